"""What one of Marlin's axes is given for a design: M92, M203 and M201, as the planner's settings keep them."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from stepramp.controllers.given_numbers import as_float32
from stepramp.controllers.marlin.motion import SLOWEST_STEPS_PER_S
from stepramp.controllers.marlin.settings import DECIMALS, most_of
from stepramp.controllers.per_mm import PerMm, Quantity, Terms
from stepramp.design import Design

MARLIN = Terms(
    name="Marlin",
    kept=as_float32,
    steps_per_mm=Quantity(6, Fraction(1, 10**6), Fraction(10**6)),
    # It lists two decimals: what is less would be told, and read back, as 0.
    speed=Quantity(3, Fraction(1, 10**2), Fraction(10**6)),
    seconds=1,
    # M201 keeps whole numbers, and with 0 an axis would never move.
    acceleration=Quantity(0, Fraction(1), Fraction(10**8)),
    starts_at=SLOWEST_STEPS_PER_S,
)
"""Speeds in mm/s; M201 is the only one without decimals."""
CONNECTED = replace(MARLIN, speed=replace(MARLIN.speed, decimals=DECIMALS))
"""Of one that is connected: speeds as it lists them, so that a backup has them as they were sent."""

CANNOT = (
    "Base speed: Marlin starts and ends at 120 steps/s, or at its jerk (M205) where that is built in.",
    "Deceleration: Marlin has one acceleration for both, so the smaller one is sent.",
    "Shapes other than constant acceleration, and any limit of jerk.",
    "Methods and lookup tables: Marlin works its intervals out itself.",
    "Slowing down when it is stopped: its quick stop (M410) ends all steps at once, and takes it 1 to 2 s to answer.",
    "Another target on the way, tracing moves, and axes that move on their own: all axes move along one line.",
)
"""What no Marlin takes of a design, or does."""


def marlin_ramp(design: Design, path: str = "", own: Fraction | None = None) -> PerMm:
    """Return what a design gives; raises Rejected as PerMm.of.

    own: the steps per mm that a Marlin tells. No more than asked is sent, whichever of those that may be it has.
    """
    if own is None:
        return PerMm.of(design, MARLIN, path)
    return replace(PerMm.of(design, CONNECTED, path, most_of(own)), scale=own)


def marlin_losses(design: Design, given: PerMm) -> Iterator[str]:
    """Yield what of a design Marlin doesn't keep, and what else its settings do."""
    yield from given.losses(design)
    yield (
        f"M204 holds for all axes: none gains speed faster than {given.acceleration} mm/s² then, whatever its own "
        "limit is."
    )
