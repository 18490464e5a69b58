"""A line to a Tic with a clock of its own, on which answers come late and noise in between."""

from __future__ import annotations

from collections.abc import Iterator

from controllers.tic.emulator import READ, TicEmulator

ANSWER_S = 0.2
TRAVEL_S = 0.01
NOISE = b"\xa5"


class SlowLine:
    """Answers come in their order, each so long after its question [s], and noise without end if that is wanted."""

    def __init__(self) -> None:
        self.name = "slow"
        self.now_s = 0.0
        self.answers_after_s: Iterator[float] = iter(())
        self.answers_are_lost = False
        self.noise_every_s: float | None = None
        self.tic = TicEmulator(lambda: self.now_s)
        self.sent: list[tuple[float, bytes]] = []
        """What was sent that is no question, and when."""
        self._noise_s = 0.0
        self._on_the_way: list[tuple[float, bytes]] = []

    def write(self, data: bytes) -> None:
        if data and data[0] not in READ:
            self.sent.append((self.now_s, data))
        answer = self.tic.exchange(data)
        if answer and not self.answers_are_lost:
            last_s = self._on_the_way[-1][0] if self._on_the_way else 0.0
            due_s = max(self.now_s + next(self.answers_after_s, 0.0), last_s) + TRAVEL_S
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
