"""What is asked of a Tic's axis, checked against what a Tic can be told."""

from collections.abc import Sequence

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.speed_ranges import too_fast_for, too_slow_for
from stepramp.controllers.tic.ramp import LEAST_SPEED, TicRamp, speed_units, steps_per_s
from stepramp.errors import Limits, Rejected, Rejection

ONE_AXIS = "0: a Tic has one axis"
LOWEST, HIGHEST = -(2**31), 2**31 - 1
"""Positions that a Tic can count to [steps]."""


def of_the_axis(asked: Sequence[AxisCommand]) -> AxisCommand:
    """Return what is asked of the only axis; Rejected when another one is named, or one twice."""
    for number, each in enumerate(asked):
        if each.axis or number:
            beside = each.field.rpartition(".")[0] + ".axis" if "." in each.field else "axis"
            field = each.field if each.field == "axes" else beside
            raise Rejected([Rejection(field, each.axis, "each axis once" if not each.axis else ONE_AXIS)])
    return asked[0]


def within_32_bits(asked: AxisCommand, position: int) -> int:
    """Return a position [steps]; Rejected when a Tic can't count so far."""
    _refuse_beyond_32_bits(asked, position, _limits(asked, position, LOWEST, HIGHEST))
    return position


def target_of(asked: AxisCommand, target: int, position: int) -> int:
    """Return a target [steps] that a motor is to go to from a position; Rejected when a Tic wouldn't go that way."""
    limits = _limits(asked, target, max(LOWEST, position - HIGHEST), min(HIGHEST, position + HIGHEST))
    _refuse_beyond_32_bits(asked, target, limits)
    if abs(target - position) > HIGHEST:
        allowed = f"a way of less than 2,147,483,648 steps from {position:,}: a Tic goes the shorter way round"
        raise Rejected([Rejection(asked.field, int(asked.value), allowed, limits)])
    return target


def _refuse_beyond_32_bits(asked: AxisCommand, position: int, limits: Limits) -> None:
    if not LOWEST <= position <= HIGHEST:
        allowed = "a target from -2,147,483,648 to 2,147,483,647 steps"
        raise Rejected([Rejection(asked.field, int(asked.value), allowed, limits)])


def velocity_of(asked: AxisCommand, ramp: TicRamp) -> int:
    """Return a speed in the Tic's units; Rejected when the ramp in use doesn't lead to it."""
    units = speed_units(asked.value)
    fastest, slowest = steps_per_s(ramp.max_speed), steps_per_s(LEAST_SPEED)
    if asked.value and abs(units) < LEAST_SPEED:
        raise Rejected([too_slow_for(asked, slowest, fastest)])
    if abs(units) > ramp.max_speed:
        raise Rejected([too_fast_for(asked, slowest, fastest, "the full speed of the ramp in use")])
    return units


def _limits(asked: AxisCommand, target: int, low: int, high: int) -> Limits:
    """Return limits of a target [steps] as those of what is asked for, which may be a distance to it."""
    origin = target - int(asked.value)
    return Limits(low - origin, high - origin, "steps", is_whole=True)
