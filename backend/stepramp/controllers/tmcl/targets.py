"""What is asked of a module's axes, checked against what it can be told."""

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.speed_ranges import too_fast_for, too_slow_for
from stepramp.controllers.tmcl.ramp import TmclRamp
from stepramp.controllers.tmcl.units import Units
from stepramp.errors import Limits, Rejected, Rejection

LOWEST, HIGHEST = -(2**31), 2**31 - 1
"""Positions that a module can count to [steps]."""


def within_32_bits(asked: AxisCommand, position: int) -> int:
    """Return a position [steps]; Rejected when a module can't count so far."""
    _refuse_beyond_32_bits(asked, position, _limits(asked, position, LOWEST, HIGHEST))
    return position


def target_of(asked: AxisCommand, target: int, position: int) -> int:
    """Return a target [steps] that a motor is to go to from a position; Rejected when a module wouldn't go that way."""
    limits = _limits(asked, target, max(LOWEST, position - HIGHEST), min(HIGHEST, position + HIGHEST))
    _refuse_beyond_32_bits(asked, target, limits)
    if abs(target - position) > HIGHEST:
        allowed = f"a way of less than 2,147,483,648 steps from {position:,}: a module goes the shorter way round"
        raise Rejected([Rejection(asked.field, int(asked.value), allowed, limits)])
    return target


def speed_of(asked: AxisCommand, ramp: TmclRamp, units: Units) -> int:
    """Return a speed with sign in the module's units; Rejected when the ramp in use doesn't lead to it."""
    speed = units.speed_units(asked.value)
    fastest, slowest = float(ramp.vmax * units.speed), float(units.speed)
    if asked.value and not speed:
        raise Rejected([too_slow_for(asked, slowest, fastest)])
    if abs(speed) > ramp.vmax:
        raise Rejected([too_fast_for(asked, slowest, fastest, "the full speed of the ramp in use")])
    return speed


def _refuse_beyond_32_bits(asked: AxisCommand, position: int, limits: Limits) -> None:
    if not LOWEST <= position <= HIGHEST:
        allowed = "a target from -2,147,483,648 to 2,147,483,647 steps"
        raise Rejected([Rejection(asked.field, int(asked.value), allowed, limits)])


def _limits(asked: AxisCommand, target: int, low: int, high: int) -> Limits:
    """Return limits of a target [steps] as those of what is asked for, which may be a distance to it."""
    origin = target - int(asked.value)
    return Limits(low - origin, high - origin, "steps", is_whole=True)
