"""A jog of a grbl: one line that moves axes straight to places, whatever units and offsets it works with otherwise."""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import partial

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.grbl.numbers import MOST_DIGITS, below, exact, read, target
from stepramp.controllers.grbl.ramp import LEAST_RATE
from stepramp.controllers.grbl.settings import LETTERS, AxisSettings, rate_of, speed_of
from stepramp.controllers.speed_ranges import Ahead, too_far_for, too_fast_for, too_slow_for
from stepramp.errors import Limits, Rejected, Rejection

FINE = 1e-6
"""By so much of it a feed that several axes have together is lowered, for what its root was rounded to."""


def jog_line(
    targets: Mapping[int, int], scales: Sequence[AxisSettings], feed: str, asked: Sequence[AxisCommand]
) -> str:
    """Return the line that has axes jog to places, as the controller counts [steps], at a feed [mm/min].

    asked: what rejections name. Raises Rejected for a place that grbl can't be told to the step.
    """
    words = {axis: target(place, scales[axis].steps_per_mm) for axis, place in targets.items()}
    fields = {each.axis: each for each in asked}
    bad = [_too_far(fields[axis], targets[axis], scales[axis]) for axis, word in words.items() if word is None]
    if bad:
        raise Rejected(bad)
    return "$J=G53G21G90" + "".join(f"{LETTERS[axis]}{word}" for axis, word in words.items()) + f"F{feed}"


def fastest_feed(axes: Sequence[int], scales: Sequence[AxisSettings]) -> str:
    """Return a feed at which nothing but the axes' own highest rates limits them [mm/min]."""
    feed = math.ceil(math.hypot(*(float(scales[axis].most_rate) for axis in axes)))
    return str(min(feed, 10**MOST_DIGITS - 1))


def feed_of(speeds: Mapping[int, float], scales: Sequence[AxisSettings]) -> str:
    """Return the feed of axes that run at speeds [steps/s], rounded down [mm/min]."""
    rates = [rate_of(Fraction(abs(speed)), scales[axis].most_steps_per_mm) for axis, speed in speeds.items()]
    both = rates[0] if len(rates) == 1 else Fraction(math.hypot(*map(float, rates)) * (1 - FINE))
    return below(max(both, Fraction(LEAST_RATE)), lambda text: exact(read(text)))


def refuse_speeds(asked: Sequence[AxisCommand], scales: Sequence[AxisSettings], slowest_steps_per_s: float) -> None:
    """Reject speeds beyond an axis' highest rate, and those nearer to 0 than the slowest that the firmware makes."""
    bad = []
    for each in asked:
        scale = scales[each.axis]
        fastest, slowest = scale.speed_steps_per_s, slowest_of(scale, slowest_steps_per_s)
        if abs(Fraction(each.value)) > speed_of(scale.most_rate, scale.steps_per_mm):
            bad.append(too_fast_for(each, slowest, fastest, "the highest rate of the axis"))
        elif each.value and abs(each.value) < slowest:
            bad.append(too_slow_for(each, slowest, fastest))
    if bad:
        raise Rejected(bad)


def slowest_of(scale: AxisSettings, slowest_steps_per_s: float) -> float:
    """Return the speed nearest to 0 that an axis runs at, where the firmware makes none nearer to it [steps/s]."""
    return max(slowest_steps_per_s, float(LEAST_RATE * exact(scale.steps_per_mm) / 60))


def refuse_runs_too_far(
    asked: Sequence[AxisCommand],
    speeds: Mapping[int, float],
    ahead: Ahead,
    scales: Sequence[AxisSettings],
    slowest_steps_per_s: float,
) -> None:
    """Reject speeds of axes that run [steps/s] by which one is sent to a place that grbl can't be told to the step."""
    fields, bad = {each.axis: each for each in asked}, []
    for axis, place in ahead(speeds).items():
        scale = scales[axis]
        can_be_told = partial(_can_be_told, scale)
        if can_be_told(place):
            continue
        named = fields.get(axis) or AxisCommand(axis, speeds[axis], "")
        slowest = slowest_of(scale, slowest_steps_per_s)
        found = too_far_for(named, speeds, ahead, can_be_told, furthest(scale), slowest, scale.speed_steps_per_s)
        if axis not in fields:
            # None of those that are asked for now names it.
            allowed = f"with axis {axis}, which runs already, at {found.allowed}"
            found = Rejection(asked[0].field, asked[0].value, allowed)
        bad.append(found)
    if bad:
        raise Rejected(bad)


def _can_be_told(scale: AxisSettings, place: int) -> bool:
    return target(place, scale.steps_per_mm) is not None


def _too_far(asked: AxisCommand, place: int, scale: AxisSettings) -> Rejection:
    """Return the rejection of a place that no number of eight digits tells to the step."""
    most = furthest(scale)
    origin = place - int(asked.value)
    limits = Limits(-most - origin, most - origin, "steps", is_whole=True)
    allowed = (
        f"a place up to {most:,} steps from where the controller counts from, at {float(scale.steps_per_mm):,.7g} "
        "steps/mm: it reads eight digits of mm as float32, which tell no step further away"
    )
    return Rejection(asked.field, int(asked.value), allowed, limits)


def furthest(scale: AxisSettings) -> int:
    """Return up to where each place can be told to the step, or a little less [steps]."""
    low, high = 1, 2**31
    while high - low > 1:
        middle = (low + high) // 2
        is_told = all(target(place, scale.steps_per_mm) for place in range(middle, middle + 8))
        low, high = (middle, high) if is_told else (low, middle)
    return low
