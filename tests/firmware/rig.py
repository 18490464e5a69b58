"""A simulated controller put to work over its serial port, and ramps for it made from the formulas for motion."""

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from firmware.checker import CYCLES_PER_S, AxisEdges, Cycles, Edges, Limits, axis_of
from firmware.protocol import (
    FAST_HZ,
    IN_MOTION,
    LINE,
    MOVE_BY,
    PATIENCE_S,
    REPORT_NOTICE,
    STATUS,
    Client,
    Ramp,
    Segment,
    Settings,
    Status,
    decode_frame,
    for_axes,
    image_of,
    values_of,
)
from simulator.avr import SimulatedController, build_firmware

Make = Callable[..., SimulatedController]
DEFAULT = Settings()
AXES = 4
MOST_STEPS_A_SEGMENT = 200
COMPRESSION = 0.02
"""By which share an interval of a segment may differ from the designed one."""
REQUESTS_AHEAD = 40
"""As many as the line carries in 35 ms."""
SILENCE_S = 0.1
"""Then nothing is on its way any more."""


# ---- ramps


def slope(speed: float, acceleration: float, hz: int) -> list[Segment]:
    """Return segments from rest to a speed, each as long as it comes near the delays of an even acceleration."""
    steps = np.arange(max(int(speed**2 / (2 * acceleration)), 1))
    delays = hz * (np.sqrt(2 * (steps + 1) / acceleration) - np.sqrt(2 * steps / acceleration))
    done, segments, slowest = 0, list[Segment](), 2**28
    while done < steps.size:
        part = delays[done : done + MOST_STEPS_A_SEGMENT]
        segment = max(candidates(part, slowest, -int(-hz // speed)), key=lambda s: s[1])
        segments.append(segment)
        done, slowest = done + segment[1], segment[0] + (segment[1] - 1) * segment[2]
    return segments


def candidates(delays: npt.NDArray[np.float64], slowest: int, fastest: int) -> Iterator[Segment]:
    """Yield segments that begin with these delays, not slower than the one before them nor faster than slew speed."""
    change = delays[1] - delays[0] if delays.size > 1 else 0.0
    for add in {math.floor(change), math.ceil(change), round((delays[-1] - delays[0]) / delays.size), 0}:
        for share in (-COMPRESSION, 0, COMPRESSION):
            first = max(min(round(delays[0] * (1 + 0.9 * share)), slowest), fastest)
            intervals = first + add * np.arange(delays.size)
            near = (np.abs(intervals - delays) <= COMPRESSION * delays + 0.5) & (intervals >= fastest)
            near[1:] &= abs(add) < 2**15
            count = max(int((~near).argmax()) if not near.all() else near.size, 1)
            yield first, count, add if count > 1 else 0


@dataclass(frozen=True)
class RampDesign:
    """What an axis is designed for."""

    speed: float
    """[steps/s]"""
    acceleration: float
    """[steps/s²]"""
    deceleration: float
    hz: int = FAST_HZ

    @property
    def ramp(self) -> Ramp:
        slopes = (slope(self.speed, change, self.hz) for change in (self.acceleration, self.deceleration))
        up, down = slopes
        return Ramp(up, self.slew, down)

    @property
    def slew(self) -> int:
        """Return the slew interval [ticks]: rounded up, so that the speed isn't higher."""
        return -int(-self.hz // self.speed)

    @property
    def cycles_per_tick(self) -> int:
        return CYCLES_PER_S // self.hz

    def limits(self, steps: int, **changes: Any) -> Limits:
        """Return what a move must keep to. Segments come only so near to a designed slope."""
        first_us = (2 / self.acceleration) ** 0.5 * 1e6
        limits = Limits(steps, first_us, self.speed, self.acceleration, self.deceleration, compression=COMPRESSION)
        return replace(limits, tick_us=1e6 / self.hz, **changes)


def image(plans: Sequence[RampDesign]) -> bytes:
    """Return the image of as many axes as plans; equal ones share a ramp."""
    ramps = list(dict.fromkeys(plans))
    numbers = [ramps.index(plan) for plan in plans]
    return image_of([plan.ramp.packed() for plan in ramps], numbers, fast=plans[0].hz == FAST_HZ)


# ---- work


class BusyClient(Client):
    """A client that can also ask and ask without waiting for the answers, so that the line is busy both ways.

    Requests that come while a reply is being sent, or faster than the controller finds time for, are dropped.
    """

    def __init__(self, port: str) -> None:
        super().__init__(port)
        self.statuses: list[Status] = []
        self._rest = b""
        self._answered_s = 0.0
        self._answered = self._last_tag = 0

    def keep_busy(self, *, until_s: float = 0.0, most_s: float = 30.0) -> list[Status]:
        """Ask until the motors rest, and for so long at least; return the answers since the last time."""
        began = time.monotonic()
        self._answered = self._tag
        while not self._is_enough(time.monotonic() - began, until_s):
            assert time.monotonic() - began < most_s, "still moving"
            self.ask_ahead()
            self.take(SILENCE_S)
        self.synchronize()
        statuses, self.statuses = self.statuses, []
        return statuses

    def _is_enough(self, passed_s: float, until_s: float) -> bool:
        return passed_s >= until_s and bool(self.statuses) and self.statuses[-1].state != IN_MOTION

    def ask_ahead(self) -> None:
        """Keep so many requests on their way that the line doesn't fall silent."""
        while (self._tag - self._answered) & 0xFF < REQUESTS_AHEAD:
            for _ in range(REQUESTS_AHEAD // 2):
                self._tag = (self._tag + 1) & 0xFF
                self.send(STATUS, bytes([self._tag % AXES]))

    def take(self, within_s: float) -> None:
        """Take what has come, or wait for something.

        Without an answer for so long nothing is on its way any more, whatever the controller reports by itself: what
        was asked has been dropped.
        """
        self._port.timeout = within_s
        data = self._port.read(max(self._port.in_waiting, 1))
        if not data or time.monotonic() - self._answered_s > within_s:
            self._answered = self._tag
            self._answered_s = time.monotonic()
        *frames, self._rest = (self._rest + data).split(b"\0")
        for frame in frames:
            message = decode_frame(frame + b"\0")
            if message[0] >= REPORT_NOTICE:
                self.notices.append(message)
            elif message[0] == STATUS | 0x80:
                self._answered = self._last_tag = message[3]
                self._answered_s = time.monotonic()
                self.statuses.append(Status.unpack(message[5:]))

    def read_frame(self) -> bytes:
        """Return the next frame, with the beginning of it that `take` may have been left with."""
        rest, self._rest = self._rest, b""
        return rest + super().read_frame()

    def forget(self) -> None:
        """Drop what has been answered."""
        while self._port.in_waiting:
            self._port.reset_input_buffer()
            time.sleep(0.05)
        self._rest = b""

    def synchronize(self) -> None:
        """Wait until all that is on its way has been answered or dropped."""
        for _ in range(20):
            self._tag = (self._tag + 1) & 0xFF
            asked, self._answered = self._tag, self._tag - 1
            self.send(STATUS, b"\0")
            self._answered_s = time.monotonic()
            while self._answered != self._tag:
                self.take(SILENCE_S)
            if self._last_tag == asked:
                self._port.timeout = PATIENCE_S
                return
        raise AssertionError("no answer after a flood")


@dataclass(frozen=True)
class Played:
    """What a controller did. `statuses` are those at the end, of each axis."""

    edges: Edges
    statuses: Sequence[Status]
    statistics: Mapping[str, Any]
    notices: Sequence[bytes] = ()
    on_the_way: Sequence[Status] = ()

    def axis(self, axis: int = 0, settings: Settings = DEFAULT) -> AxisEdges:
        return axis_of(
            self.edges,
            axis,
            step_inverted=bool(settings.step_inverted >> axis & 1),
            direction_inverted=bool(settings.direction_inverted >> axis & 1),
            both_edges=bool(settings.both_edges >> axis & 1),
        )

    def steps(self, axis: int = 0) -> Cycles:
        return self.axis(axis).steps

    def assert_nothing_lost(self) -> None:
        """Each axis is where its pins have led it, no queue ran dry and no byte was lost."""
        for axis, status in enumerate(self.statuses):
            assert status.position == self.axis(axis).travel
        assert {status.starved for status in self.statuses} == {0}
        assert self.statistics["lost_bytes"] == 0
        assert self.statistics["resets"] <= 1


Work = Callable[[BusyClient], object]


def play(make: Make, ramps: bytes, *work: Work, settings: Settings | None = None, **options: Any) -> Played:
    """Let a controller with these ramps do some work, one after the other, while the line is kept busy.

    In real time: run as fast as it can, it would be farther than was waited for by when it hears of it.
    """
    axes = ramps[2]
    with make(**options) as simulated, BusyClient(simulated.port) as client:
        client.hello()
        if settings is not None:
            client.write_settings(settings)
        client.try_out(ramps)
        on_the_way: list[Status] = []
        for one in work:
            one(client)
            on_the_way += client.keep_busy()
        statuses = [client.status(axis) for axis in range(axes)]
    return Played(simulated.edges(), statuses, simulated.statistics, client.notices, on_the_way)


def request(kind: int, body: bytes = b"") -> Work:
    """Return work: a request that must be granted."""
    return lambda client: client.expect_ok(kind, body)


def move_by(*steps: int) -> Work:
    """Return work: move the first axes by so many steps."""
    return request(MOVE_BY, for_axes(dict(enumerate(steps))))


def along_a_line(*steps: int, ramp_axis: int = 0) -> Work:
    return request(LINE, bytes([(1 << len(steps)) - 1, ramp_axis]) + values_of(dict(enumerate(steps))))


def until_made(client: Client, steps: int, axis: int = 0) -> Status:
    """Wait until an axis has made so many steps."""
    while (status := client.status(axis)).steps_made < steps:
        assert status.axis_state, "at rest before it had made so many steps"
    return status


def controller_in(folder: Path, *, build: Sequence[str] = (), **options: Any) -> SimulatedController:
    """Make a simulated controller that has its files in a folder of its own. build: options of its Makefile."""
    folder.mkdir(exist_ok=True)
    return SimulatedController(build_firmware(*build), folder, **options)


def at_the_same_time(*jobs: Callable[[], Played]) -> list[Played]:
    """Run simulators side by side."""
    with ThreadPoolExecutor(2) as pool:
        return [job.result() for job in [pool.submit(job) for job in jobs]]
