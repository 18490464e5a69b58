"""How far an axis may be told to go, as the page tells it where the server didn't ask the axis."""

import pytest

from frontend.modules import Modules
from stepramp.controllers.contract import AxisCommand
from stepramp.devices.soft_limits import refuse_beyond
from stepramp.errors import Rejected

WAYS = """async ([rejections, axis, isRelative]) => {
    const {asTheAxisGoes} = await import('/devices/ways.js');
    return rejections.map((one) => asTheAxisGoes(one, axis, isRelative).allowed); }"""
ANY = {"lowest": -(2**31), "highest": 2**31 - 1, "is_whole": True, "note": ""}


@pytest.mark.parametrize("is_relative", [True, False])
def test_how_far_an_axis_may_go_is_told_alike_by_whoever_refuses_it(modules: Modules, is_relative: bool) -> None:
    """What is no number is refused before its axis is asked: the page knows as much of that."""
    with pytest.raises(Rejected) as refused:
        refuse_beyond({}, [AxisCommand(1, 20_000_000, "by_steps")], {1: 100}, relative=is_relative)
    axis = {"axis": 1, "target_steps": 100, "lowest_steps": None, "highest_steps": None}
    given = [{"field": "by_steps", "value": "x", "allowed": "any", "limits": ANY, "message": ""}]
    assert modules.evaluate(WAYS, [given, axis, is_relative]) == [refused.value.rejections[0].allowed]


def test_how_far_an_axis_with_soft_limits_may_go(modules: Modules) -> None:
    axis = {"axis": 0, "target_steps": 100, "lowest_steps": 0, "highest_steps": 900}
    given = [
        {"field": "by_steps", "value": value, "allowed": "any", "limits": limits, "message": ""}
        for value, limits in [("x", ANY), (0, {**ANY, "note": ", but not 0"}), (7, {**ANY, "lowest": -5})]
    ]
    assert modules.evaluate(WAYS, [given, axis, True]) == [
        "a whole number from -100 to 800 steps, the soft limits of axis 0 from there",
        "a whole number from -100 to 800 steps, but not 0",
        "any",
    ]
    assert modules.evaluate(WAYS, [given[:1], axis, False]) == [
        "a whole number from 0 to 900 steps, the soft limits of axis 0"
    ]
