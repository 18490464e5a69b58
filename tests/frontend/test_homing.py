"""Homing from the page: how far it may lead, what came of it, and what the virtual controller's switches do."""

from typing import Any

import pytest

from frontend.modules import Modules
from frontend.state import DEVICE, after

WISH = {
    "axes": [{"axis": 0, "fast_steps_per_s": -800, "position_steps": 5}],
    "slow_steps_per_s": 50,
    "back_off_steps": 20,
    "for_s": 30,
}
BEGUN = {"wish": WISH, "stops": 2, "heard_s": 7, "outcomes": None}
SWITCH = {"input": "D9", "role": "limit", "axis": 0, "end": "low", "is_active": False}
AXIS = {"axis": 0, "homing": False, "position_known": False}
NOT_FOUND = {
    "state": "ready",
    "stops": 2,
    "heard_s": 8,
    "stopped_by": [],
    "inputs": [SWITCH],
    "axes": [AXIS],
}


@pytest.mark.parametrize(
    ("told", "outcome"),
    [
        ({}, "not found"),
        ({"heard_s": 7}, None),
        ({"state": "moving"}, None),
        ({"axes": [{**AXIS, "homing": True}]}, None),
        ({"axes": [{**AXIS, "position_known": True}]}, "homed"),
        ({"inputs": [{**SWITCH, "is_active": True}]}, "pressed"),
        ({"inputs": [{**SWITCH, "is_active": True, "end": "high"}]}, "not found"),
        ({"stops": 3}, "stopped"),
        ({"stops": 3, "stopped_by": ["emergency_stop"]}, "emergency"),
        ({"state": "lost"}, "lost"),
    ],
)
def test_what_has_come_of_a_homing(modules: Modules, told: dict[str, Any], outcome: str | None) -> None:
    steps: list[list[object]] = [
        ["device.homingBegan", "1", BEGUN],
        ["device.heard", [{**DEVICE, **NOT_FOUND, **told}], {}],
    ]
    seen = after(modules, steps, "(state) => state.devices.homings[1].outcomes")
    assert seen == (None if outcome is None else [outcome])


def test_what_came_of_it_stays_until_the_device_is_gone(modules: Modules) -> None:
    steps: list[list[object]] = [
        ["device.homingBegan", "1", BEGUN],
        ["device.heard", [{**DEVICE, **NOT_FOUND}], {}],
        ["device.heard", [{**DEVICE, **NOT_FOUND, "heard_s": 9, "axes": [{**AXIS, "position_known": True}]}], {}],
    ]
    look = "(state) => state.devices.homings[1]?.outcomes ?? 'gone'"
    assert after(modules, steps, look) == ["not found"]
    assert after(modules, [*steps, ["device.heard", [], {}]], look) == "gone"


@pytest.mark.parametrize(
    ("outcome", "words"),
    [
        ("homed", "Axis 0 is homed: its switch is at 5 mm."),
        ("not found", "the switch at its low end was not found within 30 s"),
        ("pressed", "the switch at its low end is still pressed after 30 s"),
        ("stopped", "it was stopped"),
        ("emergency", "Acknowledge that first"),
    ],
)
def test_it_is_told_with_a_way_out(modules: Modules, outcome: str, words: str) -> None:
    script = """async ([outcome, wish]) => { const {outcomeText} = await import('/devices/homing.js');
        return outcomeText(outcome, wish.axes[0], wish, (steps) => `${steps} mm`); }"""
    assert words in modules.evaluate(script, [outcome, WISH])


def test_how_far_it_may_lead(modules: Modules) -> None:
    script = """async (wish) => { const {farthestSteps} = await import('/devices/homing.js');
        return [wish, {...wish, slow_steps_per_s: 1000}].map((one) => farthestSteps(one, one.axes[0])); }"""
    assert modules.evaluate(script, WISH) == [24_000, 30_000]


@pytest.mark.parametrize(
    ("wanted", "is_pressed", "change"),
    [
        ({"role": "emergency_stop"}, True, {"emergency_stop": True}),
        ({"role": "driver_fault"}, False, {"driver_fault": False}),
        ({}, True, {"axes": [{"axis": 0, "low_steps": 70, "high_steps": 900}]}),
        ({}, False, {"axes": [{"axis": 0, "low_steps": -930, "high_steps": 900}]}),
        ({"end": "high"}, False, {"axes": [{"axis": 0, "low_steps": None, "high_steps": 1070}]}),
        ({"axis": 3}, True, {}),
    ],
)
def test_what_pressing_a_virtual_switch_changes(
    modules: Modules, wanted: dict[str, Any], is_pressed: bool, change: dict[str, Any]
) -> None:
    script = """async ([input, isPressed, now]) =>
        (await import('/devices/surroundings.js')).changeFor(input, isPressed, now)"""
    around = {"axes": [{"axis": 0, "place_steps": 70, "low_steps": None, "high_steps": 900}]}
    assert modules.evaluate(script, [{**SWITCH, **wanted}, is_pressed, around]) == change
