"""The integers of a controller without floating point, in which ramps of constant acceleration are computed.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004). With x = p √R, R of (19), the recurrences have no constants left: q = x² in (20), (22) and
(23), and Newton's method works on k x², k being the ramp index v² / 2 a, which grows by exactly 1 a step. Only where
ticks are wanted, x is multiplied by F / √a; that product is not fed back.

x is mantissa / 2³² / 16^exponent. The base is 16 so that x², which is what the steps shift by, moves by whole bytes.
No factor is of more than 32 bits, and no division is needed. The format, its limits and its errors:
docs/decisions/0007-fixed-point-format.md. Austin's recurrence divides by 4 n + 1 and has no place here.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.limit_text import at_least
from stepramp.shapes.constant import ConstantAcceleration

LEAST_INTERVAL_TICKS = 1
MOST_INTERVAL_TICKS = 2**27
"""The slew interval is at least, the initial interval at most so long [ticks]."""
MOST_RAMP_INDEX = 2**24
"""v² / 2 a of the slew speed [steps]."""

MANTISSA_BITS = 32
LEAST_MANTISSA = 15 << 24
MANTISSA_LIMIT = 16 * LEAST_MANTISSA
"""A mantissa is less than this, so that rounding it to fewer bits never carries out of them."""
EXPONENTS = 4
RAMP_INDEX_BITS = 24
MULTIPLIER_LIMIT = (1 << 24) - (1 << 15)
"""A multiplier is less than this, so that its highest byte, rounded, is still a byte."""


class Scaled(NamedTuple):
    """x = mantissa / 2³² / 16^exponent; x is larger where the exponent is smaller."""

    mantissa: int
    exponent: int

    @classmethod
    def of(cls, x: float) -> Self:
        """Return x, 0 < x < 15/16, rounded to its mantissa."""
        exponent = 0
        while round(math.ldexp(x, MANTISSA_BITS + 4 * exponent)) < LEAST_MANTISSA:
            exponent += 1
        return cls(round(math.ldexp(x, MANTISSA_BITS + 4 * exponent)), exponent)


class Output(NamedTuple):
    """How a mantissa becomes an interval: mantissa · multiplier / 2²⁴ is in units of 2^-fraction_bits ticks."""

    multiplier: int
    fraction_bits: int

    @classmethod
    def of(cls, ticks: float) -> Self:
        """Return the output that makes so many ticks of mantissa 2³²: as many whole bytes of fraction as fit.

        An x that would be longer than any interval allowed never occurs: its multiplier is the largest.
        """
        for fraction_bits in (24, 16, 8, 0):
            multiplier = round(math.ldexp(ticks, fraction_bits - 8))
            if multiplier < MULTIPLIER_LIMIT:
                return cls(multiplier, fraction_bits)
        return cls(MULTIPLIER_LIMIT - 1, 0)


@dataclass(frozen=True)
class Format:
    """The constants of one slope, computed in double precision and rounded once."""

    longest: Scaled
    """x of p1 (17)."""
    shortest: Scaled
    """x of pS (18)."""
    first_ramp_index: int
    """k of p1, with RAMP_INDEX_BITS of fraction [steps]."""
    outputs: tuple[Output, ...]
    """One for each exponent."""

    @classmethod
    def of(cls, slope: ConstantAcceleration) -> Self:
        """Return the format of a slope of at least one step. Raises ValueError where there is a refusal."""
        if reason := refusal(slope):
            raise ValueError(reason)
        root = math.sqrt(slope.acceleration)
        return cls(
            longest=Scaled.of(root / math.sqrt(slope.base_speed**2 + 2 * slope.acceleration)),
            shortest=Scaled.of(root / slope.slew_speed),
            first_ramp_index=round(math.ldexp(_ramp_index(slope, slope.base_speed) + 1, RAMP_INDEX_BITS)),
            outputs=tuple(Output.of(slope.timer_hz / root / 16**exponent) for exponent in range(EXPONENTS)),
        )


@dataclass(frozen=True)
class FixedIntervals:
    """The intervals of one side of a ramp, slowest first, and the integers that they are."""

    mantissas: NDArray[np.uint32]
    """Of x after each step, shape (steps,)."""
    exponents: NDArray[np.uint8]
    """Of x after each step, shape (steps,)."""
    intervals: NDArray[np.uint32]
    """[1 / 2^fraction_bits ticks], shape (steps,)."""
    fraction_bits: NDArray[np.uint8]
    """Of each interval, shape (steps,)."""

    @property
    def ticks(self) -> NDArray[np.float64]:
        """The intervals with their fractions, exactly [ticks], shape (steps,)."""
        return np.ldexp(self.intervals.astype(np.float64), -self.fraction_bits.astype(np.int32))

    @property
    def whole_ticks(self) -> NDArray[np.int64]:
        """The intervals in whole ticks: to the nearest, halves up [ticks], shape (steps,)."""
        bits = self.fraction_bits.astype(np.int64)
        return (self.intervals.astype(np.int64) + ((1 << bits) >> 1)) >> bits


def refusal(slope: ConstantAcceleration) -> str | None:
    """Return why a slope can't be computed in this format, as a sentence with what is allowed, else None."""
    if slope.steps < 1:
        return None
    if slope.slew_interval < LEAST_INTERVAL_TICKS:
        fastest = slope.timer_hz / LEAST_INTERVAL_TICKS
        return (
            f"The slew interval is {slope.slew_interval:.6g} ticks; in fixed arithmetic it must be at least "
            f"{LEAST_INTERVAL_TICKS}, which is {fastest:,.6g} steps/s with this timer."
        )
    if slope.initial_interval > MOST_INTERVAL_TICKS:
        return (
            f"The initial interval is {slope.initial_interval:,.0f} ticks; in fixed arithmetic it must be at most "
            f"{MOST_INTERVAL_TICKS:,}: use a slower timer, a higher base speed or a higher acceleration."
        )
    index = _ramp_index(slope, slope.slew_speed)
    if index > MOST_RAMP_INDEX:
        least = at_least(slope.slew_speed**2 / (2 * MOST_RAMP_INDEX))
        return (
            f"The slew speed is {index:,.0f} steps away from rest at {slope.acceleration:,.6g} steps/s², where a step "
            f"changes the interval too little to be computed; in fixed arithmetic it must be at most "
            f"{MOST_RAMP_INDEX:,}, which takes {least} steps/s²."
        )
    return None


def _ramp_index(slope: ConstantAcceleration, speed: float) -> float:
    """Return k = v² / 2 a, the steps from rest to a speed [steps]."""
    return speed**2 / (2 * slope.acceleration)


def started(slope: ConstantAcceleration, first: Scaled) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
    """Return the mantissas and exponents of a side that has only its first x so far, each of shape (steps,)."""
    mantissas, exponents = np.empty(slope.steps, np.uint32), np.empty(slope.steps, np.uint8)
    mantissas[0], exponents[0] = first
    return mantissas, exponents


def intervals_of(form: Format, mantissas: NDArray[np.uint32], exponents: NDArray[np.uint8]) -> FixedIntervals:
    """Return the intervals of a slope's x, in the order given, shape (steps,)."""
    multipliers, fraction_bits = np.array(form.outputs).T
    intervals = np.empty(mantissas.size, np.uint32)
    _output(mantissas, exponents, multipliers, intervals)
    return FixedIntervals(mantissas, exponents, intervals, fraction_bits.astype(np.uint8)[exponents])


def no_intervals() -> FixedIntervals:
    """Return the intervals of a side without steps."""
    none, no_bits = np.empty(0, np.uint32), np.empty(0, np.uint8)
    return FixedIntervals(none, no_bits, none, no_bits)


@compiled
def normal(mantissa, exponent):  # type: ignore[no-untyped-def]  # compiled
    """Return x with its mantissa in range, where its exponent can be changed."""
    if mantissa < LEAST_MANTISSA:
        return mantissa << 4, exponent + 1
    if mantissa >= MANTISSA_LIMIT and exponent > 0:
        return mantissa >> 4, exponent - 1
    return mantissa, exponent


@compiled
def _output(mantissas, exponents, multipliers, intervals):  # type: ignore[no-untyped-def]  # compiled
    for i in range(mantissas.size):
        mantissa, multiplier = np.int64(mantissas[i]), multipliers[exponents[i]]
        rounded = (multiplier + (1 << 15)) >> 16
        intervals[i] = (((mantissa >> 16) * multiplier) >> 8) + ((mantissa >> 8) & 255) * rounded
