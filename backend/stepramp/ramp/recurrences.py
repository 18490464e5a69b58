"""Ramps computed step by step, in the arithmetic of the target.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004). Every operation is done in the type of the arguments, left to right, and none is fused with
another: in float32 the results are those of a C program that computes in `float`.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.ramp.compiled import compiled
from stepramp.ramp.kinematics import Number, Slope

FIRST_ORDER, SECOND_ORDER, COMPROMISE = 0.0, 1.5, 1.0
"""c of p (1 + q + c q²) for formulas (20), (22) and (23)."""


def taylor_up(slope: Slope, coefficient: float, number: Number) -> NDArray[np.floating]:
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


def taylor_down(slope: Slope, coefficient: float, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by p = p (1 + q + c q²), last interval first [ticks], shape (steps,).

    From pS (18) on with m = +R = d / F²; an interval that would be longer than p1 (17) is p1. The first step of the
    deceleration is already one recalculation away from pS.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        p1, ps = number(slope.initial_interval), number(slope.slew_interval)
        _taylor(ps, number(slope.multiplier), number(1), number(coefficient), ps, p1, out)
    return out[::-1]


def newton_up(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration by Newton's method, first interval first [ticks], shape (slope.steps,).

    w = v² grows by 2 a a step, and p is corrected by one Newton step for p² w = F²: p = p + p (1 - w k p p) / 2 with
    k = 1 / F². p1, the first w and k are rounded once to numbers of the given type.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        first = slope.base_speed**2 + 2 * slope.acceleration
        out[0] = number(slope.initial_interval)
        _newton(out[0], _newton_constants(slope, first, 1, number), out[1:])
    return out


def newton_down(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by Newton's method, last interval first [ticks], shape (slope.steps,).

    As newton_up from pS on, w shrinking by 2 d a step down to v0² + 2 d in the last one.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        before_first = slope.base_speed**2 + 2 * slope.acceleration * (slope.steps + 1)
        _newton(number(slope.slew_interval), _newton_constants(slope, before_first, -1, number), out)
    return out[::-1]


def austin_up(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration by Austin's recurrence, first interval first [ticks], shape (steps,).

    Austin, "Generate stepper-motor speed profiles in real time" (2004), Atmel AVR446: c_n = c_(n-1) - 2 c_(n-1) /
    (4 n + 1), from c_0 = 0.676 F sqrt(2 / a) at rest. A base speed begins where the slope from rest has it,
    n = v0² / 2 a, with that step's true interval.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        start, first = _austin_start(slope)
        out[0] = number(first)
        _austin(out[0], number(4 * (start + 1) + 1), number(4), number(2), out[1:])
        np.maximum(out, number(slope.slew_interval), out=out)
    return out


def austin_down(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by Austin's recurrence, last interval first [ticks], shape (steps,).

    The same recurrence from pS on with n counted up from the negative length of the slope.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        start, _ = _austin_start(slope)
        _austin(number(slope.slew_interval), number(-4 * (start + slope.steps) + 1), number(4), number(2), out)
    return out[::-1]


def _newton_constants(slope: Slope, w: float, sign: int, number: Number) -> tuple[np.floating, ...]:
    return number(w), number(sign * 2 * slope.acceleration), number(1 / slope.timer_hz**2), number(1), number(0.5)


def _austin_start(slope: Slope) -> tuple[int, float]:
    """Return n of the first interval, and that interval [ticks]."""
    start = round(slope.base_speed**2 / (2 * slope.acceleration))
    unit = slope.timer_hz * math.sqrt(2 / slope.acceleration)
    # 0.676 makes up for what the recurrence's approximation gets wrong at its first step (AVR446, section 2.3.1).
    return start, 0.676 * unit if start == 0 else unit * (math.sqrt(start + 1) - math.sqrt(start))


@compiled
def _taylor(interval, multiplier, one, coefficient, shortest, longest, out):  # type: ignore[no-untyped-def]  # compiled
    for i in range(out.size):
        q = multiplier * interval * interval
        interval = interval * (one + q + coefficient * q * q)
        interval = min(max(interval, shortest), longest)
        out[i] = interval


@compiled
def _newton(interval, constants, out):  # type: ignore[no-untyped-def]  # compiled
    w, gain, k, one, half = constants
    for i in range(out.size):
        w = w + gain
        interval = interval + interval * (one - w * k * interval * interval) * half
        out[i] = interval


@compiled
def _austin(interval, divisor, four, two, out):  # type: ignore[no-untyped-def]  # compiled
    for i in range(out.size):
        interval = interval - two * interval / divisor
        divisor = divisor + four
        out[i] = interval
