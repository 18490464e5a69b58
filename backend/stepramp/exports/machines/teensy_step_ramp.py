"""The ramp that TeensyStep 2 plays of a move: of one speed for each 5 ms.

It begins at its pull-in speed v0. Every 5 ms a timer looks how many of the N steps are done, s, and sets the speed to
√(v0² + 2 a s) as long as it speeds up, and to √(v0² + 2 a (N - s - 1)) as it slows down, each rounded down to a whole
step/s: the chip's step timer takes a new interval once the present one is over. Where both meet, and where the highest
speed begins and ends, is worked out before, in whole steps.

Source: how TeensyStep's accelerator for moves and its use of a Teensy's periodic interrupt timers work.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.own_ramp import OwnRamp
from stepramp.design import Design
from stepramp.exports.machines.teensy_step import TeensyFigures, teensy_step_losses
from stepramp.numerics.compiled import compiled

PERIOD_S = 0.005
"""Between two looks, at its usual setting [s]."""
PHASE = (
    "When its two timers begin against each other isn't laid down by TeensyStep: both are taken to begin with the "
    "first step."
)


def own_ramp(design: Design, _steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the figures of an exported sketch, in steps.

    Raises Rejected as the export does.
    """
    figures = TeensyFigures.of(design)
    return OwnRamp(intervals_s(abs(design.move.steps), figures), (*teensy_step_losses(design), PHASE))


def intervals_s(steps: int, figures: TeensyFigures) -> NDArray[np.float64]:
    """Return the wait after each step of a move [s], shape (steps,), steps at least 1; the last is that before it."""
    up = (figures.speed**2 - figures.pull_in**2) // (2 * figures.acceleration)
    middle = steps // 2
    speeds_up, slows_down = (up, 2 * middle - up) if up < middle else (middle, middle)
    waits: NDArray[np.float64] = _intervals(
        steps, speeds_up, slows_down, figures.speed, figures.pull_in, figures.acceleration
    )
    return waits


@compiled
def _intervals(steps, speeds_up, slows_down, fastest, pull_in, rate):  # type: ignore[no-untyped-def]  # compiled
    waits = np.empty(steps, np.float64)
    speed, at, look_at = pull_in, 0.0, PERIOD_S
    for done in range(1, steps + 1):
        # What it saw at its looks since the step before: that one was the last that was done.
        while look_at <= at:
            seen = done - 1
            if seen < speeds_up:
                way = seen
            elif seen < slows_down:
                way = -1
            else:
                way = steps - seen - 1
            if way < 0:
                speed = fastest
            else:
                speed = math.floor(np.float32(math.sqrt(np.float32(pull_in * pull_in + 2 * rate * way))))
            look_at += PERIOD_S
        waits[done - 1] = 1.0 / speed
        at += waits[done - 1]
    if steps > 1:
        waits[steps - 1] = waits[steps - 2]
    return waits
