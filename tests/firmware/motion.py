"""The firmware's machine on this machine: motion_driver.c under the sanitizers; and ramp images for it."""

import struct
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from pathlib import Path

from firmware.host import Host

SLOW_HZ = 2_000_000
FAST_HZ = 16_000_000
SETUP_TICKS = {SLOW_HZ: 60, FAST_HZ: 480}
"""Of the default settings."""
DEFAULT_SETTINGS = struct.pack("<6B3H", 0, 0, 0, 0, 0, 0, 30, 0, 0xFFFF)
LARGEST_IMAGE = 440
OK, NO_RAMP, OUT_OF_RANGE, TOO_FAST = 0, 5, 6, 12

_HERE = Path(__file__).parent
_SOURCES = _HERE.parent.parent / "firmware" / "src"
_USED = (
    *sorted((_SOURCES / "stepramp" / "edge").glob("*.c")),
    *sorted((_SOURCES / "stepramp" / "motion").glob("*.c")),
    *(_SOURCES / "stepramp" / "store" / name for name in ("ramp_image.c", "driver_settings.c")),
    _SOURCES / "boards" / "polled" / "polled_engine.c",
    _SOURCES / "boards" / "polled" / "polled_limits.c",
)


def build(folder: Path) -> Path:
    """Build the driver in a folder; return the program."""
    program = folder / "motion_driver"
    flags = ["-std=c99", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
    command = ["gcc", *flags, "-fno-sanitize-recover=all", f"-I{_SOURCES}", "-o", str(program), *map(str, _USED)]
    result = subprocess.run([*command, str(_HERE / "motion_driver.c")], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return program


def zigzag(value: int) -> int:
    return 2 * value if value >= 0 else -2 * value - 1


def leb128(value: int) -> bytes:
    low, rest = value & 0x7F, value >> 7
    return bytes([low | 0x80]) + leb128(rest) if rest else bytes([low])


def packed(segments: Sequence[tuple[int, int, int]]) -> bytes:
    """Return (interval, count, add) as the bytes of a list."""
    data, expected, last_add = b"", 0, 0
    for interval, count, add in segments:
        data += leb128(count) + leb128(zigzag(interval - expected)) + leb128(zigzag(add - last_add))
        expected, last_add = interval + count * add, add
    return data


def segments_of(intervals: Sequence[int]) -> list[tuple[int, int, int]]:
    """Return intervals as segments without any loss: runs of equal differences."""
    segments: list[tuple[int, int, int]] = []
    i = 0
    while i < len(intervals):
        count, add = 1, 0
        if i + 1 < len(intervals) and -(2**15) <= intervals[i + 1] - intervals[i] < 2**15:
            add = intervals[i + 1] - intervals[i]
            while i + count < len(intervals) and intervals[i + count] - intervals[i + count - 1] == add:
                count += 1
        segments.append((intervals[i], count, add if count > 1 else 0))
        i += count
    return segments


@dataclass(frozen=True)
class StoredRamp:
    """A ramp's two lists of intervals from the slow end, and its slew interval [ticks]."""

    up: tuple[int, ...]
    slew: int
    down: tuple[int, ...]

    def encode(self) -> bytes:
        up, down = segments_of(self.up), segments_of(self.down)
        header = struct.pack("<BBBIH", 0, len(up), len(down), self.slew, len(packed(up)))
        body = header + packed(up) + packed(down)
        return struct.pack("<BH", 0, len(body)) + body

    def move(self, steps: int) -> list[int]:
        """Return the intervals of a move: the slowest ones of both lists grow together, up first when equal."""
        n_up = n_down = 0
        up, down = running_least(self.up), running_least(self.down)
        while n_up + n_down < steps and (n_up < len(up) or n_down < len(down)):
            if n_down == len(down) or (n_up < len(up) and up[n_up] >= down[n_down]):
                n_up += 1
            else:
                n_down += 1
        level = [self.slew] * (steps - n_up - n_down)
        return [*self.up[:n_up], *level, *self.down[:n_down][::-1]]


def running_least(intervals: Sequence[int]) -> list[int]:
    return [min(intervals[: i + 1]) for i in range(len(intervals))]


def image_of(*ramps: StoredRamp, fast: bool = False) -> bytes:
    """Return the ramp image of as many axes as there are ramps."""
    head = bytes([2, fast, len(ramps), len(ramps), *range(len(ramps))])
    return head + b"".join(ramp.encode() for ramp in ramps)


@dataclass(frozen=True)
class Steps:
    """Of one axis: when each was made [ticks], and in which direction."""

    times: list[int]
    backward: list[bool]

    @property
    def intervals(self) -> list[int]:
        return [after - before for before, after in zip(self.times, self.times[1:], strict=False)]

    @property
    def moves(self) -> list[tuple[int, list[int]]]:
        """Its runs of one direction: steps with sign, and the intervals within."""
        runs = [list(run) for _, run in groupby(zip(self.times, self.backward, strict=True), key=lambda step: step[1])]
        return [(-len(r) if r[0][1] else len(r), [b[0] - a[0] for a, b in pairwise(r)]) for r in runs]

    def runs(self, longest: int) -> list[list[int]]:
        """Return its intervals from rest to rest: where the direction changes, or nothing happens for longer."""
        runs: list[list[int]] = [[]]
        for i, interval in enumerate(self.intervals):
            if interval > longest or self.backward[i] != self.backward[i + 1]:
                runs.append([])
            else:
                runs[-1].append(interval)
        return runs

    @property
    def travel(self) -> int:
        return sum(-1 if backward else 1 for backward in self.backward)


class Machine:
    """The machine of a driver, with an image in use."""

    def __init__(self, host: Host, image: bytes, settings: bytes = DEFAULT_SETTINGS, round_ticks: int = 100) -> None:
        assert len(image) <= LARGEST_IMAGE
        self._host = host
        host.ask("halt", 15)
        host.ask("use", image.hex() or "-", settings.hex())
        host.ask("position", 15, 0, 0, 0, 0)
        host.ask("round", round_ticks)
        host.ask("put", 0)
        host.ask("stop_comes", 0)
        host.ask("trace", 255, 0)

    def ask(self, *words: object) -> tuple[int, ...]:
        return tuple(int(word) for word in self._host.ask(*words).split())

    def move(self, *targets: int, mask: int | None = None) -> tuple[int, ...]:
        """Return status and detail of a move of the first axes to their targets, or of those of the mask."""
        return self.ask("move", mask or (1 << len(targets)) - 1, *targets)

    def do(self, *words: object) -> None:
        assert self._host.ask(*words) == "ok"

    def rest(self, most_ticks: int = 10**9) -> int:
        """Let time pass until nothing moves; return what time it is."""
        word, time = self._host.ask("rest", most_ticks).split()
        assert word == "rest"
        return int(time)

    def report(self, axis: int = 0) -> "Report":
        return Report(*self.ask("report", axis))

    def steps(self, axis: int = 0) -> Steps:
        return self.all_steps()[axis]

    def all_steps(self) -> list[Steps]:
        """Return the steps of all four axes since the last time."""
        events = [tuple(map(int, word.split(":"))) for word in self._host.ask("events").split()[:-1]]
        return [
            Steps(
                [time for time, axes, _ in events if axes >> axis & 1],
                [bool(backward >> axis & 1) for _, axes, backward in events if axes >> axis & 1],
            )
            for axis in range(4)
        ]

    def traced(self) -> list[tuple[int, int]]:
        """Return (step, timer value) of what has been traced."""
        words = self._host.ask("traced").split()[:-1]
        return [(int(step), int(value)) for step, value in (word.split(":") for word in words)]

    def enabled(self) -> list[tuple[int, int]]:
        words = self._host.ask("enabled").split()[:-1]
        return [(int(time), int(on)) for time, on in (word.split(":") for word in words)]


@dataclass(frozen=True)
class Report:
    state: int
    position: int
    target: int
    interval: int
    steps_made: int
    starved: int
