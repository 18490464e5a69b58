"""Compiling before it is needed, as for the numerics of ramps: one pulse through the model of a motor."""

import numpy as np

from stepramp.drive_train import Motor, drive_train_of
from stepramp.motor.train import run_of, swing_of


def warm_up_motor() -> None:
    """Play a pulse, watched to its end and not."""
    motor = Motor(
        resistance_ohm=1.4, inductance_mh=3.0, holding_torque_nm=0.59, rated_current_a=2.0, rotor_inertia_g_cm2=82.0
    )
    train = drive_train_of(motor, None, None, 200)
    for play in (run_of, swing_of):
        _ = play(train, np.array([1e-3]), 0.05)
