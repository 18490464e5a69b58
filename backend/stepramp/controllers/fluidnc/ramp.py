"""What one of FluidNC's axes is given for a design: three items of its configuration, in float."""

from collections.abc import Iterator
from fractions import Fraction

from stepramp.controllers.given_numbers import as_float32
from stepramp.controllers.grbl.motion import StepTimer
from stepramp.controllers.losses import other_scale
from stepramp.controllers.per_mm import PerMm, Quantity, Terms
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design
from stepramp.units import SECONDS_PER_MINUTE

_LEAST, _MOST = Fraction(1, 1000), Fraction(100_000)
"""It puts what is beyond to the nearer end."""
TIMER = StepTimer(clock_hz=20_000_000, finest_cycles=2500, more_cycles=0)
"""Its own, on an ESP32."""

FLUIDNC = Terms(
    name="FluidNC",
    kept=as_float32,
    steps_per_mm=Quantity(5, _LEAST, _MOST),
    speed=Quantity(3, _LEAST, _MOST),
    seconds=SECONDS_PER_MINUTE,
    acceleration=Quantity(3, _LEAST, _MOST),
    works_out=", one speed for each 10 ms",
)
CANNOT = (
    "Base speed: FluidNC starts from 0.",
    "Deceleration: FluidNC has one acceleration for both, so the smaller one is set.",
    "Shapes other than constant acceleration, and any limit of jerk.",
    "Methods and lookup tables: FluidNC works its intervals out itself, one speed for each 10 ms.",
    "Storing a ramp: FluidNC keeps no setting but its configuration's file, and what it writes there itself ($CD=…) "
    "some versions can't read again. Export the ramp, and put its lines into the file.",
    "Tracing moves, and axes that move on their own: FluidNC moves all axes along one line.",
)
"""What no FluidNC takes of a design, or does."""


def fluidnc_ramp(design: Design, path: str = "") -> PerMm:
    """Return what a design gives; raises Rejected as PerMm.of."""
    return PerMm.of(design, FLUIDNC, path)


def fluidnc_losses(design: Design, given: PerMm) -> Iterator[str]:
    """Yield what of a design FluidNC doesn't keep as it moves."""
    yield from given.ramp_losses(design)
    yield from other_scale(design, FLUIDNC.name, given.scale)
    if given.speed_steps_per_s < TIMER.slowest_steps_per_s:
        yield Remark(
            "Slew speed ", quantity(float(given.speed_steps_per_s), "steps/s"), " is not kept: FluidNC makes no fewer ",
            "than ", quantity(TIMER.slowest_steps_per_s, "steps/s", 4), " while it moves.",
        )  # fmt: skip
