"""The two sides of a design's ramp: the one place that knows which shape they have."""

from stepramp.design import MOST_STEPS, Design
from stepramp.errors import Rejected, Rejection
from stepramp.numerics.limit_text import at_least
from stepramp.shapes.constant_acceleration import ConstantAcceleration, acceleration_over

SIDES = ("acceleration_steps_per_s2", "deceleration_steps_per_s2")
"""The fields of the ramp that say how steep its way up and its way down are."""


def slopes_of(design: Design) -> tuple[ConstantAcceleration, ConstantAcceleration]:
    """Return the way up and the way down of a design's ramp."""
    ramp = design.ramp
    speeds = design.timer.frequency_hz, ramp.base_speed_steps_per_s, ramp.slew_speed_steps_per_s
    return (
        ConstantAcceleration(*speeds, ramp.acceleration_steps_per_s2),
        ConstantAcceleration(*speeds, ramp.slowdown_steps_per_s2),
    )


def playable_slopes_of(design: Design) -> tuple[ConstantAcceleration, ConstantAcceleration]:
    """Return both slopes; a ramp that no move could play is rejected before its arrays are made."""
    slopes = slopes_of(design)
    for field, slope in zip(SIDES, slopes, strict=True):
        if slope.length > MOST_STEPS:
            raise too_long(
                design, field, MOST_STEPS, f" between these speeds, for a ramp of at most {MOST_STEPS:,} steps"
            )
    return slopes


def too_long(design: Design, field: str, most_steps: int, why: str) -> Rejected:
    """Return that a side, named by its field, takes more steps than are allowed, and how steep it would have to be."""
    least = at_least(
        acceleration_over(most_steps, design.ramp.base_speed_steps_per_s, design.ramp.slew_speed_steps_per_s)
    )
    return Rejected([Rejection(f"ramp.{field}", getattr(design.ramp, field), f"{least} steps/s²{why}")])
