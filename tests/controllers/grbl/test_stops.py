"""A grbl's stops, which are final."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from itertools import count

import pytest

from controllers.bench import only_rejection
from controllers.grbl.bench import Bench, at, by, to
from controllers.grbl.emulator import GrblEmulator
from controllers.interruption import interruptions
from designs import design
from stepramp.controllers.contract import Activity, AnswerUnknown, AxisCommand
from stepramp.controllers.grbl.controller import GrblController
from stepramp.controllers.grbl.jog import furthest
from stepramp.controllers.grbl.machine import GrblMachine
from stepramp.controllers.grbl.numbers import target
from stepramp.errors import DeviceLost, Refused

MOTIONS: dict[str, Callable[[GrblMachine], None]] = {
    "move_by": lambda controller: controller.move_by([by(2000)]),
    "move_to": lambda controller: controller.move_to([to(2000)]),
    "line": lambda controller: controller.line([by(2000), by(900, 1)]),
    "run": lambda controller: controller.run([at(900)]),
}


@pytest.mark.parametrize("begin", MOTIONS)
def test_a_stop_slows_down_with_the_ramp(bench: Bench, controller: GrblController, begin: str) -> None:
    MOTIONS[begin](controller)
    bench.ask_for(0.9)
    at_stop = bench.grbl.position[0]
    controller.stop()
    axis = controller.status().axes[0]
    assert axis.activity is Activity.STOPPING
    assert at_stop < axis.target_steps < 2000
    rested = bench.rest().axes[0]
    assert (rested.position_steps, bench.grbl.state) == (bench.grbl.position[0], "Idle")
    # v² / 2a with 2500 steps/s², and what asking took.
    assert rested.position_steps - at_stop < axis.speed_steps_per_s**2 / 5000 + 100
    bench.pass_time(5)
    assert bench.grbl.position[0] == rested.position_steps


def stopped_anywhere(
    bench: Bench, controller: GrblMachine, stop: str, begin: str, is_on_its_way: bool, answers_after_s: float
) -> int:
    """Stop a motion at each place where it gives way, one after the other, and return how many there are."""
    bench.lasts_s = 0.003

    def stop_and_look() -> None:
        getattr(controller, stop)()
        controller.status()

    for interruption in interruptions(bench, stop_and_look):
        bench.grbl.answers_after_s = 0.0
        if is_on_its_way:
            controller.move_by([by(-3000)])
            bench.ask_for(0.3)
        bench.grbl.answers_after_s = answers_after_s
        with interruption, suppress(AnswerUnknown, Refused):
            MOTIONS[begin](controller)
        if not interruption.came:
            return interruption.place
        bench.ask_for(1.2)
        assert not bench.grbl.is_moving, interruption.place
        assert bench.grbl.state in ("Idle", "Alarm"), interruption.place
        steps = bench.grbl.steps
        bench.pass_time(1)
        assert bench.grbl.steps == steps, interruption.place
        controller.set_position([to(0), to(0, 1)])
    raise AssertionError


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("begin", MOTIONS)
@pytest.mark.parametrize("is_on_its_way", [False, True])
@pytest.mark.parametrize("answers_after_s", [0.0, 0.02])
def test_a_stop_at_any_place_of_a_motion_is_final(
    bench: Bench, controller: GrblController, stop: str, begin: str, is_on_its_way: bool, answers_after_s: float
) -> None:
    places = stopped_anywhere(bench, controller, stop, begin, is_on_its_way, answers_after_s)
    assert places >= (1 if answers_after_s else 0)


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_stop_while_a_run_is_told_to_go_on_is_final(bench: Bench, controller: GrblController, stop: str) -> None:
    bench.grbl.answers_after_s = 0.02
    for interruption in interruptions(bench, getattr(controller, stop)):
        controller.run([at(900)])
        bench.pass_time(0.6)
        with interruption:
            status = controller.status()
        if not interruption.came:
            break
        assert status.axes[0].activity is not Activity.MOVING, interruption.place
        bench.ask_for(2.4)
        steps = bench.grbl.steps
        bench.pass_time(3)
        assert (bench.grbl.steps, bench.grbl.is_moving) == (steps, False), interruption.place
        controller.set_position([to(0)])
    assert interruption.place >= 1
    controller.stop()


def test_a_halt_makes_no_further_step_and_says_what_is_lost(bench: Bench, controller: GrblController) -> None:
    controller.run([at(900)])
    bench.ask_for(1.2)
    controller.halt()
    steps = bench.grbl.steps
    status = controller.status()
    assert (status.activity, bench.grbl.state) == (Activity.READY, "Alarm")
    assert status.trouble is not None
    assert "it was halted while it moved" in status.trouble
    bench.pass_time(3)
    assert bench.grbl.steps == steps
    with pytest.raises(Refused, match="set the position here, which unlocks it"):
        controller.move_by([by(5)])
    controller.set_position([to(0)])
    controller.move_by([by(5)])
    assert (bench.rest().axes[0].position_steps, bench.grbl.steps) == (5, steps + 5)


def test_a_halt_at_rest_resets_nothing(bench: Bench, controller: GrblController) -> None:
    """Start-up lines are carried out after a reset: they may move something."""
    bench.grbl.eeprom.startup[0] = "G0X50"
    controller.halt()
    bench.pass_time(2)
    assert (bench.grbl.steps, bench.grbl.state) == (0, "Idle")


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_nothing_that_a_reset_would_carry_out_sets_out_by_a_stop(bench: Bench, stop: str) -> None:
    bench.grbl.eeprom.startup[0], bench.grbl.starts_on_open = "G1 X90 F500", False
    bench.controller.connect()
    bench.grbl.answers_after_s = 0.02
    for interruption in interruptions(bench, getattr(bench.controller, stop)):
        with interruption, suppress(AnswerUnknown):
            bench.controller.move_by([by(2000)])
        if not interruption.came:
            break
        bench.ask_for(1.2)
        assert bench.grbl.state in ("Idle", "Alarm"), interruption.place
        steps = bench.grbl.steps
        bench.pass_time(1)
        assert (bench.grbl.steps, bench.grbl.is_moving) == (steps, False), interruption.place
        bench.controller.set_position([to(0)])
    assert interruption.place > 0
    bench.controller.stop()


def test_a_stop_of_what_somebody_else_has_started_holds_and_drops_it(bench: Bench, controller: GrblController) -> None:
    bench.grbl.run_program("G1X30F400", "G1X0F400")
    bench.pass_time(1)
    assert controller.status().activity is Activity.MOVING
    controller.stop()
    bench.rest()
    bench.rest()
    assert bench.grbl.state == "Idle"
    # Held first, so that it still knows where it is.
    assert controller.status().axes[0].position_steps == bench.grbl.position[0] > 0
    steps = bench.grbl.steps
    bench.grbl.exchange(b"~")
    bench.pass_time(3)
    assert bench.grbl.steps == steps


def test_what_is_held_is_not_dropped_where_a_reset_would_move_something(bench: Bench) -> None:
    bench.grbl.eeprom.startup[1] = "G1 X5 F100"
    bench.grbl.starts_on_open = False
    bench.controller.connect()
    bench.grbl.run_program("G1X30F400")
    bench.pass_time(1)
    bench.controller.stop()
    bench.pass_time(2)
    trouble = bench.controller.status().trouble
    assert bench.grbl.state == "Hold"
    assert trouble is not None
    assert "on hold" in trouble


@pytest.mark.parametrize("may_reset", [True, False])
def test_what_goes_on_as_its_door_was_closed_is_reset_or_the_stop_is_refused(
    bench: Bench, controller: GrblController, monkeypatch: pytest.MonkeyPatch, may_reset: bool
) -> None:
    """In these states grbl takes no hold: what it does next would go on after a stop that was answered."""
    monkeypatch.setattr(bench.grbl, "state", "Door")
    monkeypatch.setattr(bench.grbl, "part", 3)
    monkeypatch.setattr(controller._stopping, "_may_reset", lambda: may_reset)
    if may_reset:
        controller.stop()
        assert bench.grbl.state in ("Alarm", "Idle")
        return
    with pytest.raises(Refused, match="takes no stop meanwhile: open the door, or cut the power"):
        controller.stop()


def test_a_run_that_comes_to_the_furthest_place_that_can_be_told_ends(bench: Bench, controller: GrblController) -> None:
    [scale, *_] = controller._places.axes
    begin = furthest(scale) - 2000
    bench.grbl.position[0], bench.grbl._mm[0] = begin, begin / float(scale.steps_per_mm)
    controller.status()
    controller.run([at(1000)])
    for _ in range(30):
        status = controller.status()
        bench.pass_time(0.3)
    assert status.activity is Activity.READY
    assert bench.grbl.position[0] > begin


def test_a_run_beyond_the_furthest_place_is_refused_by_its_speed(bench: Bench, controller: GrblController) -> None:
    [scale, *_] = controller._places.axes
    way = controller._moves._ahead({0: 1000, 1: 100}, 0.0)[0]
    begins = count(furthest(scale) - way + 1)
    begin = next(place for place in begins if target(place + way, scale.steps_per_mm) is None)
    bench.grbl.position[0], bench.grbl._mm[0] = begin, begin / float(scale.steps_per_mm)
    controller.status()
    bench.grbl.lines.clear()
    field, value, allowed = only_rejection(lambda: controller.run([at(1000), at(100, 1)]))
    assert (field, value) == ("speed_steps_per_s", 1000)
    most = allowed.removeprefix("no faster than ").partition(" ")[0]
    assert f"that way, or the other way: each place up to {furthest(scale):,} steps" in allowed
    assert not any(line.startswith("$J") for line in bench.grbl.lines)
    controller.run([at(float(most)), at(100, 1)])


def test_homing_is_ended_by_a_reset(bench: Bench, controller: GrblController) -> None:
    bench.grbl.go_home()
    controller.stop()
    assert bench.grbl.state == "Alarm"


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("lost", [0, 1, 2])
def test_a_stop_gets_through_though_bytes_are_lost(
    bench: Bench, controller: GrblController, stop: str, lost: int
) -> None:
    controller.run([at(900)])
    bench.ask_for(0.9)
    counted = count()
    bench.grbl.on_the_way_in = lambda sent: b"" if next(counted) == lost else sent
    getattr(controller, stop)()
    bench.grbl.on_the_way_in = lambda sent: sent
    bench.ask_for(3)
    assert not bench.grbl.is_moving


def test_a_jog_without_an_answer_is_stopped_blindly(bench: Bench, controller: GrblController) -> None:
    bench.grbl.on_the_way_out = lambda _: b""
    with pytest.raises(DeviceLost):
        controller.move_by([by(5000)])
    bench.pass_time(1)
    steps = bench.grbl.steps
    bench.pass_time(3)
    assert (bench.grbl.steps, bench.grbl.is_moving) == (steps, False)


def test_a_stop_while_settings_are_written_loses_none(
    bench: Bench, grbl: GrblEmulator, controller: GrblController
) -> None:
    for interruption in interruptions(bench, controller.stop):
        controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0)()
        with interruption:
            report = controller.prepare_push([design()], 0)()
        if not interruption.came:
            break
        assert report.verified, interruption.place
        assert grbl.eeprom.settings[110] == 240.0, interruption.place
    assert interruption.place > 1
    assert grbl.steps == 0


def test_all_axes_stop_whichever_is_named(bench: Bench, controller: GrblController) -> None:
    controller.run([at(400), AxisCommand(1, -200, "speed_steps_per_s")])
    bench.ask_for(1.2)
    controller.stop([1])
    bench.rest()
    assert bench.grbl.state == "Idle"
