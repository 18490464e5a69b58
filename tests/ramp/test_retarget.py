"""Targets and speeds that change in flight. What a motor does of them is tested by itself (test_virtual_motion)."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.ramp.plan import plan_of, ramp_of
from stepramp.ramp.retarget import Command, PlayedSteps, played_towards
from stepramp.ramp.slopes import slopes_of

SHAPES: list[dict[str, Any]] = [
    {"name": "constant"},
    {"name": "s_curve", "jerk_steps_per_s3": 50_000},
    {"name": "cosine"},
    {"name": "drawn", "points": [[0, 1], [1000, 0.3]]},
]
HZ = 2_000_000


def shaped(shape: dict[str, Any], method: str = "exact", **changes: Any) -> Design:
    return design(schema="stepramp/2", ramp__shape=shape, method={"name": method}, **changes)


def to(at_s: float, target: int) -> Command:
    return Command(at_s, target_steps=target)


def at_speed(at_s: float, speed: float) -> Command:
    return Command(at_s, speed_steps_per_s=speed)


def intervals(played: PlayedSteps) -> list[int]:
    return np.diff(played.at_ticks).tolist()


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape["name"])
@pytest.mark.parametrize("method", ["exact", "midpoint", "newton", "table"])
def test_one_target_from_rest_is_the_move_of_the_plan(shape: dict[str, Any], method: str) -> None:
    asked = shaped(shape, method, move={"steps": -1500, "plan": "any_move"})
    played = played_towards(asked, [to(0.5, -1500)], 5)
    planned = plan_of(asked).intervals
    assert played.at_ticks[0] == 0.5 * HZ
    assert intervals(played) == planned[:-1].tolist()
    assert played.rest_at_ticks.tolist() == [0.5 * HZ + planned.sum()]
    assert played.rest_position_steps.tolist() == [-1500]
    assert set(played.direction.tolist()) == {-1}


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape["name"])
def test_a_nearer_target_in_flight_is_passed_and_come_back_to(shape: dict[str, Any]) -> None:
    asked = shaped(shape, move={"steps": 1, "plan": "any_move"})
    ramp = ramp_of(asked)
    full = int(ramp.up.sum()) / HZ + 0.2
    played = played_towards(asked, [to(0, 5000), to(full, 10)], 5)
    # It slows down along the whole ramp, turns, and comes back to where it was to go.
    down = ramp.down[::-1].tolist()
    turned = int(np.flatnonzero(np.diff(played.direction))[0]) + 1
    assert np.diff(played.at_ticks)[turned - 1 - len(down) + 1 : turned - 1].tolist() == down[:-1]
    assert played.at_ticks[turned] - played.at_ticks[turned - 1] == down[-1] + 10  # 5 µs of 2 MHz
    assert played.rest_position_steps.tolist() == [10]
    assert np.array_equal(played.position_steps, np.cumsum(played.direction))


def test_a_speed_is_kept_until_it_is_told_otherwise() -> None:
    asked = shaped(SHAPES[1], move={"steps": 1, "plan": "any_move"})
    played = played_towards(asked, [at_speed(0, 400), at_speed(1, 800), at_speed(2, -200), at_speed(3, 0)], 5)
    speeds = HZ / np.diff(played.at_ticks)
    times = played.at_ticks[:-1] / HZ
    for from_s, to_s, speed in ((0.6, 1, 400), (1.4, 2, 800), (2.8, 3, 200)):
        assert speeds[(times > from_s) & (times < to_s - 0.01)] == pytest.approx(speed, rel=1e-3)
    assert played.direction[-1] == -1
    assert played.rest_at_ticks.size == 1


@given(
    st.sampled_from(SHAPES),
    st.lists(
        st.tuples(st.floats(0, 0.6), st.integers(-900, 900) | st.sampled_from([-900.0, -50.0, 0.0, 300.0, 1000.0])),
        min_size=1, max_size=6,
    ),
)  # fmt: skip
def test_no_command_in_flight_exceeds_speed_or_acceleration(
    shape: dict[str, Any], told: list[tuple[float, int | float]]
) -> None:
    asked = shaped(shape, timer__frequency_hz=1e8, move={"steps": 1, "plan": "any_move"})
    at, commands = 0.0, []
    for wait, what in told:
        at += wait
        commands.append(at_speed(at, what) if isinstance(what, float) else to(at, what))
    commands.append(to(at + 0.1, 77))
    played = played_towards(asked, commands, 5)
    assert np.array_equal(played.position_steps, np.cumsum(played.direction))
    assert played.rest_position_steps[-1] == 77 if played.at_ticks.size else True
    gaps = np.diff(played.at_ticks)
    is_turn = np.diff(played.direction) != 0
    # A motor at rest waits as long as it is told nothing.
    ends = np.isin(played.at_ticks[1:], np.array(sorted(round(each.at_s * 1e8) for each in commands)))
    speeds = np.where(is_turn | ends, 0, 1e8 / gaps)
    assert speeds.max(initial=0) <= 1000 * (1 + 1e-4)
    steepest = max(slope.acceleration for slope in slopes_of(asked))
    implied = np.abs(np.diff(speeds**2)) / 2
    along = (speeds[1:] > 0) & (speeds[:-1] > 0)
    # The first step of a ramp from rest begins at no speed.
    assert implied[along].max(initial=0) <= steepest * (1 + 1e-2)


@pytest.mark.parametrize(
    ("commands", "field", "allowed"),
    [
        ([at_speed(0, 5)], "commands.0.speed_steps_per_s", "0 in the last command, or a target"),
        ([at_speed(0, 1001), to(1, 0)], "commands.0.speed_steps_per_s", "from -1,000 to 1,000 steps/s, the slew speed"),
        ([to(0, 9_000_000), to(20_000, -9_000_000)], "commands", "moves of at most 10,000,000 steps in all"),
    ],
)
def test_what_is_never_done_is_refused(commands: list[Command], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        played_towards(design(), commands, 5)
    [rejection] = caught.value.rejections
    assert rejection.field == field
    assert allowed in rejection.allowed


def test_the_slew_speed_itself_is_no_higher_than_the_slew_speed() -> None:
    # 62.5 ticks: halves are rounded up, for a command as for the ramp.
    fast = design(timer__frequency_hz=1e6, ramp__slew_speed_steps_per_s=16_000, move__steps=90_000)
    played = played_towards(fast, [at_speed(0, 16_000), at_speed(4, 0)], 5)
    assert played.interval_ticks.min() == 63


def test_the_peak_of_a_move_that_is_planned_by_itself_is_called_so() -> None:
    short = shaped({"name": "cosine"}, move__steps=100)
    with pytest.raises(Rejected, match="the peak speed of the ramp that is made for a move of 100 steps"):
        played_towards(short, [at_speed(0, 500), at_speed(1, 0)], 5)


def test_a_long_table_takes_as_few_commands_as_a_long_ramp() -> None:
    table = design(method__name="table", table__rows=[[10_000_000, 1000]], move__steps=5)
    with pytest.raises(Rejected, match=r"commands is 101; allowed: a whole number from 1 to 100 commands"):
        played_towards(table, [to(each, 5) for each in range(101)], 5)


@pytest.mark.parametrize("commands", [1, 2])
def test_a_ramp_that_cannot_be_made_says_so_itself(commands: int) -> None:
    endless = design(ramp__acceleration_steps_per_s2=0.001, ramp__slew_speed_steps_per_s=30_000, move__steps=5)
    with pytest.raises(Rejected, match=r"ramp.acceleration_steps_per_s2 is 0\.001; allowed: at least 45 steps/s²"):
        played_towards(endless, [to(each, 5) for each in range(commands)], 5)


def test_too_many_commands_for_a_long_ramp_are_refused() -> None:
    long = design(ramp__acceleration_steps_per_s2=0.1, move__steps=5)
    with pytest.raises(Rejected, match=r"commands is 1000; allowed: .* to 200 commands for so long a ramp"):
        played_towards(long, [to(each, 5) for each in range(1000)], 5)
