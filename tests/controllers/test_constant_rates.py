"""What a controller with one acceleration is given for a ramp that is shaped by what its motor has torque for."""

import math

import numpy as np
import pytest

from designs import design
from motor.trains import with_motor_document
from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.grbl.ramp import GrblRamp
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tmcl.own_ramp import USUAL_UNITS
from stepramp.controllers.tmcl.ramp import TmclRamp, in_steps
from stepramp.errors import Rejected
from stepramp.motor.verdict import outcome_of
from stepramp.ramp.slopes import full_slopes_of
from stepramp.shapes.torque import TorqueShaped

SHAPED = with_motor_document(
    ramp__shape={"name": "torque", "margin": 0.6}, ramp__acceleration_steps_per_s2=1e9,
    ramp__slew_speed_steps_per_s=48_000.0, move__steps=60_000, axis__travel_per_rev=8.0, axis__travel_unit="mm",
    load={"inertia_g_cm2": 2000.0},
)  # fmt: skip


def least_possible(steps_per_s: float, margin: float) -> float:
    """Return (m k K_m (V/Z - K_m ω R / Z²) - T_c) / J of the NEMA 17 at 24 V [steps/s²]: docs/motor.md."""
    omega, constant = steps_per_s * 2 * math.pi / 3200, 0.59 / (math.sqrt(2) * 2.0)
    impedance = math.hypot(1.4, 50 * omega * 3e-3)
    torque = 0.85 * constant * (24 / impedance - constant * omega * 1.4 / impedance**2)
    return (margin * torque - 0.05 * 0.59) / 2082e-7 * 3200 / (2 * math.pi)


def test_what_is_pushed_to_controllers_is_that_constant_ramp() -> None:
    least, shaped = least_possible(48_000, 0.6), design(**SHAPED)
    tmcl = TmclRamp.of(shaped, USUAL_UNITS)
    sent = [
        *TicRamp.of(shaped).figures[2:],
        GrblRamp.of(shaped, np.float32(400)).acceleration_steps_per_s2,
        *(in_steps(name, getattr(tmcl, name), USUAL_UNITS) for name in ("amax", "a1", "dmax", "d1")),
    ]
    assert sent == [pytest.approx(least, rel=1e-3)] * len(sent)
    assert max(sent) <= least


def test_the_constant_ramp_in_place_of_one_shaped_by_torque_loses_no_step() -> None:
    assert outcome_of(with_constant_rates(design(**SHAPED))).verdict == "safe"
    fast = SHAPED | {"ramp__slew_speed_steps_per_s": 60_000.0, "ramp__shape": {"name": "torque", "margin": 0.95}}
    shaped = design(**fast)
    assert outcome_of(with_constant_rates(shaped)).verdict == outcome_of(shaped).verdict == "marginal"
    # With what it begins with, held on, it stalls.
    slope = full_slopes_of(shaped)[0]
    assert isinstance(slope, TorqueShaped)
    largest = slope.accelerations(np.linspace(0, 60_000, 999)).max()
    held = fast | {"ramp__shape": {"name": "constant"}, "ramp__acceleration_steps_per_s2": float(largest)}
    assert outcome_of(design(**held)).verdict == "stalls"


def test_a_constant_ramp_may_come_all_at_once() -> None:
    """With all of the torque the rotor would swing out of its period: at most .7246 of T_h, less friction."""
    slow = SHAPED | {"ramp__slew_speed_steps_per_s": 8000.0, "ramp__shape": {"name": "torque", "margin": 1.0}}
    made = with_constant_rates(design(**slow)).ramp.acceleration_steps_per_s2
    static = 0.59 / math.sqrt(2)
    assert made == pytest.approx((0.7246 * static - 0.0295) / 2082e-7 * 3200 / (2 * math.pi), rel=1e-5)


def test_what_was_asked_for_stays_where_it_is_less_and_where_there_is_no_torque_it_is_refused() -> None:
    gentle = SHAPED | {"ramp__acceleration_steps_per_s2": 2000.0, "ramp__deceleration_steps_per_s2": 1e9}
    ramp = with_constant_rates(design(**gentle)).ramp
    assert ramp.acceleration_steps_per_s2 == 2000
    assert ramp.deceleration_steps_per_s2 == pytest.approx(least_possible(48_000, 0.6), rel=1e-4)
    # Though the move itself never comes so far.
    fast = SHAPED | {"ramp__slew_speed_steps_per_s": 900_000.0, "move__steps": 200}
    with pytest.raises(Rejected) as caught:
        with_constant_rates(design(**fast), "axes.0.")
    assert [each.field for each in caught.value.rejections] == ["axes.0.ramp.slew_speed_steps_per_s"]
