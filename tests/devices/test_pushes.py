"""Ramps and settings on trial, and what becomes of them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designs import design
from stepramp.controllers.stepramp.settings import USUAL_OF_INPUTS, StepRampSettings
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.devices.writing import PlanPush, SendPush
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
    assert (device.view.pushed.kept, device.view.pushed.sequence) == (True, 2)
    device.restore()
    assert (device.view.ramp.sequence, len(device.view.axes)) == (3, 1)
    assert device.view.state is DeviceState.READY


def test_a_stop_ends_a_push_that_is_still_being_planned(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])

    def stopped_meanwhile(plan: PlanPush) -> SendPush:
        send = plan()
        device.stop().result(10)
        return send

    with pytest.raises(Refused, match="A stop came before anything was sent"):
        device.push([design(), design()], None, "keep", stopped_meanwhile)
    assert (device.view.ramp.sequence, len(device.view.axes), device.view.progress) == (1, 1, None)
    device.push([design(), design()])
    assert len(device.view.axes) == 2, "what is asked for after it works"


@pytest.mark.parametrize("end", [Device.keep, Device.roll_back, Device.restore])
def test_nothing_is_under_way_once_it_is_answered(devices: Devices, port: str, end: Callable[[Device], None]) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.push([design(), design()], mode="try" if end is not Device.restore else "keep")
    end(device)
    assert (device.view.progress, device.view.state) == (None, DeviceState.READY)


def test_settings(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    usual = StepRampSettings.unpack(StepRampSettings().pack() + USUAL_OF_INPUTS)
    # It keeps soft limits itself, and has none.
    assert device.settings() == usual.model_copy(update={"soft_limits": ()})
    device.use_settings(StepRampSettings(pulse_width_us=8))
    assert (device.settings().pulse_width_us, device.view.on_trial) == (8, True)
    with pytest.raises(Refused, match="push a design first"):
        device.keep()
    device.push([design()])
    assert not device.view.on_trial
    devices.disconnect("1")
    assert devices.connect(port).settings().pulse_width_us == 8
