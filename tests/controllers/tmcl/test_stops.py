"""A module's stops, which are final."""

from __future__ import annotations

from contextlib import suppress

import pytest

from controllers.bench import at, by, to
from controllers.interruption import interruptions
from controllers.tic.damage import losing
from controllers.tmcl.bench import Bench
from controllers.tmcl.chip import POSITION
from controllers.tmcl.emulator import AMAX, MST, ROR, SAP
from designs import design
from stepramp.controllers.contract import Activity, AnswerUnknown, AxisCommand
from stepramp.controllers.tmcl import stopping
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.errors import Refused


@pytest.mark.parametrize("begin", ["move_by", "run"])
def test_a_stop_slows_down_with_the_acceleration(bench: Bench, controller: TmclController, begin: str) -> None:
    """Though the deceleration is lower: the chip has but one for that."""
    controller.prepare_push([design(ramp__deceleration_steps_per_s2=500)], 0, "try")()
    getattr(controller, begin)([AxisCommand(0, -990 if begin == "run" else -9000, "value")])
    bench.pass_time(0.4)
    at_stop = bench.module.chip.position
    controller.stop()
    [axis] = controller.status().axes
    assert axis.activity is Activity.STOPPING
    # v² / (2 a) = 990² / (2 · 4889), and what asking took.
    assert axis.target_steps == pytest.approx(at_stop - 100, abs=15)
    bench.pass_time(5)
    # Where it is, it is asked 2 ms after how fast: two steps later; and a step that was only begun isn't made.
    assert bench.rest().axes[0].position_steps == pytest.approx(axis.target_steps, abs=3)
    assert heads_nowhere(bench)


def heads_nowhere(bench: Bench) -> bool:
    return all(motor.chip.mode != POSITION and not motor.chip.vmax for motor in bench.module.motors)


def test_a_halt_is_as_hard_as_the_chip_can(bench: Bench, controller: TmclController) -> None:
    """Where it would have taken 100 steps it takes less than one, and what asking takes; the ramp is as before."""
    controller.run(at(990))
    bench.pass_time(0.4)
    where, before = bench.module.chip.place, dict(bench.module.motors[0].settings)
    bench.lasts_s = 0.001
    controller.halt()
    assert bench.module.chip.speed == 0
    assert bench.module.chip.place - where < 25
    told = [command for command in bench.module.commands if command[0] in (MST, SAP)]
    assert told[:4] == [(MST, 0, 0, 0), (MST, 0, 0, 0), (SAP, AMAX, 0, 7_629_278), (MST, 0, 0, 0)]
    assert bench.module.motors[0].settings == before
    [axis] = controller.status().axes
    assert (axis.activity, axis.position_steps) == (Activity.READY, bench.module.chip.position)


def test_a_halt_at_rest_touches_no_acceleration(bench: Bench, controller: TmclController) -> None:
    controller.halt()
    assert SAP not in bench.told()


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("begin", ["move_by", "move_to", "run"])
def test_a_stop_at_any_place_of_a_motion_is_final(
    bench: Bench, controller: TmclController, stop: str, begin: str
) -> None:
    """At each place where it gives way, one after the other, until there is no further one. It is looked at, too."""
    bench.lasts_s = 0.02

    def stop_and_look() -> None:
        getattr(controller, stop)()
        controller.status()

    for interruption in interruptions(bench, stop_and_look):
        with interruption, suppress(AnswerUnknown):
            getattr(controller, begin)([AxisCommand(0, 900, "value")])
        if not interruption.came:
            break
        bench.pass_time(3)
        assert heads_nowhere(bench), interruption.place
        assert bench.module.chip.speed == 0, interruption.place
        controller.set_position(to(0))
    assert interruption.place >= 5


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("lost", range(27))
def test_a_stop_gets_through_though_bytes_are_lost(
    bench: Bench, controller: TmclController, stop: str, lost: int
) -> None:
    controller.run(at(900))
    bench.pass_time(0.3)
    bench.module.on_the_way_in = losing(lost)
    getattr(controller, stop)()
    bench.pass_time(0.5)
    assert bench.module.chip.speed == 0
    assert heads_nowhere(bench)
    assert bench.module.motors[0].settings[AMAX] == 42


def test_each_axis_is_stopped_at_once_though_answers_are_lost(six: Bench) -> None:
    """None waits for what another answers."""
    six.controller.run([at(100, axis=axis)[0] for axis in range(4)])
    six.module.commands.clear()
    six.module.on_the_way_out = lambda _: b""
    with suppress(Exception):
        six.controller.stop()
    assert six.module.commands[:6] == [(MST, 0, axis, 0) for axis in range(6)]


def test_a_stop_ends_the_program_in_the_module(bench: Bench, controller: TmclController) -> None:
    """Which moves the motor time and again."""
    module = bench.module
    module.program = lambda module: module._move(module.motors[0], ROR, 400)
    bench.pass_time(1)
    assert module.chip.speed > 0
    for stop in (controller.stop, controller.halt):
        module.program = lambda module: module._move(module.motors[0], ROR, 400)
        bench.pass_time(1)
        stop()
        bench.pass_time(2)
        assert (module.program, module.chip.speed) == (None, 0)


def test_a_module_that_obeys_no_stop_is_told_so(bench: Bench, controller: TmclController) -> None:
    controller.run(at(900))
    bench.module.obeys = False
    for stop in (controller.stop, controller.halt):
        with pytest.raises(Refused, match="doesn't stop when it is told to: cut the power of its motor"):
            stop()


def test_a_module_that_never_comes_to_rest_is_told_so(
    bench: Bench, controller: TmclController, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stopping, "REST_S", 0.01)
    controller.run(at(900))
    bench.pass_time(0.3)
    bench.lasts_s = 0.0
    with pytest.raises(Refused, match="doesn't come to rest when it is told to"):
        controller.halt()
    assert bench.module.motors[0].settings[AMAX] == 42


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_status_tells_what_is_seen_after_a_stop_in_its_midst(
    bench: Bench, controller: TmclController, stop: str
) -> None:
    for interruption in interruptions(bench, getattr(controller, stop)):
        controller.set_position(to(0))
        controller.move_to(to(5000))
        bench.pass_time(0.4)
        with interruption:
            status = controller.status()
        if not interruption.came:
            break
        [axis] = status.axes
        assert axis.activity is (Activity.STOPPING if stop == "stop" else Activity.READY), interruption.place
        assert axis.target_steps < 5000, interruption.place
        bench.rest()
    assert interruption.place >= 3


def test_one_axis_is_stopped_and_the_others_go_on(six: Bench) -> None:
    six.controller.move_by([*by(800), *by(800, axis=2)])
    six.controller.halt([0])
    status = six.rest()
    assert status.axes[0].position_steps < 800
    assert status.axes[2].position_steps == 800
