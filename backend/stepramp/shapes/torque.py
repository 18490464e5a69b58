"""Torque: the acceleration over the speed that the motor has torque for, a part of it kept back.

a(ω) = (m T_po(ω) - |T_L| - T_c) / J, with the margin m. It begins over one period of the rotor's natural frequency, as
a sudden acceleration would make it swing: from a tenth of it the acceleration grows evenly over that time, so that
a² = a_0² + 2 j (v - v0). docs/motor.md.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.drive_train import DriveTrain
from stepramp.shapes.common.by_speed import BySpeed

BEGIN = 0.1
"""This part of the acceleration is there at once: the onset leads from it to the whole."""
LEAST_PART = 1e-6
"""Of the first acceleration: where the motor has no torque left it is as good as none; such ramps are refused in
ramp/slopes.py."""
PLACES = 2048
"""Speeds at which it is looked which of the limits holds."""


@dataclass(frozen=True)
class TorqueShaped(BySpeed):
    """One side of a ramp along what the motor has torque for."""

    rank = 50
    label = "Torque"
    summary = "the acceleration that the motor has torque for at each speed, less a margin"
    help = (
        "As fast as this motor can follow, with its load, its supply and the margin that is kept: strong while slow, "
        "gentle where its torque falls. Needs the motor's data."
    )
    takes = frozenset({"margin"})

    @property
    def kinks(self) -> NDArray[np.float64]:
        """Where another limit begins to hold [steps/s]."""
        return self._kinks

    def accelerations(self, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the least of what the torque allows, the onset, and the largest acceleration [steps/s²]."""
        least: NDArray[np.float64] = np.maximum(self._limits(speeds).min(axis=0), LEAST_PART * self._first)
        return least

    def possible(self, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what the torque allows at each speed; less than 0 where it doesn't even bear the load [steps/s²]."""
        train, margin = self._train
        per_step = train.radians_per_step
        torque = margin * train.pull_out_nm(speeds * per_step) - train.holding_back_nm
        allowed: NDArray[np.float64] = torque / train.inertia_kg_m2 / per_step
        return allowed

    def _limits(self, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        whole = self._first
        begin = BEGIN * whole
        jerk = (whole - begin) * self._train[0].natural_frequency_hz
        onset = np.sqrt(begin**2 + 2 * jerk * np.maximum(speeds - self.base_speed, 0.0))
        return np.stack((self.possible(speeds), onset, np.full(speeds.shape, self.acceleration)))

    @cached_property
    def _first(self) -> float:
        """What the onset leads to: the acceleration that holds at the base speed [steps/s²]."""
        possible = float(self.possible(np.array([self.base_speed]))[0])
        return max(min(possible, self.acceleration), LEAST_PART * self.acceleration)

    @cached_property
    def _kinks(self) -> NDArray[np.float64]:
        speeds = np.linspace(self.base_speed, self.slew_speed, PLACES)
        holds = self._limits(speeds).argmin(axis=0)
        changes = np.flatnonzero(np.diff(holds))
        found = [self._change(*speeds[at : at + 2], *holds[at : at + 2]) for at in changes]
        return np.unique(np.concatenate((np.array(found, float), self._corners)))

    def _change(self, low: float, high: float, before: int, after: int) -> float:
        """Return the speed between two at which one limit takes the place of another."""
        while low < (middle := (low + high) / 2) < high:
            limits = self._limits(np.array([middle]))[:, 0]
            low, high = (middle, high) if limits[before] <= limits[after] else (low, middle)
        return low

    @property
    def _corners(self) -> NDArray[np.float64]:
        """The speeds at which the torque itself has a kink [steps/s]."""
        train, _ = self._train
        speeds = np.linspace(self.base_speed, self.slew_speed, PLACES) * train.radians_per_step
        changes = np.flatnonzero(np.diff(train.limits(speeds)))
        found = [self._corner(*speeds[at : at + 2]) for at in changes]
        return np.array([*(speed for speed, _ in train.curve), *found], float) / train.radians_per_step

    def _corner(self, low: float, high: float) -> float:
        train, _ = self._train
        below = train.limits(np.array([low]))[0]
        while low < (middle := (low + high) / 2) < high:
            is_alike = bool(train.limits(np.array([middle]))[0] == below)
            low, high = (middle, high) if is_alike else (low, middle)
        return low

    @property
    def _train(self) -> tuple[DriveTrain, float]:
        """The motor with its drive and load, and the margin."""
        train, margin = self.parameters.drive_train, self.parameters.margin
        assert train is not None  # a design without a motor has no such shape
        return train, margin


SHAPE = TorqueShaped
