import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from simulator.avr import SimulatedController, build_firmware, build_harness, missing_tools
from tools import require

LOADERS = Path("/usr/share/arduino/hardware/arduino/avr/bootloaders")


@pytest.fixture
def simulated_controller(tmp_path: Path) -> Callable[..., SimulatedController]:
    """Return a function that makes a simulated controller, with the options of SimulatedController; not started yet."""
    require(*missing_tools())
    build_harness()
    return partial(SimulatedController, build_firmware(), tmp_path)


@pytest.fixture
def optiboot(tmp_path: Path) -> Path:
    """Return the boot loader that Arduino's Uno comes with: optiboot 4.4, which tells nobody why it began."""
    return boot_loader("optiboot/optiboot_atmega328.hex", 512, tmp_path)


@pytest.fixture
def old_loader(tmp_path: Path) -> Path:
    """Return the boot loader of old Nanos: the watchdog that has reset it resets it again and again."""
    return boot_loader("atmega/ATmegaBOOT_168_atmega328.hex", 2048, tmp_path)


def boot_loader(name: str, size: int, folder: Path) -> Path:
    """Return a file with all bytes of the end of the program memory in which a boot loader is."""
    source, loader = LOADERS / name, folder / "loader.bin"
    require(*missing_tools(), *([] if source.exists() else [f"{name} (arduino-core-avr)"]))
    subprocess.run(["avr-objcopy", "-I", "ihex", "-O", "binary", "--gap-fill", "0xFF", source, loader], check=True)
    loader.write_bytes(loader.read_bytes().ljust(size, b"\xff"))
    return loader
