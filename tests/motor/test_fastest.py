"""The fastest safe ramps: against a scan of accelerations with the torque's formula written anew."""

import math
import re
from typing import Any

import numpy as np
import pytest

from motor.clock import Clock
from motor.trains import AT_24_V, LOADED, NEMA_17, random_design, with_motor
from stepramp.errors import Change, Rejected
from stepramp.motor.changes import with_changes
from stepramp.motor.fastest import Candidate, Fastest, Figures, fastest_of
from stepramp.motor.fastest_search import SEARCH_S
from stepramp.motor.train import NotWanted
from stepramp.motor.verdict import outcome_of

STEPS_PER_REV = 3200
INERTIA = 282e-7
FRICTION = 0.05 * 0.59


def at_speed(rpm: float, volts: float = 24.0, **changes: Any) -> dict[str, Any]:
    return {
        "ramp__slew_speed_steps_per_s": rpm * STEPS_PER_REV / 60,
        "drive": AT_24_V | {"supply_v": volts},
        "move__steps": 40_000,
        **changes,
    }


def made(fastest: Fastest, shape: str) -> tuple[Candidate, Figures]:
    [candidate] = [each for each in fastest.candidates if each.shape == shape]
    assert candidate.figures is not None, candidate.rejected
    return candidate, candidate.figures


def pull_out(steps_per_s: float, volts: float) -> float:
    """Return .85 min(K I, K (V/Z - K w R/Z²)) of the NEMA 17 at 2 A peak [Nm]."""
    resistance, inductance, constant = 1.4, 3e-3, 0.59 / (math.sqrt(2) * 2.0)
    speed = steps_per_s * 2 * math.pi / STEPS_PER_REV
    impedance = math.hypot(resistance, 50 * speed * inductance)
    return 0.85 * min(constant * 2, constant * (volts / impedance - constant * speed * resistance / impedance**2))


def constant_within(acceleration: float, slew: float, volts: float, margin: float) -> bool:
    """Tell whether a constant acceleration asks nowhere for more than the margin."""
    asked = INERTIA * acceleration * 2 * math.pi / STEPS_PER_REV + FRICTION
    return all(asked <= margin * pull_out(slew * part / 500, volts) for part in range(501))


def s_curve_within(acceleration: float, slew: float, volts: float, margin: float) -> bool:
    """Tell the same of an S-curve whose onset takes a natural period, played over time."""
    period = 2 * math.pi / math.sqrt(50 * (0.59 / math.sqrt(2)) / INERTIA)
    jerk = acceleration / period
    onset = min(period, math.sqrt(slew / jerk))
    whole = 2 * onset + max(slew / acceleration - period, 0.0)
    for part in range(2001):
        time = whole * part / 2000
        if time < onset:
            speed, now = jerk * time**2 / 2, jerk * time
        elif time > whole - onset:
            speed, now = slew - jerk * (whole - time) ** 2 / 2, jerk * (whole - time)
        else:
            speed, now = jerk * onset**2 / 2 + jerk * onset * (time - onset), jerk * onset
        if INERTIA * now * 2 * math.pi / STEPS_PER_REV + FRICTION > margin * pull_out(speed, volts):
            return False
    return True


WITHIN = {"constant": constant_within, "s_curve": s_curve_within}


@pytest.mark.parametrize("shape", WITHIN)
@pytest.mark.parametrize(("rpm", "volts", "margin"), [(1200, 24.0, 0.6), (900, 24.0, 0.6), (1200, 24.0, 0.4)])
def test_the_acceleration_is_the_largest_that_the_margin_allows(
    shape: str, rpm: float, volts: float, margin: float
) -> None:
    _, figures = made(fastest_of(with_motor(**at_speed(rpm, volts)), margin), shape)
    slew, is_within = rpm * STEPS_PER_REV / 60, WITHIN[shape]
    # At rest: beyond that an S-curve need not reach its acceleration, and its jerk is another's.
    at_rest = (margin * pull_out(0, volts) - FRICTION) / INERTIA * STEPS_PER_REV / (2 * math.pi)
    scanned = max(a for a in np.linspace(at_rest / 100, at_rest, 1000) if is_within(a, slew, volts, margin))
    assert figures.acceleration_steps_per_s2 == pytest.approx(scanned, abs=at_rest / 900)
    if scanned < 0.99 * at_rest:
        assert not is_within(1.02 * figures.acceleration_steps_per_s2, slew, volts, margin)
    assert figures.most_used == pytest.approx(margin, abs=0.01) or scanned >= 0.99 * at_rest


@pytest.mark.parametrize("rpm", [300, 900, 1200, 1500])
def test_the_changes_give_the_design_that_move(rpm: float) -> None:
    given = with_motor(**at_speed(rpm), ramp__deceleration_steps_per_s2=1e5)
    fastest = fastest_of(given, 0.6)
    durations = []
    for candidate in fastest.candidates:
        outcome = outcome_of(with_changes(given, candidate.changes))
        assert outcome.verdict == "safe"
        assert candidate.figures is not None
        assert candidate.figures.duration_s == outcome.profile.duration_s
        assert candidate.figures.most_used <= 0.62
        durations.append(outcome.profile.duration_s)
    assert fastest.best is not None
    assert fastest.best.figures is not None
    assert fastest.best.figures.duration_s == min(durations)
    assert fastest.gain == pytest.approx(min(durations[:2]) / durations[2])
    assert isinstance(fastest.present, Figures)
    assert fastest.present.duration_s > min(durations)


@pytest.mark.parametrize(("rpm", "least", "most"), [(900, 1.1, 1.3), (1200, 1.3, 1.9), (1500, 1.3, 1.9)])
def test_at_speed_a_ramp_shaped_by_torque_is_quicker(rpm: float, least: float, most: float) -> None:
    fastest = fastest_of(with_motor(**at_speed(rpm)), 0.6)
    assert fastest.ramp_gain is not None
    assert least < fastest.ramp_gain < most
    assert fastest.best is not None
    assert fastest.best.shape == "torque"
    if rpm > 900:
        assert "instead of" in fastest.words
    # Times in the unit of the cards beside the sentence.
    assert re.search(r"\d ms", fastest.words)
    assert not re.search(r"\b0\.\d+ s", fastest.words)


@pytest.mark.parametrize(("rpm", "volts"), [(300, 24.0), (600, 24.0), (900, 48.0), (1500, 48.0)])
def test_slowly_and_with_many_volts_nothing_is_gained(rpm: float, volts: float) -> None:
    fastest = fastest_of(with_motor(**at_speed(rpm, volts)), 0.6)
    assert fastest.gain is not None
    assert fastest.gain < 1.005
    assert fastest.words.startswith("Nothing is gained")


def test_a_larger_margin_is_quicker_and_said_to_be_marginal() -> None:
    given = with_motor(**at_speed(1200))
    usual, bold = (fastest_of(given, margin) for margin in (0.6, 0.8))
    for shape in ("constant", "s_curve", "torque"):
        candidate, figures = made(bold, shape)
        assert figures.verdict == "marginal"
        assert figures.duration_s < made(usual, shape)[1].duration_s
        runs = outcome_of(with_changes(given, candidate.changes)).runs.values()
        assert not any(run.first_lost_step for run in runs)
    assert "20% of the torque is kept back, which is marginal" in bold.words


def test_what_the_torque_allows_and_the_model_does_not_is_made_gentler() -> None:
    # At 1,500 rpm the rotor comes to lag by over 90° and a step long before the torque is used up.
    for shape in ("constant", "s_curve", "torque"):
        _, figures = made(fastest_of(with_motor(**at_speed(1500)), 0.6), shape)
        assert figures.verdict == "safe"
        assert figures.most_used < 0.55


STARTS_TOO_FAST = {"ramp__base_speed_steps_per_s": 25_000.0}


@pytest.mark.parametrize(
    ("changes", "field", "allowed", "words"),
    [
        (STARTS_TOO_FAST, "ramp.base_speed_steps_per_s", "from 0 to 16,530 steps/s", "base speed is too fast"),
        ({"load": {"torque_nm": 3.0}}, "load", "load and friction take all of it", "the load is too much"),
        ({"load": {"torque_nm": 0.3}}, "margin", "to move this load at all", "that part of the torque doesn't move"),
        ({"move__steps": 10_000_000}, "move.steps", "at most 200 s", "its move is too long to be played"),
        # Nearly the greatest base speed: the closed form allows it, the model doesn't, whatever the acceleration.
        ({"ramp__base_speed_steps_per_s": 15_000.0}, "ramp.base_speed_steps_per_s", "however gentle", "base speed"),
        # At its natural frequency it is lost in full steps; a little slower it isn't.
        (
            {"axis__microsteps": 1, "ramp__slew_speed_steps_per_s": 137.0, "ramp__acceleration_steps_per_s2": 2e4,
             "move__steps": 600, "load": LOADED | {"torque_nm": 0.15}},
            "ramp.slew_speed_steps_per_s", "from 0 to 95", "its slew speed is too fast",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_is_told_with_why(changes: dict[str, Any], field: str, allowed: str, words: str) -> None:
    fastest = fastest_of(with_motor(**changes), 0.6)
    for candidate in fastest.candidates:
        assert (candidate.changes, candidate.figures) == ((), None)
        assert candidate.rejected is not None
        [rejection] = candidate.rejected.rejections
        assert rejection.field == field
        assert allowed in rejection.allowed
    assert (fastest.gain, fastest.ramp_gain, fastest.best) == (None, None, None)
    assert fastest.words.startswith("No ramp is safe with this motor: ")
    assert words in fastest.words


def test_a_start_that_is_too_fast_comes_before_all_else_that_is_wrong() -> None:
    # At 3 V there is little torque at such speeds, either.
    beyond = {"ramp__slew_speed_steps_per_s": 900_000.0, "ramp__base_speed_steps_per_s": 25_000.0}
    fastest = fastest_of(with_motor(**beyond, drive=AT_24_V | {"supply_v": 3.0}), 0.6)
    for candidate in fastest.candidates:
        assert candidate.rejected is not None
        assert [each.field for each in candidate.rejected.rejections] == ["ramp.base_speed_steps_per_s"]
    assert fastest.words == "No ramp is safe with this motor: its base speed is too fast to start at."


@pytest.mark.parametrize("plan", ["this_move", "any_move"])
@pytest.mark.parametrize("slew_speed", [40_000.0, 900_000.0])
def test_a_move_too_short_for_its_slew_speed_asks_for_no_torque_there(plan: str, slew_speed: float) -> None:
    """900,000 steps/s are 17,000 rpm: the move of 600 steps comes to some 30,000 steps/s."""
    short = with_motor(ramp__slew_speed_steps_per_s=slew_speed, move__steps=600, move__plan=plan)
    fastest = fastest_of(short, 0.6)
    for candidate in fastest.candidates:
        assert candidate.figures is not None, candidate.rejected
        assert candidate.figures.peak_speed_steps_per_s < 60_000
        assert outcome_of(with_changes(short, candidate.changes)).verdict == "safe"
    assert fastest.best is not None
    assert fastest.best.figures is not None
    said = "At its slew speed 60% of the torque doesn't move the load: the move never comes to it"
    assert (said in fastest.words) == (slew_speed > 1e5)
    # The same with a slew speed that it needn't come to either: nothing is lost by one that is too high.
    [bounded] = [
        fastest_of(with_motor(ramp__slew_speed_steps_per_s=60_000.0, move__steps=600, move__plan=plan), 0.6).best
    ]
    assert bounded is not None
    assert bounded.figures is not None
    assert fastest.best.figures.duration_s <= 1.05 * bounded.figures.duration_s


@pytest.mark.parametrize("plan", ["this_move", "any_move"])
def test_a_ramp_too_long_to_be_planned_that_the_move_never_comes_to_the_end_of_leads_to_a_lower_speed(
    plan: str,
) -> None:
    """To 10⁶ steps/s with some .2 Nm and 20,000 g·cm² it takes over 10⁷ steps; the move has 2,000."""
    heavy = with_motor(
        load={"inertia_g_cm2": 20_000.0}, ramp__slew_speed_steps_per_s=1e6, ramp__acceleration_steps_per_s2=1e6,
        move__steps=2000, move__plan=plan,
    )  # fmt: skip
    fastest = fastest_of(heavy, 0.6)
    assert all(each.figures is not None for each in fastest.candidates), [each.rejected for each in fastest.candidates]
    # As with a slew speed for which the ramp isn't too long, that it never comes to either.
    other = with_changes(heavy, [Change("ramp.slew_speed_steps_per_s", 30_000.0)])
    for candidate, same in zip(fastest.candidates[:1], fastest_of(other, 0.6).candidates[:1], strict=True):
        assert candidate.figures is not None
        assert same.figures is not None
        assert candidate.figures.duration_s == pytest.approx(same.figures.duration_s, rel=1e-3)
        assert outcome_of(with_changes(heavy, candidate.changes)).verdict == "safe"


@pytest.mark.parametrize("margin", [0.3, 0.8])
def test_no_ramp_uses_more_than_the_margin_that_was_asked_for(margin: float) -> None:
    """Rounded to a coarse timer's ticks a ramp asks for more than before: then it is made gentler."""
    given = random_design(np.random.default_rng(12))
    assert given.timer.frequency_hz == 250e3
    found = [each.figures for each in fastest_of(given, margin).candidates if each.figures is not None]
    assert found
    assert all(figures.most_used <= margin + 0.02 for figures in found)


def test_nothing_is_called_the_fastest_that_is_slower_than_the_design_as_it_is() -> None:
    """Random designs, as they are and short, whole and cut, in floating point and in the integers of a controller."""
    random, safe = np.random.default_rng(7), 0
    for number in range(14):
        given = random_design(random)
        steps = max(1, int(given.move.steps * (1.0, 0.2)[number % 2]))
        changes = [Change("move.steps", steps), Change("move.plan", ("this_move", "any_move")[number // 2 % 2])]
        if number % 3 == 0:
            changes.append(Change("method", given.method.model_dump() | {"name": "newton", "arithmetic": "fixed"}))
        given = with_changes(given, changes)
        present = outcome_of(given)
        fastest = fastest_of(given, 0.6)
        assert isinstance(fastest.present, Figures)
        assert fastest.present.verdict == present.verdict
        assert fastest.present.duration_s == present.profile.duration_s
        assert not any(each.rejected and "arithmetic" in str(each.rejected) for each in fastest.candidates)
        if present.verdict == "safe":
            safe += 1
            assert fastest.best is not None
            assert fastest.best.figures is not None
            assert fastest.best.figures.duration_s <= present.profile.duration_s
            if fastest.best.shape is None:
                assert fastest.words.startswith("Nothing is quicker than the design as it is")
    assert safe > 3


def test_a_design_that_uses_more_than_the_margin_does_not_take_part() -> None:
    # Up to 1,200 rpm at 24 V with 60 % of the torque, asked for 30 %.
    given = with_motor(**at_speed(1200))
    usual = fastest_of(given, 0.6).best
    assert usual is not None
    quick = with_changes(given, usual.changes)
    modest = fastest_of(quick, 0.3)
    assert modest.best is not None
    assert modest.best.shape is not None
    assert "The design as it is takes" in modest.words
    again = fastest_of(quick, 0.6)
    assert again.best is not None
    assert usual.figures is not None
    assert again.best.figures is not None
    assert again.best.figures.duration_s == usual.figures.duration_s


def test_of_a_long_move_as_much_is_played_as_decides() -> None:
    """The same ramps, a hundred times the way; the gain of the ramp is told where it is little of the whole move."""
    short, long = (fastest_of(with_motor(**at_speed(1200, move__steps=steps)), 0.6) for steps in (40_000, 4_000_000))
    for candidate, other in zip(short.candidates, long.candidates, strict=True):
        assert candidate.changes == other.changes
    assert long.words.startswith("Shaped by the torque the ramp up takes")
    assert "of the whole move of" in long.words


@pytest.mark.parametrize(
    "method", [{"name": "first_order"}, {"name": "table"}, {"name": "second_order", "arithmetic": "fixed"}]
)
def test_a_method_that_has_no_such_ramp_is_changed_with_it(method: dict[str, Any]) -> None:
    given = with_motor(**at_speed(600), method=method)
    for candidate in fastest_of(given, 0.6).candidates:
        changed = with_changes(given, candidate.changes)
        stays = candidate.shape == "constant" and method["name"] != "table"
        assert changed.method.name == (method["name"] if stays else "exact")


def test_a_pasted_curve_is_what_counts() -> None:
    drawn = with_motor(**at_speed(900), motor=NEMA_17 | {"torque_curve": [[0, 0.3], [500, 0.1], [1500, 0.08]]})
    _, figures = made(fastest_of(drawn, 0.6), "constant")
    # At 900 rpm it has .092 Nm, of which .0552 do for .0295 of friction and 282e-7 a.
    assert figures.acceleration_steps_per_s2 == pytest.approx((0.0552 - FRICTION) / INERTIA * 3200 / math.tau, rel=2e-3)


def test_a_speed_that_the_first_step_has_needs_no_ramp_to_be_gained_on() -> None:
    """1,000 half steps/s: the motor is there at once."""
    slow = with_motor(**at_speed(60, axis__microsteps=2, ramp__slew_speed_steps_per_s=1000.0, load={}))
    fastest = fastest_of(slow, 0.6)
    assert made(fastest, "torque")[1].ramp_up_s == 0
    assert fastest.ramp_gain is None
    assert fastest.gain == pytest.approx(1, rel=1e-3)


def test_it_ends_when_nobody_waits_and_needs_a_motor() -> None:
    with pytest.raises(NotWanted):
        fastest_of(with_motor(), 0.6, lambda: False)
    with pytest.raises(Rejected, match="motor is missing"):
        fastest_of(with_motor(motor=None, load=LOADED), 0.6)


@pytest.mark.parametrize(
    ("looks", "found", "words"),
    [
        (1e6, [True, True, True], "Shaped by the torque the move takes"),
        (100, [True, True, True], "there may be quicker ones"),
        (60, [True, True, False], "another shape wasn't found in time. The search ended after 10 s"),
        (5, [False, False, False], "In 10 s no safe ramp was found: it takes long to play this move"),
    ],
)
def test_it_ends_when_its_time_is_up_and_says_so(clock: Clock, looks: float, found: list[bool], words: str) -> None:
    """Looked at so many times the clock has come to the end; each shape has a third of that."""
    clock.step_s = SEARCH_S / looks
    fastest = fastest_of(with_motor(**at_speed(1500), ramp__acceleration_steps_per_s2=3e6), 0.6)
    assert [each.figures is not None for each in fastest.candidates] == found
    assert fastest.is_cut_short == (looks < 1e6)
    assert words in fastest.words
    for candidate in fastest.candidates:
        if candidate.figures is not None:
            assert candidate.figures.verdict == "safe"
            continue
        assert candidate.rejected is not None
        [rejection] = candidate.rejected.rejections
        assert (rejection.field, rejection.value) == ("move.steps", 40_000)
        assert "in 10 s no such ramp was found" in rejection.allowed


def test_speeds_that_only_some_shapes_do_for_are_said_to_be_too_high() -> None:
    # At 900 rpm with 12 V the model is lost to its mid-band resonance; gentle ramps never get there.
    fastest = fastest_of(with_motor(**at_speed(900, 12.0)), 0.6)
    assert fastest.candidates[-1].rejected is not None
    assert fastest.best is not None
    assert fastest.best.figures is not None
    assert fastest.best.figures.peak_speed_steps_per_s < 48_000
    assert "not every shape does" in fastest.words
