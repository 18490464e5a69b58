"""Answers of the controller that are lost, and what must not be done twice then."""

from __future__ import annotations

from concurrent.futures import Future

import pytest

from devices.bench import MOTIONS, STOPS, Bench, by, run
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, RunRequest, StopRequest
from stepramp.controllers.stepramp.messages.ramps import CommitRequest
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.devices.leases import Lease
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused


def test_what_is_refused_after_its_answer_was_lost_is_stopped(bench: Bench) -> None:
    """A stop of another axis comes before the repeat: whoever asked is told no, so the axis must not run on."""
    bench.reset()
    bench.witness.seen.clear()
    bench.witness.loses = 1  # The first is asked where the traced axis is.
    stopped: list[object] = []

    def stop_the_other() -> None:
        if RunRequest.KIND in bench.witness.seen and not stopped:
            stopped.append(bench.device.stop([1]))
        else:
            bench.places.choose(0, stop_the_other)

    bench.places.choose(0, stop_the_other)
    with pytest.raises(Refused, match="A stop came first"):
        run(bench, bench.devices.order.next())
    bench.places.chosen = None
    assert stopped
    sent = bench.witness.seen
    assert sent.count(RunRequest.KIND) == 1
    assert StopRequest.KIND in sent[sent.index(RunRequest.KIND) :]
    bench.look()
    assert bench.device.view.axes[0].state is not DeviceState.MOVING


def test_a_move_whose_answer_was_lost_is_not_carried_out_twice(bench: Bench) -> None:
    """A jog of the other axis is let go before the repeat, which the controller would then take for another move."""
    bench.reset()
    lease = Lease({1: 400.0}, 1e6)
    bench.device.run([AxisCommand(1, 400.0, "speed_steps_per_s")], lease)
    bench.witness.seen.clear()
    bench.witness.loses = 1  # The first is asked where the traced axis is.

    def let_go() -> None:
        if MoveByRequest.KIND in bench.witness.seen:
            bench.device.end_run(lease)
        else:
            bench.places.choose(0, let_go)

    bench.places.choose(0, let_go)
    with pytest.raises(Refused, match="answer was lost"):
        bench.device.move_by([by(600)])
    bench.places.chosen = None
    assert bench.witness.seen.count(MoveByRequest.KIND) == 1
    bench.settle()
    assert bench.device.view.position_steps < 600


def stop_while_looking_again(bench: Bench, place: int) -> None:
    """Let the answer to a commit be lost, and a stop come before its repeat: it is looked what the controller has.

    At a place of that, there is one more stop.
    """
    bench.device.use_settings(StepRampSettings(pulse_width_us=5 + place))
    bench.witness.seen.clear()
    bench.witness.loses = 2  # Both axes are asked first whether they move.
    bench.witness.lasts_s = 0.5  # It is soon stored.
    stopped: list[Future[None]] = []

    def stop_before_the_repeat() -> None:
        if CommitRequest.KIND in bench.witness.seen:
            stopped.append(bench.device.stop())
            bench.places.choose(0, stop_once_more)
        else:
            bench.places.choose(0, stop_before_the_repeat)

    def stop_once_more() -> None:
        if stopped[0].done():
            bench.places.choose(place, lambda: stopped.append(bench.device.stop()))
        else:
            bench.places.choose(0, stop_once_more)

    bench.places.choose(0, stop_before_the_repeat)
    with pytest.raises(Refused, match="answer was lost"):
        bench.device.keep()
    assert len(stopped) == 2
    bench.witness.lasts_s = 0.0
    for each in stopped:
        each.result(PATIENCE_S)
    assert bench.device.view.state is DeviceState.READY, bench.device.view.message


def test_a_stop_while_it_is_looked_what_the_controller_has_loses_no_device(bench: Bench) -> None:
    # The hello, and what is asked next, with a place before and after each.
    for place in range(20):
        stop_while_looking_again(bench, place)
    assert bench.device.settings().pulse_width_us == 24


@pytest.mark.parametrize("way", ["move", "there and back"])
def test_what_is_told_as_failed_after_it_was_granted_is_stopped(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    """Whoever asked hears of a mistake and expects no motion: the look at what has set out goes wrong once."""
    bench.reset()
    look, failed = bench.watch.refresh, []

    def refresh() -> None:
        if MoveByRequest.KIND in bench.witness.seen and not failed:
            failed.append(1)
            raise ZeroDivisionError
        look()

    monkeypatch.setattr(bench.watch, "refresh", refresh)
    shuttle, leg = Shuttle(0, 50_000, 3, 0.0, None), by(50_000)
    with pytest.raises(ZeroDivisionError):
        bench.device.move_by([leg]) if way == "move" else bench.device.go_there_and_back(shuttle, leg)
    motions = [kind for kind in bench.witness.seen if kind in MOTIONS | STOPS]
    assert motions == [MoveByRequest.KIND, StopRequest.KIND]
    bench.settle()
    assert bench.device.view.position_steps < 50_000
    assert bench.device.view.shuttle is None
