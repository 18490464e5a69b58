"""Measure the Arduino library with a timer on simulated boards: how fast, how punctual, how large."""

import tempfile
from pathlib import Path

import numpy as np

from benchmarks.firmware_engine import line_run, shortest_interval, worst_of_axes
from firmware.arduino.board import EXAMPLES, LEONARDO, LIBRARY, MEGA, UNO, Board, build, build_sketch
from firmware.arduino.stops import Stop
from firmware.arduino.timed import BUSY, ENGINES, SPEEDS, UNTIL_REST, move_all, run, source_of
from firmware.checker import axis_of, lateness_us
from firmware.emergency_stops import WORK, stopped
from firmware.engine.jobs import Engine
from firmware.rig import RampDesign, image
from simulator.avr import CLOCK_HZ

LINES = {"line of 2": 2, "line of 3": 3, "line of 4": 4}


def lateness(engine: Engine, count: int) -> str:
    """Return how late steps are at the highest speeds, with the serial port sending without a pause."""
    plan = RampDesign(SPEEDS[count], 10 * SPEEDS[count], 10 * SPEEDS[count])
    steps = [SPEEDS[count] // 3 + 200 * axis for axis in range(count)]
    source = source_of(engine, image([plan] * count), move_all(steps), BUSY + UNTIL_REST, axes=count)
    with tempfile.TemporaryDirectory() as folder:
        edges = run(engine, source, Path(folder), busy=False).edges
    late = [lateness_us(axis_of(edges, axis).steps, plan.ramp.intervals(count), 1) for axis, count in enumerate(steps)]
    together = np.concatenate(late)
    return f"{together.max():.1f} / {np.percentile(together, 99):.1f}"


def speeds() -> None:
    """Print what the interrupts alone reach, and how late a sketch's steps are at its limits."""
    print("| board, timer | what moves | interrupts alone, steps/s | a sketch's limit | late there max / p99 µs |")
    print("|---|---|---:|---:|---:|")
    for engine in ENGINES:
        for count, speed in SPEEDS.items():
            least = shortest_interval(
                lambda interval, count=count, engine=engine: worst_of_axes(count, interval, engine)
            )
            words = (engine.name, f"{count} axes", f"{CLOCK_HZ / least:,.0f}", f"{speed:,}", lateness(engine, count))
            print(f"| {' | '.join(words)} |", flush=True)
        for name, count in LINES.items():
            least = shortest_interval(lambda interval, count=count, engine=engine: line_run(count, interval, engine))
            print(f"| {engine.name} | {name} | {CLOCK_HZ / least:,.0f} | | |", flush=True)


def stops() -> None:
    """Print how long after an emergency stop the last step comes, at the highest speeds; controller and library."""
    print("\n| emergency stop of | what moves | from its edge to the last step, at most, µs |\n|---|---|---:|")
    for name in WORK:
        with tempfile.TemporaryDirectory() as folder:
            print(f"| the controller | {name} | {stopped(name, 4, Path(folder)).latest_us:.1f} |", flush=True)
    for stop in (
        *(Stop(each, 4) for each in ENGINES),
        Stop(Engine(UNO), 4, width_us=100),
        Stop(Engine(UNO), 4, timer=False),
    ):
        with tempfile.TemporaryDirectory() as folder:
            words = f"a sketch, {stop.engine.name if stop.timer else 'from loop()'}"
            what = f"{stop.axes} axes" + (f", pulses of {stop.width_us} µs" if stop.width_us else "")
            print(f"| {words} | {what} | {stop.latest_us(Path(folder)):.1f} |", flush=True)


def size(example: str, board: Board, source: Path | None = None) -> str:
    """Return flash and RAM of an example, or of a sketch."""
    try:
        sketch = build_sketch(source, board) if source else build(example, board)
    except AssertionError:  # the linker's
        return "too large"
    words = f"{sketch.flash_bytes:,}, {sketch.ram_bytes:,}"
    return words if sketch.flash_bytes <= board.flash_bytes else f"too large: {words}"


def sizes() -> None:
    """Print flash and RAM of the examples, played from loop() and by a timer."""
    print("\n| example | board | from loop(): flash, RAM bytes | by Timer1: flash, RAM bytes |\n|---|---|---:|---:|")
    for example in EXAMPLES:
        for board in (UNO, MEGA, LEONARDO):
            with tempfile.TemporaryDirectory() as folder:
                source = Path(folder) / f"{example}-timer.ino"
                text = (LIBRARY / "examples" / example / f"{example}.ino").read_text()
                source.write_text(f"#include <StepRampTimer1.h>\n{text}")
                words = (example, board.name, size(example, board), size(example, board, source))
            print(f"| {' | '.join(words)} |", flush=True)


def library_timer() -> None:
    """Print all tables."""
    sizes()
    print()
    speeds()
    stops()


if __name__ == "__main__":
    library_timer()
