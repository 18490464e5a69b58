"""Available against required torque of a design, over the speed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.motor.limits import required_nm
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.slope import Slope
from stepramp.ramp.slopes import playable_slopes_of
from stepramp.units import rad_per_s_from_rpm, rpm_from_rad_per_s

MOST_PLACES = 4096
"""So many steps of a side are looked at."""

CURVE_POINTS = 120
BEYOND_SLEW = 1.25
"""So far beyond the slew speed a curve goes."""


@dataclass(frozen=True)
class Torques:
    """Both torques at speeds, arrays of shape (n,)."""

    pull_out_nm: NDArray[np.float64]
    required_nm: NDArray[np.float64]


@dataclass(frozen=True)
class TorqueCurve:
    """Both torques over the speed, arrays of shape (n,)."""

    speeds: NDArray[np.float64]
    """[steps/s]"""
    rpm: NDArray[np.float64]
    """The same of the motor's shaft."""
    torques: Torques


def drive_train(design: Design) -> DriveTrain:
    """Return a design's motor with its drive and its load. Raises Rejected when nothing is known of the motor."""
    train = design.drive_train
    if train is None:
        raise Rejected(
            [Rejection("motor", None, "a motor: its resistance, inductance, holding torque, current, inertia")]
        )
    return train


def torques_at(design: Design, speeds_rpm: NDArray[np.float64]) -> Torques:
    """Return what the motor has and what the design's ramp asks of it at speeds [rpm], 0 or more.

    Where up and down ask for different torques, the larger; beyond the ramp's peak what load and friction ask for, and
    below the base speed what the ramp begins with. Raises Rejected as playable_slopes_of does, and without a motor.
    """
    train = drive_train(design)
    speeds = rad_per_s_from_rpm(1) * np.asarray(speeds_rpm, float)
    slopes, asked = playable_slopes_of(design), []
    for slope, sign in zip(slopes, (1, -1), strict=True):
        at, accelerations = steepness(slope)
        along = np.interp(speeds / train.radians_per_step, at, accelerations, right=0.0)
        asked.append(required_nm(train, sign * along))
    return Torques(train.pull_out_nm(speeds), np.maximum(*asked))


def torque_curve_of(design: Design) -> TorqueCurve:
    """Return both torques from rest to beyond the slew speed. Raises Rejected as torques_at does."""
    speeds = np.linspace(0, BEYOND_SLEW * design.ramp.slew_speed_steps_per_s, CURVE_POINTS)
    rpm = rpm_from_rad_per_s(1) * speeds * drive_train(design).radians_per_step
    return TorqueCurve(speeds, rpm, torques_at(design, rpm))


def steepness(slope: Slope) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return speeds along a slope, increasing [steps/s], and its accelerations there [steps/s²], by (6)."""
    steps = slope.steps
    if steps < 1:
        return np.array([slope.base_speed, slope.slew_speed]), np.full(2, slope.acceleration)
    stride = -(-steps // MOST_PLACES)
    speeds = slope.speeds(0, steps + 1, np.float64)
    first = np.arange(0, steps, stride)
    after = (speeds[first + 1] ** 2 - speeds[first] ** 2) / 2
    middles = (speeds[first] + speeds[first + 1]) / 2
    at = np.concatenate(([slope.base_speed], middles, [slope.slew_speed]))
    return at, np.concatenate((after[:1], after, after[-1:]))
