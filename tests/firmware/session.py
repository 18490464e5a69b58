"""Random sessions with a controller: ramps at the limits of what it grants or slow ones, requests at random moments.

The same seed makes the same session.
"""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from firmware.checker import CYCLES_PER_S, CYCLES_PER_US, STEP_PINS
from firmware.flight.setting import Setting, Slopes
from firmware.protocol import (
    BEGIN,
    DATA,
    END,
    FAST_HZ,
    HALT,
    HELLO,
    HOLD_FOR_EVER,
    LARGEST_IMAGE,
    LINE,
    MOVE_BY,
    MOVE_TO,
    REPORT,
    RUN,
    SLOW_HZ,
    STATUS,
    STOP,
    TRACE,
    TRY,
    WRITE_SETTINGS,
    Ramp,
    Segment,
    Settings,
    crc16,
    encode_frame,
    expand,
    for_axes,
    image_of,
    image_parts,
    values_of,
    with_header,
)
from simulator.avr import TimedFrame
from stepramp.controllers.stepramp.formula_image import encode_formula
from stepramp.ramp.on_chip import OnChipRamp
from stepramp.shapes.constant import ConstantAcceleration as Slope

LIMITS = (106, 246, 388, 533)
LINE_LIMITS = (106, 133, 160, 181)
FORMULA_LIMIT = 1600
"""[fast ticks] as hello tells them."""
SEGMENT_S = 350e-6
"""So long must a segment last for each axis that moves: decision 10."""
METHODS: tuple[str, ...] = ("first_order", "compromise", "newton")
REQUESTS = 140
"""Of one session."""
SESSION = 0x5354
LONGEST_WAIT_MS, LONGEST_WAIT_FOR_STEPS_MS = 10.0, 20.0


@dataclass(frozen=True)
class Session:
    """What a controller is to do."""

    seed: int
    title: str
    setting: Setting
    asked: Sequence[TimedFrame]


@dataclass(frozen=True)
class Planned:
    """A ramp, as an image has it and as it is judged."""

    packed: bytes
    slopes: Slopes
    hz: int

    @cached_property
    def longest_s(self) -> float:
        """The longest interval [s]."""
        return float(max(self.slopes.up.max(initial=0), self.slopes.down.max(initial=0), self.slopes.slew)) / self.hz

    @cached_property
    def ramp_down_s(self) -> float:
        return float(self.slopes.down.sum()) / self.hz

    @property
    def slew_s(self) -> float:
        return self.slopes.slew / self.hz


# ---- ramps


def segment_list(
    random: np.random.Generator, slew: int, start: int, lengths_s: Sequence[float], hz: int
) -> list[Segment]:
    """Return segments from an interval down to that of slew speed, which last at least so long each."""
    inner = np.sort(random.uniform(0, 1, len(lengths_s) - 1))[::-1]
    ends = [round(slew * (start / slew) ** share) for share in (*inner, 0)]
    segments, first = list[Segment](), start
    for end, length_s in zip(ends, lengths_s, strict=True):
        count = min(max(math.ceil(length_s * hz / end), 1), 60_000)
        add = -((first - end) // count)
        if count == 1 or add < -(2**15):
            segments.append((first, count, 0))
            first = end
        else:
            segments.append((first, count, add))
            first += count * add
    return segments


def of_segments(random: np.random.Generator, slew: int, axes: int, most: int, hz: int) -> Planned:
    """Return a ramp of random segments, as fast after one another as a controller can prepare them."""
    longest = 2**28 - 1
    lists = []
    for _ in range(2):
        start = min(round(slew * math.exp(random.uniform(0.05, random.choice([0.7, 2.0, 4.0])))), longest)
        count = int(random.integers(1, most + 1))
        least = axes * SEGMENT_S * (1 + random.choice([0, 0.1, 2, 10], count) * random.exponential(1, count))
        if count < 8 and random.random() < 0.15:
            least = least * random.uniform(0, 1, count)
        lists.append(segment_list(random, slew, start, list(least), hz))
    up, down = lists
    if random.random() < 0.4:
        down = up
    slopes = Slopes(np.array(expand(up), float), np.array(expand(down), float), slew)
    return Planned(Ramp(up, slew, down).packed(), slopes, hz)


def by_formula(random: np.random.Generator, slew: int, hz: int) -> Planned:
    """Return a ramp that the controller computes."""
    while True:
        index = math.exp(random.uniform(math.log(1.5), math.log(1500)))
        ratio = float(random.choice([1.0, math.exp(random.uniform(-1.5, 1.5))]))
        base = float(random.choice([0.0, random.uniform(0, 0.5)]))
        method = METHODS[random.integers(3)]
        speed = hz / slew
        acceleration = speed**2 / 2 / index
        up, down = (Slope(hz, base * speed, speed, change) for change in (acceleration, acceleration * ratio))
        try:
            ramp = OnChipRamp.of(up, down, method)
        except ValueError:
            continue
        return Planned(
            with_header(1, encode_formula(ramp)), slopes_of(ramp, acceleration, acceleration * ratio, hz), hz
        )


def slopes_of(ramp: OnChipRamp, up: float, down: float, hz: int) -> Slopes:
    """Return by how much each method may change an interval at a time: none rises faster than formula (20), none falls
    faster than an even deceleration. At rest is what comes close to the last steps of a ramp down, as imprecise as they
    are, and by Newton's method the first steps of a ramp up: decision 9."""
    lengths = np.unique(np.geomspace(2, 2 * (ramp.up.steps + ramp.down.steps), 40).astype(int))
    at_rest = 0.8 * min(int(ramp.move(int(steps))[-2]) for steps in lengths)
    if ramp.method == "newton":
        at_rest = min(at_rest, 0.45 * ramp.up.longest_interval)
    rising, interval = list[float](), min(at_rest, ramp.up.longest_interval)
    while interval > ramp.slew_interval:
        rising.append(interval)
        interval *= 1 - min(interval**2 * up / hz**2, 0.5)
    first = (hz / ramp.down.longest_interval) ** 2 / (2 * down)
    count = max(int((hz / ramp.slew_interval) ** 2 / (2 * down) - first), 0) + 1
    falling = hz / np.sqrt(2 * down * (first + np.arange(count)))
    last_places = int((falling > at_rest).sum()) + 1
    return Slopes(np.array(rising), falling, ramp.slew_interval, places=1, last_places=last_places)


# ---- speeds


def shares(random: np.random.Generator, axes: int) -> npt.NDArray[np.float64]:
    """Return parts of a whole."""
    if random.random() < 0.5:
        return np.full(axes, 1 / axes)
    parts = random.dirichlet(np.full(axes, 1.5)) + 0.05
    return parts / parts.sum()


def slew_interval(kind: str, share: float, need: float, random: np.random.Generator, hz: int) -> int:
    """Return an interval [ticks] of an axis that needs so many fast ticks a step; the share of the processor is its."""
    least = need / share
    speeds = {"fair": (400, 8000), "slow": (4, 300), "crawling": (0.5, 4)}
    if kind == "beyond":
        least = need * math.exp(random.uniform(0, 1.2))
    if kind in speeds:
        low, high = speeds[kind]
        least = max(FAST_HZ / math.exp(random.uniform(math.log(low), math.log(high))), least)
    return math.ceil(math.ceil(least - 1e-9) * hz / FAST_HZ)


@dataclass
class Author:
    """Writes a session."""

    random: np.random.Generator
    ramps: Sequence[Planned]
    settings: Settings
    hz: int
    asked: list[TimedFrame] = field(default_factory=list)
    tag: int = 0
    made: int = 0
    longest_run_s: float = 0.0
    """The longest interval that a run has been asked for [s]."""

    @property
    def axes(self) -> int:
        return len(self.ramps)

    @property
    def rest_s(self) -> float:
        """How long it may take to come to rest, from the slowest run or the highest speed."""
        return max(self.longest_run_s, *(ramp.longest_s + ramp.ramp_down_s for ramp in self.ramps))

    def ask(self, kind: int, body: bytes = b"", **when: int) -> None:
        self.tag = (self.tag + 1) & 0xFF
        self.made += 1
        self.asked.append(TimedFrame(encode_frame(struct.pack("<BHB", kind, SESSION, self.tag) + body), **when))

    def deliver(self, image: bytes) -> None:
        self.ask(HELLO, b"\x02")
        self.ask(WRITE_SETTINGS, self.settings.packed())
        self.ask(BEGIN, struct.pack("<HH", len(image), crc16(image)))
        for part in image_parts(image):
            self.ask(DATA, part)
        self.ask(END)
        self.ask(TRY)
        self.made = 0

    # ---- when

    def soon(self) -> dict[str, int]:
        """Return a moment: at once, a little later, somewhere on a ramp, or near a step."""
        axis = int(self.random.integers(self.axes))
        choice = self.random.random()
        if choice < 0.35:
            return {}
        if choice < 0.65:
            return {"wait_cycles": int(self.random.exponential(2e-3) * CYCLES_PER_S)}
        way_s = min(1.5 * self.ramps[axis].ramp_down_s, LONGEST_WAIT_MS / 1e3)
        if choice < 0.85:
            return {"wait_cycles": int(self.random.uniform(0, way_s) * CYCLES_PER_S)}
        return self.after_steps(axis, int(self.random.integers(1, 40)))

    def after_steps(self, axis: int, steps: int) -> dict[str, int]:
        edges = steps if self.settings.both_edges >> axis & 1 else 2 * steps
        wait = int(LONGEST_WAIT_FOR_STEPS_MS / 1e3 * CYCLES_PER_S)
        return {"wait_cycles": wait, "pin": STEP_PINS[axis], "edges": max(edges, 1)}

    def quiet(self) -> dict[str, int]:
        """Return when all motors rest."""
        longest_s = max(self.longest_run_s, *(ramp.longest_s for ramp in self.ramps))
        return {"quiet_cycles": int((1.2 * longest_s + 0.01 + self.settings.direction_setup_us / 1e6) * CYCLES_PER_S)}

    # ---- what

    def some_axes(self) -> list[int]:
        if self.random.random() < 0.6:
            return [int(self.random.integers(self.axes))]
        return [axis for axis in range(self.axes) if self.random.random() < 0.7] or [0]

    def steps(self, axis: int) -> int:
        """Return steps that take no longer than a ramp up and down and a while."""
        ramp = self.ramps[axis]
        most = ramp.slopes.up.size + ramp.slopes.down.size + 0.1 / ramp.slew_s
        count = max(round(math.exp(self.random.uniform(0, math.log(most + 2)))), 1)
        return count if self.random.random() < 0.65 else -count

    def interval(self, axis: int) -> int:
        ramp, choice = self.ramps[axis], self.random.random()
        slew, slowest = ramp.slopes.slew, max(ramp.longest_s * ramp.hz, ramp.slopes.slew)
        if choice < 0.1:
            return 0
        found = slew if choice < 0.3 else round(slew * math.exp(self.random.uniform(0, math.log(1.5 * slowest / slew))))
        if choice > 0.9:
            found = max(int(self.random.choice([29_999, 30_000, 30_001, 32_768, 46_384, 65_536])), slew)
        self.longest_run_s = max(self.longest_run_s, found / ramp.hz)
        return found if self.random.random() < 0.65 else -found

    def order(self) -> None:
        """Ask for something that changes what motors do."""
        choice, axes, when = self.random.random(), self.some_axes(), self.soon()
        if choice < 0.32:
            steps = {axis: self.steps(axis) for axis in axes}
            self.ask(MOVE_BY, for_axes(steps), **when)
            if self.random.random() < 0.25:
                axis = axes[0]
                near_end = max(abs(steps[axis]) - int(self.random.integers(0, 12)), 1)
                self.ask(MOVE_BY, for_axes({axis: self.steps(axis)}), **self.after_steps(axis, near_end))
        elif choice < 0.47:
            self.ask(MOVE_TO, for_axes({axis: self.steps(axis) for axis in axes}), **when)
        elif choice < 0.77:
            self.ask(RUN, for_axes({axis: self.interval(axis) for axis in axes}), **when)
        elif choice < 0.9:
            self.ask(STOP, b"" if self.random.random() < 0.3 else bytes([sum(1 << axis for axis in axes)]), **when)
            if self.random.random() < 0.6:
                self.ask(STATUS, bytes([axes[0]]))
        elif choice < 0.965:
            self.ask(HALT, b"" if self.random.random() < 0.3 else bytes([sum(1 << axis for axis in axes)]), **when)
        else:
            self.rest()

    def rest(self) -> None:
        """Stop, and see whether the motors come to rest where they are said to; then move once, or along a line."""
        slow = self.rest_s > 0.3
        self.ask(HALT if slow else STOP, **self.soon())
        self.see_all({})
        if slow:
            return
        self.see_all(self.quiet())
        steps = {axis: self.steps(axis) for axis in range(self.axes)}
        if self.axes > 1 and self.random.random() < 0.6:
            ramp_axis = int(self.random.integers(self.axes))
            self.ask(LINE, bytes([(1 << self.axes) - 1, ramp_axis]) + values_of(steps))
            if self.random.random() < 0.5:
                self.ask(STOP if self.random.random() < 0.7 else HALT, **self.soon())
        else:
            self.ask(MOVE_BY, for_axes(steps))
        self.see_all(self.quiet())

    def see_all(self, when: dict[str, int]) -> None:
        """Ask for the status of each axis, of the first one at this moment."""
        for axis in range(self.axes):
            self.ask(STATUS, bytes([axis]), **({} if axis else when))

    def end(self) -> None:
        slow = self.rest_s > 0.5
        self.ask(HALT if slow else STOP)
        self.see_all({"wait_cycles": 200_000} if slow else self.quiet())

    def write(self) -> None:
        if self.random.random() < 0.25:
            self.ask(REPORT, bytes([int(self.random.integers(5, 51))]))
        if self.random.random() < 0.25:
            self.ask(TRACE, struct.pack("<BH", self.random.integers(self.axes), self.random.choice([1, 10, 100])))
        while self.made < REQUESTS:
            self.order()
            if self.random.random() < 0.25:
                self.ask(STATUS, bytes([int(self.random.integers(self.axes))]), **self.soon())
        self.end()


# ---- all of it


def random_settings(random: np.random.Generator) -> Settings:
    width = int(random.choice([0, 0, 0, 3, random.integers(1, 101), 100]))
    return Settings(
        both_edges=int(random.integers(16)) if random.random() < 0.2 else 0,
        step_inverted=int(random.integers(16)) if random.random() < 0.2 else 0,
        direction_inverted=int(random.integers(16)) if random.random() < 0.2 else 0,
        pulse_width_us=width,
        direction_setup_us=int(random.choice([20, 30, 30, random.integers(20, 500), 3000])),
        enable_lead_ms=int(random.choice([0, 1, 1, 3])),
        enable_hold_ms=int(random.choice([HOLD_FOR_EVER, HOLD_FOR_EVER, 0, 5])),
    )


def random_ramps(random: np.random.Generator, kind: str, axes: int, settings: Settings, hz: int) -> list[Planned]:
    """Return a ramp for each axis; equal ones are the same."""
    width = settings.pulse_width_us * CYCLES_PER_US * 2
    formulas = random.random(axes) < random.choice([0, 0, 0.5, 1])
    parts = shares(random, axes)
    most = int(random.choice([4, 12, 40]))
    while True:
        ramps = list[Planned]()
        for formula, part in zip(formulas, parts, strict=True):
            need = FORMULA_LIMIT + width if formula else LIMITS[axes - 1] / axes + width
            slew = slew_interval(kind, part, need, random, hz)
            alone = FORMULA_LIMIT if formula else LIMITS[0]
            slew = max(slew, math.ceil(alone * hz / FAST_HZ))
            ramps.append(by_formula(random, slew, hz) if formula else of_segments(random, slew, axes, most, hz))
        if random.random() < 0.4 and not formulas.any() and np.ptp(parts) == 0:
            ramps = [ramps[0]] * axes
        if len(image_of_ramps(ramps)) <= LARGEST_IMAGE:
            return ramps
        most = max(most * 2 // 3, 1)


def image_of_ramps(ramps: Sequence[Planned]) -> bytes:
    different = list(dict.fromkeys(ramp.packed for ramp in ramps))
    numbers = [different.index(ramp.packed) for ramp in ramps]
    return image_of(different, numbers, fast=ramps[0].hz == FAST_HZ)


def session_of(seed: int) -> Session:
    random = np.random.default_rng(seed)
    kind = str(random.choice(["limit", "beyond", "fair", "slow", "crawling"], p=[0.4, 0.12, 0.23, 0.2, 0.05]))
    axes = int(random.choice([1, 2, 3, 4]))
    hz = FAST_HZ if random.random() < 0.65 else SLOW_HZ
    settings = random_settings(random)
    ramps = random_ramps(random, kind, axes, settings, hz)
    author = Author(random, ramps, settings, hz)
    author.deliver(image_of_ramps(ramps))
    author.write()
    formulas = sum(ramp.slopes.places for ramp in ramps)
    clock = "fast" if hz == FAST_HZ else "slow"
    speeds = ", ".join(f"{hz / ramp.slopes.slew:.6g}" for ramp in ramps)
    title = f"{kind}, {axes} axes ({formulas} by formula), {clock} clock, {speeds} steps/s, {settings}"
    setting = Setting([ramp.slopes for ramp in ramps], CYCLES_PER_S // hz, settings)
    return Session(seed, title, setting, author.asked)
