"""What Klipper is given for a design: a speed and an acceleration in its configuration's own numbers, in double."""

import math
from collections.abc import Iterator
from fractions import Fraction

from stepramp.controllers.losses import other_scale
from stepramp.controllers.per_mm import PerMm, Quantity, Terms
from stepramp.controllers.remark import Remark
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection, Told

DECIMALS = 6
"""Of the numbers that it is given."""
STEPS_OF_A_CYCLE = 4
"""Full steps after which a motor's currents are as before: a turn must be a multiple of them."""


KLIPPER = Terms(
    name="Klipper",
    # It keeps doubles: by how much such a one is off no motor can tell, and rounded down for it 9.7125 would be less.
    kept=Fraction,
    steps_per_mm=None,
    speed=Quantity(DECIMALS, Fraction(1, 10**DECIMALS), Fraction(10**9)),
    seconds=1,
    acceleration=Quantity(DECIMALS, Fraction(1, 10**DECIMALS), Fraction(10**12)),
)


CANNOT = (
    "Base speed: Klipper starts from 0.",
    "Deceleration: Klipper has one acceleration for both, so the smaller one is sent.",
    "Shapes other than constant acceleration, and any limit of jerk.",
    "Methods and lookup tables: Klipper works its intervals out itself.",
    "Limits for x and y apart: max_velocity and max_accel hold for the tool as a whole. z has limits of its own, which "
    "only its configuration keeps.",
    "Stopping at once: what is queued, up to 2 s and the way of slowing down, is still played. Halting is Klipper's "
    "emergency stop, after which it has to be restarted and homed.",
    "Motors that are no axes, as with delta or polar kinematics, and moving before the printer is homed.",
    "Tracing moves, and axes that move on their own: Klipper moves all axes along one line.",
)
"""What no Klipper takes of a design, or does."""


def klipper_ramp(design: Design, path: str = "") -> PerMm:
    """Return what a design gives; raises Rejected as PerMm.of, and for a turn that Klipper can't count."""
    full_steps = design.axis.full_steps_per_rev
    if full_steps % STEPS_OF_A_CYCLE:
        allowed = f"a multiple of {STEPS_OF_A_CYCLE} full steps with Klipper"
        raise Rejected([Rejection(f"{path}axis.full_steps_per_rev", full_steps, allowed)])
    return PerMm.of(design, KLIPPER, path)


def least_way(speed: float, acceleration: float, cruise_ratio: float) -> int:
    """Return over how many steps a move reaches its speed [steps/s, steps/s²]: v²/(a·(1 - r))."""
    return math.ceil(speed**2 / (acceleration * (1 - cruise_ratio)))


def losses_in_use(design: Design, given: PerMm, cruise_ratio: float) -> Iterator[str]:
    """Yield what of a design a Klipper doesn't keep as it is set, with a minimum_cruise_ratio."""
    yield from given.ramp_losses(design)
    yield from other_scale(design, KLIPPER.name, given.scale)
    if cruise_ratio > 0:
        least = least_way(float(given.speed_steps_per_s), float(given.acceleration_steps_per_s2), cruise_ratio)
        yield Remark(
            "Moves of less than ", Told(f"{least:,} steps", least, "steps", "up"), " stay slower than planned: with a "
            f"minimum_cruise_ratio of {cruise_ratio:g} they keep to one speed for that part of their way.",
        )  # fmt: skip


def klipper_losses(design: Design, given: PerMm) -> Iterator[str]:
    """Yield what of a design Klipper doesn't keep."""
    yield from given.losses(design)
    yield (
        "Short moves stay slower than planned, unless minimum_cruise_ratio is 0: at Klipper's own 0.5 they keep to one "
        "speed for half of their way."
    )
