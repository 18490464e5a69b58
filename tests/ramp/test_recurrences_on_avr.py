"""float32 on the chip: avr-gcc's floating point in the simulator, against numpy's, bit for bit."""

import os
import subprocess
import termios
from pathlib import Path

import numpy as np
import pytest

from simulator.avr import SimulatedController, missing_tools
from stepramp.methods import METHODS
from stepramp.shapes.constant import ConstantAcceleration as Slope
from tools import require

SLOPES = [
    Slope(1_000_000, 100, 2000, 4000),
    Slope(2_000_000, 0, 1000, 5000),
    Slope(16_000_000, 3.7, 3333.3, 12_345.6),
]
NUMBERS_IN_C = {"first_order": 20, "second_order": 22, "compromise": 23, "newton": 0}


def bits(number: float) -> str:
    return f"{np.float32(number).view(np.uint32):#x}ul"


def program(folder: Path, slope: Slope, method: int) -> Path:
    first = slope.base_speed**2 + 2 * slope.acceleration
    constants = {
        "METHOD": method,
        "STEPS": slope.steps,
        "P1": bits(slope.initial_interval),
        "PS": bits(slope.slew_interval),
        "R": bits(slope.multiplier),
        "K": bits(1 / slope.timer_hz**2),
        "GAIN": bits(2 * slope.acceleration),
        "W_UP": bits(first),
        "W_DOWN": bits(slope.base_speed**2 + 2 * slope.acceleration * (slope.steps + 1)),
    }
    elf = folder / "recurrences.elf"
    source = Path(__file__).with_name("recurrences_avr.c")
    flags = ["-mmcu=atmega328p", "-O2", "-std=c99", "-Wall", "-Wextra", "-Werror"]
    flags += [f"-D{name}={value}" for name, value in constants.items()]
    subprocess.run(["avr-gcc", *flags, "-o", str(elf), str(source), "-lm"], check=True)
    return elf


def received(controller: SimulatedController, size: int) -> bytes:
    port = os.open(controller.port, os.O_RDWR | os.O_NOCTTY)
    try:
        mode = termios.tcgetattr(port)
        mode[0] = mode[1] = mode[3] = 0
        mode[6][termios.VMIN], mode[6][termios.VTIME] = 0, 100
        termios.tcsetattr(port, termios.TCSANOW, mode)
        os.write(port, b"!")
        data = b""
        while len(data) < size and (more := os.read(port, size - len(data))):
            data += more
        return data
    finally:
        os.close(port)


@pytest.mark.parametrize("method", NUMBERS_IN_C)
@pytest.mark.parametrize("slope", SLOPES, ids=str)
def test_float32_is_what_avr_gcc_gives_bit_for_bit(tmp_path: Path, slope: Slope, method: str) -> None:
    require(*missing_tools())
    with SimulatedController(program(tmp_path, slope, NUMBERS_IN_C[method]), tmp_path, real_time=False) as controller:
        sent = np.frombuffer(received(controller, 8 * slope.steps), "<u4")
    sides_of = METHODS[method].sides
    assert sides_of is not None
    sides = sides_of("float32", "largest_error")
    up, down = sides.up(slope), sides.down(slope)
    np.testing.assert_array_equal(np.concatenate((up, down[::-1])).view(np.uint32), sent)
