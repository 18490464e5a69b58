"""What a report says: the verdicts, units, and methods that fail."""

import math
import re
from datetime import date
from typing import Any

import pytest

from designs import design
from motor.clock import Clock
from motor.trains import AT_24_V, LOADED, NEMA_17, with_motor
from stepramp.exports.printed.checks import checks_of
from stepramp.exports.printed.content import Asked, report_of
from stepramp.exports.printed.motor import MotorPart
from stepramp.exports.printed.motor_plots import described_motor, motor_plots_of
from stepramp.exports.printed.stall_maps import PlayedMap, described_stall_map
from stepramp.motor import patience
from stepramp.ramp.profile import profile_of
from stepramp.units import LengthUnit, ShownUnits, TimeUnit

FITS = "Every interval fits in the timer's counter"
SHORT = "No interval is too short for the controller"
FINE = "The timer is fine enough at slew speed"
STEPS = ShownUnits("steps", "s", 1)
LONG = "The move is long enough for full speed"
RAMP, UP, DOWN = "There is a ramp", "There is a ramp up", "There is a ramp down"


@pytest.mark.parametrize(
    ("changes", "passed", "failed"),
    [
        ({}, {FITS, SHORT, FINE, LONG, RAMP}, set()),
        ({"timer__counter_bits": 14}, {SHORT, FINE, LONG, RAMP}, {FITS}),
        ({"timer__shortest_interval_us": 1001}, {FITS, FINE, LONG, RAMP}, {SHORT}),
        ({"timer__frequency_hz": 90_000}, {FITS, SHORT, LONG, RAMP}, {FINE}),
        ({"move__steps": 50}, {FITS, SHORT, FINE, RAMP}, {LONG}),
        ({"ramp__acceleration_steps_per_s2": 1e6}, {FITS, SHORT, FINE, LONG}, {RAMP}),
        ({"ramp__deceleration_steps_per_s2": 1e6}, {FITS, SHORT, FINE, LONG, UP}, {DOWN}),
        ({"ramp__base_speed_steps_per_s": 1000}, {FITS, SHORT, FINE, LONG}, set()),
        ({"method": {"name": "table"}}, {FITS, SHORT, FINE, LONG}, set()),
    ],
)
def test_each_warning_has_its_verdict(changes: dict[str, Any], passed: set[str], failed: set[str]) -> None:
    asked = design(**changes)
    profile = profile_of(asked)
    checks = checks_of(asked, profile, STEPS)
    assert {check.what for check in checks if check.verdict == "passed"} == passed
    assert {check.what for check in checks if check.verdict == "failed"} == failed
    assert {check.detail for check in checks if not check.passed} == {each.message for each in profile.warnings}
    assert all(check.detail for check in checks)


@pytest.mark.parametrize(
    ("length", "time", "speed", "acceleration"),
    [
        ("steps", "s", "1,000 steps/s", "5,000 steps/s²"),
        ("rev", "s", "2.5 rev/s", "12.5 rev/s²"),
        ("deg", "s", "900 °/s", "4,500 °/s²"),
        ("mm", "min", "1,200 mm/min", "360,000 mm/min²"),
    ],
)
def test_speeds_are_in_the_units_chosen(length: LengthUnit, time: TimeUnit, speed: str, acceleration: str) -> None:
    """400 steps a turn of 8 mm."""
    report = report_of(Asked(design(), None, (), length, time), date(2026, 3, 1))
    rows = dict(row[:2] for row in report.parameters.rows)
    assert (rows["slew speed"], rows["acceleration"]) == (speed, acceleration)
    assert report.lines[0].speed.max() == pytest.approx(float(speed.split(maxsplit=1)[0].replace(",", "")))
    assert report.made.startswith("1 March 2026")


def test_a_method_that_fails_says_why_and_leaves_the_others() -> None:
    report = report_of(Asked(design(table=None), None, ("table", "newton"), "steps", "s"), date(2026, 3, 1))
    rows = {row[0]: row for row in report.methods.rows}
    assert "fails: table is missing" in rows["Table"][-1]
    assert rows["Newton"][1].endswith(" s")
    assert [line.label for line in report.lines] == ["Exact", "Newton"]
    assert report.lookup_table is None


def test_checks_are_told_in_the_units_chosen() -> None:
    """200 steps of 0.02 mm up and down; 1 / 1500 µs are 666.6… steps/s, of which at most 13.3333 mm/s are allowed."""
    short, slow = design(move__steps=100), design(timer__shortest_interval_us=1500)
    told = {
        row[0]: row[2]
        for asked in (short, slow)
        for row in report_of(Asked(asked, None, (), "mm", "s"), date(2026, 3, 1)).checks.rows
        if row[1] == "failed"
    }
    assert told[LONG].startswith("Too short to reach full speed, which takes 4 mm: the move peaks at 14.")
    assert told[SHORT].endswith("use a slew speed of at most 13.3333 mm/s.")
    passed = {row[0]: row[2] for row in report_of(Asked(slow, None, (), "mm", "min"), date(2026, 3, 1)).checks.rows}
    assert passed[LONG] == "It peaks at 1,200 mm/min."


def test_the_points_of_a_drawn_ramp_are_listed() -> None:
    drawn = {"name": "drawn", "points": [[0, 1], [500, 0.75], [1000, 0.2]]}
    asked = Asked(design(schema="stepramp/2", ramp__shape=drawn), None, (), "mm", "s")
    table = report_of(asked, date(2026, 3, 1)).drawn_ramp
    assert table is not None
    assert table.rows == (("1", "0 mm/s", "100 %"), ("2", "10 mm/s", "75 %"), ("3", "20 mm/s", "20 %"))
    assert report_of(Asked(design(), None, (), "mm", "s"), date(2026, 3, 1)).drawn_ramp is None


def motor_part(**changes: Any) -> MotorPart:
    part = report_of(Asked(with_motor(**changes), None, (), "rev", "s"), date(2026, 3, 1)).motor
    assert part is not None
    return part


def test_the_motor_is_told_with_where_its_figures_come_from() -> None:
    screw = {"name": "screw", "lead_mm": 8.0, "mass_kg": 2.0, "incline_deg": 90.0}
    part = motor_part(load={"mechanism": screw})
    rows = {row[0]: row[1:] for row in part.data.rows}
    # These are the figures of a preset, whose data sheet has them.
    assert rows["motor"] == ("NEMA 17 · 17HS19-2004S1", "a preset")
    assert rows["resistance of a phase"] == ("1.4 Ω", "data sheet")
    assert rows["detent torque"] == ("0.0236 Nm", "assumed")
    assert rows["current, peak"] == ("2 A", "given")
    assert rows["full steps of a turn"] == ("200", "those of the axis")
    assert (rows["inertia beside the rotor"], rows["constant torque"]) == (("0 g·cm²", "none"), ("0 Nm", "none"))
    assert rows["screw: lead"] == ("8 mm", "given")
    assert rows["screw: efficiency"] == ("0.4", "assumed")
    # 2 kg · 9.80665 m/s² · 8 mm / 2π, and 1.5 times that is lost in the thread, on top of 5 % of .59 Nm.
    assert rows["constant torque at the shaft"] == ("0.02497 Nm", "computed")
    assert rows["friction at the shaft"] == ("0.06696 Nm", "assumed")


def test_the_verdict_is_told_with_its_cause_and_what_is_not_covered() -> None:
    rows = dict(row for row in motor_part(ramp__acceleration_steps_per_s2=1.2e7).found.rows)
    assert rows["verdict"] == "stalls"
    assert rows["why"] == "the acceleration comes on harder than the motor follows"
    assert re.fullmatch(r"[\d,]+ full steps behind at the end; the first after step \d+", rows["lost"])
    # Stopped at once with little load it goes on by a period.
    at_once = {"ramp__base_speed_steps_per_s": 15_432.0, "ramp__slew_speed_steps_per_s": 15_432.0, "move__steps": 64}
    ahead = dict(row for row in motor_part(load={"inertia_g_cm2": 100.0}, **at_once).found.rows)
    assert ahead["lost"] == "4 full steps too far at the end; the first after step 64"
    # 600 rpm are 10 rev/s; the pendulum starts at 8 · 136.88 full steps/s, less for friction.
    assert rows["greatest start speed"].endswith(" rev/s")
    assert "closed-loop drives" in rows["not covered"]
    # ½ ω_e² = ω_n² (1 + cos φ_L - s (π - φ_L)), to four figures, never more.
    for friction_nm in (0.01, 0.02, 0.03):
        share = friction_nm / (0.59 / math.sqrt(2))
        energy = 1 + math.sqrt(1 - share**2) - share * (math.pi - math.asin(share))
        natural_hz = math.sqrt(50 * 0.59 / math.sqrt(2) / 282e-7) / (2 * math.pi)
        turns = natural_hz * math.sqrt(2 * energy) / 50
        found = dict(row for row in motor_part(load=LOADED | {"friction_nm": friction_nm}).found.rows)
        told = float(found["greatest start speed"].removesuffix(" rev/s"))
        assert turns * 0.999 < told <= turns
    assert rows["what shows it"] == "the model's rotor loses steps"
    none_left = {"torque_curve": [[0, 0.4], [500, 0]]}
    rows = dict(row for row in motor_part(motor=NEMA_17 | none_left).found.rows)
    assert (rows["verdict"], rows["what shows it"]) == ("stalls", "it asks for torque where the motor has none")
    # From 500 rpm on.
    assert rows["torque that is used"].startswith("there is none at 8.33")
    assert "torque that is kept back" not in rows
    rows = dict(row for row in motor_part(motor=NEMA_17 | {"stalled": {"rpm": 600, "torque_nm": 0.05}}).found.rows)
    assert (rows["verdict"], rows["torque that is kept back"]) == ("marginal", "7.78 %; 40 % should be")
    safe = dict(row for row in motor_part().found.rows)
    assert (safe["verdict"], "why" in safe, "lost" in safe) == ("safe", False, False)
    assert safe["torque that is kept back"] == "87 %; 40 % should be"


def test_the_report_tells_the_limits_what_the_rotor_does_what_to_change_and_what_is_faster(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In turns: .59 / √2 Nm of T_h less 5 % of .59 Nm, over 282e-7 kg m²; bands about ½ and once 136.88 full steps."""
    monkeypatch.setattr(patience, "time", Clock())
    part = motor_part(ramp__acceleration_steps_per_s2=1.2e7)
    rows = list(part.found.rows)
    told = dict(rows)
    for name, share in (("greatest sudden acceleration", 0.7246), ("the same over a natural period", 0.97)):
        turns = (share * 0.59 / math.sqrt(2) - 0.0295) / 282e-7 / (2 * math.pi)
        assert told[name].endswith(" rev/s²")
        assert turns * 0.999 < float(told[name].removesuffix(" rev/s²").replace(",", "")) <= turns
    ends = [float(each) for each in re.findall(r"[\d.]+(?= (?:to|rev))", told["resonances"])]
    assert ends == pytest.approx([136.88 / 200 * part for part in (0.425, 0.575, 0.85, 1.15)], rel=1e-3)
    changes = [text for name, text in rows if name == "what would make it safe"]
    assert any(text.startswith("lower the acceleration to") for text in changes)
    assert "within the same margin" in told["the fastest safe ramp"]
    assert part.rotor is not None
    assert [row[0] for row in part.rotor.rows] == ["0.02", "0.05", "0.1"]
    assert all(re.fullmatch(r"after step \d+", row[1]) for row in part.rotor.rows)
    calm = motor_part()
    assert calm.rotor is not None
    assert [row[1] for row in calm.rotor.rows] == ["none"] * 3
    # The more it is damped, the less it swings, and the sooner it rests.
    assert calm.tables == (calm.data, calm.found, calm.rotor)
    for column in (3, 4, 5):
        figures = [float(row[column].rstrip("° %ms")) for row in calm.rotor.rows]
        assert figures == sorted(figures, reverse=True)


def test_what_to_change_is_told_in_the_units_of_the_report(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "time", Clock())
    part = motor_part(ramp__acceleration_steps_per_s2=1.2e7)
    changes = [text for name, text in part.found.rows if name == "what would make it safe"]
    assert changes
    assert not any("steps/s" in text for text in changes)
    assert any(re.match(r"lower the acceleration to [\d,.]+ rev/s²", text) for text in changes)


def test_a_stall_map_is_drawn_in_the_units_of_the_report_with_the_design_on_it() -> None:
    """3200 steps a turn: 800 steps/s are 0.25 rev/s, 6400 steps/s² are 2 rev/s²."""
    played = PlayedMap("slew_speed", (800, 1600, 3200), (6400, 12800, 25600), ((0, 0, 1), (0, 2, 2), (-1, 2, 3)))
    report = report_of(Asked(with_motor(), None, (), "rev", "s", (played,)), date(2026, 3, 1))
    [plot] = report.maps
    assert plot.over_values.tolist() == [0.25, 0.5, 1]
    assert plot.accelerations.tolist() == [2, 4, 8]
    steps_a_turn = 200 * with_motor().axis.microsteps
    ramp = with_motor().ramp
    assert plot.point == pytest.approx(
        (ramp.slew_speed_steps_per_s / steps_a_turn, ramp.acceleration_steps_per_s2 / steps_a_turn)
    )
    words = described_stall_map(plot)
    assert words.startswith(
        "stall map: acceleration, rev/s², over slew speed, from 2 to 8; slew speed, rev/s from 0.25"
    )
    # 3, 1, 3 and 1 of 8 that are known.
    assert "38 % safe, 12 % marginal, 38 % stalls, 12 % not possible" in words


def test_a_motors_plots_are_of_its_torque_and_its_load_angle() -> None:
    part = motor_part()
    torque, angle = motor_plots_of(part)
    assert [label for label, *_ in torque.curves] == ["the motor has", "the ramp asks for"]
    # As far as a quarter beyond 600 rpm.
    assert torque.curves[0][2].max() == pytest.approx(750)
    # .01661 Nm for 300,000 steps/s², and 5 % of .59 Nm for friction.
    assert described_motor(torque).endswith("the ramp asks for from 0.0295 to 0.0461.")
    assert angle.curves[0][2][[0, -1]].tolist() == [1, 10_000]


def test_a_move_that_cannot_be_played_says_why_and_has_no_plots() -> None:
    part = motor_part(move__steps=10_000_000)
    rows = dict(row for row in part.found.rows)
    assert rows["verdict"].startswith("not played: move.steps is 10000000; allowed:")
    assert motor_plots_of(part) == []
    assert motor_plots_of(report_of(Asked(design(), None, (), "mm", "s"), date(2026, 3, 1)).motor) == []


def test_a_measured_point_and_a_driver_left_open_are_told() -> None:
    motor = with_motor().model_dump(by_alias=True)["motor"]
    stalled = motor | {"stalled": {"rpm": 1180, "torque_nm": 0.16}}
    rows = {row[0]: row[1:] for row in motor_part(motor=stalled, drive=None, load=LOADED).data.rows}
    assert rows["pull-out torque"][0].endswith("of the model's: it stalled at 1,180 rpm with 0.16 Nm")
    assert rows["pull-out torque"][1] == "measured"
    assert (rows["supply"], rows["current, rms"]) == (("24 V", "assumed"), ("2 A", "assumed"))
    drawn = motor | {"torque_curve": [[0, 0.4], [1000, 0.2]], "measured_with": AT_24_V}
    rows = {row[0]: row[1:] for row in motor_part(motor=drawn).data.rows}
    assert rows["pull-out torque"] == ("a curve of 2 points", "measured")
    assert rows["measured with"] == ("24 V, 2 A peak", "measured")
    own = motor | {"pull_out_factor": 0.7}
    told = dict.fromkeys(motor_part(motor=own).data.rows)
    assert ("pull-out torque", "0.7 of the model's", "given") in told
    both = motor_part(motor=own | {"torque_curve": drawn["torque_curve"], "stalled": stalled["stalled"]}).data.rows
    assert [row for row in both if row[0] == "pull-out torque"] == [
        ("pull-out torque", "a curve of 2 points", "measured"),
        ("pull-out torque", "0.7 of the model's", "told, but doesn't count"),
        ("pull-out torque", "it stalled at 1,180 rpm with 0.16 Nm", "told, but doesn't count"),
    ]
