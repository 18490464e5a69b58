"""Sentences with their quantities: as texts, and as data that other units can be told of."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.controllers.grbl.ramp import grbl_losses
from stepramp.controllers.remark import Remark, of_axes, of_axis, quantity, told_in
from stepramp.errors import Told


def test_a_remark_is_its_text_and_knows_its_quantities() -> None:
    remark = Remark("Base speed ", quantity(100, "steps/s"), " is not kept.")
    assert remark == "Base speed 100 steps/s is not kept."
    assert remark.told == (Told("100 steps/s", 100, "steps/s"),)
    second = of_axis(1, remark)
    assert second == "Axis 1: Base speed 100 steps/s is not kept."
    assert told_in([second, "Others say nothing."]) == ((Told("100 steps/s", 100, "steps/s", axis=1),), ())


def test_what_several_axes_lose_alike_is_told_once_and_quantities_by_each() -> None:
    slow = Remark("Moves of ", quantity(100, "steps"), " are slow.")
    losses = {0: ["No table.", slow], 1: ["No table.", slow], 2: ["No table.", "Other scale."]}
    told = list(of_axes(losses))
    assert told == [
        "Axes 0, 1 and 2: No table.",
        "Axis 0: Moves of 100 steps are slow.",
        "Axis 1: Moves of 100 steps are slow.",
        "Axis 2: Other scale.",
    ]
    assert [[each.axis for each in quantities] for quantities in told_in(told)] == [[], [0], [1], []]
    assert list(of_axes({1: ["No table.", slow]})) == ["No table.", slow]


@given(st.floats(1, 30_000), st.floats(1, 1e6))
def test_each_quantity_stands_in_its_sentence_in_their_order(base: float, deceleration: float) -> None:
    asked = design(ramp__base_speed_steps_per_s=base, ramp__slew_speed_steps_per_s=max(base, 1000))
    asked = asked.model_copy(update={"ramp": asked.ramp.model_copy(update={"deceleration_steps_per_s2": deceleration})})
    for sentence in grbl_losses(asked):
        rest = str(sentence)
        for told in told_in([sentence])[0]:
            _, found, rest = rest.partition(told.text)
            assert found
