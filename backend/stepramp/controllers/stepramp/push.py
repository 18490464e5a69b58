"""Pushing designs: what is sent to a controller, what the controller can't take, and what came of it.

The intervals are compressed with the smallest bounds for which the image fits the controller, and its processor keeps
pace. A ramp whose intervals would have to change by more than a hundredth of the slew interval, or by more than 1 µs
where that is longer, is refused.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.contract import FigureUnit, PreviewItem, PushItem, PushPreview, PushReport
from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.keeping_pace import Preparation
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.playback import formula_ramp, playback_of, unpacked
from stepramp.controllers.stepramp.push_limits import PushLimits
from stepramp.controllers.stepramp.ramp_image import AxisRamp, BadRampImage, RampImage, SegmentRamp
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.stepramp.speed_limits import Pace
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.playback.trajectory import Playback
from stepramp.ramp.segments import compress_sides
from stepramp.ramp.slopes import peak_of
from stepramp.units import ticks_from_us, us_from_ticks

COARSEST_BOUND = 0.01
"""Largest bound of the compression, as a part of the slew interval …"""
COARSEST_BOUND_US, COARSEST_SHORT_BOUND = 1.0, 0.05
"""… or, where that is larger, in time [µs], which is as late as steps may come anyway, but at most this part."""


@dataclass(frozen=True)
class PushedDesign:
    """A design that is pushed to an axis."""

    axis: int
    design: Design
    path: str
    """What a rejection puts before the design's fields."""
    ramp: Ramp
    """The design's ramp, in ticks of its timer, which are those of the controller."""


class TooLong(Rejected):
    """Ramps that the controller has no room for, however coarse: each by itself, or all of them together."""

    def __init__(self, pushed: Sequence[PushedDesign], rejections: Sequence[Rejection], *, together: bool) -> None:
        super().__init__(rejections)
        self.pushed = tuple(pushed)
        """What the rejections are about, in their order."""
        self.together = together


class SmallestChange:
    """A ramp as it may be sent: by formula, or as segments with a bound that can be made coarser step by step."""

    def __init__(
        self, pushed: PushedDesign, limits: PushLimits, preparation: Preparation, *, coarsest_only: bool = False
    ) -> None:
        self.pushed = pushed
        self._limits = limits
        self._preparation = preparation
        bounds = list(_bounds(_coarsest_bound(pushed.ramp.slew, limits.timer_hz)))
        self._coarsest = bounds[-1]
        self._bounds = iter(bounds[-1:] if coarsest_only else bounds)
        self.bound_ticks = next(self._bounds)
        self.ramp: AxisRamp = formula_ramp(pushed.design, limits.by_formula) or self._compressed()

    @property
    def fits(self) -> bool:
        """Whether the controller takes it. Compression may move an interval past a limit that the design keeps."""
        if not isinstance(self.ramp, SegmentRamp):
            return True
        return not self._is_too_long and self.ramp.keeps(self._limits.of_segments)

    @property
    def _is_too_long(self) -> bool:
        return self.ramp.sent_segments > self._limits.most_segments

    def make_coarser(self) -> bool:
        """Compress with the next bound; return whether there is one."""
        bound = None if not isinstance(self.ramp, SegmentRamp) else next(self._bounds, None)
        if bound is None:
            return False
        self.bound_ticks = bound
        self.ramp = self._compressed()
        return True

    def ease(self) -> None:
        """Compress coarser until the controller can keep pace, as long as it takes the ramp."""
        while self._is_too_long or not self._preparation.keeps_pace_with(self.ramp):
            before, fitted = (self.bound_ticks, self.ramp), self.fits
            if not self.make_coarser():
                return
            if fitted and not self.fits:
                self.bound_ticks, self.ramp = before
                return

    def _compressed(self) -> SegmentRamp:
        # What is too long isn't compressed to its end; a rejection tells how long it is with the coarsest bound.
        most = None if self.bound_ticks == self._coarsest else self._limits.most_segments + 1
        up, down = compress_sides(self.pushed.ramp, self.bound_ticks, most)
        return SegmentRamp(tuple(up), self.pushed.ramp.slew, tuple(down))


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for some designs, and what it comes from."""

    pushed: tuple[PushedDesign, ...]
    image: RampImage
    timer_hz: int
    bounds_ticks: tuple[int, ...]
    """How far the compression may have moved an interval of each design [ticks]."""
    limits: PushLimits
    out_of_pace: tuple[int, ...]
    """Axes whose segments the controller may not prepare in time, when all axes move together."""

    @property
    def keeps_pace(self) -> bool:
        """Whether the controller can prepare all segments in time."""
        return not self.out_of_pace

    def report(self, stored: bytes, sequence: int, *, kept: bool) -> PushReport:
        """Return what came of the push, from the image that was read back and the sequence number of what is stored."""
        encoded = self.image.encode()
        return PushReport(
            items=tuple(self._items(stored)),
            verified=stored == encoded,
            segments=self.image.sent_segments,
            bytes=len(encoded),
            largest_deviation_us=max(map(self._deviation_us, self.pushed)),
            sequence=sequence,
            kept=kept,
            warnings=tuple(self._warnings(verified=stored == encoded)),
        )

    def preview(self, present: RampImage | None, present_hz: int) -> PushPreview:
        """Return what the push would change of the ramps that the controller has, played with a clock [Hz]."""
        return PushPreview(
            items=tuple(self._differences(present, present_hz)),
            same=present is not None and present.encode() == self.image.encode(),
            segments=self.image.sent_segments,
            bytes=len(self.image.encode()),
            largest_deviation_us=max(map(self._deviation_us, self.pushed)),
            warnings=tuple(self._warnings(verified=True)),
        )

    def _differences(self, present: RampImage | None, present_hz: int) -> Iterator[PreviewItem]:
        before = present.axes if present else ()
        yield PreviewItem("Axes with a ramp", "", len(before), len(self.image.axes), None)
        yield PreviewItem("Clock", "Hz", present_hz if present else None, self.timer_hz, None)
        pushed_axes = {each.axis for each in self.pushed}
        for axis in range(max(len(before), len(self.image.axes))):
            if axis < len(self.image.axes) and axis not in pushed_axes:
                continue
            there = _figures(unpacked(before[axis]), present_hz) if axis < len(before) else {}
            here = _figures(unpacked(self.image.axes[axis]), self.timer_hz) if axis < len(self.image.axes) else {}
            for name, unit in {**here, **there}:
                yield PreviewItem(name, unit, there.get((name, unit)), here.get((name, unit)), axis)
        crc = crc16(present.encode()) if present else None
        yield PreviewItem("Ramp image", "CRC-16", crc, crc16(self.image.encode()), None)

    def _items(self, stored: bytes) -> Iterator[PushItem]:
        try:
            read_back = RampImage.decode(stored).axes
        except BadRampImage:
            read_back = ()
        for each in self.pushed:
            there = _figures(unpacked(read_back[each.axis]), self.timer_hz) if each.axis < len(read_back) else {}
            sent = _figures(unpacked(self.image.axes[each.axis]), self.timer_hz)
            for (name, unit), figure in _figures(each.ramp, self.timer_hz).items():
                called = name if len(self.pushed) == 1 else f"Axis {each.axis}: {name[0].lower()}{name[1:]}"
                yield PushItem(called, unit, figure, sent[name, unit], there.get((name, unit)), each.axis)
        crc = crc16(self.image.encode())
        yield PushItem("Ramp image", "CRC-16", crc, crc, crc16(stored), None)

    def _deviation_us(self, each: PushedDesign) -> float:
        """Return the largest difference between an interval of a design's ramp and of the one sent [µs]."""
        sent = _all_intervals(unpacked(self.image.axes[each.axis]))
        return us_from_ticks(float(np.abs(_all_intervals(each.ramp) - sent).max()), self.timer_hz)

    def _warnings(self, *, verified: bool) -> Iterator[str]:
        if not verified:
            yield "What the controller has is not what was sent: push again before moving."
        for each, bound in zip(self.pushed, self.bounds_ticks, strict=True):
            if bound:
                which = "" if len(self.pushed) == 1 else f" of axis {each.axis}"
                yield (
                    f"To fit the controller's memory, intervals{which} were changed by up to {_ticks(bound)}: "
                    f"at most {self._deviation_us(each):,.3g} µs from the design."
                )
        if not self.keeps_pace:
            them = "its motor" if len(self.image.axes) == 1 else f"all {len(self.image.axes)} motors moving together"
            yield (
                f"The ramps have more segments in so short a time than the controller can prepare: {them} may have to "
                f"wait between steps. A lower acceleration takes fewer."
            )
            if not {each.axis for each in self.pushed} >= set(self.out_of_pace):
                yield "The ramps that stay were made for fewer axes: push the designs of all axes together."
        too_fast = self.limits.too_fast_together([playback_of(ramp) for ramp in self.image.axes])
        if len(self.image.axes) > 1 and too_fast is not None:
            yield too_fast


def plan_push(
    designs: Sequence[Design],
    hello: HelloReply,
    settings: StepRampSettings,
    first_axis: int | None = None,
    present: RampImage | None = None,
    *,
    coarsest_only: bool = False,
) -> PushPlan:
    """Return what to send for designs to a controller that introduced itself like this.

    first_axis, present: the only design is that of this axis; the others keep their present ramps. Without a first axis
    the designs are those of all axes, and rejections name their fields from `axes` on.

    coarsest_only: whether they fit at all is seen soonest with the coarsest bounds.

    Raises Rejected when a design's timer isn't a clock of the controller, an interval lies outside the limits, or the
    ramps take more memory than there is.
    """
    others = present if first_axis is not None else None
    _check_axes(len(designs), hello, first_axis, others)
    timer_hz = _clock_hz(designs, hello, first_axis, others)
    limits = PushLimits.of(hello, settings, timer_hz)
    pushed = tuple(
        PushedDesign(
            number if first_axis is None else first_axis, design, _path(number, first_axis), _ramp(design, path)
        )
        for number, design in enumerate(designs)
        for path in [_path(number, first_axis)]
    )
    for each in pushed:
        limits.check(each.design, each.ramp, each.path)
    preparation = Preparation.of(limits.speeds, _paces(pushed, others))
    changes = {
        _key(each.design): SmallestChange(each, limits, preparation, coarsest_only=coarsest_only)
        for each in reversed(pushed)
    }
    for change in changes.values():
        change.ease()
    chosen = [changes[_key(each.design)] for each in pushed]
    image = _fitting(pushed, chosen, others, limits)
    bounds_ticks = tuple(change.bound_ticks for change in chosen)
    out_of_pace = tuple(axis for axis, ramp in enumerate(image.axes) if not preparation.keeps_pace_with(ramp))
    return PushPlan(pushed, image, timer_hz, bounds_ticks, limits, out_of_pace)


def _paces(pushed: Sequence[PushedDesign], present: RampImage | None) -> list[Pace]:
    """Return how fast all axes are that there will be; what is pushed may yet be computed by the controller."""
    kept = dict(enumerate(present.axes if present else ()))
    paces = {axis: _pace(playback_of(ramp)) for axis, ramp in kept.items()}
    paces |= {each.axis: Pace(int(each.ramp.slew)) for each in pushed}
    return list(paces.values())


def _pace(playback: Playback) -> Pace:
    return Pace(playback.slew_interval, playback.by_formula)


def _path(number: int, first_axis: int | None) -> str:
    return f"axes.{number}." if first_axis is None else ""


def _ramp(design: Design, path: str) -> Ramp:
    try:
        return ramp_of(design)
    except Rejected as error:
        raise Rejected([each.within(path) for each in error.rejections]) from error


def _key(design: Design) -> str:
    """Return what makes two designs' ramps the same: of the move only the peak that it lowers the ramp to."""
    return f"{peak_of(design)} {design.model_dump_json(exclude={'schema_', 'name', 'move'})}"


def _check_axes(count: int, hello: HelloReply, first_axis: int | None, present: RampImage | None) -> None:
    if not 1 <= count <= hello.axes:
        allowed = f"a list of 1 to {hello.axes} designs with this controller"
        raise Rejected([Rejection("axes", Count(f"{count} designs"), allowed)])
    most = min(hello.axes - 1, len(present.axes) if present else 0)
    if first_axis is not None and not 0 <= first_axis <= most:
        known = "has no ramps yet" if not present else f"has ramps for axes 0 to {len(present.axes) - 1}"
        allowed = f"an axis from 0 to {most}, since the controller {known}; or push the designs of all axes together"
        raise Rejected([Rejection("to_axis", first_axis, allowed)])


def _clock_hz(designs: Sequence[Design], hello: HelloReply, first_axis: int | None, present: RampImage | None) -> int:
    """Return the clock of the controller that all designs are made for [Hz]."""
    clocks = (hello.fast_clock_hz, hello.slow_clock_hz)
    both = f"{clocks[0]:,} or {clocks[1]:,} Hz"
    bad = [
        Rejection(f"{_path(number, first_axis)}timer.frequency_hz", design.timer.frequency_hz, allowed)
        for number, design in enumerate(designs)
        for allowed in [f"{both}: the clocks of this controller"]
        if design.timer.frequency_hz not in clocks
    ]
    if bad:
        raise Rejected(bad)
    clocks_hz = {number: int(design.timer.frequency_hz) for number, design in enumerate(designs)}
    others_hz, whose = clocks_hz[0], "that of axis 0"
    if present is not None and any(axis != first_axis for axis in range(len(present.axes))):
        others_hz, whose = clocks[0] if present.fast_clock else clocks[1], "that of the axes that keep their ramps"
    bad = [
        Rejection(
            f"{_path(number, first_axis)}timer.frequency_hz",
            hz,
            f"{others_hz:,} Hz, {whose}: all axes have one clock, which is {both}",
        )
        for number, hz in clocks_hz.items()
        if hz != others_hz
    ]
    if bad:
        raise Rejected(bad)
    return others_hz


def _fitting(
    pushed: Sequence[PushedDesign], chosen: Sequence[SmallestChange], present: RampImage | None, limits: PushLimits
) -> RampImage:
    """Return the image that fits the controller, made so by coarser bounds of the ramps that take most."""
    while True:
        axes = dict(enumerate(present.axes if present else ()))
        axes |= {each.axis: change.ramp for each, change in zip(pushed, chosen, strict=True)}
        image = RampImage(limits.fast_clock, tuple(axes[axis] for axis in sorted(axes)))
        misfits = [change for change in chosen if not change.fits]
        if not misfits and len(image.encode()) <= limits.largest_image_bytes:
            return image
        largest_first = sorted(misfits or chosen, key=lambda change: -change.ramp.sent_segments)
        if not any(change.make_coarser() for change in largest_first):
            raise _too_long(pushed, chosen, limits, image)


def _too_long(
    pushed: Sequence[PushedDesign], chosen: Sequence[SmallestChange], limits: PushLimits, image: RampImage
) -> TooLong:
    each = list(zip(pushed, chosen, strict=True))
    misfits = [(one, change) for one, change in each if not change.fits]
    if misfits:
        rejections = [
            _rejection(one, change, limits, f"{change.ramp.sent_segments:,} of {limits.most_segments:,} segments")
            for one, change in misfits
        ]
        return TooLong([one for one, _ in misfits], rejections, together=False)
    one, change = max(each, key=lambda pair: pair[1].ramp.sent_segments)
    size = f"{len(image.encode()):,} of {limits.largest_image_bytes:,} bytes"
    taken = size if len(image.axes) == 1 else f"all ramps together take {size}, this one most of them"
    return TooLong([one], [_rejection(one, change, limits, taken)], together=True)


def _rejection(pushed: PushedDesign, change: SmallestChange, limits: PushLimits, taken: str) -> Rejection:
    design, path = pushed.design, pushed.path
    allowed = (
        f"a ramp of at most {limits.most_segments:,} segments, all ramps together of at most "
        f"{limits.largest_image_bytes:,} bytes, with this controller"
    )
    changed = f", even with intervals changed by up to {_ticks(change.bound_ticks)}" if change.bound_ticks else ""
    reason = f"Too long for this controller: {taken}{changed}."
    if design.method.plays_table:
        rows = f"{len(design.table.rows) if design.table else 0} rows"
        return Rejection(f"{path}table.rows", rows, allowed, reason=reason)
    rate = design.ramp.acceleration_steps_per_s2
    return Rejection(f"{path}ramp.acceleration_steps_per_s2", rate, allowed, reason=reason)


def _ticks(count: int) -> str:
    return f"{count:,} tick{'' if count == 1 else 's'}"


def _coarsest_bound(slew: float, timer_hz: int) -> int:
    """Return the largest bound that is allowed for a ramp with this slew interval [ticks]."""
    in_time = min(ticks_from_us(COARSEST_BOUND_US, timer_hz), slew * COARSEST_SHORT_BOUND)
    return max(1, int(max(slew * COARSEST_BOUND, in_time)))


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


def _figures(ramp: Ramp, hz: float) -> dict[tuple[str, FigureUnit], float]:
    """Return the figures of a ramp that people compare: (name, unit) → figure."""
    figures: dict[tuple[str, FigureUnit], float] = {("Up ramp steps", "steps"): ramp.up.size}
    if ramp.up.size:
        figures["First interval", "µs"] = us_from_ticks(float(ramp.up[0]), hz)
    figures["Slew interval", "µs"] = us_from_ticks(float(ramp.slew), hz)
    figures["Down ramp steps", "steps"] = ramp.down.size
    if ramp.down.size:
        figures["Last interval", "µs"] = us_from_ticks(float(ramp.down[0]), hz)
    return figures
