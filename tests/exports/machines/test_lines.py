"""What machines are given for a design, line by line; the figures are worked out by hand beside them."""

import configparser
import re
from typing import Any

import numpy as np
import pytest
import yaml

from designs import design
from exports.test_files import NASTY
from stepramp.controllers.grbl.ramp import GrblRamp
from stepramp.exports.export import Options, export, sheet_of
from stepramp.exports.machines.machines import MACHINES
from stepramp.exports.machines.sheet import Sheet

SCREW = {"full_steps_per_rev": 200, "microsteps": 16, "travel_per_rev": 8.0, "travel_unit": "mm"}
# 200 · 16 / 8 = 400 steps/mm; 20,000 / 400 = 50 mm/s = 3,000 mm/min; 100,000 / 400 = 250 mm/s².
FAST = {"axis": SCREW, "ramp__slew_speed_steps_per_s": 20_000, "ramp__acceleration_steps_per_s2": 100_000}
# 200 / 360 = 0.555… steps per degree.
DIAL = {"axis": {"full_steps_per_rev": 200, "microsteps": 1, "travel_per_rev": 360, "travel_unit": "deg"}}
SETTINGS = [name for name, machine in MACHINES.items() if not machine.is_code]


def sheet(machine: str, letter: Any = "X", **changes: Any) -> Sheet:
    return sheet_of(design(**changes), machine, Options(axis_letter=letter))[1]


def lines(machine: str, letter: Any = "X", **changes: Any) -> list[str]:
    """Return the lines that are no comments."""
    return [line for line in sheet(machine, letter, **changes).text.splitlines() if line and line[0] not in ";#/"]


def test_grbl_is_given_its_settings() -> None:
    assert lines("grbl", **FAST) == ["$100=400", "$110=3000.000", "$120=250.000"]
    assert lines("grbl", "Z", **FAST) == ["$102=400", "$112=3000.000", "$122=250.000"]
    # 1000 / 0.555556 · 60 = 107,999.9136, of which grbl reads eight digits. 5000 / 0.555556 = 8999.9928: 8999.993 would
    # be more, but grbl keeps it in mm/min², in float32, as 32,399,974 / 3600 = 8999.99278.
    assert lines("grblhal", "A", **DIAL) == ["$103=0.555556", "$113=107999.91", "$123=8999.993"]


def test_an_export_is_what_a_push_sends() -> None:
    asked = design(**FAST)
    pushed = GrblRamp.of(asked, np.float32(400))
    assert lines("grbl", **FAST)[1:] == [f"$110={pushed.rate_text}", f"$120={pushed.acceleration_text}"]


def test_marlin_is_sent_its_codes() -> None:
    assert lines("marlin", **FAST) == ["M92 X400", "M203 X50", "M201 X250", "M204 P250 T250", "M500"]
    assert lines("marlin", "Y", **FAST)[:3] == ["M92 Y400", "M203 Y50", "M201 Y250"]
    # 0.555556 steps/degree, in float 0.55555600…; 1000 / 0.555556 = 1799.99856; 5000 / 0.555556 = 8999.99.
    assert lines("marlin", "A", **DIAL) == ["M92 A0.555556", "M203 A1799.998", "M201 A8999", "M204 P8999 T8999", "M500"]


def test_marlins_configuration_names_what_is_to_be_kept() -> None:
    text = sheet("marlin_configuration", "Y", **FAST).text
    assert "#define DEFAULT_AXIS_STEPS_PER_UNIT { X_STEPS_PER_UNIT, 400, Z_STEPS_PER_UNIT, E_STEPS_PER_UNIT }" in text
    assert "#define DEFAULT_MAX_FEEDRATE { X_MAX_FEEDRATE, 50, Z_MAX_FEEDRATE, E_MAX_FEEDRATE }" in text
    assert "#define DEFAULT_ACCELERATION 250\n" in text
    turntable = sheet("marlin_configuration", "A", **DIAL).text
    assert "{ X_MAX_ACCELERATION, Y_MAX_ACCELERATION, Z_MAX_ACCELERATION, 8999, E_MAX_ACCELERATION }" in turntable


def test_fluidnc_gets_items_that_yaml_reads() -> None:
    read = yaml.safe_load(sheet("fluidnc", "Z", name=NASTY, **FAST).text)
    assert read == {"axes": {"z": {"steps_per_mm": 400, "max_rate_mm_per_min": 3000, "acceleration_mm_per_sec2": 250}}}
    # 0.55556 · 1799.985 … : 1000 · 60 / 0.55556 = 107,999.136, more than FluidNC takes; half of it is not.
    slow = {**DIAL, "ramp__slew_speed_steps_per_s": 500}
    read = yaml.safe_load(sheet("fluidnc", "A", **slow).text)["axes"]["a"]
    assert read["steps_per_mm"] == 0.55556
    # 30,000 / 0.55556 = 53,999.568; 5000 / 0.55556 = 8,999.928.
    assert read["max_rate_mm_per_min"] == pytest.approx(53_999.568, abs=0.01)
    assert read["acceleration_mm_per_sec2"] == pytest.approx(8_999.928, abs=0.002)


@pytest.mark.parametrize(
    ("letter", "expected"),
    [
        ("X", {"stepper_x": {}, "printer": {"max_velocity": "50", "max_accel": "250"}}),
        ("Z", {"stepper_z": {}, "printer": {"max_z_velocity": "50", "max_z_accel": "250"}}),
        ("B", {"manual_stepper b": {"velocity": "50", "accel": "250"}}),
    ],
)
def test_klipper_gets_options_that_its_parser_reads(letter: str, expected: dict[str, dict[str, str]]) -> None:
    read = configparser.RawConfigParser(strict=True, inline_comment_prefixes=(";", "#"))
    read.read_string(sheet("klipper", letter, name=NASTY, **FAST).text)
    turn = {"rotation_distance": "8.0", "microsteps": "16", "full_steps_per_rotation": "200"}
    first = next(iter(expected))
    expected[first] = turn | expected[first]
    assert {name: dict(read[name]) for name in read.sections()} == expected


def test_a_tic_gets_what_its_guide_counts_in() -> None:
    changes = {"ramp__base_speed_steps_per_s": 100, "ramp__deceleration_steps_per_s2": 8000.019}
    # Speeds in ten thousandths, accelerations in hundredths; what is beyond is dropped.
    calls = ["starting-speed 1000000", "max-speed 10000000", "max-accel 500000", "max-decel 800001"]
    assert lines("tic", **changes) == [f"ticcmd --{call}" for call in calls]
    read = yaml.safe_load(sheet("tic_settings", name=NASTY, **changes).text)
    assert read == {"starting_speed": 1_000_000, "max_speed": 10_000_000, "max_accel": 500_000, "max_decel": 800_001}


@pytest.mark.parametrize("machine", SETTINGS)
def test_what_is_sent_obeys_nobody_else(machine: str) -> None:
    text = sheet(machine, name=NASTY + "!~?").text
    assert text.isascii()
    # grbl and its kin obey these in comments, too; a comment lasts to the end of its line.
    assert not set("!?~") & set(text)
    assert not [line for line in text.splitlines() if "script" in line and line[0] not in ";#"]


@pytest.mark.parametrize("machine", MACHINES)
def test_the_file_is_what_is_shown(machine: str) -> None:
    file_name, shown = sheet_of(design(), machine, Options())
    made = export(design(), machine, Options())
    assert (made.file_name, made.content.decode()) == (file_name, shown.text)
    assert shown.text.endswith("\n")
    assert all(len(line) <= 140 for line in shown.text.splitlines())


@pytest.mark.parametrize("machine", MACHINES)
def test_each_figure_stands_in_the_text(machine: str) -> None:
    shown = sheet(machine, ramp__base_speed_steps_per_s=150)
    for each in shown.settings:
        assert re.search(rf"(?<![\d.]){re.escape(each.sent)}(?![\d.])", shown.text), each


def test_requested_figures_are_those_of_the_design() -> None:
    asked = [(each.name, each.requested) for each in sheet("marlin", **DIAL).settings]
    # Speeds and accelerations are worked out with the steps that the machine keeps.
    assert asked == [
        ("M92 X", pytest.approx(0.5555555556)),
        ("M203 X", pytest.approx(1000 / 0.555556)),
        ("M201 X", pytest.approx(5000 / 0.555556)),
        ("M204 P T", pytest.approx(5000 / 0.555556)),
    ]
