"""The page that is in control of a device."""

from __future__ import annotations

import threading
from contextlib import suppress

import pytest

from devices.motion import PATIENCE_S
from stepramp.devices import control
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceView
from stepramp.errors import Refused


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
