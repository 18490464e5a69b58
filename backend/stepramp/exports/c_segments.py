"""A ramp as segments in a C header, with what plays them."""

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.exports.c_text import filled, heading, ramp_values, ticks_in_words, ticks_types
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import Segment, compress_sides

MOST_SEGMENTS = 65_535


def segments_header(design: Design, name: str, bound_ticks: int) -> str:
    """Return the design's ramp as segments whose intervals lie within a bound of the planned ones [ticks].

    Raises Rejected as ramp_of does, and when it takes more than 65,535 segments.
    """
    ramp = ramp_of(design)
    up, down = compress_sides(ramp, bound_ticks)
    if len(up) + len(down) > MOST_SEGMENTS:
        allowed = f"more, so that the ramp takes at most {MOST_SEGMENTS:,} segments instead of {len(up) + len(down):,}"
        raise Rejected([Rejection("segment_bound_ticks", bound_ticks, allowed)])
    longest = max(ramp.slew, *(int(side.max(initial=0)) for side in (ramp.up, ramp.down))) + bound_ticks
    values = heading(design, name, "segments") | ramp_values(design) | ticks_types(longest)
    return filled(
        "segments.h",
        values | {
            "method": design.method.name,
            "arithmetic": design.method.arithmetic,
            "bound": ticks_in_words(bound_ticks),
            "slew": str(ramp.slew),
            "up_lines": _lines(up),
            "down_lines": _lines(down),
        },
    )  # fmt: skip


def _lines(segments: list[Segment]) -> str:
    return "\n".join(f"    {{{interval}, {count}, {add}}}," for interval, count, add in segments)
