"""Motions in real time, and what they are waited for."""

from __future__ import annotations

import time
from collections.abc import Callable

from stepramp.controllers.contract import AxisCommand
from stepramp.devices.device import Device
from stepramp.devices.view import DeviceState

PATIENCE_S = 10.0
LONG_MOVE = 100_000


def by_steps(*steps: int) -> list[AxisCommand]:
    return [AxisCommand(axis, each, f"axes.{axis}.by_steps") for axis, each in enumerate(steps)]


def wait_for(device: Device, state: DeviceState) -> None:
    wait_until(lambda: device.view.state is state, device)


def wait_until(condition: Callable[[], bool], device: Device) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"still {device.view}"
        time.sleep(0.005)
