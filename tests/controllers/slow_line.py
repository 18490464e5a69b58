"""A line with a clock of its own, on which answers come late and noise in between, and a stop that is asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Generic, Protocol, TypeVar

NOISE = b"\xa5"


class Board(Protocol):
    """What is at its far end."""

    def exchange(self, sent: bytes) -> bytes: ...


B = TypeVar("B", bound=Board)


class SlowLine(Generic[B]):
    """Answers come in their order, each so long after its question [s], and noise without end if that is wanted.

    make: the board at its far end, given its clock. travel_s: how long each answer is on the way.
    """

    def __init__(self, make: Callable[[Callable[[], float]], B], travel_s: float) -> None:
        self.name = "slow"
        self.now_s = 0.0
        self.answers_after_s: Iterator[float] = iter(())
        self.answers_are_lost = False
        self.noise_every_s: float | None = None
        self.board = make(lambda: self.now_s)
        self.sent: list[tuple[float, bytes]] = []
        """What was sent, and when."""
        self._travel_s = travel_s
        self._noise_s = 0.0
        self._on_the_way: list[tuple[float, bytes]] = []

    def write(self, data: bytes) -> None:
        self.sent.append((self.now_s, data))
        answer = self.board.exchange(data)
        if answer and not self.answers_are_lost:
            last_s = self._on_the_way[-1][0] if self._on_the_way else 0.0
            due_s = max(self.now_s + next(self.answers_after_s, 0.0), last_s) + self._travel_s
            self._on_the_way.append((due_s, answer))

    def read(self, timeout_s: float) -> bytes:
        until_s = self.now_s + timeout_s
        if self._on_the_way and self._on_the_way[0][0] <= min(until_s, self._next_noise_s()):
            due_s, answer = self._on_the_way.pop(0)
            self.now_s = max(self.now_s, due_s)
            return answer
        if self._next_noise_s() <= until_s:
            self.now_s = self._noise_s = self._next_noise_s()
            return NOISE
        self.now_s = until_s
        return b""

    def pending(self) -> bytes:
        come = b""
        while self._on_the_way and self._on_the_way[0][0] <= self.now_s:
            come += self._on_the_way.pop(0)[1]
        return come

    def close(self) -> None:
        pass

    def _next_noise_s(self) -> float:
        if self.noise_every_s is None:
            return float("inf")
        return max(self._noise_s + self.noise_every_s, self.now_s)


class Urgent:
    """Does something once when a moment has come and somebody gives way."""

    def __init__(self, line: SlowLine) -> None:
        self._line = line
        self._at_s: float | None = None
        self._act: Callable[[], None] = lambda: None

    def come(self, after_s: float, act: Callable[[], None]) -> float:
        """Return when it is, so long after now [s]."""
        self._at_s, self._act = self._line.now_s + after_s, act
        return self._at_s

    def give_way(self, pause_s: float) -> None:
        self._line.now_s += pause_s
        if self._at_s is not None and self._line.now_s >= self._at_s:
            self._at_s = None
            self._act()
