"""Lanes: the threads that requests are served in, apart by what they do, so that none waits for what takes long.

A stop needs none of them: see door.
"""

import asyncio
import os
import sys
import threading
from collections.abc import Callable, Coroutine, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial, wraps
from typing import Any, ParamSpec, TypeVar

from stepramp.design import Design
from stepramp.ramp.plan import computed_steps

T = TypeVar("T")
P = ParamSpec("P")

CORES = max(2, os.cpu_count() or 1)
NICER = 5
"""How much a computing thread is nicer than the others: it gets a third of the time that they get, if they want it."""
MOST_QUICK_STEPS = 5_000_000
"""More steps, of all methods or axes together, take long to compute [steps]."""
MOST_QUICK_POINTS = 200_000
"""Answers of more points take long to send [points]."""


def _yield_to_others() -> None:
    """Let the system prefer the threads that wait for clients and controllers to this one, which computes."""
    if sys.platform == "linux":  # Elsewhere priorities are those of processes.
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), os.getpriority(os.PRIO_PROCESS, 0) + NICER)


class Lane:
    """So many threads, and a queue of what waits for them.

    What is cancelled while it waits is never begun; what has begun is done to its end.
    """

    def __init__(self, name: str, threads: int, *, computes: bool = False) -> None:
        self._pool = ThreadPoolExecutor(
            threads, thread_name_prefix=name, initializer=_yield_to_others if computes else None
        )

    async def run(self, job: Callable[[], T]) -> T:
        """Run a job in its turn; return its result, or raise what it raised."""
        return await asyncio.get_running_loop().run_in_executor(self._pool, job)

    def serves(self, route: Callable[P, T]) -> Callable[P, Coroutine[Any, Any, T]]:
        """Have a route's requests served in this lane: a decorator."""

        @wraps(route)
        async def in_turn(*args: P.args, **asked: P.kwargs) -> T:
            return await self.run(partial(route, *args, **asked))

        return in_turn

    def wait_for(self, job: Callable[[], T]) -> T:
        """Run a job in its turn for a thread of another lane, which waits for it; as run."""
        return self._pool.submit(job).result()


PLANNING = Lane("planning", CORES, computes=True)
"""Computing for sliders, and all else that is done soon."""
LONG_PLANNING = Lane("long planning", CORES, computes=True)
"""Computing of millions of steps, and what makes files. A turn lasts until the answer is sent, so that no more of those
are in memory than there are threads."""
CONNECTING = Lane("connecting", 8)
"""Connecting, which takes up to 6 s."""
CHECKING = Lane("checking", 1, computes=True)
"""Parsing and validating of large bodies: one at a time, since other threads hardly get on meanwhile."""
PUSHING = Lane("pushing", 8)
"""Pushes, which take some seconds and wait for their planning, too."""
ACTING = Lane("acting", 32)
"""What else is asked of a device: most of it answered within some ms."""


def planning_lane(designs: Sequence[Design], methods: int = 1, points: int | None = None) -> Lane:
    """Return the lane for planning designs by so many methods; points: most that are answered, None for all steps."""
    steps = methods * sum(map(computed_steps, designs))
    is_quick = steps <= MOST_QUICK_STEPS and min(steps, points or steps) <= MOST_QUICK_POINTS
    return PLANNING if is_quick else LONG_PLANNING
