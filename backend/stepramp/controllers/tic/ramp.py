"""A Tic's ramp: four limits that it computes its steps from. User's Guide (Pololu 0J71), section 5.1."""

import binascii
import math
import struct
from dataclasses import dataclass
from decimal import Decimal

from stepramp.controllers.tic.wire import Write, write
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection

SPEED_SCALE = 10_000
"""A Tic counts speeds in steps a ten thousand seconds …"""
ACCELERATION_SCALE = 100
"""… and accelerations in steps per second a hundred seconds."""
LEAST_SPEED, MOST_SPEED = 7, 500_000_000
"""[Tic's units]; slower ones are none."""
LEAST_ACCELERATION, MOST_ACCELERATION = 100, 2**31 - 1
"""[Tic's units]"""


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
        _check(design, path)
        ramp = design.ramp
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
    """Return base and slew speed [steps/s], acceleration and deceleration [steps/s²] that a design asks for."""
    ramp = design.ramp
    return (
        ramp.base_speed_steps_per_s,
        ramp.slew_speed_steps_per_s,
        ramp.acceleration_steps_per_s2,
        ramp.slowdown_steps_per_s2,
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


def _check(design: Design, path: str) -> None:
    """Reject speeds and accelerations beyond a Tic."""
    ramp = design.ramp
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
