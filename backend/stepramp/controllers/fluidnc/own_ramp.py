"""The ramp that FluidNC really plays of a design's move: grbl's segments of 10 ms, by the ticks of another timer."""

from stepramp.controllers.fluidnc.ramp import FLUIDNC, TIMER, fluidnc_losses
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.grbl.motion import MOST_STEPS, intervals_s
from stepramp.controllers.own_ramp import OwnRamp
from stepramp.controllers.per_mm import PerMm
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection

ENGINE = (
    "Its step engine rounds what is drawn: I2S_STREAM puts each step on a raster of about 4 µs, RMT and Timed on none "
    "that shows here."
)


def own_ramp(design: Design, steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the items that a push would set.

    Raises Rejected as a push does, and for a move of more than MOST_STEPS; Refused for one that FluidNC never ends.
    """
    steps = abs(design.move.steps)
    if steps > MOST_STEPS:
        limits = Limits(-MOST_STEPS, MOST_STEPS, "steps", is_whole=True, note=" for the ramp that FluidNC makes of it")
        raise Rejected([Rejection.outside("move.steps", design.move.steps, limits)])
    given = PerMm.of(design, FLUIDNC, own=typed(steps_per_mm))
    waits = intervals_s(steps, steps_per_mm, float(given.speed), float(given.acceleration), TIMER)
    return OwnRamp(waits, (*fluidnc_losses(design, given), ENGINE))
