import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as stn

from stepramp.ramp.segments import MOST_ADD, MOST_COUNT, Segment, compress, expand

intervals = stn.arrays(np.int64, st.integers(0, 25), elements=st.integers(1, 60) | st.integers(1, 2**24 - 1))


def line_fits(given: list[int], bound: int) -> bool:
    """Whether some whole interval and add give a line within the bound: by trying them all."""
    if len(given) == 1:
        return True
    for first in range(max(1, given[0] - bound), given[0] + bound + 1):
        for add in range(given[1] - bound - first, given[1] + bound - first + 1):
            line = [first + add * k for k in range(len(given))]
            near = all(abs(a - b) <= bound for a, b in zip(line, given, strict=True))
            if near and abs(add) <= MOST_ADD and min(line) >= 1:
                return True
    return False


def fewest(given: list[int], bound: int) -> int:
    """The least number of segments, by dynamic programming over all ways to cut."""
    best = [0] + [len(given)] * len(given)
    for end in range(1, len(given) + 1):
        best[end] = min(best[start] + 1 for start in range(end) if line_fits(given[start:end], bound))
    return best[-1]


@given(intervals, st.integers(0, 5))
def test_expanding_gives_the_intervals_back_within_the_bound(given: np.ndarray, bound: int) -> None:
    segments = compress(given, bound)
    back = expand(segments)
    assert back.size == given.size
    assert np.all(np.abs(back - given) <= bound)
    assert np.all(back >= 1)
    assert all(abs(each.add) <= MOST_ADD and 1 <= each.count <= MOST_COUNT for each in segments)


@given(stn.arrays(np.int64, st.integers(1, 9), elements=st.integers(1, 30)), st.integers(0, 2))
def test_no_way_to_cut_needs_fewer_segments(given: np.ndarray, bound: int) -> None:
    assert len(compress(given, bound)) == fewest(given.tolist(), bound)


def test_a_straight_ramp_is_one_segment() -> None:
    assert compress(np.arange(1000, 500, -5), 0) == [Segment(1000, 100, -5)]


def test_counts_and_adds_beyond_their_fields_are_cut() -> None:
    assert [each.count for each in compress(np.full(70_000, 50), 0)] == [65_535, 4_465]
    assert compress(np.array([100_000, 60_000, 20_000]), 0) == [Segment(100_000, 1, 0), Segment(60_000, 1, 0),
                                                               Segment(20_000, 1, 0)]  # fmt: skip


@pytest.mark.parametrize("bound", [1, 2, 4])
@pytest.mark.parametrize("steps", [500, 5000, 100_000])
def test_the_time_of_a_step_does_not_drift_however_long_the_ramp(bound: int, steps: int) -> None:
    given = np.rint(2e6 / np.sqrt(2 * 4000 * np.arange(1, steps + 1))).astype(np.int64)
    segments = compress(given, bound)
    ends = np.cumsum([segment.count for segment in segments]) - 1
    drift = np.cumsum(expand(segments) - given)
    assert np.abs(drift[ends]).max() <= 32 * bound
    # Keeping to that costs few segments: no way to cut at all needs fewer than this bound on the longest lines.
    assert len(segments) <= 1.3 * fewest_without_drift_limit(given, bound) + 2


@pytest.mark.parametrize("bound", [1, 200, 1600, 10_000])
def test_a_long_slow_ramp_takes_no_time(bound: int) -> None:
    given = np.rint(2e6 / np.sqrt(1 + 0.02 * np.arange(1, 500_001))).astype(np.int64)
    compress(given[:10], bound)
    begin_s = time.process_time()
    segments = compress(given, bound)
    # It takes a tenth of a second; trying every line for each interval took minutes.
    assert time.process_time() - begin_s < 5
    off = expand(segments) - given
    assert np.abs(off).max() <= bound
    assert np.abs(np.cumsum(off)[np.cumsum([segment.count for segment in segments]) - 1]).max() <= 32 * bound


def test_no_more_segments_are_made_than_are_wanted() -> None:
    given = np.rint(2e6 / np.sqrt(2 * 4000 * np.arange(1, 5001))).astype(np.int64)
    assert compress(given, 1, 7) == compress(given, 1)[:7]
    assert compress(given, 1, 10_000) == compress(given, 1)


def fewest_without_drift_limit(given: np.ndarray, bound: int) -> int:
    """Count the segments of a cut in which each reaches as far as a line of any slope and start can."""
    count, at = 0, 0
    while at < given.size:
        reach = 1
        for first in range(max(1, int(given[at]) - bound), int(given[at]) + bound + 1):
            ahead = np.arange(1, min(given.size - at, 70_000))
            low = np.maximum.accumulate(np.ceil((np.maximum(given[at + ahead] - bound, 1) - first) / ahead))
            high = np.minimum.accumulate(np.floor((given[at + ahead] + bound - first) / ahead))
            reach = max(reach, 1 + int(np.argmin(np.append(low <= high, False))))
        at += min(reach, MOST_COUNT)
        count += 1
    return count


def test_no_intervals_are_no_segments() -> None:
    assert compress(np.empty(0, np.int64), 1) == []
    assert expand([]).size == 0
