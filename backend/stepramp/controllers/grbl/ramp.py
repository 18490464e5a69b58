"""The ramp of one of grbl's axes for a design: two settings, rounded down, and what of the design they don't hold."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.grbl.motion import SLOWEST_STEPS_PER_S
from stepramp.controllers.grbl.numbers import below, exact, read
from stepramp.controllers.grbl.settings import acceleration_of, kept_acceleration, rate_of, speed_of
from stepramp.controllers.losses import losses, slower
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import highest, lowest
from stepramp.units import SECONDS_PER_MINUTE

LEAST_RATE = 1
"""Slower grbl plans nothing, whatever is set [mm/min]."""
LEAST = Fraction(2, 1000)
"""Below, an acceleration may become 0, at which grbl hangs [mm/s²]."""
MOST = 99_999_999
"""Of what has eight digits before the point [mm/min, mm/s²]."""
MOST_ON_AN_UNO = 30_000
"""So fast grbl 1.1 makes steps on an Uno, as its documentation says [steps/s]."""

CANNOT = (
    "Base speed: grbl starts from 0.",
    "Deceleration: grbl has one acceleration for both, so the smaller one is sent.",
    "Shapes other than constant acceleration, and any limit of jerk.",
    "Methods and lookup tables: grbl works its intervals out itself, one speed for each 10 ms.",
    "Trying a ramp without storing it: grbl stores each setting at once.",
    "Tracing moves, and axes that move on their own: grbl moves all axes along one line.",
)
"""What no grbl takes of a design, or does."""


@dataclass(frozen=True)
class GrblRamp:
    """What is sent for one axis: numbers as grbl is told them."""

    steps_per_mm: np.float32
    rate_text: str
    acceleration_text: str

    @classmethod
    def of(
        cls,
        design: Design,
        steps_per_mm: np.float32,
        path: str = "",
        most_per_mm: np.float32 | None = None,
        name: str = "grbl",
    ) -> "GrblRamp":
        """Return the ramp for a design, rounded down: too much of either would stall the motor.

        path: what a rejection puts before the design's fields. most_per_mm: as many as the steps per mm may be, where
        they are told rounded: with them it is worked out. name: of grbl, or of its kin. Raises Rejected for what grbl
        can't take: with a rate or an acceleration of 0 it hangs.
        """
        per_mm = steps_per_mm if most_per_mm is None else most_per_mm
        ramp = with_constant_rates(design, path).ramp
        least_speed, least = LEAST_RATE * exact(per_mm) / SECONDS_PER_MINUTE, LEAST * exact(per_mm)
        most = MOST * exact(per_mm)
        speed = typed(ramp.slew_speed_steps_per_s)
        rates = {"acceleration_steps_per_s2": ramp.acceleration_steps_per_s2}
        if ramp.deceleration_steps_per_s2 is not None:
            rates["deceleration_steps_per_s2"] = ramp.deceleration_steps_per_s2
        bad = []
        if speed < least_speed or rate_of(speed, per_mm) > MOST:
            note = f" with {name} at {float(steps_per_mm):,.7g} steps/mm"
            limits = Limits(lowest(float(least_speed)), highest(float(most / SECONDS_PER_MINUTE)), "steps/s", note=note)
            bad.append(Rejection.outside(f"{path}ramp.slew_speed_steps_per_s", ramp.slew_speed_steps_per_s, limits))
        for field, rate in rates.items():
            if not least <= typed(rate) <= most:
                note = f" with {name} at {float(steps_per_mm):,.7g} steps/mm, which keeps thousandths of mm/s²"
                limits = Limits(lowest(float(least)), highest(float(most)), "steps/s²", note=note)
                bad.append(Rejection.outside(f"{path}ramp.{field}", rate, limits))
        if bad:
            raise Rejected(bad)
        return cls(
            steps_per_mm,
            below(rate_of(speed, per_mm), lambda text: exact(read(text))),
            below(slower(design) / exact(per_mm), lambda text: kept_acceleration(read(text))),
        )

    @property
    def rate(self) -> np.float32:
        """The highest rate, as grbl reads it [mm/min]."""
        return read(self.rate_text)

    @property
    def acceleration(self) -> np.float32:
        """The acceleration, as grbl reads it [mm/s²]."""
        return read(self.acceleration_text)

    @property
    def speed_steps_per_s(self) -> float:
        """Its highest speed [steps/s]."""
        return float(speed_of(self.rate, self.steps_per_mm))

    @property
    def acceleration_steps_per_s2(self) -> float:
        """How it gains speed, and loses it [steps/s²]."""
        return float(acceleration_of(self.acceleration, self.steps_per_mm))


def grbl_losses(design: Design, name: str = "grbl") -> Iterator[str]:
    """Yield what of a design grbl, or its kin of another name, doesn't keep."""
    yield from losses(design, name, works_out=", one speed for each 10 ms")
    speed = design.ramp.slew_speed_steps_per_s
    if speed > MOST_ON_AN_UNO:
        yield Remark(
            "Slew speed ", quantity(speed, "steps/s"), " is more than the ", quantity(MOST_ON_AN_UNO, "steps/s"),
            " that grbl 1.1 makes on an Uno; grblHAL on a faster board may make it.",
        )  # fmt: skip
    if speed < SLOWEST_STEPS_PER_S:
        yield Remark(
            "Slew speed ", quantity(speed, "steps/s"), " is not kept: on an Uno grbl makes no fewer than ",
            quantity(SLOWEST_STEPS_PER_S, "steps/s", 4), " while it moves.",
        )  # fmt: skip
