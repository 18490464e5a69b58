"""What is proposed for a ramp that is too long for a controller: applied to the design, it fits."""

import json
from typing import Any

import pytest

from controllers.test_push import limits
from designs import document
from stepramp.controllers.stepramp import push_remedies
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.push_remedies import plan_or_remedies
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection, Remedy

SMALL = limits(most_segments=10)
LONG = {"ramp__acceleration_steps_per_s2": 1000.0}


def rejections(*documents: dict[str, Any], hello: HelloReply = SMALL, axis: int | None = None) -> list[Rejection]:
    present = None if axis is None else plan_push([Design.checked(document())], limits(), StepRampSettings()).image
    with pytest.raises(Rejected) as caught:
        plan_or_remedies([Design.checked(each) for each in documents], hello, StepRampSettings(), axis, present)
    return list(caught.value.rejections)


def changed(body: Any, remedy: Remedy) -> Any:
    """Return what a page sends that puts the values where the paths say."""
    for change in remedy.changes:
        *parts, last = change.field.split(".")
        part = body
        for each in parts:
            part = part[int(each) if each.isdecimal() else each]
        part[last] = change.value
    return body


def kinds(rejection: Rejection) -> list[str]:
    return [remedy.text.split()[0] for remedy in rejection.remedies]


@pytest.mark.parametrize(
    "changes",
    [LONG, LONG | {"ramp__deceleration_steps_per_s2": 700.0}, LONG | {"method__name": "newton"}],
)
def test_each_remedy_by_itself_makes_the_design_fit(changes: dict[str, Any]) -> None:
    [rejection] = rejections(document(**changes))
    assert kinds(rejection) == ["raise", "lower", "use"]
    for number in range(3):
        [rejection] = rejections(document(**changes))
        body = changed({"axes": [document(**changes)]}, rejection.remedies[number])
        plan_push([Design.checked(body["axes"][0])], SMALL, StepRampSettings())


@pytest.mark.parametrize("own", [{}, {"deceleration_jerk_steps_per_s3": 1500.0}])
def test_of_an_s_curve_its_jerk_may_be_raised_too(own: dict[str, float]) -> None:
    # Two sides that differ take twice the segments.
    hello = limits(most_segments=10 * (1 + len(own)))
    shape = {"name": "s_curve", "jerk_steps_per_s3": 2000.0} | own
    long = document(schema="stepramp/2", method__name="exact", ramp__acceleration_steps_per_s2=2e4, ramp__shape=shape)
    [rejection] = rejections(long, hello=hello)
    fields = ["acceleration_steps_per_s2", *(f"shape.{name}" for name in ("jerk_steps_per_s3", *own))]
    steeper, sharper, slower = rejection.remedies[:3]
    assert [change.field for change in steeper.changes] == [f"axes.0.ramp.{field}" for field in fields]
    assert [change.field for change in sharper.changes] == [f"axes.0.ramp.{field}" for field in fields[1:]]
    assert slower.text.startswith("lower the slew speed to ")
    # The form of the ramp stays: twice the acceleration in half the time has four times the jerk.
    factor = steeper.changes[0].value / 2e4
    assert steeper.changes[1].value / 2000 == pytest.approx(factor**2, rel=0.02)
    for remedy in rejection.remedies:
        body = changed({"axes": [json.loads(json.dumps(long))]}, remedy)
        plan_push([Design.checked(body["axes"][0])], hello, StepRampSettings())


def test_the_numbers_are_close_to_the_least_change() -> None:
    """A tenth less of the change, and the ramp is too long again."""
    [rejection] = rejections(document(**LONG))
    steeper, slower, _ = rejection.remedies
    for field, value in (
        ("acceleration_steps_per_s2", 1000 + 0.9 * (steeper.changes[0].value - 1000)),
        ("slew_speed_steps_per_s", 1000 - 0.9 * (1000 - slower.changes[0].value)),
    ):
        assert rejections(document(**LONG | {f"ramp__{field}": value}))


def test_it_is_said_in_one_sentence_with_what_was_counted() -> None:
    [rejection] = rejections(document(**LONG))
    ways = [remedy.text for remedy in rejection.remedies]
    assert rejection.message == rejection.reason
    assert rejection.reason.startswith("Too long for this controller: ")
    assert " of 10 segments, even with intervals changed by up to 16 ticks; " in rejection.reason
    assert rejection.reason.endswith(f"; {ways[0]}, {ways[1]}, or {ways[2]}.")


def test_every_axis_that_is_too_long_is_told_and_no_remedy_touches_another() -> None:
    fine = document(ramp__acceleration_steps_per_s2=1e6)
    found = rejections(document(**LONG), fine, document(**LONG))
    assert [each.field for each in found] == [f"axes.{axis}.ramp.acceleration_steps_per_s2" for axis in (0, 2)]
    for axis, rejection in zip((0, 2), found, strict=True):
        assert kinds(rejection) == ["raise", "lower", "use"]
        fields = [change.field for remedy in rejection.remedies for change in remedy.changes]
        assert all(field.startswith(f"axes.{axis}.") for field in fields)
    body = {"axes": [document(**LONG), fine, document(**LONG)]}
    for rejection in found:
        changed(body, rejection.remedies[2])
    plan_push([Design.checked(each) for each in body["axes"]], SMALL, StepRampSettings())


def test_where_all_ramps_together_are_too_long_the_remedy_makes_them_fit_together() -> None:
    hello = limits(largest_image_bytes=160)
    both = [document(**LONG), document(ramp__acceleration_steps_per_s2=1100.0)]
    [rejection] = rejections(*both, hello=hello)
    assert "all ramps together take" in rejection.reason
    assert rejection.remedies
    for number in range(len(rejection.remedies)):
        body = changed({"axes": [document(**LONG), document(ramp__acceleration_steps_per_s2=1100.0)]},
                       rejection.remedies[number])  # fmt: skip
        plan_push([Design.checked(each) for each in body["axes"]], hello, StepRampSettings())


def test_the_fields_of_a_single_design_are_its_own() -> None:
    [rejection] = rejections(document(**LONG), axis=1)
    assert rejection.field == "ramp.acceleration_steps_per_s2"
    assert rejection.remedies[0].changes[0].field == "ramp.acceleration_steps_per_s2"
    design = Design.checked(changed(document(**LONG), rejection.remedies[0]))
    plan_push([design], SMALL, StepRampSettings(), 0)


def test_a_table_can_only_give_way_to_a_formula() -> None:
    [rejection] = rejections(document(method__name="table"), hello=limits(most_segments=2))
    assert rejection.field == "axes.0.table.rows"
    [remedy] = rejection.remedies
    assert [change.field for change in remedy.changes] == ["axes.0.method.name", "axes.0.method.arithmetic"]


def test_only_ramps_that_are_planned_soon_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    # 500 steps up, by (16), and as many down; twice the acceleration halves them, by the same formula.
    for most_steps, least_factor in ((1000, 1.0), (200, 5.0), (10, 100.0)):
        monkeypatch.setattr(push_remedies, "MOST_STEPS_TO_SEARCH", most_steps)
        [rejection] = rejections(document(**LONG))
        assert kinds(rejection) == ["raise", "lower", "use"]
        raised = rejection.remedies[0].changes[0].value
        assert raised >= least_factor * LONG["ramp__acceleration_steps_per_s2"]
    monkeypatch.setattr(push_remedies, "MOST_STEPS_TO_SEARCH", 0)
    assert kinds(rejections(document(**LONG))[0]) == ["use"]


def test_a_ramp_that_is_too_long_to_be_planned_often_has_remedies_too() -> None:
    """Its 750,000 steps were refused without a way out, though a few changes of it are short."""
    long = document(ramp__slew_speed_steps_per_s=15_000, ramp__acceleration_steps_per_s2=300, move__steps=900_000)
    [rejection] = rejections(long, hello=limits(most_segments=250))
    assert {"raise", "lower"} <= set(kinds(rejection))
    for remedy in rejection.remedies:
        body = changed({"axes": [json.loads(json.dumps(long))]}, remedy)
        plan_push([Design.checked(body["axes"][0])], limits(most_segments=250), StepRampSettings())


def test_the_search_ends_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(push_remedies, "SEARCH_S", 0.0)
    assert kinds(rejections(document(**LONG))[0]) == ["use"]
