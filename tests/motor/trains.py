"""Motors for tests: those of published curves, and one without friction, detent and inductance to speak of."""

from dataclasses import replace
from typing import Any

import numpy as np

from designs import design, document
from stepramp.design import Design
from stepramp.drive_train import Drive, Motor, drive_train_of
from stepramp.numerics.drive_train import DriveTrain

NEMA_17: dict[str, Any] = {
    "resistance_ohm": 1.4, "inductance_mh": 3.0, "holding_torque_nm": 0.59, "rated_current_a": 2.0,
    "rotor_inertia_g_cm2": 82.0,
}  # fmt: skip
NEMA_23: dict[str, Any] = {
    "resistance_ohm": 1.13, "inductance_mh": 5.4, "holding_torque_nm": 1.89, "rated_current_a": 2.8,
    "rotor_inertia_g_cm2": 480.0,
}  # fmt: skip
AT_24_V: dict[str, Any] = {"supply_v": 24.0, "current_a": 2.0, "current_is": "peak"}
LOADED: dict[str, Any] = {"inertia_g_cm2": 200.0}

PUBLISHED: dict[str, tuple[Motor, Drive, dict[float, float]]] = {
    "17HS19-2004D-E1K, 24 V, 2 A peak": (
        Motor(**NEMA_17), Drive(**AT_24_V),
        {100: 0.345, 300: 0.33, 600: 0.31, 900: 0.245, 1200: 0.22, 1500: 0.155},
    ),
    "23HS30-2804S, 36 V, 2.69 A rms": (
        Motor(**NEMA_23), Drive(supply_v=36.0, current_a=2.69, current_is="rms"),
        {300: 1.44, 390: 1.28, 510: 1.00, 600: 0.88},
    ),
}  # fmt: skip
"""Of makers' torque curves, as collected in docs/motor.md: rpm → Nm."""


def with_motor(**changes: Any) -> Design:
    """Return a design for the NEMA 17 at 1/16 step, which it makes easily."""
    return design(**with_motor_document(**changes))


def with_motor_document(**changes: Any) -> dict[str, Any]:
    usual = {
        "schema": "stepramp/2", "motor": NEMA_17, "drive": AT_24_V, "load": LOADED, "method__name": "exact",
        "axis__microsteps": 16, "timer__frequency_hz": 16e6, "ramp__slew_speed_steps_per_s": 32_000.0,
        "ramp__acceleration_steps_per_s2": 3e5, "move__steps": 10_000,
    }  # fmt: skip
    made: dict[str, Any] = usual | changes
    return made


def whole(**changes: Any) -> dict[str, Any]:
    """Return the whole document of such a design."""
    return document(**with_motor_document(**changes))


def random_design(random: np.random.Generator, slew_s: float = 0.05) -> Design:
    """Return a design as likely to stall as not, at one to four microsteps, so that it is soon played.

    slew_s: so long its slew phase is at least [s].
    """
    microsteps = int(random.choice([1, 2, 4]))
    speed, acceleration = (10 ** random.uniform(*ends) * microsteps for ends in ((2.3, 4.0), (3.3, 5.7)))
    return with_motor(
        motor=NEMA_17 if random.random() < 0.5 else NEMA_23,
        drive=AT_24_V | {"supply_v": float(random.choice([12, 24, 48]))},
        load={"inertia_g_cm2": float(random.uniform(0, 800)), "torque_nm": float(random.uniform(-0.1, 0.2))},
        axis__microsteps=microsteps,
        timer__frequency_hz=float(random.choice([16e6, 1e6, 250e3])),
        method__rounding=str(random.choice(["nearest", "floor", "carry"])),
        ramp__slew_speed_steps_per_s=speed,
        ramp__acceleration_steps_per_s2=acceleration,
        move__steps=int(speed**2 / acceleration + slew_s * speed) + 20,
    )


def pendulum(load_part: float = 0.0) -> DriveTrain:
    """Return a motor as the closed forms have it: the field pulls it, and nothing else does but a constant load."""
    train = drive_train_of(Motor(**NEMA_17), Drive(**AT_24_V), None, 200 * 256)
    load_nm = load_part * train.static_torque_nm
    return replace(train, supply_v=1e6, friction_nm=0.0, detent_nm=0.0, load_nm=load_nm)
