"""What isn't played through the motor's model: what is named instead is, and a little less isn't."""

import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motor.trains import AT_24_V, NEMA_17, with_motor
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.motor import bounds
from stepramp.motor.bounds import refuse_too_long
from stepramp.motor.train import MOST_LOST
from stepramp.motor.verdict import outcome_of, verdict_of
from stepramp.numerics.ramp import RealRamp
from stepramp.ramp.plan import real_ramp

TINY: dict[str, Any] = {
    "resistance_ohm": 0.0476, "inductance_mh": 12.14, "holding_torque_nm": 40.1, "rated_current_a": 0.0042,
    "rotor_inertia_g_cm2": 5.66e-3, "full_steps_per_rev": 4,
}  # fmt: skip
"""40 Nm of 4 mA: against its inductance it swings with 4e8 Hz."""
ONE: dict[str, Any] = {"move__steps": 1, "ramp__acceleration_steps_per_s2": 10.0, "ramp__slew_speed_steps_per_s": 100.0}


def refusal_of(design: Design) -> Rejection:
    with pytest.raises(Rejected) as refused:
        refuse_too_long(design, real_ramp(design))
    [rejection] = refused.value.rejections
    return rejection


def is_played(design: Design) -> bool:
    try:
        refuse_too_long(design, real_ramp(design))
    except Rejected:
        return False
    return True


@pytest.mark.parametrize(
    ("field", "motor", "changes"),
    [
        ("rotor_inertia_g_cm2", TINY | {"rated_current_a": 0.05}, ONE | {"drive": AT_24_V, "load": None}),
        ("rated_current_a", TINY, ONE | {"drive": None, "load": None}),
        ("rated_current_a", TINY | {"holding_torque_nm": 400.0, "detent_torque_nm": 0}, ONE | {"drive": None}),
        ("detent_torque_nm", NEMA_17 | {"holding_torque_nm": 1e-4, "detent_torque_nm": 1000.0}, ONE),
    ],
)
def test_a_motor_that_would_need_too_many_steps_is_refused_by_a_figure_that_would_do(
    field: str, motor: dict[str, Any], changes: dict[str, Any]
) -> None:
    rejection = refusal_of(with_motor(motor=motor, **changes))
    assert (rejection.field, rejection.value) == (f"motor.{field}", motor[field])
    limits = rejection.limits
    assert limits is not None
    ends = (limits.lowest, 0.99) if limits.lowest is not None else (limits.highest, 1.01)
    assert is_played(with_motor(motor=motor | {field: ends[0]}, **changes))
    assert not is_played(with_motor(motor=motor | {field: ends[0] * ends[1]}, **changes))


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("ramp.slew_speed_steps_per_s", {"ramp__slew_speed_steps_per_s": 0.002, "move__steps": -3}),
        (
            "ramp.acceleration_steps_per_s2",
            {"ramp__acceleration_steps_per_s2": 0.001, "move__plan": "any_move", "move__steps": 1,
             "ramp__slew_speed_steps_per_s": 2.0,
             "ramp__shape": {"name": "drawn", "points": [[0, 0.001], [2, 0.001]]}},
        ),
        ("table.rows.0.1", {"method__name": "table", "move__steps": 2, "table": {"rows": [[3, 300_000_000]]}}),
    ],
)  # fmt: skip
def test_a_step_that_lasts_for_minutes_is_refused_by_what_makes_it_so_slow(field: str, changes: dict[str, Any]) -> None:
    assert refusal_of(with_motor(**changes)).field == field


@pytest.mark.parametrize(
    "changes",
    [
        {"ramp__slew_speed_steps_per_s": 100.0, "ramp__acceleration_steps_per_s2": 0.02,
         "ramp__shape": {"name": "s_curve", "jerk_steps_per_s3": 0.001}, "move__steps": -30_000},
        {"ramp__slew_speed_steps_per_s": 100.0, "ramp__acceleration_steps_per_s2": 0.02, "move__steps": 30_000},
        {"ramp__slew_speed_steps_per_s": 2.0, "move__steps": 30_000},
        {"method__name": "table", "table": {"rows": [[3, 200_000], [40, 30_000]]}, "move__steps": 30_000},
    ],
)  # fmt: skip
def test_as_many_steps_are_named_as_are_played(changes: dict[str, Any]) -> None:
    """With the sign of the move, also of a ramp that never gets to its slew speed."""
    rejection = refusal_of(with_motor(**changes))
    assert rejection.limits is not None
    ends = rejection.limits.lowest, rejection.limits.highest
    assert ends[0 if changes["move__steps"] > 0 else 1] == (1 if changes["move__steps"] > 0 else -1)
    nearest = int(max(ends, key=lambda end: abs(end or 0)) or 0)
    assert is_played(with_motor(**changes | {"move__steps": nearest}))
    assert not is_played(with_motor(**changes | {"move__steps": round(1.01 * nearest) + (1 if nearest > 0 else -1)}))


@pytest.mark.parametrize("full_steps", [4, 200])
def test_a_motor_without_full_steps_of_its_own_has_those_of_the_axis(full_steps: int) -> None:
    parts = {"drive": None, "load": None, "axis__full_steps_per_rev": full_steps, **ONE}
    motor = TINY | {"full_steps_per_rev": None}
    rejection = refusal_of(with_motor(motor=motor, **parts))
    field, limits = rejection.field.removeprefix("motor."), rejection.limits
    assert limits is not None
    assert limits.lowest is not None
    assert is_played(with_motor(motor=motor | {field: limits.lowest}, **parts))
    assert not is_played(with_motor(motor=motor | {field: 0.99 * limits.lowest}, **parts))


def test_the_limits_of_a_motor_are_played_to_the_end() -> None:
    """Where one figure is as odd as is allowed, a move is played, or refused by name: its numbers stay numbers."""
    for current_a in (0.0042, 0.05, 1.0):
        made = with_motor(motor=TINY | {"rated_current_a": current_a}, drive=None, load=None, move__steps=3)
        try:
            outcome = outcome_of(made)
        except Rejected as rejected:
            assert [each.field.partition(".")[0] for each in rejected.rejections] == ["motor"]
        else:
            assert outcome.worst.largest_load_angle_deg < 1e6


def test_what_would_do_is_looked_for_only_where_somebody_reads_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A map, or a search, meets thousands of such moves: each shorter one is planned anew."""
    planned = []

    def counted(design: Design) -> RealRamp:
        planned.append(design.move.steps)
        return real_ramp(design)

    monkeypatch.setattr(bounds, "real_ramp", counted)
    gentle = with_motor(ramp__slew_speed_steps_per_s=100.0, ramp__acceleration_steps_per_s2=0.02, move__steps=30_000)
    with pytest.raises(Rejected) as caught:
        verdict_of(gentle)
    assert planned == []
    assert re.search(r"move.steps is 30000; allowed: a whole number from 1 to .*", str(caught.value))
    assert planned
    tried = len(planned)
    assert [each.field for each in caught.value.rejections] == ["move.steps"]
    assert len(planned) == tried


def figures(least: float, most: float) -> st.SearchStrategy[float]:
    """Return as many small ones as large ones, to four figures."""
    powers = st.floats(math.log10(least), math.log10(most))
    return powers.map(lambda power: min(max(float(f"{10**power:.4g}"), least), most))


@given(
    motor=st.fixed_dictionaries(
        {
            "resistance_ohm": figures(0.01, 1e4), "inductance_mh": figures(0.01, 1e4),
            "holding_torque_nm": figures(1e-6, 1e3), "rated_current_a": figures(1e-3, 100),
            "rotor_inertia_g_cm2": figures(1e-6, 1e8), "full_steps_per_rev": st.integers(4, 10_000),
            "detent_torque_nm": st.none() | figures(1e-6, 1e3),
        }
    ),
    drive=st.fixed_dictionaries({"supply_v": figures(0.5, 1e3)}),
    load=st.fixed_dictionaries({"inertia_g_cm2": figures(1e-6, 1e8), "torque_nm": figures(1e-6, 1e3)}),
    steps=st.integers(-40, 40).filter(bool),
    speed=figures(100, 1e6),
)  # fmt: skip
@settings(max_examples=60)
def test_whatever_is_accepted_is_played_in_numbers_or_refused_by_name(
    motor: dict[str, Any], drive: dict[str, Any], load: dict[str, Any], steps: int, speed: float
) -> None:
    """Over all that a motor may be: nothing grows without end, and both ways to a verdict have the same."""
    made = with_motor(
        motor=motor, drive=drive, load=load, move__steps=steps, ramp__base_speed_steps_per_s=speed,
        ramp__slew_speed_steps_per_s=speed,
    )  # fmt: skip
    try:
        outcome = outcome_of(made)
    except Rejected as rejected:
        assert all(each.field.startswith(("motor.", "move.steps")) for each in rejected.rejections)
        return
    for run in outcome.runs.values():
        told = [run.largest_load_angle_deg, run.overshoot_deg, run.settled_after_s, *run.speeds, *run.load_angles_deg]
        assert np.isfinite(told).all()
        assert abs(run.lost_periods) <= MOST_LOST
    assert verdict_of(made) == outcome.verdict
