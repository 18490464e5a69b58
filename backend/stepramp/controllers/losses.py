"""What of a design a controller that works its ramp out by itself doesn't keep, as sentences with their figures."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import steps_per_unit, typed
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design, RampParameters, RampShape
from stepramp.errors import StepUnit, Told
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
        starts = ("starts and ends at ", quantity(starts_at, "steps/s")) if starts_at else ("starts from 0",)
        yield Remark(
            "Base speed ", quantity(ramp.base_speed_steps_per_s, "steps/s"), f" is not kept: {name} ", *starts, "."
        )
    up, down = given.acceleration_steps_per_s2, given.slowdown_steps_per_s2
    if up != down and not has_deceleration:
        lost = "Deceleration" if down > up else "Acceleration"
        yield Remark(
            f"{lost} ", quantity(max(up, down), "steps/s²"), f" is not kept: {name} has one acceleration for both, so "
            "the smaller one, ", quantity(min(up, down), "steps/s²"), ", is sent.",
        )  # fmt: skip
    if ramp.shape.name != USUAL_SHAPE:
        instead = _instead(ramp, given)
        yield Remark(
            "The shape ", *_shape(ramp.shape), f" is not kept: {name}'s acceleration is constant", *instead, "."
        )
    own = "The lookup table" if design.method.plays_table else f"The method {METHODS[design.method.name].label}"
    yield f"{own} is not kept: {name} works its intervals out itself{works_out}."


def rounding(label: str, unit: StepUnit, asked: Fraction, kept: Fraction) -> Iterator[str]:
    """Yield that a figure is rounded down on its way [unit], unless it arrives as it is."""
    if asked - kept > asked * LEAST_TOLD:
        rounded = replace(quantity(float(kept), unit), rounding="down")
        yield Remark(f"{label} ", quantity(float(asked), unit), " is rounded down to ", rounded, ".")


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


def _instead(ramp: RampParameters, given: RampParameters) -> tuple[str | Told, ...]:
    """Return which acceleration is given in place of one that falls with the speed; nothing: the same."""
    rates = [given.acceleration_steps_per_s2, given.slowdown_steps_per_s2]
    if rates == [ramp.acceleration_steps_per_s2, ramp.slowdown_steps_per_s2]:
        return ()
    told = _joined([quantity(rate, "steps/s²") for rate in dict.fromkeys(rates)])
    if ramp.shape.margin is None:
        return (", ", *told, ", the least that is drawn from its largest on")
    part = f", the largest for which {ramp.shape.margin:.0%} of the motor's torque does at every speed up to "
    return (", ", *told, part, quantity(ramp.slew_speed_steps_per_s, "steps/s"))


def _shape(shape: RampShape) -> tuple[str | Told, ...]:
    label = SHAPES[shape.name].label or shape.name
    jerks = [each for each in (shape.jerk_steps_per_s3, shape.deceleration_jerk_steps_per_s3) if each is not None]
    if not jerks:
        return (label,)
    return (f"{label} with a jerk of ", *_joined([quantity(each, "steps/s³") for each in jerks]))


def _joined(quantities: Sequence[Told]) -> tuple[str | Told, ...]:
    first, *others = quantities
    return (first, *(part for each in others for part in (" and ", each)))


def _figure(value: float) -> str:
    return f"{value:,.10g}"
