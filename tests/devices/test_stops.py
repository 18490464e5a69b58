"""A stop that was answered is final: at every place where what sets motors moving gives way, a stop is asked for.

Deterministic: the motors' clock stands still unless it is set, nothing polls unless it is told to, and the stop is
asked for from within the port's own thread at the k-th place that it passes, for every k.
"""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from typing import Any

import pytest

from controllers.conftest import Clock
from designs import design
from stepramp.controllers.contract import Asked
from stepramp.controllers.stepramp import conversation, tracing
from stepramp.controllers.stepramp.frames import FrameSplitter
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    StopRequest,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import CommitRequest
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest
from stepramp.controllers.stepramp.messages.status import StatusRequest
from stepramp.controllers.stepramp.settings import Settings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices import attachment, limit_checks, watch
from stepramp.devices import registry as devices_module
from stepramp.devices.attachment import Attachment
from stepramp.devices.device import Device
from stepramp.devices.leases import Lease
from stepramp.devices.owed_stops import OwedStops
from stepramp.devices.registry import Devices
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import FREE, Span
from stepramp.devices.stops import Order
from stepramp.devices.view import DeviceState
from stepramp.devices.watch import Watch
from stepramp.devices.writing import SendPush
from stepramp.errors import DeviceLost, Refused, Rejected, StepRampError
from stepramp.link import protocol_sim
from stepramp.link.ports import Port
from stepramp.link.serial_port import SerialPort
from stepramp.link.worker import Worker

PATIENCE_S = 10.0
WAITED_FOR_S = 0.2
"""How long an answer is waited for before its request is repeated, by decision of the protocol's client."""
MOTIONS = {each.KIND for each in (MoveByRequest, MoveToRequest, RunRequest, LineRequest, ZeroRequest)}
STOPS = {StopRequest.KIND, HaltRequest.KIND}
ANSWERED = "the stop was answered"
MOST_PLACES = 400
POLL = Attachment.poll


class Witness:
    """The virtual controller, what was asked of it, and when stops were answered. It loses answers when told to.

    lasts_s: by how much the motors' clock goes on with each exchange. unanswered: how many requests of a kind get no
    answer, each of them waited for by that clock, too.
    """

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.controller = VirtualController(clock)
        self.seen: list[int | str] = []
        self.loses: int | None = None
        self.lasts_s = 0.0
        self.unanswered: Counter[int] = Counter()
        self._splitter = FrameSplitter()

    def opened(self) -> None:
        self.controller.opened()

    def exchange(self, sent: bytes) -> bytes:
        self.clock.now_s += self.lasts_s
        said = self.controller.exchange(sent)
        for frame in self._splitter.feed(sent):
            message = Message.unpack(frame)
            if message is not None:
                self.seen.append(message.kind)
                if self.unanswered[message.kind] > 0:
                    self.unanswered[message.kind] -= 1
                    self.clock.now_s += WAITED_FOR_S
                    return b""
                if self.loses is not None:
                    self.loses -= 1
                    if self.loses < 0:
                        self.loses = None
                        return b""
        return said


@dataclass
class Places:
    """Where the port's thread gives way, waits, or sends; at the one that is chosen, something is done."""

    chosen: int | None = None
    act: Callable[[], None] = field(default=lambda: None)
    counted: int = 0
    inside: bool = False

    def choose(self, place: int, act: Callable[[], None]) -> None:
        self.chosen, self.act, self.counted = place, act, 0

    def passed(self) -> None:
        if self.chosen is None or self.inside or not threading.current_thread().name.startswith("port"):
            return
        if self.counted == self.chosen:
            self.chosen, self.inside = None, True
            self.act()
            self.inside = False
            return
        self.counted += 1

    def around(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*args: Any, **kwargs: Any) -> Any:
            self.passed()
            try:
                return call(*args, **kwargs)
            finally:
                self.passed()

        return watched


@pytest.fixture
def places(monkeypatch: pytest.MonkeyPatch) -> Places:
    places = Places()
    watched = (Worker, "give_way"), (SerialPort, "write"), (SerialPort, "read"), (protocol_sim.Serial, "write")
    for owner, name in watched:
        monkeypatch.setattr(owner, name, places.around(getattr(owner, name)))
    return places


@dataclass
class Bench:
    """One device with two axes, and what a test needs to watch it."""

    devices: Devices
    device: Device
    witness: Witness
    clock: Clock
    places: Places
    answered_s: float = 0.0

    @property
    def worker(self) -> Worker:
        return worker_of(self.device)

    @property
    def watch(self) -> Watch:
        return self.device._attachment._watch

    def settle(self) -> None:
        """Let whatever moves come to rest, and see it."""
        self.clock.now_s += 10_000.0
        self.look()
        assert self.device.view.state is DeviceState.READY

    def look(self) -> None:
        self.worker.call(self.watch.refresh)

    def poll(self) -> None:
        self.watch.is_view_old = True
        self.worker.call(lambda: POLL(self.device._attachment))

    def reset(self) -> None:
        self.places.chosen = None
        self.witness.loses = None
        self.device.stop().result(PATIENCE_S)
        self.settle()
        with suppress(Refused):
            self.device.trace_moves(0, 1)
        self.device.set_position([Asked(0, 0, "position_steps"), Asked(1, 0, "position_steps")])
        self.witness.seen.clear()


@pytest.fixture
def bench(clock: Clock, places: Places, plug_in: Callable, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    # Answers come at once or not at all, and traces are not waited for: the motors' clock stands still.
    monkeypatch.setattr(conversation, "REPLY_TIMEOUT_S", 0.003)
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.0)
    monkeypatch.setattr(tracing, "LAST_FRAME_WITHIN_S", 0.001)
    monkeypatch.setattr(tracing, "LISTEN_S", 0.001)
    monkeypatch.setattr(protocol_sim, "LISTEN_S", 0.0005)
    devices, witness = Devices(), Witness(clock)
    # Nothing is asked of the controller but what the test asks for.
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    device = devices.connect(plug_in(witness))
    push(device, clock)
    yield Bench(devices, device, witness, clock, places)
    devices.close()


def worker_of(device: Device) -> Worker:
    worker = device._attachment._contact.worker
    assert worker is not None
    return worker


def push(device: Device, clock: Clock) -> None:
    """Push a ramp for two axes; writing it takes time by the controller's clock."""
    pushing = threading.Thread(target=lambda: device.push([design(), design()]))
    pushing.start()
    while pushing.is_alive():
        clock.now_s += 0.1
        pushing.join(0.001)


def by(steps: int, axis: int = 0) -> Asked:
    return Asked(axis, steps, "by_steps")


def run(bench: Bench, asked: int, *, lasts_s: float = 1e6) -> None:
    bench.device.run([Asked(0, 400.0, "speed_steps_per_s")], Lease({0: 400.0}, lasts_s), asked)


def changed_on_its_way(bench: Bench, asked: int) -> None:
    bench.device.move_by([by(2000)], asked)
    bench.clock.now_s += 0.5
    bench.device.move_to([Asked(0, -300, "to_steps")], asked)


def there_and_back(bench: Bench, asked: int) -> None:
    bench.device.go_there_and_back(Shuttle(0, 50, 3, 0.0), by(50), asked)
    for _ in range(3):
        bench.clock.now_s += 100.0
        bench.poll()
        bench.poll()


def jog_and_renew(bench: Bench, asked: int) -> None:
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([Asked(0, 400.0, "speed_steps_per_s")], lease, asked)
    bench.clock.now_s += 0.3
    lease.renew()
    bench.poll()
    bench.device.run([Asked(0, -200.0, "speed_steps_per_s")], Lease({0: -200.0}, 1e6), asked)


def traced_move(bench: Bench, asked: int) -> None:
    bench.device.trace_moves(0, 1)
    bench.device.move_by([by(300)], asked)
    bench.clock.now_s += 100.0
    bench.device.move_by([by(-300)], asked)


def push_then_move(bench: Bench, asked: int) -> None:
    bench.device.push([design(), design()], mode="try")
    bench.device.move_by([by(300)], asked)


SCENARIOS: dict[str, Callable[[Bench, int], None]] = {
    "move": lambda bench, asked: bench.device.move_by([by(300), by(-200, 1)], asked),
    "change": changed_on_its_way,
    "line": lambda bench, asked: bench.device.line([by(300), by(-200, 1)], None, asked),
    "run": run,
    "jog": jog_and_renew,
    "shuttle": there_and_back,
    "trace": traced_move,
    "push": push_then_move,
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


@pytest.mark.parametrize("name", ["move", "line", "run", "trace", "zero"])
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


def test_what_was_refused_takes_no_lease_away(bench: Bench) -> None:
    """A move that is refused must not let a run go on for ever."""
    bench.reset()
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([Asked(0, 400.0, "speed_steps_per_s")], lease)
    with pytest.raises(StepRampError):
        bench.device.move_by([by(2**40)])
    with pytest.raises(StepRampError):
        bench.device.run([Asked(0, 5e5, "speed_steps_per_s")], Lease({0: 5e5}, 1e6))
    lease.end()
    bench.poll()
    assert bench.witness.seen[-1] not in MOTIONS
    assert StopRequest.KIND in bench.witness.seen


def test_a_lease_of_one_axis_outlives_a_move_of_another(bench: Bench) -> None:
    bench.reset()
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([Asked(0, 400.0, "speed_steps_per_s")], lease)
    bench.device.move_by([by(60, 1)])
    lease.end()
    bench.poll()
    assert StopRequest.KIND in bench.witness.seen
    bench.settle()


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
    bench.device.run([Asked(1, 400.0, "speed_steps_per_s")], lease)
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
    bench.device.use_settings(Settings(pulse_width_us=5 + place))
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


def held(bench: Bench, *calls: Callable[[], object]) -> list[Future[object]]:
    """Let calls wait for the port's thread, one after the other, and return what comes of them."""
    with ThreadPoolExecutor(1 + len(calls)) as pool:
        begun, go_on = threading.Event(), threading.Event()
        pool.submit(bench.worker.call, lambda: (begun.set(), go_on.wait(PATIENCE_S)))
        assert begun.wait(PATIENCE_S)
        results = []
        for count, call in enumerate(calls, 1):
            results.append(pool.submit(call))
            while len(bench.worker._waiting) < count and not results[-1].done():
                time.sleep(0.001)
        go_on.set()
    return results


def test_limits_that_were_answered_hold_for_a_zero_that_was_asked_before(bench: Bench) -> None:
    bench.reset()
    limited, zeroed = held(bench, lambda: bench.device.limit({0: Span(-10, 1000)}), lambda: bench.device.zero([0], 900))
    assert limited.result() is None
    with pytest.raises(Rejected, match="axes without soft limits"):
        zeroed.result()
    assert ZeroRequest.KIND not in bench.witness.seen
    bench.device.limit({0: FREE})


def test_a_run_keeps_to_soft_limits_while_answers_are_lost(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is asked just then, and is answered only after the third repeat: the run is looked after meanwhile."""
    for module in (watch, limit_checks):
        monkeypatch.setattr(module, "monotonic", bench.clock)
    reached = []
    for polls in range(20, 90, 5):
        bench.reset()
        bench.device.limit({0: Span(None, 1500)})
        bench.device.run([Asked(0, 900.0, "speed_steps_per_s")], Lease({0: 900.0}, 1e6))
        for _ in range(polls):
            bench.clock.now_s += 0.02
            bench.poll()
        bench.witness.unanswered[ReadSettingsRequest.KIND] = 3
        bench.device.settings()
        for _ in range(200):
            bench.clock.now_s += 0.02
            bench.poll()
        assert bench.device.view.state is DeviceState.READY
        reached.append(bench.device.view.position_steps)
    bench.device.limit({0: FREE})
    assert max(reached) <= 1500
    # It is looked again 0.2 s later at most: no run ends much further away from the limit than it needs to.
    assert min(reached) > 1500 - 900 * (0.5 + WAITED_FOR_S)


def test_a_run_s_lease_ends_while_answers_are_lost(bench: Bench) -> None:
    bench.reset()
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([Asked(0, 400.0, "speed_steps_per_s")], lease)
    bench.witness.seen.clear()
    bench.witness.unanswered[ReadSettingsRequest.KIND] = 3
    lease.end()
    bench.device.settings()
    assert bench.witness.seen[:2] == [StopRequest.KIND, ReadSettingsRequest.KIND]
    assert bench.witness.seen.count(StopRequest.KIND) == 1


def test_a_stop_shows_what_has_set_out_though_something_was_looked_at_meanwhile(bench: Bench) -> None:
    """A jog of the other axis is let go of before the move is sent, and a stop comes before the move is looked at."""
    bench.reset()
    lease = Lease({1: 400.0}, 1e6)
    bench.device.run([Asked(1, 400.0, "speed_steps_per_s")], lease)
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


def test_a_mistake_after_a_run_was_granted_lets_it_not_run_on(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has no lease yet that would end it."""
    bench.reset()

    def fail(*_: object) -> None:
        raise ZeroDivisionError("a mistake of ours")

    monkeypatch.setattr(tracing.Tracing, "runs", fail)
    with pytest.raises(ZeroDivisionError):
        run(bench, bench.devices.order.next())
    sent = bench.witness.seen
    assert StopRequest.KIND in sent[sent.index(RunRequest.KIND) :]
    bench.look()
    assert bench.device.view.axes[0].state is not DeviceState.MOVING


def test_a_stop_of_an_axis_that_is_not_there_stops_all_and_says_so(bench: Bench) -> None:
    bench.reset()
    bench.device.run([Asked(1, 400.0, "speed_steps_per_s")], Lease({1: 400.0}, 1e6))
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


class OwnSupply(Witness):
    """A board that opening its port doesn't reset, and whose cable can come out while its motor moves on."""

    is_plugged_in = True

    def opened(self) -> None:
        pass

    def exchange(self, sent: bytes) -> bytes:
        if not self.is_plugged_in:
            raise OSError(5, "Input/output error")
        return super().exchange(sent)


def test_a_stop_that_finds_no_connection_is_owed(clock: Clock, plug_in: Callable) -> None:
    """It is the first thing that the controller is told once it is there again."""
    board = OwnSupply(clock)
    VirtualController.opened(board.controller)
    devices = Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.move_by([by(5000)])
    clock.now_s += 0.1
    board.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.trace_moves(0, 1)
    with pytest.raises(DeviceLost):
        device.stop()
    board.is_plugged_in = True
    board.seen.clear()
    devices.connect(device.view.port)
    after_hello = [kind for kind in board.seen if kind in MOTIONS | STOPS]
    assert after_hello == [StopRequest.KIND]
    assert device.view.state is DeviceState.STOPPING
    # Owed once: a device that is connected again later is not stopped again.
    board.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.trace_moves(0, 1)
    board.is_plugged_in = True
    board.seen.clear()
    devices.connect(device.view.port)
    assert not STOPS & set(board.seen)
    devices.close()


class UnpluggedAt(OwnSupply):
    """Its cable comes out just when it is told something of a kind."""

    kind: int | None = None

    def exchange(self, sent: bytes) -> bytes:
        for frame in FrameSplitter().feed(sent):
            message = Message.unpack(frame)
            if message is not None and message.kind == self.kind:
                self.is_plugged_in, self.kind = False, None
        return super().exchange(sent)


@pytest.fixture
def unplugged_at(clock: Clock) -> UnpluggedAt:
    board = UnpluggedAt(clock)
    VirtualController.opened(board.controller)
    return board


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_stop_that_finds_the_connection_gone_is_owed(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt, stop: str
) -> None:
    """Nobody knew until then: it is the stop itself that finds it out, or it still waits when that is found out."""
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.move_by([by(50_000)])
    clock.now_s += 0.1
    board.kind = StopRequest.KIND if stop == "stop" else HaltRequest.KIND
    with ThreadPoolExecutor(1) as pool:
        begun, held = threading.Event(), threading.Event()
        busy = pool.submit(worker_of(device).call, lambda: (begun.set(), held.wait(PATIENCE_S)))
        assert begun.wait(PATIENCE_S)
        stopped = [getattr(device, stop)() for _ in range(2)]
        held.set()
        assert busy.result(PATIENCE_S)
    for each in stopped:
        with pytest.raises(DeviceLost):
            each.result(PATIENCE_S)
    assert not STOPS & set(board.seen)
    board.is_plugged_in = True
    devices.connect(device.view.port)
    assert [kind for kind in board.seen if kind in STOPS] == [StopRequest.KIND]
    assert device.view.state is DeviceState.STOPPING
    devices.close()


def test_a_stop_that_was_granted_is_owed_no_more() -> None:
    """One of all axes does what one before it was to do; one of a single axis does not, nor what came after it."""
    owed = OwedStops(Order())
    first, second, third = (owed.owe("A") for _ in range(3))
    elsewhere = owed.owe("B")
    owed.settle("A", second, of_all_axes=False)
    assert owed.newest("A") == third
    owed.settle("A", third, of_all_axes=False)
    assert owed.newest("A") == first
    last = [owed.owe("A"), owed.owe("A")]
    owed.settle("A", last[0], of_all_axes=True)
    assert owed.newest("A") == last[1]
    owed.settle("A", last[1], of_all_axes=True)
    assert owed.newest("A") is None
    assert owed.newest("B") == elsewhere


def test_a_stop_that_is_owed_outlives_a_connect_that_fails(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The device is forgotten, but its motor may move: whatever is connected there next is stopped, before all else."""
    board, devices = unplugged_at, Devices()
    port = plug_in(board)
    device = devices.connect(port)
    push(device, clock)
    device.move_by([by(50_000)])
    devices.close()
    monkeypatch.setattr(conversation, "MOST_HELLOS", 2)
    monkeypatch.setattr(conversation, "HELLO_INTERVAL_S", 0.05)
    devices = Devices()
    waiting, go_on = threading.Event(), threading.Event()
    listen = board.exchange

    def mute(sent: bytes) -> bytes:
        if sent:
            waiting.set()
            assert go_on.wait(PATIENCE_S)
        return b""

    monkeypatch.setattr(board, "exchange", mute)
    with ThreadPoolExecutor(1) as pool:
        connecting = pool.submit(devices.connect, port)
        assert waiting.wait(PATIENCE_S)
        devices.stop_all()
        go_on.set()
        with pytest.raises(DeviceLost):
            connecting.result(PATIENCE_S)
    assert devices.views() == []
    monkeypatch.setattr(board, "exchange", listen)
    board.seen.clear()
    device = devices.connect(port)
    assert board.seen[:2] == [HelloRequest.KIND, StopRequest.KIND]
    assert STOPS & set(board.seen[2:]) == set()
    devices.close()


def test_a_stop_need_not_wait_until_the_ramps_are_read(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt
) -> None:
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.move_by([by(50_000)])
    board.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.trace_moves(0, 1)
    board.is_plugged_in = True
    board.seen.clear()
    exchange, asked = board.exchange, []

    def stopping(sent: bytes) -> bytes:
        said = exchange(sent)
        if ReadSettingsRequest.KIND in board.seen and not asked:
            asked.append(device.stop())
        return said

    board.exchange = stopping  # type: ignore[method-assign]
    devices.connect(device.view.port)
    assert asked[0].result(PATIENCE_S) is None
    assert board.seen[:3] == [HelloRequest.KIND, ReadSettingsRequest.KIND, StopRequest.KIND]
    devices.close()


def test_what_is_connected_while_all_are_stopped_does_not_move(bench: Bench, clock: Clock, plug_in: Callable) -> None:
    bench.reset()
    early = bench.devices.order.next()
    with bench.devices.being_stopped():
        other = bench.devices.connect(plug_in(VirtualController(clock)))
        push(other, clock)
        with pytest.raises(Refused, match="A stop came first"):
            other.move_by([by(50)])
    for asked in (early, other.view.stops - 1):
        with pytest.raises(Refused, match="A stop came first"):
            other.move_by([by(50)], asked)
    other.move_by([by(50)], other.view.stops)
    assert other.view.target_steps == 50


def test_limits_are_kept_to_only_where_it_is_known_what_they_are_counted_from(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt
) -> None:
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.limit({0: Span(0, 1000)})
    device.move_to([Asked(0, 900, "to_steps")])
    board.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.trace_moves(0, 1)
    board.is_plugged_in = True
    VirtualController.opened(board.controller)  # The board was reset: it counts from 0, and is near 1,000.
    devices.connect(device.view.port)
    assert (device.view.position_steps, device.view.unknown_positions) == (0, (0, 1))
    motions: list[Callable[[], None]] = [
        lambda: device.move_by([by(5, 1), by(900)]),
        lambda: device.move_to([Asked(0, 900, "to_steps")]),
        lambda: device.line([by(900), by(5, 1)]),
        lambda: device.run([Asked(0, 50.0, "speed_steps_per_s")], Lease({0: 50.0}, 1e6)),
        lambda: device.go_there_and_back(Shuttle(0, 50, 1, 0.0), by(50)),
    ]
    for motion in motions:
        with pytest.raises(Refused, match=r"Axis 0 may be elsewhere .* set the position, or take the limits away"):
            motion()
    assert not MOTIONS & set(board.seen[board.seen.index(HelloRequest.KIND, 1) :])
    device.move_by([by(5, 1)])
    device.run([Asked(0, 0.0, "speed_steps_per_s")], Lease({}, 1e6))
    device.stop().result(PATIENCE_S)
    clock.now_s += 100.0
    device.set_position([Asked(0, 900, "position_steps")])
    with pytest.raises(Rejected, match="0 to 1,000 steps, and this leads to 1,800"):
        device.move_by([by(900)])
    device.move_by([by(100)])
    devices.close()


@pytest.mark.parametrize("is_lost", [False, True])
def test_limits_outlive_a_device_that_is_let_go_of(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt, is_lost: bool
) -> None:
    """Whether it was lost before or not, it may have been moved meanwhile, and count anew."""
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.limit({0: Span(0, 100)})
    if is_lost:
        board.is_plugged_in = False
        with pytest.raises(DeviceLost):
            device.trace_moves(0, 1)
    devices.disconnect(device.view.id)
    board.is_plugged_in = True
    again = devices.connect(device.view.port)
    assert again.view.id != device.view.id
    assert [(axis.lowest_steps, axis.highest_steps) for axis in again.view.axes] == [(0, 100), (None, None)]
    assert again.view.unknown_positions == ((0, 1) if is_lost else (0,))
    with pytest.raises(Refused, match="Axis 0 may be elsewhere"):
        again.move_by([by(50)])
    again.set_position([Asked(0, 90, "position_steps")])
    with pytest.raises(Rejected, match="0 to 100 steps, and this leads to 140"):
        again.move_by([by(50)])
    # Whoever has taken them away meets them no more.
    again.limit({0: Span()})
    devices.disconnect(again.view.id)
    last = devices.connect(again.view.port)
    assert last.view.soft_limits == {}
    assert last.view.unknown_positions == ((1,) if is_lost else ())
    devices.close()


def test_limits_go_with_what_has_a_serial_number(
    clock: Clock, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    numbered: dict[str, str] = {}

    def known(port: str) -> Port:
        return Port(port, port, usb=(0x2341, 0x0043, numbered[port]))

    for module in (devices_module, attachment):
        monkeypatch.setattr(module, "known_port", known)
    first, second = plug_in(VirtualController(clock)), plug_in(VirtualController(clock))
    numbered |= {first: "A1", second: "B2"}
    devices = Devices()
    limited, free = devices.connect(first), devices.connect(second)
    limited.limit({0: Span(-5, 5)})
    for device in (limited, free):
        devices.disconnect(device.view.id)
    numbered |= {first: "B2", second: "A1"}
    assert devices.connect(first).view.soft_limits == {}
    assert devices.connect(second).view.soft_limits == {0: Span(-5, 5)}
    devices.close()


def test_a_push_that_was_planned_for_a_lost_connection_is_not_sent_over_the_next(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt
) -> None:
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)

    def across_a_loss(plan: Callable[[], SendPush]) -> SendPush:
        send = plan()
        board.is_plugged_in = False
        with pytest.raises(DeviceLost):
            device.trace_moves(0, 1)
        board.is_plugged_in = True
        devices.connect(device.view.port)
        return send

    with pytest.raises(Refused, match="connected again in the meantime"):
        device.push([design()], planned=across_a_loss)
    worker_of(device).call(device._attachment._watch.refresh)
    assert (device.view.state, len(device.view.axes)) == (DeviceState.READY, 2)
    devices.close()


def test_a_stop_in_the_last_moment_of_connecting_is_carried_out(clock: Clock, plug_in: Callable) -> None:
    devices = Devices()
    asked: list[object] = []

    class Late(OwnSupply):
        def exchange(self, sent: bytes) -> bytes:
            said = super().exchange(sent)
            if StatusRequest.KIND in self.seen and not asked:
                asked.append(1)
                with suppress(StepRampError):
                    devices.get("1").stop()
            return said

    late = Late(clock)
    VirtualController.opened(late.controller)
    device = devices.connect(plug_in(late))
    worker_of(device).call(lambda: None)
    assert asked
    assert StopRequest.KIND in late.seen
    devices.close()


def test_the_end_of_the_program_lets_nothing_move_again(bench: Bench) -> None:
    bench.reset()
    bench.device.move_by([by(2000)])
    bench.devices.end_motion()
    assert StopRequest.KIND in bench.witness.seen
    with pytest.raises(Refused, match="A stop came first"):
        bench.device.move_by([by(50)])
    with pytest.raises(Refused, match="is ending"):
        bench.devices.connect("sim://another")
