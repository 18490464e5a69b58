"""What of a design a controller that works its ramp out by itself doesn't keep, as sentences with their figures."""

from collections.abc import Iterator
from fractions import Fraction

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import steps_per_unit, typed
from stepramp.design import Design, RampParameters, RampShape
from stepramp.methods import METHODS
from stepramp.shapes import SHAPES, USUAL_SHAPE

WAY_MM = 1000
"""Of this way it is told by how much it comes out wrong."""
LEAST_TOLD = Fraction(1, 10**9)
"""Relative differences below this are no loss."""


def losses(
    design: Design,
    name: str,
    *,
    has_base_speed: bool = False,
    starts_at: int = 0,
    has_deceleration: bool = False,
    works_out: str = "",
) -> Iterator[str]:
    """Yield what a controller of this name doesn't keep.

    starts_at: the speed that it begins and ends a move with, if it keeps no base speed [steps/s]. works_out: how it
    works its intervals out, as the end of a sentence, if there is something to tell.
    """
    ramp, given = design.ramp, with_constant_rates(design).ramp
    if ramp.base_speed_steps_per_s != starts_at and not has_base_speed:
        starts = f"starts and ends at {starts_at:,} steps/s" if starts_at else "starts from 0"
        yield f"Base speed {_figure(ramp.base_speed_steps_per_s)} steps/s is not kept: {name} {starts}."
    up, down = given.acceleration_steps_per_s2, given.slowdown_steps_per_s2
    if up != down and not has_deceleration:
        lost = "Deceleration" if down > up else "Acceleration"
        yield (
            f"{lost} {_figure(max(up, down))} steps/s² is not kept: {name} has one acceleration for both, so "
            f"the smaller one, {_figure(min(up, down))} steps/s², is sent."
        )
    if ramp.shape.name != USUAL_SHAPE:
        constant = f"constant{_instead(ramp, given)}"
        yield f"The shape {_shape(ramp.shape)} is not kept: {name}'s acceleration is {constant}."
    own = "The lookup table" if design.method.plays_table else f"The method {METHODS[design.method.name].label}"
    yield f"{own} is not kept: {name} works its intervals out itself{works_out}."


def rounding(label: str, unit: str, asked: Fraction, kept: Fraction) -> Iterator[str]:
    """Yield that a figure is rounded down on its way [unit], unless it arrives as it is."""
    if asked - kept > asked * LEAST_TOLD:
        yield f"{label} {_figure(float(asked))} {unit} is rounded down to {_figure(float(kept))} {unit}."


def scale_losses(design: Design, name: str, kept: Fraction) -> Iterator[str]:
    """Yield what becomes of ways with the steps per mm that a controller keeps, and that it counts in mm only."""
    asked = steps_per_unit(design.axis)
    unit = "degrees" if design.axis.travel_unit == "deg" else "mm"
    off = WAY_MM * (asked / kept - 1)
    if abs(off) > WAY_MM * LEAST_TOLD:
        yield (
            f"{_figure(float(asked))} steps per mm are kept as {_figure(float(kept))}: a way of {WAY_MM:,} {unit} "
            f"comes out {abs(float(off)):,.2g} {unit} {'short' if off > 0 else 'long'}."
        )
    if design.axis.travel_unit == "deg":
        yield f"{name} counts in mm: here each stands for a degree."


def other_scale(design: Design, name: str, own: Fraction) -> Iterator[str]:
    """Yield that a controller is set to other steps per mm than the design has, and what becomes of that."""
    asked = steps_per_unit(design.axis)
    if abs(asked / own - 1) > LEAST_TOLD:
        unit = "degree" if design.axis.travel_unit == "deg" else "mm"
        yield (
            f"The design has {_figure(float(asked))} steps per {unit}, {name} {_figure(float(own))} per mm: the "
            "design's steps are sent, not its lengths."
        )


def slower(design: Design) -> Fraction:
    """Return the smaller one of acceleration and deceleration that a controller is given [steps/s²]."""
    given = with_constant_rates(design).ramp
    return min(typed(given.acceleration_steps_per_s2), typed(given.slowdown_steps_per_s2))


def _instead(ramp: RampParameters, given: RampParameters) -> str:
    """Return which acceleration is given in place of one that falls with the speed; empty: the same."""
    rates = [given.acceleration_steps_per_s2, given.slowdown_steps_per_s2]
    if rates == [ramp.acceleration_steps_per_s2, ramp.slowdown_steps_per_s2]:
        return ""
    told = " and ".join(_figure(rate) for rate in dict.fromkeys(rates))
    if ramp.shape.margin is None:
        return f", {told} steps/s², the least that is drawn from its largest on"
    speed = _figure(ramp.slew_speed_steps_per_s)
    return (
        f", {told} steps/s², the largest for which {ramp.shape.margin:.0%} of the motor's torque does at every speed "
        f"up to {speed} steps/s"
    )


def _shape(shape: RampShape) -> str:
    label = SHAPES[shape.name].label or shape.name
    if shape.jerk_steps_per_s3 is None:
        return label
    down = shape.deceleration_jerk_steps_per_s3
    jerks = _figure(shape.jerk_steps_per_s3) + ("" if down is None else f" and {_figure(down)}")
    return f"{label} with a jerk of {jerks} steps/s³"


def _figure(value: float) -> str:
    return f"{value:,.10g}"
