"""What a ramp allows from one interval to the next."""

import itertools
from bisect import bisect_left
from collections.abc import Sequence

from firmware.motion import SETUP_TICKS, SLOW_HZ, Steps, StoredRamp

MOST_REST_TICKS = 400 + 10 * 100 + 440 + SETUP_TICKS[SLOW_HZ]
"""What a rest on the way adds to an interval, at most: the silence that ends a move, the rounds of the main loop that
queue the next one, its start, and the silence in which the direction settles."""


def assert_obeys(made: Steps, ramp: StoredRamp, slowest_run: int) -> None:
    """No interval is shorter than the next of the ramp up after the one before it allows, nor longer than the ramp down
    allows; a run's speed lies between. A direction begins and ends slowly."""
    start = (*ramp.up, ramp.slew)[0]
    landing = (*ramp.down, ramp.slew)[0]
    longest = max(*ramp.up, *ramp.down, ramp.slew, slowest_run)
    for intervals in made.runs(longest):
        if intervals:
            assert intervals[0] >= min(start, landing)
        for before, after in itertools.pairwise(intervals):
            faster = max((i for i in (*ramp.up, ramp.slew) if i < before), default=ramp.slew)
            slower = min((i for i in ramp.down if i > before), default=max(before, slowest_run))
            allowed = range(min(faster, before), max(slower, before) + 1)
            # An order that came too late finds the motor at rest, if only for a moment: it sets out anew.
            rested = landing <= before <= landing + MOST_REST_TICKS and after == start
            rests = range(max(allowed.start, landing), allowed.stop + MOST_REST_TICKS)
            assert rested or after in allowed or after in rests


def assert_without_a_stall(intervals: Sequence[int], ramp: StoredRamp) -> None:
    """The motor slows down no faster than its ramp down does."""
    down = sorted(ramp.down)
    for before, after in itertools.pairwise(intervals):
        slower = bisect_left(down, before + 1)
        assert after <= max(before, down[min(slower, len(down) - 1)])
