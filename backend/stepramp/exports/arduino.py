"""A complete Arduino sketch that moves a motor there and back: alone, or with the StepRamp library."""

import math
from dataclasses import dataclass

import numpy as np

from stepramp.controllers.stepramp.ramp_image import LONGEST_INTERVAL_TICKS, SegmentRamp
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.exports.c_ramp_image import encoded_ramp, lines_of_bytes, refuse_other_clocks
from stepramp.exports.c_text import filled, heading, ramp_values, ticks_in_words
from stepramp.numerics.limit_text import at_least, at_most
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import Segment, compress_sides, expand
from stepramp.units import speed_from_interval, ticks_from_us, us_from_ticks

CHIP_HZ = 16_000_000
CLOCK_SELECTS = {
    1: "_BV(CS10)",
    8: "_BV(CS11)",
    64: "_BV(CS11) | _BV(CS10)",
    256: "_BV(CS12)",
    1024: "_BV(CS12) | _BV(CS10)",
}
"""How Timer1 is told its prescaler."""
SHORTEST_US = 50.0
"""Of the sketch alone: what its interrupt takes, and another one before it, is over by then [µs]."""
SHORTEST_BY_POLLING_US = 400.0
"""What the library plays on an Uno from loop(): arduino_limits.h [µs]. Shorter ones want a timer."""
SHORTEST_BY_TIMER_US = 10.0
"""The same by a timer: timer_limits.h [µs]."""
MOST_SEGMENTS = 3500
"""What an Uno's program memory has room for beside the sketch, 8 bytes each."""
MOST_IMAGE_BYTES = 256
"""What the library holds on an Uno: arduino_limits.h."""
BYTES_A_SEGMENT = 3
"""At least."""
LEAD_US = 1000.0


@dataclass(frozen=True)
class _Played:
    """A design's ramp as a sketch plays it, from segments; both sides begin at the slow end."""

    up: list[Segment]
    down: list[Segment]
    ramp: Ramp


def arduino_sketch(design: Design, name: str, bound_ticks: int) -> str:
    """Return a sketch for an Uno that needs no library; its intervals lie within a bound of the planned ones [ticks].

    Raises Rejected as ramp_of does, and when a chip's Timer1 doesn't count at the design's clock, an interval is
    shorter or longer than the sketch can play, or the ramp takes more segments than there is memory for.
    """
    clocks_hz = {CHIP_HZ / prescaler: prescaler for prescaler in CLOCK_SELECTS}
    prescaler = clocks_hz.get(design.timer.frequency_hz)
    if prescaler is None:
        allowed = " or ".join(f"{clock_hz:,.0f}" for clock_hz in clocks_hz) + " Hz, the clocks of an Uno's Timer1"
        raise Rejected([Rejection("timer.frequency_hz", design.timer.frequency_hz, allowed)])
    played = _played(design, bound_ticks)
    _refuse_intervals(design, played.ramp, SHORTEST_US)
    segments = len(played.up) + len(played.down)
    if segments > MOST_SEGMENTS:
        allowed = f"more, so that the ramp takes at most {MOST_SEGMENTS:,} segments instead of {segments:,}"
        raise Rejected([Rejection("segment_bound_ticks", bound_ticks, allowed)])
    return filled(
        "arduino.ino",
        _values(design, name, bound_ticks, played.ramp) | {
            "slew": str(played.ramp.slew),
            "up_steps": str(played.ramp.up.size),
            "down_steps": str(played.ramp.down.size),
            "up_lines": _lines(played.up),
            "down_lines": _lines(played.down),
            "clock_select": CLOCK_SELECTS[prescaler],
            "prescaler": str(prescaler),
            "lead_ticks": str(math.ceil(ticks_from_us(LEAD_US, design.timer.frequency_hz))),
        },
    )  # fmt: skip


def arduino_library_sketch(design: Design, name: str, bound_ticks: int) -> str:
    """Return a sketch for an Uno with the StepRamp library; see arduino_sketch.

    Raises Rejected as encoded_ramp does, and for what the library doesn't play on an Uno.
    """
    refuse_other_clocks(design)
    played = _played(design, bound_ticks)
    ramp = played.ramp
    least_bytes = BYTES_A_SEGMENT * SegmentRamp(tuple(played.up), ramp.slew, tuple(played.down)).sent_segments
    if least_bytes > MOST_IMAGE_BYTES:
        # Before encoded_ramp tells a bound that would do for controllers with more memory.
        raise Rejected([_too_many_bytes(bound_ticks, f"{least_bytes:,} or more")])
    image = encoded_ramp(design, bound_ticks)
    _refuse_intervals(design, ramp, SHORTEST_BY_TIMER_US)
    if len(image) > MOST_IMAGE_BYTES:
        raise Rejected([_too_many_bytes(bound_ticks, f"{len(image):,}")])
    return filled(
        "arduino_library.ino",
        _values(design, name, bound_ticks, ramp) | {
            "bytes": lines_of_bytes(image, indent=2),
            "button": filled("button.ino", {}),
        } | _steps_by(us_from_ticks(_ends(ramp)[0], design.timer.frequency_hz)),
    )  # fmt: skip


def _steps_by(shortest_us: float) -> dict[str, str]:
    """Return what the sketch with the library says of who makes its steps: loop(), or above what that can do Timer1."""
    if shortest_us >= SHORTEST_BY_POLLING_US:
        return {"timer": "", "played": _BY_POLLING, "pulse": "5; /* a pulse lasts so long at least */"}
    return {
        "timer": "#include <StepRampTimer1.h>\n",
        "played": _BY_TIMER,
        "pulse": "0; /* 0: 2.6 us; wider ones leave no time for the highest speeds */",
    }


_BY_POLLING = """\
 * plans; the library plays it by polling, so that a pulse may come some tenths of a millisecond late. To the tick is
 * the sketch without the library."""
_BY_TIMER = """\
 * plans. That is too fast for loop(), so that Timer1 makes the steps (Uno, Nano, Mega, Leonardo or Micro), each up to
 * 10 us late. Taken are Timer1, so that Servo and analogWrite() on an Uno's pins 9 and 10 don't work beside it, and the
 * registers GPIOR0 to GPIOR2; loop() must come round each 2 ms. To the tick is the sketch without the library, which
 * goes up to 20,000 steps/s."""


def _too_many_bytes(bound_ticks: int, count: str) -> Rejection:
    allowed = f"more, so that the ramp takes at most {MOST_IMAGE_BYTES} bytes on an Uno instead of {count}"
    return Rejection("segment_bound_ticks", bound_ticks, allowed)


def _played(design: Design, bound_ticks: int) -> _Played:
    planned = ramp_of(design)
    up, down = compress_sides(planned, bound_ticks)
    return _Played(up, down, Ramp(expand(up), planned.slew, expand(down)))


def _refuse_intervals(design: Design, ramp: Ramp, least_us: float) -> None:
    """Refuse a ramp with intervals shorter than so many µs, or longer than can be counted."""
    timer_hz = design.timer.frequency_hz
    shortest, longest = _ends(ramp)
    if us_from_ticks(shortest, timer_hz) < least_us:
        raise Rejected([_too_fast(design, ramp, least_us)])
    if longest > LONGEST_INTERVAL_TICKS:
        raise Rejected([_too_slow(design, ramp)])


def _ends(ramp: Ramp) -> tuple[int, int]:
    """Return the shortest and the longest interval [ticks]."""
    intervals = np.concatenate((ramp.up, [ramp.slew], ramp.down))
    return int(intervals.min()), int(intervals.max())


def _too_fast(design: Design, ramp: Ramp, least_us: float) -> Rejection:
    if design.table is not None and design.method.plays_table:
        rows = design.table.rows
        least = least_us if design.table.interval_unit == "us" else ticks_from_us(least_us, design.timer.frequency_hz)
        row = min(range(len(rows)), key=lambda each: rows[each][1])
        allowed = f"at least {math.ceil(least):,} {_unit(design)}, the shortest delay that this sketch plays"
        return Rejection(f"table.rows.{row}.1", rows[row][1], allowed)
    speed = design.ramp.slew_speed_steps_per_s
    slew_us, shortest_us = (us_from_ticks(each, design.timer.frequency_hz) for each in (ramp.slew, _ends(ramp)[0]))
    # What the method is off by, and what segments may be, can make an interval shorter than that of the slew speed.
    most = 1e6 / least_us if slew_us < least_us else speed * shortest_us / least_us
    why = f"no interval of this sketch may be shorter than {least_us:g} µs; this ramp's shortest is {shortest_us:g} µs"
    return Rejection("ramp.slew_speed_steps_per_s", speed, f"{at_most(most)} steps/s, as {why}")


def _too_slow(design: Design, ramp: Ramp) -> Rejection:
    most = f"no interval may be longer than {LONGEST_INTERVAL_TICKS:,} ticks"
    timer_hz = design.timer.frequency_hz
    if design.table is not None and design.method.plays_table:
        rows = design.table.rows
        ticks = LONGEST_INTERVAL_TICKS
        longest = ticks if design.table.interval_unit == "ticks" else us_from_ticks(ticks, timer_hz)
        row = max(range(len(rows)), key=lambda each: rows[each][1])
        return Rejection(f"table.rows.{row}.1", rows[row][1], f"at most {int(longest):,} {_unit(design)}: {most}")
    if ramp.slew > LONGEST_INTERVAL_TICKS:
        least = speed_from_interval(LONGEST_INTERVAL_TICKS, timer_hz)
        return Rejection(
            "ramp.slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s, f"{at_least(least)} steps/s: {most}"
        )
    given = design.ramp.acceleration_steps_per_s2
    return Rejection("ramp.acceleration_steps_per_s2", given, f"faster: {most}")


def _unit(design: Design) -> str:
    return "ticks" if design.table is not None and design.table.interval_unit == "ticks" else "µs"


def _values(design: Design, name: str, bound_ticks: int, ramp: Ramp) -> dict[str, str]:
    """Return what both sketches say."""
    fastest, slowest = (speed_from_interval(each, design.timer.frequency_hz) for each in _ends(ramp))
    return heading(design, name, "sketch") | ramp_values(design) | {
        "timer_hz": f"{design.timer.frequency_hz:,.0f}",
        "method": design.method.name,
        "arithmetic": design.method.arithmetic,
        "bound": ticks_in_words(bound_ticks),
        "steps": str(design.move.steps),
        "fastest": f"{fastest:.6g}",
        "slowest": f"{slowest:.6g}",
    }  # fmt: skip


def _lines(segments: list[Segment]) -> str:
    return "\n".join(f"  {{{interval}, {count}, {add}}}," for interval, count, add in segments)
