"""A second planner, in closed forms: which steps grbl's documented algorithm puts into which segment, and how fast.

A trapezoid from rest to rest is a function of time. grbl looks at it every 10 ms, or as many times 10 ms later as it
takes to come 1.25 steps further; the steps in between get even intervals. Everything here is in float64 and steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

CLOCK_HZ = 16_000_000


@dataclass(frozen=True)
class Trapezoid:
    """From rest to rest [steps, s]."""

    steps: int
    speed: float
    acceleration: float

    @property
    def peak(self) -> float:
        return min(self.speed, math.sqrt(self.acceleration * self.steps))

    @property
    def lasts_s(self) -> float:
        return self.steps / self.peak + self.peak / self.acceleration

    def left(self, time_s: float) -> float:
        """Return how far the end still is."""
        if time_s >= self.lasts_s:
            return 0.0
        ramp_s = self.peak / self.acceleration
        if time_s <= ramp_s:
            return self.steps - self.acceleration * time_s**2 / 2
        if time_s >= self.lasts_s - ramp_s:
            return self.acceleration * (self.lasts_s - time_s) ** 2 / 2
        return self.steps - self.peak * (time_s - ramp_s / 2)


def timer_ticks(cycles: int) -> tuple[int, int]:
    """Return how often the timer ticks a step of so many cycles, and how long: it counts from 0, up to 16 bits."""
    ticks = 1 if cycles < 2000 else 2 if cycles < 4000 else 4 if cycles < 8000 else 8
    return ticks, min(cycles // ticks, 65_535) + 1


def timer_cycles(cycles: int) -> int:
    """Return what the timer makes of a wished interval."""
    ticks, each = timer_ticks(cycles)
    return ticks * each


def segments(move: Trapezoid) -> list[tuple[int, int]]:
    """Return steps, and the clock cycles that each is to take, for each segment.

    Where speeding up ends within a part of 10 ms that a segment was made longer by, grbl takes the way from the whole
    segment's beginning for that of the part, and so is late from then on.
    """
    found: list[tuple[int, int]] = []
    ramp_s = move.peak / move.acceleration
    begun_s, left, rest_s, late_s = 0.0, float(move.steps), 0.0, 0.0
    while left > 0:
        wanted = max(left - 1.25, 0.0)
        part_s, end_s, after = begun_s, begun_s, left
        while after > wanted:
            part_s += 0.01
            if begun_s < end_s < ramp_s + late_s <= part_s:
                late_s += 2 * (left - after) / (move.acceleration * (end_s - late_s) + move.peak)
                end_s = max(part_s, ramp_s + late_s)
            else:
                end_s = part_s
            after = move.left(end_s - late_s)
        end_s = min(end_s, move.lasts_s + late_s)
        whole_before, whole = math.ceil(left), math.ceil(after)
        per_step_s = (end_s - begun_s + rest_s) / (whole_before - after)
        found.append((whole_before - whole, math.ceil(per_step_s * CLOCK_HZ)))
        rest_s = (whole - after) * per_step_s
        begun_s, left = end_s, after
    return found


def instants_s(move: Trapezoid) -> list[float]:
    """Return when each step is made [s]: tick by tick, by a counter of eighths, at four to begin with."""
    now, eighths, made = 0, 4, []
    for count, wished in segments(move):
        ticks, cycles = timer_ticks(wished)
        for _ in range(count * ticks):
            now += cycles
            eighths += 8 // ticks
            if eighths > 8:
                eighths -= 8
                made.append(now / CLOCK_HZ)
    return made
