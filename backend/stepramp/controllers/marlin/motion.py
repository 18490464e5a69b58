"""The steps that Marlin 2.1 really makes of a move: planned in whole steps a second, and timed anew after each step.

It plans a trapezoid from rest to rest: whole numbers of steps to speed up and to slow down, between a whole slowest and
a whole highest rate. Its step interrupt then works out after each step how fast it is to be by the time since the move
began, or since it began to slow down, in ticks of the step timer and with an acceleration in 2⁻²⁴ of a step/s each
tick; a step waits for as many whole ticks as that rate takes, and one more, since the timer counts from 0.

This is Marlin without S_CURVE_ACCELERATION, CLASSIC_JERK, ADAPTIVE_STEP_SMOOTHING and input shaping, on a 32-bit board
whose step timer ticks at 2 MHz, with one step for each interrupt.

Source: how Marlin 2.1.2 works, as its planner and stepper modules say.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.errors import Refused
from stepramp.numerics.compiled import compiled

TICKS_PER_S = 2_000_000
"""Of the step timer."""
SLOWEST_STEPS_PER_S = 120
"""It plans no rate below this at the ends of a move."""
LEAST_SPEED = 0.05
"""Nor a speed below this [mm/s]."""
MOST_STEPS = 4_000_000
LONGEST_S = 2000
"""After 2³² ticks the time that a move has lasted begins anew [s]."""
FEED_OVER_SPEED = 2
"""So many times an axis' highest speed a move is told as its feed, so that nothing but that limits it."""


@dataclass(frozen=True)
class Block:
    """A move of one axis as it is planned: rates in steps/s, places in steps from its beginning."""

    nominal_rate: int
    ends_rate: int
    """That it begins and ends with."""
    acceleration: int
    """[steps/s²]"""
    speeds_up_until: int
    slows_down_after: int

    @classmethod
    def of(cls, steps: int, steps_per_mm: float, speed_mm_per_s: float, acceleration_mm_per_s2: float) -> "Block":
        """Return the plan of a move, with settings M92, M203 and M201; Refused for one without an acceleration."""
        one, scale, speed = np.float32(1), np.float32(steps_per_mm), np.float32(speed_mm_per_s)
        length = np.float32(steps) * (one / scale)
        per_s = one / length * (speed * np.float32(FEED_OVER_SPEED))
        fed = length * per_s
        factor = min(one, speed / fed)
        nominal = int(np.float32(math.ceil(np.float32(steps) * per_s)) * factor)
        acceleration = int(np.float32(acceleration_mm_per_s2) * scale)
        if acceleration < 1 or nominal < 1:
            raise Refused(
                "Marlin plans no such move: its speed or its acceleration would be less than 1 step/s, or /s²."
            )
        least = math.ceil(np.float32(nominal) * (np.float32(LEAST_SPEED) / (fed * factor)))
        ends = max(SLOWEST_STEPS_PER_S, least)
        ramp = np.float32(0.5) / np.float32(acceleration) * (np.float32(nominal) ** 2 - np.float32(ends) ** 2)
        up, down = max(0, math.ceil(ramp)), max(0, math.floor(ramp))
        if up + down > steps:
            # As it works the middle out: the ramps are of the same length, so that is half of the way.
            up = min(max(0, math.ceil(np.float32(steps) * np.float32(0.5))), steps)
            down = steps - up
        return cls(nominal, ends, acceleration, up, steps - down)

    def lasts_s(self, steps: int) -> float:
        """Return about how long the move takes [s]."""
        peak = min(float(self.nominal_rate), math.sqrt(self.ends_rate**2 + self.acceleration * steps))
        return steps / peak + peak / self.acceleration


def intervals_s(
    steps: int, steps_per_mm: float, speed_mm_per_s: float, acceleration_mm_per_s2: float
) -> NDArray[np.float64]:
    """Return the wait after each step of a move of one axis [s], shape (steps,); steps: 1 to MOST_STEPS.

    Raises Refused for a move that lasts longer than LONGEST_S, or has no acceleration.
    """
    block = Block.of(steps, steps_per_mm, speed_mm_per_s, acceleration_mm_per_s2)
    if block.lasts_s(steps) > LONGEST_S:
        raise Refused(f"Such a move takes Marlin longer than {LONGEST_S:,} s: its steps aren't worked out.")
    per_tick = int(np.float32(block.acceleration) * np.float32(2**24 / TICKS_PER_S))
    ticks: NDArray[np.int64] = _ticks(
        steps, block.nominal_rate, block.ends_rate, per_tick, block.speeds_up_until, block.slows_down_after
    )
    return ticks / TICKS_PER_S


@compiled
def _ticks(steps, nominal, ends, per_tick, until, after):  # type: ignore[no-untyped-def]  # compiled
    """Return the ticks after each step; per_tick: the acceleration [2⁻²⁴ steps/s each tick]."""
    half = 1 << 23
    waits = np.zeros(steps, np.int64)
    up_ticks, down_ticks, rate = TICKS_PER_S // ends, 0, ends
    for made in range(1, steps + 1):
        if made <= until:
            rate = min(ends + ((up_ticks * per_tick + half) >> 24), nominal)
            wait = TICKS_PER_S // rate
            up_ticks += wait
        elif made > after:
            lost = (down_ticks * per_tick + half) >> 24
            wait = TICKS_PER_S // max(rate - lost, ends)
            down_ticks += wait
        else:
            wait = TICKS_PER_S // nominal
        waits[made - 1] = wait + 1
    return waits
