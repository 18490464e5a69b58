"""A second planner, in exact numbers: which rate Marlin's documented algorithm plans after each step, and the wait.

Rates are those of the ideal ramp at the time that has passed, as fractions: what the firmware's 24 bits, its float32
and its rounding make of them is less than a step/s each way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

TICKS_PER_S = 2_000_000
ENDS = 120


@dataclass(frozen=True)
class Trapezoid:
    """A move in whole steps; speed and acceleration in steps."""

    steps: int
    speed: int
    acceleration: int

    @property
    def speeds_up(self) -> int:
        """Return after how many steps it speeds up no more: v² = v0² + 2 a s."""
        return min(math.ceil(Fraction(self.speed**2 - ENDS**2, 2 * self.acceleration)), math.ceil(self.steps / 2))

    @property
    def slows_down(self) -> int:
        """Return over how many steps it slows down."""
        whole = math.floor(Fraction(self.speed**2 - ENDS**2, 2 * self.acceleration))
        return min(whole, self.steps - self.speeds_up)

    def waits(self) -> list[int]:
        """Return the ticks after each step; the timer counts from 0, which takes one more."""
        found, passed, top, since = [], Fraction(TICKS_PER_S // ENDS, TICKS_PER_S), Fraction(ENDS), Fraction(0)
        for made in range(1, self.steps + 1):
            if made <= self.speeds_up:
                top = min(ENDS + self.acceleration * passed, Fraction(self.speed))
                wait = math.floor(TICKS_PER_S / Fraction(round(top)))
                passed += Fraction(wait, TICKS_PER_S)
            elif made > self.steps - self.slows_down:
                wait = math.floor(TICKS_PER_S / Fraction(round(max(top - self.acceleration * since, Fraction(ENDS)))))
                since += Fraction(wait, TICKS_PER_S)
            else:
                wait = TICKS_PER_S // self.speed
            found.append(wait + 1)
        return found
