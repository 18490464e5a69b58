"""A Tic's stops, which are final."""

from __future__ import annotations

from contextlib import suppress

import pytest

from controllers.bench import at, to
from controllers.interruption import interruptions
from controllers.tic.bench import Bench
from controllers.tic.damage import losing
from controllers.tic.emulator import GO_TO_POSITION, HALTED, SOFT_ERROR, VELOCITY
from stepramp.controllers.contract import Activity, AnswerUnknown, AxisCommand
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import Refused


@pytest.mark.parametrize("begin", ["move_by", "run"])
def test_a_stop_slows_down_with_the_ramp(bench: Bench, controller: TicController, begin: str) -> None:
    getattr(controller, begin)([AxisCommand(0, -1000, "value")])
    bench.pass_time(0.4)
    at_stop = bench.tic.position
    controller.stop()
    [axis] = controller.status().axes
    assert axis.activity is Activity.STOPPING
    # v² / (2 d) = 1000² / (2 · 5000), and what asking took.
    assert axis.target_steps == pytest.approx(at_stop - 100, abs=10)
    bench.pass_time(5)
    assert bench.rest().axes[0].position_steps == pytest.approx(axis.target_steps, abs=2)
    assert (bench.tic.told, bench.tic.state) == ((VELOCITY, 0), SOFT_ERROR)


def test_a_halt_makes_no_further_step(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.pass_time(0.4)
    controller.halt()
    steps = bench.tic.steps
    bench.pass_time(5)
    assert (bench.tic.steps, bench.tic.told) == (steps, (HALTED, 0))
    assert controller.status().axes[0].position_steps == bench.tic.position == steps


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("begin", ["move_by", "move_to", "run", "zero"])
@pytest.mark.parametrize("guarded", [True, False])
def test_a_stop_at_any_place_of_a_motion_is_final(
    bench: Bench, controller: TicController, stop: str, begin: str, guarded: bool
) -> None:
    """At each place where it gives way, one after the other, until there is no further one. It is looked at, too."""
    bench.tic.disable_safe_start, bench.lasts_s = not guarded, 0.02

    def stop_and_look() -> None:
        getattr(controller, stop)()
        controller.status()

    for interruption in interruptions(bench, stop_and_look):
        with interruption, suppress(AnswerUnknown):
            controller.zero([0], 500) if begin == "zero" else getattr(controller, begin)([AxisCommand(0, 900, "value")])
        if not interruption.came:
            break
        bench.pass_time(3)
        assert bench.tic.told in ((VELOCITY, 0), (HALTED, 0)), interruption.place
        assert bench.tic.velocity == 0, interruption.place
        controller.set_position(to(0))
    assert interruption.place > 5


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("lost", range(16))
def test_a_stop_gets_through_though_bytes_are_lost(
    bench: Bench, controller: TicController, stop: str, lost: int
) -> None:
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.on_the_way_in = losing(lost)
    getattr(controller, stop)()
    bench.pass_time(0.5)
    assert bench.tic.velocity == 0
    assert bench.tic.told in ((VELOCITY, 0), (HALTED, 0))


def test_a_stop_ends_what_the_tic_does_in_error(bench: Bench, controller: TicController) -> None:
    """A Tic may be set to go somewhere when there is an error, whatever it was told last."""
    bench.tic.soft_error_response, bench.tic.soft_error_position = GO_TO_POSITION, 100_000
    controller.run(at(-200))
    bench.pass_time(0.3)
    bench.tic.press("kill_switch")
    bench.pass_time(0.5)
    assert bench.tic.velocity > 0
    controller.stop()
    bench.pass_time(1)
    assert bench.tic.velocity == 0


def test_a_tic_that_obeys_no_stop_is_told_so(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.tic.control_mode = 1
    for stop, word in ((controller.stop, "stop"), (controller.halt, "halt")):
        with pytest.raises(Refused, match=f"doesn't {word} when it is told to: cut the power of its motor"):
            stop()


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_status_tells_what_is_seen_after_a_stop_in_its_midst(
    bench: Bench, controller: TicController, stop: str
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
    assert interruption.place > 3
