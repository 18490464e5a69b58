"""Controllers at ports of another machine, behind the real ser2net: all goes as at a cable, also when it comes out."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from controllers.grbl.emulator import GrblOnACable
from controllers.tic.emulator import TicEmulator, TicOnACable
from controllers.usb_board import UsbBoard
from designs import design
from devices.motion import LONG_MOVE, PATIENCE_S, by_steps, wait_for, wait_until
from devices.ser2net import Ser2net
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused
from stepramp.link.remote_ports import RemotePorts

Connect = Callable[[Ser2net], Device]


@pytest.fixture
def connect() -> Iterator[Connect]:
    made = []

    def connect(host: Ser2net, family: str = "stepramp") -> Device:
        devices = Devices(remote_ports=RemotePorts.named([host.host]))
        made.append(devices)
        devices.look_for_lost_ones()
        device = devices.connect(host.address, family)
        device.push([design()], 0, "try")
        return device

    yield connect
    for devices in made:
        devices.close()


def moving(device: Device) -> None:
    device.move_by(by_steps(LONG_MOVE))
    wait_until(lambda: device.view.position_steps > 0, device)


@pytest.mark.parametrize("scheme", ["rfc2217", "socket"])
def test_our_own_controller_far_away(connect: Connect, tmp_path: Path, scheme: str) -> None:
    with UsbBoard() as board, Ser2net(scheme, board.port, 115_200, tmp_path) as host:
        device = connect(host)
        moving(device)
        device.stop().result(PATIENCE_S)
        wait_for(device, DeviceState.READY)
        assert 0 < device.view.position_steps < LONG_MOVE
        moving(device)
        host.kill()
        wait_for(device, DeviceState.LOST)
        assert "Axis 0 was moving, last heard of at" in (device.view.message or "")
        with pytest.raises(DeviceLost):
            device.stop()
        host.begin()
        # The stop that it was owed comes first.
        wait_for(device, DeviceState.READY)
        assert device.view.position_steps < LONG_MOVE
        device.push([design()], 0, "try")
        moving(device)
        device.halt().result(PATIENCE_S)
        assert device.view.state is DeviceState.READY


def test_a_tic_far_away(connect: Callable[[Ser2net, str], Device], tmp_path: Path) -> None:
    tic = TicEmulator()
    tic.has_been_up(60)
    with TicOnACable(tic) as cable, Ser2net("rfc2217", cable.port, 9_600, tmp_path) as host:
        device = connect(host, "tic")
        moving(device)
        device.stop().result(PATIENCE_S)
        wait_for(device, DeviceState.READY)
        moving(device)
        host.kill()
        wait_for(device, DeviceState.LOST)
        host.begin()
        wait_for(device, DeviceState.READY)
        assert device.view.position_steps < LONG_MOVE
        # It counts bytes of all kinds as we do, also that which telnet doubles.
        device.move_to(by_steps(0xFF))
        wait_until(lambda: tic.position == 0xFF, device)


def test_a_stop_that_a_hanging_network_holds_up_is_told_and_comes_first_afterwards(
    connect: Connect, tmp_path: Path
) -> None:
    with UsbBoard() as board, Ser2net("rfc2217", board.port, 115_200, tmp_path) as host:
        device = connect(host)
        moving(device)
        host.freeze()
        began_s = time.monotonic()
        with pytest.raises(DeviceLost):
            device.stop().result(PATIENCE_S)
        assert time.monotonic() - began_s < PATIENCE_S
        with pytest.raises(DeviceLost):
            device.move_by(by_steps(1))
        host.thaw()
        wait_for(device, DeviceState.READY)
        assert device.view.position_steps < LONG_MOVE


@pytest.mark.parametrize("scheme", ["rfc2217", "socket"])
def test_what_a_grbl_far_away_has_stored(tmp_path: Path, scheme: str) -> None:
    with GrblOnACable() as cable, Ser2net(scheme, cable.port, 115_200, tmp_path) as host:
        devices = Devices(remote_ports=RemotePorts.named([host.host]), data=tmp_path)
        device = devices.connect(host.address, "grbl")
        device.push([design()], 0)
        if scheme == "rfc2217":
            device.prove()
            assert device.view.proof is not None
            assert (device.view.unproven, device.view.proof.not_kept) == ((), ())
        else:
            # What listens there may greet whoever connects, as a grblHAL on a network does.
            with pytest.raises(Refused, match="only bytes travel, and nothing that restarts the controller"):
                device.prove()
            device.disconnect()
            device.connect()
            assert (device.view.unproven, device.view.proof) == (("$110", "$120"), None)
        devices.close()


def test_what_is_no_controller_behind_it_is_told_and_its_port_is_free_again(tmp_path: Path) -> None:
    tic = TicEmulator()
    with TicOnACable(tic) as cable, Ser2net("rfc2217", cable.port, 9_600, tmp_path) as host:
        devices = Devices(remote_ports=RemotePorts.named([host.host]))
        began_s = time.monotonic()
        with pytest.raises(DeviceLost, match=f"at {host.address}"):
            devices.connect(host.address, "stepramp")
        assert time.monotonic() - began_s < PATIENCE_S
        assert devices.connect(host.address, "tic").view.state is DeviceState.READY
        devices.close()
