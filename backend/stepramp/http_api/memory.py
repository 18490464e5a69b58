"""Memory for long plans: what doesn't fit beside the others waits, and what never would is refused before it is begun.

Quick ones, of some million steps at most, wait for none: there are but a few threads for them.
"""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from stepramp.errors import Count, Rejected, Rejection

T = TypeVar("T")

BYTES_A_STEP = 100
"""Taken at most while steps are computed and told, of each axis; a method at a time [bytes]."""
SHARE = 1 / 3
"""Of the machine's memory: the rest is for quick plans, for other programs, and for all that isn't known."""
MOST_BYTES = 4 * 2**30
WHERE_UNKNOWN_BYTES = 2 * 2**30
_OF_CONTAINER = Path("/sys/fs/cgroup/memory.max")


def machine_bytes() -> int | None:
    """Return how much memory the machine has, or the container that we are in; None where that isn't told [bytes]."""
    told: list[int] = []
    with suppress(AttributeError, ValueError, OSError):
        told.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    with suppress(ValueError, OSError):
        told.append(int(_OF_CONTAINER.read_text()))  # "max" where there is no limit
    return min((each for each in told if each > 0), default=None)


def most_for_plans() -> int:
    """Return how much memory all plans together may take [bytes]."""
    known = machine_bytes()
    return WHERE_UNKNOWN_BYTES if known is None else min(MOST_BYTES, int(known * SHARE))


class Memory:
    """Room for plans, for any thread: who comes first has it first."""

    def __init__(self, most_bytes: int) -> None:
        self.most_bytes = most_bytes
        self._left_bytes = most_bytes
        self._changed = threading.Condition()
        self._waiting: list[object] = []

    @property
    def most_steps(self) -> int:
        """So many steps of all axes together may be planned at a time."""
        return self.most_bytes // BYTES_A_STEP

    def of(self, steps: int, field: str) -> int:
        """Return how much a plan of so many steps, of all axes together, takes [bytes].

        Raises Rejected, naming a field, when it is more than there is.
        """
        if steps > self.most_steps:
            allowed = (
                f"at most {self.most_steps:,} steps, of all axes together: for more this machine has too little memory"
            )
            raise Rejected([Rejection(field, Count(f"{steps:,} steps"), allowed)])
        return steps * BYTES_A_STEP

    @contextmanager
    def held(self, size_bytes: int) -> Iterator[None]:
        """Wait until there is so much room, and hold it [bytes]."""
        turn = object()
        with self._changed:
            self._waiting.append(turn)
            self._changed.wait_for(lambda: self._waiting[0] is turn and size_bytes <= self._left_bytes)
            self._waiting.remove(turn)
            self._left_bytes -= size_bytes
            self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._left_bytes += size_bytes
                self._changed.notify_all()

    def use(self, size_bytes: int, job: Callable[[], T]) -> T:
        """Run a job that takes so much, once there is room."""
        with self.held(size_bytes):
            return job()


MEMORY = Memory(most_for_plans())
