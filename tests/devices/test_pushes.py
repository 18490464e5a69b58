"""Ramps and settings on trial, and what becomes of them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designs import design
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused


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


@pytest.mark.parametrize("end", [Device.keep, Device.roll_back, Device.restore])
def test_nothing_is_under_way_once_it_is_answered(devices: Devices, port: str, end: Callable[[Device], None]) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.push([design(), design()], mode="try" if end is not Device.restore else "keep")
    end(device)
    assert (device.view.progress, device.view.state) == (None, DeviceState.READY)


def test_settings(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    assert device.settings() == StepRampSettings()
    device.use_settings(StepRampSettings(pulse_width_us=8))
    assert (device.settings().pulse_width_us, device.view.on_trial) == (8, True)
    with pytest.raises(Refused, match="push a design first"):
        device.keep()
    device.push([design()])
    assert not device.view.on_trial
    devices.disconnect("1")
    assert devices.connect(port).settings().pulse_width_us == 8
