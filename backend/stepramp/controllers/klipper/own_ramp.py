"""The ramp that Klipper really plays of a design's move.

It plans moves of constant acceleration in real numbers, and makes each step at the instant at which the axis has come
half a step further than the one before, as its iterative solver (`klippy/chelper/itersolve.c`) does. Then it packs
them.
"""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.klipper.compression import packed_s
from stepramp.controllers.klipper.machine import USUAL_CRUISE_RATIO
from stepramp.controllers.klipper.ramp import KLIPPER, losses_in_use
from stepramp.controllers.own_ramp import OwnRamp
from stepramp.controllers.per_mm import PerMm
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection

MOST_STEPS = 4_000_000
EARLY = (
    "Steps come early, by up to 25 µs and no more than half of their interval: Klipper packs them into as few messages "
    "as that allows. It is drawn for a board of 16 MHz."
)


def own_ramp(design: Design, steps_per_mm: float) -> OwnRamp:
    """Return the waits after each step of a design's move, with the limits that a push would send.

    minimum_cruise_ratio is what Klipper comes with. Raises Rejected as a push does, and for a move of more than
    MOST_STEPS.
    """
    steps = abs(design.move.steps)
    if steps > MOST_STEPS:
        limits = Limits(-MOST_STEPS, MOST_STEPS, "steps", is_whole=True, note=" for the ramp that Klipper makes of it")
        raise Rejected([Rejection.outside("move.steps", design.move.steps, limits)])
    given = PerMm.of(design, KLIPPER, own=typed(steps_per_mm))
    instants, lasts_s = instants_s(steps, float(given.speed_steps_per_s), float(given.acceleration_steps_per_s2))
    waits: NDArray[np.float64] = np.diff(packed_s(instants), append=lasts_s)
    return OwnRamp(waits, tuple(_losses(design, given, steps)))


def instants_s(
    steps: int, speed: float, acceleration: float, cruise_ratio: float = USUAL_CRUISE_RATIO
) -> tuple[NDArray[np.float64], float]:
    """Return when each step should be made [s], shape (steps,), and when the axis rests.

    speed [steps/s], acceleration [steps/s²]. cruise_ratio: the least part of the way that is to go at one speed, r: the
    highest speed is min(v, √(a·n·(1 - r))) over n steps, as `klippy/toolhead.py` plans a move from rest to rest.
    """
    top = peak_speed(steps, speed, acceleration, cruise_ratio)
    gain_s, gain = top / acceleration, top**2 / (2 * acceleration)
    lasts_s = 2 * gain_s + (steps - 2 * gain) / top
    # Where the axis is at each step, counted from the nearer end.
    place = np.arange(steps, dtype=np.float64) + 0.5
    near = np.minimum(place, steps - place)
    instant = np.where(near < gain, np.sqrt(2 * near / acceleration), gain_s + (near - gain) / top)
    instant = np.where(place <= steps / 2, instant, lasts_s - instant)
    return instant, lasts_s


def peak_speed(steps: int, speed: float, acceleration: float, cruise_ratio: float) -> float:
    """Return the highest speed that a move reaches [steps/s]."""
    return float(min(speed, np.sqrt(acceleration * steps * (1 - cruise_ratio))))


def _losses(design: Design, given: PerMm, steps: int) -> Iterator[str]:
    yield from losses_in_use(design, given, USUAL_CRUISE_RATIO)
    speed, acceleration = given.speed_steps_per_s, given.acceleration_steps_per_s2
    top = peak_speed(steps, float(speed), float(acceleration), USUAL_CRUISE_RATIO)
    if Fraction(top) < speed:
        yield f"This move stays at {top:,.6g} steps/s with a minimum_cruise_ratio of {USUAL_CRUISE_RATIO:g}."
    yield EARLY
