"""A motor with its drive and its load in SI units, and the torque that it has over speed: docs/motor.md.

Sources: Acarnley, "Stepping Motors"; Kenjo and Sugawara, "Stepping Motors and their Microprocessor Controls".
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NONE_NM = 1e-12
"""Less torque is none: nothing is in proportion to it."""


@dataclass(frozen=True)
class DriveTrain:
    """A motor, what drives it, and what it moves, at the motor's shaft."""

    resistance_ohm: float
    """R of one phase."""
    inductance_h: float
    """L of one phase."""
    torque_constant_nm_per_a: float
    """K_m = T_hold / (√2 I_rated): torque of one phase at a peak current."""
    peak_current_a: float
    """I_pk of a phase."""
    supply_v: float
    """V."""
    periods_per_rev: float
    """N_r: electrical periods of a turn."""
    periods_per_full_step: float
    """A quarter for two phases; half for a gauge's motor."""
    inertia_kg_m2: float
    """J of rotor and load."""
    detent_nm: float
    """T_det."""
    friction_nm: float
    """T_c: against any motion."""
    load_nm: float
    """T_L: against forward motion; negative with it."""
    steps_per_rev: float
    """Pulses of the driver for a turn [steps]."""
    pull_out_factor: float
    """k."""
    curve: tuple[tuple[float, float], ...] = ()
    """Speeds [rad/s], increasing, and pull-out torques there [Nm], in place of the model; none: the model."""
    when_measured: "DriveTrain | None" = None
    """The same, driven as it was when the curve was measured; None: as it is now."""

    @property
    def static_torque_nm(self) -> float:
        """T_h = K_m min(I_pk, V/R): at rest a supply drives no more through a phase than V/R [Nm]."""
        return self.torque_constant_nm_per_a * min(self.peak_current_a, self.supply_v / self.resistance_ohm)

    @property
    def natural_frequency_hz(self) -> float:
        """f_n = √(N_r T_h / J) / 2π [Hz]."""
        return math.sqrt(self.periods_per_rev * self.static_torque_nm / self.inertia_kg_m2) / (2 * math.pi)

    @property
    def radians_per_step(self) -> float:
        """How far the shaft turns with a pulse of the driver [rad]."""
        return 2 * math.pi / self.steps_per_rev

    @property
    def steps_per_full_step(self) -> float:
        """Pulses of the driver for a full step of the motor [steps]."""
        return self.steps_per_rev * self.periods_per_full_step / self.periods_per_rev

    @property
    def holding_back_nm(self) -> float:
        """What load and friction take while the motor accelerates, in the worse direction: |T_L| + T_c [Nm]."""
        return abs(self.load_nm) + self.friction_nm

    def pull_out_nm(self, speeds_rad_per_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the pull-out torque at speeds of the shaft, 0 or more [Nm], shape of the speeds.

        A curve counts as far as the drive's current makes so much, T_h.
        """
        if not self.curve:
            return self.pull_out_factor * self.model_nm(speeds_rad_per_s)
        return np.minimum(self._drawn_nm(speeds_rad_per_s), self.static_torque_nm)

    def limits(self, speeds_rad_per_s: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return a number for what limits the torque at speeds: where it changes the torque has a kink."""
        holds = self.static_torque_nm
        trains = (self,) if self.when_measured is None else (self, self.when_measured)
        of_drives = [train._by_supply_nm(speeds_rad_per_s) >= train.static_torque_nm for train in trains]
        of_curve = [self._drawn_nm(speeds_rad_per_s) >= holds] if self.curve else []
        number: NDArray[np.int64] = sum(
            (is_so.astype(np.int64) << bit for bit, is_so in enumerate((*of_drives, *of_curve))),
            np.zeros(speeds_rad_per_s.shape, np.int64),
        )
        return number

    def model_nm(self, speeds_rad_per_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return min(T_h, K_m (V/Z - K_m ω R / Z²)) with Z² = R² + (N_r ω L)², never less than 0 [Nm]."""
        return np.minimum(self._by_supply_nm(speeds_rad_per_s), self.static_torque_nm)

    def _by_supply_nm(self, speeds_rad_per_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what the supply alone allows, whatever the current is [Nm]."""
        reactance = self.periods_per_rev * speeds_rad_per_s * self.inductance_h
        squared = self.resistance_ohm**2 + reactance**2
        back = self.torque_constant_nm_per_a * speeds_rad_per_s * self.resistance_ohm / squared
        possible = self.torque_constant_nm_per_a * (self.supply_v / np.sqrt(squared) - back)
        torque: NDArray[np.float64] = np.maximum(possible, 0.0)
        return torque

    def _drawn_nm(self, speeds_rad_per_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the curve, beyond its last point as what the supply allows, as far as this drive is another [Nm]."""
        then = self.when_measured or self
        speeds, torques = np.array(self.curve).T
        beyond = float(then._by_supply_nm(speeds[-1:])[0])
        scaled = then._by_supply_nm(speeds_rad_per_s) * (torques[-1] / beyond if beyond > NONE_NM else 0.0)
        drawn = np.where(speeds_rad_per_s > speeds[-1], scaled, np.interp(speeds_rad_per_s, speeds, torques))
        had, has = then.model_nm(speeds_rad_per_s), self.model_nm(speeds_rad_per_s)
        as_then: NDArray[np.float64] = np.divide(has, had, out=np.ones(had.shape), where=had > NONE_NM)
        return drawn * as_then
