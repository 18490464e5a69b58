"""A Tic's ramp: four limits that it computes its steps from. User's Guide (Pololu 0J71), section 5.1."""

import binascii
import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.losses import losses, rounding
from stepramp.controllers.microsteps import steps
from stepramp.controllers.remark import Remark, quantity
from stepramp.controllers.tic.wire import Write, write
from stepramp.design import Design, RampParameters
from stepramp.errors import Limits, Rejected, Rejection, StepUnit

SPEED_SCALE = 10_000
"""A Tic counts speeds in steps a ten thousand seconds …"""
ACCELERATION_SCALE = 100
"""… and accelerations in steps per second a hundred seconds."""
LEAST_SPEED, MOST_SPEED = 7, 500_000_000
"""[Tic's units]; slower ones are none."""
LEAST_ACCELERATION, MOST_ACCELERATION = 100, 2**31 - 1
"""[Tic's units]"""
TIMER_HZ = 3_000_000
"""Its timer ticks so often; it takes whole ticks for a step, rounded down."""
LEAST_TOLD_FASTER = 1e-3
"""By so much faster than asked, relatively, it is worth a sentence."""
SPEED_UNIT, ACCELERATION_UNIT = "steps/10,000 s", "steps/100 s²"
"""What a Tic counts speeds and accelerations in."""

RATES = ("Acceleration", "Deceleration")

CANNOT = (
    "Methods, lookup tables and timers: a Tic works its intervals out itself.",
    "Shapes other than constant acceleration, and any limit of jerk.",
    "Storing a ramp: a Tic takes settings to keep over its USB port only, and forgets what it is sent here when it is "
    "reset or switched off.",
    "Speeds near 50,000 steps/s as asked: it takes whole thirds of a µs for a step, up to 1.66 % too fast.",
    "Tracing moves, and moving more than one motor.",
)
"""What no Tic takes of a design, or does."""


@dataclass(frozen=True)
class TicRamp:
    """The four limits, in the Tic's units, in the order of its memory."""

    starting_speed: int
    """Up to it speeds change at once."""
    max_speed: int
    max_deceleration: int
    max_acceleration: int

    @classmethod
    def told(cls, starting_speed: int, max_speed: int, max_deceleration: int, max_acceleration: int) -> "TicRamp":
        """Return the limits that a Tic tells: in its settings a deceleration of 0 is the same as the acceleration.

        Raises ValueError for what no Tic tells.
        """
        ramp = cls(starting_speed, max_speed, max_deceleration or max_acceleration, max_acceleration)
        speeds, rates = (starting_speed, max_speed), (ramp.max_deceleration, max_acceleration)
        if max(speeds) > MOST_SPEED or not all(LEAST_ACCELERATION <= rate <= MOST_ACCELERATION for rate in rates):
            raise ValueError("limits that a Tic can't have")
        return ramp

    @classmethod
    def of(cls, design: Design, path: str = "") -> "TicRamp":
        """Return the limits for a design, rounded down: too much of any would stall the motor.

        path: what a rejection puts before the design's fields. Raises Rejected for what a Tic can't do.
        """
        ramp = with_constant_rates(design, path).ramp
        _check(ramp, path)
        return cls(
            starting_speed=speed_units(ramp.base_speed_steps_per_s),
            max_speed=speed_units(ramp.slew_speed_steps_per_s),
            max_deceleration=_acceleration_units(ramp.slowdown_steps_per_s2),
            max_acceleration=_acceleration_units(ramp.acceleration_steps_per_s2),
        )

    @property
    def commands(self) -> tuple[bytes, ...]:
        """What has a Tic use it, until it is reset or switched off."""
        return (
            write(Write.STARTING_SPEED, self.starting_speed),
            write(Write.MAX_SPEED, self.max_speed),
            write(Write.MAX_ACCELERATION, self.max_acceleration),
            write(Write.MAX_DECELERATION, self.max_deceleration),
        )

    @property
    def units(self) -> tuple[int, int, int, int]:
        """The limits in the Tic's units, in the order of figures_of."""
        return self.starting_speed, self.max_speed, self.max_acceleration, self.max_deceleration

    @property
    def crc(self) -> int:
        """CRC-16 of the sixteen bytes that it takes in the Tic's memory: it tells ramps apart."""
        limits = (self.starting_speed, self.max_speed, self.max_deceleration, self.max_acceleration)
        return binascii.crc_hqx(struct.pack("<4I", *limits), 0xFFFF)

    @property
    def figures(self) -> tuple[float, float, float, float]:
        """The limits as figures_of has them."""
        return (
            steps_per_s(self.starting_speed),
            steps_per_s(self.max_speed),
            self.max_acceleration / ACCELERATION_SCALE,
            self.max_deceleration / ACCELERATION_SCALE,
        )

    def steps_to_rest(self, speed_steps_per_s: float) -> int:
        """Return how many steps slowing down from a speed [steps/s] takes, by (v² - v0²) / (2 d), rounded up."""
        start, rate = steps_per_s(self.starting_speed), self.max_deceleration / ACCELERATION_SCALE
        return math.ceil(max(0.0, speed_steps_per_s**2 - start**2) / (2 * rate))


def figures_of(design: Design) -> tuple[float, float, float, float]:
    """Return base and slew speed [steps/s], acceleration and deceleration [steps/s²] that a design gives."""
    ramp = with_constant_rates(design).ramp
    return (
        ramp.base_speed_steps_per_s,
        ramp.slew_speed_steps_per_s,
        ramp.acceleration_steps_per_s2,
        ramp.slowdown_steps_per_s2,
    )


def ticks_of(speed_units: int) -> int:
    """Return how many ticks of TIMER_HZ a Tic waits for a step at a speed in its units, above LEAST_SPEED."""
    return TIMER_HZ * SPEED_SCALE // speed_units


def tic_losses(design: Design) -> Iterator[str]:
    """Yield what of a design a Tic doesn't keep. Raises Rejected for what it can't take."""
    ramp = TicRamp.of(design)
    yield from losses(design, "a Tic", has_base_speed=True, has_deceleration=True)
    labels: tuple[tuple[str, StepUnit], ...] = (
        ("Base speed", "steps/s"), ("Slew speed", "steps/s"), (RATES[0], "steps/s²"), (RATES[1], "steps/s²")
    )  # fmt: skip
    for (label, unit), asked, kept in zip(labels, figures_of(design), ramp.figures, strict=True):
        if label != RATES[1] or design.ramp.deceleration_steps_per_s2 is not None:
            yield from rounding(label, unit, typed(asked), typed(kept))
    ticks = ticks_of(max(LEAST_SPEED, ramp.max_speed))
    if TIMER_HZ / ticks > steps_per_s(ramp.max_speed) * (1 + LEAST_TOLD_FASTER):
        yield Remark(
            "Slew speed ", quantity(design.ramp.slew_speed_steps_per_s, "steps/s"), " comes out as ",
            quantity(TIMER_HZ / ticks, "steps/s", 7), f": a Tic takes {ticks} whole thirds of a µs for a step, rounded "
            "down.",
        )  # fmt: skip


def other_steps(design: Design, microsteps: int) -> Iterator[str]:
    """Yield that a Tic is set to other microsteps, for each full step, than a design has."""
    if design.axis.microsteps != microsteps:
        yield (
            f"The design has {steps(design.axis.microsteps)} a full step, the Tic {microsteps:,} (its step mode): "
            "its steps are sent as microsteps of the Tic."
        )


def speed_units(steps_per_s: float) -> int:
    """Return a speed [steps/s] in the Tic's units, towards 0."""
    return _scaled(steps_per_s, SPEED_SCALE)


def steps_per_s(units: int) -> float:
    """Return a speed in the Tic's units in steps/s."""
    return units / SPEED_SCALE


def _acceleration_units(steps_per_s2: float) -> int:
    return _scaled(steps_per_s2, ACCELERATION_SCALE)


def _scaled(value: float, scale: int) -> int:
    """Return a value times a scale towards 0, of the decimal number that people typed: 0.29 · 100 is 29."""
    return int(Decimal(str(value)) * scale)


def _check(ramp: RampParameters, path: str) -> None:
    """Reject speeds and accelerations beyond a Tic."""
    speeds = {"base_speed_steps_per_s": ramp.base_speed_steps_per_s}
    speeds["slew_speed_steps_per_s"] = ramp.slew_speed_steps_per_s
    rates = {"acceleration_steps_per_s2": ramp.acceleration_steps_per_s2}
    if ramp.deceleration_steps_per_s2 is not None:
        rates["deceleration_steps_per_s2"] = ramp.deceleration_steps_per_s2
    fastest = Limits(highest=steps_per_s(MOST_SPEED), unit="steps/s", note=" with a Tic")
    lowest, highest = LEAST_ACCELERATION / ACCELERATION_SCALE, MOST_ACCELERATION / ACCELERATION_SCALE
    between = Limits(lowest, highest, "steps/s²", note=" with a Tic")
    bad = [
        Rejection.outside(f"{path}ramp.{field}", speed, fastest)
        for field, speed in speeds.items()
        if speed > steps_per_s(MOST_SPEED)
    ]
    bad += [
        Rejection.outside(f"{path}ramp.{field}", rate, between)
        for field, rate in rates.items()
        if not lowest <= rate <= highest
    ]
    if bad:
        raise Rejected(bad)
