"""The steps that grbl 1.1 really makes of a move: of one speed within each of its segments of 10 ms.

grbl plans in float32, in millimetres and minutes: a trapezoid of constant acceleration from rest to rest. Of that it
takes the distance of 10 ms at a time, or of as many as hold a whole step, and plays the whole steps in it at even
intervals; what is left of the time of a step goes into the next segment. A tick of its step timer lasts a clock cycle
more than what is put into the compare register, since the timer counts from 0. Below 8 kHz, 4 kHz and 2 kHz it ticks
twice, four and eight times a step (AMASS), so an interval is a multiple of that. It begins to count in the middle of a
step and makes one once it is beyond its end, so not in the last of eight ticks but in the fifth: between two segments
an interval is three ticks of the one and five of the other.

Source: how grbl 1.1h works, as its stepper and planner modules say; the timer is that of the ATmega328P's data sheet.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.errors import Refused
from stepramp.numerics.compiled import compiled
from stepramp.units import SECONDS_PER_MINUTE

SEGMENTS_PER_S = 100
LEAST_STEPS_IN_SEGMENT = 1.25
"""A segment is made longer until it goes on by so many steps, at least."""
LEVELS = 3
LONGEST_CYCLES = 0xFFFF
"""The longest tick [clock cycles]."""
STEPS_IN_TICK = (1, 2, 3, 5)
"""In which tick the step is made, of one, two, four and eight."""


@dataclass(frozen=True)
class StepTimer:
    """What makes the ticks, of which there are one, two, four or eight a step."""

    clock_hz: int
    finest_cycles: int
    """From so many clock cycles a step on it ticks twice a step, from twice as many four times, from four times as many
    eight times."""
    more_cycles: int
    """A tick lasts so many clock cycles more than it is told."""

    @property
    def slowest_steps_per_s(self) -> float:
        """Of its longest ticks: what is planned to be slower is played at this speed [steps/s]."""
        return self.clock_hz / ((LONGEST_CYCLES + self.more_cycles) << LEVELS)


UNO = StepTimer(clock_hz=16_000_000, finest_cycles=2000, more_cycles=1)
"""That of an ATmega328P."""
SLOWEST_STEPS_PER_S = UNO.slowest_steps_per_s
MOST_STEPS = 4_000_000
"""Further a float32 in steps isn't fine enough for segments of 1.25 steps."""
LONGEST_S = 1e6


def intervals_s(
    steps: int,
    steps_per_mm: float,
    max_rate_mm_per_min: float,
    acceleration_mm_per_s2: float,
    timer: StepTimer = UNO,
) -> NDArray[np.float64]:
    """Return the wait after each step of a move of one axis [s], shape (steps,), with settings $100, $110 and $120.

    steps: 1 to MOST_STEPS. Raises Refused for a move that lasts longer than LONGEST_S, and for one that grbl never
    ends: once 10 ms lead less far than the last place of a float32, it plans for ever.
    """
    if _lasts_s(
        steps, max_rate_mm_per_min / SECONDS_PER_MINUTE * steps_per_mm, acceleration_mm_per_s2 * steps_per_mm
    ) > (LONGEST_S):
        raise Refused(f"Such a move takes grbl longer than {LONGEST_S:,.0f} s: its steps aren't worked out.")
    per_mm = np.float32(steps_per_mm)
    counts, ticks, levels = _segments(
        np.float32(np.float32(steps) / per_mm),
        steps,
        np.float32(max_rate_mm_per_min),
        np.float32(np.float32(acceleration_mm_per_s2) * np.float32(SECONDS_PER_MINUTE**2)),
        (timer.clock_hz, timer.finest_cycles, timer.more_cycles),
    )
    if not counts.size:
        raise Refused("grbl would never end such a move: in 10 ms it goes less far than its numbers can tell apart.")
    until = np.repeat(ticks * np.array(STEPS_IN_TICK)[levels], counts)
    each = np.repeat(ticks << levels, counts)
    return np.append((each - until)[:-1] + until[1:], each[-1:]) / timer.clock_hz


def ticks_of(cycles: int) -> int:
    """Return how long grbl waits for a step [clock cycles] that is to take so many."""
    tick, level = _tick(cycles, UNO.finest_cycles, UNO.more_cycles)
    return int(tick << level)


def _lasts_s(steps: int, speed: float, acceleration: float) -> float:
    """Return how long a trapezoid from rest to rest takes [s]; speed [steps/s], acceleration [steps/s²]."""
    peak = min(speed, math.sqrt(acceleration * steps))
    return steps / peak + peak / acceleration


@compiled
def _tick(cycles, finest, more):  # type: ignore[no-untyped-def]  # compiled
    """Return how long a tick lasts [clock cycles], and how often a step is halved for it."""
    level = 0
    while level < LEVELS and cycles >= finest << level:
        level += 1
    return min(cycles >> level, LONGEST_CYCLES) + more, level


@compiled
def _segments(length, steps, rate, acceleration, timer):  # type: ignore[no-untyped-def]  # compiled
    """Return how many steps each segment has, and their ticks, as `_tick` does; none if it never ends."""
    zero, part_min = np.float32(0), np.float32(1 / (SEGMENTS_PER_S * SECONDS_PER_MINUTE))
    clock_hz, finest, more = timer
    cycles_per_min = np.float32(clock_hz * SECONDS_PER_MINUTE)
    per_mm = np.float32(steps) / length
    least_mm = np.float32(LEAST_STEPS_IN_SEGMENT) / per_mm
    trapezoid = _trapezoid(length, rate, acceleration)
    phase, speed, left = 0, zero, length
    steps_left, rest_min = np.float32(steps), zero
    counts, ticks, levels = [0], [0], [0]
    while left > zero:
        before, lasted, longest, part = left, zero, part_min, part_min
        least = max(before - least_mm, zero)
        while left > zero:
            came, was = left, phase
            phase, left, speed, part = _further(phase, left, speed, part, before, trapezoid)
            # Speeding up may end just where a part begins: then it goes no further either, and on in the next one.
            if was == phase == 1 and left == came and part > np.float32(0.5) * part_min:
                return np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, np.int64)
            lasted += part
            if lasted >= longest:
                if left <= least:
                    break
                longest += part_min
            part = longest - lasted
        in_steps = per_mm * left
        whole, whole_before = np.float32(math.ceil(in_steps)), np.float32(math.ceil(steps_left))
        per_step = (lasted + rest_min) / (whole_before - in_steps)
        counts.append(int(whole_before - whole))
        tick, level = _tick(math.ceil(cycles_per_min * per_step), finest, more)
        ticks.append(tick)
        levels.append(level)
        steps_left = whole
        rest_min = (whole - in_steps) * per_step
    return np.array(counts), np.array(ticks), np.array(levels)


@compiled
def _trapezoid(length, rate, acceleration):  # type: ignore[no-untyped-def]  # compiled
    """Return acceleration, highest speed, and how far from the end speeding up ends and slowing down begins."""
    half, two = np.float32(0.5), np.float32(2)
    middle, slow_after = half * length, half / acceleration * (rate * rate)
    if slow_after >= middle:
        return acceleration, np.float32(math.sqrt(two * acceleration * middle)), middle, middle
    return acceleration, rate, length - slow_after, slow_after


@compiled
def _further(phase, left, speed, part, before, trapezoid):  # type: ignore[no-untyped-def]  # compiled
    """Return phase, distance from the end and speed after a part of a segment, and the time that it took [min].

    phase: 0 speeding up, 1 at speed, 2 slowing down. before: how far the end was when the segment began.
    """
    half, two, zero = np.float32(0.5), np.float32(2), np.float32(0)
    acceleration, fastest, speed_up_until, slow_after = trapezoid
    change = acceleration * part
    if phase == 0:
        left -= part * (speed + half * change)
        if left >= speed_up_until:
            return phase, left, speed + change, part
        # From the segment's beginning, whenever this part began: so grbl does it.
        part = two * (before - speed_up_until) / (speed + fastest)
        return (2 if speed_up_until == slow_after else 1), speed_up_until, fastest, part
    if phase == 1:
        further = left - fastest * part
        if further >= slow_after:
            return phase, further, speed, part
        return 2, slow_after, speed, (left - slow_after) / fastest
    further = left - part * (speed - half * change)
    if speed > change and further > zero:
        return phase, further, speed - change, part
    return phase, zero, zero, two * left / speed
