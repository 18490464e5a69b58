"""The torque that a motor has and that a ramp asks for: against published curves, and against hand-computed figures."""

import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from designs import design
from motor.trains import AT_24_V, LOADED, NEMA_17, PUBLISHED, with_motor
from stepramp.drive_train import Motor, drive_train_of
from stepramp.errors import Rejected
from stepramp.motor.limits import SUDDEN, greatest_acceleration, greatest_start_speed, required_nm
from stepramp.motor.map_points import design_with
from stepramp.motor.map_ranges import question_of
from stepramp.motor.torque import torques_at
from stepramp.ramp.profile import profile_of
from stepramp.ramp.slopes import full_slopes_of, playable_slopes_of
from stepramp.shapes.torque import TorqueShaped


@pytest.mark.parametrize("name", PUBLISHED)
def test_pull_out_torque_is_within_a_tenth_of_published_curves(name: str) -> None:
    motor, drive, published = PUBLISHED[name]
    train = drive_train_of(motor, drive, None, 3200)
    speeds = np.array([*published]) * 2 * math.pi / 60
    off = train.pull_out_nm(speeds) / np.array([*published.values()]) - 1
    assert math.sqrt(np.mean(off**2)) < 0.1


def test_the_figures_of_a_motor_are_those_of_its_datasheet() -> None:
    train = with_motor().drive_train
    assert train is not None
    # .59 / (√2 · 2) Nm/A at 2 A; √(50 · .4172 / 282e-7) / 2π.
    assert train.static_torque_nm == pytest.approx(0.41719, rel=1e-4)
    assert train.natural_frequency_hz == pytest.approx(136.88, rel=1e-4)
    assert (train.friction_nm, train.detent_nm) == pytest.approx((0.0295, 0.0236))
    # A driver that is set by RMS gives √2 times the peak; without any it is the rated current, as RMS.
    for drive in ({"current_a": 2.0, "current_is": "rms"}, {}):
        by_rms = with_motor(drive=drive).drive_train
        assert by_rms is not None
        assert by_rms.static_torque_nm == pytest.approx(0.59)
    # A gauge: 180 periods a turn of 360 full steps.
    gauge = drive_train_of(Motor(**NEMA_17 | {"kind": "gauge", "full_steps_per_rev": 360}), None, None, 1080)
    assert (gauge.periods_per_rev, gauge.steps_per_full_step) == (180, 3)


def test_required_torque_is_that_of_acceleration_load_and_friction() -> None:
    given_ = with_motor(load=LOADED | {"torque_nm": -0.05, "friction_nm": 0.02})
    # 300,000 steps/s² of 2π / 3200: 589 rad/s², times 282e-7 kg m² = .01661 Nm. Down nothing is counted on friction.
    torques = torques_at(given_, np.array([0.0, 300.0, 599.0, 601.0]))
    assert torques.required_nm == pytest.approx([0.08661, 0.08661, 0.08661, 0.07], rel=1e-3)
    train = given_.drive_train
    assert train is not None
    assert required_nm(train, np.array([-3e5])) == pytest.approx([0.06661], rel=1e-3)


def test_a_measured_point_and_a_pasted_curve_take_the_place_of_the_model() -> None:
    speeds = np.array([50.0, 1180.0, 2000.0])
    measured = with_motor(motor=NEMA_17 | {"stalled": {"rpm": 1180, "torque_nm": 0.16}})
    plain, fitted = torques_at(with_motor(), speeds).pull_out_nm, torques_at(measured, speeds).pull_out_nm
    assert fitted[1] == pytest.approx(0.16)
    assert fitted / plain == pytest.approx([fitted[1] / plain[1]] * 3)
    drawn = with_motor(motor=NEMA_17 | {"torque_curve": [[100, 0.4], [1000, 0.2]]})
    curve = torques_at(drawn, np.array([0.0, 550.0, 1000.0, 2000.0])).pull_out_nm
    assert curve[:3] == pytest.approx([0.4, 0.3, 0.2])
    model = torques_at(with_motor(), np.array([1000.0, 2000.0])).pull_out_nm
    assert curve[3] == pytest.approx(0.2 * model[1] / model[0])
    # With half the current there are at most .59 / (√2 · 2) Nm/A · 1 A of it.
    weaker = with_motor(motor=drawn.motor, drive=AT_24_V | {"current_a": 1.0})
    assert torques_at(weaker, np.array([0.0, 1000.0])).pull_out_nm == pytest.approx([0.20860, 0.2], rel=1e-4)


STALLED: dict[str, Any] = NEMA_17 | {"stalled": {"rpm": 1180, "torque_nm": 0.16}}


def test_what_was_measured_holds_with_the_drive_it_was_measured_with() -> None:
    """k is that of 24 V, 2 A peak, whatever drives the motor now; a curve grows as the model does."""
    speeds = np.array([100.0, 1180.0, 2400.0])
    doubled = AT_24_V | {"supply_v": 48.0}
    model = [torques_at(with_motor(drive=drive), speeds).pull_out_nm for drive in (AT_24_V, doubled)]
    curve = NEMA_17 | {"torque_curve": [[100, 0.3], [1180, 0.16]]}
    for motor in (STALLED, curve):
        then, now = (
            torques_at(with_motor(motor=motor | {"measured_with": AT_24_V}, drive=drive), speeds).pull_out_nm
            for drive in (AT_24_V, doubled)
        )
        assert then == pytest.approx(torques_at(with_motor(motor=motor), speeds).pull_out_nm)
        assert now / then == pytest.approx(model[1] / model[0])
    # What isn't told of that drive is as the design's own has it: the current here.
    told = with_motor(motor=STALLED | {"measured_with": {"supply_v": 24.0}}, drive=doubled)
    assert torques_at(told, speeds[1:2]).pull_out_nm / 0.16 == pytest.approx(model[1][1] / model[0][1])


@given(
    rpm=st.floats(0, 100_000), volts=st.floats(0.5, 1000), then_volts=st.floats(0.5, 1000),
    amperes=st.floats(0.001, 200), ohms=st.floats(0.01, 10_000), millihenry=st.floats(0.01, 10_000),
    curve=st.dictionaries(st.floats(0, 100_000), st.floats(0, 1000), min_size=2, max_size=5),
)  # fmt: skip
def test_a_curve_has_a_torque_at_every_speed_and_never_more_than_is_held(
    rpm: float, volts: float, then_volts: float, amperes: float, ohms: float, millihenry: float,
    curve: dict[float, float],
) -> None:  # fmt: skip
    motor = NEMA_17 | {"resistance_ohm": ohms, "inductance_mh": millihenry, "torque_curve": sorted(curve.items())}
    given_ = with_motor(
        motor=motor | {"measured_with": {"supply_v": then_volts}},
        drive=AT_24_V | {"current_a": amperes, "supply_v": volts},
    )
    train = given_.drive_train
    assert train is not None
    [torque] = train.pull_out_nm(np.array([rpm * 2 * math.pi / 60]))
    assert 0 <= torque <= train.static_torque_nm


@pytest.mark.parametrize("measured_with", [None, AT_24_V])
def test_a_map_over_the_supply_fits_what_was_measured_once(measured_with: dict[str, Any] | None) -> None:
    given_ = with_motor(motor=STALLED | {"measured_with": measured_with})
    question = question_of(given_, "supply_voltage", (12.0, 48.0), None, 8)
    found = [design_with(question, 3e5, value) for value in question.over_values]
    has = [torques_at(each, np.array([1180.0])).pull_out_nm[0] for each in found]
    assert has == sorted(has)
    assert has[-1] > 1.5 * has[4]
    # The fifth of 9 in equal ratios: 24 V.
    assert has[4] == pytest.approx(0.16)


def test_a_current_that_is_not_told_is_the_rated_one_as_rms() -> None:
    for current_is in ("rms", "peak"):
        train = with_motor(drive={"current_is": current_is}).drive_train
        assert train is not None
        assert train.peak_current_a == pytest.approx(2 * 2**0.5)


def test_a_motor_has_the_full_steps_of_its_axis_unless_it_tells_its_own() -> None:
    def periods(**changes: Any) -> float:
        train = with_motor(axis__full_steps_per_rev=400, **changes).drive_train
        assert train is not None
        return train.periods_per_rev

    assert periods() == 100
    assert periods(motor=NEMA_17 | {"full_steps_per_rev": 200}) == 50


def test_a_supply_that_cannot_drive_the_current_limits_what_holds_the_rotor() -> None:
    """2.1 V drive 1.5 A through 1.4 Ω: .59 / (√2 · 2) Nm/A · 1.5 A, √(50 · .3129 / 282e-7) / 2π."""
    low = with_motor(drive=AT_24_V | {"supply_v": 2.1}).drive_train
    as_much = with_motor(drive=AT_24_V | {"current_a": 1.5}).drive_train
    assert low is not None
    assert as_much is not None
    assert low.static_torque_nm == pytest.approx(0.31290, rel=1e-4)
    assert low.natural_frequency_hz == pytest.approx(118.54, rel=1e-4)
    assert greatest_start_speed(low) == pytest.approx(greatest_start_speed(as_much))
    assert greatest_acceleration(low, SUDDEN) == pytest.approx(greatest_acceleration(as_much, SUDDEN))


@given(
    rpm=st.floats(0, 5000), amperes=st.floats(0.01, 5), less=st.floats(0.05, 1),
    volts=st.floats(1, 100), curve=st.sampled_from([None, [[0, 0.4], [600, 0.35]], [[100, 0.2], [2000, 0.15]]]),
)  # fmt: skip
def test_less_current_never_gives_more_torque(
    rpm: float, amperes: float, less: float, volts: float, curve: list[list[float]] | None
) -> None:
    """Neither with a curve nor beyond its last point."""
    motor = NEMA_17 | {"torque_curve": curve}
    speeds = np.array([rpm])
    much, little = (
        torques_at(with_motor(motor=motor, drive=AT_24_V | {"supply_v": volts, "current_a": current}), speeds)
        for current in (amperes, max(amperes * less, 0.001))
    )
    assert little.pull_out_nm[0] <= much.pull_out_nm[0] * (1 + 1e-9)


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"drive": {"current_a": 1.0}}, "drive.current_is", "'rms' or 'peak'"),
        ({"motor": NEMA_17 | {"stalled": {"rpm": 1000, "torque_nm": 2}}}, "motor.stalled.torque_nm", "the model has"),
        (
            # 1.4 Ω at 0.5 V: no torque at 90,000 rpm, whatever k is; so no other torque would do there.
            {
                "motor": NEMA_17 | {"inductance_mh": 0.01, "stalled": {"rpm": 90_000, "torque_nm": 0.1}},
                "drive": AT_24_V | {"supply_v": 0.5},
            },
            "motor.stalled.rpm",
            "a speed at which the model has torque with 0.5 V and 2 A peak: there it has 0 Nm",
        ),
        ({"motor": NEMA_17 | {"torque_curve": [[9, 1], [9, 1]]}}, "motor.torque_curve.1.0", "more than 9 rpm"),
        ({"motor": {}}, "motor.resistance_ohm", "a value"),
        ({"schema": "stepramp/1"}, "schema", "stepramp/2 for a design with motor and drive and load"),
        (
            {"motor": None, "ramp__shape": {"name": "torque", "margin": 0.6}},
            "motor",
            "since ramp.shape.name is 'torque'",
        ),
        ({"ramp__shape": {"name": "torque"}}, "ramp.shape.margin", "the part of the motor's torque that is used"),
    ],
)
def test_what_makes_no_motor_is_refused_by_name(changes: dict[str, Any], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        with_motor(**changes)
    told = {each.field: each.allowed for each in caught.value.rejections}
    assert allowed in told[field]


def test_a_design_without_a_motor_is_what_it_was() -> None:
    assert not {"motor", "drive", "load"} & design().model_dump(by_alias=True).keys()
    with pytest.raises(Rejected, match="motor is missing; allowed: a motor"):
        torques_at(design(), np.array([100.0]))


SHAPED = {"ramp__shape": {"name": "torque", "margin": 0.6}, "ramp__acceleration_steps_per_s2": 1e9}


@settings(max_examples=40)
@given(
    margin=st.floats(0.2, 0.9), slew=st.floats(4000, 90_000), base=st.sampled_from([0.0, 800.0]),
    inertia=st.floats(50, 5000), load=st.floats(-0.03, 0.03), volts=st.sampled_from([12.0, 24.0, 48.0]),
    curve=st.sampled_from([None, [[0, 0.4], [600, 0.35], [1500, 0.2], [3000, 0.15]]]),
)  # fmt: skip
def test_a_ramp_shaped_by_torque_never_asks_for_more_than_its_margin(
    margin: float, slew: float, base: float, inertia: float, load: float, volts: float, curve: list[list[float]] | None
) -> None:
    """But for rounding to ticks, and over a step: its mean acceleration is held against the better of its two ends."""
    try:
        made = with_motor(
            ramp__base_speed_steps_per_s=base, ramp__slew_speed_steps_per_s=slew, move__steps=100_000,
            ramp__acceleration_steps_per_s2=1e9, ramp__shape={"name": "torque", "margin": margin},
            motor=NEMA_17 | {"torque_curve": curve}, drive=AT_24_V | {"supply_v": volts},
            load={"inertia_g_cm2": inertia, "torque_nm": load},
        )  # fmt: skip
        plan = profile_of(made).plan
    except Rejected as error:
        fields = {each.field for each in error.rejections}
        speeds = {"ramp.base_speed_steps_per_s", "ramp.slew_speed_steps_per_s"}
        assert fields <= speeds | {"ramp.shape.margin", "load", "ramp.acceleration_steps_per_s2"}
        return
    train = made.drive_train
    assert train is not None
    for side, sign in ((plan.real.up, 1), (plan.real.down, -1)):
        speeds = np.append(base, 16e6 / np.asarray(side))
        accelerations = np.diff(speeds**2) / 2
        slower, faster = speeds[:-1] * train.radians_per_step, speeds[1:] * train.radians_per_step
        available = np.maximum(train.pull_out_nm(slower), train.pull_out_nm(faster))
        assert (required_nm(train, sign * accelerations) <= margin * available * (1 + 1e-6) + 1e-9).all()


def test_a_torque_ramp_begins_gently_and_is_quicker_than_the_best_constant_one_at_speed() -> None:
    fast = {"ramp__slew_speed_steps_per_s": 80_000.0, "move__steps": 400_000}
    torque = profile_of(with_motor(**fast, **SHAPED))
    train = with_motor().drive_train
    assert train is not None
    # The best constant acceleration with the same margin: what is left at the slew speed.
    left = 0.6 * train.pull_out_nm(np.array([80_000 * train.radians_per_step])) - train.holding_back_nm
    best = float(left[0] / train.inertia_kg_m2 / train.radians_per_step)
    constant = profile_of(with_motor(**fast, ramp__acceleration_steps_per_s2=best))
    seconds = [profile.plan.real.up.sum() / 16e6 for profile in (torque, constant)]
    assert 1.2 < seconds[1] / seconds[0] < 2.5
    # Within the first tenth of a natural period it has not much more than a tenth of the acceleration.
    first = profile_of(with_motor(**fast, **SHAPED, method__name="ideal")).intervals_ticks[0] / 16e6
    whole = (
        (0.6 * train.pull_out_nm(np.zeros(1)) - train.holding_back_nm)[0] / train.inertia_kg_m2 / train.radians_per_step
    )
    assert 2 / first**2 < whole


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"ramp__slew_speed_steps_per_s": 900_000.0}, "ramp.slew_speed_steps_per_s", "at most"),
        ({"load": {"torque_nm": 0.3}}, "ramp.shape.margin", "to move this load at all"),
        ({"load": {"torque_nm": 3.0}}, "load", "load and friction take all of it"),
    ],
)
def test_where_no_torque_is_left_the_ramp_is_refused(changes: dict[str, Any], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**SHAPED | changes))
    [rejection] = caught.value.rejections
    assert rejection.field == field
    assert allowed in rejection.allowed


def test_the_margin_that_is_told_moves_the_load() -> None:
    """Half of 0.02 Nm is what friction takes: that half holds it, and a little more moves it."""
    motor = NEMA_17 | {"torque_curve": [[0, 0.02], [1500, 0.02]]}
    shaped = {"ramp__acceleration_steps_per_s2": 1e4, "motor": motor, "load": {"friction_nm": 0.01}}
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**shaped, ramp__shape={"name": "torque", "margin": 0.5}))
    [rejection] = caught.value.rejections
    assert rejection.field == "ramp.shape.margin"
    assert rejection.limits is not None
    assert rejection.limits.lowest is not None
    assert 0.5 < rejection.limits.lowest < 0.501
    heeded = {"name": "torque", "margin": rejection.limits.lowest}
    slopes = playable_slopes_of(with_motor(**shaped, ramp__slew_speed_steps_per_s=1.0, ramp__shape=heeded))
    assert slopes[0].length > 0


@pytest.mark.parametrize(("asked", "base"), [(1e6, 0.0), (1e4, 0.0), (100.0, 0.0), (1e6, 30.0)])
def test_the_highest_speed_is_told_however_far_beyond_it_the_one_asked_for_is(asked: float, base: float) -> None:
    """By a curve that falls from 0.3 Nm to none at 1 rpm, of which 60 % do for 0.0295 Nm up to 0.836 rpm."""
    motor = NEMA_17 | {"torque_curve": [[0, 0.3], [1, 0.0]]}
    changes = SHAPED | {"motor": motor, "ramp__base_speed_steps_per_s": base}
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**changes, ramp__slew_speed_steps_per_s=asked))
    [rejection] = caught.value.rejections
    assert rejection.limits is not None
    assert rejection.limits.highest is not None
    assert rejection.limits.highest == pytest.approx((1 - 0.0295 / (0.6 * 0.3)) * 3200 / 60, rel=1e-3)
    assert profile_of(with_motor(**changes, ramp__slew_speed_steps_per_s=rejection.limits.highest)).direction == 1


def test_next_to_where_no_torque_is_left_the_ramp_asks_for_no_more_than_there_is() -> None:
    """However much acceleration is asked for."""
    shaped = SHAPED | {"ramp__shape": {"name": "torque", "margin": 0.2}}
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**shaped, ramp__slew_speed_steps_per_s=90_000.0))
    limits = caught.value.rejections[0].limits
    assert limits is not None
    assert limits.highest is not None
    made = with_motor(**shaped, ramp__slew_speed_steps_per_s=limits.highest)
    speeds = np.linspace(0.9, 1, 500) * limits.highest
    slope = full_slopes_of(made)[0]
    assert isinstance(slope, TorqueShaped)
    assert (slope.accelerations(speeds) <= np.maximum(slope.possible(speeds), 1.0) * (1 + 1e-9)).all()


def test_a_ramp_too_long_for_its_torque_is_told_how_fast_it_may_become() -> None:
    """50,000,000 g·cm² take 2,500 s to 600 rpm: v² / 2a, with a of some 20 steps/s²."""
    heavy = SHAPED | {"load": {"inertia_g_cm2": 5e7}, "timer__counter_bits": 64}
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**heavy))
    [rejection] = caught.value.rejections
    assert rejection.field == "ramp.slew_speed_steps_per_s"
    assert rejection.limits is not None
    assert "for a ramp of at most 10,000,000 steps, with this motor's torque" in rejection.allowed
    profile_of(with_motor(**heavy, ramp__slew_speed_steps_per_s=rejection.limits.highest))


def test_the_highest_speed_that_is_told_is_allowed() -> None:
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**SHAPED, ramp__slew_speed_steps_per_s=900_000.0, timer__frequency_hz=1e9))
    limits = caught.value.rejections[0].limits
    assert limits is not None
    told = with_motor(**SHAPED, ramp__slew_speed_steps_per_s=limits.highest, timer__frequency_hz=1e9)
    profile_of(told)


def test_a_motor_that_has_no_torque_where_the_ramp_begins_is_refused() -> None:
    with pytest.raises(Rejected, match="load and friction take all of it"):
        profile_of(with_motor(**SHAPED, motor=NEMA_17 | {"torque_curve": [[0, 0], [500, 0.4]]}))


def test_a_base_speed_at_which_no_torque_is_left_is_refused_itself() -> None:
    """By a curve that falls from 0.3 Nm to none at 600 rpm: 60 % of it do for 0.0295 Nm up to 501.7 rpm."""
    changes = SHAPED | {"motor": NEMA_17 | {"torque_curve": [[0, 0.3], [600, 0]]}}
    with pytest.raises(Rejected) as caught:
        profile_of(with_motor(**changes, ramp__base_speed_steps_per_s=29_000.0, ramp__slew_speed_steps_per_s=31_000.0))
    [rejection] = caught.value.rejections
    assert rejection.field == "ramp.base_speed_steps_per_s"
    assert rejection.limits is not None
    assert rejection.limits.highest == pytest.approx(501.67 * 3200 / 60, rel=1e-3)
    # A margin wouldn't do: with all of the torque it is the same.
    whole = {"ramp__shape": {"name": "torque", "margin": 1.0}, "ramp__slew_speed_steps_per_s": 31_000.0}
    with pytest.raises(Rejected, match=r"ramp.base_speed_steps_per_s is 29000.0; allowed: a number from 0 to 28,85"):
        profile_of(with_motor(**changes | whole, ramp__base_speed_steps_per_s=29_000.0))


def test_what_a_stall_may_have_been_at_is_told_in_figures_that_people_type() -> None:
    with pytest.raises(Rejected) as refused:
        with_motor(motor=NEMA_17 | {"stalled": {"rpm": 1000, "torque_nm": 2}})
    [rejection] = refused.value.rejections
    numbers = re.findall(r"from ([\d.]+) to ([\d.]+)", str(rejection))[0]
    assert all(len(number.replace(".", "").lstrip("0")) <= 6 for number in numbers)
