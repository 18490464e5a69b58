"""Ramps as Hypothesis makes them."""

from hypothesis import strategies as st

from firmware.protocol import Ramp, Segment

SHORTEST, LONGEST = 40, 16_777_215

intervals = st.one_of(st.integers(SHORTEST, 300), st.integers(SHORTEST, 70_000), st.integers(SHORTEST, LONGEST))


@st.composite
def segments(draw: st.DrawFn, most_count: int = 12) -> Segment:
    """Any allowed segment: growing ones and constant ones too, as the format allows them."""
    interval, count = draw(intervals), draw(st.integers(1, most_count))
    if count == 1:
        return interval, 1, draw(st.integers(-32768, 32767))
    lowest = max(-32768, -((interval - SHORTEST) // (count - 1)))
    highest = min(32767, (LONGEST - interval) // (count - 1))
    return interval, count, draw(st.integers(lowest, highest))


def lists(most: int = 6, most_count: int = 12) -> st.SearchStrategy[list[Segment]]:
    return st.lists(segments(most_count), max_size=most)


@st.composite
def falling_lists(draw: st.DrawFn, most: int = 5, most_count: int = 12) -> list[Segment]:
    """Segments as a ramp really has them: no interval longer than the one before."""
    found: list[Segment] = []
    top = draw(st.integers(300, 60_000))
    for _ in range(draw(st.integers(0, most))):
        interval, count = draw(st.integers(SHORTEST, top)), draw(st.integers(1, most_count))
        add = -draw(st.integers(0, (interval - SHORTEST) // count))
        found.append((interval, count, max(add, -32768)))
        top = max(SHORTEST, interval + (count - 1) * found[-1][2])
    return found


@st.composite
def ramps(draw: st.DrawFn) -> Ramp:
    """Any allowed ramp, half of them with falling lists, some with one list for both directions."""
    some_lists = draw(st.sampled_from([lists(), falling_lists()]))
    up = draw(some_lists)
    down = up if draw(st.booleans()) else draw(some_lists)
    return Ramp(up, draw(intervals), down)


@st.composite
def falling_ramps(draw: st.DrawFn) -> Ramp:
    """A ramp that never becomes slower while accelerating, and whose slew is its fastest."""
    up = draw(falling_lists())
    down = up if draw(st.booleans()) else draw(falling_lists())
    ends = [interval + (count - 1) * add for interval, count, add in [*up[-1:], *down[-1:]]]
    return Ramp(up, draw(st.integers(SHORTEST, min([*ends, 60_000]))), down)
