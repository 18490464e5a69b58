"""A Marlin's stops, which are final, whether it was built with an emergency parser or not."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from itertools import count

import pytest

from controllers.bench import at, by, to
from controllers.interruption import interruptions
from controllers.marlin.bench import Bench
from controllers.marlin.emulator import MarlinEmulator
from designs import design
from stepramp.controllers.contract import Activity, AnswerUnknown
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.errors import DeviceLost, Refused

MOTIONS: dict[str, Callable[[MarlinController], None]] = {
    "move_by": lambda controller: controller.move_by(by(80_000)),
    "move_to": lambda controller: controller.move_to(to(80_000)),
    "line": lambda controller: controller.line([*by(80_000), *by(900, 1)]),
    "run": lambda controller: controller.run(at(9000)),
}


ANSWERED_WITHIN_S = 2.3
"""In which the page says that it waits."""


def stays(bench: Bench, time_s: float = 1.5) -> bool:
    """Tell whether nothing moves, nor sets out within so long."""
    steps = bench.marlin.steps
    still = not bench.marlin.is_moving
    bench.pass_time(time_s)
    return still and bench.marlin.steps == steps and not bench.marlin.is_moving


@pytest.fixture(params=[False, True], ids=["lines only", "emergency parser"], autouse=True)
def _parser(request: pytest.FixtureRequest, marlin: MarlinEmulator) -> None:
    marlin.has_emergency_parser = request.param


@pytest.mark.parametrize("begin", MOTIONS)
def test_a_stop_ends_all_steps_at_once(bench: Bench, controller: MarlinController, begin: str) -> None:
    MOTIONS[begin](controller)
    bench.pass_time(0.5)
    bench.controller.status()
    before, at_s = bench.marlin.position[0], bench.clock.now_s
    controller.stop()
    # Where it was when that was read, a slice or two later; it answers once it takes moves again.
    assert before < bench.marlin.position[0] <= before + 9000 * 0.02
    assert bench.clock.now_s - at_s < ANSWERED_WITHIN_S
    status = controller.status()
    assert (status.activity, status.axes[0].position_steps) == (Activity.READY, bench.marlin.position[0])
    assert stays(bench)
    controller.move_by(by(60))
    assert bench.rest().axes[0].position_steps == bench.marlin.position[0] == status.axes[0].position_steps + 60


@pytest.mark.parametrize(
    ("begin", "stop"),
    [("move_by", "stop"), ("move_by", "halt"), ("move_to", "stop"), ("line", "stop"), ("run", "stop"), ("run", "halt")],
)
def test_a_stop_at_any_place_of_a_motion_is_final(
    bench: Bench, controller: MarlinController, begin: str, stop: str
) -> None:
    """At each place where it gives way, one after the other, until there is no further one. It is looked at, too."""
    # It gives way several times before a line that was sent is carried out, and before that is answered.
    bench.marlin.answers_after_s, bench.lasts_s = 0.003, 0.0007

    def stop_and_look() -> None:
        steps, at_s = bench.marlin.steps, bench.clock.now_s
        getattr(controller, stop)()
        assert bench.clock.now_s - at_s < ANSWERED_WITHIN_S, interruption.place
        # Before it is answered, too: a move that sets out meanwhile is ended in the 0.1 s before it begins.
        assert bench.marlin.steps - steps < 5, interruption.place
        controller.status()
        assert not bench.marlin.is_moving, interruption.place

    for interruption in interruptions(bench, stop_and_look):
        with interruption, suppress(AnswerUnknown, Refused):
            MOTIONS[begin](controller)
        if not interruption.came:
            break
        assert stays(bench), interruption.place
        assert not bench.marlin._is_relative, interruption.place
        assert controller.status().activity is Activity.READY, interruption.place
        controller.set_position([*to(0), *to(0, 1)])
    assert interruption.place >= 20


def test_a_move_that_waits_for_a_place_in_the_queue_is_ended_too(bench: Bench, controller: MarlinController) -> None:
    """A quick stop that it reads meanwhile ends what goes on; then that move sets out, as in the real one."""
    bench.marlin.planner.blocks *= 0
    for _ in range(15):
        bench.marlin.move_as_somebody_else(X=2000)
    conversation = controller._conversation
    conversation.ask("G91")
    conversation.start("G1 X5 F600")
    bench.pass_time(0.3)
    controller.stop()
    assert stays(bench)


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_stop_while_a_run_is_told_to_go_on_is_final(bench: Bench, controller: MarlinController, stop: str) -> None:
    bench.marlin.answers_after_s = 0.01
    for interruption in interruptions(bench, getattr(controller, stop)):
        controller.run(at(900))
        bench.pass_time(0.7)
        with interruption:
            status = controller.status()
        if not interruption.came:
            break
        assert status.axes[0].activity is Activity.READY, interruption.place
        assert stays(bench), interruption.place
    assert interruption.place >= 5
    controller.stop()


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("lost", range(4))
def test_a_stop_gets_through_though_bytes_are_lost(
    bench: Bench, controller: MarlinController, stop: str, lost: int
) -> None:
    controller.run(at(900))
    bench.ask_for(0.9)
    counted = count()
    bench.marlin.on_the_way_in = lambda sent: b"" if next(counted) == lost else sent
    getattr(controller, stop)()
    assert stays(bench)


@pytest.mark.parametrize("lost", range(3))
def test_a_stop_gets_through_though_answers_are_lost(bench: Bench, controller: MarlinController, lost: int) -> None:
    controller.move_by(by(80_000))
    bench.pass_time(0.5)
    counted = count()
    bench.marlin.on_the_way_out = lambda said: b"" if next(counted) == lost else said
    controller.stop()
    assert stays(bench)
    assert controller.status().axes[0].position_steps == bench.marlin.position[0]


def test_where_nothing_is_heard_any_more_it_is_stopped_blindly(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.on_the_way_out = lambda _: b""
    with pytest.raises(DeviceLost, match="does not answer"):
        controller.move_by(by(50_000))
    bench.pass_time(1)
    assert stays(bench)
    assert not bench.marlin.is_killed
    assert not bench.marlin._is_relative


@pytest.mark.parametrize("nth", range(8))
def test_where_nothing_more_is_heard_in_the_midst_it_is_left_taking_places(
    bench: Bench, controller: MarlinController, nth: int
) -> None:
    counted = count()
    bench.marlin.on_the_way_out = lambda said: said if next(counted) < nth else b""
    with suppress(DeviceLost, Refused):
        controller.move_by(by(50_000))
        controller.stop()
    bench.pass_time(3)
    assert stays(bench)
    assert not bench.marlin._is_relative


def test_the_last_resort_is_for_a_halt_that_isnt_answered(bench: Bench, controller: MarlinController) -> None:
    controller.run(at(900))
    bench.marlin.on_the_way_out = lambda _: b""
    with pytest.raises(DeviceLost):
        controller.halt()
    bench.pass_time(1)
    assert bench.marlin.is_killed
    assert stays(bench)


def test_a_stop_of_what_somebody_else_moves(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.move_as_somebody_else(Y=40_000)
    bench.pass_time(1)
    controller.stop()
    assert stays(bench)
    assert controller.status().axes[1].position_steps == bench.marlin.position[1] > 0


def test_a_stop_while_settings_are_written_loses_none(bench: Bench, controller: MarlinController) -> None:
    for interruption in interruptions(bench, controller.stop, apart=11):
        controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0)()
        with interruption:
            report = controller.prepare_push([design()], 0)()
        if not interruption.came:
            break
        assert report.verified, interruption.place
        assert bench.marlin.eeprom.settings is not None
        assert bench.marlin.eeprom.settings["M203"]["X"] == 12.5, interruption.place
    assert interruption.place > 20
    assert bench.marlin.steps == 0


def test_all_axes_stop_whichever_is_named(bench: Bench, controller: MarlinController) -> None:
    controller.run([*at(400), *at(-200, 1)])
    bench.ask_for(0.9)
    controller.stop([1])
    assert stays(bench)
