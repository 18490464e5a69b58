"""What of a design is lost is said with its figure, and what can't be taken is refused."""

import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.test_constant_rates import SHAPED, least_possible
from designs import design
from stepramp.controllers.fluidnc.ramp import FLUIDNC
from stepramp.controllers.given_numbers import as_float32, rounded_down
from stepramp.controllers.klipper.ramp import KLIPPER
from stepramp.controllers.marlin.ramp import MARLIN
from stepramp.controllers.per_mm import PerMm, Terms
from stepramp.errors import Rejected
from stepramp.exports.export import Options, sheet_of
from stepramp.exports.machines.accel_stepper import float_below
from stepramp.exports.machines.machines import MACHINES

NAMES = {
    "grbl": "grbl",
    "grblhal": "grblHAL",
    "fluidnc": "FluidNC",
    "marlin": "Marlin",
    "marlin_configuration": "Marlin",
    "klipper": "Klipper",
    "accelstepper": "AccelStepper",
}
STARTS = dict.fromkeys(NAMES, "starts from 0") | dict.fromkeys(
    ("marlin", "marlin_configuration"), "starts and ends at 120 steps/s"
)
LOSING = {
    "schema": "stepramp/2",
    "ramp__base_speed_steps_per_s": 100,
    "ramp__deceleration_steps_per_s2": 2500,
    "ramp__shape": {"name": "s_curve", "jerk_steps_per_s3": 80_000},
}


def remarks(machine: str, letter: Any = "X", **changes: Any) -> str:
    return "\n".join(sheet_of(design(**changes), machine, Options(axis_letter=letter))[1].remarks)


@pytest.mark.parametrize("machine", NAMES)
def test_every_loss_is_named_with_its_figure(machine: str) -> None:
    name, said = NAMES[machine], remarks(machine, **LOSING)
    assert f"Base speed 100 steps/s is not kept: {name} {STARTS[machine]}." in said
    assert "Acceleration 5,000 steps/s² is not kept" in said
    assert "the smaller one, 2,500 steps/s²" in said
    assert f"The shape S-curve with a jerk of 80,000 steps/s³ is not kept: {name}'s acceleration is constant." in said
    assert f"The method Exact is not kept: {name} works its intervals out itself" in said


@pytest.mark.parametrize("machine", NAMES)
def test_what_is_not_lost_is_not_named(machine: str) -> None:
    # Marlin plans no slower rate at the ends of a move, whatever it is told (MINIMAL_STEP_RATE).
    said = remarks(machine, ramp__base_speed_steps_per_s=120 if "120" in STARTS[machine] else 0)
    assert not [
        word for word in ("Base speed", "eceleration", "shape", "rounded", "degree", "a way of") if word in said
    ]
    assert "The lookup table is not kept" in remarks(machine, method__name="table")


WITH_ONE_RATE = (*NAMES, "tic", "tic_settings", "fastaccelstepper", "teensystep")


@pytest.mark.parametrize("machine", WITH_ONE_RATE)
def test_a_ramp_shaped_by_torque_becomes_the_constant_one_that_the_torque_does_for(machine: str) -> None:
    """The largest along it, asked for or had, would stall the motor at speed."""
    least = least_possible(48_000, 0.6)
    made = sheet_of(design(**SHAPED), machine, Options(axis_letter="X"))[1]
    given = next(
        each for each in made.settings if re.search("accel|M201|120|DEFAULT_MAX_ACC", each.name, re.IGNORECASE)
    )
    of_mm = 400.0 if "mm" in given.unit else 0.01 if "100 s" in given.unit else 1.0
    assert given.requested * of_mm == pytest.approx(least, rel=1e-4)
    sent = float(given.sent.strip("f")) * of_mm
    assert least * 0.99 < sent <= least
    told = "the largest for which 60% of the motor's torque does at every speed up to 48,000 steps/s."
    assert any(told in remark for remark in made.remarks)


def test_a_drawn_ramp_becomes_the_least_from_its_largest_on() -> None:
    points = [[0, 0.2], [200, 1], [600, 0.5], [1000, 0.3]]
    said = remarks("grbl", schema="stepramp/2", ramp__shape={"name": "drawn", "points": points})
    # 0.3 of 5,000 steps/s²; that it begins gently says nothing of the motor.
    assert "constant, 1,500 steps/s², the least that is drawn from its largest on." in said


TO_CONVERT = LOSING | {"ramp__slew_speed_steps_per_s": 49_999.75, "ramp__base_speed_steps_per_s": 150}


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("changes", [TO_CONVERT, {}, {"ramp__base_speed_steps_per_s": 150}])
def test_every_speed_and_rate_that_is_told_is_told_as_data_too(machine: str, changes: dict[str, Any]) -> None:
    sheet = sheet_of(design(**changes), machine, Options(axis_letter="X"))[1]
    assert len(sheet.remarks_told) == len(sheet.remarks)
    for sentence, told in zip(sheet.remarks, sheet.remarks_told, strict=True):
        rest, others = str(sentence), ""
        for each in told:
            other, found, rest = rest.partition(each.text)
            others += other
            assert found, "they are in their order"
        # What a library can't go below is its own.
        assert "steps/s" not in (others + rest).replace("below 1 step/s", "")


def test_the_exported_text_stays_in_steps() -> None:
    sheet = sheet_of(design(**TO_CONVERT), "accelstepper", Options())[1]
    assert "Slew speed 49,999.75 steps/s is more than the 4,000 that AccelStepper" in " ".join(
        line.strip(" *") for line in sheet.text.splitlines()
    )


def test_what_others_keep_is_not_named() -> None:
    for machine in ("tic", "tic_settings"):
        said = remarks(machine, **LOSING)
        assert not [word for word in ("Base speed", "celeration 5,000", "celeration 2,500") if word in said]
        assert "The shape S-curve" in said
    # sqrt(2 · 2500 · 2) = 100 steps/s.
    assert "Base speed" not in remarks("fastaccelstepper", **LOSING)
    # 150² / (2 · 5000) = 2.25 steps: 2 of them lead to sqrt(20,000) = 141.421 steps/s.
    jumped = remarks("fastaccelstepper", ramp__base_speed_steps_per_s=150)
    assert "Base speed 150 steps/s becomes 141.421 steps/s, the speed after 2 whole steps" in jumped
    assert "Base speed" not in remarks("teensystep", **LOSING)
    # sqrt(5000 / 2) = 50 steps/s.
    assert "Base speed 0 steps/s becomes 50 steps/s" in remarks("teensystep")
    assert "Base speed 99.5 steps/s is rounded down to 99 steps/s" in remarks(
        "teensystep", ramp__base_speed_steps_per_s=99.5
    )


def test_rotary_axes_are_told() -> None:
    dial = {"full_steps_per_rev": 200, "microsteps": 1, "travel_per_rev": 360, "travel_unit": "deg"}
    slow = {"axis": dial, "ramp__slew_speed_steps_per_s": 500}
    for machine, name in NAMES.items():
        if machine != "accelstepper":
            assert f"{name} counts in mm: here each stands for a degree." in remarks(machine, **slow)
    # 0.555556 / 0.5555… = 1.0000008: after 1,000 degrees of the machine 0.0008 are missing.
    assert "0.5555555556 steps per mm are kept as 0.555555999" in remarks("marlin", **slow)
    assert "a way of 1,000 degrees comes out 0.0008 degrees long" in remarks("marlin", **slow)
    assert "a way of" not in remarks("klipper", **slow), "it works them out of the way of a turn"


def test_speeds_that_boards_don_t_make_are_told() -> None:
    assert "30,001 steps/s is more than the 30,000 steps/s that grbl" in remarks(
        "grbl", ramp__slew_speed_steps_per_s=30_001
    )
    assert "more than the 4,000 that AccelStepper makes" in remarks("accelstepper", ramp__slew_speed_steps_per_s=4001)
    fast = {"ramp__slew_speed_steps_per_s": 50_001, "ramp__acceleration_steps_per_s2": 100_000}
    assert "Slew speed 50,001 steps/s is more than the 50,000" in remarks("fastaccelstepper", **fast)


@pytest.mark.parametrize(
    ("machine", "changes", "field", "allowed"),
    [
        # 0.002 · 50 = 0.1 steps/s²; 1 / 60 · 50 = 0.8333… steps/s.
        ("grbl", {"ramp__acceleration_steps_per_s2": 0.09}, "ramp.acceleration_steps_per_s2", "from 0.1 to"),
        ("grblhal", {"ramp__slew_speed_steps_per_s": 0.8}, "ramp.slew_speed_steps_per_s", "from 0.833334 to"),
        ("grbl", {"axis__travel_per_rev": 500_000}, "axis.travel_per_rev", "from 0.004 to 400,000 mm"),
        # M201 keeps whole mm/s²: 1 · 50 steps/mm.
        ("marlin", {"ramp__acceleration_steps_per_s2": 49}, "ramp.acceleration_steps_per_s2", "from 50 to 5,000,000"),
        ("marlin", {"ramp__deceleration_steps_per_s2": 7}, "ramp.deceleration_steps_per_s2", "Marlin at 50 steps/mm"),
        # 100,000 mm/min · 50 / 60 = 83,333.3 steps/s.
        ("fluidnc", {"ramp__slew_speed_steps_per_s": 83_334}, "ramp.slew_speed_steps_per_s", "to 83,333.3 steps/s"),
        ("fluidnc", {"axis__travel_per_rev": 0.003}, "axis.travel_per_rev", "from 0.004 to 400,000 mm"),
        ("klipper", {"axis__full_steps_per_rev": 201}, "axis.full_steps_per_rev", "a multiple of 4"),
        ("tic", {"ramp__acceleration_steps_per_s2": 0.5}, "ramp.acceleration_steps_per_s2", "from 1 to 21,474,836.47"),
        ("fastaccelstepper", {"ramp__acceleration_steps_per_s2": 0.5}, "ramp.acceleration_steps_per_s2", "at least 1"),
        ("fastaccelstepper", {"ramp__slew_speed_steps_per_s": 0.06}, "ramp.slew_speed_steps_per_s", "at least 0.064"),
        ("teensystep", {"ramp__slew_speed_steps_per_s": 65_536}, "ramp.slew_speed_steps_per_s", "1 to 65,535 steps/s"),
        ("teensystep", {"ramp__deceleration_steps_per_s2": 5e5 + 1}, "ramp.deceleration_steps_per_s2", "1 to 500,000"),
        ("switecx25", {"table": None}, "table", "a table"),
        ("switecx25", {"table__rows": [[70_000, 600]]}, "table.rows.0.0", "from 0 to 65,535 steps"),
        ("switecx25", {"table__rows": [[9, 65_536]]}, "table.rows.0.1", "up to 65,535 µs"),
        ("switecx25", {"table__rows": [[0, 600]]}, "table.rows.0.0", "from 1 to 65,535 steps in the last row"),
        ("switecx25", {"table__rows": [[row, 9000 - row] for row in range(300)]}, "table.rows", "up to 256 rows"),
        ("switecx25", {"move__steps": 32_767}, "move.steps", "from -32,766 to 32,766"),
    ],
)  # fmt: skip
def test_what_a_machine_can_t_take_is_refused(machine: str, changes: dict[str, Any], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as refused:
        remarks(machine, **changes)
    [rejection] = refused.value.rejections
    assert rejection.field == field
    assert allowed in rejection.allowed


@pytest.mark.parametrize("machine", ["grbl", "grblhal"])
@pytest.mark.parametrize("change", [{"ramp__slew_speed_steps_per_s": 0.001}, {"ramp__acceleration_steps_per_s2": 1e-3}])
def test_what_is_refused_names_the_machine_that_was_asked_for(machine: str, change: dict[str, Any]) -> None:
    with pytest.raises(Rejected) as refused:
        remarks(machine, **change)
    [rejection] = refused.value.rejections
    assert f" with {NAMES[machine]} at 50 steps/mm" in rejection.allowed


def test_axes_that_a_machine_has_not_are_refused() -> None:
    with pytest.raises(Rejected) as refused:
        remarks("grbl", "A")
    [rejection] = refused.value.rejections
    assert (rejection.field, rejection.value, rejection.allowed) == ("axis_letter", "A", "X, Y, Z with grbl")
    assert remarks("grblhal", "C")


def test_the_ends_of_what_is_allowed_are() -> None:
    longest = {"axis__travel_per_rev": 1e6, "axis__full_steps_per_rev": 1, "axis__microsteps": 1}
    assert remarks("marlin", **longest, ramp__slew_speed_steps_per_s=0.9, ramp__acceleration_steps_per_s2=90)
    assert remarks("fluidnc", axis__travel_per_rev=0.004, ramp__acceleration_steps_per_s2=5e5)
    assert remarks("marlin", ramp__acceleration_steps_per_s2=50)
    assert remarks("teensystep", ramp__slew_speed_steps_per_s=65_535)


amounts = st.fractions(min_value=Fraction(1, 1000), max_value=10**9, max_denominator=10**6)


@given(most=amounts, decimals=st.integers(0, 6), in_float=st.booleans())
def test_rounding_down_never_exceeds_and_stays_within_one_step(most: Fraction, decimals: int, in_float: bool) -> None:
    kept = as_float32 if in_float else Fraction
    sent = kept(rounded_down(most, decimals, kept))
    # Two of the float's own steps: one that the text lies above, one that it was put below.
    ulps = 2 * Fraction(float(np.spacing(np.float32(float(most))))) if in_float else Fraction(0)
    assert most - Fraction(1, 10**decimals) - ulps < sent <= most


@given(most=amounts)
def test_a_float_below_is_the_next_one(most: Fraction) -> None:
    below = float_below(most)
    assert Fraction(float(below)) <= most < Fraction(float(np.nextafter(below, np.float32(np.inf))))


@given(
    speed=st.floats(1, 500_000),
    rate=st.floats(10_000, 1e6),
    travel=st.floats(0.5, 100),
    terms=st.sampled_from([MARLIN, FLUIDNC, KLIPPER]),
)
def test_no_machine_is_told_more_than_the_design_says(speed: float, rate: float, travel: float, terms: Terms) -> None:
    asked = design(
        axis__travel_per_rev=travel, ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=rate
    )
    try:
        sent = PerMm.of(asked, terms)
    except Rejected as refused:
        assert {each.limits is not None for each in refused.rejections} == {True}
        return
    resolutions = [
        sent.scale * (Fraction(1, 10**quantity.decimals) + quantity_ulps(value, terms))
        for quantity, value in ((terms.speed, sent.speed), (terms.acceleration, sent.acceleration))
    ]
    assert Fraction(speed) - resolutions[0] / terms.seconds < sent.speed_steps_per_s <= Fraction(str(speed))
    assert Fraction(rate) - resolutions[1] < sent.acceleration_steps_per_s2 <= Fraction(str(rate))


def quantity_ulps(value: str, terms: Terms) -> Fraction:
    spacing = np.spacing(float(value)) if terms is KLIPPER else np.spacing(np.float32(value))
    return 2 * Fraction(float(spacing))
