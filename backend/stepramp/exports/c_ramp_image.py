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
from stepramp.errors import Rejected, Rejection
from stepramp.exports.c_text import filled, heading, ramp_values
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import compress_sides

CLOCKS_HZ = (SLOW_CLOCK_HZ, FAST_CLOCK_HZ)
BYTES_A_LINE = 16


def ramp_image_header(design: Design, name: str, bound_ticks: int) -> str:
    """Return the design's ramp as a ramp image whose intervals lie within a bound of the planned ones [ticks].

    Raises Rejected as ramp_of does, when the timer is none of a StepRamp controller, and when the ramp takes more
    segments or longer intervals than an image can hold.
    """
    if design.timer.frequency_hz not in CLOCKS_HZ:
        allowed = " or ".join(f"{clock_hz:,}" for clock_hz in CLOCKS_HZ) + " Hz, the clocks of StepRamp's firmware"
        raise Rejected([Rejection("timer.frequency_hz", design.timer.frequency_hz, allowed)])
    ramp = ramp_of(design)
    up, down = compress_sides(ramp, bound_ticks)
    sides = SegmentRamp(tuple(up), ramp.slew, tuple(down))
    if sides.sent_segments > MOST_SEGMENTS:
        allowed = f"more, so that the ramp takes at most {MOST_SEGMENTS} segments instead of {sides.sent_segments:,}"
        raise Rejected([Rejection("segment_bound_ticks", bound_ticks, allowed)])
    if not sides.keeps(range(1, LONGEST_INTERVAL_TICKS + 1)):
        allowed = f"faster, so that no interval is longer than {LONGEST_INTERVAL_TICKS:,} ticks"
        raise Rejected([Rejection("ramp.acceleration_steps_per_s2", design.ramp.acceleration_steps_per_s2, allowed)])
    image = RampImage(design.timer.frequency_hz == FAST_CLOCK_HZ, (sides,)).encode()
    return filled(
        "ramp_image.h",
        heading(design, name, "ramp_image")
        | ramp_values(design)
        | {
            "method": design.method.name,
            "arithmetic": design.method.arithmetic,
            "bound": f"{bound_ticks} tick{'' if bound_ticks == 1 else 's'}",
            "bytes": _lines(image),
        },
    )


def _lines(image: bytes) -> str:
    rows = (image[at : at + BYTES_A_LINE] for at in range(0, len(image), BYTES_A_LINE))
    return "\n".join("    " + " ".join(f"0x{byte:02X}," for byte in row) for row in rows)
