"""Moves and runs of a Tic."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import POLL_S, at, by, only_rejection, to
from controllers.tic.bench import Bench
from controllers.tic.emulator import NORMAL, SOFT_ERROR, VELOCITY
from stepramp.controllers.contract import Activity, AxisCommand
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import Refused, Rejected


def test_moving(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(3000))
    # Target, then leaving safe start; its motor was never switched off on purpose.
    assert bench.told() == [0xE0, 0x83]
    assert controller.status().activity is Activity.MOVING
    bench.pass_time(0.5)
    [axis] = controller.status().axes
    assert (axis.activity, axis.target_steps) == (Activity.MOVING, 3000)
    # 0.2 s up to 1000 steps/s take 100 steps, then 0.3 s, and what asking took.
    assert axis.position_steps == pytest.approx(400, abs=80)
    assert axis.steps_made == axis.position_steps
    assert axis.speed_steps_per_s == pytest.approx(1000)
    status = bench.rest()
    assert (status.axes[0].position_steps, status.axes[0].target_steps, status.trouble) == (3000, 3000, None)
    assert (status.motors_on, status.axes[0].steps_made, bench.tic.steps) == (True, 3000, 3000)
    controller.move_to(to(-1000))
    assert bench.rest().axes[0].position_steps == bench.tic.position == -1000
    assert controller.status().axes[0].steps_made == 4000


def test_a_move_counts_as_begun_once_the_tic_acts_on_it(bench: Bench, controller: TicController) -> None:
    """It does so a moment after it was told; until then it looks as if it rested at the target before."""
    controller.move_by(by(100))
    bench.rest()
    bench.lasts_s = 0.0
    controller.move_by(by(-100))
    assert controller.status().activity is Activity.MOVING
    controller.run(at(-100))
    [axis] = controller.status().axes
    assert axis.target_steps == axis.position_steps


def test_moves_count_from_the_target(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(1000))
    bench.pass_time(0.3)
    controller.move_by(by(-400))
    assert bench.rest().axes[0].position_steps == 600
    controller.run(at(-300))
    with pytest.raises(Refused, match="it isn't known yet where it comes to rest"):
        controller.move_by(by(5))


def test_a_move_is_kept_from_timing_out_as_long_as_somebody_asks(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(20_000))
    bench.pass_time(0.1)
    assert bench.rest().axes[0].position_steps == 20_000
    # And is held, for the next one to begin at once.
    for _ in range(20):
        controller.status()
        bench.pass_time(POLL_S)
    assert (bench.tic.state, bench.tic.energized) == (NORMAL, True)


def test_a_tic_that_nobody_asks_stops_by_itself_and_says_why(bench: Bench, controller: TicController) -> None:
    bench.tic.disable_safe_start = True
    controller.run(at(1000))
    bench.pass_time(3)
    assert (bench.tic.velocity, bench.tic.state) == (0, SOFT_ERROR)
    steps = bench.tic.steps
    # 1 s, and 0.2 s of slowing down, which takes 100 steps.
    assert 900 < steps < 1100
    status = controller.status()
    assert status.trouble == "The Tic has stopped by itself: it heard no command for longer than its command timeout."
    for _ in range(10):
        controller.status()
        bench.pass_time(POLL_S)
    assert bench.tic.steps == steps
    controller.move_by(by(10))
    assert bench.rest().trouble is None
    assert bench.tic.steps == steps + 10


@pytest.mark.parametrize("speed", [1000, -1000, 0.0007, -0.00079, 12.34567])
def test_running(bench: Bench, controller: TicController, speed: float) -> None:
    controller.run(at(speed))
    assert bench.tic.told == (VELOCITY, int(speed * 10_000))
    bench.pass_time(0.5)
    [axis] = controller.status().axes
    assert (axis.activity, axis.target_steps) == (Activity.MOVING, axis.position_steps)
    controller.run(at(0))
    assert bench.rest().axes[0].position_steps == bench.tic.position


@pytest.mark.parametrize("speed", [0.0006, -1e-9])
def test_speeds_that_are_slower_than_a_tic_runs(bench: Bench, controller: TicController, speed: float) -> None:
    told = only_rejection(lambda: controller.run(at(speed)))
    assert told == ("speed_steps_per_s", speed, "a number from 0.0007 to 1,000 steps/s either way, or 0")
    assert bench.told() == []


@pytest.mark.parametrize("speed", [1000.0002, -1001])
def test_speeds_that_a_tic_would_not_run_at(bench: Bench, controller: TicController, speed: float) -> None:
    field, value, allowed = only_rejection(lambda: controller.run(at(speed)))
    assert (field, value) == ("speed_steps_per_s", speed)
    assert allowed.startswith(
        "from -1,000 to 1,000 steps/s, the full speed of the ramp in use, and 0 or at least 0.0007"
    )
    assert bench.told() == []


def test_what_a_tic_can_be_told_is_told_as_limits_of_the_field(controller: TicController) -> None:
    """What they tell is allowed, and one more isn't."""

    def limits_of(call: Callable[[], object]) -> tuple[float | None, float | None, str]:
        with pytest.raises(Rejected) as caught:
            call()
        limits = caught.value.rejections[0].limits
        assert limits is not None
        return limits.lowest, limits.highest, limits.unit

    assert limits_of(lambda: controller.run(at(1001))) == (-1000, 1000, "steps/s")
    controller.set_position(to(1000))
    beyond = -(2**31), 2**31 - 1, "steps"
    assert limits_of(lambda: controller.set_position(to(2**31))) == beyond
    lowest, highest = -(2**31) + 1001, 2**31 - 1
    assert limits_of(lambda: controller.move_to(to(lowest - 1))) == (lowest, highest, "steps")
    assert limits_of(lambda: controller.move_to(to(highest + 1))) == (lowest, highest, "steps")
    assert limits_of(lambda: controller.move_by(by(2**31))) == (lowest - 1000, highest - 1000, "steps")


@pytest.mark.parametrize("ask", ["move_by", "move_to", "run", "set_position"])
def test_other_axes_are_not_there(controller: TicController, ask: str) -> None:
    for field, named in (("by_steps", "axis"), ("axes.0.by_steps", "axes.0.axis")):
        rejected = only_rejection(lambda field=field: getattr(controller, ask)([AxisCommand(2, 5, field)]))
        assert rejected == (named, 2, "0: a Tic has one axis")
    twice = [AxisCommand(0, 5, "axes.0.by_steps"), AxisCommand(0, 6, "axes.1.by_steps")]
    assert only_rejection(lambda: getattr(controller, ask)(twice)) == ("axes.1.axis", 0, "each axis once")


def test_positions_that_a_tic_cant_count_to(bench: Bench, controller: TicController) -> None:
    controller.set_position(to(2**31 - 1))
    assert only_rejection(lambda: controller.move_by(by(1)))[:2] == ("by_steps", 1)
    assert only_rejection(lambda: controller.set_position(to(-(2**31) - 1)))[:2] == ("to_steps", -(2**31) - 1)
    # A Tic would go there the other way, past the last position to the first.
    field, value, allowed = only_rejection(lambda: controller.move_to(to(-(2**31))))
    assert (field, value) == ("to_steps", -(2**31))
    assert "the shorter way round" in allowed
    assert bench.told() == [0xEC]
    assert bench.tic.steps == 0


def test_setting_the_position_and_zeroing(bench: Bench, controller: TicController) -> None:
    controller.set_position(to(-70_000))
    assert (bench.tic.position, bench.tic.position_uncertain, bench.tic.steps) == (-70_000, False, 0)
    assert controller.status().axes[0].position_steps == -70_000
    assert only_rejection(lambda: controller.zero([0, 1], 40)) == ("axes", 1, "0: a Tic has one axis")
    controller.zero([0, 0], 40)
    assert bench.rest().axes[0].position_steps == 0
    assert bench.tic.steps == 40


def test_a_limit_switch_on_the_way(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(1000))
    bench.pass_time(0.3)
    bench.tic.press("forward_limit")
    status = bench.rest()
    assert status.axes[0].target_steps == status.axes[0].position_steps < 1000
    assert status.trouble == "The Tic has stopped at a limit switch: it does not go on when the switch is released."
    bench.tic.press("forward_limit", False)
    bench.pass_time(5.0)
    assert bench.rest().axes[0].position_steps == status.axes[0].position_steps
