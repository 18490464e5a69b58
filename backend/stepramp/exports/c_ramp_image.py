"""A ramp as the bytes that a StepRamp controller stores, in a C header for sketches with the StepRamp library."""

from stepramp.controllers.stepramp.ramp_image import (
    FAST_CLOCK_HZ,
    LONGEST_INTERVAL_TICKS,
    MOST_SEGMENTS,
    SLOW_CLOCK_HZ,
    RampImage,
    SegmentRamp,
)
from stepramp.design import Design
from stepramp.errors import Change, Rejected, Rejection, Remedy
from stepramp.exports.c_text import filled, heading, ramp_values, ticks_in_words
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import compress_sides

CLOCKS_HZ = (SLOW_CLOCK_HZ, FAST_CLOCK_HZ)
BYTES_A_LINE = 16
COARSER_BOUNDS = (1, 2, 4, 8, 16, 32)
"""What is tried where a finer bound takes too many segments [ticks]."""
MOST_STEPS_TO_TRY = 200_000
"""Longer ramps take too long to be compressed again and again [steps]."""


def ramp_image_header(design: Design, name: str, bound_ticks: int) -> str:
    """Return the design's ramp as a ramp image in a C header. Raises Rejected as encoded_ramp does."""
    image = encoded_ramp(design, bound_ticks)
    return filled(
        "ramp_image.h",
        heading(design, name, "ramp_image")
        | ramp_values(design)
        | {
            "method": design.method.name,
            "arithmetic": design.method.arithmetic,
            "bound": ticks_in_words(bound_ticks),
            "bytes": lines_of_bytes(image, indent=4),
        },
    )


def refuse_other_clocks(design: Design) -> None:
    """Refuse a timer that is none of a StepRamp controller, before a ramp is made for it."""
    if design.timer.frequency_hz not in CLOCKS_HZ:
        allowed = " or ".join(f"{clock_hz:,}" for clock_hz in CLOCKS_HZ) + " Hz, the clocks of StepRamp's firmware"
        raise Rejected([Rejection("timer.frequency_hz", design.timer.frequency_hz, allowed)])


def encoded_ramp(design: Design, bound_ticks: int) -> bytes:
    """Return the design's ramp as a ramp image whose intervals lie within a bound of the planned ones [ticks].

    Raises Rejected as ramp_of does, when the timer is none of a StepRamp controller, and when the ramp takes more
    segments or longer intervals than an image can hold.
    """
    refuse_other_clocks(design)
    ramp = ramp_of(design)
    sides = _segments(ramp, bound_ticks)
    if sides.sent_segments > MOST_SEGMENTS:
        allowed = f"more, so that the ramp takes at most {MOST_SEGMENTS} segments instead of {sides.sent_segments:,}"
        reason = f"Too long for a controller: {sides.sent_segments:,} of {MOST_SEGMENTS} segments"
        remedies = _coarser(ramp, bound_ticks)
        reason += "".join(f"; {remedy.text}" for remedy in remedies) + "."
        raise Rejected([Rejection("segment_bound_ticks", bound_ticks, allowed, remedies=remedies, reason=reason)])
    if not sides.keeps(range(1, LONGEST_INTERVAL_TICKS + 1)):
        allowed = f"faster, so that no interval is longer than {LONGEST_INTERVAL_TICKS:,} ticks"
        raise Rejected([Rejection("ramp.acceleration_steps_per_s2", design.ramp.acceleration_steps_per_s2, allowed)])
    return RampImage(design.timer.frequency_hz == FAST_CLOCK_HZ, (sides,)).encode()


def _segments(ramp: Ramp, bound_ticks: int) -> SegmentRamp:
    up, down = compress_sides(ramp, bound_ticks)
    return SegmentRamp(tuple(up), ramp.slew, tuple(down))


def _coarser(ramp: Ramp, bound_ticks: int) -> tuple[Remedy, ...]:
    """Return the finest of some coarser bounds with which the ramp fits; nothing when none does."""
    if ramp.up.size + ramp.down.size > MOST_STEPS_TO_TRY:
        return ()
    coarser = (bound for bound in COARSER_BOUNDS if bound > bound_ticks)
    fitting = next((bound for bound in coarser if _segments(ramp, bound).sent_segments <= MOST_SEGMENTS), None)
    if fitting is None:
        return ()
    text = f"allow {ticks_in_words(fitting)} of deviation"
    return (Remedy(text, (Change("segment_bound_ticks", fitting),)),)


def lines_of_bytes(image: bytes, indent: int) -> str:
    """Return bytes as lines of C numbers, so many characters in from the edge."""
    rows = (image[at : at + BYTES_A_LINE] for at in range(0, len(image), BYTES_A_LINE))
    return "\n".join(" " * indent + " ".join(f"0x{byte:02X}," for byte in row) for row in rows)
