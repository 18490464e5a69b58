"""AccelStepper: a sketch with its maximum speed and acceleration, in float."""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.losses import losses, rounding, slower
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design
from stepramp.errors import Told
from stepramp.exports.c_text import number
from stepramp.exports.machines.sheet import Setting, Sheet
from stepramp.exports.machines.sketch import of_a_library

USUAL_MOST = 4000
"""So fast it makes steps with a clock of 16 MHz, as its documentation says [steps/s]."""


def accel_stepper(design: Design, name: str) -> Sheet:
    """Return a sketch with AccelStepper."""
    speed, rate = figures_of(design)
    settings = (
        Setting("setMaxSpeed", "steps/s", design.ramp.slew_speed_steps_per_s, number(speed)),
        Setting("setAcceleration", "steps/s²", float(slower(design)), number(rate)),
    )
    return of_a_library("accel_stepper.ino", design, name, settings, _remarks(design))


def figures_of(design: Design) -> tuple[np.float32, np.float32]:
    """Return the highest speed [steps/s] and the acceleration [steps/s²] that it is given."""
    return float_below(typed(design.ramp.slew_speed_steps_per_s)), float_below(slower(design))


def float_below(most: Fraction) -> np.float32:
    """Return the greatest float32 that is no more than a number."""
    value = np.float32(float(most))
    return value if Fraction(float(value)) <= most else np.nextafter(value, np.float32(-np.inf))


def accel_stepper_losses(design: Design) -> Iterator[str]:
    """Yield what of a design it doesn't keep."""
    ramp = design.ramp
    speed, rate = figures_of(design)
    works_out = " by the recurrence (20), with a first interval of 0.676 of the exact one"
    yield from losses(design, "AccelStepper", works_out=works_out)
    yield from rounding("Slew speed", "steps/s", typed(ramp.slew_speed_steps_per_s), Fraction(float(speed)))
    yield from rounding("Acceleration", "steps/s²", slower(design), Fraction(float(rate)))
    if ramp.slew_speed_steps_per_s > USUAL_MOST:
        most = Told(f"{USUAL_MOST:,}", USUAL_MOST, "steps/s")
        yield Remark(
            "Slew speed ", quantity(ramp.slew_speed_steps_per_s, "steps/s"), " is more than the ", most, " that "
            "AccelStepper makes with a clock of 16 MHz, as on an Uno: there each step comes later than told."
        )  # fmt: skip


def _remarks(design: Design) -> Iterator[str]:
    yield from accel_stepper_losses(design)
    yield "Steps are made by polling: what else a sketch does in its loop makes them late."
