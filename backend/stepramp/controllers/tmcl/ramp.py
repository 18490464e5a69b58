"""A module's ramp: eight figures, of which a chip of the TMC5160's kind makes one of six points.

From the starting speed it gains speed with A1 up to V1, with AMAX up to VMAX, and loses it with DMAX down to V1, with
D1 down to the stopping speed. With V1 = 0 there is only AMAX and DMAX: that is what a design asks for. (Data sheet of
the TMC5160, "Ramp Generator".)
"""

import binascii
import math
from collections.abc import Iterator
from dataclasses import Field, astuple, dataclass, fields
from fractions import Fraction

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.losses import losses, rounding
from stepramp.controllers.remark import Remark, quantity
from stepramp.controllers.tmcl.units import Units
from stepramp.design import Design, RampParameters
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import highest, lowest

LEAST_VSTOP = 10
"""In either unit: below, the chip may not come to rest at its target."""
MOST_VMAX = 2**23 - 512
MOST_VSTART = 2**18 - 1
MOST_ACCELERATION = 2**16 - 3
"""[The chip's units]; what is above, a halt uses."""
HALTING_ACCELERATION = 2**16 - 1
"""[The chip's units]"""

CANNOT = (
    "Methods, lookup tables and timers: a module works its intervals out itself.",
    "Shapes other than constant acceleration, and any limit of jerk.",
    "A base speed below 10 steps/s at the end of a move: the module needs a stopping speed.",
    "A deceleration of its own where it is stopped, or runs at a speed: it uses its acceleration then.",
    "Coming to rest by itself when the computer or the cable is gone, unless its serial heartbeat (global parameter "
    "68) is set.",
    "Tracing moves, moving axes along a straight line, and more than the first 4 motors of a module.",
)
"""What no module takes of a design, or does."""


@dataclass(frozen=True)
class TmclRamp:
    """The eight figures of one axis, in its module's units."""

    vmax: int
    amax: int
    dmax: int
    vstart: int
    vstop: int
    a1: int
    v1: int
    d1: int

    @classmethod
    def of(cls, design: Design, units: Units, path: str = "") -> "TmclRamp":
        """Return the figures for a design, rounded down: too much of any would stall the motor.

        path: what a rejection puts before the design's fields. Raises Rejected for what a module can't do: with an
        acceleration of 0 no move would end.
        """
        ramp = with_constant_rates(design, path).ramp
        _check(ramp, units, path)
        gain, loss = (
            units.acceleration_units(rate) for rate in (ramp.acceleration_steps_per_s2, ramp.slowdown_steps_per_s2)
        )
        start = units.speed_units(ramp.base_speed_steps_per_s)
        return cls(
            vmax=units.speed_units(ramp.slew_speed_steps_per_s),
            amax=gain,
            dmax=loss,
            vstart=start,
            vstop=max(start, LEAST_VSTOP),
            a1=gain,
            v1=0,
            # Nor may it be 0 where there is no V1.
            d1=loss,
        )

    @classmethod
    def figures(cls) -> "tuple[Field[int], ...]":
        """Return the figures, of which each has its name; in the order in which they are sent."""
        return fields(cls)

    def of_the_chip(self, units: Units) -> "TmclRamp":
        """Return what the chip gets of it."""
        return TmclRamp(**{name: _to_chip(name, value, units) for name, value in self.named})

    @property
    def named(self) -> Iterator[tuple[str, int]]:
        """The figures by name, by which Parameters has them, too, in the order in which they are sent."""
        return zip((each.name for each in self.figures()), astuple(self), strict=True)

    def lacks(self) -> str | None:
        """Return what of it is 0 and mustn't be; None for nothing."""
        for name, value in self.named:
            if not value and name in ("vmax", "amax", "dmax", "d1", "vstop"):
                return f"{name.upper()} is 0"
            if not value and name == "a1" and self.v1:
                return "A1 is 0"
        return None

    def is_of_a_halt(self, units: Units) -> bool:
        """Whether its acceleration is one that is there for a halt only."""
        return self.of_the_chip(units).amax > MOST_ACCELERATION

    def is_kept_by(self, told: "TmclRamp", units: Units) -> bool:
        """Whether a module may tell these figures as those: of a figure that its chip rounds it tells what that has."""
        return all(
            is_kept(name, sent, back, units) for (name, sent), (_, back) in zip(self.named, told.named, strict=True)
        )

    def steps_to_rest(self, speed_steps_per_s: float, units: Units) -> int:
        """Return how many steps a stop takes from a speed [steps/s], by v² / (2 a), rounded up."""
        rate = float(max(self.amax, 1) * units.acceleration)
        return math.ceil(speed_steps_per_s**2 / (2 * rate))

    @property
    def crc(self) -> int:
        """CRC-16 of the figures: it tells ramps apart."""
        return binascii.crc_hqx(",".join(map(str, astuple(self))).encode(), 0xFFFF)


def is_speed(name: str) -> bool:
    """Whether a figure is a speed; the others are accelerations."""
    return name.startswith("v")


def in_steps(name: str, value: int, units: Units) -> float:
    """Return a figure in the module's units in steps/s, or in steps/s²."""
    return float(value * (units.speed if is_speed(name) else units.acceleration))


def chip_in_steps(name: str, sent: int, units: Units) -> Fraction:
    """Return what the chip gets of a figure in the module's units, in steps/s, or in steps/s²."""
    return _to_chip(name, sent, units) * (units.chip_speed if is_speed(name) else units.chip_acceleration)


def in_units(name: str, in_steps: Fraction, units: Units) -> int:
    """Return a figure in steps/s, or in steps/s², in the module's units, as it tells it."""
    return int(in_steps / (units.speed if is_speed(name) else units.acceleration))


def is_kept(name: str, sent: int, back: int, units: Units) -> bool:
    """Whether a module that was sent a figure may tell it as another one: less by what its chip rounds away.

    Never as 0 but a starting speed: with no acceleration, or no speed, a move doesn't end.
    """
    if sent == back or not (back or name == "vstart"):
        return sent == back
    ours, chip = (units.speed, units.chip_speed) if is_speed(name) else (units.acceleration, units.chip_acceleration)
    return ours != chip and 0 <= sent - back < chip / ours + 1


def tmcl_losses(design: Design, units: Units) -> Iterator[str]:
    """Yield what of a design a module doesn't keep."""
    ramp = with_constant_rates(design).ramp
    speed, rate = typed(ramp.slew_speed_steps_per_s), typed(ramp.acceleration_steps_per_s2)
    down = typed(ramp.slowdown_steps_per_s2)
    start = typed(ramp.base_speed_steps_per_s)
    sent = TmclRamp.of(design, units).of_the_chip(units)
    if sent.vstop > sent.vstart:
        yield Remark(
            "Base speed ", quantity(float(start), "steps/s"), " is not kept at the end of a move: the module needs a "
            "stopping speed, so VSTOP is ", quantity(float(sent.vstop * units.chip_speed), "steps/s"), ".",
        )  # fmt: skip
    else:
        yield from rounding("Base speed", "steps/s", start, sent.vstart * units.chip_speed)
    yield from rounding("Slew speed", "steps/s", speed, sent.vmax * units.chip_speed)
    yield from rounding("Acceleration", "steps/s²", rate, sent.amax * units.chip_acceleration)
    if down != rate:
        yield from rounding("Deceleration", "steps/s²", down, sent.dmax * units.chip_acceleration)
        yield Remark(
            "Deceleration ", quantity(float(down), "steps/s²"), " holds for moves to a position only: a stop, and the "
            "end of a run, slow down with the acceleration, ", quantity(float(rate), "steps/s²"), ".",
        )  # fmt: skip
    yield from losses(design, "the module", has_base_speed=True, has_deceleration=True)


def halting_acceleration(units: Units) -> int:
    """Return the highest acceleration that a chip has, in its module's units."""
    return int(HALTING_ACCELERATION * units.chip_acceleration / units.acceleration)


def _to_chip(name: str, value: int, units: Units) -> int:
    return units.chip_speed_units(value) if is_speed(name) else units.chip_acceleration_units(value)


def _least(ours: Fraction, chip: Fraction) -> Fraction:
    """Return the least figure that a module tells again as more than 0, in steps/s or steps/s².

    ours, chip: the unit of the module, of which it tells whole ones, rounded down, and that of its chip.
    """
    in_chip = math.ceil(ours / chip) * chip
    return math.ceil(in_chip / ours) * ours


def _check(ramp: RampParameters, units: Units, path: str) -> None:
    """Reject speeds and accelerations beyond a module."""
    speeds = {
        "base_speed_steps_per_s": (Fraction(0), MOST_VSTART * units.chip_speed),
        "slew_speed_steps_per_s": (_least(units.speed, units.chip_speed), MOST_VMAX * units.chip_speed),
    }
    least = _least(units.acceleration, units.chip_acceleration)
    rates = {"acceleration_steps_per_s2": (least, MOST_ACCELERATION * units.chip_acceleration)}
    if ramp.deceleration_steps_per_s2 is not None:
        rates["deceleration_steps_per_s2"] = rates["acceleration_steps_per_s2"]
    bad = []
    for unit, ranges in (("steps/s", speeds), ("steps/s²", rates)):
        for field, (low, high) in ranges.items():
            value = getattr(ramp, field)
            if not low <= typed(value) <= high:
                limits = Limits(lowest(float(low)), highest(float(high)), unit, note=" with a TMCL module")
                bad.append(Rejection.outside(f"{path}ramp.{field}", value, limits))
    if bad:
        raise Rejected(bad)
