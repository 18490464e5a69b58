"""The ramp that a Tic plays of a design's move, as far as its maker says how.

Said is (User's Guide, Pololu 0J71, section 5.1): speeds change at once up to the starting speed, and by no more than
the acceleration beyond; a speed is a whole number of a Tic's units, and becomes a wait of whole ticks of a timer of
3 MHz, 3·10¹⁰ / speed, rounded down. Not said is at which instants it works the speed out anew. So it is taken to gain
and lose speed evenly, and over each step to have its mean speed there.
"""

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.own_ramp import OwnRamp
from stepramp.controllers.six_points import SixPoints
from stepramp.controllers.tic.ramp import LEAST_SPEED, SPEED_SCALE, TIMER_HZ, TicRamp, tic_losses
from stepramp.design import Design

SLACK = 1e-9
"""So far from it a whole number is taken for itself."""
ASSUMED = (
    "At which instants a Tic works its speed out anew isn't published: that it gains and loses speed evenly is assumed."
)


def own_ramp(design: Design, _steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the figures that a push sends. A Tic counts in steps.

    Raises Rejected as a push does.
    """
    waits = intervals_s(TicRamp.of(design), abs(design.move.steps))
    return OwnRamp(waits, (*tic_losses(design), ASSUMED))


def intervals_s(ramp: TicRamp, steps: int) -> NDArray[np.float64]:
    """Return the wait after each step of a move [s], shape (steps,), steps at least 1."""
    start, fastest, gain, loss = ramp.figures
    evenly = SixPoints(vstart=start, a1=0, v1=0, amax=gain, vmax=fastest, dmax=loss, d1=0, vstop=start)
    units = np.floor(SPEED_SCALE * (1 + SLACK) / evenly.intervals_s(steps))
    return np.floor(TIMER_HZ * SPEED_SCALE / np.clip(units, LEAST_SPEED, ramp.max_speed)) / TIMER_HZ
