"""The ramp that a module really plays of a design's move."""

from stepramp.controllers.own_ramp import OwnRamp
from stepramp.controllers.six_points import SixPoints
from stepramp.controllers.tmcl.modules import CLOCK_HZ
from stepramp.controllers.tmcl.ramp import TmclRamp, is_speed, tmcl_losses
from stepramp.controllers.tmcl.units import UnitMode, Units
from stepramp.design import Design

USUAL_UNITS = Units(UnitMode.STEPS, CLOCK_HZ)
"""Those that a module comes with."""


def own_ramp(design: Design, _steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the figures that a push sends to a module as it comes.

    A module counts in steps only. Raises Rejected as a push does.
    """
    points = six_points_of(TmclRamp.of(design, USUAL_UNITS), USUAL_UNITS)
    return OwnRamp(points.intervals_s(abs(design.move.steps)), tuple(tmcl_losses(design, USUAL_UNITS)))


def six_points_of(ramp: TmclRamp, units: Units) -> SixPoints:
    """Return what the chip plays of a ramp in its module's units."""
    exact = {
        name: float(value * (units.chip_speed if is_speed(name) else units.chip_acceleration))
        for name, value in ramp.of_the_chip(units).named
    }
    return SixPoints(**exact)
