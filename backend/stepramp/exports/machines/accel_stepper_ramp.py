"""The ramp that AccelStepper 1.64 plays of a move from rest: the recurrence of David Austin's article, in float.

With c0 = 0.676 · √(2/a) · 10⁶ µs each next wait is c - 2 c / (4 n + 1), no shorter than that of the highest speed. It
slows down, with n negative, once v² / (2 a) steps, rounded down, are all that is left. Waits are whole µs, rounded
down. The first step is due c0 after the last one of the move before, so after a rest it is made at once: the wait c0
is skipped, and the first that is there is 0.4 · c0 shorter. An AVR's double is a float, as everything here.

Source: D. Austin, "Generate stepper-motor speed profiles in real time" (2004), and how AccelStepper says it uses it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.own_ramp import OwnRamp
from stepramp.design import Design
from stepramp.exports.machines.accel_stepper import accel_stepper_losses, figures_of
from stepramp.numerics.compiled import compiled
from stepramp.units import MICROSECONDS_PER_SECOND

FIRST_FACTOR = 0.676
"""Of the exact first interval."""
POLLED = "Between two polls, and on an Uno up to 4 µs of its clock, each step may come later: that isn't counted here."


def own_ramp(design: Design, _steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the figures of an exported sketch, in steps."""
    speed, rate = figures_of(design)
    waits = intervals_us(abs(design.move.steps), speed, rate) / MICROSECONDS_PER_SECOND
    return OwnRamp(waits, (*accel_stepper_losses(design), POLLED))


def intervals_us(steps: int, speed: np.float32, rate: np.float32) -> NDArray[np.int64]:
    """Return the wait after each step of a move [µs], shape (steps,), steps at least 1; the last is that before it.

    speed: the highest [steps/s]. rate: the acceleration [steps/s²].
    """
    million, two = np.float32(MICROSECONDS_PER_SECOND), np.float32(2)
    first = np.float32(np.float32(FIRST_FACTOR) * np.sqrt(two / rate)) * million
    waits: NDArray[np.int64] = _intervals(steps, first, million / speed, rate)
    return waits


@compiled
def _intervals(steps, first, shortest, rate):  # type: ignore[no-untyped-def]  # compiled
    one, two, four, million = np.float32(1), np.float32(2), np.float32(4), np.float32(1e6)
    waits = np.empty(steps, np.int64)
    wait, place = first, 1
    waits[0] = math.floor(wait)
    for done in range(1, steps):
        speed = million / wait
        to_stop = math.floor(speed * speed / (two * rate))
        left = steps - done
        if place > 0 and to_stop >= left:
            place = -to_stop
        elif place < 0 and to_stop < left:
            place = -place
        wait = first if place == 0 else max(wait - two * wait / (four * np.float32(place) + one), shortest)
        place += 1
        waits[done - 1] = math.floor(wait)
        waits[done] = waits[done - 1]
    return waits
