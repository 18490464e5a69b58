"""Devices that are lost, and connected again."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from controllers.conftest import Clock
from controllers.grbl.emulator import Eeprom, GrblOnACable
from controllers.usb_board import Cable, UsbBoard
from designs import design
from devices.bench import push, worker_of
from devices.boards import UnpluggedAt
from devices.motion import LONG_MOVE, by_steps, wait_for, wait_until
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.motion import MoveByRequest
from stepramp.controllers.stepramp.messages.ramps import CommitRequest, DataRequest
from stepramp.controllers.stepramp.messages.status import StatusRequest
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices import attachment, reconnect, registry
from stepramp.devices.device import Device
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.soft_limits import Span
from stepramp.devices.view import AxisView, DeviceState, DeviceView
from stepramp.devices.writing import SendPush
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.link.ports import Port


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
    device.move_by(by_steps(LONG_MOVE))


def unplugged_in_a_move(board: UsbBoard, device: Device) -> None:
    device.move_by(by_steps(LONG_MOVE))
    board.unplug_at(StatusRequest.KIND)
    time.sleep(0.1)
    device.move_by(by_steps(1))


@pytest.mark.parametrize(
    ("unplug", "midst"),
    [
        (unplugged_while_idle, ""),
        (unplugged_in_a_push, "it has the old ones or the new ones whole, never a mixture"),
        (unplugged_while_writing, "it has the old ones or the new ones whole, never a mixture"),
        (unplugged_as_a_move_begins, ""),
        (unplugged_in_a_move, "Axis 0 was moving, last heard of at"),
    ],
)
def test_unplugging(devices: Devices, port: str, unplug: Callable[[UsbBoard, Device], None], midst: str) -> None:
    other = devices.connect(port)
    other.push([design()])
    other.move_by(by_steps(LONG_MOVE))
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
    assert midst in device.view.message
    for refused in (lambda: device.push([design()]), lambda: device.move_by(by_steps(1)), device.stop, device.halt):
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


def test_what_was_unplugged_is_connected_again_by_itself_and_nothing_moves(devices: Devices, cable: Cable) -> None:
    device = devices.connect(str(cable.port))
    device.push([design()])
    device.move_by(by_steps(LONG_MOVE))
    wait_until(lambda: device.view.speed_steps_per_s > 0, device)
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    # Nobody has seen it come to rest.
    assert device.view.speed_steps_per_s > 0
    assert device.view.axes[0].speed_steps_per_s == device.view.speed_steps_per_s
    assert "Axis 0 was moving, last heard of at" in (device.view.message or "")
    assert device.view.unknown_positions == (0,)
    cable.plug_in()
    wait_for(device, DeviceState.READY)
    view = device.view
    assert (view.id, view.position_steps, view.target_steps, view.unknown_positions) == ("1", 0, 0, (0,))
    device.set_position([AxisCommand(0, 77, "position_steps")])
    assert (device.view.position_steps, device.view.unknown_positions) == (77, ())


@pytest.mark.parametrize("lasts_s", [0.4, 600.0])
def test_what_runs_for_nobody_once_it_is_connected_again_slows_down(
    devices: Devices, cable: Cable, lasts_s: float
) -> None:
    """A board with a supply of its own runs on, and would for as long as we ask it what it does."""
    device = devices.connect(str(cable.port))
    device.push([design(), design()])
    device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], Lease({0: 400.0}, lasts_s))
    device.move_by([AxisCommand(1, LONG_MOVE, "by_steps")])
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    cable.plug_in(is_reset=False)
    devices.connect(str(cable.port))
    assert device.view.axes[0].state is DeviceState.STOPPING
    wait_until(lambda: device.view.axes[0].state is DeviceState.READY, device)
    # A move has an end of its own: it goes on to it.
    assert device.view.axes[1].state is DeviceState.MOVING
    assert device.view.axes[1].target_steps == LONG_MOVE
    device.stop()


def test_a_run_that_another_server_left_behind_slows_down(cable: Cable) -> None:
    first = Devices()
    device = first.connect(str(cable.port))
    device.push([design()])
    device.run([AxisCommand(0, -400.0, "speed_steps_per_s")], Lease({0: -400.0}, 600.0))
    # It was killed: it stops nothing any more.
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    first.close()
    cable.plug_in(is_reset=False)
    second = Devices()
    found = second.connect(str(cable.port))
    wait_for(found, DeviceState.READY)
    second.close()


def test_a_zero_says_where_an_axis_is_once_it_has_arrived(devices: Devices, cable: Cable) -> None:
    device = devices.connect(str(cable.port))
    device.push([design()])
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    cable.plug_in()
    devices.connect(str(cable.port))
    assert device.view.unknown_positions == (0,)
    device.zero([0], 900)
    assert device.view.unknown_positions == (0,), "on its way it may be anywhere"
    device.stop()
    wait_for(device, DeviceState.READY)
    assert device.view.position_steps != 0
    assert device.view.unknown_positions == (0,), "it didn't get to the gauge's stop"
    device.zero([0], 40)
    device.move_by(by_steps(3))
    wait_for(device, DeviceState.READY)
    assert device.view.unknown_positions == (0,), "it was sent elsewhere on its way"
    device.zero([0], 40)
    wait_until(lambda: device.view.unknown_positions == (), device)
    assert (device.view.state, device.view.position_steps) == (DeviceState.READY, 0)


def test_what_was_last_heard_of_outlives_an_attempt_that_fails(devices: Devices, cable: Cable) -> None:
    device = devices.connect(str(cable.port))
    device.push([design()])
    device.move_by(by_steps(LONG_MOVE))
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    lost = device.view
    cable.plug_in(is_reset=False).mute()
    with pytest.raises(DeviceLost):
        devices.connect(str(cable.port))
    view = device.view
    assert view.state is DeviceState.LOST
    assert "Axis 0 was moving, last heard of at" in (view.message or "")
    assert (view.axes, view.heard_s, view.unknown_positions) == (lost.axes, lost.heard_s, (0,))
    assert view.target_steps == LONG_MOVE


def test_all_that_went_on_outlives_attempts_that_fail() -> None:
    moving = AxisView(0, DeviceState.MOVING, 1234, 5000, 1000.0, 1234)
    view = DeviceView("1", "p", "p", "grbl", state=DeviceState.MOVING, axes=(moving,), half_written="Restore it.")
    lost = view.lost("Gone.")
    assert lost.message == "Gone. Restore it. Axis 0 was moving, last heard of at 1,234 steps."
    again = lost.still_lost("Mute.", lost.anew("p", "p")).still_lost("Mute.", lost.anew("p", "p"))
    assert (again.message, again.midst) == (f"Mute. {' '.join(lost.midst)}", lost.midst)


def test_what_was_let_go_of_is_not_connected_again(devices: Devices, cable: Cable) -> None:
    device = devices.connect(str(cable.port))
    cable.unplug()
    wait_for(device, DeviceState.LOST)
    devices.disconnect("1")
    cable.plug_in()
    assert device.reconnect()
    assert device.view.state is DeviceState.LOST
    assert devices.views() == []


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

    with pytest.raises(Refused, match="connected anew in the meantime, and nothing was sent"):
        device.push([design()], planned=across_a_loss)
    worker_of(device).call(device._attachment._watch.refresh)
    assert (device.view.state, len(device.view.axes)) == (DeviceState.READY, 2)
    devices.close()


class ChangedBoards(GrblOnACable):
    """A grbl that starts as its port is opened. serial_number: that of the board that is plugged in; None: none is."""

    serial_number: str | None = "A1"

    def exchange(self, data: bytes) -> bytes:
        said = super().exchange(data if self.serial_number else b"")
        return said if self.serial_number else b""

    def change(self, device: Device, serial_number: str) -> None:
        """Pull the board out, and plug another one in."""
        self.serial_number = None
        wait_for(device, DeviceState.LOST)
        self.plug_in(serial_number)

    def plug_in(self, serial_number: str) -> None:
        self.serial_number = serial_number
        self.grbl.eeprom = Eeprom()
        self.grbl.power_up()


@pytest.fixture
def changed_boards(monkeypatch: pytest.MonkeyPatch) -> Iterator[ChangedBoards]:
    with ChangedBoards() as cable:

        def known(port: str) -> Port:
            return Port(port, "CH340 adapter", usb=(0x1A86, 0x7523, cable.serial_number), leads_to=port)

        for module in (registry, attachment):
            monkeypatch.setattr(module, "known_port", known)
        yield cable


def test_another_board_at_the_port_of_a_lost_one_is_another_device(
    changed_boards: ChangedBoards, tmp_path: Path
) -> None:
    """It has nothing of the other's, and takes nothing from it: no limits, no backups, no proof."""
    devices = Devices(data=tmp_path)
    first = devices.connect(changed_boards.port, "grbl")
    first.push([design()])
    first.limit({0: Span(0, 1000)})
    pending, saved = first.view.unproven, first.backups()
    assert pending
    changed_boards.change(first, "B2")
    second = devices.connect(changed_boards.port, "grbl")
    assert (second.view.id, second.view.soft_limits, second.view.unproven, second.view.proof) == ("2", {}, (), None)
    assert second.backups().backups == []
    second.back_up()
    # Whoever has the first one's id is told, and nothing is done by another board in its place.
    with pytest.raises(
        DeviceLost, match=r"Another board is at its port now, USB 1A86:7523, serial number B2: .* device 2"
    ):
        first.back_up()
    assert (first.backups(), first.view.unproven) == (saved, pending)
    assert first.called != second.called
    # A third one takes the second one's place in what is told.
    changed_boards.change(second, "C3")
    assert devices.connect(changed_boards.port, "grbl").view.id == "3"
    for lost in (first, second):
        assert (lost.view.message or "").count("Another board is at its port now") == 1
        assert "serial number C3: that is device 3." in (lost.view.message or "")
    # Once that is forgotten, nobody is told to look there.
    devices.disconnect("3")
    assert not any("Another board" in (lost.view.message or "") for lost in (first, second))
    # The same board back is the same device.
    changed_boards.plug_in("A1")
    assert devices.connect(changed_boards.port, "grbl") is first
    assert (first.view.state, first.view.soft_limits) == (DeviceState.READY, {0: Span(0, 1000, steps_per_mm=250.0)})
    assert first.view.proof is not None
    assert set(first.view.proof.not_kept) == set(pending)
    assert devices.get("2").view.state is DeviceState.LOST
    devices.close()


def test_a_board_that_is_changed_just_as_it_is_connected_again_is_refused(
    changed_boards: ChangedBoards, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is sent to it: only once the port is held it is known what is plugged in there."""
    devices = Devices(data=tmp_path)
    first = devices.connect(changed_boards.port, "grbl")
    changed_boards.change(first, "A1")
    monkeypatch.setattr(attachment, "known_port", lambda port: Port(port, "x", usb=(0x1A86, 0x7523, "B2")))
    changed_boards.grbl.lines.clear()
    with pytest.raises(
        Refused, match=r"Another board is plugged in .* than the one that was there before, USB 1A86:7523"
    ):
        devices.connect(changed_boards.port, "grbl")
    assert first.view.state is DeviceState.LOST
    assert changed_boards.grbl.lines == []
    devices.close()


def test_a_board_that_the_list_of_ports_misses_once_is_known_by_its_number_all_the_same(
    plug_in: Callable, unplugged_at: UnpluggedAt, monkeypatch: pytest.MonkeyPatch
) -> None:
    usb: list[tuple[int, int, str] | None] = [(0x2341, 0x0043, "A1")]
    for module in (registry, attachment):
        monkeypatch.setattr(module, "known_port", lambda port: Port(port, port, usb=usb[0], leads_to=port))
    devices = Devices()
    device = devices.connect(plug_in(unplugged_at))
    unplugged_at.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.settings()
    unplugged_at.is_plugged_in = True
    known, usb[0] = device.identity, None
    assert devices.connect(device.view.port) is device
    assert (device.identity, device.called) == (known, "USB 2341:0043, serial number A1")
    devices.close()


def test_what_the_list_of_ports_misses_at_first_has_what_was_saved_of_its_board(
    changed_boards: ChangedBoards, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    devices = Devices(data=tmp_path)
    first = devices.connect(changed_boards.port, "grbl")
    first.push([design()])
    pending, saved = first.view.unproven, first.backups()
    assert pending
    assert saved.backups
    devices.disconnect("1")
    monkeypatch.setattr(registry, "known_port", lambda port: Port(port, port, leads_to=port))
    again = devices.connect(changed_boards.port, "grbl")
    assert again.backups() == saved
    assert again.view.proof is not None or again.view.unproven == pending
    devices.close()


def test_a_mistake_of_ours_with_one_lost_device_keeps_none_from_being_found(
    plug_in: Callable, unplugged_at: UnpluggedAt, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(reconnect, "LOOK_S", 0.01)
    mistakes = [ValueError("a mistake")]

    def find_again(lost: Port) -> str:
        if mistakes:
            raise mistakes.pop()
        return lost.port

    monkeypatch.setattr(attachment, "find_again", find_again)
    devices = Devices()
    device = devices.connect(plug_in(unplugged_at))
    unplugged_at.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.settings()
    unplugged_at.is_plugged_in = True
    devices.look_for_lost_ones()
    wait_for(device, DeviceState.READY)
    assert "Device 1 could not be looked for" in caplog.text
    devices.close()
