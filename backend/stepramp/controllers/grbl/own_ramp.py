"""The ramp that a grbl really plays of a design's move."""

import numpy as np

from stepramp.controllers.grbl.motion import MOST_STEPS, intervals_s
from stepramp.controllers.grbl.ramp import GrblRamp, grbl_losses
from stepramp.controllers.own_ramp import OwnRamp
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection


def own_ramp(design: Design, steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the settings that a push would send.

    Raises Rejected as a push does, and for a move of more than MOST_STEPS; Refused for one that grbl never ends.
    """
    steps = abs(design.move.steps)
    if steps > MOST_STEPS:
        limits = Limits(-MOST_STEPS, MOST_STEPS, "steps", is_whole=True, note=" for the ramp that grbl makes of it")
        raise Rejected([Rejection.outside("move.steps", design.move.steps, limits)])
    ramp = GrblRamp.of(design, np.float32(steps_per_mm))
    waits = intervals_s(steps, float(ramp.steps_per_mm), float(ramp.rate), float(ramp.acceleration))
    return OwnRamp(waits, tuple(grbl_losses(design)))
