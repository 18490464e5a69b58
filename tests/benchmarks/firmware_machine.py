"""Measure the complete firmware on the simulated chip, over its serial port: how fast motors can go, and what is left.

usage: PYTHONPATH=tests python tests/benchmarks/firmware_machine.py
"""

import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks import firmware_formula
from firmware.checker import CYCLES_PER_S, lateness_us
from firmware.rig import BusyClient, Played, RampDesign, along_a_line, controller_in, image, move_by, play
from simulator.avr import build_firmware, build_harness

RATES = {
    "1 axis": (100_000, 130_000, 150_944),
    "2 axes": (40_000, 55_000, 65_040),
    "3 axes": (25_000, 35_000, 41_237),
    "4 axes": (20_000, 25_000, 30_019),
    "line of 2": (80_000, 100_000, 120_301),
    "line of 3": (70_000, 85_000, 100_000),
    "line of 4": (60_000, 75_000, 88_395),
}
"""[steps/s] of each axis, the last one as fast as the firmware allows. Beyond that it refuses to move."""
SLEW_S, RAMP_S = 0.15, 0.025
QUEUE_BYTES = 512


@dataclass(frozen=True)
class Run:
    is_good: bool
    late_us: np.ndarray
    free: float
    """Share of the processor that the interrupts leave, at slew speed."""

    def __str__(self) -> str:
        if not self.is_good:
            return "**steps lost** |"
        return f"{self.late_us.max():.1f} / {np.percentile(self.late_us, 99):.1f} | {self.free:.0%}"


def run(name: str, rate: int, folder: Path) -> Run:
    """Move as a name of RATES says, up to a rate, while the serial port is busy."""
    count, is_line = int("".join(filter(str.isdigit, name))), name.startswith("line")
    plan = RampDesign(rate, rate / RAMP_S, rate / RAMP_S)
    steps = [int(rate * SLEW_S) - (axis if is_line else 0) for axis in range(count)]
    work = along_a_line(*steps) if is_line else move_by(*steps)
    played = play(partial(controller_in, folder), image([plan] * count), work)
    made = [played.steps(axis) for axis in range(count)]
    is_good = [part.size for part in made] == steps and {status.starved for status in played.statuses} == {0}
    if not is_good:
        return Run(False, np.zeros(1), 0.0)
    judged = made[:1] if is_line else made
    planned = [plan.ramp.intervals(part.size) for part in judged]
    late = [lateness_us(part, intervals, 1) for part, intervals in zip(judged, planned, strict=True)]
    return Run(is_good, np.concatenate(late), free_at_slew(played, plan, made))


def free_at_slew(played: Played, plan: RampDesign, made: list[np.ndarray]) -> float:
    """Return the share that is left when each step costs what a step of this run cost on average."""
    cycles = sum(played.statistics[name]["cycles"] for name in ("compare_a", "compare_b"))
    received = played.statistics["receive"]
    a_byte = received["cycles"] / received["count"]
    steps = max(part.size for part in made)
    return 1 - cycles / (steps * plan.slew) - a_byte * 11_520 / CYCLES_PER_S


def speeds() -> None:
    """Print what passes, and how punctual it is."""
    print("| what moves | steps/s of each | late max / p99 µs | of the processor free |\n|---|---:|---:|---:|")
    for name, rates in RATES.items():
        for rate in rates:
            with tempfile.TemporaryDirectory() as folder:
                print(f"| {name} | {rate:,} | {run(name, rate, Path(folder))} |", flush=True)


def answers() -> None:
    """Print how long a status takes to be answered, at rest and at full speed."""
    print("\n| one axis, steps/s | longest answer to a status ms |\n|---:|---:|")
    for rate in (0, 50_000, 150_944):
        plan = RampDesign(rate or 1000, (rate or 1000) / RAMP_S, (rate or 1000) / RAMP_S)
        with tempfile.TemporaryDirectory() as folder:
            played = play(partial(controller_in, Path(folder)), image([plan]), asking(rate))
        print(f"| {rate:,} | {played.statistics['longest_answer_cycles'] / CYCLES_PER_S * 1e3:.1f} |", flush=True)


def asking(rate: int) -> Callable[[BusyClient], None]:
    def work(client: BusyClient) -> None:
        if rate:
            client.move_by(int(rate * SLEW_S))
        for _ in range(20):
            client.status()

    return work


def sizes() -> None:
    """Print what the firmware takes of the chip's memory, without inputs and with them."""
    print("\n| build | flash, of 32,256 bytes | static RAM, of 2,048 | left for the stack |\n|---|---:|---:|---:|")
    for options in ((), ("INPUTS=yes",)):
        elf = str(build_firmware(*options))
        out = subprocess.run(["avr-size", elf], check=True, capture_output=True, text=True).stdout
        text, data, bss = map(int, out.splitlines()[1].split()[:3])
        static = data + bss + QUEUE_BYTES
        print(f"| `{' '.join(('make', *options))}` | {text + data:,} | {static:,} | {2048 - static:,} |")


def firmware_machine() -> None:
    """Print all tables of the complete firmware."""
    build_harness()
    speeds()
    answers()
    sizes()
    print("\nCycles of a delay that the chip computes:\n")
    firmware_formula.main()


if __name__ == "__main__":
    firmware_machine()
