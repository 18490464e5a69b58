"""A way of a Marlin's axes as it is told: one line, at a feed, and what of it can't be told."""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.given_numbers import rounded_down
from stepramp.controllers.marlin.dialect import MOTION
from stepramp.controllers.marlin.motion import FEED_OVER_SPEED
from stepramp.controllers.marlin.settings import AxisSettings
from stepramp.controllers.speed_ranges import Ahead, too_far_for, too_fast_for, too_slow_for
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.units import SECONDS_PER_MINUTE

FURTHEST = 2**22
"""Up to so many steps from where it counts from, float32 tells each from the next, also after what adds up."""
SLOWEST_STEPS_PER_S = 1.0
FEED_DECIMALS = 3


def way_line(ways: Mapping[str, str], feed: str) -> str:
    """Return the line that has axes go so many mm, by letter, at a feed [mm/min]."""
    return MOTION + "".join(f"{letter}{way} " for letter, way in ways.items()) + f"F{feed}"


def fastest_feed(axes: Sequence[int], scales: Sequence[AxisSettings]) -> str:
    """Return a feed at which nothing but the axes' own highest speeds limits them [mm/min]."""
    highest = math.hypot(*(float(scales[axis].speed) for axis in axes))
    return str(math.ceil(highest * SECONDS_PER_MINUTE) * FEED_OVER_SPEED)


def feed_of(speeds: Mapping[int, float], scales: Sequence[AxisSettings]) -> str:
    """Return the feed of axes that run at speeds [steps/s], rounded down [mm/min]."""
    along = math.hypot(*(abs(speed) / float(scales[axis].most_steps_per_mm) for axis, speed in speeds.items()))
    return rounded_down(Fraction(along) * SECONDS_PER_MINUTE, FEED_DECIMALS)


def can_be_told(place: int) -> bool:
    """Whether a place, as Marlin counts, can be told it to the step [steps]."""
    return abs(place) <= FURTHEST


def refuse_places(asked: Sequence[AxisCommand], targets: Mapping[int, int]) -> None:
    """Reject places [steps], as the controller counts, that it can't be told to the step."""
    bad = []
    for each in asked:
        target = targets[each.axis]
        if can_be_told(target):
            continue
        origin = target - int(each.value)
        limits = Limits(-FURTHEST - origin, FURTHEST - origin, "steps", is_whole=True)
        allowed = f"a place up to {FURTHEST:,} steps from where Marlin counts from: it keeps lengths as float32"
        bad.append(Rejection(each.field, int(each.value), allowed, limits))
    if bad:
        raise Rejected(bad)


def refuse_runs_too_far(
    asked: Sequence[AxisCommand], speeds: Mapping[int, float], ahead: Ahead, scales: Sequence[AxisSettings]
) -> None:
    """Reject speeds of axes that run [steps/s] by which one is sent to a place that it can't be told to the step.

    Those asked are all that run: a run sets out from rest, and no axis joins one, nor changes its speed.
    """
    targets = ahead(speeds)
    bad = [
        too_far_for(
            each, speeds, ahead, can_be_told, FURTHEST, SLOWEST_STEPS_PER_S, scales[each.axis].speed_steps_per_s
        )
        for each in asked
        if not can_be_told(targets.get(each.axis, 0))
    ]
    if bad:
        raise Rejected(bad)


def refuse_speeds(asked: Sequence[AxisCommand], scales: Sequence[AxisSettings]) -> None:
    """Reject speeds beyond an axis' highest one, and those nearer to 0 than a step a second."""
    bad = []
    for each in asked:
        fastest = scales[each.axis].speed_steps_per_s
        if abs(each.value) > fastest:
            bad.append(too_fast_for(each, SLOWEST_STEPS_PER_S, fastest, "the highest speed of the axis"))
        elif each.value and abs(each.value) < SLOWEST_STEPS_PER_S:
            bad.append(too_slow_for(each, SLOWEST_STEPS_PER_S, fastest))
    if bad:
        raise Rejected(bad)
