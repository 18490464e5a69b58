"""Lanes: the threads that requests are served in, apart by what they do, so that none waits for what takes long.

A stop needs none of them: see door.
"""

import asyncio
import threading
from collections.abc import Callable, Coroutine, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial, wraps
from typing import Any, ParamSpec, Protocol, TypeVar
from weakref import WeakValueDictionary

from stepramp.design import Design
from stepramp.devices.device import Device
from stepramp.errors import Overloaded
from stepramp.executors.priority import be_nicer
from stepramp.executors.threads import CORES
from stepramp.http_api.access import ASKING
from stepramp.http_api.memory import MEMORY
from stepramp.ramp.plan import computed_steps

T = TypeVar("T")
P = ParamSpec("P")

A_CLIENT = 1
"""So many threads for what takes long one client has at most, where several share the server: each gets its turns."""
A_DEVICE = 3
"""So many threads of a lane one device has at most. Its answers come over one line, one after the other."""
NICER = 5
"""How much a computing thread is nicer than the others: it gets a third of the time that they get, if they want it."""
MOST_WAIT_S = 30.0
"""Whoever has waited so long behind others that take seconds each is told so: nobody knows how long it would last."""
MOST_QUICK_STEPS = 5_000_000
"""More steps, of all methods or axes together, take long to compute [steps]."""
MOST_QUICK_POINTS = 200_000
"""Answers of more points take long to send [points]."""
MOST_AT_ONCE_STEPS, MOST_AT_ONCE_POINTS = 10_000, 500
"""A profile of no more takes some 0.2 ms, whatever its method and shape: no longer than to hand it to a thread, and its
answer back, while many ask. It fits into one piece."""
COMPILED = threading.Event()
"""Set once the numerics are compiled: before that, the first profile of a kind takes seconds."""


class Lane:
    """So many threads, and a queue of what waits for them.

    What is cancelled while it waits is never begun; what has begun is done to its end. What is asked of one device has
    only some of the threads, so that one that doesn't answer keeps no other device waiting.
    """

    def __init__(self, name: str, threads: int, *, computes: bool = False, most_wait_s: float | None = None) -> None:
        """Make a lane. most_wait_s: what hasn't come to its turn by then is refused; None: it waits."""
        self._most_wait_s = most_wait_s
        self._pool = ThreadPoolExecutor(
            threads, thread_name_prefix=name, initializer=partial(be_nicer, NICER if computes else 0)
        )
        # Each lives as long as somebody uses it or waits for it.
        self._of_devices: WeakValueDictionary[object, asyncio.Semaphore] = WeakValueDictionary()
        self._of_clients: WeakValueDictionary[object, asyncio.Semaphore] = WeakValueDictionary()

    async def run(self, job: Callable[[], T], device: object = None) -> T:
        """Run a job in its turn; return its result, or raise what it raised, or Overloaded where its turn doesn't come.

        device: what tells the device apart that the job asks, if it asks one.
        """
        if device is None and self._most_wait_s is not None and (client := ASKING.get()) is not None:
            return await self._in_turn_of(client.name, job, self._most_wait_s)
        if device is None:
            return await self._unless_late(self._pool.submit(job))
        loop = asyncio.get_running_loop()
        turns = self._of_devices.setdefault((loop, device), asyncio.Semaphore(A_DEVICE))
        await turns.acquire()
        begun = self._pool.submit(job)
        # Not as soon as nobody waits for it any more: until the device answers, the thread is taken.
        begun.add_done_callback(lambda _: _in(loop, turns.release))
        return await asyncio.wrap_future(begun)

    async def _in_turn_of(self, client: str, job: Callable[[], T], most_wait_s: float) -> T:
        """Run a job once the client's earlier ones are done; raise as run."""
        loop = asyncio.get_running_loop()
        turns = self._of_clients.setdefault((loop, client), asyncio.Semaphore(A_CLIENT))
        try:
            async with asyncio.timeout(most_wait_s):
                await turns.acquire()
        except TimeoutError:
            raise Overloaded(
                f"What you asked for before takes long: this has waited {most_wait_s:g} s. Ask again later."
            ) from None
        begun = self._pool.submit(job)
        # Not as soon as the client has left: what has begun goes on, and who asks again and leaves would take them all.
        begun.add_done_callback(lambda _: _in(loop, turns.release))
        return await self._unless_late(begun)

    async def _unless_late(self, begun: Future[T]) -> T:
        made = asyncio.wrap_future(begun)
        try:
            await asyncio.wait([made], timeout=self._most_wait_s)
        except asyncio.CancelledError:
            made.cancel()
            raise
        if not made.done() and begun.cancel():
            raise Overloaded(
                f"Others are computing: this has waited {self._most_wait_s:g} s for its turn. Ask again later."
            )
        return await made

    def serves(self, route: Callable[P, T]) -> Callable[P, Coroutine[Any, Any, T]]:
        """Have a route's requests served in this lane: a decorator."""

        @wraps(route)
        async def in_turn(*args: P.args, **arguments: P.kwargs) -> T:
            return await self.run(partial(route, *args, **arguments), _device_of(arguments))

        return in_turn

    def wait_for(self, job: Callable[[], T]) -> T:
        """Run a job in its turn for a thread of another lane, which waits for it; as run."""
        return self._pool.submit(job).result()


PLANNING = Lane("planning", CORES, computes=True)
"""Computing for sliders, and all else that is done soon."""
LONG_PLANNING = Lane("long planning", CORES, computes=True, most_wait_s=MOST_WAIT_S)
"""Computing of millions of steps, of what motors do, and what makes files. A turn lasts until the answer is sent, so
that no more of those are in memory than there are threads."""
CONNECTING = Lane("connecting", 8)
"""Connecting, which takes up to 5 s."""
CHECKING = Lane("checking", 1, computes=True)
"""Parsing and validating of large bodies: one at a time, since other threads hardly get on meanwhile."""
CAPTURING = Lane("capturing", 1, computes=True, most_wait_s=MOST_WAIT_S)
"""Reading of captured files: one at a time, since each takes many times its own size in memory."""
PUSHING = Lane("pushing", 8)
"""Pushes, which take some seconds and wait for their planning, too."""
LIBRARY = Lane("library", 1, most_wait_s=MOST_WAIT_S)
"""All that is read of the library, one after the other: whatever its database waits for, nothing else does."""
LIBRARY_WRITING = Lane("library writing", 1, most_wait_s=MOST_WAIT_S)
"""All that is saved in it: each waits up to 5 s for another program that writes, or for a whole library that comes."""
LIBRARY_FILES = Lane("library files", 1, computes=True, most_wait_s=MOST_WAIT_S)
"""Whole libraries, out and in, one after the other: what else is asked of the library waits for none of them."""
ACTING = Lane("acting", 32)
"""What else is asked of a device: most of it answered within some ms."""


def _in(loop: asyncio.AbstractEventLoop, act: Callable[[], None]) -> None:
    with suppress(RuntimeError):  # The loop has ended, and with it whoever waits.
        loop.call_soon_threadsafe(act)


def _device_of(arguments: dict[str, Any]) -> object:
    """Return what tells the device apart that a route is asked about, if it is."""
    device: Device | None = arguments.get("device")
    return arguments.get("device_id") if device is None else device.view.id


class AtOnce:
    """Where what takes no time worth mentioning has its turn: there and then, in the loop that it is asked for in."""

    async def run(self, job: Callable[[], T]) -> T:
        """Run a job; as Lane.run."""
        return job()


AT_ONCE = AtOnce()


class Turns(Protocol):
    """Where a job has its turn."""

    async def run(self, job: Callable[[], T]) -> T:
        """Run a job in its turn; as Lane.run."""


@dataclass(frozen=True)
class PlanningTurns:
    """A lane for jobs that take so much memory: in its turn a long one waits until there is room."""

    lane: Lane
    size_bytes: int

    async def run(self, job: Callable[[], T]) -> T:
        """Run a job in its turn; as Lane.run."""
        return await self.lane.run(job if self.lane is PLANNING else partial(MEMORY.use, self.size_bytes, job))


def planning_lane(
    designs: Sequence[Design], methods: int = 1, points: int | None = None, field: str = "design"
) -> PlanningTurns:
    """Return where designs are planned by so many methods; points: most that are answered, None for all steps.

    Raises Rejected, naming a field of the request, where they take more memory than there is.
    """
    steps_of_one = sum(map(computed_steps, designs))
    size_bytes = MEMORY.of(steps_of_one, field)
    steps = methods * steps_of_one
    is_quick = steps <= MOST_QUICK_STEPS and min(steps, points or steps) <= MOST_QUICK_POINTS
    return PlanningTurns(PLANNING if is_quick else LONG_PLANNING, size_bytes)


def profile_turns(design: Design, points: int | None) -> Turns:
    """Return where a design's profile is planned; points and what is raised: as of planning_lane."""
    steps = computed_steps(design)
    is_small = steps <= MOST_AT_ONCE_STEPS and min(steps, points or steps) <= MOST_AT_ONCE_POINTS
    return AT_ONCE if is_small and COMPILED.is_set() else planning_lane([design], points=points)
