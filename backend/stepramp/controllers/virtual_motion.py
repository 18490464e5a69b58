"""The virtual controller's motor: a move as a function of time, and how it stops."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.ramp.move import Ramp, split


@dataclass(frozen=True)
class Motion:
    """The intervals of one move [ticks]: a head, one interval many times, and a tail.

    A move may be 2³¹ steps long, so the slew intervals are never written out.
    """

    head: NDArray[np.int64]
    slew_interval: int
    slew_steps: int
    tail: NDArray[np.int64]

    @classmethod
    def of(cls, ramp: Ramp, steps: int) -> "Motion":
        """Return the move of so many steps that the ramp gives."""
        n_up, n_down = split(ramp, steps)
        up, down = ramp.up[:n_up].astype(np.int64), ramp.down[:n_down].astype(np.int64)
        return cls(up, int(ramp.slew), steps - n_up - n_down, down[::-1])

    @property
    def steps(self) -> int:
        """Number of pulses, which is that of intervals."""
        return self.head.size + self.slew_steps + self.tail.size

    @property
    def duration_ticks(self) -> int:
        """From the first pulse to the end of the last interval [ticks]."""
        return int(self.head.sum()) + self.slew_steps * self.slew_interval + int(self.tail.sum())

    def intervals_passed(self, ticks: int) -> int:
        """Return how many intervals have passed wholly, so long after the first pulse [ticks]."""
        ticks_of_head = int(self.head.sum())
        if ticks < ticks_of_head:
            return _passed(self.head, ticks)
        slewing = (ticks - ticks_of_head) // self.slew_interval
        if slewing < self.slew_steps:
            return self.head.size + slewing
        ticks_of_tail = ticks - ticks_of_head - self.slew_steps * self.slew_interval
        return self.head.size + self.slew_steps + _passed(self.tail, ticks_of_tail)

    def pulses(self, ticks: int) -> int:
        """Return how many pulses have been made, so long after the first [ticks]."""
        return min(self.intervals_passed(ticks) + 1, self.steps)

    def interval(self, ticks: int) -> int:
        """Return the present interval [ticks], 0 when the move is over."""
        index = self.intervals_passed(ticks)
        if index < self.head.size:
            return int(self.head[index])
        if index < self.head.size + self.slew_steps:
            return self.slew_interval
        return int(self.tail[index - self.head.size - self.slew_steps]) if index < self.steps else 0

    def stopped(self, ticks: int, ramp: Ramp) -> "Motion":
        """Return this move as it goes on when a stop comes, so long after the first pulse [ticks].

        The present interval runs out; then come the last of the ramp's down steps, those longer than it. While slewing
        that is all of them. A move that slows down already ends where it would have ended.
        """
        index = self.intervals_passed(ticks)
        if index >= self.head.size + self.slew_steps:
            return self
        down = ramp.down.astype(np.int64)
        if index < self.head.size:
            short_enough = np.flatnonzero(down <= self.head[index])
            steps = int(short_enough[0]) if short_enough.size else down.size
            way_down = Motion(self.head[: index + 1], self.slew_interval, 0, down[:steps][::-1])
        else:
            way_down = Motion(self.head, self.slew_interval, index - self.head.size + 1, down[::-1])
        return way_down if way_down.steps < self.steps else self


def _passed(intervals: NDArray[np.int64], ticks: int) -> int:
    return int(np.searchsorted(np.cumsum(intervals), ticks, side="right"))


class VirtualMotor:
    """A motor that moves by a clock [s], at so many ticks a second [Hz]. It is where the last call found it."""

    def __init__(self, clock: Callable[[], float], timer_hz: int) -> None:
        self._clock = clock
        self._timer_hz = timer_hz
        self._motion: Motion | None = None
        self._began_s = 0.0
        self._start = 0
        self._direction = 1
        self.stopping = False
        self.steps_made = 0
        """Pulses of the present move, or of the last one."""
        self.interval_ticks = 0
        """The interval that passes [ticks]; 0 at rest."""

    @property
    def moving(self) -> bool:
        """Whether a move has not ended yet."""
        return self._motion is not None

    @property
    def position(self) -> int:
        """Where the motor is [steps]."""
        return self._start + self._direction * self.steps_made

    @property
    def target(self) -> int:
        """Where the motor will come to rest [steps]; its position at rest."""
        return self._start + self._direction * self._motion.steps if self._motion else self.position

    def settle(self) -> None:
        """Move to where the motor is by now."""
        if self._motion is not None:
            ticks = self._ticks()
            self.steps_made = self._motion.pulses(ticks)
            self.interval_ticks = self._motion.interval(ticks)
            if not self.interval_ticks:
                self._motion = None

    def move(self, ramp: Ramp, steps: int) -> None:
        """Begin to move by so many steps, not 0, from rest."""
        self._start, self._direction = self.position, 1 if steps > 0 else -1
        self._motion, self._began_s = Motion.of(ramp, abs(steps)), self._clock()
        self.stopping = False
        self.settle()

    def stop(self, ramp: Ramp) -> None:
        """Slow down with the ramp; nothing at rest, or when that has begun already."""
        if self._motion is not None and not self.stopping:
            self._motion = self._motion.stopped(self._ticks(), ramp)
            self.stopping = True

    def halt(self) -> None:
        """Make no further step."""
        self._motion = None
        self.interval_ticks = 0

    def _ticks(self) -> int:
        return int((self._clock() - self._began_s) * self._timer_hz)
