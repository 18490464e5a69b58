"""The page that is in control of a device."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress

import pytest

from devices.motion import PATIENCE_S
from stepramp.devices import control
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceView
from stepramp.errors import Refused


@pytest.mark.parametrize("take", [Devices.acting, Devices.take_over], ids=["acting", "taking over"])
def test_a_page_that_goes_while_it_takes_control_has_none(
    devices: Devices, port: str, monkeypatch: pytest.MonkeyPatch, take: Callable[[Devices, str, str], Device]
) -> None:
    device = devices.connect(port)
    present = devices.present("gone")
    present.__enter__()
    taken = Device.take_control

    def take_late(device: Device, page: str, place: str | None = None, *, over: bool = False) -> None:
        present.__exit__(None, None, None)
        taken(device, page, place, over=over)

    monkeypatch.setattr(Device, "take_control", take_late)
    assert take(devices, device.view.id, "gone") is device
    assert device.view.in_control is None


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
