"""Ramp images for tests, in ticks of the slow clock."""

from __future__ import annotations

from stepramp.controllers.stepramp.ramp_image import AxisRamp, RampImage, SegmentRamp
from stepramp.ramp.segments import Segment, expand

SIDE = (Segment(4000, 1, 0), Segment(2828, 2, -519), Segment(2000, 40, -25))
DOWN = (Segment(4000, 20, -100), Segment(2000, 20, -50))
DOWN_STEPS = [int(interval) for interval in expand(DOWN)]


def image_of(*ramps: AxisRamp) -> RampImage:
    return RampImage(False, ramps)


IMAGE = image_of(SegmentRamp(SIDE, 1000, DOWN))
FAST_IMAGE = image_of(SegmentRamp((Segment(1500, 10, -80),), 600, (Segment(1500, 10, -80),)))


def four_axes() -> RampImage:
    """Return an image of four axes with two ramps."""
    other = SegmentRamp((Segment(5000, 30, -100),), 900, (Segment(5000, 30, -100),))
    first = IMAGE.axes[0]
    return image_of(first, other, first, other)
