"""Segments: intervals as short straight lines, which is how a controller stores and plays them.

A segment is (interval, count, add): `count` intervals, the first `interval` ticks long, each next one `add` ticks
longer.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.ramp import Ramp

MOST_ADD = 32767
MOST_COUNT = 65535
MOST_DRIFT = 32
"""Times the bound: how far the instants at the ends of segments may be off."""


class Segment(NamedTuple):
    """`count` intervals, the first `interval` [ticks] long, each next one `add` [ticks] longer."""

    interval: int
    count: int  # type: ignore[assignment]  # hides tuple.count, which nothing here calls
    add: int


def compress(intervals: NDArray[np.int64], bound_ticks: int) -> list[Segment]:
    """Return segments whose intervals all lie within `bound_ticks` of the given ones [ticks], close to the fewest.

    Each segment is as long as any can be from where the last one ended; without a limit to the drift that makes their
    number least, since a part of a segment that fits also fits. Of the lines that reach as far, the one is taken that
    brings the sum of all intervals so far closest to the given sum; a line that would leave it further off than 32
    times the bound is cut shorter. So the time at which a step comes doesn't drift, however long the ramp.

    intervals: whole [ticks], shape (steps,); may be empty.
    """
    table = _compress(np.ascontiguousarray(intervals, dtype=np.int64), bound_ticks)
    return [Segment(*map(int, row)) for row in table]


def compress_sides(ramp: Ramp, bound_ticks: int) -> tuple[list[Segment], list[Segment]]:
    """Return both sides of a ramp as segments, up and down; see compress. Equal sides are compressed once."""
    up = compress(ramp.up, bound_ticks)
    return up, up if np.array_equal(ramp.up, ramp.down) else compress(ramp.down, bound_ticks)


def expand(segments: Iterable[Segment]) -> NDArray[np.int64]:
    """Return the intervals that segments stand for [ticks], shape (total count,)."""
    lines = [interval + add * np.arange(count, dtype=np.int64) for interval, count, add in segments]
    return np.concatenate(lines) if lines else np.empty(0, np.int64)


@compiled
def _compress(intervals, bound):  # type: ignore[no-untyped-def]  # compiled
    out = np.empty((intervals.size, 3), np.int64)
    made, at, drift = 0, 0, 0
    while at < intervals.size:
        line, drift = _line_within_drift(intervals, at, bound, drift)
        out[made] = line
        at += line[1]
        made += 1
    return out[:made]


@compiled
def _line_within_drift(intervals, at, bound, drift):  # type: ignore[no-untyped-def]  # compiled
    """Return the line that reaches furthest without letting the drift grow too far, and the drift after it."""
    most_count = MOST_COUNT
    while True:
        line, after = _furthest_line(intervals, at, bound, drift, most_count)
        if line[1] == 1 or abs(after) <= max(MOST_DRIFT * bound, abs(drift)):
            return line, after
        # A shorter line leaves more freedom to make up for the drift.
        most_count = line[1] - 1


@compiled
def _furthest_line(intervals, at, bound, drift, most_count):  # type: ignore[no-untyped-def]  # compiled
    """Return (interval, count, add) of the line that reaches furthest, of several the one with the least drift."""
    best = np.array([intervals[at], 1, 0])
    best_drift = drift
    for first in range(intervals[at] - bound, intervals[at] + bound + 1):
        count, low, high, total = _longest(intervals, at, first, bound, most_count)
        if count < best[1]:
            continue
        # Of the adds that reach as far, the one that leaves the least drift.
        pairs = count * (count - 1) // 2
        exact = (total - drift - count * first) / pairs if pairs else 0.0
        add = min(max(int(np.rint(exact)), low), high)
        left = drift + count * first + pairs * add - total
        if count > best[1] or abs(left) < abs(best_drift):
            best[:] = (first, count, add)
            best_drift = left
    return best, best_drift


@compiled
def _longest(intervals, at, first, bound, most_count):  # type: ignore[no-untyped-def]  # compiled
    """Return how far a line from `first` fits the intervals from `at` on, between which adds, and their sum.

    No interval of a line is shorter than 1 tick.
    """
    low, high, count, total = -MOST_ADD, MOST_ADD, 1, intervals[at]
    if first < 1:
        return 0, 0, 0, total
    while at + count < intervals.size and count < most_count:
        given = intervals[at + count]
        # Ceiling and floor of what add must lie between.
        next_low = max(low, -((first - max(given - bound, 1)) // count))
        next_high = min(high, (given + bound - first) // count)
        if next_low > next_high:
            break
        low, high, count, total = next_low, next_high, count + 1, total + given
    return count, (low if count > 1 else 0), (high if count > 1 else 0), total
