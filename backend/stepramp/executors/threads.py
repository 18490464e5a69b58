"""The cores of this machine: threads, which numba's loops let run side by side."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice

from stepramp.executors.contract import IsWanted, Item, R
from stepramp.executors.priority import be_nicer

CORES = max(2, os.cpu_count() or 1)
NICER = 10
"""How much nicer they are than others: what a client waits for comes before what runs for a while anyway."""
AHEAD = 2
"""So many items a thread are handed out: several who ask take turns."""
LOOK_S = 0.1
"""So often it is looked whether anybody still waits [s]."""


class Threads:
    """Computes many things at once in threads of this process."""

    def __init__(self, threads: int = CORES) -> None:
        self._most = AHEAD * threads
        self._pool = ThreadPoolExecutor(threads, "map", initializer=be_nicer, initargs=(NICER,))

    def results(
        self, task: Callable[[Item, IsWanted], R], items: Sequence[Item], is_wanted: IsWanted
    ) -> Iterator[tuple[Item, R]]:
        """Yield results as Executor does."""
        left, begun = iter(items), dict[Future[R], Item]()
        try:
            while is_wanted():
                for item in islice(left, self._most - len(begun)):
                    begun[self._pool.submit(task, item, is_wanted)] = item
                if not begun:
                    return
                for done in wait(begun, LOOK_S, FIRST_COMPLETED).done:
                    if not is_wanted():
                        return
                    yield begun.pop(done), done.result()
        finally:
            for future in begun:
                future.cancel()
