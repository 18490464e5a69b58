"""Loads that are told by their mechanism: what the shaft feels of them, by hand."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motor.trains import LOADED, NEMA_17, with_motor
from stepramp.drive_train import Load
from stepramp.errors import Rejected
from stepramp.numerics.drive_train import DriveTrain

SCREW: dict[str, Any] = {"name": "screw", "lead_mm": 8.0, "mass_kg": 5.0}
BELT: dict[str, Any] = {"name": "belt", "pulley_mm": 12.7323954, "mass_kg": 0.4}

# l/2π = 1.273240 mm; 5 kg weigh 49.03325 N, which are .0624312 Nm at the screw; the rotor has 82e-7 kg m².
# r = 6.3661977 mm; .4 kg weigh 3.92266 N, which are .0249724 Nm at the belt.
AT_THE_SHAFT: dict[str, tuple[dict[str, Any], float, float, float]] = {
    "screw, level": (SCREW | {"friction_n": 12.0, "efficiency": 0.8}, 81.05695e-7, 0.0, 0.01909859),
    "screw, up": (SCREW | {"friction_n": 0.0, "efficiency": 0.8, "incline_deg": 90.0},
                  81.05695e-7, 0.0624312, 0.0156078),
    "screw, down": (SCREW | {"friction_n": 0.0, "efficiency": 0.8, "incline_deg": -90.0},
                    81.05695e-7, -0.0624312, 0.0156078),
    "screw, up by 30°, usual": (SCREW | {"friction_n": 4.0, "incline_deg": 30.0},
                                81.05695e-7, 0.0312156, 0.0127324 + 0.0468234),
    "belt, level": (BELT | {"friction_n": 3.0}, 162.1139e-7, 0.0, 0.01909859),
    "belt, up": (BELT | {"friction_n": 0.0, "incline_deg": 90.0}, 162.1139e-7, 0.0249724, 0.0),
    "pointer": ({"name": "pointer", "inertia_g_cm2": 2.0}, 2e-7, 0.0, 0.0295),
}  # fmt: skip
"""kg m², Nm, Nm."""


def moved(mechanism: dict[str, Any], **load: Any) -> DriveTrain:
    train = with_motor(load={**load, "mechanism": mechanism}).drive_train
    assert train is not None
    return train


@pytest.mark.parametrize("name", AT_THE_SHAFT)
def test_what_the_shaft_feels(name: str) -> None:
    mechanism, inertia, torque, friction = AT_THE_SHAFT[name]
    train = moved(mechanism)
    assert train.inertia_kg_m2 == pytest.approx(82e-7 + inertia, rel=1e-6)
    assert (train.load_nm, train.friction_nm) == pytest.approx((torque, friction), rel=1e-5)


def test_the_figures_at_the_shaft_stay_and_the_mechanism_is_added() -> None:
    train = moved(BELT | {"incline_deg": 90.0}, inertia_g_cm2=200.0, torque_nm=-0.01, friction_nm=0.005)
    assert train.inertia_kg_m2 == pytest.approx((82 + 200 + 162.1139) * 1e-7, rel=1e-6)
    assert (train.load_nm, train.friction_nm) == pytest.approx((0.0149724, 0.005), rel=1e-5)


def test_the_usual_friction_holds_until_one_is_told() -> None:
    usual = 0.05 * NEMA_17["holding_torque_nm"]
    assert moved(BELT).friction_nm == pytest.approx(usual)
    assert moved(BELT | {"friction_n": 0.0}).friction_nm == 0
    assert moved(BELT, friction_nm=0.01).friction_nm == pytest.approx(0.01)
    # What a weight loses in the thread is on top of it: the screw's efficiency is known.
    assert moved(SCREW | {"efficiency": 0.8, "incline_deg": 90.0}).friction_nm == pytest.approx(usual + 0.0156078)


@given(lead=st.floats(0.5, 50), mass=st.floats(0.01, 100), efficiency=st.floats(0.05, 1))
def test_a_weight_takes_the_screws_efficiency_up_and_down(lead: float, mass: float, efficiency: float) -> None:
    """Up it takes F l/2πη; what brings it down has the efficiency 2 - 1/η, and nothing has it fall below a half."""
    mechanism = SCREW | {"lead_mm": lead, "mass_kg": mass, "efficiency": efficiency, "incline_deg": 90.0}
    train = moved(mechanism, friction_nm=0.0)
    ideal = mass * 9.80665 * lead / 1000 / (2 * math.pi)
    assert train.load_nm + train.friction_nm == pytest.approx(ideal / efficiency)
    assert train.load_nm - train.friction_nm == pytest.approx(ideal * (2 - 1 / efficiency), abs=1e-9)


@pytest.mark.parametrize(
    ("mechanism", "field", "allowed"),
    [
        ({"name": "screw", "mass_kg": 1.0}, "lead_mm", "the travel of one turn [mm], since the name is 'screw'"),
        ({"name": "belt", "pulley_mm": 12.0}, "mass_kg", "the mass that it moves [kg], since the name is 'belt'"),
        ({"name": "pointer"}, "inertia_g_cm2", "the pointer's inertia"),
        (BELT | {"lead_mm": 8.0}, "lead_mm", "none with the name 'belt', it is of 'screw'"),
        (BELT | {"efficiency": 0.9}, "efficiency", "none with the name 'belt', it is of 'screw'"),
        (SCREW | {"inertia_g_cm2": 8.0}, "inertia_g_cm2", "it is of 'pointer'"),
        ({"name": "pointer", "inertia_g_cm2": 2.0, "mass_kg": 0.0}, "mass_kg", "it is of 'screw' or 'belt'"),
        (SCREW | {"efficiency": 1.1}, "efficiency", "from 0.05 to 1"),
        (SCREW | {"incline_deg": 91.0}, "incline_deg", "from -90 to 90 °"),
        ({"name": "rack"}, "name", "screw, belt, pointer"),
    ],
)
def test_fields_of_another_mechanism_and_missing_ones_are_refused(
    mechanism: dict[str, Any], field: str, allowed: str
) -> None:
    with pytest.raises(Rejected) as caught:
        with_motor(load={"mechanism": mechanism})
    told = {each.field: each.allowed for each in caught.value.rejections}
    assert allowed in told[f"load.mechanism.{field}"]


def test_a_load_without_a_mechanism_is_what_it_was() -> None:
    bare = {"inertia_g_cm2": 200.0, "torque_nm": 0.0, "friction_nm": None}
    assert Load.checked(LOADED).model_dump() == bare
    assert Load.checked({**LOADED, "mechanism": None}).model_dump() == bare
    assert Load.checked({"mechanism": BELT}).model_dump()["mechanism"] == BELT
