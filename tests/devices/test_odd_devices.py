"""What talks nonsense, for ever or not at all: told all the same, and its port is free again."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest

from devices.odd_device import OddDevice
from stepramp.devices.registry import Devices
from stepramp.errors import DeviceLost, Refused
from stepramp.link.serial_port import SerialPort
from waiting import PATIENCE_S

NOISE = random.Random(17).randbytes(4000)

ODD: dict[str, Callable[[], OddDevice]] = {
    "silent": lambda: OddDevice(lambda _: b""),
    "deaf": OddDevice,
    "a byte now and then": lambda: OddDevice(lambda _: b"", b"U", 0.3),
    "noise at 1 MB/s": lambda: OddDevice(lambda _: b"", NOISE, len(NOISE) / 1e6),
    "zeros at 1 MB/s": lambda: OddDevice(lambda _: b"", bytes(4000), 0.004),
    "lines at 1 MB/s": lambda: OddDevice(None, b"ok\r\n" * 1000, 0.004),
    "an echo": lambda: OddDevice(lambda heard: heard),
    "another program": lambda: OddDevice(lambda _: b"error:20\r\n"),
}
SILENT = ("silent", "deaf")


@pytest.mark.parametrize(
    ("family", "nothing", "something"),
    [
        ("stepramp", "Nothing answers at", "Something talks at"),
        ("tic", "Nothing answers at .* as a Tic does", "Something talks at .*, but it is no Tic"),
        ("grbl", "Nothing answers at .* as grbl does", "Something talks at .*, but it is no grbl"),
        ("fluidnc", "Nothing answers at .* as FluidNC does", "Something talks at .*, but it is no FluidNC"),
        ("tmcl", "Nothing answers at .* as a TMCL module does", "Something talks at .*, but it is no TMCL module"),
        ("marlin", "Nothing answers at .* as Marlin does", "Something talks at .*, but it is no Marlin"),
        ("marlin_250000", "Nothing answers at .* as Marlin does", "Something talks at .*, but it is no Marlin"),
    ],
)
def test_what_is_no_controller_is_told_and_leaves_its_port_usable(family: str, nothing: str, something: str) -> None:
    devices = Devices()

    def tried(name: str) -> None:
        with ODD[name]() as odd:
            began_s = time.monotonic()
            with pytest.raises((DeviceLost, Refused), match=nothing if name in SILENT else something) as caught:
                devices.connect(odd.port, family)
            assert time.monotonic() - began_s < PATIENCE_S, name
            assert odd.port in str(caught.value)
            SerialPort(odd.port).close()

    names = list(ODD)
    with ThreadPoolExecutor(4) as pool:
        for each in [pool.submit(tried, name) for name in names]:
            each.result()
    assert devices.views() == []
    devices.close()
