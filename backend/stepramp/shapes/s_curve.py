"""S-curve: the acceleration grows to its largest value and falls back at a constant jerk.

v(t) rises by j t²/2 for the onset a/j, then by a t, and mirrored at the end; its graph is its own image about its
centre. With Δ = v - v0: T = Δ/a + a/j where the largest acceleration is reached, else 2 sqrt(Δ/j); S = T (v0 + v)/2.
Speeds over position are roots of cubics, found by Newton's method from the step before: docs/shapes.md.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Number
from stepramp.numerics.remembered import remembered
from stepramp.numerics.slope import Slope


@dataclass(frozen=True)
class SCurve(Slope):
    """One side of a ramp with limited jerk."""

    rank = 20
    label = "S-curve"
    summary = "the acceleration grows and falls at a limited jerk"
    help = (
        "The acceleration itself comes and goes at a limited jerk: less ringing and fewer lost steps, "
        "for a slightly longer ramp."
    )
    takes = frozenset({"jerk"})
    begins_alike = False

    @cached_property
    def onset_s(self) -> float:
        """How long the acceleration grows, and how long it falls: a/j, or sqrt(Δ/j) where there is no more room [s]."""
        return min(self.acceleration / self.parameters.jerk, math.sqrt(self._gain / self.parameters.jerk))

    @cached_property
    def level_s(self) -> float:
        """How long the acceleration stays at its largest: Δ/a - a/j [s]."""
        return max(self._gain / self.acceleration - self.acceleration / self.parameters.jerk, 0.0)

    @property
    def duration_s(self) -> float:
        """T [s]."""
        return 2 * self.onset_s + self.level_s

    @property
    def length(self) -> float:
        """S = T (v0 + v)/2, by the symmetry of v(t) [steps, not whole]."""
        return self.duration_s * (self.base_speed + self.slew_speed) / 2

    def acceleration_over(self, steps: float) -> float:
        """Return the smaller root of a²/j - a T + Δ = 0 with T = 2 S / (v0 + v) [steps/s²]; inf below 2 sqrt(Δ/j)."""
        duration = 2 * steps / (self.base_speed + self.slew_speed)
        square = duration**2 - 4 * self._gain / self.parameters.jerk
        return 2 * self._gain / (duration + math.sqrt(square)) if square >= 0 else math.inf

    def jerk_over(self, steps: float) -> float:
        """Return a / (T - Δ/a) with T = 2 S / (v0 + v), or 4 Δ/T² where that never reaches a [steps/s³]."""
        duration = 2 * steps / (self.base_speed + self.slew_speed)
        level = self._gain / self.acceleration
        return self.acceleration / (duration - level) if level < duration <= 2 * level else 4 * self._gain / duration**2

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

    @property
    def _gain(self) -> float:
        """Δ [steps/s]."""
        return self.slew_speed - self.base_speed

    def _constants(self, number: Number) -> tuple[np.floating, ...]:
        """Return what the compiled loops work with, in such numbers, and how close a root has to come."""
        jerk, onset = self.parameters.jerk, self.onset_s
        base, peak = self.base_speed, jerk * onset
        level_begin = onset * (base + jerk * onset**2 / 6)
        level_end = self.length - onset * (self.slew_speed - jerk * onset**2 / 6)
        first_speed = base + peak * onset / 2
        numbers = (base, self.slew_speed, peak, jerk, onset, self.duration_s, level_begin, level_end, self.length)
        exact = (first_speed, 1, 2, 1 / 2, 1 / 6, 2 * np.finfo(number).eps)
        return tuple(number(each) for each in (*numbers, *exact))


@compiled
def _speeds(constants, place, out):  # type: ignore[no-untyped-def]  # compiled
    base, slew, peak, jerk, _, _, level_begin, level_end, length, level_speed, one, two, half, _, _ = constants
    squared = level_speed * level_speed
    # No root is known yet: the first of each phase is searched from afar.
    grown = left = -one
    for i in range(out.size):
        if place < level_begin:
            grown = _growing_time(constants, place, grown)
            out[i] = base + half * jerk * grown * grown
        elif place < level_end:
            out[i] = np.sqrt(squared + two * peak * (place - level_begin))
        else:
            left = _time_left(constants, length - place, left)
            out[i] = slew - half * jerk * left * left
        place = place + one


@compiled
def _durations(constants, timer_hz, out):  # type: ignore[no-untyped-def]  # compiled
    base, slew, peak, jerk, onset, whole, level_begin, level_end, length, level_speed, one, two, half, _, _ = constants
    squared = level_speed * level_speed
    grown = left = -one
    place = time = one - one
    speed, phase = base, 0
    for i in range(out.size):
        time_before, speed_before, phase_before, place = time, speed, phase, place + one
        if place < level_begin:
            grown = _growing_time(constants, place, grown)
            time, speed, phase = grown, base + half * jerk * grown * grown, 0
        elif place < level_end:
            speed = np.sqrt(squared + two * peak * (place - level_begin))
            time, phase = onset + two * (place - level_begin) / (speed + level_speed), 1
        else:
            left = _time_left(constants, length - place, left)
            time, speed, phase = whole - left, slew - half * jerk * left * left, 2
        # A difference of long times has few digits: it is corrected along the step itself.
        if phase == phase_before == 1:
            duration = two / (speed_before + speed)
        else:
            acceleration = (
                peak if phase_before == 1 else jerk * (time_before if phase_before == 0 else whole - time_before)
            )
            duration = _one_step(constants, time_before, speed_before, acceleration, time - time_before)
        out[i] = timer_hz * duration


@compiled
def _one_step(constants, time, speed, acceleration, duration):  # type: ignore[no-untyped-def]  # compiled
    """Return the root of v t + a t²/2 + j t³/6 = 1, one Newton step from a duration that is close to it.

    The step begins at a time with a speed and an acceleration, and may lead through all phases: where one ends need not
    be known closely, as speed and acceleration go on there.
    """
    jerk, onset, whole = constants[3:6]
    one, _, half, sixth, _ = constants[10:]
    nothing = one - one
    growing = min(max(onset - time, nothing), duration)
    level = min(max(whole - onset - max(time, onset), nothing), duration - growing)
    covered = nothing
    for part, growth in ((growing, jerk), (level, nothing), (duration - growing - level, -jerk)):
        covered += part * (speed + part * (half * acceleration + sixth * growth * part))
        speed += part * (acceleration + half * growth * part)
        acceleration += growth * part
    return duration - (covered - one) / speed


@compiled
def _growing_time(constants, place, before):  # type: ignore[no-untyped-def]  # compiled
    """Return t with v0 t + j t³/6 = place; before: that of the step before, less than 0 for none.

    The function is convex and grows: from a start that is too late Newton's method comes down to the root.
    """
    base, jerk = constants[0], constants[3]
    _, two, half, sixth, close = constants[10:]
    if before > 0:
        speed = base + half * jerk * before * before
        time = before + two / (speed + np.sqrt(speed * speed + two * jerk * before))
    else:
        time = np.cbrt(place / (sixth * jerk))
        if base * time > place:
            time = place / base
    change = time
    while change > close * time:
        square = jerk * time * time
        change = (time * (base + sixth * square) - place) / (base + half * square)
        time -= change
    return time


@compiled
def _time_left(constants, room, before):  # type: ignore[no-untyped-def]  # compiled
    """Return the time to the end of the slope, from room steps before it: v t - j t³/6 = room; before: as above.

    The function is concave and grows: from a start that is too early Newton's method comes up to the root.
    """
    slew, jerk = constants[1], constants[3]
    one, _, half, sixth, close = constants[10:]
    time = max(room, room - room) / slew
    if before > 0:
        time = max(time, before - one / (slew - half * jerk * before * before))
    change = time
    while change > close * time:
        square = jerk * time * time
        change = (room - time * (slew - sixth * square)) / (slew - half * square)
        time += change
    return time


SHAPE = SCurve
