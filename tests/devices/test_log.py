"""What the log tells: enough to see afterwards who moved what, and each byte when a cable is suspected."""

import logging
from collections.abc import Callable, Iterator

import pytest

from controllers.plain_controller import PLAIN
from designs import design
from firmware.protocol import STOP, decode_frame
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.errors import Rejected


@pytest.fixture
def device(plug_in: Callable[[object], str], caplog: pytest.LogCaptureFixture) -> Iterator[Device]:
    caplog.set_level(logging.DEBUG, "stepramp")
    devices = Devices()
    yield devices.connect(plug_in(VirtualController()))
    devices.close()


def told(caplog: pytest.LogCaptureFixture, level: int, logger: str) -> list[str]:
    records = [*caplog.get_records("setup"), *caplog.records]
    return [each.getMessage() for each in records if (each.levelno, each.name) == (level, logger)]


def test_connects_pushes_moves_and_stops_are_told(device: Device, caplog: pytest.LogCaptureFixture) -> None:
    device.push([design()], mode="try")
    device.move_by([AxisCommand(0, 20_000, "by_steps")])
    device.stop([0]).result()
    with pytest.raises(Rejected):
        device.move_by([AxisCommand(3, 5, "by_steps")])
    device.halt().result()
    lines = told(caplog, logging.INFO, "stepramp.devices.live_view")
    where = f"Device 1 at {device.view.port}: "
    assert all(line.startswith(where) for line in lines)
    said = [line.removeprefix(where) for line in lines]
    assert said[0] == "connected, firmware 0.2.0"
    assert said[1].startswith("ramps pushed, ")
    assert said[1].endswith(" bytes, on trial")
    assert said[2:5] == ["move by 20000 (axis 0): begun", "stop of axes [0] asked for", "stop granted"]
    assert said[5].startswith("move by 5 (axis 3): refused: ")
    assert said[6:] == ["halt of all axes asked for", "stop granted"]


def test_a_version_that_isnt_told_is_left_out(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "stepramp")
    devices = Devices({"plain": PLAIN})
    devices.connect("at a plain wire", "plain")
    devices.close()
    assert told(caplog, logging.INFO, "stepramp.devices.live_view")[0] == "Device 1 at at a plain wire: connected"


def test_each_byte_is_told_in_one_place(device: Device, caplog: pytest.LogCaptureFixture) -> None:
    caplog.clear()
    device.stop().result()
    lines = told(caplog, logging.DEBUG, "stepramp.link.serial_port")
    sent = b"".join(bytes.fromhex(line.partition(" sent ")[2]) for line in lines if " sent " in line)
    received = b"".join(bytes.fromhex(line.partition(" received ")[2]) for line in lines if " received " in line)
    asked = [decode_frame(frame + b"\0") for frame in sent.split(b"\0") if frame]
    answered = [decode_frame(frame + b"\0") for frame in received.split(b"\0") if frame]
    [stop] = [message for message in asked if message[0] == STOP]
    assert bytes([STOP | 0x80]) + stop[1:4] in [message[:4] for message in answered]
