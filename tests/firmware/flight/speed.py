"""Intervals against the ramps."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from firmware.checker import CYCLES_PER_US
from firmware.flight.exchange import Exchange
from firmware.flight.judgement import Judgement, at, us
from firmware.flight.motion import Flight, leader_of
from firmware.flight.setting import Slopes, Ticks
from firmware.protocol import HALT, STOP

LINE_LATE_US = 4.5
SETTING_OUT_US = 60
"""A stop that comes before the first step halts; until it has, steps may be made, as fast as a motor sets out."""
WINDOWS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 128, 256, 512)
"""Steps over which a change of speed is looked at."""


@dataclass(frozen=True)
class Piece:
    """Steps that an axis made from rest, to rest or to a halt, along its own ramp or leading a line."""

    flight: Flight
    begin: int
    end: int
    """Of its steps."""
    slopes: Slopes
    ends_at_rest: bool
    late: float
    """[cycles]"""

    @property
    def steps(self) -> npt.NDArray[np.int64]:
        return self.flight.made.steps[self.begin : self.end]

    @property
    def forward(self) -> npt.NDArray[np.bool_]:
        return self.flight.made.forward[self.begin : self.end]

    def where(self, interval: int) -> str:
        return f"axis {self.flight.axis} {at(self.steps[interval])}"

    def in_cycles(self, ticks: npt.ArrayLike) -> Ticks:
        return np.asarray(ticks, float) * self.flight.setting.cycles_per_tick


def pieces_of(flight: Flight) -> Iterator[Piece]:
    """Yield the axis' pieces: cut at halts and lines. In a line only its leader plays a ramp."""
    steps = flight.made.steps
    cuts = {0: True, steps.size: True}
    halts = [one.answered for one in flight.heard if one.is_granted and one.kind == HALT]
    lines = flight.lines
    for halt in halts:
        in_line = any(line.arrived < halt < end for line, end in lines)
        if in_line or any(one.answered == halt for one in flight.orders):
            cuts[int(np.searchsorted(steps, halt))] = False
    cuts |= dict.fromkeys(_stopped_setting_out(flight), False)
    for line, end in lines:
        for moment in (line.arrived, end):
            cuts.setdefault(int(np.searchsorted(steps, moment)), True)
    ordered = sorted(cuts)
    for begin, end in pairwise(ordered):
        slopes, late = flight.setting.slopes[flight.axis], flight.setting.late_cycles
        its_line = [line for line, until in lines if line.arrived <= steps[begin] < until]
        if its_line:
            if leader_of(its_line[0]) != flight.axis:
                continue
            slopes = flight.setting.slopes[its_line[0].body[1]]
            late = LINE_LATE_US * CYCLES_PER_US + flight.setting.cycles_per_tick
        yield Piece(flight, begin, end, slopes, cuts[end], late)


def _stopped_setting_out(flight: Flight) -> Iterator[int]:
    """Yield the ends of first steps that were made while a stop, come before them, was being obeyed."""
    steps = flight.made.steps
    for stop in (one for one in flight.heard if one.is_granted and one.kind == STOP):
        first, last = np.searchsorted(steps, [stop.arrived, stop.answered])
        least = 1 if _rested(flight, stop) else 2
        if last - first >= least and steps[last - 1] - steps[first] <= SETTING_OUT_US * CYCLES_PER_US:
            yield int(last)


def _rested(flight: Flight, stop: Exchange) -> bool:
    """Whether the axis had made no step since a halt when a stop came: the next step was the first of a motion."""
    halts = [one.answered for one in flight.orders if one.kind == HALT and one.answered < stop.arrived]
    first, last = np.searchsorted(flight.made.steps, [max(halts, default=0), stop.arrived])
    return bool(first == last)


def judge_speed(piece: Piece, found: Judgement) -> None:
    """From step to step, and over more of them, the speed changes no faster than the ramp's; and never beyond it."""
    intervals = np.diff(piece.steps).astype(float)
    slew = float(piece.in_cycles(piece.slopes.slew))
    if intervals.size and intervals.min() < slew - piece.late:
        found.add(f"{piece.where(int(intervals.argmin()))}: {us(intervals.min())}, the slew interval is {us(slew)}")
    with_rests = np.concatenate(([np.inf], intervals, [np.inf] if piece.ends_at_rest else []))
    for count in WINDOWS:
        if count < with_rests.size:
            before, after = with_rests[:-count], with_rests[count:]
            good_so_far = len(found.faults)
            _judge_rise(piece, count, before, after, found)
            _judge_fall(piece, count, before, after, found)
            if len(found.faults) > good_so_far:
                break
    _judge_turns(piece, intervals, found)


def _judge_rise(piece: Piece, count: int, before: Ticks, after: Ticks, found: Judgement) -> None:
    slopes, up = piece.slopes, piece.in_cycles([*piece.slopes.up, piece.slopes.slew])
    place = np.searchsorted(-up, -(before - piece.late), side="right") - 1
    place += count + slopes.places
    too_short = up[np.minimum(place, up.size - 1)] - piece.late - after
    worst = int(too_short.argmax())
    if too_short[worst] > 0:
        over = "" if count == 1 else f" over {count} steps"
        found.add(
            f"{piece.where(max(worst + count - 1, 0))}: the speed rises too fast{over}: {us(before[worst])}, then "
            f"{us(after[worst])}, {us(too_short[worst])} too short"
        )


def _judge_fall(piece: Piece, count: int, before: Ticks, after: Ticks, found: Judgement) -> None:
    slopes, down = piece.slopes, piece.in_cycles(piece.slopes.down)
    place = np.searchsorted(-down, -(before + piece.late), side="left") - count
    may_rest = place <= slopes.last_places - 1
    longest = np.where(may_rest, np.inf, down[np.maximum(place - slopes.places, 0)] if down.size else np.inf)
    with np.errstate(invalid="ignore"):
        too_long = np.where(may_rest, -np.inf, after - longest)
    worst = int(too_long.argmax())
    if np.isfinite(too_long[worst]):
        found.latest_us = max(found.latest_us, too_long[worst] / CYCLES_PER_US)
    if too_long[worst] > piece.late:
        over = "" if count == 1 else f" over {count} steps"
        found.add(
            f"{piece.where(max(worst + count - 2, 0))}: a pause at speed{over}: {us(before[worst])}, then "
            f"{us(after[worst])}, {us(too_long[worst])} too long"
        )


def may_rest(piece: Piece, interval: float) -> bool:
    """Whether the motor may come to rest after such an interval."""
    down = piece.in_cycles(piece.slopes.down)
    return int((down > interval + piece.late).sum()) <= piece.slopes.last_places


def _judge_turns(piece: Piece, intervals: Ticks, found: Judgement) -> None:
    """The direction changes at rest, after the last interval has passed."""
    down = piece.in_cycles(piece.slopes.down)
    for turn in np.flatnonzero(np.diff(piece.forward.astype(int))):
        before = intervals[turn - 1] if turn else np.inf
        if not may_rest(piece, before):
            found.add(f"{piece.where(turn)}: the direction changes at speed, after {us(before)}")
        least = (down[0] if down.size else min(before, intervals[turn])) if piece.slopes.places == 0 else 0
        least = least + piece.flight.setting.settings.direction_setup_us * CYCLES_PER_US - piece.late
        if intervals[turn] < least:
            found.add(f"{piece.where(turn)}: {us(intervals[turn])} from a step to one back, not {us(least)}")
