"""What a motor can do, in closed form: quick enough to be shown while a slider moves.

Of a rotor that the field pulls like a pendulum, microstepped and undamped; T_h is the static torque, φ the load angle.
Derived in docs/motor.md, after Acarnley, and Kenjo and Sugawara.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.drive_train import DriveTrain

SUDDEN = 0.7246
"""A torque that is asked for all at once makes the rotor swing: up to this part of T_h it comes back."""
SMOOTH = 0.97
"""The same for a torque that grows over one period of the natural frequency."""
BAND = 0.15
"""How wide a resonance is, to either side of it."""
RESONANCES = (0.5, 1.0)
"""Full steps for one swing of the rotor, at which detent torque and steps push it in time [1/(f_n)]."""


def greatest_start_speed(train: DriveTrain) -> float:
    """Return the speed to which the motor can start at once, in steps of the driver [steps/s].

    ½ ω_e² = ω_n² (cos φ_0 + cos φ_L - s (π - φ_L - φ_0)) with s = sin φ_L = (|T_L| + T_c) / T_h, from where the load
    holds the rotor, sin φ_0 = |T_L| / T_h; without a load that is 8 f_n full steps/s. 0 where load and friction take
    all of T_h.
    """
    share = train.holding_back_nm / train.static_torque_nm
    if share >= 1:
        return 0.0
    angle, at_rest = math.asin(share), math.asin(abs(train.load_nm) / train.static_torque_nm)
    energy = math.cos(at_rest) + math.cos(angle) - share * (math.pi - angle - at_rest)
    electrical_rad_per_s = 2 * math.pi * train.natural_frequency_hz * math.sqrt(2 * max(energy, 0.0))
    return electrical_rad_per_s / (2 * math.pi) / train.periods_per_rev * train.steps_per_rev


def greatest_acceleration(train: DriveTrain, share: float) -> float:
    """Return the acceleration at rest that takes so much of T_h, with load and friction [steps/s²]; 0: none."""
    torque = share * train.static_torque_nm - train.holding_back_nm
    return max(torque, 0.0) / train.inertia_kg_m2 / train.radians_per_step


def required_nm(train: DriveTrain, accelerations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the torque that accelerations ask for, in the worse direction [Nm], shape of the accelerations.

    accelerations: [steps/s²], less than 0 while it slows down. Up: J a + |T_L| + T_c. Down: a load that pulls is held
    back, and what friction does for it isn't counted on.
    """
    inertia = train.inertia_kg_m2 * train.radians_per_step * np.abs(accelerations)
    held = np.where(accelerations < 0, abs(train.load_nm), train.holding_back_nm)
    torque: NDArray[np.float64] = inertia + held
    return torque


def resonances(train: DriveTrain) -> list[tuple[float, float]]:
    """Return the bands of speed in which the steps come in time with the rotor's swing [steps/s], the lowest first."""
    centres = [part * train.natural_frequency_hz * train.steps_per_full_step for part in RESONANCES]
    return [((1 - BAND) * centre, (1 + BAND) * centre) for centre in centres]
