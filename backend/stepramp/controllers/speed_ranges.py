"""Why an axis isn't run at a speed, whatever the controller: each family runs from its slowest to its ramp's speed."""

from collections.abc import Callable, Mapping

from stepramp.controllers.contract import AxisCommand
from stepramp.errors import Limits, Rejection
from stepramp.numerics.limit_text import at_least, highest, lowest

FIGURES = 10
HALVINGS = 40
Ahead = Callable[[Mapping[int, float]], Mapping[int, int]]
"""Tells where axes that run at speeds [steps/s] are sent to first, as the controller counts [steps]."""


def too_slow_for(asked: AxisCommand, slowest: float, fastest: float) -> Rejection:
    """Return the rejection of a speed nearer to 0 than the slowest [steps/s]."""
    limits = Limits(lowest(slowest, FIGURES), highest(fastest, FIGURES), "steps/s", note=" either way, or 0")
    return Rejection.outside(asked.field, asked.value, limits)


def too_fast_for(asked: AxisCommand, slowest: float, fastest: float, why: str) -> Rejection:
    """Return the rejection of a speed beyond the fastest [steps/s], and why no faster one is possible."""
    note = f", {why}, and 0 or {at_least(slowest)} steps/s either way"
    most = highest(fastest, FIGURES)
    allowed = f"from {-most:,.10g} to {most:,.10g} steps/s{note}"
    return Rejection(asked.field, asked.value, allowed, Limits(-most, most, "steps/s", note=note))


def homing_speed_for(asked: AxisCommand, slowest: float, fastest: float, note: str) -> Rejection:
    """Return the rejection of a speed at which an axis isn't homed: 0 is none [steps/s]. note: which way it goes."""
    return Rejection.outside(
        asked.field, asked.value, Limits(lowest(slowest, FIGURES), highest(fastest, FIGURES), "steps/s", note=note)
    )


def too_far_for(
    asked: AxisCommand,
    speeds: Mapping[int, float],
    ahead: Ahead,
    can_be_told: Callable[[int], bool],
    furthest: int,
    slowest: float,
    fastest: float,
) -> Rejection:
    """Return the rejection of a speed at which a run would lead to a place that can't be told [steps].

    speeds: of all axes that would run [steps/s]; slowest, fastest: of this one. furthest: up to where all can be told.
    """
    sign = 1 if asked.value > 0 else -1

    def fits(speed: float) -> bool:
        return can_be_told(ahead({**speeds, asked.axis: sign * speed})[asked.axis])

    most = highest(_fastest_that(fits, abs(asked.value)), FIGURES)
    is_possible = most >= slowest
    note = (
        f"or the other way: each place up to {furthest:,} steps from where the controller counts from can be told it "
        "to the step, and this run would lead further. Homed at the machine it counts anew"
    )
    end = sign * most if is_possible else 0.0
    other_end = -sign * highest(fastest, FIGURES)
    limits = Limits(min(end, other_end), max(end, other_end), "steps/s", note=f", {note}")
    this_way = f"no faster than {most:,.10g} steps/s that way" if is_possible else "0"
    return Rejection(asked.field, asked.value, f"{this_way}, {note}", limits)


def _fastest_that(fits: Callable[[float], bool], beyond: float) -> float:
    """Return the highest speed that fits, or a little less, below one that doesn't."""
    low, high = 0.0, beyond
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low
