"""Jogs: what is said of runs that lead further than grbl can be told."""

from __future__ import annotations

import pytest

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.grbl.jog import furthest, refuse_runs_too_far
from stepramp.controllers.grbl.numbers import target
from stepramp.controllers.grbl.settings import Settings
from stepramp.errors import Rejected


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
