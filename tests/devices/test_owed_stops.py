"""Stops that find no connection, or one that is only being made: they are owed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from controllers.conftest import Clock
from controllers.usb_board import Cable
from designs import design
from devices.bench import MOTIONS, STOPS, Bench, by, push, worker_of
from devices.boards import HeldUp, OwnSupply, UnpluggedAt
from devices.motion import LONG_MOVE, PATIENCE_S, by_steps, wait_for
from stepramp.controllers.stepramp import conversation
from stepramp.controllers.stepramp.messages.motion import HaltRequest, MoveByRequest, StopRequest
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest
from stepramp.controllers.stepramp.messages.status import StatusRequest
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices import attachment, registry
from stepramp.devices.owed_stops import OwedStops
from stepramp.devices.registry import Devices
from stepramp.devices.stops import Order
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.link import protocol_sim
from stepramp.link.ports import Port, known_port


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


def test_a_motion_that_waits_on_the_way_and_was_told_as_failed_is_stopped(
    clock: Clock, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A network or a machine in between may hang, and hand over later what it was given."""
    monkeypatch.setattr(conversation, "REPLY_TIMEOUT_S", 0.003)
    board = HeldUp(clock)
    VirtualController.opened(board.controller)
    devices = Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    board.is_held_up = True
    with pytest.raises(DeviceLost):
        device.move_by([by(5000)])
    board.is_held_up = False
    board.seen.clear()
    devices.connect(device.view.port)
    told = [kind for kind in board.seen if kind in MOTIONS | STOPS]
    assert set(told[:-1]) == {MoveByRequest.KIND}
    assert told[-1] == StopRequest.KIND
    devices.close()


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
    assert [kind for kind in board.seen if kind in STOPS] == [StopRequest.KIND if stop == "stop" else HaltRequest.KIND]
    assert device.view.state is (DeviceState.STOPPING if stop == "stop" else DeviceState.READY)
    devices.close()


@pytest.mark.parametrize("is_forgotten", [False, True])
def test_a_stop_is_owed_to_a_board_that_comes_back_at_another_port(
    clock: Clock, plug_in: Callable, monkeypatch: pytest.MonkeyPatch, is_forgotten: bool
) -> None:
    """Its serial number tells it, whether the device that was lost is still listed or not."""
    plugged_in: dict[str, str] = {}

    def known(port: str) -> Port:
        return Port(port, port, usb=(0x2341, 0x0043, plugged_in[port]))

    for module in (registry, attachment):
        monkeypatch.setattr(module, "known_port", known)
    board, other = OwnSupply(clock), OwnSupply(clock)
    for each in (board, other):
        VirtualController.opened(each.controller)
    first, second = plug_in(board), plug_in(board)
    plugged_in |= {first: "A1", second: "A1"}
    devices = Devices()
    device = devices.connect(first)
    push(device, clock)
    device.move_by([by(50_000)])
    clock.now_s += 0.1
    board.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.trace_moves(0, 1)
    with pytest.raises(DeviceLost):
        device.stop()
    if is_forgotten:
        devices.disconnect(device.view.id)
    # What comes to the old port in its place is stopped, too, and takes nothing of what is owed to the board.
    plugged_in[first] = "B2"
    protocol_sim.register(first, other)
    devices.connect(first)
    assert [kind for kind in other.seen if kind in STOPS] == [StopRequest.KIND]
    board.is_plugged_in = True
    board.seen.clear()
    found = devices.connect(second)
    assert [kind for kind in board.seen if kind in MOTIONS | STOPS] == [StopRequest.KIND]
    assert found.view.state is DeviceState.STOPPING
    devices.close()


def test_a_stop_that_was_granted_is_owed_no_more() -> None:
    """One of all axes does what one before it was to do; one of a single axis does not, nor what came after it."""
    owed, a, b = OwedStops(Order()), Port("A", "A"), Port("B", "B")
    first, second, third = (owed.owe(a) for _ in range(3))
    elsewhere = owed.owe(b)
    owed.settle(a, second, of_all_axes=False)
    assert owed.newest(a) == third
    owed.settle(a, third, of_all_axes=False)
    assert owed.newest(a) == first
    last = [owed.owe(a), owed.owe(a)]
    owed.settle(a, last[0], of_all_axes=True)
    assert owed.newest(a) == last[1]
    owed.settle(a, last[1], of_all_axes=True)
    assert owed.newest(a) is None
    assert owed.newest(b) == elsewhere


def test_what_a_board_is_owed_is_settled_by_itself_only() -> None:
    """At whichever port it is stopped; of what is plugged in where it was, only that is known to have been stopped."""
    owed = OwedStops(Order())
    number = owed.owe(Port("p", "p", usb=(1, 2, "A")))
    for other in (Port("p", "p"), Port("p", "p", usb=(1, 2, "B")), Port("p", "p", usb=(1, 2, None))):
        again = owed.owe(Port("p", "p"))
        assert owed.newest(other) == again
        owed.settle(other, again, of_all_axes=True)
        assert owed.newest(other) is None
        assert owed.newest(Port("q", "q", usb=(1, 2, "A"))) == number
    owed.settle(Port("q", "q", usb=(1, 2, "A")), number, of_all_axes=True)
    assert owed.newest(Port("p", "p", usb=(1, 2, "A"))) is None


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


@pytest.mark.parametrize("is_link_first", [False, True])
def test_a_stop_is_owed_by_whichever_of_its_names_a_port_is_connected(cable: Cable, is_link_first: bool) -> None:
    """The device is the same one, too."""
    assert cable.board is not None
    names = [str(cable.port), cable.board.port]
    devices = Devices()
    device = devices.connect(names[not is_link_first])
    device.push([design()])
    device.move_by(by_steps(LONG_MOVE))
    cable.board.mute()
    wait_for(device, DeviceState.LOST)
    with pytest.raises(DeviceLost):
        device.stop()
    cable.board.speak()
    cable.board.requests.clear()
    assert devices.connect(names[is_link_first]) is device
    assert StopRequest.KIND in cable.board.requests
    devices.close()


def test_what_is_owed_by_one_name_of_a_port_is_settled_by_another(tmp_path: Path) -> None:
    port, link = tmp_path / "ttyUSB0", tmp_path / "by-id"
    port.touch()
    link.symlink_to(port)
    by_link, by_name = known_port(str(link)), known_port(str(port))
    owed = OwedStops(Order())
    owed.settle(by_name, owed.owe(by_link), of_all_axes=True)
    assert (owed.newest(by_link), owed.newest(by_name)) == (None, None)
    # Once the link leads elsewhere, what moves there is another one.
    number = owed.owe(by_link)
    link.unlink()
    owed.settle(by_name, number, of_all_axes=True)
    assert (owed.newest(by_name), owed.newest(Port(str(link), "by-id"))) == (None, number)
