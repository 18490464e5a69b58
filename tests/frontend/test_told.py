"""Messages of the server whose quantities are told in the units that are shown."""

from collections.abc import Callable
from typing import Any

import pytest

from designs import design, document
from frontend.modules import Modules
from stepramp.controllers.losses import losses
from stepramp.controllers.remark import Remark, of_axis, quantity, told_in
from stepramp.http_api.error_items import ToldAnswer
from stepramp.http_api.schedule_models import LimitAnswer
from stepramp.ramp.profile import profile_of
from stepramp.ramp.schedule import schedule_of

FINE = document(axis__microsteps=2, axis__travel_per_rev=8)  # 0.02 mm a step
COARSE = document(axis__microsteps=1, axis__travel_per_rev=8)  # 0.04 mm a step
SCRIPT = """async ([said, units, designs]) =>
    (await import('/model/told.js')).inShownUnits(units, designs)(said)"""


def shown(modules: Modules, said: dict[str, Any], designs: list[Any], length: str = "mm", time: str = "s") -> Any:
    return modules.evaluate(SCRIPT, [said, {"length": length, "time": time}, designs])


def as_answered(said: Any) -> dict[str, Any]:
    answer = LimitAnswer.model_validate({"field": said.field, "axis": 0, "message": said.message, "told": said.told})
    return answer.model_dump()


@pytest.mark.parametrize(
    ("changes", "units", "text"),
    [
        # 200 steps up and down; 100 steps rise to sqrt(2 · 5000 · 50) = 707 steps/s.
        ({"move__steps": 100}, ("mm", "s"), "which takes 4 mm: the move peaks at 14."),
        ({"move__steps": 100}, ("mm", "min"), "which takes 4 mm: the move peaks at 8"),
        ({"move__steps": 100}, ("rev", "s"), "which takes 0.5 rev: the move peaks at 1.7"),
        # 1 / 1500 µs = 666.66… steps/s, of which at most 13.3333 mm/s are allowed.
        ({"timer__shortest_interval_us": 1500}, ("mm", "s"), "use a slew speed of at most 13.3333 mm/s."),
        # A step at 1e6 steps/s² reaches sqrt(2e6) = 1,414.21… steps/s, rounded up; one to 1,000 takes 500,000 steps/s².
        (
            {"ramp__acceleration_steps_per_s2": 1e6},
            ("mm", "s"),
            "At 20,000 mm/s² a single step would reach 28.2843 mm/s, above the slew speed: there is no ramp. "
            "Use at most 10,000 mm/s², or a slew speed of at least 28.2843 mm/s.",
        ),
    ],
)
def test_warnings_are_told_in_the_units_shown(
    modules: Modules, changes: dict[str, Any], units: tuple[str, str], text: str
) -> None:
    warning = profile_of(design(**changes)).warnings[0]
    said = shown(modules, as_answered(warning), [FINE], *units)
    assert text in said["message"]
    assert "steps/s" not in said["message"]
    assert shown(modules, as_answered(warning), [FINE], "steps")["message"] == warning.message


def test_a_line_is_told_in_the_units_of_each_of_its_axes(modules: Modules) -> None:
    slow = design(name="Y", ramp__slew_speed_steps_per_s=100, move__steps=500, axis__microsteps=1)
    [limit] = schedule_of([slow, design(name="X", move__steps=1000)], "line").limits
    said = shown(modules, as_answered(limit), [COARSE, FINE])
    # 100 steps/s of 0.04 mm; 200 and 1,000 steps/s of 0.02 mm.
    assert said["message"] == (
        "Y (axis 0) allows a slew speed of 4 mm/s: along the line that of X (axis 1) is 4 mm/s instead of 20 mm/s."
    )


S_CURVE = {"name": "s_curve", "jerk_steps_per_s3": 20_000}
EACH_WARNING: list[Callable[[], Any]] = [
    lambda: profile_of(design(move__steps=100)),
    lambda: profile_of(design(timer__shortest_interval_us=1500)),
    lambda: profile_of(design(timer__frequency_hz=1e5, ramp__slew_speed_steps_per_s=3000)),
    lambda: profile_of(design(ramp__acceleration_steps_per_s2=1e6)),
    lambda: profile_of(design(method__name="first_order", ramp__base_speed_steps_per_s=0)),
    lambda: profile_of(design(schema="stepramp/2", ramp__shape=S_CURVE, move__steps=60)),
]


@pytest.mark.parametrize("made", EACH_WARNING)
def test_what_a_warning_tells_as_data_stands_in_it_in_that_order(made: Callable[[], Any]) -> None:
    for warning in made().warnings:
        rest = warning.message
        for each in warning.told:
            assert float(each.text.split()[0].replace(",", "")) == pytest.approx(each.value, rel=1e-3)
            assert each.text.endswith(f" {each.unit}")
            rest = rest[rest.index(each.text) + len(each.text) :]
        assert "steps/s" not in rest


def test_limits_are_told_in_the_unit_of_their_field_only(modules: Modules) -> None:
    limits = {"lowest": 0.001, "highest": 1000, "is_whole": False, "note": ", the slew speed"}
    said = {
        "field": "axes.1.ramp.slew_speed_steps_per_s",
        "value": 2000,
        "allowed": "",
        "message": "",
        "limits": limits,
    }
    told = shown(modules, said | {"unit": "steps/s"}, [FINE, COARSE])
    assert told["given"] == "80 mm/s (2,000 steps/s)"
    assert told["allowed"] == "a number from 0.00004 to 40 mm/s, the slew speed"
    # A frequency is no speed, whatever limits it.
    other = said | {"field": "design.timer.frequency_hz", "unit": "steps/s", "allowed": "as it is"}
    assert shown(modules, other, [FINE])["allowed"] == "as it is"
    # Of an axis that the page doesn't know nothing can be converted.
    assert shown(modules, said | {"unit": "steps/s", "allowed": "as it is"}, [FINE])["allowed"] == "as it is"


def test_sentences_of_several_axes_are_told_in_the_units_of_each_and_once_where_they_are_the_same(
    modules: Modules,
) -> None:
    """2,000 steps/s of 0.02 mm, and 1,000 of 0.04, are both 40 mm/s."""
    axes = []
    for name, axis, steps_per_s in (("X", FINE, 2000), ("Y", COARSE, 1000), ("Z", COARSE, 500)):
        remark = Remark("Up to V1, ", quantity(steps_per_s, "steps/s"), ", all is as it was.")
        told = [[ToldAnswer.model_validate(each).model_dump() for each in one] for one in told_in([remark])]
        axes.append({"design": axis | {"name": name}, "remarks": [str(remark)], "remarks_told": told})
    in_mm = [modules.call("/model/imported.js", "remarksOf", axes[:n], {"length": "mm", "time": "s"}) for n in (2, 3)]
    assert in_mm[0] == ["Up to V1, 40 mm/s, all is as it was."]
    assert in_mm[1][1:] == ["Y: Up to V1, 40 mm/s, all is as it was.", "Z: Up to V1, 20 mm/s, all is as it was."]
    in_steps = modules.call("/model/imported.js", "remarksOf", axes[:2], {"length": "steps", "time": "s"})
    assert in_steps[0] == "X: Up to V1, 2,000 steps/s, all is as it was."


def test_warnings_of_a_push_are_told_in_the_units_that_are_shown(modules: Modules) -> None:
    """Of 50 steps/mm: what a grbl says of a base speed and of another axis' acceleration."""
    said = [of_axis(0, next(losses(design(ramp__base_speed_steps_per_s=100), "grbl"))), "Klipper forgets these limits."]
    told = [[ToldAnswer.model_validate(each).model_dump() for each in one] for one in told_in(said)]
    shown = modules.call(
        "/panels/device/push_words.js",
        "warningsOf",
        {"warnings": [str(each) for each in said], "warnings_told": told},
        {"length": "mm", "time": "min"},
        [document()],
    )
    # 100 steps/s of 50 steps/mm: 2 mm/s.
    assert shown == ["Axis 0: Base speed 120 mm/min is not kept: grbl starts from 0.", "Klipper forgets these limits."]
