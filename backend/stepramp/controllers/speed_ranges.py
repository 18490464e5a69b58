"""Why an axis isn't run at a speed, whatever the controller: each family runs from its slowest to its ramp's speed."""

from stepramp.controllers.contract import AxisCommand
from stepramp.errors import Limits, Rejection
from stepramp.numerics.limit_text import at_least, highest, lowest

FIGURES = 10


def too_slow_for(asked: AxisCommand, slowest: float, fastest: float) -> Rejection:
    """Return the rejection of a speed nearer to 0 than the slowest [steps/s]."""
    limits = Limits(lowest(slowest, FIGURES), highest(fastest, FIGURES), "steps/s", note=" either way, or 0")
    return Rejection.outside(asked.field, asked.value, limits)


def too_fast_for(asked: AxisCommand, slowest: float, fastest: float, why: str) -> Rejection:
    """Return the rejection of a speed beyond the fastest [steps/s], and why no faster one is possible."""
    note = f", {why}, and 0 or {at_least(slowest)} steps/s either way"
    most = highest(fastest, FIGURES)
    allowed = f"from {-fastest:,.10g} to {fastest:,.10g} steps/s{note}"
    return Rejection(asked.field, asked.value, allowed, Limits(-most, most, "steps/s", note=note))


def homing_speed_for(asked: AxisCommand, slowest: float, fastest: float, note: str) -> Rejection:
    """Return the rejection of a speed at which an axis isn't homed: 0 is none [steps/s]. note: which way it goes."""
    return Rejection.outside(
        asked.field, asked.value, Limits(lowest(slowest, FIGURES), highest(fastest, FIGURES), "steps/s", note=note)
    )
