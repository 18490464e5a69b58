"""What a Marlin's axes are told: ways, where they lead, what is seen of them, and what is refused."""

from __future__ import annotations

import pytest

from controllers.bench import at, by, only_rejection, to
from controllers.marlin.bench import Bench
from controllers.marlin.emulator import MarlinEmulator
from stepramp.controllers.contract import Activity, AxisCommand
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.errors import Refused, Rejected


def test_a_move_is_one_way_from_where_it_is(bench: Bench, controller: MarlinController) -> None:
    controller.move_by(by(-1001))
    # 1001 / 80 mm, at twice the 500 mm/s that its axis has at most.
    assert bench.told() == ["G91", "G1 X-12.51250 F60000", "G90"]
    status = controller.status()
    assert (status.activity, status.motors_on) == (Activity.MOVING, True)
    assert [axis.activity for axis in status.axes] == [Activity.MOVING, *[Activity.READY] * 3]
    assert status.axes[0].target_steps == -1001
    rested = bench.rest().axes[0]
    assert (rested.position_steps, rested.target_steps, rested.steps_made) == (-1001, -1001, 1001)
    assert bench.marlin.position == [-1001, 0, 0, 0]


@pytest.mark.parametrize("tells", ["targets", "places", "places at rest"])
@pytest.mark.parametrize("has_realtime", [False, True])
def test_where_it_is_on_its_way_whatever_its_firmware_tells(
    bench: Bench, controller: MarlinController, tells: str, has_realtime: bool
) -> None:
    bench.marlin.tells, bench.marlin.has_realtime = tells, has_realtime
    controller.move_by(by(40_000))
    for _ in range(8):
        status = controller.status()
        axis = status.axes[0]
        assert (status.activity, axis.target_steps) == (Activity.MOVING, 40_000)
        # 40,000 steps/s² after 0.1 s.
        assert axis.position_steps == pytest.approx(bench.marlin.position[0], abs=0.02 * 40_000)
        assert axis.speed_steps_per_s == pytest.approx(bench.marlin.planner._speed * 80, abs=0.05 * 40_000)
        bench.pass_time(0.1)
    assert bench.rest().axes[0].position_steps == bench.marlin.position[0] == 40_000


def test_axes_that_are_told_together_go_along_a_line(bench: Bench, controller: MarlinController) -> None:
    controller.line([*by(8000), *by(-4000, 1), *by(200, 2)])
    bench.pass_time(0.3)
    first, second, _, fourth = controller.status().axes
    assert first.speed_steps_per_s == pytest.approx(2 * second.speed_steps_per_s, rel=0.01)
    assert (second.activity, fourth.activity) == (Activity.MOVING, Activity.READY)
    bench.rest()
    assert bench.marlin.position == [8000, -4000, 200, 0]
    with pytest.raises(Rejected, match="ramp_axis is 0; allowed: null: along a line Marlin keeps to the limits"):
        controller.line(by(10), 0)


def test_nothing_else_is_told_while_something_moves(bench: Bench, controller: MarlinController) -> None:
    controller.move_by(by(8000))
    for ask in (
        lambda: controller.move_by(by(5)),
        lambda: controller.move_to(to(0)),
        lambda: controller.run(at(100)),
        lambda: controller.set_position(to(0)),
    ):
        with pytest.raises(Refused, match="The motor moves: wait until it rests, or stop it first"):
            ask()
    bench.rest()
    assert bench.marlin.position[0] == 8000


def test_what_somebody_else_moves_is_seen_and_left_alone(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.move_as_somebody_else(Y=4000)
    with pytest.raises(Refused, match="Something moves that was not asked for here"):
        controller.move_by(by(5))
    assert controller.status().activity is Activity.MOVING
    assert bench.rest().axes[1].position_steps == 4000
    assert bench.told() == []


def test_while_it_prints_nothing_is_moved_or_written(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.prints_a_file = True
    for ask in (lambda: controller.move_by(by(50)), lambda: controller.run(at(100)), controller.backup):
        with pytest.raises(Refused, match="carries out a file of its own"):
            ask()
    assert bench.told() == []


def test_a_run_goes_on_as_long_as_somebody_asks(bench: Bench, controller: MarlinController) -> None:
    controller.run(at(-500))
    bench.ask_for(9)
    axis = controller.status().axes[0]
    assert axis.runs
    assert axis.speed_steps_per_s == pytest.approx(500, abs=1)
    assert axis.position_steps == pytest.approx(bench.marlin.position[0], abs=30)
    # Its queue is short.
    assert len(bench.marlin.planner.blocks) < 6
    bench.pass_time(30)
    left = controller.status().axes[0]
    assert left.activity is Activity.READY
    assert 500 * 9 < -left.position_steps == -bench.marlin.position[0] < 500 * 12


@pytest.mark.parametrize(("speed", "end"), [(2000, 7003), (-2000, -6001)])
def test_a_run_leads_no_further_than_its_end(bench: Bench, controller: MarlinController, speed: int, end: int) -> None:
    controller.set_position(to(100))
    controller.keep_within({0: (-5901, 7103)})
    controller.run(at(speed))
    bench.ask_for(9.0)
    status = controller.status()
    assert (status.activity, status.trouble) == (Activity.READY, None)
    assert (bench.marlin.position[0], status.axes[0].position_steps) == (end, end + 100)


def test_a_run_never_slows_down_on_its_way(bench: Bench, controller: MarlinController) -> None:
    controller.run(at(2000))
    bench.ask_for(0.9)
    for _ in range(20):
        before = bench.marlin.position[0]
        bench.pass_time(0.1)
        assert bench.marlin.position[0] - before == pytest.approx(200, abs=30)
        controller.status()
    controller.stop()


def test_runs_of_several_axes_and_what_they_are_told(bench: Bench, controller: MarlinController) -> None:
    controller.run([*at(400), *at(-200, 1)])
    bench.ask_for(2.4)
    assert bench.marlin.position[0] == pytest.approx(-2 * bench.marlin.position[1], abs=4)
    controller.run(at(400))
    with pytest.raises(Refused, match="Axes that run keep their speeds: stop them first"):
        controller.run(at(300))
    controller.run([*at(0), *at(0, 1)])
    assert not bench.marlin.is_moving
    controller.run(at(0))
    assert [axis.position_steps for axis in bench.rest().axes] == bench.marlin.position


def test_speeds_beyond_what_it_can(controller: MarlinController) -> None:
    field, value, allowed = only_rejection(lambda: controller.run(at(40_001)))
    assert (field, value) == ("speed_steps_per_s", 40_001)
    assert allowed.startswith("from -40,000 to 40,000 steps/s, the highest speed of the axis")
    _, _, allowed = only_rejection(lambda: controller.run(at(-0.5)))
    assert allowed.startswith("a number from 1 to 40,000")


def test_places_that_float32_cant_tell_are_refused_by_name(bench: Bench, controller: MarlinController) -> None:
    field, value, allowed = only_rejection(lambda: controller.move_to(to(2**22 + 1)))
    assert (field, value) == ("to_steps", 2**22 + 1)
    assert "up to 4,194,304 steps" in allowed
    assert bench.told() == []


def test_a_run_beyond_the_furthest_place_is_refused_by_its_speed(bench: Bench, controller: MarlinController) -> None:
    controller.move_to(to(-(2**22) + 900))
    bench.pass_time(10_000)
    controller.status()
    bench.marlin.lines.clear()
    field, value, allowed = only_rejection(lambda: controller.run(at(-2000)))
    assert (field, value) == ("speed_steps_per_s", -2000)
    assert allowed.startswith("no faster than ")
    assert bench.told() == []
    controller.run(at(-float(allowed.removeprefix("no faster than ").partition(" ")[0])))
    status = bench.ask_for(10)
    assert status.activity is Activity.READY
    assert -(2**22) <= status.axes[0].position_steps < -(2**22) + 900
    controller.move_to(to(-(2**22)))
    bench.pass_time(10)
    controller.status()
    _, _, allowed = only_rejection(lambda: controller.run(at(-2000)))
    assert allowed.startswith("0, or the other way: each place up to 4,194,304 steps from where the controller counts")
    controller.run(at(2000))


def test_axes_that_are_not_there(controller: MarlinController) -> None:
    two = [AxisCommand(0, 5, "axes.0.by_steps"), AxisCommand(4, 5, "axes.1.by_steps")]
    assert only_rejection(lambda: controller.move_by(two)) == ("axes.1.axis", 4, "an axis of this controller: 0 to 3")


def test_ways_add_up_to_the_step(bench: Bench, controller: MarlinController) -> None:
    """80 steps/mm, 93 of the extruder: no step is a number of decimals."""
    sent = [0, 0]
    for steps in (7, 13, -1001, 11, 3333, -7, 6) * 3:
        controller.move_by([*by(steps), *by(steps * 2, 3)])
        bench.rest()
        sent = [sent[0] + steps, sent[1] + 2 * steps]
        assert [bench.marlin.position[0], bench.marlin.position[3]] == sent


def test_a_way_counts_from_where_it_is_whoever_has_told_it_something_else(
    bench: Bench, controller: MarlinController
) -> None:
    controller.move_by(by(800))
    bench.rest()
    # As G92 does, or a way that was left out.
    bench.marlin._mm["X"] += 0.5
    bench.marlin.planner.targets["X"] += 40
    bench.marlin.planner.counts["X"] += 40
    controller.status()
    controller.move_by(by(80))
    assert bench.rest().axes[0].position_steps == bench.marlin.position[0] == 920


def test_positions_are_called_something_else_without_telling_it(bench: Bench, controller: MarlinController) -> None:
    controller.move_by(by(500))
    bench.rest()
    before = len(bench.told())
    controller.set_position([*to(7), *to(-3, 2)])
    assert [axis.position_steps for axis in controller.status().axes] == [7, 0, -3, 0]
    assert (bench.told()[before:], bench.marlin.eeprom.writes) == ([], 0)
    controller.move_to(to(-93))
    bench.rest()
    assert bench.marlin.position == [400, 0, 0, 0]


def test_what_marlin_leaves_out_is_told(bench: Bench, controller: MarlinController) -> None:
    controller.move_by(by(5))
    status = bench.rest()
    assert (status.axes[0].position_steps, bench.marlin.position[0]) == (0, 0)
    assert status.trouble is not None
    assert "short of its target: X 5 steps. Marlin leaves out ways of fewer than 6 steps" in status.trouble
    controller.move_by(by(12))
    assert bench.rest().axes[0].position_steps == 12
    assert controller.status().trouble is None


def test_its_own_soft_limits_are_told(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.soft_limit_mm = 10.0
    controller.move_by(by(1000))
    status = bench.rest()
    assert status.axes[0].position_steps == 800
    assert "X 200 steps" in (status.trouble or "")


def test_a_cold_extruder_is_told(bench: Bench, marlin: MarlinEmulator, controller: MarlinController) -> None:
    marlin.is_hot = False
    with pytest.raises(Refused, match="leaves the extruder where it is: cold extrusion prevented"):
        controller.move_by(by(300, 3))
    assert bench.marlin.steps == 0
    assert bench.rest().activity is Activity.READY


def test_an_extruder_that_cools_as_it_runs_comes_to_rest(
    bench: Bench, marlin: MarlinEmulator, controller: MarlinController
) -> None:
    controller.run(at(400, 3))
    bench.ask_for(0.6)
    marlin.is_hot = False
    status = bench.rest()
    assert "cold extrusion prevented" in (status.trouble or "")
    assert bench.marlin.position[3] > 0


def test_a_way_that_is_refused_leaves_it_taking_places(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.has_errors = True
    with pytest.raises(Refused, match=r"refuses 'G1 X1\.25000 F60000': Printer stopped due to errors"):
        controller.move_by(by(100))
    assert not bench.marlin._is_relative
    assert bench.marlin.position[0] == 0
    bench.marlin.has_errors = False
    controller.run(at(500))
    bench.ask_for(0.9)
    bench.marlin.has_errors = True
    status = bench.rest()
    assert "Printer stopped due to errors" in str(status.trouble)
    assert not bench.marlin._is_relative
    assert status.axes[0].position_steps == bench.marlin.position[0] > 0


def test_one_that_is_busy_with_something_else_is_waited_for(bench: Bench, controller: MarlinController) -> None:
    """As while it heats for somebody at the machine."""
    bench.marlin.heats_until_s = bench.clock.now_s + 20
    bench.pass_time(2.1)
    assert controller.status().activity is Activity.MOVING
    with pytest.raises(Refused, match="Something moves that was not asked for here"):
        controller.move_by(by(50))
    for stop in (controller.stop, controller.halt):
        with pytest.raises(Refused, match="It is busy, as while it heats, and doesn't say yet"):
            stop()
    assert not bench.marlin.is_killed
    assert bench.rest().activity is Activity.READY
    controller.move_by(by(50))
    assert bench.rest().axes[0].position_steps == bench.marlin.position[0] == 50


def test_a_long_move_though_nothing_else_is_answered_meanwhile(bench: Bench, controller: MarlinController) -> None:
    """It says that it is busy every 2 s."""
    bench.marlin.tells = "places at rest"
    controller.move_by(by(20_000, 2))
    for _ in range(6):
        axis = bench.ask_for(1.2).axes[2]
        assert axis.activity is Activity.MOVING
        assert axis.position_steps == pytest.approx(bench.marlin.position[2], abs=0.35 * 2000)
    assert bench.rest().axes[2].position_steps == bench.marlin.position[2] == 20_000
