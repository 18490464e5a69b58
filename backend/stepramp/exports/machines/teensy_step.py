"""TeensyStep: a sketch with its maximum speed, its pull-in speed and its acceleration."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.losses import losses, rounding, slower
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.exports.machines.sheet import Setting, Sheet
from stepramp.exports.machines.sketch import of_a_library

MOST_STEPS_PER_S = 65_535
"""It squares speeds in 32 bits [steps/s]."""
MOST_STEPS_PER_S2 = 500_000
"""[steps/s²]"""


@dataclass(frozen=True)
class TeensyFigures:
    """What it is given, in whole steps/s and steps/s²."""

    speed: int
    pull_in: int
    acceleration: int

    @classmethod
    def of(cls, design: Design) -> "TeensyFigures":
        """Return the figures for a design, rounded down; raises Rejected for what it can't take."""
        _check(design)
        speed, rate = math.floor(typed(design.ramp.slew_speed_steps_per_s)), math.floor(slower(design))
        pull_in = math.floor(typed(design.ramp.base_speed_steps_per_s)) or _from_rest(rate, speed)
        return cls(speed, pull_in, rate)


def teensy_step(design: Design, name: str) -> Sheet:
    """Return a sketch with TeensyStep; raises Rejected for what it can't take."""
    figures, ramp = TeensyFigures.of(design), design.ramp
    settings = (
        Setting("setMaxSpeed", "steps/s", ramp.slew_speed_steps_per_s, str(figures.speed)),
        Setting("setPullInSpeed", "steps/s", ramp.base_speed_steps_per_s, str(figures.pull_in)),
        Setting("setAcceleration", "steps/s²", float(slower(design)), str(figures.acceleration)),
    )
    return of_a_library("teensy_step.ino", design, name, settings, teensy_step_losses(design))


def _from_rest(rate: int, speed: int) -> int:
    """Return the speed of the first step from rest, of the interval sqrt(2/a), in whole steps/s: sqrt(a/2)."""
    return min(max(1, math.isqrt(rate // 2)), speed)


def _check(design: Design) -> None:
    ramp = with_constant_rates(design).ramp
    checked = {
        "slew_speed_steps_per_s": (MOST_STEPS_PER_S, "steps/s"),
        "acceleration_steps_per_s2": (MOST_STEPS_PER_S2, "steps/s²"),
        "deceleration_steps_per_s2": (MOST_STEPS_PER_S2, "steps/s²"),
    }
    bad = []
    for field, (most, unit) in checked.items():
        value = getattr(ramp, field)
        if value is not None and not 1 <= value <= most:
            limits = Limits(1, most, unit, note=" with TeensyStep")
            bad.append(Rejection.outside(f"ramp.{field}", value, limits))
    if bad:
        raise Rejected(bad)


def teensy_step_losses(design: Design) -> Iterator[str]:
    """Yield what of a design it doesn't keep; raises Rejected for what it can't take."""
    ramp, figures = design.ramp, TeensyFigures.of(design)
    yield from losses(
        design, "TeensyStep", has_base_speed=True, works_out=", one speed for each 5 ms at its usual setting"
    )
    base = typed(ramp.base_speed_steps_per_s)
    if figures.pull_in > base:
        yield Remark(
            "Base speed ", quantity(float(base), "steps/s"), " becomes ", quantity(figures.pull_in, "steps/s"),
            ", about that of the first step from rest: TeensyStep never leaves a pull-in speed below 1 step/s."
        )  # fmt: skip
    yield from rounding("Base speed", "steps/s", base, Fraction(figures.pull_in))
    yield from rounding("Slew speed", "steps/s", typed(ramp.slew_speed_steps_per_s), Fraction(figures.speed))
    yield from rounding("Acceleration", "steps/s²", slower(design), Fraction(figures.acceleration))
