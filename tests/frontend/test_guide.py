"""The guide of a first visit: what its answers make of a design.

The figures are worked out by hand, from the formulas that stand beside them.
"""

import math
from typing import Any

import pytest

from designs import document
from frontend.modules import Modules

SCREW = {"full_steps_per_rev": 200, "microsteps": 16, "travel_per_rev": 8, "travel_unit": "mm"}
DIAL = {"full_steps_per_rev": 1080, "microsteps": 1, "travel_per_rev": 360, "travel_unit": "deg"}
RUN = """async ([design, steps, examples, look]) => {
    const {FIRST_STATE} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {designOf} = await import('/app/selectors.js');
    let state = COMMANDS.work.begin({...FIRST_STATE, examples}, {axes: [design], together: 'independent'});
    for (const [name, ...args] of steps) {
        const [noun, verb] = name.split('.');
        state = COMMANDS[noun][verb](state, ...args);
    }
    return {design: designOf(state), units: state.units, guide: state.guide, past: state.history.past.length}; }"""


def made(modules: Modules, *steps: list[object], design: Any = None, examples: Any = ()) -> Any:
    """Return what there is after commands."""
    return modules.evaluate(RUN, [design or document(axis=SCREW), steps, examples, ""])


def test_each_step_of_the_guide_is_undone_as_one(modules: Modules) -> None:
    first = document(axis=SCREW)
    # What is typed digit by digit, with the focus gone from one field to the next.
    typed: list[list[object]] = [
        ["guide.openGuide"],
        ["guide.answer", "axis.microsteps", 3],
        ["guide.answer", "axis.microsteps", 32],
        ["work.endGesture"],
        ["guide.answer", "axis.travel_per_rev", 2],
        ["guide.goToStep", "limits"],
        ["guide.answer", "ramp.slew_speed_steps_per_s", 1600],
        ["work.endGesture"],
        ["guide.answer", "ramp.base_speed_steps_per_s", 50],
    ]
    end = made(modules, *typed)
    assert (end["past"], end["design"]["axis"]["microsteps"], end["design"]["axis"]["travel_per_rev"]) == (2, 32, 2)
    once = made(modules, *typed, ["work.undo"])["design"]
    # The motor goes on turning as before: twice the steps.
    assert once["ramp"] == {**first["ramp"], "slew_speed_steps_per_s": 2000, "acceleration_steps_per_s2": 10_000}
    assert once["axis"]["microsteps"] == 32
    assert made(modules, *typed, ["work.undo"], ["work.undo"])["design"] == first
    # What comes after the guide is a change by itself.
    assert made(modules, *typed, ["guide.closeGuide"], ["guide.answer", "move.steps", 7])["past"] == 3


def limits_of(design: Any) -> list[float | str | None]:
    return [*(value for name, value in design["ramp"].items() if name != "shape"), design["move"]["steps"]]


def test_the_motor_turns_as_before_when_its_steps_become_others(modules: Modules) -> None:
    def set_to(microsteps: object) -> list[object]:
        return ["guide.answer", "axis.microsteps", microsteps]

    speeds = {"base_speed_steps_per_s": 100, "slew_speed_steps_per_s": 1000, "acceleration_steps_per_s2": 5000}
    design = document(axis=SCREW, ramp={**speeds, "deceleration_steps_per_s2": 8000}, move__steps=-2000)
    assert limits_of(design) == [100, 1000, 5000, 8000, -2000]
    # From 16 microsteps, digit by digit, with what is no number in between.
    typed = [set_to(value) for value in (1, "", 3, 32)]
    assert limits_of(made(modules, *typed, design=design)["design"]) == [200, 2000, 10_000, 16_000, -4000]
    assert made(modules, *typed, set_to(16), design=design)["design"] == design
    # 400 full steps of 8 microsteps are 3,200 a turn, too.
    finer = {"name": "0.9", "help": "", "values": {"full_steps_per_rev": 400, "microsteps": 8, "travel_unit": "mm"}}
    assert limits_of(made(modules, set_to(4), ["guide.setMotor", finer], design=design)["design"]) == limits_of(design)
    # What is typed of the limits meanwhile is kept as well.
    faster: list[object] = ["work.setValue", "ramp.slew_speed_steps_per_s", 1600, "type"]
    assert limits_of(made(modules, set_to(8), faster, set_to(16), design=design)["design"])[1] == 3200
    refused = {**design, "ramp": {**design["ramp"], "slew_speed_steps_per_s": "fast"}}
    assert limits_of(made(modules, set_to(32), design=refused)["design"])[1:3] == ["fast", 10_000]


def test_nothing_is_changed_by_skipping(modules: Modules) -> None:
    steps: list[list[object]] = [["guide.openGuide"], *(["guide.goToStep", step] for step in ("limits", "ramp", "use"))]
    end = made(modules, *steps, ["guide.closeGuide"])
    assert (end["design"], end["past"], end["units"]) == (document(axis=SCREW), 0, {"length": "steps", "time": "s"})


def test_units_are_those_of_what_is_driven(modules: Modules) -> None:
    assert made(modules, ["guide.setDrive", "dial"])["units"] == {"length": "deg", "time": "s"}
    assert made(modules, ["guide.setDrive", "nothing"])["units"] == {"length": "rev", "time": "s"}
    assert made(modules, ["guide.takeDrive"])["units"] == {"length": "mm", "time": "s"}
    minutes = {"length": "mm", "time": "min"}
    assert made(modules, ["view.setUnits", minutes], ["guide.takeDrive"])["units"] == minutes, "chosen before"
    wheel = made(modules, ["guide.setDrive", "wheel"])["design"]["axis"]
    assert wheel == {**SCREW, "travel_per_rev": pytest.approx(math.pi * 65)}
    assert made(modules, ["guide.setDrive", "linear"])["design"]["axis"] == SCREW, "it is one already"


def test_an_example_is_renamed_and_a_persons_own_design_is_not(modules: Modules) -> None:
    example = document(axis=SCREW)
    answer: list[object] = ["guide.answer", "axis.microsteps", 4]
    renamed = made(modules, answer, examples=[{"title": "", "description": "", "design": example}])
    assert renamed["design"]["name"] == ""
    assert made(modules, answer)["design"]["name"] == example["name"]
    same: list[object] = ["guide.answer", "axis.microsteps", 16]
    unchanged = made(modules, same, examples=[{"title": "", "description": "", "design": example}])
    assert (unchanged["design"], unchanged["past"]) == (example, 0)


@pytest.mark.parametrize(
    ("player", "method", "frequency_hz"),
    [
        ("controller", "exact", 2_000_000),
        ("sketch", "exact", 2_000_000),
        ("grbl", "ideal", 24_000_000),
        ("marlin", "ideal", 24_000_000),
        ("chip", "newton", 24_000_000),
    ],
)
def test_the_method_shows_what_plays_the_ramp(modules: Modules, player: str, method: str, frequency_hz: int) -> None:
    teensy = document(axis=SCREW)
    teensy["timer"] = {**teensy["timer"], "frequency_hz": 24_000_000, "counter_bits": 32}
    design = made(modules, ["guide.setPlayer", player], design=teensy)["design"]
    assert (design["method"]["name"], design["timer"]["frequency_hz"]) == (method, frequency_hz)
    assert design["name"] == teensy["name"]


@pytest.mark.parametrize("player", ["grbl", "marlin"])
def test_the_error_shown_of_a_machine_that_ramps_by_itself_is_explained(modules: Modules, player: str) -> None:
    help_text = modules.evaluate("async () => (await import('/model/guide.js')).PLAYERS")[player]["help"]
    assert "+100 %" in help_text
    assert "no fault of the machine" in help_text


def test_an_unos_clock_stays(modules: Modules) -> None:
    fine = document(axis=SCREW)
    fine["timer"] = {**fine["timer"], "frequency_hz": 16_000_000, "counter_bits": 16}
    assert made(modules, ["guide.setPlayer", "sketch"], design=fine)["design"]["timer"] == fine["timer"]


def test_careful_limits_are_in_full_steps_and_within_the_timers(modules: Modules) -> None:
    ramp = made(modules, ["guide.beginCarefully"])["design"]["ramp"]
    assert (ramp["slew_speed_steps_per_s"], ramp["acceleration_steps_per_s2"]) == (400 * 16, 2000 * 16)
    assert (ramp["base_speed_steps_per_s"], ramp["deceleration_steps_per_s2"]) == (0, None)
    fine = document(axis={**SCREW, "microsteps": 256})
    fine["timer"] = {**fine["timer"], "shortest_interval_us": 20}
    # 102,400 steps/s are more than a step each 20 us.
    assert made(modules, ["guide.beginCarefully"], design=fine)["design"]["ramp"]["slew_speed_steps_per_s"] == 50_000
    wrong = document(axis={**SCREW, "microsteps": "many"})
    assert made(modules, ["guide.beginCarefully"], design=wrong)["past"] == 0, "nothing is made of a refused number"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_move_becomes_long_enough(modules: Modules, sign: int) -> None:
    short = document(axis=SCREW)
    short["ramp"] = {
        "base_speed_steps_per_s": 100,
        "slew_speed_steps_per_s": 1000,
        "acceleration_steps_per_s2": 2000,
        "deceleration_steps_per_s2": 4500,
    }
    short["move"] = {"steps": 10 * sign}
    # (1000² − 100²) / (2 · 2000) = 247.5 and / (2 · 4500) = 110: 248 + 110 steps; half of the move is at slew speed.
    assert modules.call("model/guide.js", "leastSteps", short) == 358
    assert made(modules, ["guide.lengthenMove"], design=short)["design"]["move"]["steps"] == 716 * sign
