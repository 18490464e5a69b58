"""Measure the firmware's engine on the simulated chip: how fast it can step, how punctually, and what that costs."""

import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from firmware.engine.jobs import (
    CONTROLLER,
    LINE,
    SOURCES,
    Engine,
    Job,
    LineSegment,
    Segment,
    chip_sources,
    play_on_chip,
)
from simulator.avr import CLOCK_HZ, folder_of_builds

CYCLES_PER_US = 16
STEPS_A_SEGMENT = 50
SEGMENTS = 200
MOST_LATE_US = 40
TARGETS = {"1 axis": 150_000, "2 axes": 65_000, "3 axes": 42_000, "4 axes": 30_000} | {
    "line of 2": 120_000,
    "line of 3": 100_000,
    "line of 4": 90_000,
}
AXES_OF = {1: (0,), 2: (0, 1), 3: (0, 1, 2), 4: (0, 1, 2, 3)}


@dataclass(frozen=True)
class Run:
    """`late_us`: of each step, after the earliest place it can have."""

    is_good: bool
    late_us: np.ndarray[Any, Any]
    statistics: dict[str, Any]
    span_cycles: int

    def free(self) -> float:
        """Return the share of the processor that the interrupts leave."""
        taken = sum(self.statistics[name]["cycles"] for name in ("compare_a", "compare_b", "receive"))
        return 1 - taken / self.span_cycles


def judged(job: Job, ideals: dict[int, np.ndarray[Any, Any]], engine: Engine = CONTROLLER) -> Run:
    """Play a job; compare the steps with their ideal times [cycles from anywhere]."""
    with tempfile.TemporaryDirectory() as folder:
        chip = play_on_chip(job, Path(folder), engine)
    is_complete = all(len(chip.steps[axis]) == len(ideal) for axis, ideal in ideals.items())
    is_complete = is_complete and chip.statistics["lost_bytes"] == 0 and max(chip.empty) == 1
    if not is_complete:
        return Run(False, np.array([1e9]), chip.statistics, 1)
    late = np.concatenate([chip.steps[axis] - ideal for axis, ideal in ideals.items()])
    late_us = (late - late.min()) / CYCLES_PER_US
    first = min(chip.steps[axis][0] for axis in ideals)
    span = max(chip.steps[axis][-1] for axis in ideals) - first
    most_us = engine.late(MOST_LATE_US * CYCLES_PER_US) / CYCLES_PER_US
    return Run(bool(late_us.max() <= most_us), late_us, chip.statistics, int(span))


def axes_run(
    axes: Sequence[int],
    interval: int,
    spread: bool,
    segments: int = SEGMENTS,
    fast: bool = True,
    engine: Engine = CONTROLLER,
) -> Run:
    """All of the axes at one rate, in step or spread over the interval."""
    cycles_per_tick = 1 if fast else 8
    ticks = interval // cycles_per_tick
    lists: list[list[Segment]] = [[], [], [], []]
    ideals = {}
    steps = STEPS_A_SEGMENT * segments
    for i, axis in enumerate(axes):
        wait = 1000 + (ticks * i // len(axes) if spread else 0)
        lists[axis] = [Segment(wait, is_step=False), *[Segment(ticks, STEPS_A_SEGMENT)] * segments]
        ideals[axis] = (wait + ticks * np.arange(steps)) * cycles_per_tick
    return judged(Job(lists, fast=fast, busy=True), ideals, engine)


def worst_of_axes(count: int, interval: int, engine: Engine = CONTROLLER) -> Run:
    runs = [
        axes_run(AXES_OF[count], interval, spread, engine=engine)
        for spread in ((False, True) if count > 1 else (False,))
    ]
    return min(runs, key=lambda run: (run.is_good, -run.late_us.max()))


def line_run(count: int, interval: int, engine: Engine = CONTROLLER) -> Run:
    """One line, as along a ramp: its followers step at nearly every event of the leader."""
    steps = STEPS_A_SEGMENT * SEGMENTS
    followers = tuple((axis, steps - axis) for axis in range(1, count))
    begin = LineSegment(interval, STEPS_A_SEGMENT, leaders=1, total=steps, followers=followers)
    line = [begin, *[LineSegment(interval, STEPS_A_SEGMENT)] * (SEGMENTS - 1)]
    return judged(Job([line], mode=LINE, busy=True), {0: interval * np.arange(steps)}, engine)


def shortest_interval(run: Callable[[int], Run]) -> int:
    """Return the shortest interval [cycles] at which a run is good, to 2 cycles."""
    bad, good = 60, 1200
    while good - bad > 2:
        middle = (bad + good) // 2
        bad, good = (bad, middle) if run(middle).is_good else (middle, good)
    return good


def punctuality(run: Run) -> str:
    return f"{run.late_us.max():.1f} / {np.percentile(run.late_us, 99):.1f}" if run.is_good else "**steps lost**"


def limits() -> None:
    """Print the highest rates, and how late steps are at them and at the targets."""
    print(
        "| what moves | steps/s of each, limit | late there max / p99 µs | target steps/s | late there max / p99 µs |"
    )
    print("|---|---:|---:|---:|---:|")
    for name, target in TARGETS.items():
        count = int("".join(filter(str.isdigit, name)))
        play = line_run if name.startswith("line") else worst_of_axes
        interval = shortest_interval(lambda interval, play=play, count=count: play(count, interval))
        at_target = play(count, CLOCK_HZ // target)
        rate = CLOCK_HZ / interval
        words = (name, f"{rate:,.0f}", punctuality(play(count, interval)), f"{target:,}", punctuality(at_target))
        print(f"| {' | '.join(words)} |", flush=True)


def costs() -> None:
    """Print what interrupts cost, and what they leave."""
    print("\n| one axis, steps/s | late max / p99 µs | of the processor free |\n|---:|---:|---:|")
    for rate in (150_000, 130_000, 100_000, 49_000):
        run = axes_run((0,), CLOCK_HZ // rate, spread=False, segments=1000)
        print(f"| {rate:,} | {punctuality(run)} | {run.free():.0%} |", flush=True)
    print("\n| interrupt | cycles, shortest | mean | longest |\n|---|---:|---:|---:|")
    alone, shared = axes_run((0,), 1000, False), axes_run((0, 2), 1000, True)
    rows = {"only axis of its channel": alone.statistics["compare_a"]}
    rows |= {"one of two axes": shared.statistics["compare_a"], "a byte received": alone.statistics["receive"]}
    rows |= {f"line of {count}": line_run(count, 1000).statistics["compare_a"] for count in (2, 3, 4)}
    for name, times in rows.items():
        print(f"| {name} | {times['shortest']} | {times['cycles'] / times['count']:.1f} | {times['longest']} |")


def sizes() -> None:
    """Print what the engine takes of the chip's memory."""
    print("\n| source | flash bytes | RAM bytes |\n|---|---:|---:|")
    flags = ["-mmcu=atmega328p", "-DF_CPU=16000000UL", "-DSTEPRAMP_IN_ASSEMBLY", "-O2", "-std=c99"]
    include = [f"-I{SOURCES}"]
    for source in chip_sources():
        target = folder_of_builds() / "size.o"
        subprocess.run(["avr-gcc", *flags, *include, "-c", "-o", target, source], check=True)
        out = subprocess.run(["avr-size", target], check=True, capture_output=True, text=True).stdout
        text, data, bss = map(int, out.splitlines()[1].split()[:3])
        print(f"| {source.name} | {text + data} | {data + bss} |")
    print("| queues | 0 | 512 |")


def firmware_engine() -> None:
    """Print all tables. Edges of the simulated pins, the serial port busy both ways, 50 steps a segment."""
    limits()
    costs()
    sizes()


if __name__ == "__main__":
    firmware_engine()
