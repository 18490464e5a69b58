"""Ramps computed step by step, in the arithmetic of the target.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004). Every operation is done in the type of the arguments, left to right, and none is fused with
another: in float32 the results are those of a C program that computes in `float`.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from stepramp.ramp.kinematics import Number, initial_interval, slew_interval


@njit(cache=True)
def _first_order(interval, multiplier, one, shortest, longest, out):  # type: ignore[no-untyped-def]  # compiled
    """Fill out with successive intervals of formula (20), p = p (1 + m p p), each kept within [shortest, longest]."""
    for i in range(out.size):
        interval = interval * (one + multiplier * interval * interval)
        interval = min(max(interval, shortest), longest)
        out[i] = interval


def first_order_up(
    timer_hz: float, base_speed: float, slew_speed: float, acceleration: float, steps: int, number: Number
) -> NDArray[np.floating]:
    """Return the intervals of an acceleration by formula (20) [ticks], shape (steps,), first interval first.

    The first is p1 (17); each later one is p (1 + m p p) with m = -R = -a / F² (19), and pS (18) when it would be
    shorter. p1, pS and m are computed in double precision and rounded once to numbers of the given type.
    """
    out = np.empty(steps, number)
    if steps:
        p1 = number(initial_interval(timer_hz, base_speed, acceleration))
        ps = number(slew_interval(timer_hz, slew_speed))
        m = number(-acceleration / timer_hz**2)
        out[0] = p1
        _first_order(p1, m, number(1), ps, p1, out[1:])
    return out


def first_order_down(
    timer_hz: float, base_speed: float, slew_speed: float, deceleration: float, steps: int, number: Number
) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by formula (20) [ticks], shape (steps,), last interval first.

    From pS (18) on, each interval is p (1 + m p p) with m = +R = d / F² (19), and p1 (17) when it would be longer:
    the first step of the deceleration is already one recalculation away from pS.
    """
    out = np.empty(steps, number)
    if steps:
        p1 = number(initial_interval(timer_hz, base_speed, deceleration))
        ps = number(slew_interval(timer_hz, slew_speed))
        _first_order(ps, number(deceleration / timer_hz**2), number(1), ps, p1, out)
    return out[::-1]
