"""Controllers that keep steps per mm, a highest speed and one acceleration for each axis: what a design gives them."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import Kept, nearest, rounded_down, steps_per_unit, typed
from stepramp.controllers.losses import losses, rounding, scale_losses, slower
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import highest, lowest


@dataclass(frozen=True)
class Quantity:
    """How one of the three is kept."""

    decimals: int
    least: Fraction
    most: Fraction


@dataclass(frozen=True)
class Terms:
    """How a family of controllers is given them."""

    name: str
    kept: Kept
    steps_per_mm: Quantity | None
    """None where they are not given, but follow from what a turn is."""
    speed: Quantity
    """[mm for each time]"""
    seconds: int
    """That time [s]: 60 where speeds are in mm/min."""
    acceleration: Quantity
    """[mm/s²]"""
    works_out: str = ""
    """How it works its intervals out, as the end of a sentence."""
    starts_at: int = 0
    """What a move begins and ends with [steps/s]."""


@dataclass(frozen=True)
class PerMm:
    """What one axis is given for a design: numbers as the controller reads them."""

    terms: Terms
    scale: Fraction
    """Its steps per mm."""
    steps_per_mm: str
    """The same as it is given them."""
    speed: str
    acceleration: str

    @classmethod
    def of(
        cls,
        design: Design,
        terms: Terms,
        path: str = "",
        own: Fraction | None = None,
        most: Fraction | None = None,
    ) -> "PerMm":
        """Return what a design gives; speed and acceleration rounded down, since too much would stall the motor.

        They are worked out with the steps per mm that the controller keeps, which are the nearest that it can.
        path: what a rejection puts before the design's fields. own: the steps per mm that a controller is set to; None:
        the design's are given it. most: as many as its own may be, where it tells them rounded: with them it is worked
        out. Raises Rejected for what the controller can't take.
        """
        kept, scale = _scale(design, terms, path) if own is None else (own, f"{float(own):.10g}")
        per_mm = kept if most is None else most
        ramp, speed = with_constant_rates(design, path).ramp, per_mm / terms.seconds
        fields = {"slew_speed_steps_per_s": (ramp.slew_speed_steps_per_s, terms.speed, speed, "steps/s")}
        for field in ("acceleration_steps_per_s2", "deceleration_steps_per_s2"):
            if (rate := getattr(ramp, field)) is not None:
                fields[field] = (rate, terms.acceleration, per_mm, "steps/s²")
        bad = []
        for field, (value, quantity, unit_in_steps, unit) in fields.items():
            # What is kept of the least text may be a little more: then less than that can't be rounded down to it.
            least = max(quantity.least, terms.kept(nearest(quantity.least, quantity.decimals)))
            if not least * unit_in_steps <= typed(value) <= quantity.most * unit_in_steps:
                limits = Limits(
                    lowest(float(least * unit_in_steps)),
                    highest(float(quantity.most * unit_in_steps)),
                    unit,
                    note=f" with {terms.name} at {scale} steps/mm",
                )
                bad.append(Rejection.outside(f"{path}ramp.{field}", value, limits))
        if bad:
            raise Rejected(bad)
        return cls(
            terms,
            kept,
            scale,
            rounded_down(typed(ramp.slew_speed_steps_per_s) / speed, terms.speed.decimals, terms.kept),
            rounded_down(slower(design) / per_mm, terms.acceleration.decimals, terms.kept),
        )

    @property
    def speed_steps_per_s(self) -> Fraction:
        """Its highest speed [steps/s]."""
        return self.terms.kept(self.speed) * self.scale / self.terms.seconds

    @property
    def acceleration_steps_per_s2(self) -> Fraction:
        """How it gains speed, and loses it [steps/s²]."""
        return self.terms.kept(self.acceleration) * self.scale

    def losses(self, design: Design) -> Iterator[str]:
        """Yield what of the design it doesn't keep."""
        yield from self.ramp_losses(design)
        yield from scale_losses(design, self.terms.name, self.scale)

    def ramp_losses(self, design: Design) -> Iterator[str]:
        """Yield what of the design's ramp it doesn't keep, whatever its steps per mm are."""
        yield from losses(design, self.terms.name, starts_at=self.terms.starts_at, works_out=self.terms.works_out)
        yield from rounding("Slew speed", "steps/s", typed(design.ramp.slew_speed_steps_per_s), self.speed_steps_per_s)
        yield from rounding("Acceleration", "steps/s²", slower(design), self.acceleration_steps_per_s2)


def kept_scale(design: Design, name: str, quantity: Quantity, kept: Kept, path: str = "") -> tuple[Fraction, str]:
    """Return the steps per mm of a design as a controller keeps them, and as it is given them, the nearest.

    Raises Rejected when it can't keep them.
    """
    text = nearest(steps_per_unit(design.axis), quantity.decimals)
    if quantity.least <= Fraction(text) <= quantity.most:
        return kept(text), text
    steps = design.axis.steps_per_rev
    ends = f"{float(quantity.least):g} to {float(quantity.most):,.10g}"
    limits = Limits(
        lowest(float(steps / quantity.most)),
        highest(float(steps / quantity.least)),
        "degrees" if design.axis.travel_unit == "deg" else "mm",
        note=f" with {steps:,} steps a turn: {name} keeps {ends} steps/mm",
    )
    raise Rejected([Rejection.outside(f"{path}axis.travel_per_rev", design.axis.travel_per_rev, limits)])


def _scale(design: Design, terms: Terms, path: str) -> tuple[Fraction, str]:
    if terms.steps_per_mm is None:
        exact = steps_per_unit(design.axis)
        return exact, f"{float(exact):.10g}"
    return kept_scale(design, terms.name, terms.steps_per_mm, terms.kept, path)
