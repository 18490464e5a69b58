"""FastAccelStepper: a sketch with its speed, its acceleration and the step of the ramp that it jumps to."""

import math
from collections.abc import Iterator
from fractions import Fraction

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.losses import losses, rounding, slower
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection, Told
from stepramp.exports.machines.sheet import Setting, Sheet
from stepramp.exports.machines.sketch import of_a_library

SPEED_SCALE = 1000
"""It counts speeds in thousandths of a step a second."""
SLOWEST_STEPS_PER_S = 0.064
"""250 million of its ticks at 16 MHz [steps/s]."""
MOST_ON_AN_UNO = 50_000
"""So fast it makes the steps of one motor on an Uno [steps/s]."""


def fast_accel_stepper(design: Design, name: str) -> Sheet:
    """Return a sketch with FastAccelStepper; raises Rejected for what it can't take."""
    _check(design)
    speed, rate = typed(design.ramp.slew_speed_steps_per_s), slower(design)
    whole_rate = math.floor(rate)
    # It takes the speed there to be sqrt(2 a j).
    jump = typed(design.ramp.base_speed_steps_per_s) ** 2 / (2 * whole_rate)
    settings = (
        Setting("setSpeedInMilliHz", "steps/1,000 s", float(speed * SPEED_SCALE), str(math.floor(speed * SPEED_SCALE))),
        Setting("setAcceleration", "steps/s²", float(rate), str(whole_rate)),
        Setting("setJumpStart", "steps", float(jump), str(math.floor(jump))),
    )
    remarks = _remarks(design, math.floor(speed * SPEED_SCALE), whole_rate, math.floor(jump))
    return of_a_library("fast_accel_stepper.ino", design, name, settings, remarks)


def _check(design: Design) -> None:
    ramp = with_constant_rates(design).ramp
    bad = []
    if ramp.slew_speed_steps_per_s < SLOWEST_STEPS_PER_S:
        limits = Limits(lowest=SLOWEST_STEPS_PER_S, unit="steps/s", note=" with FastAccelStepper at 16 MHz")
        bad.append(Rejection.outside("ramp.slew_speed_steps_per_s", ramp.slew_speed_steps_per_s, limits))
    for field in ("acceleration_steps_per_s2", "deceleration_steps_per_s2"):
        rate = getattr(ramp, field)
        if rate is not None and rate < 1:
            limits = Limits(lowest=1, unit="steps/s²", note=" with FastAccelStepper")
            bad.append(Rejection.outside(f"ramp.{field}", rate, limits))
    if bad:
        raise Rejected(bad)


def _remarks(design: Design, milli_hz: int, rate: int, jump: int) -> Iterator[str]:
    ramp = design.ramp
    yield from losses(design, "FastAccelStepper", has_base_speed=True)
    base = math.sqrt(2 * rate * jump)
    if ramp.base_speed_steps_per_s - base > 1e-9 * ramp.base_speed_steps_per_s:
        yield Remark(
            "Base speed ", quantity(ramp.base_speed_steps_per_s, "steps/s"), " becomes ", quantity(base, "steps/s", 6),
            f", the speed after {jump:,} whole steps at this acceleration, with which FastAccelStepper begins."
        )  # fmt: skip
    yield from rounding("Slew speed", "steps/s", typed(ramp.slew_speed_steps_per_s), Fraction(milli_hz, SPEED_SCALE))
    yield from rounding("Acceleration", "steps/s²", slower(design), Fraction(rate))
    if ramp.slew_speed_steps_per_s > MOST_ON_AN_UNO:
        most = Told(f"{MOST_ON_AN_UNO:,}", MOST_ON_AN_UNO, "steps/s")
        yield Remark(
            "Slew speed ", quantity(ramp.slew_speed_steps_per_s, "steps/s"), " is more than the ", most, " that "
            "FastAccelStepper makes on an Uno: there the sketch refuses to move. Faster boards may make it."
        )  # fmt: skip
