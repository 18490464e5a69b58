"""A module's motions: to places, at speeds, and what ends them."""

from __future__ import annotations

import pytest

from controllers.bench import at, by, only_rejection, to
from controllers.tmcl.bench import Bench
from controllers.tmcl.chip import POSITION
from controllers.tmcl.emulator import AMAX, GAP, MST, MVP, ROL, ROR, SAP, TmclEmulator
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.errors import Refused


def test_a_move_is_told_as_a_target_and_watched_to_its_end(bench: Bench, controller: TmclController) -> None:
    controller.move_by(by(-600))
    assert (MVP, 0, 0, -600) in bench.module.commands
    assert (GAP, 0, 0, 0) in bench.module.commands
    bench.pass_time(0.5)
    [axis] = controller.status().axes
    assert (axis.activity, axis.target_steps) == (Activity.MOVING, -600)
    assert axis.speed_steps_per_s == pytest.approx(999, abs=2)
    assert axis.steps_made == -axis.position_steps > 100
    assert bench.rest().axes[0].position_steps == bench.module.chip.position == -600


def test_moves_by_steps_add_up_from_the_target(bench: Bench, controller: TmclController) -> None:
    controller.move_by(by(500))
    controller.move_by(by(-1200))
    assert bench.rest().axes[0].position_steps == -700
    assert controller.status().axes[0].steps_made == 700


def test_a_run_goes_on_and_turns_and_stops(bench: Bench, controller: TmclController) -> None:
    controller.run(at(500.9))
    bench.pass_time(1)
    [axis] = controller.status().axes
    assert (axis.activity, axis.runs, axis.speed_steps_per_s) == (Activity.MOVING, True, 499)
    with pytest.raises(Refused, match="it isn't known yet where it comes to rest"):
        controller.move_by(by(5))
    controller.run(at(-300))
    bench.pass_time(1)
    assert bench.module.chip.speed == pytest.approx(-299.4, abs=1)
    controller.run(at(0))
    assert bench.rest().axes[0].target_steps == bench.module.chip.position
    assert [command for command in bench.told() if command in (ROR, ROL)] == [ROR, ROL]


@pytest.mark.parametrize("speed", [500, -500])
def test_a_run_that_is_told_to_have_ended_has_ended(bench: Bench, controller: TmclController, speed: int) -> None:
    # Quicker than the module's own slices of time: its end is seen in the midst of the last one.
    bench.lasts_s = 0.0003
    for _ in range(30):
        controller.run(at(speed))
        bench.pass_time(0.37)
        controller.stop()
        while (status := controller.status()).activity is not Activity.READY:
            pass
        bench.pass_time(0.1)
        assert status.axes[0].position_steps == bench.module.chip.position


def test_a_run_is_taken_over_by_a_move(bench: Bench, controller: TmclController) -> None:
    controller.run(at(500))
    bench.pass_time(0.5)
    controller.move_to(to(-100))
    assert bench.rest().axes[0].position_steps == -100


@pytest.mark.parametrize(
    ("speed", "allowed"),
    [(1000.5, "the full speed of the ramp in use"), (-2000, "from -999 to 999 steps/s"), (0.5, "from 1 to 999")],
)
def test_speeds_beyond_the_ramp_in_use(controller: TmclController, speed: float, allowed: str) -> None:
    field, value, words = only_rejection(lambda: controller.run(at(speed)))
    assert (field, value, allowed in words) == ("speed_steps_per_s", speed, True)


@pytest.mark.parametrize(
    ("ask", "allowed"),
    [
        (lambda controller: controller.move_to(to(2**31)), "a target from -2,147,483,648"),
        (lambda controller: controller.move_by(by(-(2**31) - 5)), "a target from -2,147,483,648"),
        (lambda controller: controller.set_position(to(2**31)), "a target from -2,147,483,648"),
        (lambda controller: controller.move_to(to(5, axis=1)), "an axis of this controller: 0 to 0"),
        (lambda controller: controller.move_to([*to(5), *to(6)]), "each axis once"),
    ],
)
def test_what_a_module_cant_be_told(bench: Bench, controller: TmclController, ask: object, allowed: str) -> None:
    assert allowed in only_rejection(lambda: ask(controller))[2]
    assert bench.told() == []


def test_a_way_round_is_rejected(controller: TmclController) -> None:
    controller.set_position(to(2_000_000_000))
    assert "a module goes the shorter way round" in only_rejection(lambda: controller.move_to(to(-2_000_000_000)))[2]


def test_a_position_is_set_at_rest_without_a_step(bench: Bench, controller: TmclController) -> None:
    controller.move_by(by(60))
    bench.rest()
    bench.module.commands.clear()
    controller.set_position(to(-5))
    assert [command for command in bench.module.commands if command[0] in (MST, SAP)] == [
        (MST, 0, 0, 0), (SAP, 1, 0, -5), (SAP, 0, 0, -5)
    ]  # fmt: skip
    bench.pass_time(1)
    assert (bench.module.chip.position, bench.module.chip.target, bench.module.chip.steps) == (-5, -5, 60)
    controller.move_by(by(10))
    assert bench.rest().axes[0].position_steps == 5


def test_axes_are_moved_each_on_its_own(six: Bench) -> None:
    six.controller.move_by([*by(200), *by(-50, axis=3)])
    assert [axis.position_steps for axis in six.rest().axes] == [200, 0, 0, -50]
    six.controller.run([*at(100, axis=1), *at(-80, axis=2)])
    six.pass_time(1)
    six.controller.stop([1])
    six.pass_time(1)
    first, second = (six.controller.status().axes[axis] for axis in (1, 2))
    assert (first.activity, second.activity) == (Activity.READY, Activity.MOVING)
    six.controller.stop()
    six.rest()


def test_what_doesnt_take_its_target_stops_all_that_were_told_together(six: Bench) -> None:
    take = six.module._move
    six.module._move = lambda motor, command, value: (
        take(motor, command, value) if motor is not six.module.motors[1] or command == MST else None
    )
    with pytest.raises(Refused, match="Axis 1 doesn't take what it is told"):
        six.controller.move_by([*by(5000), *by(5000, axis=1)])
    six.pass_time(3)
    assert [motor.chip.speed for motor in six.module.motors] == [0] * 6
    assert six.module.chip.position < 5000


def test_a_motor_beyond_those_shown_keeps_the_module_from_being_written(six: Bench) -> None:
    chip = six.module.motors[5].chip
    chip.mode, chip.vmax = 1, 500
    six.pass_time(1)
    with pytest.raises(Refused, match="Motor 5 of the module moves"):
        six.controller.prepare_push([design()], 0, "try")()
    six.controller.stop()
    six.pass_time(3)
    assert chip.speed == 0


def test_at_a_limit_switch_it_is_stopped_and_does_not_go_on(bench: Bench, controller: TmclController) -> None:
    controller.move_to(to(5000))
    bench.pass_time(0.5)
    bench.module.press("forward_switch")
    status = bench.rest()
    assert "Axis 0 has stopped by itself at" in (status.trouble or "")
    where = bench.module.chip.position
    bench.module.press("forward_switch", False)
    bench.pass_time(2)
    assert bench.module.chip.position == where < 5000
    controller.move_to(to(0))
    assert bench.rest().trouble is None


@pytest.mark.parametrize(("number", "words"), [(4, "VMAX is 0"), (5, "AMAX is 0"), (20, "VSTOP is 0")])
def test_a_ramp_with_which_a_move_would_never_end_is_not_moved_with(bench: Bench, number: int, words: str) -> None:
    bench.module.motors[0].settings[number] = 0
    bench.controller.connect()
    assert words in (bench.controller.status().trouble or "")
    with pytest.raises(Refused, match=words):
        bench.controller.move_by(by(5))
    assert bench.told() == []


def test_what_a_halt_has_left_is_not_moved_with(bench: Bench) -> None:
    bench.module.motors[0].settings[AMAX] = 65_535
    bench.controller.connect()
    with pytest.raises(Refused, match="the acceleration of a halt that was cut short"):
        bench.controller.run(at(50))
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.run(at(50))
    assert bench.controller.status().trouble is None


def test_the_chip_s_own_units(bench: Bench, module: TmclEmulator) -> None:
    module.motors[0].settings[255] = 0
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.run(at(500))
    bench.pass_time(1)
    assert bench.controller.status().axes[0].speed_steps_per_s == pytest.approx(524 * 16e6 / 2**24)
    bench.controller.halt()
    assert (module.chip.speed, module.motors[0].settings[AMAX]) == (0, 42)
    bench.controller.move_to(to(30))
    assert bench.rest().axes[0].position_steps == 30
    assert module.chip.mode == POSITION
