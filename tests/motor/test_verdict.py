"""What is said of a move: safe, marginal, stalls, and what it comes of."""

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from typing import Any

import pytest

from motor.trains import AT_24_V, LOADED, NEMA_17, with_motor
from stepramp.errors import Rejected
from stepramp.motor import verdict
from stepramp.motor.bounds import refuse_too_long
from stepramp.motor.changes import with_changes
from stepramp.motor.limits import greatest_start_speed
from stepramp.motor.origins import torque_is_measured
from stepramp.motor.presets import PRESETS
from stepramp.motor.proposals import proposals_of
from stepramp.motor.verdict import DAMPINGS, USUAL_DAMPING, cause_of, outcome_of, verdict_of
from stepramp.ramp.plan import real_ramp

MOVES: dict[str, tuple[dict[str, Any], str, str | None]] = {
    "easy": ({}, "safe", None),
    "backwards": ({"move__steps": -10_000}, "safe", None),
    "starts too fast": ({"ramp__base_speed_steps_per_s": 20_000.0}, "stalls", "start"),
    "jerks away": ({"ramp__acceleration_steps_per_s2": 1.2e7}, "stalls", "onset"),
    "too fast": (
        {"ramp__slew_speed_steps_per_s": 150_000.0, "ramp__acceleration_steps_per_s2": 2.5e6, "move__steps": 60_000},
        "stalls", "top_speed",
    ),
    "stops too hard": (
        {"ramp__deceleration_steps_per_s2": 1.2e7, "ramp__slew_speed_steps_per_s": 60_000.0, "move__steps": 20_000},
        "stalls", "stop",
    ),
    "little left": ({"load": LOADED | {"torque_nm": 0.23}}, "marginal", None),
}  # fmt: skip


@pytest.mark.parametrize("name", MOVES)
def test_the_verdict_names_its_cause(name: str) -> None:
    changes, verdict, cause = MOVES[name]
    outcome = outcome_of(with_motor(**changes))
    assert outcome.verdict == verdict
    if cause is not None:
        assert cause_of(outcome) == cause
    assert (cause_of(outcome) is None) == (verdict == "safe")
    assert (outcome.lost_full_steps != 0) == (verdict == "stalls")


def test_a_coarse_timer_is_told_from_a_ramp_that_is_too_hard() -> None:
    # At 1,500 rpm and 1/16 a tick of 4 µs leaves the speeds 16 % apart: 80,000 steps/s are 3.1 ticks.
    coarse = {
        "timer__frequency_hz": 250_000.0, "ramp__slew_speed_steps_per_s": 80_000.0, "move__steps": 40_000,
        "ramp__acceleration_steps_per_s2": 4e5, "load": {"inertia_g_cm2": 80.0},
    }  # fmt: skip
    outcome = outcome_of(with_motor(**coarse))
    assert (outcome.verdict, cause_of(outcome)) == ("stalls", "timer")
    fine = outcome_of(with_motor(**coarse | {"timer__frequency_hz": 16e6}))
    assert fine.verdict != "stalls"


def test_less_voltage_leaves_less_torque_at_speed() -> None:
    fast = {"ramp__slew_speed_steps_per_s": 60_000.0, "move__steps": 40_000, "ramp__acceleration_steps_per_s2": 4e5}
    used = [
        outcome_of(with_motor(**fast, drive=AT_24_V | {"supply_v": volts})).most_used for volts in (48.0, 24.0, 12.0)
    ]
    assert used == sorted(used)


AT_ONCE = {"ramp__base_speed_steps_per_s": 15_432.0, "ramp__slew_speed_steps_per_s": 15_432.0, "move__steps": 64}


def test_a_step_that_is_lost_after_the_last_interval_is_lost() -> None:
    """With little load it stops at once from a speed from which the field doesn't hold it: it goes on by a period."""
    made = with_motor(load={"inertia_g_cm2": 100.0}, **AT_ONCE)
    outcome = outcome_of(made)
    assert (outcome.verdict, outcome.lost_full_steps, cause_of(outcome)) == ("stalls", -4, "stop")
    assert (outcome.worst.first_lost_step, outcome.worst.is_lost_at_end) == (64, True)
    assert verdict_of(made) == "stalls"
    # What is offered is safe also after the last interval.
    offered = proposals_of(made, outcome, "stop")
    assert offered
    assert {outcome_of(with_changes(made, each.changes)).verdict for each in offered} == {"safe"}


def test_a_hanging_load_is_held_from_the_beginning() -> None:
    """Of .8 T_h, which lets the rotor hang 53° behind: a gentle move loses nothing, whichever way it goes."""
    hanging = {"inertia_g_cm2": 200.0, "torque_nm": 0.8 * 0.59 / math.sqrt(2), "friction_nm": 0.0}
    gentle = {"ramp__slew_speed_steps_per_s": 3000.0, "ramp__acceleration_steps_per_s2": 20_000.0}
    for steps in (3000, -3000):
        made = with_motor(motor=NEMA_17 | {"detent_torque_nm": 0}, load=hanging, move__steps=steps, **gentle)
        run = outcome_of(made).runs[0.05]
        assert (run.first_lost_step, run.lost_periods, run.is_held) == (0, 0, True)
        # A pulse takes the field on by 90° / 16.
        assert run.load_angles_deg[0] == pytest.approx(math.copysign(53.13 + 5.625, steps), abs=1)


@pytest.mark.parametrize("steps", [10_000_000, -10_000_000])
def test_moves_that_take_minutes_are_refused_and_what_is_named_is_played(steps: int) -> None:
    made = with_motor(move__steps=steps)
    with pytest.raises(Rejected, match=r"move.steps is .*; allowed: a whole number from .* at most 200 s") as refused:
        refuse_too_long(made, real_ramp(made))
    [rejection] = refused.value.rejections
    assert rejection.limits is not None
    nearest = rejection.limits.highest if steps > 0 else rejection.limits.lowest
    # .106 s of either ramp are at half the speed.
    assert nearest == pytest.approx(math.copysign(32_000 * (200 - 0.106), steps), rel=1e-4)
    for number, is_played in ((int(nearest), True), (int(nearest + math.copysign(1, steps)), False)):
        nearer = with_motor(move__steps=number)
        with nullcontext() if is_played else pytest.raises(Rejected):
            refuse_too_long(nearer, real_ramp(nearer))


@pytest.mark.parametrize("torque_nm", [0.39, 0.45, 3.0])
def test_a_load_that_leaves_nothing_to_start_with_is_told(torque_nm: float) -> None:
    """With 0.0295 Nm of friction it takes all of the static torque, .59 / √2 Nm."""
    outcome = outcome_of(with_motor(load=LOADED | {"torque_nm": torque_nm}))
    assert outcome.verdict != "safe"
    assert greatest_start_speed(outcome.train) == 0


def test_a_speed_without_torque_stalls() -> None:
    curve = {"torque_curve": [[0, 0.4], [500, 0]]}
    made = with_motor(motor=NEMA_17 | curve, load=LOADED | {"friction_nm": 0}, ramp__slew_speed_steps_per_s=32_000.0)
    outcome = outcome_of(made)
    assert (outcome.verdict, outcome.evidence, cause_of(outcome)) == ("stalls", "no_torque", "top_speed")
    assert outcome.most_used == math.inf
    assert verdict_of(made) == "stalls"


MEASURED: dict[str, Any] = {
    "load": LOADED | {"torque_nm": 0.3}, "ramp__slew_speed_steps_per_s": 32_000.0,
    "ramp__acceleration_steps_per_s2": 50_000.0, "move__steps": 40_000,
}  # fmt: skip


@pytest.mark.parametrize(
    "measured", [{"stalled": {"rpm": 600, "torque_nm": 0.1}}, {"torque_curve": [[0, 0.4], [300, 0.39], [600, 0.1]]}]
)
def test_what_was_measured_of_the_torque_counts_whatever_the_rotor_does(measured: dict[str, Any]) -> None:
    """.3 Nm of load, .0295 Nm of friction and some .003 Nm of acceleration, of .1 Nm at 600 rpm."""
    outcome = outcome_of(with_motor(motor=NEMA_17 | measured, **MEASURED))
    assert (outcome.verdict, outcome.evidence, cause_of(outcome)) == ("stalls", "measured_torque", "top_speed")
    assert outcome.most_used == pytest.approx(3.32, abs=0.01)
    assert verdict_of(with_motor(motor=NEMA_17 | measured, **MEASURED)) == "stalls"
    # The rotor knows nothing of it: the motor's other figures give it the torque.
    assert outcome.worst.first_lost_step == 0
    computed = outcome_of(with_motor(motor=NEMA_17 | {"pull_out_factor": 0.26}, **MEASURED))
    assert computed.most_used > 1
    assert (computed.verdict, computed.evidence) == ("marginal", "torque")


@pytest.mark.parametrize("stalled_nm", [0.13, 0.14, 0.1401])
def test_where_it_was_seen_to_stall_it_stalls_again(stalled_nm: float) -> None:
    """At one speed throughout, against .1105 Nm of load and .0295 Nm of friction, in the last bits of which is .14."""
    steady = {"method__name": "table", "table": {"rows": [[40, 100]], "interval_unit": "us"}, "move__steps": 2000}
    load = {"inertia_g_cm2": 100.0, "torque_nm": 0.1105, "friction_nm": 0.0295}
    stalled = {"stalled": {"rpm": 187.5, "torque_nm": stalled_nm}}
    made = with_motor(motor=NEMA_17 | stalled, load=load, **steady)
    outcome, is_enough = outcome_of(made), stalled_nm > 0.14
    assert outcome.most_used == pytest.approx(0.14 / stalled_nm)
    assert (outcome.verdict == "stalls", outcome.evidence == "measured_torque") == (not is_enough, not is_enough)
    assert verdict_of(made) == outcome.verdict


@pytest.mark.parametrize("base_speed", [0.0, 2000.0])
def test_an_acceleration_that_no_step_is_played_with_asks_for_no_torque(base_speed: float) -> None:
    """The first pulse is at slew speed, 125 full steps/s, to which the motor starts at once."""
    at_once = {"ramp__base_speed_steps_per_s": base_speed, "ramp__slew_speed_steps_per_s": 2000.0}
    made = with_motor(ramp__acceleration_steps_per_s2=1e8, **at_once)
    outcome = outcome_of(made)
    assert [phase.name for phase in outcome.profile.phases] == ["slew"]
    # 5 % of .59 Nm, of .85 T_h.
    assert outcome.most_used == pytest.approx(0.0295 / (0.85 * 0.41719), rel=1e-3)
    assert (outcome.verdict, verdict_of(made)) == ("safe", "safe")


def test_more_torque_than_there_is_comes_before_a_resonance() -> None:
    """In full steps, lost within the band of 116 to 157 steps/s: with enough torque and without."""
    slow = {
        "axis__microsteps": 1, "ramp__slew_speed_steps_per_s": 137.0, "ramp__acceleration_steps_per_s2": 5000.0,
        "move__steps": 600, "load": LOADED | {"torque_nm": 0.15},
    }  # fmt: skip
    outcomes = [outcome_of(with_motor(motor=NEMA_17 | {"pull_out_factor": factor}, **slow)) for factor in (0.85, 0.2)]
    for outcome in outcomes:
        assert 116 < outcome.profile.speed_steps_per_s[outcome.worst.first_lost_step - 1] < 157
    assert [outcome.most_used > 1 for outcome in outcomes] == [False, True]
    assert [cause_of(outcome) for outcome in outcomes] == ["resonance", "top_speed"]


@pytest.mark.parametrize("damping", DAMPINGS)
def test_a_rotor_that_is_not_held_with_any_damping_is_not_safe(damping: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def unheld(by: Callable[..., Any], *args: Any, **options: Any) -> Any:
        swing = by(*args, **options)
        return replace(swing, is_held=args[2] != damping)

    for name in ("run_of", "swing_of"):
        monkeypatch.setattr(verdict, name, partial(unheld, getattr(verdict, name)))
    outcome = outcome_of(with_motor())
    assert (outcome.verdict, outcome.evidence) == ("marginal", "load_angle")
    assert verdict_of(with_motor()) == "marginal"


def test_the_evidence_is_the_strongest() -> None:
    told = {name: outcome_of(with_motor(**MOVES[name][0])).evidence for name in ("easy", "too fast", "little left")}
    assert told == {"easy": None, "too fast": "lost_steps", "little left": "torque"}


def test_what_is_told_is_of_the_run_that_is_drawn() -> None:
    """Where steps are lost with the usual damping, no other run's step stands beside the plot of that one."""
    outcome = outcome_of(with_motor(**MOVES["too fast"][0]))
    assert all(run.first_lost_step for run in outcome.runs.values())
    assert outcome.worst is outcome.runs[USUAL_DAMPING]


def test_a_preset_s_curve_is_no_measurement_of_ones_own() -> None:
    [x27] = [preset.motor for preset in PRESETS if preset.name.endswith("X27")]
    curve = x27.torque_curve
    assert curve is not None
    own = x27.model_copy(update={"torque_curve": curve[:-1]})
    designs = [with_motor().model_copy(update={"motor": motor}) for motor in (x27, own)]
    assert [torque_is_measured(design) for design in designs] == [False, True]
