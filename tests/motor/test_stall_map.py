"""The map of stalls: what of it is played, against the whole grid."""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from motor.trains import random_design, with_motor
from stepramp.errors import Rejected
from stepramp.motor.map_points import NOT_POSSIBLE, VERDICTS, Question, design_with, own_verdict, verdict_at
from stepramp.motor.map_ranges import question_of
from stepramp.motor.shortened import shortened
from stepramp.motor.stall_map import Picture, Point, stall_map
from stepramp.motor.train import NotWanted
from stepramp.motor.verdict import outcome_of, verdict_of

CELLS = 32


def player(verdict: Callable[[Point], int], batches: list[list[Point]]) -> Callable[..., Iterator[tuple[Point, int]]]:
    def play_all(points: list[Point]) -> Iterator[tuple[Point, int]]:
        batches.append(points)
        return ((point, verdict(point)) for point in points)

    return play_all


def mapped(whole: np.ndarray) -> tuple[list[Picture], list[list[Point]]]:
    batches: list[list[Point]] = []
    play_all = player(lambda point: int(whole[point]), batches)
    return list(stall_map(len(whole) - 1, play_all)), batches


def grid(cells: int = 64) -> tuple[np.ndarray, np.ndarray]:
    row, column = np.mgrid[: cells + 1, : cells + 1] / cells
    return row, column


@given(angle=st.floats(0, 6.3), distance=st.floats(-0.4, 0.4), width=st.floats(0, 0.2))
def test_straight_borders_are_found_exactly(angle: float, distance: float, width: float) -> None:
    row, column = grid()
    along = (row - 0.5) * np.sin(angle) + (column - 0.5) * np.cos(angle)
    whole = (along > distance).astype(int) + (along > distance + width)
    pictures, batches = mapped(whole)
    assert (pictures[-1].verdicts == whole).all()
    asked = [point for batch in batches for point in batch]
    assert len(set(asked)) == len(asked) == pictures[-1].played


def test_a_thin_feature_that_touches_the_border_is_followed_and_an_island_within_a_coarse_cell_is_not() -> None:
    row, column = grid()
    whole = (row + column > 1.1).astype(int)
    whole[40, 5:] = whole[41, 5:] = 1
    assert (mapped(whole)[0][-1].verdicts == whole).all()
    whole[11:14, 11:14] = 1
    assert (mapped(whole)[0][-1].verdicts[11:14, 11:14] == 0).all()


def test_what_is_played_grows_with_the_border_not_with_the_grid() -> None:
    played = []
    for cells in (16, 32, 64, 128):
        row, column = grid(cells)
        played.append(mapped((row > column**2 + 0.2).astype(int))[0][-1].played)
    assert all(after < 2.6 * before for before, after in pairwise(played))
    assert played[-1] < 0.15 * 129**2


def test_pictures_grow_and_none_says_what_a_later_one_takes_back() -> None:
    row, column = grid()
    pictures, _ = mapped((row**2 + column**2 > 0.7).astype(int))
    progress = [picture.progress for picture in pictures]
    assert progress == sorted(progress)
    assert (progress[0] > 0, progress[-1]) == (True, 1.0)
    known = [int((picture.verdicts >= 0).sum()) for picture in pictures]
    assert known == sorted(known)
    last = pictures[-1].verdicts
    assert (last >= 0).all()
    for picture in pictures[::20]:
        is_known = picture.verdicts >= 0
        assert (picture.verdicts[is_known] == last[is_known]).all()


def test_it_ends_with_who_plays() -> None:
    def play_all(points: list[Point]) -> Iterator[tuple[Point, int]]:
        return ((point, 0) for point in points[:10])

    pictures = list(stall_map(16, play_all))
    assert len(pictures) == 10
    assert pictures[-1].progress < 1


@pytest.mark.parametrize("seed", range(4))
def test_it_is_the_whole_grid_but_for_islands(seed: int) -> None:
    """At most 2 % of the points differ: resonances make islands, and rows of them, between the coarse points."""
    question = question_of(random_design(np.random.default_rng(seed)), "slew_speed", None, None, CELLS)
    points = [(row, column) for row in range(CELLS + 1) for column in range(CELLS + 1)]
    whole = np.array([verdict_at(question, point) for point in points]).reshape(CELLS + 1, CELLS + 1)
    last = mapped(whole)[0][-1]
    assert (last.verdicts != whole).mean() <= 0.02
    assert len(np.unique(whole)) >= 3


def test_what_is_left_out_of_playing_changes_no_verdict() -> None:
    """Neither what verdict_of leaves out, nor the rest of a long slew phase: of 60 random designs."""
    random, told = np.random.default_rng(5), set()
    for _ in range(60):
        design = random_design(random, slew_s=1.5)
        try:
            whole = outcome_of(design).verdict
        except Rejected:
            continue
        assert verdict_of(design) == whole
        assert verdict_of(shortened(design)) == whole
        told.add(whole)
    assert told == {"safe", "marginal", "stalls"}


def test_a_long_slew_phase_is_played_in_part_and_a_short_one_whole() -> None:
    assert shortened(with_motor()).move.steps == 10_000
    long, backwards = (shortened(with_motor(move__steps=steps)).move.steps for steps in (6_000_000, -6_000_000))
    assert backwards == -long
    # 40 periods of 1/136.88 s at 32,000 steps/s, ramps of 2 · 1,707 steps; whole electrical periods of 64 steps less.
    assert 40 / 136.88 * 32_000 + 3412 <= long <= 40 / 136.88 * 32_000 + 3416 + 64
    assert (6_000_000 - long) % 64 == 0


def test_what_is_refused_whole_is_not_possible_in_the_map() -> None:
    """The slew phase that the map leaves out counts: 200 s are played."""
    for steps, is_played in ((6_300_000, True), (6_500_000, False)):
        design = with_motor(move__steps=steps)
        told = own_verdict(Question(design, "slew_speed", (), ()))
        assert told == (VERDICTS["safe"] if is_played else NOT_POSSIBLE)
    with pytest.raises(Rejected, match=r"move.steps is 6500000"):
        outcome_of(design)


def test_each_point_is_the_design_with_two_values_replaced() -> None:
    own = with_motor(ramp__deceleration_steps_per_s2=1.5e5)
    for over, value, path in (
        ("slew_speed", 20_000.0, ("ramp", "slew_speed_steps_per_s")),
        ("load", -0.05, ("load", "torque_nm")),
        ("supply_voltage", 30.0, ("drive", "supply_v")),
    ):
        made = design_with(Question(own, over, (), ()), 6e5, value)
        expected = own.model_dump(by_alias=True)
        expected["ramp"] |= {"acceleration_steps_per_s2": 6e5, "deceleration_steps_per_s2": 3e5}
        expected[path[0]][path[1]] = value
        assert made.model_dump(by_alias=True) == expected
    bare = with_motor(load=None, drive=None)
    assert design_with(Question(bare, "load", (), ()), 3e5, 0.1).drive_train.load_nm == 0.1  # type: ignore[union-attr]


def test_what_is_refused_is_not_possible() -> None:
    coarse = with_motor(timer__frequency_hz=15_000.0)
    question = question_of(coarse, "slew_speed", (10_000.0, 90_000.0), None, 8)
    assert verdict_at(question, (0, 8)) == NOT_POSSIBLE
    assert own_verdict(question) == NOT_POSSIBLE
    assert verdict_at(question, (0, 0)) != NOT_POSSIBLE


def test_a_point_that_nobody_waits_for_ends() -> None:
    with pytest.raises(NotWanted):
        verdict_at(question_of(with_motor(), "load", None, None, 8), (0, 0), lambda: False)


@settings(max_examples=30)
@given(seed=st.integers(0, 10_000), over=st.sampled_from(["slew_speed", "load", "supply_voltage"]))
@example(seed=237, over="load")
def test_usual_ranges_hold_the_design_and_its_border(seed: int, over: str) -> None:
    design = random_design(np.random.default_rng(seed))
    question = question_of(design, over, None, None, 8)  # type: ignore[arg-type]  # one of them
    train = design.drive_train
    assert train is not None
    own = {"slew_speed": design.ramp.slew_speed_steps_per_s, "load": train.load_nm, "supply_voltage": train.supply_v}
    assert question.over_values[0] <= own[over] <= question.over_values[-1]
    assert question.accelerations[0] <= design.ramp.acceleration_steps_per_s2 <= question.accelerations[-1]
    assert list(question.over_values) == sorted(set(question.over_values))
    # The steepest is more than the motor has, and of what is varied the end that asks for most: of loads that drive the
    # motor it is the first one. Within what it can start with, it makes any acceleration.
    most = 0 if over == "supply_voltage" or (over == "load" and train.load_nm < 0) else 8
    assert verdict_at(question, (8, most)) in (1, 2, NOT_POSSIBLE)


def test_a_map_of_a_table_over_the_supply_is_around_what_its_rows_ask_for() -> None:
    """40 steps of 250 µs, then 125 µs, which is 150 rpm: whatever the ramp beside it is."""
    table = {"method__name": "table", "table": {"rows": [[40, 250], [400, 125]], "interval_unit": "us"}}
    ranges = [
        question_of(
            with_motor(**table, ramp__slew_speed_steps_per_s=speed), "supply_voltage", None, None, 8
        ).over_values
        for speed in (10.0, 900_000.0)
    ]
    assert ranges[0] == ranges[1]
    speed, asked = 8000 * 2 * math.pi / 3200, 282e-7 * (8000**2 - 4000**2) / 32 * 2 * math.pi / 3200 + 0.0295
    impedance, constant = math.hypot(1.4, 50 * speed * 3e-3), 0.59 / (math.sqrt(2) * 2)
    needed = asked * impedance / (0.85 * constant) + constant * speed * 1.4 / impedance
    assert needed < 24
    assert (ranges[0][0], ranges[0][-1]) == pytest.approx((needed / 3, 48))
