"""austin: the recurrence of Atmel's application note AVR446, with a division a step.

Austin, "Generate stepper-motor speed profiles in real time" (2004). It holds for constant acceleration only, and has no
place in the integers of `fixed`, which do without division.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.method import RampMethod, Style, in_numbers
from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Number
from stepramp.shapes.constant import ConstantAcceleration


def austin_up(slope: ConstantAcceleration, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration by Austin's recurrence, first interval first [ticks], shape (steps,).

    c_n = c_(n-1) - 2 c_(n-1) / (4 n + 1), from c_0 = 0.676 F sqrt(2 / a) at rest. A base speed begins where the slope
    from rest has it, n = v0² / 2 a, with that step's true interval.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        start, first = _austin_start(slope)
        out[0] = number(first)
        _austin(out[0], number(4 * (start + 1) + 1), number(4), number(2), out[1:])
        np.maximum(out, number(slope.slew_interval), out=out)
    return out


def austin_down(slope: ConstantAcceleration, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration by Austin's recurrence, last interval first [ticks], shape (steps,).

    The same recurrence from pS on with n counted up from the negative length of the slope.
    """
    out = np.empty(slope.steps, number)
    if out.size:
        start, _ = _austin_start(slope)
        _austin(number(slope.slew_interval), number(-4 * (start + slope.steps) + 1), number(4), number(2), out)
    return out[::-1]


def _austin_start(slope: ConstantAcceleration) -> tuple[int, float]:
    """Return n of the first interval, and that interval [ticks]."""
    start = round(slope.base_speed**2 / (2 * slope.acceleration))
    unit = slope.timer_hz * math.sqrt(2 / slope.acceleration)
    # 0.676 makes up for what the recurrence's approximation gets wrong at its first step (AVR446, section 2.3.1).
    return start, 0.676 * unit if start == 0 else unit * (math.sqrt(start + 1) - math.sqrt(start))


@compiled
def _austin(interval, divisor, four, two, out):  # type: ignore[no-untyped-def]  # compiled
    for i in range(out.size):
        interval = interval - two * interval / divisor
        divisor = divisor + four
        out[i] = interval


METHOD = RampMethod(
    rank=90,
    label="Austin",
    summary="AVR446",
    help="The ramp of Atmel’s application note AVR446: each interval from the one before with one division.",
    style=Style("#1f86b4", "#7fd6f7", dash=(5, 2, 5, 2, 1.5, 2), file_dash=(4, 1.5, 4, 1.5, 1, 1.5)),
    arithmetics=("float32", "float64"),
    sides=in_numbers(austin_up, austin_down),
    shape=ConstantAcceleration,
)
