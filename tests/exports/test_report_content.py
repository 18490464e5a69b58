"""What a report says: the verdicts, units, and methods that fail."""

from datetime import date
from typing import Any

import pytest

from designs import design
from stepramp.exports.printed.checks import checks_of
from stepramp.exports.printed.content import Asked, report_of
from stepramp.ramp.profile import profile_of
from stepramp.units import LengthUnit, TimeUnit

FITS = "Every interval fits in the timer's counter"
SHORT = "No interval is too short for the controller"
FINE = "The timer is fine enough at slew speed"
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
    checks = checks_of(asked, profile)
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
