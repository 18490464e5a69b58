"""Available against required torque of a design, over the speed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.motor.demand import Demand, demands_of
from stepramp.motor.limits import required_nm
from stepramp.numerics.drive_train import DriveTrain
from stepramp.units import rad_per_s_from_rpm, rpm_from_rad_per_s

CURVE_POINTS = 120
"""So many a curve has, besides those where rows of a table begin and end."""
BEYOND_SLEW = 1.25
"""So far beyond the slew speed, or what a table comes to, a curve goes."""


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
    below the base speed what the ramp begins with. Raises Rejected as demands_of does, and without a motor.
    """
    train = drive_train(design)
    return _torques(train, demands_of(design, train), rad_per_s_from_rpm(1) * np.asarray(speeds_rpm, float))


def torque_curve_of(design: Design) -> TorqueCurve:
    """Return both torques from rest to beyond all that is played. Raises Rejected as torques_at does."""
    train = drive_train(design)
    demands = demands_of(design, train)
    played = max((float(demand.speeds[-1]) for demand in demands), default=0.0)
    end = BEYOND_SLEW * max(design.ramp.slew_speed_steps_per_s, played)
    speeds = np.linspace(0, end, CURVE_POINTS)
    if design.method.plays_table:
        # What a row asks for may be felt between two of them.
        speeds = np.unique(np.concatenate([speeds, *(demand.speeds for demand in demands)]))
    in_rad_per_s = speeds * train.radians_per_step
    return TorqueCurve(speeds, rpm_from_rad_per_s(1) * in_rad_per_s, _torques(train, demands, in_rad_per_s))


def _torques(train: DriveTrain, demands: list[Demand], speeds: NDArray[np.float64]) -> Torques:
    """Return both torques at speeds of the shaft [rad/s]."""
    required = required_nm(train, np.zeros(speeds.shape))
    for demand in demands:
        at = demand.speeds * train.radians_per_step
        required = np.maximum(required, np.interp(speeds, at, demand.torques_nm, right=0.0))
    return Torques(train.pull_out_nm(speeds), required)
