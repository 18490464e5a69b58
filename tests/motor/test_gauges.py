"""Gauges' motors: the makers' rule for tables, and how far the model is from what makers say."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from designs import design
from motor.trains import NEMA_17
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.motor.gauge_rows import gauge_rows_of
from stepramp.motor.limits import greatest_start_speed
from stepramp.motor.presets import PRESETS, Preset
from stepramp.motor.torque import torque_curve_of, torques_at
from stepramp.motor.train import run_of
from stepramp.motor.verdict import outcome_of

GAUGES = {preset.name.removeprefix("Gauge · "): preset for preset in PRESETS if preset.motor.kind == "gauge"}
MAKERS_ROWS_DEG_PER_S = [259, 399, 492, 560, 600]
LIBRARY = [[10, 5000], [30, 1500], [100, 1000], [150, 800], [300, 600]]


def of_preset(preset: Preset, **changes: Any) -> Design:
    parts = {
        name: part.model_dump(exclude_unset=True)
        for name in ("motor", "drive", "load", "axis")
        if (part := getattr(preset, name)) is not None
    }
    return design(**{"schema": "stepramp/2", "ramp__slew_speed_steps_per_s": 1800.0, **parts, **changes})


def rows_of(name: str, share: float, **changes: Any) -> list[float]:
    """Return the speeds of a gauge's rows [°/s]."""
    return [row.speed / 3 for row in gauge_rows_of(of_preset(GAUGES[name], **changes), share)]


def test_the_rule_reproduces_the_makers_rows_for_the_x27() -> None:
    """Within 1 °/s, with a share of 68.7 %: the one number that is chosen for it, see docs/motor.md."""
    assert rows_of("X27", 0.687) == pytest.approx(MAKERS_ROWS_DEG_PER_S, abs=1.0)


@pytest.mark.parametrize("name", GAUGES)
@pytest.mark.parametrize("share", [0.4, 0.687, 1.0])
def test_each_row_has_the_torque_that_the_rule_says(name: str, share: float) -> None:
    """J (ω_i - ω_(i-1)) ω_i π/180 = M_d(ω_i), but for the last one, which the slew speed ends."""
    inertia = {"X27": 8.1e-7, "X25": 6.8e-7, "VID29": 6.225e-7}[name]
    curve = GAUGES[name].motor.torque_curve
    assert curve is not None
    speeds, before = rows_of(name, share), 0.0
    for speed in speeds[:-1]:
        dynamic = np.interp(speed / 6, [rpm for rpm, _ in curve], [torque for _, torque in curve])
        assert inertia * (speed - before) * speed * math.pi / 180 == pytest.approx(share * dynamic, rel=1e-9)
        before = speed
    assert speeds[-1] == pytest.approx(600)


def test_rows_are_of_full_steps_and_never_faster_than_the_rule() -> None:
    rows = gauge_rows_of(of_preset(GAUGES["X27"]), 0.4)
    assert [row.last_step for row in rows] == [3 * number for number in range(1, len(rows) + 1)]
    assert all(0 <= row.delay_us - 1e6 / row.speed < 1 for row in rows)
    # Load and friction are taken off the share.
    loaded = gauge_rows_of(of_preset(GAUGES["X27"], load={"inertia_g_cm2": 2.0, "friction_nm": 1e-4}), 0.4)
    assert loaded[0].speed < rows[0].speed


def test_rows_end_where_nothing_is_gained() -> None:
    speeds = rows_of("X27", 0.4, ramp__slew_speed_steps_per_s=6000.0)
    # The data end at 600 °/s; the model goes on from there.
    assert 600 < speeds[-1] < 2000
    assert speeds == sorted(speeds)


@pytest.mark.parametrize(
    ("changes", "share", "message"),
    [
        ({"motor": NEMA_17}, 0.4, "motor.kind is 'hybrid'; allowed: gauge"),
        (
            {"axis__full_steps_per_rev": 200, "axis__microsteps": 1},
            0.4,
            "axis.microsteps is 1; allowed: a whole number from 2 to 1,024 per step: a row is a full step of the motor",
        ),
        (
            {
                "axis__full_steps_per_rev": 100_000,
                "axis__microsteps": 1024,
                "load": {"mechanism": {"name": "belt", "pulley_mm": 1e4, "mass_kg": 1e4}},
                "ramp__slew_speed_steps_per_s": 1e6,
            },
            0.4,
            "axis.microsteps is 1024; allowed: fewer, so that",
        ),
        (
            {"axis__microsteps": 1, "load": {"mechanism": {"name": "belt", "pulley_mm": 1e4, "mass_kg": 1e4}}},
            0.4,
            "load is .*; allowed: a load that 40% of the torque brings to 0.001 steps/s in a full step",
        ),
        (
            {"load": {"friction_nm": 5e-3}},
            0.4,
            "load is .*; allowed: a load that the motor moves: of 0.00155 Nm load and ",
        ),
        ({"load": {"friction_nm": 1e-3}}, 0.4, "share is 0.4; allowed: a number from 0.64557[0-9] to 1 of the torque"),
    ],
)
def test_what_has_no_rows_is_refused(changes: dict[str, Any], share: float, message: str) -> None:
    with pytest.raises(Rejected, match=message):
        gauge_rows_of(of_preset(GAUGES["X27"], **changes), share)


@pytest.mark.parametrize("preset", PRESETS, ids=[preset.name for preset in PRESETS])
def test_presets_are_parts_of_designs_and_say_where_their_figures_are_from(preset: Preset) -> None:
    made = of_preset(preset)
    assert made.drive_train is not None
    assert preset.assumed <= preset.sources.keys()
    assert preset.sources["motor.resistance_ohm"] == "datasheet"
    assert preset.sources.keys() >= {f"motor.{field}" for field in preset.motor.model_fields_set}


@pytest.mark.parametrize(("name", "dynamic_nm"), [("X27", 1.45e-3), ("X25", 1.3e-3), ("VID29", 1.2e-3)])
def test_the_dynamic_torque_of_a_gauge_is_its_makers_at_200_deg_per_s(name: str, dynamic_nm: float) -> None:
    train = of_preset(GAUGES[name]).drive_train
    assert train is not None
    at = np.array([math.radians(200)])
    assert train.pull_out_nm(at) == pytest.approx([dynamic_nm], rel=1e-3)
    # The inductance is assumed, so that the model has it, too.
    assert 0.85 * train.model_nm(at) == pytest.approx([dynamic_nm], rel=5e-3)


@pytest.mark.parametrize(("name", "told", "too_fast"), [("X27", 250, 1.6), ("X25", 200, 2.0), ("VID29", 125, 3.2)])
def test_the_model_starts_faster_than_makers_say(name: str, told: float, too_fast: float) -> None:
    """They keep a reserve, or have other pointers in mind; the closed form, without inductance, is farther still."""
    train = of_preset(GAUGES[name]).drive_train
    assert train is not None

    def loses_steps(deg_per_s: float) -> bool:
        return run_of(train, np.full(300, 1 / (3 * deg_per_s)), 0.05).first_lost_step != 0

    assert not loses_steps(told)
    assert loses_steps(told * too_fast)
    assert 2 * told < greatest_start_speed(train) / 3 < 4.7 * told


@pytest.mark.parametrize(
    ("rows", "verdict", "used"), [(LIBRARY, "marginal", 1.22), (None, "marginal", 0.65)], ids=["library", "makers"]
)
def test_what_is_said_of_a_gauges_tables(rows: list[list[int]] | None, verdict: str, used: float) -> None:
    """No step is lost; the library's last row asks, over a full step, for more than the motor has."""
    rows = rows or [[row.last_step, row.delay_us] for row in gauge_rows_of(of_preset(GAUGES["X27"]), 0.687)]
    outcome = outcome_of(
        of_preset(GAUGES["X27"], method__name="table", table={"rows": rows, "interval_unit": "us"}, move__steps=800)
    )
    assert (outcome.verdict, outcome.lost_full_steps) == (verdict, 0)
    assert outcome.most_used == pytest.approx(used, abs=0.01)


def library(**changes: Any) -> Design:
    table = {"rows": LIBRARY, "interval_unit": "us"}
    return of_preset(GAUGES["X27"], **{"method__name": "table", "table": table, "move__steps": 800, **changes})


def test_the_torque_that_is_drawn_of_a_table_is_what_its_rows_ask_for_and_what_the_verdict_counts() -> None:
    """Over a full step of 1°: J (ω_i² - ω_(i-1)²) / 2 = T φ, of rows of 5, 1.5, 1, .8 and .6 ms a third of it."""
    speeds_deg_per_s = [1e6 / delay / 3 for _, delay in LIBRARY]
    squares = [math.radians(speed) ** 2 for speed in speeds_deg_per_s]
    expected = [8.1e-7 * (after - before) / 2 / math.radians(1) for before, after in pairwise(squares)]
    # The ramp that the design has beside its table, slow or never to be made, isn't played.
    impossible = {"name": "torque", "margin": 0.6}
    for ramp in ({}, {"ramp__slew_speed_steps_per_s": 1e6, "ramp__shape": impossible}, {"move__steps": -800}):
        made = library(**ramp)
        between = np.array([(low + high) / 2 for low, high in pairwise(speeds_deg_per_s)]) / 6
        friction = made.drive_train.friction_nm  # type: ignore[union-attr]  # it has a motor
        assert torques_at(made, between).required_nm == pytest.approx(np.array(expected) + friction)
        assert torques_at(made, np.array([100.0])).required_nm == pytest.approx([friction])
        curve = torque_curve_of(made)
        drawn = (curve.torques.required_nm / np.maximum(curve.torques.pull_out_nm, 1e-12))[curve.rpm < 93].max()
        assert drawn == pytest.approx(outcome_of(made).most_used)
        assert curve.speeds[-1] >= 1.25 * 1e6 / 600
    # Of a move that never comes to the last rows, as much as it comes to.
    assert torques_at(library(move__steps=40), between).required_nm == pytest.approx(
        np.array([expected[0], 0, 0, 0]) + friction
    )


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_rows_that_a_short_move_never_comes_to_are_not_counted(rows: int) -> None:
    """As if the table ended before them: the same intervals are played."""

    def used(table: list[list[int]]) -> float:
        parts = {"method__name": "table", "table": {"rows": table, "interval_unit": "us"}}
        return outcome_of(of_preset(GAUGES["X27"], move__steps=2 * LIBRARY[rows - 1][0], **parts)).most_used

    assert used(LIBRARY) == pytest.approx(used(LIBRARY[:rows]))
    assert used(LIBRARY) < 1


def test_the_geared_motor_follows_as_its_maker_says() -> None:
    [preset] = [each for each in PRESETS if "28BYJ" in each.name]
    train = of_preset(preset).drive_train
    assert train is not None
    assert train.steps_per_full_step == 2
    # 34.3 mNm at the shaft at 120 half steps/s; unloaded, friction alone is left at 1000.
    torques = train.pull_out_nm(np.array([120.0, 1000.0]) * train.radians_per_step)
    assert torques * 63.684 == pytest.approx([34.3e-3, 0.05 * 34.3e-3], rel=2e-3)
    assert greatest_start_speed(train) > 600
