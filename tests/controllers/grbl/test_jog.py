"""Jogs: what is said of runs that lead further than grbl can be told."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import count

import pytest

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.grbl.jog import furthest, refuse_runs_too_far, refuse_speeds
from stepramp.controllers.grbl.numbers import target
from stepramp.controllers.grbl.settings import Settings
from stepramp.errors import Rejected, Rejection


def test_a_run_that_takes_another_axis_too_far_is_refused_by_its_own_value() -> None:
    """Axis 0 runs already, and what is asked of axis 1 begins a jog of both."""
    scales = [
        axis for number in (0, 1) if (axis := Settings({number + at: "250" for at in (100, 110, 120)}).axis(number))
    ]
    beyond = furthest(scales[0])
    beyond = next(place for place in range(beyond, 2 * beyond) if target(place, scales[0].steps_per_mm) is None)
    start = [beyond - 3000, 0]

    def ahead(speeds: dict[int, float]) -> dict[int, int]:
        return {axis: start[axis] + round(speed * 3) for axis, speed in speeds.items()}

    def rejection_of(asked: list[AxisCommand], speeds: dict[int, float]) -> tuple[str, object, str]:
        with pytest.raises(Rejected) as caught:
            refuse_runs_too_far(asked, speeds, ahead, scales, 0.0)
        [found] = caught.value.rejections
        assert (found.limits is None) is (0 not in [each.axis for each in asked])
        return found.field, found.value, found.allowed

    own = rejection_of([AxisCommand(0, 1000.0, "axes.0.speed_steps_per_s")], {0: 1000.0})
    assert own[:2] == ("axes.0.speed_steps_per_s", 1000.0)
    field, value, allowed = rejection_of([AxisCommand(1, 100.0, "axes.0.speed_steps_per_s")], {0: 1000.0, 1: 100.0})
    assert (field, value) == ("axes.0.speed_steps_per_s", 100.0)
    assert allowed == f"with axis 0, which runs already, at {own[2]}"


@pytest.mark.parametrize("rate", [499.0, 500.0, 700.0, 1000.0])
@pytest.mark.parametrize("steps_per_mm", ["320", "250", "80.3", "26.667"])
def test_the_speeds_that_a_refusal_names_are_not_refused(steps_per_mm: str, rate: float) -> None:
    """As 500 mm/min of 320 steps/mm, 2,666.666… steps/s: rounded to the nearest it would be too fast."""
    scale = Settings({100: steps_per_mm, 110: str(rate), 120: "250"}).axis(0)
    assert scale is not None

    def refused(speed: float) -> Rejection:
        with pytest.raises(Rejected) as caught:
            refuse_speeds([AxisCommand(0, speed, "speed")], [scale], 0.0)
        [found] = caught.value.rejections
        return found

    def refused_too_far(speed: float) -> Rejection:
        def ahead(speeds: Mapping[int, float]) -> dict[int, int]:
            return {axis: untold if each == speed else 0 for axis, each in speeds.items()}

        untold = next(place for place in count(10**7) if target(place, scale.steps_per_mm) is None)
        with pytest.raises(Rejected) as caught:
            refuse_runs_too_far([AxisCommand(0, speed, "speed")], {0: speed}, ahead, [scale], 0.0)
        [found] = caught.value.rejections
        return found

    too_fast = refused(1e6)
    named = [float(each.replace(",", "")) for each in re.findall(r"-?[\d,]+\.?\d*", too_fast.allowed)[:2]]
    for told in (too_fast, refused_too_far(100.0), refused_too_far(-100.0)):
        assert told.limits is not None
        for speed in (told.limits.lowest, told.limits.highest, *named):
            refuse_speeds([AxisCommand(0, speed, "speed")], [scale], 0.0)
