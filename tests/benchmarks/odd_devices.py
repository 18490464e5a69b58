"""Measure how long it takes until it is told that a port has no controller of a family, whatever is there instead.

By decision 5 s at most.
"""

import time
from contextlib import suppress

from devices.test_odd_devices import ODD
from stepramp.devices.registry import Devices
from stepramp.errors import DeviceLost, Refused

FAMILIES = ("stepramp", "tic", "grbl", "fluidnc", "tmcl", "marlin", "marlin_250000")


def told_after_s(devices: Devices, family: str, name: str) -> float:
    """Return how long a connection to something odd takes until it is refused [s]."""
    with ODD[name]() as odd:
        began_s = time.monotonic()
        with suppress(DeviceLost, Refused):
            devices.connect(odd.port, family)
        return time.monotonic() - began_s


def odd_devices() -> None:
    """Print a line for each family."""
    print("| told after s | " + " | ".join(ODD) + " |\n|---|" + "---:|" * len(ODD))
    devices = Devices()
    for family in FAMILIES:
        times_s = [told_after_s(devices, family, name) for name in ODD]
        print(f"| {family} | " + " | ".join(f"{time_s:.2f}" for time_s in times_s) + " |", flush=True)
    devices.close()


if __name__ == "__main__":
    odd_devices()
