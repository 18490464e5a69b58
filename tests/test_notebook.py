import numpy as np
import pytest

import stepramp
from designs import document
from stepramp.examples import all_examples


def test_a_design_is_made_from_its_parts_or_from_a_document() -> None:
    parts = document()
    made, parsed = stepramp.Design(**parts), stepramp.Design.checked(parts)
    assert made == parsed
    assert made.model_dump(by_alias=True)["schema"] == "stepramp/1"


def test_wrong_parts_are_refused_by_name() -> None:
    with pytest.raises(stepramp.Rejected) as caught:
        stepramp.Design(**document(move__steps=0), surprise=1)
    assert {each.field for each in caught.value.rejections} == {"move.steps", "surprise"}


@pytest.mark.parametrize("example", all_examples(), ids=lambda example: example["title"])
def test_a_planned_move_tells_what_its_profile_does(example: dict) -> None:
    move = stepramp.Design(**example["design"]).profile()
    assert move.intervals_ticks.size == example["design"]["move"]["steps"]
    assert move.position_steps[-1] == example["design"]["move"]["steps"]
    np.testing.assert_allclose(np.diff(move.time_s) * move.speed_steps_per_s[:-1], 1)
    assert move.duration_s > move.time_s[-1]
    assert sum(phase.last_step - phase.first_step + 1 for phase in move.phases) == move.intervals_ticks.size
    assert move.warnings == ()


def test_a_figure_draws_every_step_of_a_short_move() -> None:
    move = stepramp.Design(**document(move__steps=300)).profile()
    figure = move.figure(["first_order", "table"])
    assert len(figure.data) == 9
    np.testing.assert_allclose(figure.data[0].y, move.speed_steps_per_s)
    np.testing.assert_allclose(figure.data[1].y, move.intervals_ticks / 2)
    np.testing.assert_allclose(figure.data[5].y, 100 * move.errors(method="first_order").relative_error)


def test_there_is_no_other_name() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Designs'"):
        _ = stepramp.Designs
