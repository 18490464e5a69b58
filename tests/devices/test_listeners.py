"""Those who listen to what devices do."""

from __future__ import annotations

import pytest

from designs import design
from devices.motion import by_steps, wait_for
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState


def test_listeners_hear_of_each_change(devices: Devices, port: str) -> None:
    states: list[list[str]] = []
    with devices.listening(lambda: states.append([view.state.value for view in devices.views()])):
        device = devices.connect(port)
        device.push([design()])
        device.move_by(by_steps(50))
        wait_for(device, DeviceState.READY)
        devices.disconnect("1")
    heard = [state for index, state in enumerate(states) if index == 0 or state != states[index - 1]]
    assert heard[:5] == [["connecting"], ["ready"], ["writing"], ["ready"], ["moving"]]
    assert heard[-1] == []
    count = len(states)
    devices.connect(port)
    assert len(states) == count


def test_a_listener_that_fails_keeps_nobody_waiting(
    devices: Devices, port: str, caplog: pytest.LogCaptureFixture
) -> None:
    heard = []

    def fail() -> None:
        raise ZeroDivisionError("a mistake")

    with devices.listening(fail), devices.listening(lambda: heard.append(1)):
        device = devices.connect(port)
        device.push([design()])
        device.move_by(by_steps(10))
        wait_for(device, DeviceState.READY)
        assert heard
    assert "could not be told" in caplog.text
