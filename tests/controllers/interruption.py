"""What comes in the midst of a call, at each place where a bench gives way, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Protocol


class GivesWay(Protocol):
    """A bench: what it calls whenever it gives way may be set."""

    interrupt: Callable[[], None]


class Interruption:
    """Does something at a place, counted from 0, of those that are passed within the context."""

    def __init__(self, bench: GivesWay, place: int, act: Callable[[], None]) -> None:
        self.place = place
        self.came = False
        self._bench, self._act = bench, act
        self._passed = 0
        self._is_inside = False

    def __enter__(self) -> None:
        self._bench.interrupt = self._pass

    def __exit__(self, *_: object) -> None:
        self._bench.interrupt = lambda: None

    def _pass(self) -> None:
        if self._is_inside:
            return
        self._passed += 1
        if self._passed == self.place + 1:
            self.came = self._is_inside = True
            self._act()
            self._is_inside = False


def interruptions(bench: GivesWay, act: Callable[[], None], apart: int = 1) -> Iterator[Interruption]:
    """Yield one for each place, or for each so many; who finds that it did not come has been at all of them."""
    for place in count(step=apart):
        yield Interruption(bench, place, act)
