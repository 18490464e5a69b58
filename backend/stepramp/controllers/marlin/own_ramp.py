"""The ramp that a Marlin really plays of a design's move."""

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.marlin.motion import MOST_STEPS, intervals_s
from stepramp.controllers.marlin.ramp import marlin_ramp
from stepramp.controllers.own_ramp import OwnRamp
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection


def own_ramp(design: Design, steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the settings that a push would send.

    Raises Rejected as a push does, and for a move of more than MOST_STEPS; Refused as intervals_s.
    """
    steps = abs(design.move.steps)
    if steps > MOST_STEPS:
        limits = Limits(-MOST_STEPS, MOST_STEPS, "steps", is_whole=True, note=" for the ramp that Marlin makes of it")
        raise Rejected([Rejection.outside("move.steps", design.move.steps, limits)])
    given = marlin_ramp(design, own=typed(steps_per_mm))
    waits = intervals_s(steps, float(given.scale), float(given.speed), float(given.acceleration))
    return OwnRamp(waits, tuple(given.ramp_losses(design)))
