"""The two sides of a design's ramp: the one place that makes them."""

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

from stepramp.design import MOST_STEPS, Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import lowest
from stepramp.numerics.slope import Slope
from stepramp.shapes import SHAPES
from stepramp.shapes.constant import ConstantAcceleration
from stepramp.shapes.s_curve import SCurve

SIDES = ("acceleration_steps_per_s2", "deceleration_steps_per_s2")
"""The fields of the ramp that say how steep its ramp up and its ramp down are."""
JERKS = ("jerk_steps_per_s3", "deceleration_jerk_steps_per_s3")
"""The fields of the shape that limit their jerk."""

KEPT = 64
"""So many slopes are kept for the next question about them."""


def slopes_of(design: Design) -> tuple[Slope, Slope]:
    """Return the ramp up and the ramp down of a design's ramp, as its move is planned.

    With the plan `this_move`, a move too short for the slew speed has slopes to a lower peak that are together as long
    as the move, unless they would only be the beginning of those to the slew speed.
    """
    slopes, peak = full_slopes_of(design), peak_of(design)
    return slopes if peak is None else lowered(slopes, peak)


def full_slopes_of(design: Design) -> tuple[Slope, Slope]:
    """Return the ramp up and the ramp down of a design's ramp between its base and its slew speed."""
    ramp, shape = design.ramp, SHAPES[design.ramp.shape.name]
    speeds = design.timer.frequency_hz, ramp.base_speed_steps_per_s, ramp.slew_speed_steps_per_s
    up = _slope(shape, *speeds, ramp.acceleration_steps_per_s2, ramp.shape.parameters(is_down=False))
    return up, _slope(shape, *speeds, ramp.slowdown_steps_per_s2, ramp.shape.parameters(is_down=True))


def peak_of(design: Design) -> float | None:
    """Return the lower speed to which a short move is planned by itself [steps/s]; None: the slew speed."""
    if design.move.plan == "any_move" or design.method.plays_table:
        return None
    return _peak(*full_slopes_of(design), abs(design.move.steps))


def lowered(slopes: tuple[Slope, Slope], peak_speed: float) -> tuple[Slope, Slope]:
    """Return slopes to a lower speed [steps/s]."""
    up, down = slopes
    lower = up.lowered(peak_speed)
    return lower, lower if down is up else down.lowered(peak_speed)


def constant_slopes_of(design: Design) -> tuple[ConstantAcceleration, ConstantAcceleration] | None:
    """Return the same for what holds for constant acceleration only; None when the ramp has another shape."""
    up, down = full_slopes_of(design)
    if isinstance(up, ConstantAcceleration) and isinstance(down, ConstantAcceleration):
        return up, down
    return None


def playable_slopes_of(design: Design) -> tuple[Slope, Slope]:
    """Return both slopes. Raises Rejected for a ramp that no move could play, before its arrays are made."""
    slopes = slopes_of(design)
    for field, slope in zip(SIDES, slopes, strict=True):
        if slope.length > MOST_STEPS:
            why = f" between these speeds, for a ramp of at most {MOST_STEPS:,} steps"
            raise too_long(design, field, MOST_STEPS, why)
    return slopes


def too_long(design: Design, field: str, most_steps: int, why: str) -> Rejected:
    """Return that a side, named by its field, takes more steps than are allowed, and how steep it would have to be.

    Where no acceleration would do, it is the jerk that is too low; where neither alone does, both are.
    """
    side = SIDES.index(field)
    slope = full_slopes_of(design)[side]
    if not isinstance(slope, SCurve) or math.isfinite(slope.acceleration_over(most_steps)):
        return Rejected([_too_gentle(design, field, slope.acceleration_over(most_steps), why)])
    jerk = lowest(slope.jerk_over(most_steps))
    limits = Limits(lowest=jerk, unit="steps/s³", note=why)
    given = getattr(design.ramp.shape, JERKS[side])
    rejections = [Rejection.outside(f"ramp.shape.{JERKS[side]}", given, limits)]
    quicker = replace(slope, parameters=replace(slope.parameters, jerk=jerk))
    if quicker.length > most_steps:
        rejections.append(_too_gentle(design, field, quicker.acceleration_over(most_steps), why))
    return Rejected(rejections)


def _too_gentle(design: Design, field: str, least: float, why: str) -> Rejection:
    limits = Limits(lowest=lowest(least), unit="steps/s²", note=why)
    return Rejection.outside(f"ramp.{field}", getattr(design.ramp, field), limits)


@lru_cache(maxsize=KEPT)
def _slope(shape: type[Slope], *values: Any) -> Slope:
    """Return a slope; the same one for the same values, with all that it has found out about itself."""
    return shape(*values)


@lru_cache(maxsize=KEPT)
def _peak(up: Slope, down: Slope, steps: int) -> float | None:
    if (up.begins_alike and down.begins_alike) or up.length + down.length <= steps:
        return None
    low, high = up.base_speed, up.slew_speed
    while low < (middle := (low + high) / 2) < high:
        is_short = sum(slope.length for slope in lowered((up, down), middle)) <= steps
        low, high = (middle, high) if is_short else (low, middle)
    return low
