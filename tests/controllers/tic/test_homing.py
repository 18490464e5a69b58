"""Homing, which a Tic does only when somebody at its USB port asks for it: as its Control Center can."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import at, by, to
from controllers.tic.bench import Bench
from controllers.tic.emulator import HALTED, POSITION, VELOCITY, TicEmulator
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import Refused

FULL_SPEED = 10_000_000
"""1000 steps/s"""


@pytest.fixture
def homing(bench: Bench, tic: TicEmulator, controller: TicController) -> TicEmulator:
    """Return a Tic that rested at 50 steps, was kept up there, and has been looking for its home for 0.3 s."""
    controller.move_by(by(50))
    bench.rest()
    tic.homing_speed_towards = FULL_SPEED
    tic.go_home(-1)
    bench.pass_time(0.3)
    assert tic.velocity == -FULL_SPEED
    return tic


def test_a_motor_that_homes_is_told_to_move(bench: Bench, controller: TicController, homing: TicEmulator) -> None:
    for pressed in (False, True):
        homing.press("reverse_limit", pressed)
        status = controller.status()
        [axis] = status.axes
        assert (axis.activity, axis.target_steps, status.trouble) == (Activity.MOVING, axis.position_steps, None)
        bench.pass_time(0.05)
    homing.press("reverse_limit", False)
    status = bench.rest()
    assert (status.axes[0].position_steps, homing.position, status.trouble) == (0, 0, None)
    assert not homing.is_homing


def test_homing_is_not_taken_for_a_motion_that_a_switch_ended(
    bench: Bench, controller: TicController, homing: TicEmulator
) -> None:
    """It waits for 20 ms at the switch, with what it goes towards still ahead."""
    homing.press("reverse_limit")
    status = controller.status()
    assert homing.velocity == 0
    assert (homing.is_homing, status.activity, status.trouble) == (True, Activity.MOVING, None)
    bench.pass_time(0.05)
    assert homing.velocity > 0


def test_what_needs_a_motor_at_rest_is_refused_while_it_homes(controller: TicController, homing: TicEmulator) -> None:
    refusals: dict[str, Callable[[], object]] = {
        "The motor moves: stop it first": controller.prepare_push([design()], 0, "try"),
        "The motor moves": lambda: controller.set_position(to(0)),
        "The motor": lambda: controller.zero([0], 5),
        "it isn't known yet where it comes to rest": lambda: controller.move_by(by(5)),
    }
    for words, ask in refusals.items():
        with pytest.raises(Refused, match=words):
            ask()
    assert homing.is_homing


def test_a_target_takes_over_from_homing(bench: Bench, controller: TicController, homing: TicEmulator) -> None:
    controller.move_to(to(-1000))
    assert (homing.is_homing, homing.told) == (False, (POSITION, -1000))
    assert bench.rest().axes[0].position_steps == -1000
    homing.go_home(-1)
    controller.run(at(200))
    assert (homing.is_homing, homing.told) == (False, (VELOCITY, 2_000_000))


@pytest.mark.parametrize("ask", [lambda each: each.move_to(to(30)), lambda each: each.run(at(-1000))])
def test_a_tic_that_homes_on_is_stopped_and_the_target_refused(
    bench: Bench, controller: TicController, homing: TicEmulator, ask: Callable[[TicController], None]
) -> None:
    """Though it homes at the very speed that was asked for."""
    homing.targets_end_homing = False
    with pytest.raises(Refused, match=r"^The Tic can't move: it goes on homing\.$"):
        ask(controller)
    bench.pass_time(1)
    assert (homing.is_homing, homing.velocity, homing.told) == (False, 0, (HALTED, 0))


@pytest.mark.parametrize("targets_end_homing", [True, False])
@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("at_the_switch", [True, False])
def test_stop_and_halt_end_homing(
    bench: Bench,
    controller: TicController,
    homing: TicEmulator,
    stop: str,
    targets_end_homing: bool,
    at_the_switch: bool,
) -> None:
    homing.targets_end_homing = targets_end_homing
    homing.press("reverse_limit", at_the_switch)
    getattr(controller, stop)()
    bench.pass_time(1)
    assert (homing.is_homing, homing.velocity) == (False, 0)
    assert homing.told in ((VELOCITY, 0), (HALTED, 0))
    steps = homing.steps
    homing.press("reverse_limit", False)
    assert bench.rest().axes[0].position_steps == homing.position
    bench.pass_time(1)
    assert homing.steps == steps


def test_homing_of_a_tic_that_nobody_has_moved_is_told_too(bench: Bench, tic: TicEmulator) -> None:
    tic.command_timeout_ms = 0
    bench.controller.connect()
    bench.exchange(b"\x83")
    bench.pass_time(0.1)
    tic.go_home(1)
    bench.pass_time(0.1)
    assert bench.controller.status().activity is Activity.MOVING
    bench.controller.stop()
    bench.pass_time(0.5)
    assert (tic.is_homing, tic.velocity) == (False, 0)
    assert bench.controller.status().activity is Activity.READY
