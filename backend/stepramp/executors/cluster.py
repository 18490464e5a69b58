"""A Dask cluster that is there already: its scheduler's address stands in STEPRAMP_DASK."""

import logging
import pickle
import queue
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from stepramp.errors import Refused, Rejected, Rejection
from stepramp.executors.contract import IsWanted, Item, R
from stepramp.version import __version__

VARIABLE = "STEPRAMP_DASK"
CONNECT_S = 3.0
"""So long the scheduler has for its answer, and then its first worker to be there [s]."""
LOOK_S = 0.1
"""So often it is looked whether anybody still waits [s]."""
CHUNKS = 16
"""Into so many parts what a worker's thread does is divided: as many as it may lose, and as pictures are told."""
ALLOWED = (
    "the address of a Dask scheduler that answers and has a worker, such as tcp://127.0.0.1:8786; without the variable "
    "the cores of this machine compute"
)

DIED = (
    "Dask's workers died, one after the other, while they computed the same part, so that the scheduler at {address} "
    "gave it up. What they wrote last says why; often they have too little memory."
)


@contextmanager
def connected(address: str) -> Iterator["Cluster"]:
    """Yield the cluster of a scheduler. Raises Rejected, which names STEPRAMP_DASK, when it can't be used."""
    if find_spec("distributed") is None:
        raise _refused(address, "Dask, which isn't installed here: pip install 'stepramp[cluster]'")
    if not address.startswith(("tcp://", "tls://")):
        raise _refused(address, ALLOWED)
    # Not imported before it is needed: it takes half a second.
    distributed: Any = import_module("distributed")
    # What it says of a scheduler that doesn't answer, the refusal says.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise _refused(address, ALLOWED) from error
    try:
        try:
            client.wait_for_workers(1, timeout=CONNECT_S)
        except TimeoutError as error:
            raise _refused(address, ALLOWED) from error
        yield Cluster(address, client)
    finally:
        client.close()


class Cluster:
    """Computes many things at once on the workers of a Dask cluster.

    A worker that dies costs time only: the scheduler has others do what it was at.
    """

    def __init__(self, address: str, client: Any) -> None:
        self._address, self._client = address, client

    def results(
        self, task: Callable[[Item, IsWanted], R], items: Sequence[Item], is_wanted: IsWanted
    ) -> Iterator[tuple[Item, R]]:
        """Yield results as Executor does. Raises Rejected when the scheduler has gone."""
        done: queue.SimpleQueue[int] = queue.SimpleQueue()
        chunks = self._chunks(items)
        dumps = import_module("cloudpickle").dumps
        calls = [dumps(_Call(on_worker, __version__, task, chunk)) for chunk in chunks]
        futures = self._client.map(pickle.loads, calls, pure=False)
        for number, future in enumerate(futures):
            future.add_done_callback(lambda _, number=number: done.put(number))
        left = len(chunks)
        try:
            while left and is_wanted():
                try:
                    number = done.get(timeout=LOOK_S)
                except queue.Empty:
                    continue
                yield from zip(chunks[number], self._result(futures[number]), strict=True)
                left -= 1
        finally:
            self._client.cancel(futures)

    def _result(self, future: Any) -> Any:
        """Return what a worker made; raise what its task raised, or Rejected where the scheduler has gone."""
        if future.status == "error":
            error = future.exception()
            if isinstance(error, ImportError):
                lacking = f"A Dask worker lacks what StepRamp needs: {error}. Install StepRamp {__version__} there."
                raise Refused(lacking) from error
            killed: type[Exception] = import_module("distributed.scheduler").KilledWorker
            if isinstance(error, killed):
                raise Refused(DIED.format(address=self._address)) from error
            raise error
        # It may be done there, and its result not here yet.
        try:
            return future.result()
        except (OSError, CancelledError) as error:
            raise _refused(self._address, ALLOWED) from error

    def _chunks(self, items: Sequence[Item]) -> list[Sequence[Item]]:
        """Return the items, some together: to hand out a task takes as long as to play a short move."""
        threads = max(1, sum(self._client.nthreads().values()))
        size = max(1, len(items) // (CHUNKS * threads))
        return [items[first : first + size] for first in range(0, len(items), size)]


class _Call:
    """A call that is done by who unpickles it.

    As bytes until then: a scheduler needs no StepRamp, and a worker that has none says so.
    """

    def __init__(self, function: Callable[..., object], *arguments: object) -> None:
        self._parts = function, arguments

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return self._parts


def on_worker(version: str, task: Callable[[Item, IsWanted], R], items: Sequence[Item]) -> list[R]:
    """Do a task on a worker, which must have the same StepRamp: another one may see a move otherwise."""
    if version != __version__:
        raise Refused(f"A Dask worker has StepRamp {__version__}, and {version} asks it: install the same on both.")
    is_wanted = _IsWantedHere()
    return [task(item, is_wanted) for item in items]


class _IsWantedHere:
    """Whether the scheduler still waits for what this worker is at."""

    def __init__(self) -> None:
        distributed: Any = import_module("distributed")
        self._worker = distributed.get_worker()
        self._key = self._worker.get_current_task()

    def __call__(self) -> bool:
        task = self._worker.state.tasks.get(self._key)
        return task is not None and task.state == "executing"


def _refused(address: str, allowed: str) -> Rejected:
    return Rejected([Rejection(VARIABLE, address, allowed)])
