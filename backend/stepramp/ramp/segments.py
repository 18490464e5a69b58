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


def compress(intervals: NDArray[np.int64], bound_ticks: int, most_segments: int | None = None) -> list[Segment]:
    """Return segments whose intervals all lie within `bound_ticks` of the given ones [ticks], close to the fewest.

    Each segment is as long as any can be from where the last one ended; without a limit to the drift that makes their
    number least, since a part of a segment that fits also fits. Of the lines that reach as far, the one is taken that
    brings the sum of all intervals so far closest to the given sum; a line that would leave it further off than 32
    times the bound is cut shorter. So the time at which a step comes doesn't drift, however long the ramp.

    intervals: whole [ticks], shape (steps,); may be empty. most_segments: so many at most, the first ones of them all.
    """
    most = intervals.size if most_segments is None else most_segments
    table = _compress(np.ascontiguousarray(intervals, dtype=np.int64), bound_ticks, most)
    return [Segment(*row) for row in table.tolist()]


def compress_sides(
    ramp: Ramp, bound_ticks: int, most_segments: int | None = None
) -> tuple[list[Segment], list[Segment]]:
    """Return both sides of a ramp as segments, up and down; see compress. Equal sides are compressed once."""
    up = compress(ramp.up, bound_ticks, most_segments)
    return up, up if np.array_equal(ramp.up, ramp.down) else compress(ramp.down, bound_ticks, most_segments)


def expand(segments: Iterable[Segment]) -> NDArray[np.int64]:
    """Return the intervals that segments stand for [ticks], shape (total count,)."""
    lines = [interval + add * np.arange(count, dtype=np.int64) for interval, count, add in segments]
    return np.concatenate(lines) if lines else np.empty(0, np.int64)


@compiled
def _compress(intervals, bound, most_segments):  # type: ignore[no-untyped-def]  # compiled
    out = np.empty((min(intervals.size, most_segments), 3), np.int64)
    room = min(intervals.size, MOST_COUNT)
    highs, lows = np.empty((4, room), np.int64), np.empty((4, room), np.int64)
    made, at, drift = 0, 0, 0
    while at < intervals.size and made < most_segments:
        first, count, add, drift = _line_within_drift(intervals[at : at + MOST_COUNT], bound, drift, highs, lows)
        out[made] = first, count, add
        at += count
        made += 1
    return out[:made]


@compiled
def _line_within_drift(ahead, bound, drift, highs, lows):  # type: ignore[no-untyped-def]  # compiled
    """Return (interval, count, add) of the line that reaches furthest without too much drift, and the drift after it.

    highs, lows: room for the envelopes of what the line must lie between.
    """
    count = _reach(ahead, bound, highs, lows)
    given = ahead[:count].sum()
    while count > 1:
        _, first, add, after = _best_line(highs, lows, count, given - drift)
        if abs(after) <= max(MOST_DRIFT * bound, abs(drift)):
            return first, count, add, after
        # A shorter line leaves more freedom to make up for the drift.
        count = _move(ahead, bound, highs, lows, count, count - 1)
        given -= ahead[count]
    first = min(max(given - drift, -lows[_HEIGHT, 0]), highs[_HEIGHT, 0])
    return first, 1, 0, drift + first - given


@compiled
def _reach(ahead, bound, highs, lows):  # type: ignore[no-untyped-def]  # compiled
    """Return how many intervals one line fits at most, and leave their envelopes. What it fits, it fits shorter too."""
    fitting, beyond, count = 1, ahead.size + 1, _move(ahead, bound, highs, lows, 0, 1)
    while beyond - fitting > 1:
        # Twice as many each time while none is known that are too many, then in the middle.
        wanted = min(2 * fitting, ahead.size) if beyond > ahead.size else (fitting + beyond) // 2
        count = _move(ahead, bound, highs, lows, count, wanted)
        if _best_line(highs, lows, count, 0)[0]:
            fitting = count
        else:
            beyond = count
    return _move(ahead, bound, highs, lows, count, fitting)


@compiled
def _best_line(highs, lows, count, wanted):  # type: ignore[no-untyped-def]  # compiled
    """Return whether a line fits so many intervals; its first, its add, and how far its sum is off the wanted one.

    Of several it is the one that is off least, then the one that begins lowest.
    """
    last, pairs = count - 1, count * (count - 1) // 2
    fits, best_first, best_add, best = False, 0, 0, 0
    flattest = max(-MOST_ADD, -((highs[_HEIGHT, 0] + lows[_HEIGHT, last]) // last))
    steepest = min(MOST_ADD, (highs[_HEIGHT, last] + lows[_HEIGHT, 0]) // last)
    for add in range(flattest, steepest + 1):
        low, high = -_least_above(lows, last, -add), _least_above(highs, last, add)
        if low > high:
            continue
        # The first interval that leaves least, the lower one of two.
        first = (2 * (wanted - pairs * add) + count - 1) // (2 * count)
        first = min(max(first, low), high)
        off = count * first + pairs * add - wanted
        if (
            not fits
            or abs(off) < abs(best)
            or (abs(off) == abs(best) and (first < best_first or (first == best_first and add % 2 == 0)))
        ):
            fits, best_first, best_add, best = True, first, add, off
    return fits, best_first, best_add, best


_HEIGHT, _CORNER, _CORNERS, _REPLACED = range(4)
"""Rows of a lower convex envelope of the points (0, height), (1, height) …: the heights, the points that are its
corners, how many these were when each point had come, and which corner's place it took."""


@compiled
def _move(ahead, bound, highs, lows, count, to):  # type: ignore[no-untyped-def]  # compiled
    """Make the envelopes of `count` intervals those of another number, and return that.

    highs: envelope of the longest that each may be; lows: of the shortest, at least 1 tick, negative.
    """
    for at in range(count, to):
        _take(highs, at, ahead[at] + bound)
        _take(lows, at, -max(ahead[at] - bound, 1))
    for at in range(count - 1, to - 1, -1):
        for envelope in (highs, lows):
            envelope[_CORNER, envelope[_CORNERS, at] - 1] = envelope[_REPLACED, at]
    return to


@compiled
def _take(envelope, at, height):  # type: ignore[no-untyped-def]  # compiled
    """Take in the next point, behind all that are there."""
    heights, corner = envelope[_HEIGHT], envelope[_CORNER]
    heights[at] = height
    corners = envelope[_CORNERS, at - 1] if at else 0
    while corners > 1:
        before, last = corner[corners - 2], corner[corners - 1]
        if (heights[last] - heights[before]) * (at - last) < (height - heights[last]) * (last - before):
            break
        corners -= 1
    envelope[_REPLACED, at] = corner[corners]
    corner[corners] = at
    envelope[_CORNERS, at] = corners + 1


@compiled
def _least_above(envelope, last, slope):  # type: ignore[no-untyped-def]  # compiled
    """Return how far the points 0 to `last` lie at least above a line with this slope through (0, 0)."""
    heights, corner = envelope[_HEIGHT], envelope[_CORNER]
    low, high = 0, envelope[_CORNERS, last] - 1
    while low < high:
        middle = (low + high) // 2
        here, there = corner[middle], corner[middle + 1]
        if heights[there] - heights[here] >= slope * (there - here):
            high = middle
        else:
            low = middle + 1
    return heights[corner[low]] - slope * corner[low]
