from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from controllers.usb_board import Cable, UsbBoard
from designs import design
from stepramp.controllers.contract import Asked
from stepramp.controllers.stepramp import conversation
from stepramp.controllers.stepramp.messages.motion import MoveByRequest
from stepramp.controllers.stepramp.messages.ramps import CommitRequest, DataRequest
from stepramp.controllers.stepramp.messages.report import ReportRequest
from stepramp.controllers.stepramp.messages.status import AxisState, StatusRequest
from stepramp.controllers.stepramp.settings import Settings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices import control
from stepramp.devices import registry as devices_module
from stepramp.devices.device import Device
from stepramp.devices.leases import JOG_S, Lease
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState, DeviceView
from stepramp.errors import DeviceLost, NotFound, Refused, Rejected, StepRampError
from stepramp.link.ports import Port
from stepramp.ramp.move import play
from stepramp.ramp.plan import ramp_of

PATIENCE_S = 10.0
LONG_MOVE = 100_000


def by(*steps: int) -> list[Asked]:
    return [Asked(axis, each, f"axes.{axis}.by_steps") for axis, each in enumerate(steps)]


@pytest.fixture
def devices() -> Iterator[Devices]:
    devices = Devices()
    devices.look_for_lost_ones()
    yield devices
    devices.close()


@pytest.fixture
def port(plug_in: Callable) -> str:
    """Return the port of a virtual controller that is in real time and forgets nothing."""
    return plug_in(VirtualController())


def wait_for(device: Device, state: DeviceState) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while device.view.state is not state:
        assert time.monotonic() < deadline, f"still {device.view}"
        time.sleep(0.005)


def test_connecting_moves_nothing(devices: Devices, port: str) -> None:
    view = devices.connect(port).view
    assert (view.id, view.port, view.name, view.state) == ("1", port, "Virtual controller", DeviceState.READY)
    assert (view.timer_hz, view.firmware_version, view.ramp, view.pushed) == (2_000_000, "0.2.0", None, None)
    assert (view.position_steps, view.target_steps, view.speed_steps_per_s) == (0, 0, 0.0)


def test_connecting_again_returns_the_same_device(devices: Devices, port: str) -> None:
    assert devices.connect(port) is devices.connect(port)
    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(devices.connect, [port] * 8))) == 1
    assert len(devices.views()) == 1


def test_two_threads_connect_a_new_port_at_once(devices: Devices, port: str) -> None:
    with ThreadPoolExecutor(8) as pool:
        assert {device.view.id for device in pool.map(devices.connect, [port] * 8)} == {"1"}


def test_a_mute_port_is_tried_once_for_all_who_ask(
    devices: Devices, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One after the other they would wait for eight times as long."""
    monkeypatch.setattr(conversation, "MOST_HELLOS", 1)
    asked, all_ask = threading.Semaphore(0), threading.Event()
    opened = []

    class Mute(Silent):
        def opened(self) -> None:
            opened.append(1)
            assert all_ask.wait(PATIENCE_S)

    connect = Device.connect

    def counted(device: Device) -> None:
        asked.release()
        connect(device)

    monkeypatch.setattr(Device, "connect", counted)
    port = plug_in(Mute())
    with ThreadPoolExecutor(8) as pool:
        connecting = [pool.submit(devices.connect, port) for _ in range(8)]
        for _ in range(8):
            assert asked.acquire(timeout=PATIENCE_S)
        time.sleep(0.1)  # Those who were counted last have still to ask.
        all_ask.set()
        for each in connecting:
            with pytest.raises(DeviceLost, match="Nothing answers at"):
                each.result(PATIENCE_S)
    assert len(opened) == 1
    assert devices.views() == []


def test_what_cant_be_connected_is_forgotten(devices: Devices) -> None:
    with pytest.raises(DeviceLost):
        devices.connect("/dev/there-is-none")
    with pytest.raises(Rejected):
        devices.connect("spy://x")
    assert devices.views() == []
    with pytest.raises(NotFound, match="'1'"):
        devices.get("1")


def test_push_move_stop(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    report = device.push([design()])
    assert report.verified
    assert device.view.pushed == report
    assert device.view.state is DeviceState.READY
    assert device.view.ramp is not None
    assert device.view.ramp.sequence == report.sequence == 1
    device.move_by(by(LONG_MOVE))
    assert (device.view.state, device.view.target_steps) == (DeviceState.MOVING, LONG_MOVE)
    for refused in (lambda: device.push([design()]), lambda: devices.disconnect("1"), device.keep):
        with pytest.raises(Refused, match="The motor moves"):
            refused()
    device.stop().result(PATIENCE_S)
    assert device.view.state is DeviceState.STOPPING
    wait_for(device, DeviceState.READY)
    assert 0 < device.view.position_steps == device.view.target_steps < LONG_MOVE
    device.move_to(by(0))
    wait_for(device, DeviceState.READY)
    assert device.view.position_steps == 0
    devices.disconnect("1")
    assert devices.views() == []


def test_four_axes(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    assert [axis.axis for axis in device.view.axes] == [0]
    device.push([design(), design(ramp__slew_speed_steps_per_s=500), design(), design()])
    device.move_by(by(300, -200, 0, 50))
    assert [axis.state for axis in device.view.axes] == [DeviceState.MOVING] * 2 + [
        DeviceState.READY,
        DeviceState.MOVING,
    ]
    assert [axis.target_steps for axis in device.view.axes] == [300, -200, 0, 50]
    assert (device.view.state, device.view.target_steps) == (DeviceState.MOVING, 300)
    device.move_to([Asked(1, 60, "axes.0.to_steps")])
    wait_for(device, DeviceState.READY)
    assert [axis.position_steps for axis in device.view.axes] == [300, 60, 0, 50]
    device.stop([0]).result(PATIENCE_S)
    device.run([Asked(2, 400.0, "axes.0.speed_steps_per_s")], Lease({2: 400.0}, 60))
    device.halt([2]).result(PATIENCE_S)
    device.line([*by(-30, 20), Asked(3, 5, "axes.2.by_steps")])
    wait_for(device, DeviceState.READY)
    assert [device.view.axes[axis].position_steps for axis in (0, 1, 3)] == [270, 80, 55]
    device.set_position(by(-7))
    assert device.view.position_steps == -7
    device.zero([0], 10)
    wait_for(device, DeviceState.READY)
    assert device.view.axes[0].position_steps == 0


def test_a_device_is_listened_to_while_it_moves(devices: Devices) -> None:
    with UsbBoard() as board:
        device = devices.connect(board.port)
        device.push([design()])
        device.move_by(by(LONG_MOVE))
        positions = {device.view.position_steps}
        before = board.requests.count(StatusRequest.KIND)
        deadline = time.monotonic() + 0.5
        while time.monotonic() < deadline:
            positions.add(device.view.position_steps)
            time.sleep(0.002)
        assert board.requests.count(StatusRequest.KIND) - before <= 3
        assert len(positions) >= 12
        device.halt().result(PATIENCE_S)
        devices.disconnect("1")
    assert board.requests[-1] == ReportRequest.KIND


def test_a_ramp_on_trial_and_what_becomes_of_it(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.push([design(ramp__slew_speed_steps_per_s=500)], mode="try")
    assert (device.view.on_trial, device.view.ramp.sequence) == (True, 1)
    device.roll_back()
    assert not device.view.on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        device.roll_back()
    device.push([design(), design()], mode="try")
    device.keep()
    assert (device.view.on_trial, device.view.ramp.sequence, len(device.view.axes)) == (False, 2, 2)
    device.restore()
    assert (device.view.ramp.sequence, len(device.view.axes)) == (3, 1)
    assert device.view.state is DeviceState.READY


def test_settings(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    assert device.settings() == Settings()
    device.use_settings(Settings(pulse_width_us=8))
    assert (device.settings().pulse_width_us, device.view.on_trial) == (8, True)
    with pytest.raises(Refused, match="push a design first"):
        device.keep()
    device.push([design()])
    assert not device.view.on_trial
    devices.disconnect("1")
    assert devices.connect(port).settings().pulse_width_us == 8


def test_a_trace(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design(), design()])
    with pytest.raises(Refused, match="No move has been traced"):
        device.trace()
    assert device.trace_moves(1, 0) == 1
    device.move_by(by(50, -120))
    wait_for(device, DeviceState.READY)
    trace = device.trace()
    assert (trace.axis, trace.complete, trace.step.tolist()) == (1, True, list(range(1, 121)))
    assert np.abs(trace.deviation_us).max() == 0
    intervals = play(ramp_of(design()), 120)
    assert trace.planned_ticks.tolist() == [0, *np.cumsum(intervals)[:-1].tolist()]


def test_halt_is_at_once(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.move_by(by(LONG_MOVE))
    device.halt().result(PATIENCE_S)
    assert device.view.state is DeviceState.READY


def test_the_ramp_outlives_the_connection(devices: Devices, port: str) -> None:
    devices.connect(port).push([design()])
    devices.disconnect("1")
    device = devices.connect(port)
    assert device.view.id == "2"
    assert device.view.ramp is not None
    assert device.view.pushed is None


def test_a_move_without_a_ramp_is_refused(devices: Devices, port: str) -> None:
    with pytest.raises(Refused, match="no ramp"):
        devices.connect(port).move_by(by(1))


def test_a_stop_gets_through_in_the_midst_of_a_push_and_the_push_goes_on(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    with ThreadPoolExecutor(1) as pool:
        pushing = pool.submit(device.push, [design()])
        wait_for(device, DeviceState.WRITING)
        began = time.monotonic()
        device.stop().result(PATIENCE_S)
        assert time.monotonic() - began < 0.3
        assert device.view.state is DeviceState.WRITING
        assert not pushing.done()
        assert pushing.result(PATIENCE_S).verified


def test_a_move_that_waits_behind_a_push_does_not_begin_after_a_stop(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    with ThreadPoolExecutor(2) as pool:
        pushing = pool.submit(device.push, [design()])
        wait_for(device, DeviceState.WRITING)
        moving = pool.submit(device.move_by, by(LONG_MOVE))
        while not device._attachment._contact.worker._waiting:
            time.sleep(0.001)
        device.stop().result(PATIENCE_S)
        with pytest.raises(Refused, match="A stop came first"):
            moving.result(PATIENCE_S)
        assert pushing.result(PATIENCE_S).verified
    assert device.view.position_steps == 0


def test_all_are_stopped_whatever_they_do(devices: Devices, plug_in: Callable) -> None:
    moving = [devices.connect(plug_in(VirtualController())) for _ in range(2)]
    for device in moving:
        device.push([design()])
        device.move_by(by(LONG_MOVE))
    with UsbBoard() as board:
        lost = devices.connect(board.port)
        board.unplug()
        wait_for(lost, DeviceState.LOST)
    devices.stop_all()
    assert [device.view.state for device in moving] == [DeviceState.STOPPING] * 2
    assert lost.view.state is DeviceState.LOST


def test_the_end_of_the_program_stops_what_moves(plug_in: Callable) -> None:
    virtual, devices = VirtualController(), Devices()
    device = devices.connect(plug_in(virtual))
    device.push([design()])
    device.move_by(by(LONG_MOVE))
    devices.close()
    assert virtual._machine._motors[0].state is not AxisState.MOVING
    assert virtual._machine._motors[0].position < LONG_MOVE
    assert devices.views() == []
    assert device.view.state is DeviceState.LOST


def test_listeners_hear_of_each_change(devices: Devices, port: str) -> None:
    states: list[list[str]] = []
    with devices.listening(lambda: states.append([view.state.value for view in devices.views()])):
        device = devices.connect(port)
        device.push([design()])
        device.move_by(by(50))
        wait_for(device, DeviceState.READY)
        devices.disconnect("1")
    heard = [state for index, state in enumerate(states) if index == 0 or state != states[index - 1]]
    assert heard[:5] == [["connecting"], ["ready"], ["writing"], ["ready"], ["moving"]]
    assert heard[-1] == []
    count = len(states)
    devices.connect(port)
    assert len(states) == count


def unplugged_while_idle(board: UsbBoard, _: Device) -> None:
    board.unplug()


def unplugged_in_a_push(board: UsbBoard, device: Device) -> None:
    board.unplug_at(DataRequest.KIND, after=2)
    device.push([design()])


def unplugged_while_writing(board: UsbBoard, device: Device) -> None:
    board.unplug_at(CommitRequest.KIND)
    device.push([design()])


def unplugged_as_a_move_begins(board: UsbBoard, device: Device) -> None:
    board.unplug_at(MoveByRequest.KIND)
    device.move_by(by(LONG_MOVE))


def unplugged_in_a_move(board: UsbBoard, device: Device) -> None:
    device.move_by(by(LONG_MOVE))
    board.unplug_at(StatusRequest.KIND)
    time.sleep(0.1)
    device.move_by(by(1))


@pytest.mark.parametrize(
    "unplug",
    [
        unplugged_while_idle,
        unplugged_in_a_push,
        unplugged_while_writing,
        unplugged_as_a_move_begins,
        unplugged_in_a_move,
    ],
)
def test_unplugging(devices: Devices, port: str, unplug: Callable[[UsbBoard, Device], None]) -> None:
    other = devices.connect(port)
    other.push([design()])
    other.move_by(by(LONG_MOVE))
    with UsbBoard() as board:
        device = devices.connect(board.port)
        device.push([design()])
        try:
            unplug(board, device)
        except StepRampError as error:
            assert isinstance(error, DeviceLost)
        wait_for(device, DeviceState.LOST)
    assert device.view.message is not None
    assert board.port in device.view.message
    assert device.view.speed_steps_per_s == 0
    for refused in (lambda: device.push([design()]), lambda: device.move_by(by(1)), device.stop, device.halt):
        with pytest.raises(DeviceLost):
            refused()
    with pytest.raises(DeviceLost):
        devices.connect(board.port)
    assert device.view.state is DeviceState.LOST
    assert other.view.state is DeviceState.MOVING
    devices.disconnect(device.view.id)
    assert [view.id for view in devices.views()] == [other.view.id]


def test_a_lost_device_is_connected_again_under_its_id(devices: Devices, plug_in: Callable) -> None:
    virtual = VirtualController()
    port = plug_in(virtual)
    device = devices.connect(port)
    device.push([design()])
    virtual.opened()  # The board is reset: it forgets the session.
    wait_for(device, DeviceState.LOST)
    assert "was restarted" in (device.view.message or "")
    again = devices.connect(port)
    assert again is device
    assert (again.view.id, again.view.state, again.view.message) == ("1", DeviceState.READY, None)
    assert again.view.pushed is None


class Silent:
    """Answers nothing."""

    def opened(self) -> None:
        pass

    def exchange(self, _: bytes) -> bytes:
        return b""


def test_what_is_not_connected_yet_cant_be_asked(
    devices: Devices, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(conversation, "MOST_HELLOS", 2)
    with ThreadPoolExecutor(1) as pool:
        connecting = pool.submit(devices.connect, plug_in(Silent()))
        while not devices.views():
            time.sleep(0.001)
        device = devices.get("1")
        assert device.view.state is DeviceState.CONNECTING
        with pytest.raises(Refused, match="still being connected"):
            device.stop()
        with pytest.raises(DeviceLost, match="Nothing answers at"):
            connecting.result(PATIENCE_S)
    assert devices.views() == []


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    made = Cable(tmp_path / "ttyACM0")
    made.plug_in()
    yield made
    made.unplug()


def test_what_was_unplugged_is_connected_again_by_itself_and_nothing_moves(devices: Devices, cable: Cable) -> None:
    device = devices.connect(str(cable.port))
    device.push([design()])
    device.move_by(by(LONG_MOVE))
    time.sleep(0.3)
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    assert "Axis 0 was moving, last heard of at" in (device.view.message or "")
    assert device.view.unknown_positions == (0,)
    cable.plug_in()
    wait_for(device, DeviceState.READY)
    view = device.view
    assert (view.id, view.position_steps, view.target_steps, view.unknown_positions) == ("1", 0, 0, (0,))
    device.set_position([Asked(0, 77, "position_steps")])
    assert (device.view.position_steps, device.view.unknown_positions) == (77, ())


def test_a_port_has_one_device_whatever_it_is_called(devices: Devices, cable: Cable, tmp_path: Path) -> None:
    device = devices.connect(str(cable.port))
    by_id = tmp_path / "by-id"
    by_id.symlink_to(cable.port)
    for name in (by_id, cable.port.resolve(), tmp_path / ".." / tmp_path.name / cable.port.name):
        assert devices.connect(str(name)) is device
    assert [view.port for view in devices.views()] == [str(cable.port)]


def test_what_was_let_go_of_is_not_connected_again(devices: Devices, cable: Cable) -> None:
    device = devices.connect(str(cable.port))
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    devices.disconnect("1")
    cable.plug_in()
    assert device.reconnect()
    assert device.view.state is DeviceState.LOST
    assert devices.views() == []


def test_a_lease_runs_out_and_is_not_brought_back() -> None:
    lease = Lease({0: 400.0})
    assert lease.renew()
    time.sleep(JOG_S + 0.05)
    assert not lease.holds
    assert not lease.renew()
    ended = Lease({0: 400.0})
    ended.end()
    assert not ended.renew()


def test_a_jog_that_was_let_go_of_before_it_began(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    lease = Lease({0: 400.0})
    device.end_run(lease)
    with pytest.raises(Refused, match="let go before it began"):
        device.run([Asked(0, 400.0, "speed_steps_per_s")], lease)
    assert device.view.state is DeviceState.READY


def test_a_jog_that_nobody_renews_slows_down(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.run([Asked(0, 400.0, "speed_steps_per_s")], Lease({0: 400.0}))
    wait_for(device, DeviceState.READY)
    position = device.view.position_steps
    # 400 steps/s for 0.4 s, and what it takes to slow down: 16 steps with 5,000 steps/s².
    assert 20 < position < 400
    time.sleep(0.3)
    assert device.view.position_steps == position


def test_a_run_goes_on_for_as_long_as_its_lease_holds(devices: Devices, port: str) -> None:
    """The controller ends a run that nobody asks about for 1.3 s."""
    device = devices.connect(port)
    device.push([design()])
    device.run([Asked(0, 100.0, "speed_steps_per_s")], Lease({0: 100.0}, 60))
    time.sleep(3.0)
    assert device.view.state is DeviceState.MOVING
    assert device.view.position_steps > 200
    device.stop()
    wait_for(device, DeviceState.READY)


def test_only_one_of_two_pages_wins_control(devices: Devices, port: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second asks exactly between the first one's look whether the device is free and its taking it."""
    device = devices.connect(port)
    refuse_others, won = control._refuse_others, []

    def take(page: str) -> None:
        with suppress(Refused):
            device.take_control(page)
            won.append(page)

    second = threading.Thread(target=take, args=("two",))

    def look(view: DeviceView, page: str) -> None:
        refuse_others(view, page)
        if page == "one":
            second.start()
            second.join(0.2)

    monkeypatch.setattr(control, "_refuse_others", look)
    take("one")
    second.join(PATIENCE_S)
    assert (won, device.view.in_control) == (["one"], "one")


def test_the_ports_are_listed_without_keeping_anyone_waiting(
    devices: Devices, port: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    listing, go_on = threading.Event(), threading.Event()

    def slow(name: str) -> Port:
        listing.set()
        assert go_on.wait(PATIENCE_S)
        return Port(name, name)

    monkeypatch.setattr(devices_module, "known_port", slow)
    with ThreadPoolExecutor(2) as pool:
        connecting = pool.submit(devices.connect, port)
        assert listing.wait(PATIENCE_S)
        assert pool.submit(devices.views).result(PATIENCE_S) == []
        go_on.set()
        connecting.result(PATIENCE_S)


def test_a_listener_that_fails_keeps_nobody_waiting(
    devices: Devices, port: str, caplog: pytest.LogCaptureFixture
) -> None:
    heard = []

    def fail() -> None:
        raise ZeroDivisionError("a mistake")

    with devices.listening(fail), devices.listening(lambda: heard.append(1)):
        device = devices.connect(port)
        device.push([design()])
        device.move_by(by(10))
        wait_for(device, DeviceState.READY)
        assert heard
    assert "could not be told" in caplog.text


def test_nothing_is_looked_for_before_the_server_begins() -> None:
    """Its thread belongs to the server's life, not to the making of the application."""
    before = threading.active_count()
    devices = Devices()
    assert threading.active_count() == before
    devices.close()
