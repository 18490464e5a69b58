"""The model of the rotor: against the closed forms of a pendulum, its own energy, and itself with finer steps."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from motor.trains import LOADED, pendulum, with_motor
from stepramp.drive_train import Drive, Motor, drive_train_of
from stepramp.motor import train as train_module
from stepramp.motor.limits import greatest_acceleration, greatest_start_speed
from stepramp.motor.step_width import integration_step_s, settling_steps
from stepramp.motor.train import ANGLE, FIELD, SPEED, NotWanted, run_of, swing_of
from stepramp.motor.verdict import outcome_of
from stepramp.numerics.drive_train import DriveTrain


def border(is_lost: Callable[[float], bool], low: float, high: float) -> float:
    assert not is_lost(low)
    assert is_lost(high)
    for _ in range(13):
        middle = (low + high) / 2
        low, high = (low, middle) if is_lost(middle) else (middle, high)
    return low


@pytest.mark.parametrize("load", [0.0, 0.1, 0.3])
def test_the_greatest_start_speed_is_that_of_the_closed_form(load: float) -> None:
    train = pendulum(load)
    told = greatest_start_speed(train)
    found = border(lambda speed: loses(train, np.full(int(0.3 * speed), 1 / speed)), 0.5 * told, 1.5 * told)
    assert told == pytest.approx(found, rel=0.01)
    if load == 0:
        # 8 f_n full steps/s, at 256 steps each.
        assert told / 256 == pytest.approx(8 * train.natural_frequency_hz)


def test_the_greatest_sudden_acceleration_takes_about_seven_tenths_of_the_static_torque() -> None:
    train = pendulum()
    whole = greatest_acceleration(train, 1.0)

    def is_lost(share: float) -> bool:
        steps = np.arange(int(0.5 * share * whole * 0.15**2) + 1)
        return loses(train, np.diff(np.sqrt(2 * steps / (share * whole))))

    assert 0.71 < border(is_lost, 0.5, 1.0) < 0.74


def loses(train: DriveTrain, intervals_s: np.ndarray) -> bool:
    """Tell of a move that goes on, as the closed forms have it: what its end brings isn't asked."""
    run = run_of(train, intervals_s, 0.0)
    return run.first_lost_step > 0 and not run.is_lost_at_end


def test_the_energy_of_a_swing_is_kept() -> None:
    """Undamped, without steps that follow: half a degree within 1 % of the period and of the height, for 12 periods."""
    train = pendulum()
    # One pulse, a step of 60 electrical degrees; then it swings about its end.
    one = replace(train, steps_per_rev=50 * 6)
    run = run_of(one, np.array([1e-6]), 0.0)
    assert run.overshoot_deg == pytest.approx(60.0, rel=0.01)
    assert run.settled_after_s == pytest.approx(12 / one.natural_frequency_hz, rel=0.1)
    damped = run_of(one, np.array([1e-6]), 0.1)
    # exp(-ζ π / √(1 - ζ²)) of a linear swing; a pendulum's of 60° is a little slower.
    assert damped.overshoot_deg / 60 == pytest.approx(math.exp(-0.1 * math.pi / math.sqrt(1 - 0.01)), rel=0.1)


def test_the_energy_of_a_swing_stays_the_same_for_ten_periods() -> None:
    """Kinetic and potential energy of the undamped rotor, let go 60° from where the field pulls it, within 1 %."""
    train = pendulum()
    h = integration_step_s(train)
    constants, state = train_module._constants(train, 0.0, h), np.zeros(len(train_module.STATE))
    state[FIELD] = math.radians(60)
    depth = train.static_torque_nm / train.periods_per_rev
    wanted = train.peak_current_a * np.array([math.cos(state[FIELD]), math.sin(state[FIELD])])
    energies = []
    for _ in range(round(10 / train.natural_frequency_hz / h)):
        train_module._advance(constants, state, *wanted, h, 0.0)
        load_angle = state[FIELD] - train.periods_per_rev * state[ANGLE]
        energies.append(train.inertia_kg_m2 * state[SPEED] ** 2 / 2 - depth * math.cos(load_angle))
    swing = depth * (1 - math.cos(math.radians(60)))
    # Semi-implicit steps let it waver within each period: over whole ones it is kept.
    a_period = round(1 / train.natural_frequency_hz / h)
    means = np.array(energies[: len(energies) // a_period * a_period]).reshape(-1, a_period).mean(1)
    assert np.ptp(means) < 0.01 * swing
    assert means[0] == pytest.approx(-depth * math.cos(math.radians(60)), abs=0.01 * swing)


@pytest.mark.parametrize("speed", [2000.0, 20_000.0, 60_000.0])
def test_what_the_supply_gives_becomes_heat_and_work(speed: float) -> None:
    """At a constant speed, but for the heat of R: load, friction and damping take it. In steps of 1 µs, within 1 %."""
    train = replace(with_motor().drive_train, load_nm=0.05, detent_nm=0.0)  # type: ignore[type-var]
    commanded, parts = speed * train.radians_per_step, max(1, round(1e6 / speed))
    h = 1 / speed / parts
    constants, state = train_module._constants(train, 0.1, h), np.zeros(len(train_module.STATE))
    state[SPEED] = commanded
    drag = 0.2 * 2 * math.pi * train.natural_frequency_hz * train.inertia_kg_m2
    given = taken = 0.0
    steps = 64 * int(0.1 * speed / 64)
    for step in range(2 * steps):
        state[FIELD] += train.periods_per_rev * train.radians_per_step
        wanted = train.peak_current_a * np.array([math.cos(state[FIELD]), math.sin(state[FIELD])])
        for _ in range(parts):
            before, rotor, turning = state[2:4].copy(), state[ANGLE], state[SPEED]
            train_module._advance(constants, state, *wanted, h, commanded)
            if step < steps:
                continue  # Until it turns evenly.
            electrical = train.periods_per_rev * rotor
            back = train.torque_constant_nm_per_a * turning * np.array([-math.sin(electrical), math.cos(electrical)])
            after = state[2:4]
            less_r = train.inductance_h * (after - before) / h + back
            assert (np.abs(less_r + train.resistance_ohm * after) <= train.supply_v * (1 + 1e-9)).all()
            # A current grows evenly over a step of the integration.
            given += float(less_r @ (before + after)) / 2 * h
            torque_nm = train.load_nm + train.friction_nm + drag * (turning - commanded)
            taken += torque_nm * (state[ANGLE] - rotor)
    assert given == pytest.approx(taken, rel=0.01)


def test_half_the_step_of_the_integration_says_the_same() -> None:
    """Of 200 random motions; where they are within 2 % of the border nothing is asked."""
    random = np.random.default_rng(7)
    differ = 0
    for _ in range(200):
        train = replace(
            with_motor().drive_train,  # type: ignore[type-var]
            inertia_kg_m2=random.uniform(1e-5, 1e-4),
            friction_nm=random.uniform(0, 0.05),
            load_nm=random.uniform(-0.05, 0.05),
            supply_v=random.choice([12.0, 24.0, 48.0]),
        )
        fast, steep, damping = random.uniform(5e3, 1.2e5), 10 ** random.uniform(5, 7), random.choice([0.02, 0.05, 0.1])
        verdicts = [
            run_of(train, ramp_s(by * fast, by * steep), damping, finer=finer).first_lost_step > 0
            for by, finer in ((1, 1), (1, 2), (0.98, 1), (1.02, 1))
        ]
        differ += verdicts[0] != verdicts[1] and verdicts[2] == verdicts[3] == verdicts[0]
    assert differ == 0


def ramp_s(speed: float, acceleration: float) -> np.ndarray:
    steps = np.arange(int(speed**2 / (2 * acceleration)) + 2)
    instants = np.sqrt(2 * steps / acceleration)
    return np.append(np.diff(instants), np.full(int(0.1 * speed), 1 / speed))


@pytest.mark.parametrize("play", [run_of, swing_of])
@pytest.mark.parametrize(
    ("intervals_s", "inductance_h"),
    [(np.full(100_000, 1e-4), 3e-3), (np.array([100.0]), 3e-3), (np.array([1e-3]), 3e-15)],
    ids=["many pulses", "a long interval", "a long time of settling"],
)
def test_what_nobody_waits_for_any_more_ends(
    play: Callable[..., object], intervals_s: np.ndarray, inductance_h: float
) -> None:
    """After the second piece, wherever that is; against so little inductance a current swings a million times."""
    train, asked = replace(pendulum(), inductance_h=inductance_h, resistance_ohm=1e-9), []

    def is_wanted() -> bool:
        asked.append(1)
        return len(asked) < 3

    with pytest.raises(NotWanted):
        play(train, intervals_s, 0.0, is_wanted=is_wanted)
    assert len(asked) == 3


def test_a_rotor_that_is_held_is_where_it_should_be() -> None:
    """Of 600 that stop at once, 12 periods later: who lost no step is not behind, and all but odd ones are held."""
    random, lost, held = np.random.default_rng(3), 0, 0
    for _ in range(600):
        train = replace(
            with_motor().drive_train,  # type: ignore[type-var]
            inertia_kg_m2=10 ** random.uniform(-7, -3),
            friction_nm=random.choice([0.0, 0.03]),
            detent_nm=random.choice([0.0, 0.02, 0.2]),
            load_nm=random.uniform(-0.4, 0.4),
            supply_v=random.choice([2.0, 5.0, 24.0]),
            inductance_h=10 ** random.uniform(-4, -1),
            steps_per_rev=float(random.choice([200, 400, 3200])),
        )
        speed = train.natural_frequency_hz * train.steps_per_full_step * 10 ** random.uniform(-1, 1.2)
        intervals_s, damping = np.full(random.integers(1, 60), 1 / speed), random.choice([0.02, 0.05, 0.1])
        run, swing = run_of(train, intervals_s, damping), swing_of(train, intervals_s, damping)
        assert swing.first_lost_step == run.first_lost_step
        assert run.first_lost_step or run.lost_periods == 0
        assert run.settled_after_s <= 12.01 / train.natural_frequency_hz
        lost += run.is_lost_at_end
        held += run.is_held
    assert lost > 20
    assert held >= 595


def test_a_heavy_load_that_swings_for_minutes_is_watched_in_as_many_steps_as_a_light_one() -> None:
    """12 periods of a screw with 10 t at a lead of 10 m are most of an hour."""
    screw = {"mechanism": {"name": "screw", "lead_mm": 1e4, "mass_kg": 1e4}}
    heavy, light = (with_motor(load=load).drive_train for load in (screw, LOADED))
    assert heavy is not None
    assert light is not None
    assert 12 / heavy.natural_frequency_hz > 2500
    assert settling_steps(heavy) == settling_steps(light) == 12 * 200
    run = run_of(heavy, np.array([1.0]), 0.05)
    assert run.first_lost_step == 0
    # A pulse is a sixteenth of a full step: it doesn't leave the end by more.
    assert run.overshoot_deg < 6


@pytest.mark.parametrize("finer", [1, 2])
def test_currents_that_swing_against_the_rotor_faster_than_it_in_the_field_are_resolved(finer: int) -> None:
    """K_m / √(L J) is 2500 times the natural frequency: in steps of 20 µs the speed grew without end."""
    motor = Motor(
        resistance_ohm=2474.0, inductance_mh=6.17, holding_torque_nm=6.66, rated_current_a=0.033,
        rotor_inertia_g_cm2=249.0, full_steps_per_rev=4,
    )  # fmt: skip
    train = drive_train_of(motor, Drive(supply_v=2.87), None, 4)
    run = run_of(train, np.array([1 / 160, 1 / 160]), 0.05, finer=finer)
    assert np.isfinite(run.speeds).all()
    assert np.abs(run.speeds).max() < 1000


def test_a_rotor_that_runs_away_comes_to_the_speed_at_which_damping_holds_the_load() -> None:
    """T_L / D, and no faster, though its currents can't be followed any more."""
    train = replace(pendulum(), load_nm=100.0, supply_v=24.0, inductance_h=0.0753)
    run = run_of(train, np.full(20, 0.1), 0.05)
    drag = 0.1 * 2 * math.pi * train.natural_frequency_hz * train.inertia_kg_m2
    assert run.first_lost_step == 1
    assert run.speeds[-1] * train.radians_per_step == pytest.approx(-100.0 / drag, rel=0.01)
    assert run.lost_periods > 1000


def test_detent_that_is_stronger_than_the_field_is_resolved() -> None:
    """At rest it holds the rotor where it is: 4 N_r T_det / J swings 200 times as fast as the field has it."""
    train = replace(pendulum(), detent_nm=10_000 * pendulum().static_torque_nm)
    run = run_of(train, np.full(200, 1e-3), 0.05)
    assert np.abs(run.speeds).max() < 1


def test_the_rotor_follows_a_move_that_it_can_make() -> None:
    outcome = outcome_of(with_motor())
    run = outcome.runs[0.05]
    assert (run.first_lost_step, run.lost_periods) == (0, 0)
    # At slew speed its mean speed is the commanded one.
    assert run.speeds[4000:6000].mean() == pytest.approx(32_000, rel=1e-3)
    assert run.largest_load_angle_deg < 30
