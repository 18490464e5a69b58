"""Pushing a design: what is sent to a controller, what the controller can't take, and what came of it.

The intervals are compressed with the smallest bound for which the image fits the controller. A ramp whose intervals
would have to change by more than a hundredth of the slew interval is refused.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.controller import PushItem, PushReport
from stepramp.controllers.frames import crc16
from stepramp.controllers.messages import HelloReply
from stepramp.controllers.ramp_image import MOST_SEGMENTS, BadRampImage, RampImage
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.move import Ramp
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import compress, expand
from stepramp.ramp.timer import rescaled
from stepramp.units import MICROSECONDS_PER_SECOND, speed_from_interval, us_from_ticks

COARSEST_BOUND = 0.01
"""Largest bound of the compression, as a part of the slew interval."""


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for a design, and what it comes from."""

    ramp: Ramp
    """The design's ramp, in ticks of its own timer."""
    ramp_hz: float
    image: RampImage
    controller_hz: int
    bound_ticks: int
    """How far the compression may have moved an interval [ticks of the controller]."""

    def report(self, stored: bytes, sequence: int) -> PushReport:
        """Return what came of the push, from the image that was read back and the ramp's sequence number."""
        encoded = self.image.encode()
        return PushReport(
            items=tuple(self._items(stored)),
            verified=stored == encoded,
            segments=self.image.sent_segments,
            bytes=len(encoded),
            largest_deviation_us=self._largest_deviation_us(),
            sequence=sequence,
            warnings=tuple(self._warnings(verified=stored == encoded)),
        )

    def _items(self, stored: bytes) -> Iterator[PushItem]:
        requested = _figures(self.ramp, self.ramp_hz)
        sent = _figures(unpacked(self.image), self.controller_hz)
        try:
            read_back = _figures(unpacked(RampImage.decode(stored)), self.controller_hz)
        except BadRampImage:
            read_back = {}
        for (name, unit), figure in requested.items():
            yield PushItem(name, unit, figure, sent[name, unit], read_back.get((name, unit), "unreadable"))
        crc = f"0x{crc16(self.image.encode()):04X}"
        yield PushItem("Ramp image CRC", "", crc, crc, f"0x{crc16(stored):04X}")

    def _largest_deviation_us(self) -> float:
        """Return the largest difference between an interval of the design's ramp and of the one sent [µs]."""
        sent = unpacked(self.image)
        wanted_us = _all_intervals(self.ramp) * us_from_ticks(1, self.ramp_hz)
        sent_us = _all_intervals(sent) * us_from_ticks(1, self.controller_hz)
        # To a millionth of a µs: what lies below is the arithmetic's own.
        return round(float(np.abs(wanted_us - sent_us).max()), 6)

    def _warnings(self, *, verified: bool) -> Iterator[str]:
        deviation_us = self._largest_deviation_us()
        if not verified:
            yield "What the controller stored is not what was sent: push again before moving."
        if self.bound_ticks:
            yield (
                f"To fit the controller's memory, intervals were changed by up to {self.bound_ticks:,} ticks: "
                f"at most {deviation_us:,.3g} µs from the design."
            )
        elif deviation_us:
            yield (
                f"The controller's timer runs at {self.controller_hz:,} Hz, the design's at {self.ramp_hz:,.10g} Hz: "
                f"intervals differ by up to {deviation_us:,.3g} µs."
            )


def plan_push(design: Design, limits: HelloReply) -> PushPlan:
    """Return what to send to a controller with these limits for a design.

    Raises Rejected when an interval lies outside them, or the ramp takes more segments than they allow.
    """
    ramp = ramp_of(design)
    ramp_hz, controller_hz = design.timer.frequency_hz, limits.timer_frequency_hz
    target = rescaled(ramp, ramp_hz, controller_hz)
    _check_intervals(design, target, limits)
    image, bound_ticks = _smallest_change(design, target, limits)
    return PushPlan(ramp, ramp_hz, image, controller_hz, bound_ticks)


def unpacked(image: RampImage) -> Ramp:
    """Return the ramp that an image stands for, in ticks of the controller."""
    up = expand(image.up)
    return Ramp(up, image.slew_interval_ticks, up if image.down == image.up else expand(image.down))


def _check_intervals(design: Design, ramp: Ramp, limits: HelloReply) -> None:
    """Reject a ramp that is too fast or too slow for the controller; what to change depends on the method."""
    hz, intervals = limits.timer_frequency_hz, _all_intervals(ramp)
    shortest, longest = limits.shortest_interval_ticks, limits.longest_interval_ticks
    if shortest <= intervals.min() and intervals.max() <= longest:
        return
    if design.method.name == "table":
        raise Rejected(list(_bad_rows(design, limits)))
    if intervals.min() < shortest or ramp.slew > longest:
        slowest, fastest = speed_from_interval(longest, hz), speed_from_interval(shortest, hz)
        allowed = f"from {slowest:,.6g} to {fastest:,.10g} steps/s with this controller"
        raise Rejected([Rejection("ramp.slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s, allowed)])
    allowed = f"more, so that each step takes at most {us_from_ticks(longest, hz):,.10g} µs: this controller's longest"
    raise Rejected([Rejection("ramp.acceleration_steps_per_s2", design.ramp.acceleration_steps_per_s2, allowed)])


def _bad_rows(design: Design, limits: HelloReply) -> Iterator[Rejection]:
    """Yield the delays of a design's table that lie outside a controller's limits."""
    rows, unit = (design.table.rows, design.table.interval_unit) if design.table else ([], "us")
    timer_hz = design.timer.frequency_hz if unit == "ticks" else MICROSECONDS_PER_SECOND
    shortest = limits.shortest_interval_ticks / limits.timer_frequency_hz * timer_hz
    longest = limits.longest_interval_ticks / limits.timer_frequency_hz * timer_hz
    words = "µs" if unit == "us" else "ticks"
    for number, (_, delay) in enumerate(rows):
        if not shortest <= delay <= longest:
            allowed = f"a delay from {shortest:,.10g} to {longest:,.10g} {words} with this controller"
            yield Rejection(f"table.rows.{number}.1", delay, allowed)


def _smallest_change(design: Design, ramp: Ramp, limits: HelloReply) -> tuple[RampImage, int]:
    """Return the image that changes intervals least, of those that fit the controller, and its bound [ticks]."""
    symmetric = np.array_equal(ramp.up, ramp.down)
    bound = needed = 0
    for bound in _bounds(max(1, int(ramp.slew * COARSEST_BOUND))):
        up = tuple(compress(ramp.up.astype(np.int64), bound))
        down = up if symmetric else tuple(compress(ramp.down.astype(np.int64), bound))
        image = RampImage(up, int(ramp.slew), down)
        if _fits(image, limits):
            return image, bound
        needed = image.sent_segments
    at_most = min(limits.most_segments, MOST_SEGMENTS)
    allowed = (
        f"a ramp of at most {at_most} segments and {limits.largest_image_bytes} bytes with this controller; this one "
        f"takes {needed:,} segments, even with intervals changed by {bound:,} ticks: make it shorter or more even"
    )
    if design.method.name == "table":
        raise Rejected([Rejection("table.rows", f"{len(design.table.rows) if design.table else 0} rows", allowed)])
    raise Rejected([Rejection("ramp.acceleration_steps_per_s2", design.ramp.acceleration_steps_per_s2, allowed)])


def _fits(image: RampImage, limits: HelloReply) -> bool:
    """Tell whether a controller takes an image. Compression may move an interval past a limit that the design keeps."""
    return (
        image.sent_segments <= min(limits.most_segments, MOST_SEGMENTS)
        and image.keeps(limits.intervals_ticks)
        and len(image.encode()) <= limits.largest_image_bytes
    )


def _bounds(coarsest: int) -> Iterator[int]:
    """Yield 0, 1, 2, 3, 4, 6, 8, 12, 16, 24 … up to the coarsest [ticks]."""
    yield 0
    bound = 1
    while bound <= coarsest:
        yield bound
        if bound > 1 and bound * 3 // 2 <= coarsest:
            yield bound * 3 // 2
        bound *= 2


def _all_intervals(ramp: Ramp) -> NDArray[np.float64]:
    return np.concatenate((ramp.up, [ramp.slew], ramp.down)).astype(np.float64)


def _figures(ramp: Ramp, hz: float) -> dict[tuple[str, str], str]:
    """Return the figures of a ramp that people compare: (name, unit) → figure."""
    figures = {("Up ramp steps", "steps"): f"{ramp.up.size:,}"}
    if ramp.up.size:
        figures["First interval", "µs"] = _microseconds(ramp.up[0], hz)
    figures["Slew interval", "µs"] = _microseconds(ramp.slew, hz)
    figures["Down ramp steps", "steps"] = f"{ramp.down.size:,}"
    if ramp.down.size:
        figures["Last interval", "µs"] = _microseconds(ramp.down[0], hz)
    return figures


def _microseconds(ticks: float, hz: float) -> str:
    """Return ticks as µs for people, to a ten-thousandth: finer than a tick of any controller here."""
    whole, _, part = f"{us_from_ticks(float(ticks), hz):,.4f}".partition(".")
    return f"{whole}.{part.rstrip('0') or '0'}"
