"""Ramps that the machine plays."""

import itertools
import math

from firmware.motion import FAST_HZ, SLOW_HZ, StoredRamp


def slope(slew_speed: float, acceleration: float, hz: int = SLOW_HZ) -> tuple[int, ...]:
    """Return intervals from rest to a speed by formula (9) [ticks]."""
    steps = int(slew_speed**2 / (2 * acceleration))
    return tuple(round(hz / math.sqrt(2 * acceleration * i)) for i in range(1, steps + 1))


def coarse_slope(slew_speed: float, acceleration: float, segments: int) -> tuple[int, ...]:
    """Return intervals from rest to a speed that never rise, in so many segments of as many steps [fast ticks]."""
    steps = int(slew_speed**2 / (2 * acceleration)) // segments
    firsts = [FAST_HZ / math.sqrt(2 * acceleration * max(steps * i, 1)) for i in range(segments + 1)]
    falls = [int((first - after) / steps) for first, after in itertools.pairwise(firsts)]
    return tuple(int(first) - fall * i for first, fall in zip(firsts, falls, strict=False) for i in range(steps))


def ramp_of(slew_speed: float, acceleration: float, deceleration: float, hz: int = SLOW_HZ) -> StoredRamp:
    return StoredRamp(slope(slew_speed, acceleration, hz), round(hz / slew_speed), slope(slew_speed, deceleration, hz))


QUICK = ramp_of(1000, 50_000, 20_000)
SHARP = ramp_of(2000, 60_000, 100_000)
RAMPS = (QUICK, SHARP, StoredRamp((), 2000, ()), StoredRamp((4000, 3000), 2000, ()))


LONG = StoredRamp(coarse_slope(20_000, 100_000, 40), 800, coarse_slope(20_000, 100_000, 40))
"""2000 steps up and as many down, in 0.2 s each."""
