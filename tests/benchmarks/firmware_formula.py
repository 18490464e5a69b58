"""Print what a delay costs that an ATmega328P computes, in the simulator [cycles], and the size of the code [bytes].

usage: PYTHONPATH=tests python tests/benchmarks/firmware_formula.py
"""

import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

from firmware.formula.machine import Machine, build_for_chip
from stepramp.controllers.stepramp.formula_image import encode_formula
from stepramp.methods.common.fixed_point import Scaled
from stepramp.ramp.on_chip import OnChipRamp
from stepramp.shapes.constant import ConstantAcceleration as Slope

METHODS: dict[str, int] = {"first_order": 0, "compromise": 2, "newton": 4}
SIDES_AT, SIDE_BYTES = 15, 39
TIMER_HZ, SLEW, ACCELERATION = 2e6, 5000, 10_000
INDEX = 600
SIZES = (3, 8, 16)
AS_BUILT = ("-Os", "-mcall-prologues", "-fno-jump-tables", "-fira-algorithm=priority", "-mstrict-X")
OBJECTS = ("stepramp/motion/formula.c", "stepramp/motion/axis_by_formula.c", "boards/avr/formula.S")


def mean_cycles(machine: Machine, batch: Callable[[], int]) -> float:
    """Return the cycles a delay of batches, until one of them is empty."""
    cycles = delays = 0
    while got := batch():
        cycles += machine.cycles
        delays += got
    return cycles / delays


def ways(machine: Machine, method: str, deceleration: float, size: int) -> str:
    """Return the cycles a delay of a whole ramp up and a whole ramp down."""
    slopes = Slope(TIMER_HZ, 0, SLEW, ACCELERATION), Slope(TIMER_HZ, 0, SLEW, deceleration)
    machine.check(encode_formula(OnChipRamp.of(*slopes, method)))
    up = mean_cycles(machine, lambda: machine.up(size).size)
    return f"{up:.0f} / {mean_cycles(machine, lambda: machine.down(size).size):.0f}"


def loop(machine: Machine, method: str, size: int) -> int:
    """Return the cycles of one call of the loop, upwards, in the middle of a ramp."""
    slope = Slope(TIMER_HZ, 0, SLEW, ACCELERATION)
    constants = encode_formula(OnChipRamp.of(slope, slope, method))
    x = Scaled.of((2 * INDEX) ** -0.5)
    machine.step(size, METHODS[method], INDEX, *x, constants[SIDES_AT : SIDES_AT + SIDE_BYTES])
    return machine.cycles


def sizes(folder: Path) -> None:
    """Print the size of each file, as the firmware is built."""
    sources = Path(__file__).parents[2] / "firmware" / "src"
    for name in OBJECTS:
        built = folder / "object.o"
        flags = ["-mmcu=atmega328p", "-DSTEPRAMP_IN_ASSEMBLY", *AS_BUILT, "-std=c99", f"-I{sources}"]
        subprocess.run(["avr-gcc", *flags, "-c", "-o", str(built), str(sources / name)], check=True)
        size = subprocess.run(["avr-size", str(built)], check=True, capture_output=True, text=True).stdout.split()[6]
        print(f"{name}: {size} bytes")


def main() -> None:
    """Print both tables."""
    print("| | each further delay | loop, 3 | 8 | 16 | up / down, 3 | 8 | 16 | d ≠ a: 3 | 8 | 16 |")
    print("|---" + 10 * "|---:" + "|")
    with tempfile.TemporaryDirectory() as folder:
        with Machine(build_for_chip(Path(folder))) as machine:
            for method in METHODS:
                further = (loop(machine, method, 32) - loop(machine, method, 16)) / 16
                loops = [f"{loop(machine, method, size) / size:.0f}" for size in SIZES]
                same = [ways(machine, method, ACCELERATION, size) for size in SIZES]
                other = [ways(machine, method, 1.7 * ACCELERATION, size) for size in SIZES]
                print("|", " | ".join((method, f"{further:.0f}", *loops, *same, *other)), "|")
        sizes(Path(folder))


if __name__ == "__main__":
    main()
