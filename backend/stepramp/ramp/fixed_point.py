"""Ramps computed step by step in integers, as a controller without floating point computes them, bit for bit.

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

from stepramp.ramp.compiled import compiled
from stepramp.ramp.kinematics import Slope
from stepramp.ramp.limit_text import at_least

LEAST_INTERVAL_TICKS = 1
MOST_INTERVAL_TICKS = 2**27
"""The slew interval is at least, the initial interval at most so long [ticks]."""
MOST_RAMP_INDEX = 2**24
"""v² / 2 a of the slew speed [steps]."""
MOST_TAYLOR_DECELERATION = 2**18
"""Longest deceleration by (20), (22) or (23) [steps]: they multiply any error by the number of steps."""
GREATEST_COEFFICIENT = 4.0

MANTISSA_BITS = 32
LEAST_MANTISSA = 15 << 24
MANTISSA_LIMIT = 16 * LEAST_MANTISSA
"""A mantissa is less than this, so that rounding it to fewer bits never carries out of them."""
EXPONENTS = 4
COEFFICIENT_BITS = 16
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
    def of(cls, slope: Slope) -> Self:
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


def refusal(slope: Slope) -> str | None:
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


def taylor_deceleration_refusal(slope: Slope) -> str | None:
    """Return why a slope can't be computed downwards by p = p (1 + q + c q²), as refusal does, else None."""
    if slope.steps > MOST_TAYLOR_DECELERATION:
        return (
            f"The deceleration takes {slope.steps:,} steps; in fixed arithmetic this formula must come to rest within "
            f"{MOST_TAYLOR_DECELERATION:,}, beyond which its rounding errors grow to more than 1 %: newton has no such "
            f"limit."
        )
    return refusal(slope)


def fixed_taylor_up(slope: Slope, coefficient: float) -> FixedIntervals:
    """Return an acceleration by p = p (1 + q + c q²), as recurrences.taylor_up [ticks], shape (slope.steps,).

    The coefficient c, from 0 to 4, is rounded to 1/65536. Raises ValueError where there is a refusal, or c is beyond.
    """
    if slope.steps < 1:
        return _no_intervals()
    form, c = Format.of(slope), _whole_coefficient(coefficient)
    mantissas, exponents = _started(slope, form.longest)
    taylor_steps(form.longest, c, True, form.longest, form.shortest, mantissas[1:], exponents[1:])
    return intervals_of(form, mantissas, exponents)


def fixed_taylor_down(slope: Slope, coefficient: float) -> FixedIntervals:
    """Return a deceleration by p = p (1 + q + c q²), as recurrences.taylor_down [ticks], shape (slope.steps,).

    The coefficient is as for fixed_taylor_up. Raises ValueError where taylor_deceleration_refusal gives a reason, or c
    is beyond.
    """
    if slope.steps < 1:
        return _no_intervals()
    if reason := taylor_deceleration_refusal(slope):
        raise ValueError(reason)
    form, c = Format.of(slope), _whole_coefficient(coefficient)
    mantissas, exponents = _started(slope, form.shortest)
    taylor_steps(form.shortest, c, False, form.longest, form.shortest, mantissas, exponents)
    return intervals_of(form, mantissas[::-1], exponents[::-1])


def fixed_newton_up(slope: Slope) -> FixedIntervals:
    """Return an acceleration by Newton's method, as recurrences.newton_up [ticks], shape (slope.steps,).

    Raises ValueError where there is a refusal.
    """
    if slope.steps < 1:
        return _no_intervals()
    form, one = Format.of(slope), 1 << RAMP_INDEX_BITS
    mantissas, exponents = _started(slope, form.longest)
    newton_steps(form.longest, form.first_ramp_index, one, mantissas[1:], exponents[1:])
    return intervals_of(form, mantissas, exponents)


def fixed_newton_down(slope: Slope) -> FixedIntervals:
    """Return a deceleration by Newton's method, as recurrences.newton_down [ticks], shape (slope.steps,).

    Raises ValueError where there is a refusal.
    """
    if slope.steps < 1:
        return _no_intervals()
    form, one = Format.of(slope), 1 << RAMP_INDEX_BITS
    mantissas, exponents = _started(slope, form.shortest)
    newton_steps(form.shortest, form.first_ramp_index + slope.steps * one, -one, mantissas, exponents)
    return intervals_of(form, mantissas[::-1], exponents[::-1])


def _ramp_index(slope: Slope, speed: float) -> float:
    """Return k = v² / 2 a, the steps from rest to a speed [steps]."""
    return speed**2 / (2 * slope.acceleration)


def _whole_coefficient(coefficient: float) -> int:
    if not 0 <= coefficient <= GREATEST_COEFFICIENT:
        raise ValueError(f"The coefficient is {coefficient}; allowed: 0 to {GREATEST_COEFFICIENT:g}.")
    return round(math.ldexp(coefficient, COEFFICIENT_BITS))


def _started(slope: Slope, first: Scaled) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
    mantissas, exponents = np.empty(slope.steps, np.uint32), np.empty(slope.steps, np.uint8)
    mantissas[0], exponents[0] = first
    return mantissas, exponents


def intervals_of(form: Format, mantissas: NDArray[np.uint32], exponents: NDArray[np.uint8]) -> FixedIntervals:
    """Return the intervals of a slope's x, in the order given, shape (steps,)."""
    multipliers, fraction_bits = np.array(form.outputs).T
    intervals = np.empty(mantissas.size, np.uint32)
    _output(mantissas, exponents, multipliers, intervals)
    return FixedIntervals(mantissas, exponents, intervals, fraction_bits.astype(np.uint8)[exponents])


def _no_intervals() -> FixedIntervals:
    none, no_bits = np.empty(0, np.uint32), np.empty(0, np.uint8)
    return FixedIntervals(none, no_bits, none, no_bits)


@compiled
def taylor_steps(state, c, up, longest, shortest, mantissas, exponents):  # type: ignore[no-untyped-def]  # compiled
    """Fill mantissas and exponents with x after each further step by p (1 + q + c q²), both of shape (steps,)."""
    mantissa, exponent = state
    for i in range(mantissas.size):
        change = _taylor_change(mantissa, exponent, c, up)
        mantissa, exponent = normal(mantissa - change if up else mantissa + change, exponent)
        if exponent > shortest[1] or (exponent == shortest[1] and mantissa < shortest[0]):
            mantissa, exponent = shortest
        if exponent < longest[1] or (exponent == longest[1] and mantissa > longest[0]):
            mantissa, exponent = longest
        mantissas[i], exponents[i] = mantissa, exponent


@compiled
def _taylor_change(mantissa, exponent, c, up):  # type: ignore[no-untyped-def]  # compiled
    """Return by how much x (1 + q + c q²) is less or more than x, in units of the mantissa."""
    high, low = mantissa >> 16, (mantissa >> 8) & 255
    q = (high * high + 128) >> 8
    # x³ is high² (high + 3 low) but for terms of low²: 16 bits of x are enough to square. The lowest bit, always set,
    # makes up on average for the bits below it that are cut off.
    x = (high << 8) + 3 * (low | 1)
    # (q + 1/2)² but for the 1/4: the half is what is cut off on average.
    square = (q >> 8) * ((q >> 8) + 1)
    second = (c >> 16) * square + ((c >> 8) & 255) * (square >> 8) + (c & 255) * (square >> 16)
    shift = 8 + 8 * exponent
    half = 1 << (shift - 1)
    second = (second + half) >> shift
    # A factor beyond 24 bits, either way, would take x beyond p1, which is where the clamp leaves it.
    factor = max(q - second, 0) if up else min(q + second, (1 << 24) - 1)
    # x times factor in 2⁻⁴⁰; the lowest bytes are not multiplied.
    product = (x >> 8) * factor + (x & 255) * (factor >> 8)
    return (product + half) >> shift


@compiled
def newton_steps(state, k, gain, mantissas, exponents):  # type: ignore[no-untyped-def]  # compiled
    """Fill mantissas and exponents with x after each further Newton step, both of shape (steps,); k: that of state."""
    mantissa, exponent = state
    for i in range(mantissas.size):
        k = k + gain
        mantissa, exponent = normal(_newton_corrected(mantissa, exponent, k), exponent)
        mantissas[i], exponents[i] = mantissa, exponent


@compiled
def _newton_corrected(mantissa, exponent, k):  # type: ignore[no-untyped-def]  # compiled
    """Return x + x (1/2 - k x²), which is p + p (1 - w p² / F²) / 2, as a mantissa that may have to be normalised."""
    x = (mantissa + (1 << 15)) >> 16
    error = (1 << 31) - newton_product(mantissa, exponent, k)
    change = (x * (abs(error) >> 8)) >> 8
    return (x << 16) + change if error > 0 else (x << 16) - change


@compiled
def newton_product(mantissa, exponent, k):  # type: ignore[no-untyped-def]  # compiled
    """Return k x² in 2⁻³²; k has RAMP_INDEX_BITS of fraction."""
    x = (mantissa + (1 << 15)) >> 16
    square = x * x
    # k in the scale of the exponent, 8 bits whole; its bytes times as much of x² as counts.
    scaled = k >> (8 * exponent)
    return (
        (scaled >> 24) * square
        + ((scaled >> 16) & 255) * (square >> 8)
        + ((scaled >> 8) & 255) * (square >> 16)
        + (scaled & 255) * (square >> 24)
    )


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
