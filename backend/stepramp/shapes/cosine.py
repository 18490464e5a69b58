"""Cosine: the speed follows half a wave, v(t) = v0 + Δ sin²(π t / 2 T); the acceleration is half a sine.

With Δ = v - v0 and the angle θ = π t / T: s = (T / π) (v0 θ + Δ (θ - sin θ) / 2), S = T (v0 + v) / 2, and the largest
acceleration a = π Δ / 2 T is in the middle. The angle of a place is found by Newton's method: docs/shapes.md.
"""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Number
from stepramp.numerics.remembered import remembered
from stepramp.numerics.slope import Slope


@dataclass(frozen=True)
class Cosine(Slope):
    """One side of a ramp whose speed is half a wave."""

    rank = 30
    label = "Cosine"
    summary = "the speed follows half a wave, the acceleration half a sine"
    help = (
        "Speed follows half a wave. Soft at both ends without a number of its own; as long as 1.57 "
        "ramps of the same acceleration."
    )
    begins_alike = False

    @property
    def duration_s(self) -> float:
        """T = π Δ / 2 a [s]."""
        gain = self.slew_speed - self.base_speed
        return math.pi * gain / (2 * self.acceleration) if gain else 0.0

    @property
    def length(self) -> float:
        """S = T (v0 + v) / 2 [steps, not whole]."""
        return self.duration_s * (self.base_speed + self.slew_speed) / 2

    def acceleration_over(self, steps: float) -> float:
        """Return π (v² - v0²) / (4 S) [steps/s²]."""
        return math.pi * (self.slew_speed**2 - self.base_speed**2) / (4 * steps)

    def lowered(self, peak_speed: float) -> Self:
        """Return the slope to a lower speed with the same largest jerk, which is 2 a²/Δ: the acceleration is lower."""
        part = (peak_speed - self.base_speed) / (self.slew_speed - self.base_speed)
        return replace(self, slew_speed=peak_speed, acceleration=self.acceleration * math.sqrt(part))

    @remembered
    def speeds(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        """Return the speeds at `first`, `first` + 1 … steps from the base speed [steps/s], shape (count,)."""
        out = np.empty(count, number)
        _speeds(self._constants(number), number(first), out)
        return out

    @remembered
    def durations(self, number: Number) -> NDArray[np.floating]:
        """Return F (t(i) - t(i - 1)) [ticks], shape (steps,)."""
        out = np.empty(self.steps, number)
        _durations(self._constants(number), number(self.timer_hz), out)
        return out

    def _constants(self, number: Number) -> tuple[np.floating, ...]:
        """Return what the compiled loops work with, in such numbers; last, how small a change has to be."""
        gain, scale = self.slew_speed - self.base_speed, self.duration_s / math.pi
        middle = scale * (self.base_speed * math.pi / 2 + gain * (math.pi / 2 - 1) / 2)
        exact = (self.length, middle, math.pi, 1, 7 / 48, 1 / 2, 1 / 6, np.sqrt(np.finfo(number).eps))
        return tuple(number(each) for each in (self.base_speed, gain, scale, *exact))


@compiled
def _speeds(constants, place, out):  # type: ignore[no-untyped-def]  # compiled
    base, gain, _, _, _, _, one, _, half, _, _ = constants
    angle = -one
    for i in range(out.size):
        angle = _angle(constants, place, angle)
        sine = np.sin(half * angle)
        out[i] = base + gain * sine * sine
        place = place + one


@compiled
def _durations(constants, timer_hz, out):  # type: ignore[no-untyped-def]  # compiled
    one, scale = constants[6], constants[2]
    place = before = one - one
    for i in range(out.size):
        place = place + one
        angle = _angle(constants, place, before)
        # The difference of two angles has few digits: one Newton step along the step itself mends it.
        turn = _one_step(constants, before, angle - before)
        out[i] = timer_hz * scale * turn
        before = angle


@compiled
def _one_step(constants, angle, turn):  # type: ignore[no-untyped-def]  # compiled
    """Return the turn from an angle on that takes one step, one Newton step from a turn that is close to it."""
    base, gain, scale, _, _, _, one, _, half, _, _ = constants
    centre, end = np.sin(half * (angle + half * turn)), np.sin(half * (angle + turn))
    cosine = one - centre * centre - centre * centre
    covered = scale * (base * turn + gain * (turn * centre * centre + cosine * _less_sine(constants, half * turn)))
    return turn - (covered - one) / (scale * (base + gain * end * end))


@compiled
def _angle(constants, place, before):  # type: ignore[no-untyped-def]  # compiled
    """Return the angle at a place; before: that of the step before, 0 or less for none.

    In the first half the place is convex over the angle: from a start that is too late Newton's method comes down to
    the root. The second half is searched from its end, where the same holds backwards: from too early it comes up.
    After a change by c the root is within c²/θ, since |v'/v| is at most 2/θ: what is left is less than can be written.
    """
    base, gain, scale, length, middle, pi, one, most, half, _, close = constants
    turn = one + one
    if before > 0:
        sine = np.sin(half * before)
        turn = one / (scale * (base + gain * sine * sine))
    if place < middle:
        # θ - sin θ is at least 7/8 of θ³/6 up to a right angle.
        angle = min(np.cbrt(place / (most * half * gain * scale)), half * pi)
        if base * scale * angle > place:
            angle = place / (base * scale)
        if before > 0:
            angle = min(angle, before + turn)
        change = angle
        while change > close * angle:
            sine = np.sin(half * angle)
            covered = scale * (base * angle + half * gain * _less_sine(constants, angle))
            change = (covered - place) / (scale * (base + gain * sine * sine))
            angle -= change
        return angle
    room = max(length - place, one - one)
    left = room / (scale * (base + gain))
    if before > 0:
        left = max(left, pi - before - turn)
    change = left
    while change > close * left:
        cosine = np.cos(half * left)
        covered = scale * (base * left + half * gain * (left + np.sin(left)))
        change = (room - covered) / (scale * (base + gain * cosine * cosine))
        left += change
    return pi - left


@compiled
def _less_sine(constants, angle):  # type: ignore[no-untyped-def]  # compiled
    """Return x - sin x; by its series where the difference would have few digits."""
    one, sixth = constants[6], constants[9]
    if angle > one:
        return angle - np.sin(angle)
    square, total = angle * angle, one
    for n in (20, 18, 16, 14, 12, 10, 8, 6, 4):
        total = one - total * square * one / (one * n * (n + 1))
    return angle * square * sixth * total


SHAPE = Cosine
