"""What a controller plays itself: of which one it is asked, and how it lies over the plots."""

from __future__ import annotations

from typing import Any

import pytest

from designs import document
from frontend.modules import Modules

PORTS = [{"port": "/dev/a", "name": "A", "virtual": False, "families": ["stepramp", "grbl"]}]
FAMILIES = [
    {"name": "stepramp", "title": "StepRamp", "cannot": [], "plays_own": False, "reads_settings": False},
    {"name": "grbl", "title": "grbl", "cannot": [], "plays_own": True, "reads_settings": True},
]
OWN = {
    "step": [1, 2, 3],
    "intervals_us": [20_000, 10_000, 5000],
    "start_s": [0, 0.02, 0.03],
    "speed_steps_per_s": [50, 100, 200],
    "relative_error": [0.5, 0, -0.25],
}


@pytest.mark.parametrize(
    ("chosen", "device", "family"), [(None, None, None), ("grbl", None, "grbl"), (None, "grbl", "grbl")]
)
def test_of_the_family_connected_or_chosen(
    modules: Modules, chosen: str | None, device: str | None, family: Any
) -> None:
    there = [{"id": "1", "port": "/dev/a", "family": device, "axes": [{"steps_per_mm": 80}]}] if device else []
    script = """async (value) => { const [{FIRST_STATE}, {ownFamilyOf, stepsPerMmOf}] =
            await Promise.all([import('/app/state.js'), import('/app/devices.js')]);
        const devices = {...FIRST_STATE.devices, ...value};
        const state = {...FIRST_STATE, devices};
        return [ownFamilyOf(state)?.name ?? null, stepsPerMmOf(state)]; }"""
    known = {
        "ports": PORTS,
        "families": FAMILIES,
        "list": there,
        "chosenFamilies": {"/dev/a": chosen} if chosen else {},
    }
    assert modules.evaluate(script, known) == [family, 80 if device else None]


@pytest.mark.parametrize(
    ("in_hand", "chosen", "pushed", "scale"),
    [
        # Both designs go to the device together: each has the scale of its own axis, whichever is in view.
        (0, 0, None, 80),
        (1, 0, None, 400),
        (0, 1, None, 80),
        # The second was pushed to the first axis of the device: what the first design is given nobody knows.
        (1, 0, {"ids": [7], "toAxis": 0}, 80),
        (0, 0, {"ids": [7], "toAxis": 0}, None),
        # It is the other one's: never that of the axis in view.
        (0, 1, {"ids": [7, 5], "toAxis": 0}, 400),
        (1, 1, {"ids": [7, 5], "toAxis": 0}, 80),
    ],
)
def test_it_has_the_scale_of_the_axis_that_plays_the_design(
    modules: Modules, in_hand: int, chosen: int, pushed: Any, scale: int | None
) -> None:
    script = """async ([value, design, active, pushed]) => {
        const [{FIRST_STATE}, {ownPlayerOf}] = await Promise.all([import('/app/state.js'), import('/app/devices.js')]);
        const {historyOf} = await import('/model/workbench.js');
        const designs = pushed?.ids.map(() => design);
        const devices = {...FIRST_STATE.devices, ...value, pushed: pushed ? {1: {...pushed, designs}} : {}};
        const history = historyOf({axes: [design, design], together: 'independent', ids: [5, 7], active});
        return ownPlayerOf({...FIRST_STATE, history, devices}).stepsPerMm; }"""
    axes = [{"steps_per_mm": 80}, {"steps_per_mm": 400}]
    there = [{"id": "1", "port": "/dev/a", "family": "grbl", "state": "ready", "axes": axes, "most_axes": 3}]
    known = {"ports": PORTS, "families": FAMILIES, "list": there, "axis": chosen}
    assert modules.evaluate(script, [known, document(), in_hand, pushed]) == scale


def test_it_lies_over_time_and_steps_in_the_units_shown(modules: Modules) -> None:
    answer: dict[str, Any] = {"design": document(), "units": {"length": "mm", "time": "s"}, "range": None, "errors": {}}
    answer["profiles"] = {"exact": {"summary": {"steps": 3, "duration_s": 20}}}
    over = modules.call("plotting/curves.js", "ownOver", answer, "time", OWN)
    # 400 steps a turn of 8 mm: 0.02 mm a step.
    assert over == {
        "x": [0, 0.02, 0.03],
        "velocity": [1, 2, 4],
        "delay": [20_000, 10_000, 5000],
        "error": [50, 0, -25],
    }
    assert modules.call("plotting/curves.js", "ownOver", answer, "step", OWN)["x"] == [1, 2, 3]
