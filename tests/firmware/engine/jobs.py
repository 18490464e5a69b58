"""Jobs for the engine: what to put into its queues, played on the simulated chip and by the engine's twin in C."""

import json
import struct
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from firmware.arduino.board import LEONARDO, MEGA, UNO, Board, build_files
from simulator.avr import EDGE, Chip, build_harness, build_program, folder_of_builds

AXES, LINE, GAUGES = range(3)
STEP_PINS = (2, 3, 4, 12)
DIRECTION_PINS = (5, 6, 7, 13)
HALT_PIN = 14
NEVER = 0xFFFF
LONGEST_WAIT = 30_000
RESULT_BYTES = 86
CORE_INTERRUPTS = 300
"""Cycles for which Arduino's core may block ours: Timer0's, a byte received and one sent."""

_HERE = Path(__file__).parent
_FIRMWARE = _HERE.parents[2] / "firmware"
SOURCES = _FIRMWARE / "src"
_SETTINGS = SOURCES / "stepramp" / "store" / "driver_settings.c"
_PORTABLE = [SOURCES / "boards" / "polled" / "polled_engine.c", _SETTINGS]
_HOST_FLAGS = ["-std=c99", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
_ON_THE_CHIP = ("engine.c", "gauge.c", "outputs.c", "engine.S", "line.S")
_BESIDE_IT = ("clock.c", "reset.c", "serial.c", "usart.S")


@dataclass(frozen=True)
class Segment:
    interval: int
    count: int = 1
    add: int = 0
    is_step: bool = True
    turns: bool = False

    def intervals(self) -> list[int]:
        return [self.interval + i * self.add for i in range(self.count)]

    def packed(self) -> bytes:
        return struct.pack("<HhHBB", self.interval, self.add, self.count - 1, self.is_step, self.turns)


@dataclass(frozen=True)
class LineSegment:
    """`followers` are (axis, delta), which counts only where `total` isn't 0; all segments of a piece name them."""

    interval: int
    count: int = 1
    add: int = 0
    leaders: int = 1
    total: int = 0
    followers: tuple[tuple[int, int], ...] = ()
    turn_axes: int = 0

    def packed(self) -> bytes:
        deltas = [delta for _, delta in sorted(self.followers)] + [0] * (3 - len(self.followers))
        axes = self.leaders | sum(1 << axis for axis, _ in self.followers) << 4
        words = (self.interval, self.add, self.count - 1, self.total, *deltas)
        return struct.pack("<HhHHHHHBB", *words, axes, self.turn_axes)


@dataclass(frozen=True)
class Job:
    """`axes`: the segments of each axis, or of the line, played `repeats` times.

    `first` axes start at once, `later` ones when the watched axis has loaded so many segments; likewise halts.
    """

    axes: Sequence[Sequence[Segment | LineSegment]]
    fast: bool = True
    mode: int = AXES
    both_edges: int = 0
    step_inverted: int = 0
    direction_inverted: int = 0
    pulse_width_us: int = 0
    setup_ticks: int = 1000
    first: int | None = None
    later: int = 0
    later_loads: int = NEVER
    watched: int = 0
    halted: int = 0
    halt_loads: int = NEVER
    busy: bool = False
    repeats: Sequence[int] = (1, 1, 1, 1)

    def packed(self) -> bytes:
        first = sum(1 << i for i, segments in enumerate(self.axes) if segments) if self.first is None else self.first
        head = struct.pack(
            "<BBBBBBHBBHBBHBB",
            *(self.fast, self.mode, self.both_edges, self.step_inverted, self.direction_inverted, self.pulse_width_us),
            *(self.setup_ticks, first, self.later, self.later_loads, self.watched, self.halted, self.halt_loads),
            *(self.busy, 0),
        )
        begin = 0
        for axis in range(4):
            count = len(self.axes[axis]) if axis < len(self.axes) else 0
            head += struct.pack("<HHH", begin, count, self.repeats[axis])
            begin += count
        return head + b"".join(segment.packed() for segments in self.axes for segment in segments)


@dataclass
class Played:
    """Times of the events: cycles on the chip, ticks in the twin."""

    steps: dict[int, npt.NDArray[np.int64]]
    """By axis. On the chip: where its step pin leaves its resting level, or all its edges where each is a step."""
    turns: dict[int, npt.NDArray[np.int64]]
    positions: tuple[int, ...] = ()
    traced: tuple[tuple[int, ...], ...] = ()
    received: int = 0
    empty: tuple[int, ...] = ()
    edges: npt.NDArray[np.void] = field(default_factory=lambda: np.empty(0, EDGE))
    statistics: dict[str, Any] = field(default_factory=dict)

    def read_result(self, data: bytes) -> None:
        words = struct.unpack("<4i32HH4B", data)
        self.positions = words[:4]
        self.traced = tuple(words[4 + 8 * axis : 12 + 8 * axis] for axis in range(4))
        self.received, self.empty = words[36], words[37:]


@cache
def twin_program() -> Path:
    program = folder_of_builds() / "play_job_host"
    sources = [_HERE / "play_job.c", _HERE / "play_job_host.c", *_PORTABLE]
    command = ["gcc", *_HOST_FLAGS, "-fno-sanitize-recover=all", f"-I{SOURCES}", "-o", program, *sources]
    subprocess.run(command, check=True)
    return program


def chip_sources() -> list[Path]:
    """Return the firmware's sources around the engine, without what is above it."""
    controller = [_FIRMWARE / "controller" / name for name in _BESIDE_IT]
    return [_SETTINGS, *(SOURCES / "boards" / "avr" / name for name in _ON_THE_CHIP), *controller]


@dataclass(frozen=True)
class Engine:
    """An engine on a chip: the controller's, or the library's with one of a board's timers."""

    board: Board | None = None
    timer: int = 1

    @property
    def chip(self) -> Chip:
        return Chip(self.board.chip, self.timer) if self.board else Chip()

    def late(self, controllers: int) -> int:
        """Return how late an event may be [cycles] that may be so late on the controller.

        In a sketch each interrupt takes a third more, and up to three of Arduino's core come one after the other.
        """
        return controllers * 4 // 3 + CORE_INTERRUPTS if self.board else controllers

    @property
    def name(self) -> str:
        return f"{self.board.name}-{self.timer}" if self.board else "controller"


CONTROLLER = Engine()
IN_SKETCHES = (Engine(UNO), Engine(MEGA), Engine(MEGA, 5), Engine(LEONARDO, 3))


@cache
def chip_program(engine: Engine = CONTROLLER) -> Path:
    if engine.board is None:
        return build_program("play_job", [_HERE / "play_job.c", _HERE / "play_job_chip.c", *chip_sources()])
    folder = folder_of_builds() / f"play_job-{engine.name}"
    folder.mkdir()
    sources = [_HERE / "play_job_sketch.cpp", _HERE / "play_job.c"]
    options = [f"-I{_HERE}", f'-DTIMER_HEADER="StepRampTimer{engine.timer}.h"']
    return build_files(sources, folder, engine.board, *options).elf


def play_in_twin(job: Job, folder: Path) -> Played:
    (folder / "job").write_bytes(job.packed())
    lines = subprocess.run(
        [twin_program(), folder / "job"], check=True, capture_output=True, text=True, timeout=20
    ).stdout.split("\n")
    times: dict[str, list[list[int]]] = {"step": [[] for _ in range(4)], "turn": [[] for _ in range(4)]}
    result = b""
    for kind, *words in (line.split() for line in lines if line):
        if kind == "result":
            result = bytes.fromhex(words[0])
            continue
        for axis in range(4):
            if int(words[1]) >> axis & 1:
                times[kind][axis].append(int(words[0]))
    played = Played(*({axis: np.array(times[kind][axis], np.int64) for axis in range(4)} for kind in ("step", "turn")))
    played.read_result(result[:RESULT_BYTES])
    return played


def run_on_chip(
    program: Path, folder: Path, *options: str | Path
) -> tuple[dict[str, Any], npt.NDArray[np.void], bytes]:
    """Run a program until it ends; return what the simulator counted, the edges of the pins and the bytes sent."""
    files = ["--edges", folder / "edges", "--sent", folder / "sent"]
    command = [build_harness(), "--batch", *files, *options, program]
    output = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout
    edges = np.fromfile(folder / "edges", EDGE)
    return json.loads(output), edges, (folder / "sent").read_bytes()


def play_on_chip(job: Job, folder: Path, engine: Engine = CONTROLLER) -> Played:
    (folder / "job").write_bytes(job.packed())
    options = ["--data", folder / "job", *(["--busy"] if job.busy else []), *engine.chip.options]
    statistics, edges, sent = run_on_chip(chip_program(engine), folder, *options)
    # The direction pins, or the coils', first take their resting levels.
    begun = edges["cycle"][0] + (6000 if job.mode == GAUGES else 2000) if edges.size else 0
    moved = edges[edges["cycle"] > begun]
    steps, turns = {}, {}
    for axis in range(4):
        rests = job.step_inverted >> axis & 1
        step = moved[moved["pin"] == STEP_PINS[axis]]
        steps[axis] = (step if job.both_edges >> axis & 1 else step[step["value"] != rests])["cycle"]
        turns[axis] = moved["cycle"][moved["pin"] == DIRECTION_PINS[axis]]
    played = Played(steps, turns, edges=moved, statistics=statistics)
    played.read_result(sent[-RESULT_BYTES:])
    return played


def expected_steps(segments: Sequence[Segment], setup: int) -> list[int]:
    """Return the times of an axis' steps [ticks] after the event that loads its first segment."""
    times, now = [], setup
    for segment in segments:
        for interval in segment.intervals():
            times += [now] if segment.is_step else []
            now += interval
    return times


def pulse_widths(edges: npt.NDArray[np.void], pin: int, rests: int) -> npt.NDArray[np.int64]:
    """Return how long each pulse of a pin is [cycles]."""
    own = edges[edges["pin"] == pin]
    assert all(before["value"] != after["value"] for before, after in pairwise(own))
    begin = own["value"] != rests
    return np.diff(own["cycle"])[begin[:-1]]
