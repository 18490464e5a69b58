"""A stop that was answered is final: at every place where what sets motors moving gives way, a stop is asked for.

Deterministic: the motors' clock stands still unless it is set, nothing polls unless it is told to, and the stop is
asked for from within the port's own thread at the k-th place that it passes, for every k.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress

import pytest

from designs import design
from devices.bench import MOTIONS, STOPS, Bench, by, home, run
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, StopRequest
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.leases import Lease
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused, StepRampError

ANSWERED = "the stop was answered"
MOST_PLACES = 400


def changed_on_its_way(bench: Bench, asked: int) -> None:
    bench.device.move_by([by(2000)], asked)
    bench.clock.now_s += 0.5
    bench.device.move_to([AxisCommand(0, -300, "to_steps")], asked)


def there_and_back(bench: Bench, asked: int) -> None:
    bench.device.go_there_and_back(Shuttle(0, 50, 3, 0.0), by(50), asked)
    for _ in range(3):
        bench.clock.now_s += 100.0
        bench.poll()
        bench.poll()


def jog_and_renew(bench: Bench, asked: int) -> None:
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease, asked)
    bench.clock.now_s += 0.3
    lease.renew()
    bench.poll()
    bench.device.run([AxisCommand(0, -200.0, "speed_steps_per_s")], Lease({0: -200.0}, 1e6), asked)


def traced_move(bench: Bench, asked: int) -> None:
    bench.device.trace_moves(0, 1)
    bench.device.move_by([by(300)], asked)
    bench.clock.now_s += 100.0
    bench.device.move_by([by(-300)], asked)


def push_then_move(bench: Bench, asked: int) -> None:
    bench.device.push([design(), design()], mode="try")
    bench.device.move_by([by(300)], asked)


def homed_and_called(bench: Bench, asked: int) -> None:
    home(bench, asked, position_steps=1000)
    for _ in range(3):
        bench.clock.now_s += 0.5
        bench.poll()
    if not bench.places.chosen:
        return
    axis = bench.device.view.axes[0]
    assert (axis.position_known, axis.position_steps) == (True, 999), "it was not homed where nothing stopped it"


SCENARIOS: dict[str, Callable[[Bench, int], None]] = {
    "move": lambda bench, asked: bench.device.move_by([by(300), by(-200, 1)], asked),
    "change": changed_on_its_way,
    "line": lambda bench, asked: bench.device.line([by(300), by(-200, 1)], None, asked),
    "run": run,
    "jog": jog_and_renew,
    "shuttle": there_and_back,
    "trace": traced_move,
    "push": push_then_move,
    "home": homed_and_called,
    "zero": lambda bench, asked: bench.device.zero([0], 90, asked),
}


def stop_at(bench: Bench, place: int, stop: str, scenario: Callable[[Bench, int], None], *, loses: int | None) -> bool:
    """Let a scenario be stopped at a place; return whether it came to that. What must never happen fails."""
    bench.reset()
    answered = threading.Event()

    def ask_to_stop() -> None:
        gate = ExitStack()
        gate.enter_context(bench.device.being_stopped())

        def answer(_: object) -> None:
            gate.close()
            bench.witness.seen.append(ANSWERED)
            bench.answered_s = bench.clock.now_s
            answered.set()

        getattr(bench.device, stop)().add_done_callback(answer)

    bench.places.choose(place, ask_to_stop)
    bench.witness.loses = loses
    asked = bench.devices.order.next()
    with suppress(StepRampError):
        scenario(bench, asked)
    came_to_it = bench.places.chosen is None
    bench.places.chosen = bench.witness.loses = None
    if came_to_it:
        assert answered.wait(PATIENCE_S)
        judge(bench)
    return came_to_it


def judge(bench: Bench) -> None:
    """Nothing sets out after the answer, what moves comes to rest, and what is asked afterwards works."""
    see_that_the_newest_is_shown(bench)
    after = bench.witness.seen[bench.witness.seen.index(ANSWERED) + 1 :]
    assert not MOTIONS & set(after), "it set out after the stop was answered"
    stopped_at = next(index for index, kind in enumerate(bench.witness.seen) if kind in STOPS)
    assert not MOTIONS & set(bench.witness.seen[stopped_at:]), "it set out after the stop itself"
    bench.settle()
    for _ in range(3):
        bench.clock.now_s += 100.0
        bench.poll()
    assert not MOTIONS & set(bench.witness.seen[stopped_at:]), "a leg that was due set out"
    before = [axis.position_steps for axis in bench.device.view.axes]
    assert bench.device.view.shuttle is None
    bench.device.move_by([by(7)])
    bench.settle()
    assert bench.device.view.position_steps == before[0] + 7


def see_that_the_newest_is_shown(bench: Bench) -> None:
    """What was asked before a stop and told after it isn't shown as new, as long as the motors' clock stands still."""
    if bench.clock.now_s == bench.answered_s and not bench.watch.is_view_old:
        shown = bench.device.view.axes
        bench.look()
        assert bench.device.view.axes == shown


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_stop_at_any_place_is_final(bench: Bench, name: str, stop: str) -> None:
    tried = 0
    while tried < MOST_PLACES and stop_at(bench, tried, stop, SCENARIOS[name], loses=None):
        tried += 1
    # At least: the check, the request, its answer and the question after it, each with a place before and after.
    assert 16 <= tried < MOST_PLACES


@pytest.mark.parametrize("name", ["move", "line", "run", "trace", "home", "zero"])
def test_a_stop_at_any_place_is_final_when_answers_are_lost(bench: Bench, name: str) -> None:
    for loses in range(3):
        place = 0
        while place < MOST_PLACES and stop_at(bench, place, "stop", SCENARIOS[name], loses=loses):
            place += 1
        assert 16 <= place < MOST_PLACES


def test_a_stop_comes_before_the_port_does(bench: Bench) -> None:
    """The stop is asked for and answered while a request is still on its way to the port's thread."""
    for name, scenario in SCENARIOS.items():
        bench.reset()
        asked = bench.devices.order.next()
        bench.device.stop().result(PATIENCE_S)
        with pytest.raises(Refused, match="A stop came first"):
            scenario(bench, asked)
        assert not MOTIONS & set(bench.witness.seen), name


def test_nothing_moves_while_a_stop_is_being_answered(bench: Bench) -> None:
    bench.reset()
    with bench.device.being_stopped():
        bench.device.stop().result(PATIENCE_S)
        with pytest.raises(Refused, match="A stop came first"):
            bench.device.move_by([by(50)])
    assert not MOTIONS & set(bench.witness.seen)
    bench.device.move_by([by(50)])


def test_a_stop_of_one_device_leaves_the_other_alone(bench: Bench, plug_in: Callable) -> None:
    bench.reset()
    other = bench.devices.connect(plug_in(VirtualController()))
    asked = bench.devices.order.next()
    other.stop().result(PATIENCE_S)
    bench.device.move_by([by(50)], asked)
    assert bench.device.view.target_steps == 50


def test_a_stop_shows_what_has_set_out_though_something_was_looked_at_meanwhile(bench: Bench) -> None:
    """A jog of the other axis is let go of before the move is sent, and a stop comes before the move is looked at."""
    bench.reset()
    lease = Lease({1: 400.0}, 1e6)
    bench.device.run([AxisCommand(1, 400.0, "speed_steps_per_s")], lease)
    bench.witness.seen.clear()
    shown: list[DeviceState] = []

    def stop() -> None:
        if MoveByRequest.KIND not in bench.witness.seen:
            bench.places.choose(0, stop)
            return
        bench.clock.now_s += 0.05
        stopped = bench.device.stop()
        stopped.add_done_callback(lambda _: shown.append(bench.device.view.axes[0].state))

    def let_go() -> None:
        bench.device.end_run(lease)
        bench.places.choose(0, stop)

    bench.places.choose(0, let_go)
    with suppress(StepRampError):
        bench.device.move_by([by(5000)])
    bench.places.chosen = None
    assert shown == [DeviceState.STOPPING]


def test_a_stop_of_an_axis_that_is_not_there_stops_all_and_says_so(bench: Bench) -> None:
    bench.reset()
    bench.device.run([AxisCommand(1, 400.0, "speed_steps_per_s")], Lease({1: 400.0}, 1e6))
    bench.device.move_by([by(5000)])
    bench.clock.now_s += 0.1
    bench.device.stop([3]).result(PATIENCE_S)
    assert [axis.state for axis in bench.device.view.axes] == [DeviceState.STOPPING] * 2
    assert bench.device._runs._leases.speeds == {}


def test_a_stop_tells_no_target_that_is_not_reached(bench: Bench) -> None:
    """Where it will come to rest is asked afterwards: the stop's answer needn't wait for it."""
    bench.reset()
    bench.device.move_by([by(5000), by(900, 1)])
    bench.clock.now_s += 0.1
    bench.look()
    bench.device.stop([0]).result(PATIENCE_S)
    stopped, moving = bench.device.view.axes
    assert (stopped.state, moving.state) == (DeviceState.STOPPING, DeviceState.MOVING)
    assert 0 < stopped.target_steps == stopped.position_steps == bench.device.view.target_steps
    assert moving.target_steps == 900
    bench.settle()
    rest = bench.device.view.axes[0]
    assert stopped.position_steps < rest.position_steps == rest.target_steps < 5000


def test_the_end_of_the_program_lets_nothing_move_again(bench: Bench) -> None:
    bench.reset()
    bench.device.move_by([by(2000)])
    bench.devices.end_motion()
    assert StopRequest.KIND in bench.witness.seen
    with pytest.raises(Refused, match="A stop came first"):
        bench.device.move_by([by(50)])
    with pytest.raises(Refused, match="is ending"):
        bench.devices.connect("sim://another")
