"""p (1 + q + c q²), step by step: the first terms of a Taylor series, in floating-point numbers, in integers and in C.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004). They hold for constant acceleration only. Every operation is done in the type of the arguments,
left to right, and none is fused with another: in float32 the results are those of a C program that computes in `float`.
The integers are those of fixed_point.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.fixed_point import (
    EXPONENTS,
    LEAST_MANTISSA,
    FixedIntervals,
    Format,
    Scaled,
    intervals_of,
    no_intervals,
    normal,
    refusal,
    started,
)
from stepramp.methods.common.method import Code, FixedCode, OnChip, Sides, TunedFor, step_by_step
from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Arithmetic, Number
from stepramp.shapes.constant import ConstantAcceleration

MOST_TAYLOR_DECELERATION = 2**18
"""Longest deceleration by (20), (22) or (23) [steps]: they multiply any error by the number of steps."""
GREATEST_COEFFICIENT = 4.0
COEFFICIENT_BITS = 16
SHORTEST_OF_ALL = Scaled(LEAST_MANTISSA, EXPONENTS - 1)


def taylor_sides(coefficient: float) -> Callable[[Arithmetic, TunedFor], Sides]:
    """Return both sides of a ramp with one c, in any arithmetic."""
    return step_by_step(
        lambda slope, number: taylor_up(slope, coefficient, number),
        lambda slope, number: taylor_down(slope, coefficient, number),
        lambda slope: fixed_taylor_up(slope, coefficient),
        lambda slope: fixed_taylor_down(slope, coefficient),
    )


def taylor_on_chip(number: int, coefficient: float) -> OnChip:
    """Return how a controller computes the formula with one c, under a number in ramp images."""
    c = _whole_coefficient(coefficient)

    def steps(
        x: Scaled, _: int, up: bool, form: Format, mantissas: NDArray[np.uint32], exponents: NDArray[np.uint8]
    ) -> None:
        # Upwards x isn't limited, only its interval is.
        taylor_steps(x, c, up, form.longest, SHORTEST_OF_ALL, mantissas, exponents)

    return OnChip(number, steps, taylor_deceleration_refusal)


def taylor_code(coefficient: float, title: str, series: str, label: str, help: str) -> Code:
    """Return the formula in C; series: 1 + q + c q², where $coefficient is c in the numbers of the ramp."""

    def constants(up: ConstantAcceleration, down: ConstantAcceleration, number: Number) -> dict[str, np.floating]:
        return {
            "up_longest": number(up.initial_interval),
            "down_longest": number(down.initial_interval),
            "up_multiplier": number(-up.multiplier),
            "down_multiplier": number(down.multiplier),
            "coefficient": number(coefficient),
        }

    return Code(
        title,
        label,
        help,
        side=SIDE.replace("$series", series),
        constants=constants,
        fixed=FixedCode(
            field="struct ${name}_x shortest, longest; /* those of pS and of p1 */",
            constants=lambda form, _: (form.shortest, form.longest),
            change=FIXED_CHANGE.replace("$coefficient", str(_whole_coefficient(coefficient))),
        ),
    )


def taylor_up(slope: ConstantAcceleration, coefficient: float, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration by p = p (1 + q + c q²), q = m p² [ticks], shape (slope.steps,).

    Formula (20) with c = 0, (22) with c = 1.5, (23) with c = 1. The first interval is p1 (17); m = -R = -a / F² (19);
    an interval that would be shorter than pS (18) is pS. p1, pS and m are computed in double precision and rounded
    once to numbers of the given type.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        p1, ps = number(slope.initial_interval), number(slope.slew_interval)
        out[0] = p1
        _taylor(p1, number(-slope.multiplier), number(1), number(coefficient), ps, p1, out[1:])
    return out


def taylor_down(slope: ConstantAcceleration, coefficient: float, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by p = p (1 + q + c q²), last interval first [ticks], shape (steps,).

    From pS (18) on with m = +R = d / F²; an interval that would be longer than p1 (17) is p1. The first step of the
    deceleration is already one recalculation away from pS.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        p1, ps = number(slope.initial_interval), number(slope.slew_interval)
        _taylor(ps, number(slope.multiplier), number(1), number(coefficient), ps, p1, out)
    return out[::-1]


def taylor_deceleration_refusal(slope: ConstantAcceleration) -> str | None:
    """Return why a slope can't be computed downwards by p = p (1 + q + c q²), as refusal does, else None."""
    if slope.steps > MOST_TAYLOR_DECELERATION:
        return (
            f"The deceleration takes {slope.steps:,} steps; in fixed arithmetic this formula must come to rest within "
            f"{MOST_TAYLOR_DECELERATION:,}, beyond which its rounding errors grow to more than 1 %: newton has no such "
            f"limit."
        )
    return refusal(slope)


def fixed_taylor_up(slope: ConstantAcceleration, coefficient: float) -> FixedIntervals:
    """Return an acceleration by p = p (1 + q + c q²), as taylor_up [ticks], shape (slope.steps,).

    The coefficient c, from 0 to 4, is rounded to 1/65536. Raises ValueError where there is a refusal, or c is beyond.
    """
    if slope.steps < 1:
        return no_intervals()
    form, c = Format.of(slope), _whole_coefficient(coefficient)
    mantissas, exponents = started(slope, form.longest)
    taylor_steps(form.longest, c, True, form.longest, form.shortest, mantissas[1:], exponents[1:])
    return intervals_of(form, mantissas, exponents)


def fixed_taylor_down(slope: ConstantAcceleration, coefficient: float) -> FixedIntervals:
    """Return a deceleration by p = p (1 + q + c q²), as taylor_down [ticks], shape (slope.steps,).

    The coefficient is as for fixed_taylor_up. Raises ValueError where taylor_deceleration_refusal gives a reason, or c
    is beyond.
    """
    if slope.steps < 1:
        return no_intervals()
    if reason := taylor_deceleration_refusal(slope):
        raise ValueError(reason)
    form, c = Format.of(slope), _whole_coefficient(coefficient)
    mantissas, exponents = started(slope, form.shortest)
    taylor_steps(form.shortest, c, False, form.longest, form.shortest, mantissas, exponents)
    return intervals_of(form, mantissas[::-1], exponents[::-1])


def _whole_coefficient(coefficient: float) -> int:
    if not 0 <= coefficient <= GREATEST_COEFFICIENT:
        raise ValueError(f"The coefficient is {coefficient}; allowed: 0 to {GREATEST_COEFFICIENT:g}.")
    return round(math.ldexp(coefficient, COEFFICIENT_BITS))


@compiled
def _taylor(interval, multiplier, one, coefficient, shortest, longest, out):  # type: ignore[no-untyped-def]  # compiled
    for i in range(out.size):
        q = multiplier * interval * interval
        interval = interval * (one + q + coefficient * q * q)
        interval = min(max(interval, shortest), longest)
        out[i] = interval


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


SIDE = """\
/* One side of the ramp. */
struct ${name}_side {
    uint32_t steps;
    uint32_t given;              /* how many intervals the first one stands for before the formula begins */
    ${name}_number first;        /* p1 (17) upwards, pS (18) downwards */
    ${name}_number multiplier;   /* m: -R upwards, R downwards (19) */
    ${name}_number shortest;     /* pS */
    ${name}_number longest;      /* p1 */
};
static const struct ${name}_side ${name}_up = {$up_steps, 1, $up_first, $up_multiplier, $slew, $up_longest};
static const struct ${name}_side ${name}_down = {$down_steps, 0, $slew, $down_multiplier, $slew, $down_longest};

/* Where on a side one is. */
struct ${name}_state {
    const struct ${name}_side *side;
    uint32_t given;
    ${name}_number interval;
};

static inline struct ${name}_state ${name}_start(const struct ${name}_side *side)
{
    const struct ${name}_state state = {side, side->given, side->first};
    return state;
}

/* The next interval of a side, in order of time. */
static inline ${name}_number ${name}_step(struct ${name}_state *state)
{
    const struct ${name}_side *const side = state->side;
    const ${name}_number p = state->interval, q = side->multiplier * p * p;
    if (state->given != 0) {
        state->given--;
        return p;
    }
    state->interval = p * ($series);
    if (state->interval < side->shortest) state->interval = side->shortest;
    if (state->interval > side->longest) state->interval = side->longest;
    return state->interval;
}
"""
"""One side of the ramp in C, in floating-point numbers."""

FIXED_CHANGE = """\
static inline int ${name}_is_shorter(struct ${name}_x x, struct ${name}_x other)
{
    return x.exponent > other.exponent || (x.exponent == other.exponent && x.mantissa < other.mantissa);
}

/* x (1 + q + c q^2) with c in 2^-16, q being subtracted upwards; kept between pS and p1. */
static inline void ${name}_recur(struct ${name}_state *state)
{
    const struct ${name}_side *const side = state->side;
    const struct ${name}_x from = state->x;
    const uint32_t c = $coefficient, high = from.mantissa >> 16, low = from.mantissa >> 8 & 255u;
    const uint32_t q = (high * high + 128) >> 8, x = (high << 8) + 3 * (low | 1u);
    const uint32_t square = (q >> 8) * ((q >> 8) + 1);
    const unsigned shift = 8u + 8u * from.exponent;
    const uint64_t half = (uint64_t)1 << (shift - 1);
    const uint64_t cq2 =
        (uint64_t)(c >> 16) * square + (uint64_t)(c >> 8 & 255u) * (square >> 8) + (c & 255u) * (square >> 16);
    const uint64_t second = (cq2 + half) >> shift;
    uint64_t factor, change;
    if (side->is_up)
        factor = q > second ? q - second : 0;
    else
        factor = q + second < 0xFFFFFF ? q + second : 0xFFFFFF;
    change = ((x >> 8) * factor + (x & 255u) * (factor >> 8) + half) >> shift;
    state->x = ${name}_normal(side->is_up ? from.mantissa - change : from.mantissa + change, from.exponent);
    if (${name}_is_shorter(state->x, side->shortest)) state->x = side->shortest;
    if (${name}_is_shorter(side->longest, state->x)) state->x = side->longest;
}
"""
"""One step of the recurrence in C, in integers."""
