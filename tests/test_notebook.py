import math
import weakref
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import stepramp
from designs import document
from motor.trains import whole
from stepramp.errors import Change
from stepramp.examples import all_examples
from stepramp.motor.stall_map import Picture
from stepramp.notebook import StallMap


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


def test_a_motor_answers_from_python_as_over_http() -> None:
    made = stepramp.Design(**whole(ramp__acceleration_steps_per_s2=1.2e7))
    played = made.simulate_motor()
    assert (played.verdict, played.cause) == ("stalls", "onset")
    assert played.lost_full_steps != 0
    assert played.load_angles_deg.shape == (10_000,)
    assert played.assumed == ["motor.detent_torque_nm", "motor.pull_out_factor", "load.friction_nm"]
    proposal = made.with_changes(played.proposals()[0].changes)
    assert isinstance(proposal, stepramp.Design)
    assert proposal.simulate_motor().verdict == "safe"
    best = made.fastest_ramp().best
    assert best is not None
    assert best.figures is not None
    assert made.with_changes(best.changes).profile().duration_s == best.figures.duration_s
    # k T_h = .85 · .41719.
    assert made.motor_torque([0.0]).pull_out_nm == pytest.approx([0.3546], rel=1e-3)


def test_designs_are_made_of_the_motors_that_there_are() -> None:
    gauge = stepramp.MOTORS["Gauge · X27"]
    made = stepramp.Design(
        schema="stepramp/2", axis=gauge.axis, timer={"frequency_hz": 1e6}, motor=gauge.motor, drive=gauge.drive,
        load=gauge.load, ramp={"slew_speed_steps_per_s": 750, "acceleration_steps_per_s2": 20_000}, move={"steps": 900},
    )  # fmt: skip
    assert made.simulate_motor().lost_full_steps == 0
    with pytest.raises(stepramp.Rejected, match="motor is missing"):
        stepramp.Design(**document()).fastest_ramp()


def test_a_stall_map_has_the_verdicts_of_the_moves() -> None:
    made = stepramp.Design(**whole(move__steps=2000))
    found = made.stall_map("load", (0.0, 0.5), (1e5, 1e7), cells=8)
    assert found.verdicts.shape == (9, 9)
    assert (found.values[[0, -1]].tolist(), found.accelerations_steps_per_s2[0]) == ([0.0, 0.5], pytest.approx(1e5))
    for acceleration, load in ((1e5, 0.0), (1e7, 0.0), (1e5, 0.5)):
        changed = made.with_changes([
            Change("ramp.acceleration_steps_per_s2", acceleration), Change("load.torque_nm", load),
        ])  # fmt: skip
        assert found.verdict_at(acceleration, load) == changed.simulate_motor().verdict
    # What lies beside it has no verdict on it.
    for wrong in (math.nan, 9e4, 2e7, "1e5", None):
        with pytest.raises(stepramp.Rejected, match=r"acceleration_steps_per_s2 is .*; allowed: a number from 1"):
            found.verdict_at(wrong, 0.1)  # type: ignore[arg-type]
    with pytest.raises(stepramp.Rejected, match=r"value is nan; allowed: a number from 0 to 0\.5 Nm, on the map"):
        found.verdict_at(1e6, math.nan)


def test_the_nearest_point_of_a_map_is_so_by_ratio_and_for_loads_by_difference() -> None:
    """As its points lie: from 10⁴ to 10⁶ steps/s² the middle is 10⁵."""
    sides = np.array([1e4, 1e6]), np.array([[0, 1], [2, 3]], np.int8)
    speeds = StallMap("slew_speed", np.array([1000.0, 4000.0]), *sides, played=4)
    found = [speeds.verdict_at(*at) for at in ((9e4, 1900), (9e4, 2100), (1.1e5, 1900), (1.1e5, 2100))]
    assert found == ["safe", "marginal", "stalls", "not possible"]
    loads = StallMap("load", np.array([-0.1, 0.3]), *sides, played=4)
    assert [loads.verdict_at(1e4, value) for value in (0.09, 0.11)] == ["safe", "marginal"]


def test_of_a_map_that_grows_no_more_than_the_last_picture_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[weakref.ref[Picture]] = []
    most = 0

    def growing(cells: int, _: object) -> Iterator[Picture]:
        nonlocal most
        for number in range(50):
            picture = Picture(np.zeros((cells + 1, cells + 1), np.int8), number, number / 49)
            made.append(weakref.ref(picture))
            most = max(most, sum(each() is not None for each in made))
            yield picture
            del picture

    monkeypatch.setattr("stepramp.notebook.stall_map", growing)
    assert stepramp.Design(**whole()).stall_map(cells=8).played == 49
    assert most <= 3


def test_numbers_of_numpy_are_numbers() -> None:
    made = stepramp.Design(**whole())
    speeds = np.arange(0, 900, 300)
    as_list = made.motor_torque([0, 300, 600]).pull_out_nm
    np.testing.assert_array_equal(made.motor_torque(speeds).pull_out_nm, as_list)
    np.testing.assert_array_equal(made.motor_torque([np.int64(0), *speeds[1:]]).pull_out_nm, as_list)
    assert made.with_changes([Change("move.steps", np.int64(500))]).move.steps == 500


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([Change("rmp.x", 1)], 'rmp is {"x": 1}; allowed: nothing; there is no such field, only schema, name, axis'),
        ([Change("move.steps.x", 1)], "move.steps.x is 1; allowed: move.steps as a whole"),
        ([Change("move.steps", math.nan)], "move.steps is nan; allowed: a whole number from -10,000,000"),
        ([Change("ramp.slew_speed_steps_per_s", -1), Change("move.steps", 0)], "slew_speed_steps_per_s is -1; allowed"),
        ([("move.steps", 5)], 'changes.0 is ["move.steps", 5]; allowed: a stepramp.errors.Change'),
        ([Change(5, 5)], "changes.0 is Change(field=5, value=5); allowed"),  # type: ignore[arg-type]
        (None, "changes is missing; allowed: a list, each a stepramp.errors.Change"),
    ],
)
def test_changes_that_make_no_design_are_refused_by_name(changes: Any, message: str) -> None:
    with pytest.raises(stepramp.Rejected) as caught:
        stepramp.Design(**whole()).with_changes(changes)
    assert message in str(caught.value)


def test_a_change_may_begin_a_part_that_is_not_there() -> None:
    made = stepramp.Design(**whole(load=None, drive=None))
    changed = made.with_changes([Change("load.torque_nm", 0.1), Change("drive.supply_v", 36)])
    assert (changed.load.torque_nm, changed.drive.supply_v) == (0.1, 36)


def test_methods_that_there_are_not_are_refused_by_name() -> None:
    made = stepramp.Design(**document())
    for call in (
        lambda: made.with_method("quick"), lambda: made.profile().errors("quick"),
        lambda: made.profile().errors(method="quick"), lambda: made.profile().figure(["quick"]),
    ):  # fmt: skip
        with pytest.raises(stepramp.Rejected, match=r"method\.name is 'quick'; allowed: exact, ideal"):
            call()
    with pytest.raises(stepramp.Rejected, match=r"method\.arithmetic is 'float16'; allowed: float64"):
        made.with_method("newton", "float16")
