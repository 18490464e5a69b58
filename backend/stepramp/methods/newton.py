"""newton: w = v² is kept by addition, and the interval corrected by one Newton step for p² w = F².

With constant acceleration w grows by 2 a a step, with another shape by 2 a(k): what the ramp gains on step k. Every
operation is done in the type of the arguments, left to right, and none is fused with another: in float32 the results
are those of a C program that computes in `float`. The integers, for constant acceleration only, are those of
fixed_point: the recurrence works on k x², k being the ramp index v² / 2 a, which grows by exactly 1 a step.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.fixed_point import (
    RAMP_INDEX_BITS,
    FixedIntervals,
    Format,
    Scaled,
    intervals_of,
    no_intervals,
    normal,
    refusal,
    started,
)
from stepramp.methods.common.method import (
    STEP_BY_STEP,
    Code,
    FixedCode,
    OnChip,
    RampMethod,
    Style,
    step_by_step,
)
from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Number
from stepramp.numerics.slope import Slope
from stepramp.shapes.constant import ConstantAcceleration


def newton_up(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration by Newton's method, first interval first [ticks], shape (slope.steps,).

    w = v² grows by 2 a a step, and p is corrected by one Newton step for p² w = F²: p = p + p (1 - w k p p) / 2 with
    k = 1 / F². p1, the first w and k are rounded once to numbers of the given type.
    """
    out = np.empty(slope.steps, number)
    if out.size and isinstance(slope, ConstantAcceleration):
        first = slope.base_speed**2 + 2 * slope.acceleration
        out[0] = number(slope.initial_interval)
        _newton(out[0], _newton_constants(slope, first, 1, number), out[1:])
    elif out.size:
        squares = np.square(slope.speeds(1, slope.steps, np.float64), dtype=np.float64)
        out[0] = number(slope.timer_hz / math.sqrt(squares[0]))
        _along(slope, out[0], squares, out[1:])
    return out


def newton_down(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by Newton's method, last interval first [ticks], shape (slope.steps,).

    As newton_up from pS on, w shrinking by 2 d a step down to v0² + 2 d in the last one.
    """
    out = np.empty(slope.steps, number)
    if out.size and isinstance(slope, ConstantAcceleration):
        before_first = slope.base_speed**2 + 2 * slope.acceleration * (slope.steps + 1)
        _newton(number(slope.slew_interval), _newton_constants(slope, before_first, -1, number), out)
    elif out.size:
        squares = np.append(slope.speeds(1, slope.steps, np.float64), slope.slew_speed)[::-1] ** 2
        _along(slope, number(slope.slew_interval), squares, out)
    return out[::-1]


def _along(slope: Slope, interval: np.floating, squares: NDArray[np.float64], out: NDArray[np.floating]) -> None:
    """Fill out with the intervals after the first, w growing by what the squares do: 2 a(k) at step k.

    The first square and what they grow by, which a program has in a table, are rounded once to numbers of the type. An
    interval that would be shorter than pS (18) is pS.
    squares: of the speeds, the interval's own first [steps²/s²], shape (steps + 1,).
    """
    number = out.dtype.type
    constants = number(1 / slope.timer_hz**2), number(1), number(0.5), number(slope.slew_interval)
    _newton_along(interval, number(squares[0]), np.diff(squares).astype(number), constants, out)


def fixed_newton_up(slope: ConstantAcceleration) -> FixedIntervals:
    """Return an acceleration by Newton's method, as newton_up [ticks], shape (slope.steps,).

    Raises ValueError where there is a refusal.
    """
    if slope.steps < 1:
        return no_intervals()
    form, one = Format.of(slope), 1 << RAMP_INDEX_BITS
    mantissas, exponents = started(slope, form.longest)
    newton_steps(form.longest, form.first_ramp_index, one, mantissas[1:], exponents[1:])
    return intervals_of(form, mantissas, exponents)


def fixed_newton_down(slope: ConstantAcceleration) -> FixedIntervals:
    """Return a deceleration by Newton's method, as newton_down [ticks], shape (slope.steps,).

    Raises ValueError where there is a refusal.
    """
    if slope.steps < 1:
        return no_intervals()
    form, one = Format.of(slope), 1 << RAMP_INDEX_BITS
    mantissas, exponents = started(slope, form.shortest)
    newton_steps(form.shortest, form.first_ramp_index + slope.steps * one, -one, mantissas, exponents)
    return intervals_of(form, mantissas[::-1], exponents[::-1])


def _newton_constants(slope: ConstantAcceleration, w: float, sign: int, number: Number) -> tuple[np.floating, ...]:
    return number(w), number(sign * 2 * slope.acceleration), number(1 / slope.timer_hz**2), number(1), number(0.5)


@compiled
def _newton_along(interval, w, gains, constants, out):  # type: ignore[no-untyped-def]  # compiled
    k, one, half, shortest = constants
    for i in range(out.size):
        w = w + gains[i]
        interval = interval + interval * (one - w * k * interval * interval) * half
        # Where the speed grows by several times within a step one correction goes far beyond it.
        interval = max(interval, shortest)
        out[i] = interval


@compiled
def _newton(interval, constants, out):  # type: ignore[no-untyped-def]  # compiled
    w, gain, k, one, half = constants
    for i in range(out.size):
        w = w + gain
        interval = interval + interval * (one - w * k * interval * interval) * half
        out[i] = interval


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


def _steps_on_chip(
    x: Scaled, k: int, up: bool, _: Format, mantissas: NDArray[np.uint32], exponents: NDArray[np.uint8]
) -> None:
    one = 1 << RAMP_INDEX_BITS
    newton_steps(x, k, one if up else -one, mantissas, exponents)


def _constants(up: ConstantAcceleration, down: ConstantAcceleration, number: Number) -> dict[str, np.floating]:
    """Return those of the code in floating-point numbers."""
    base = up.base_speed**2
    return {
        "up_w": number(base + 2 * up.acceleration),
        "up_gain": number(2 * up.acceleration),
        "down_w": number(base + 2 * down.acceleration * (down.steps + 1)),
        "down_gain": number(-2 * down.acceleration),
        "k": number(1 / up.timer_hz**2),
        "half": number(0.5),
    }


SIDE = """\
/* One side of the ramp. */
struct ${name}_side {
    uint32_t steps;
    uint32_t given;       /* how many intervals the first one stands for before the formula begins */
    ${name}_number first; /* p1 (17) upwards, pS (18) downwards */
    ${name}_number w;     /* the square of the speed at which that is [steps^2/s^2] */
    ${name}_number gain;  /* what a step adds to it: 2 a upwards, -2 d downwards */
};
static const struct ${name}_side ${name}_up = {$up_steps, 1, $up_first, $up_w, $up_gain};
static const struct ${name}_side ${name}_down = {$down_steps, 0, $slew, $down_w, $down_gain};
static const ${name}_number ${name}_k = $k; /* 1 / F^2 */

/* Where on a side one is. */
struct ${name}_state {
    const struct ${name}_side *side;
    uint32_t given;
    ${name}_number interval, w;
};

static inline struct ${name}_state ${name}_start(const struct ${name}_side *side)
{
    const struct ${name}_state state = {side, side->given, side->first, side->w};
    return state;
}

/* The next interval of a side, in order of time. */
static inline ${name}_number ${name}_step(struct ${name}_state *state)
{
    const ${name}_number p = state->interval;
    if (state->given != 0) {
        state->given--;
        return p;
    }
    state->w = state->w + state->side->gain;
    state->interval = p + p * (1 - state->w * ${name}_k * p * p) * $half;
    return state->interval;
}
"""
"""One side of the ramp in C, in floating-point numbers."""

FIXED_CHANGE = """\
/* x + x (1/2 - k x^2); k = v^2 / 2 a, the steps from rest to here, grows or shrinks by 1 a step. */
static inline void ${name}_recur(struct ${name}_state *state)
{
    const uint64_t one = (uint64_t)1 << 24, half = (uint64_t)1 << 31;
    const uint32_t x = (uint32_t)(((uint64_t)state->x.mantissa + 0x8000) >> 16), square = x * x;
    uint32_t scaled;
    uint64_t product, mantissa;
    state->k = state->side->is_up ? state->k + one : state->k - one;
    scaled = (uint32_t)(state->k >> (8 * state->x.exponent));
    product = (uint64_t)(scaled >> 24) * square + (uint64_t)(scaled >> 16 & 255u) * (square >> 8) +
              (uint64_t)(scaled >> 8 & 255u) * (square >> 16) + (scaled & 255u) * (square >> 24);
    mantissa = (uint64_t)x << 16;
    if (product < half)
        mantissa += x * ((half - product) >> 8) >> 8;
    else
        mantissa -= x * ((product - half) >> 8) >> 8;
    state->x = ${name}_normal(mantissa, state->x.exponent);
}
"""
"""One step of the recurrence in C, in integers."""

METHOD = RampMethod(
    rank=80,
    label="Newton",
    summary="w = v² kept by addition, p corrected by one Newton step",
    help="Keeps w = v² by addition and corrects p with one Newton step. Errors shrink from step to step.",
    style=Style("#0f8a6d", "#2be0a0", dash=(16, 4), file_dash=(12, 3)),
    arithmetics=STEP_BY_STEP,
    sides=step_by_step(newton_up, newton_down, fixed_newton_up, fixed_newton_down),
    code=Code(
        title="p = p + p (1 - w p^2 / F^2) / 2, w = v^2 growing by 2 a a step (newton)",
        label="Newton",
        help="One Newton step a delay: corrects itself, up and down.",
        side=SIDE,
        constants=_constants,
        fixed=FixedCode(
            field="uint64_t k;            /* v^2 / 2 a there, in 2^-24 steps */",
            constants=lambda _, ramp_index: (ramp_index,),
            change=FIXED_CHANGE,
            state_field="uint64_t k;",
            state_value="side->k",
        ),
    ),
    on_chip=OnChip(2, _steps_on_chip, refusal),
    is_shown_at_first=True,
)
