"""The two sides of a design's ramp: the one place that makes them."""

from stepramp.design import MOST_STEPS, Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import lowest
from stepramp.numerics.slope import Slope
from stepramp.shapes import SHAPES
from stepramp.shapes.constant import ConstantAcceleration

SIDES = ("acceleration_steps_per_s2", "deceleration_steps_per_s2")
"""The fields of the ramp that say how steep its ramp up and its ramp down are."""


def slopes_of(design: Design) -> tuple[Slope, Slope]:
    """Return the ramp up and the ramp down of a design's ramp."""
    ramp, shape = design.ramp, SHAPES[design.ramp.shape.name]
    speeds = design.timer.frequency_hz, ramp.base_speed_steps_per_s, ramp.slew_speed_steps_per_s
    up = shape(*speeds, ramp.acceleration_steps_per_s2)
    is_mirrored = ramp.slowdown_steps_per_s2 == ramp.acceleration_steps_per_s2
    return up, up if is_mirrored else shape(*speeds, ramp.slowdown_steps_per_s2)


def constant_slopes_of(design: Design) -> tuple[ConstantAcceleration, ConstantAcceleration] | None:
    """Return the same for what holds for constant acceleration only; None when the ramp has another shape."""
    up, down = slopes_of(design)
    if isinstance(up, ConstantAcceleration) and isinstance(down, ConstantAcceleration):
        return up, down
    return None


def playable_slopes_of(design: Design) -> tuple[Slope, Slope]:
    """Return both slopes. Raises Rejected for a ramp that no move could play, before its arrays are made."""
    slopes = slopes_of(design)
    for field, slope in zip(SIDES, slopes, strict=True):
        if slope.length > MOST_STEPS:
            why = f" between these speeds, for a ramp of at most {MOST_STEPS:,} steps"
            raise too_long(design, field, MOST_STEPS, why)
    return slopes


def too_long(design: Design, field: str, most_steps: int, why: str) -> Rejected:
    """Return that a side, named by its field, takes more steps than are allowed, and how steep it would have to be."""
    slope = slopes_of(design)[SIDES.index(field)]
    limits = Limits(lowest=lowest(slope.acceleration_over(most_steps)), unit="steps/s²", note=why)
    return Rejected([Rejection.outside(f"ramp.{field}", getattr(design.ramp, field), limits)])
