"""The two sides of a design's ramp: the one place that makes them."""

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from stepramp.design import MOST_ACCELERATION, MOST_STEPS, Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import highest, lowest
from stepramp.numerics.slope import Slope
from stepramp.shapes import SHAPES
from stepramp.shapes.constant import ConstantAcceleration
from stepramp.shapes.s_curve import SCurve
from stepramp.shapes.torque import PLACES, TorqueShaped

SIDES = ("acceleration_steps_per_s2", "deceleration_steps_per_s2")
"""The fields of the ramp that say how steep its ramp up and its ramp down are."""
JERKS = ("jerk_steps_per_s3", "deceleration_jerk_steps_per_s3")
"""The fields of the shape that limit their jerk."""

LITTLE_MORE = 1e-9
"""Of the part of the torque that just holds the load."""
CLOSE = 1e-4
"""Of the speed at which no torque is left: so close to it the highest one is told."""

LAST_BITS = 4e-15
"""Of a speed: nobody can tell them."""

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
    train = design.drive_train if "margin" in shape.takes else None
    own_up, own_down = (ramp.shape.parameters(train, is_down=is_down) for is_down in (False, True))
    up = _slope(shape, *speeds, ramp.acceleration_steps_per_s2, own_up)
    return up, _slope(shape, *speeds, ramp.slowdown_steps_per_s2, own_down)


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
    _refuse_without_torque(design, slopes[0])
    for field, slope in zip(SIDES, slopes, strict=True):
        if slope.length > MOST_STEPS:
            why = f" between these speeds, for a ramp of at most {MOST_STEPS:,} steps"
            raise too_long(design, field, MOST_STEPS, why)
    return slopes


def _refuse_without_torque(design: Design, slope: Slope) -> None:
    """Refuse a slew speed at which the motor has no torque left to accelerate with."""
    if not isinstance(slope, TorqueShaped):
        return
    speeds = np.linspace(slope.base_speed, slope.slew_speed, PLACES)
    without = np.flatnonzero(slope.possible(speeds) <= 0)
    if without.size == 0:
        return
    margin = design.ramp.shape.margin or 1.0
    note = f": beyond that {margin:.0%} of the motor's torque doesn't move this load"
    if without[0] == 0 and slope.possible(np.zeros(1))[0] > 0:
        # Below the base speed there is torque.
        fastest = highest(_last_with_torque(slope, 0.0, slope.base_speed), 4)
        limits = Limits(0, fastest, "steps/s", note=note)
        raise Rejected([Rejection.outside("ramp.base_speed_steps_per_s", slope.base_speed, limits)])
    if without[0] == 0:
        train = slope.parameters.drive_train
        has_nm = float(train.pull_out_nm(speeds[:1] * train.radians_per_step)[0]) if train else 0.0
        # What only holds the load moves nothing: a little more does.
        least = lowest(train.holding_back_nm / has_nm * (1 + LITTLE_MORE)) if train and has_nm > 0 else math.inf
        limits = Limits(lowest=least, highest=1, unit="of the motor's torque", note=" to move this load at all")
        if margin < least <= 1:
            raise Rejected([Rejection.outside("ramp.shape.margin", margin, limits)])
        allowed = "a motor, a drive or a load with which there is torque left: load and friction take all of it"
        raise Rejected([Rejection("load", design.load and design.load.model_dump(), allowed)])
    fastest = max(highest(_last_with_torque(slope, *speeds[without[0] - 1 : without[0] + 1]), 4), slope.base_speed)
    limits = Limits(highest=fastest, unit="steps/s", note=note)
    raise Rejected([Rejection.outside("ramp.slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s, limits)])


def _last_with_torque(slope: TorqueShaped, low: float, high: float) -> float:
    """Return the highest speed, to a part of itself, at which torque is left, between one with and one without it."""
    while high - low > CLOSE * high:
        middle = (low + high) / 2
        low, high = (middle, high) if slope.possible(np.array([middle]))[0] > 0 else (low, middle)
    return low


def too_long(design: Design, field: str, most_steps: int, why: str) -> Rejected:
    """Return that a side, named by its field, takes more steps than are allowed, and how steep it would have to be.

    Where no acceleration would do, it is the jerk that is too low; where neither alone does, both are. Of a ramp shaped
    by torque it is the slew speed that is too high.
    """
    side = SIDES.index(field)
    slope = full_slopes_of(design)[side]
    if isinstance(slope, TorqueShaped) and replace(slope, acceleration=MOST_ACCELERATION).length > most_steps:
        fastest = highest(float(slope.speeds(most_steps, 1, np.float64)[0]), 4)
        limits = Limits(highest=fastest, unit="steps/s", note=f"{why}, with this motor's torque")
        return Rejected([Rejection.outside("ramp.slew_speed_steps_per_s", slope.slew_speed, limits)])
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
    # A deceleration that isn't given is the acceleration.
    given = field if getattr(design.ramp, field) is not None else SIDES[0]
    return Rejection.outside(f"ramp.{given}", getattr(design.ramp, given), limits)


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
    # Sides that are whole to the last bits must not lose a step by them.
    rounded = min(low * (1 + LAST_BITS), up.slew_speed)
    counts = [sum(slope.steps for slope in lowered((up, down), peak)) for peak in (low, rounded)]
    return rounded if counts[0] < counts[1] <= steps else low
