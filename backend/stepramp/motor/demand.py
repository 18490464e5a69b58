"""What a design's ramp asks of its motor over the speed: of a lookup table what its rows ask for, that are played.

Both the verdict and the curves of torque have it from here.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.motor.limits import required_nm
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.slope import Slope
from stepramp.ramp.move import split
from stepramp.ramp.plan import real_ramp
from stepramp.ramp.slopes import playable_slopes_of

Side = Literal["up", "down"]
SIDES: tuple[Side, Side] = "up", "down"

MOST_PLACES = 4096
"""So many steps of a side are looked at."""
JUST_BEYOND = 1 + 1e-12
"""Behind a row's speed begins what the next one asks for."""


@dataclass(frozen=True)
class Demand:
    """What a side of a ramp asks for, linear between its speeds; arrays of shape (n,)."""

    side: Side
    speeds: NDArray[np.float64]
    """Increasing [steps/s]."""
    torques_nm: NDArray[np.float64]
    """With load and friction."""


def demands_of(design: Design, train: DriveTrain, fastest: float = math.inf) -> list[Demand]:
    """Return what both sides of what a design plays ask for, as far as they have steps.

    fastest: of a slope what comes to no more [steps/s]; of a table it is always what the move comes to. Raises Rejected
    as playable_slopes_of does, and for a table as real_ramp.
    """
    if design.method.plays_table:
        return _of_rows(design, train)
    demands = []
    for side, slope in zip(SIDES, playable_slopes_of(design), strict=True):
        if slope.steps < 1:
            continue  # The first pulse is at slew speed: what that asks for the rotor says.
        speeds, accelerations = _steepness(slope)
        is_played = speeds <= fastest
        demands.append(Demand(side, speeds[is_played], _asked(train, side, accelerations[is_played])))
    return demands


def _asked(train: DriveTrain, side: Side, gains: NDArray[np.float64]) -> NDArray[np.float64]:
    return required_nm(train, gains if side == "up" else -gains)


def _of_rows(design: Design, train: DriveTrain) -> list[Demand]:
    real, steps = real_ramp(design), abs(design.move.steps)
    up, down = split(real, steps)
    slew = [real.slew] if steps > up + down else []
    intervals = np.append(real.up[:up], slew), np.append(real.down[:down], slew)
    both = [(side, design.timer.frequency_hz / each) for side, each in zip(SIDES, intervals, strict=True)]
    return [_of_side(side, speeds, train) for side, speeds in both if speeds.size]


def _of_side(side: Side, speeds: NDArray[np.float64], train: DriveTrain) -> Demand:
    """Return what a side of a table asks for, whose steps have such speeds, the slow end first.

    A row begins at once: what it asks for is felt over a full step, as the makers of gauges' motors have it, at all
    speeds on the way.
    """
    stride = min(max(1, round(train.steps_per_full_step)), max(1, speeds.size - 1))
    pairs = np.stack((speeds[:-stride], speeds[stride:]))
    pairs = np.unique(pairs[:, pairs[0] != pairs[1]], axis=1)
    ends = np.unique(np.append(pairs, speeds[[0, -1]]))
    torques = required_nm(train, np.zeros(ends.size))  # From the end before to each.
    asked = _asked(train, side, (pairs[1] ** 2 - pairs[0] ** 2) / (2 * stride))
    for low, high, torque in zip(*np.searchsorted(ends, np.sort(pairs, axis=0)) + 1, asked, strict=True):
        torques[low:high] = np.maximum(torques[low:high], torque)
    if ends.size == 1:
        return Demand(side, ends, torques)
    places = np.stack((ends[:-1] * JUST_BEYOND, ends[1:]), axis=1).ravel()
    return Demand(side, places, np.repeat(torques[1:], 2))


def _steepness(slope: Slope) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return speeds along a slope, increasing [steps/s], and its accelerations there [steps/s²], by (6)."""
    steps = slope.steps
    stride = -(-steps // MOST_PLACES)
    speeds = slope.speeds(0, steps + 1, np.float64)
    first = np.arange(0, steps, stride)
    after = (speeds[first + 1] ** 2 - speeds[first] ** 2) / 2
    middles = (speeds[first] + speeds[first + 1]) / 2
    at = np.concatenate(([slope.base_speed], middles, [slope.slew_speed]))
    return at, np.concatenate((after[:1], after, after[-1:]))
