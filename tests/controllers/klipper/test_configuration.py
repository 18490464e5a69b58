"""Klipper's configuration, read as its config file documentation has it, and written so that nothing else changes."""

from __future__ import annotations

import configparser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.klipper.printer import CONFIG, MACROS
from stepramp.controllers.klipper.configuration import Configuration, includes_of, with_option
from stepramp.controllers.klipper.machine import Machine, Senseless
from stepramp.errors import Refused

SAVED = """
#*# <---------------------- SAVE_CONFIG ---------------------->
#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.
#*#
#*# [stepper_z]
#*# position_endstop = 1.250
"""
NUMBER = "allowed: a number from 0.000000001 to 1,000,000,000"
COUNT = "allowed: a whole number from 1 to 1,000,000,000"
PAIRS = "allowed: pairs of numbers above 0, such as 57:11, 2:1"
BLANKS = st.sampled_from(["", " ", "\t", "  "])
COMMENTS = st.sampled_from(["", " # as it came", "\t; max_velocity: 7", "#max_velocity: 9"])


def of(text: str, **others: str) -> Configuration:
    return Configuration({"printer.cfg": text} | others)


def test_sections_comments_includes_and_what_klipper_has_saved_itself() -> None:
    sections = Configuration({"printer.cfg": CONFIG + SAVED, "macros/start.cfg": MACROS}).sections
    assert sections["printer"]["max_velocity"] == "300"
    assert sections["printer"]["max_z_accel"] == "100"
    assert sections["stepper_z"] | {"position_endstop": "1.250"} == sections["stepper_z"]
    assert sections["gcode_macro START"]["gcode"].split() == MACROS.partition("gcode:")[2].split()
    assert "include macros/*.cfg" not in sections


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_any_line_end_that_klipper_reads(end: str) -> None:
    text = (CONFIG + SAVED + "#*# rotation_distance = 4\n").replace("\n", end)
    files = {"printer.cfg": text, "macros/start.cfg": MACROS.replace("\n", end)}
    sections = Configuration(files).sections
    assert sections["stepper_z"]["rotation_distance"] == "4"
    assert sections["stepper_z"]["position_endstop"] == "1.250"
    assert includes_of(text) == ["macros/*.cfg"]
    configuration = Configuration(files)
    place = configuration.place("printer", "max_velocity")
    assert place is not None
    changed = with_option(text, place, "max_velocity", "12.5")
    assert changed == text.replace("max_velocity: 300", "max_velocity: 12.5")


@pytest.mark.parametrize("odd", ["\f", "\v", "\x1c", "\x85", "\u2028", "\u2029"])
def test_what_ends_no_line_for_klipper(odd: str) -> None:
    text = CONFIG.replace("rotation_distance: 32", f"rotation_distance: 32 # a{odd}rotation_distance: 99")
    text = f"# Mine{odd}, of course\n{text}"
    configuration = of(text, **{"macros/start.cfg": MACROS})
    assert configuration.sections == Configuration({"printer.cfg": CONFIG, "macros/start.cfg": MACROS}).sections
    place = configuration.place("printer", "max_accel")
    assert place is not None
    assert with_option(text, place, "max_accel", "1") == text.replace("max_accel: 3000", "max_accel: 1")


def test_the_last_one_counts_also_across_files() -> None:
    main = "[printer]\nmax_velocity: 1\n[include b/*.cfg]\n[include a.cfg]\n[printer]\nmax_accel: 4\n"
    files = {"printer.cfg": main, "b/1.cfg": "[printer]\nmax_velocity: 2\n", "a.cfg": "[printer]\nmax_velocity: 3"}
    configuration = Configuration(files)
    assert configuration.sections["printer"] == {"max_velocity": "3", "max_accel": "4"}
    assert configuration.paths == ["printer.cfg", "b/1.cfg", "a.cfg"]
    place = configuration.place("printer", "max_velocity")
    assert place is not None
    assert (place.path, place.line) == ("a.cfg", 1)
    assert configuration.place("bed_mesh", "speed") is None


def test_an_include_finds_files_beside_the_file_that_has_it_and_no_deeper_ones() -> None:
    files = {"printer.cfg": "[include sub/a.cfg]", "sub/a.cfg": "[include *.cfg]\n[x]\nn: 1", "sub/b.cfg": "[y]\nn: 2"}
    assert set(Configuration(files | {"sub/deep/c.cfg": "[z]\nn: 3"}).sections) == {"x", "y"}
    assert includes_of("[include a.cfg]\n#[include b.cfg]\n[include c/*.cfg] # more\n" + SAVED) == ["a.cfg", "c/*.cfg"]


@given(BLANKS, st.sampled_from([":", "=", ": ", " = "]), COMMENTS, st.sampled_from(["\n", "\r\n"]), st.booleans())
def test_another_value_changes_nothing_else(blank: str, between: str, comment: str, end: str, has_more: bool) -> None:
    lines = ["# max_velocity: 5", "[printer]", f"max_velocity{blank}{between}301{blank}{comment}", "max_accel: 3000"]
    text = end.join(
        ["[mcu]", "max_velocity: 1", *lines, *(["[gcode_macro X]", "gcode:", "  G1 F[1]"] if has_more else [])]
    )
    place = of(text).place("printer", "max_velocity")
    assert place is not None
    changed = with_option(text, place, "max_velocity", "12.5")
    assert changed == text.replace(f"{between}301", f"{between}12.5")
    assert of(changed).sections["printer"]["max_velocity"] == "12.5"


def test_an_option_that_is_not_there_comes_below_its_section() -> None:
    text = "[mcu]\r\n[printer]  # it\r\nmax_accel: 3\r\n"
    place = of(text).place("printer", "max_z_accel")
    assert place is not None
    assert (
        with_option(text, place, "max_z_accel", "2") == "[mcu]\r\n[printer]  # it\r\nmax_z_accel: 2\r\nmax_accel: 3\r\n"
    )


def test_values_are_those_of_the_parser_that_klipper_uses() -> None:
    parser = configparser.RawConfigParser(strict=False, inline_comment_prefixes=(";", "#"))
    parser.read_string(CONFIG)
    expected = {name: dict(parser.items(name)) for name in parser.sections() if not name.startswith("include")}
    assert of(CONFIG).sections == expected


@pytest.mark.parametrize("text", ["max_velocity: 3", "[printer]\nno option\n", "[printer\nmax_velocity: 3"])
def test_what_is_no_configuration_is_refused(text: str) -> None:
    with pytest.raises(Refused, match="The configuration can't be read"):
        _ = of(text)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("kinematics: cartesian", "kinematics: delta", "kinematics are delta"),
        ("max_velocity: 300", "max_velocity: fast", rf"max_velocity of \[printer\] is 'fast'; {NUMBER}"),
        ("max_velocity: 300", "max_velocity: 0", rf"max_velocity of \[printer\] is '0'; {NUMBER}"),
        ("max_z_accel = 100", "max_z_accel = nan", rf"max_z_accel of \[printer\] is 'nan'; {NUMBER}"),
        ("max_accel: 3000", "", r"\[printer\] has no max_accel"),
        ("rotation_distance: 32", "step_distance: 0.01", r"\[stepper_z\] has no rotation_distance"),
        ("microsteps: 16", "", r"\[stepper_x\] has no microsteps"),
        ("microsteps: 16", "microsteps: many", rf"microsteps of \[stepper_x\] is 'many'; {COUNT}"),
        ("microsteps: 16", "microsteps: 0", rf"microsteps of \[stepper_x\] is '0'; {COUNT}"),
        ("rotation: 400", "rotation: 400.5", rf"full_steps_per_rotation of \[stepper_y\] is '400.5'; {COUNT}"),
        ("gear_ratio: 80:20", "gear_ratio: 80", rf"gear_ratio of \[stepper_z\] is '80'; {PAIRS}"),
        ("gear_ratio: 80:20", "gear_ratio: 80:0", rf"gear_ratio of \[stepper_z\] is '80:0'; {PAIRS}"),
        ("gear_ratio: 80:20", "gear_ratio: 80/20", rf"gear_ratio of \[stepper_z\] is '80/20'; {PAIRS}"),
        ("gear_ratio: 80:20", "gear_ratio: 1e9:1, 2:1", r"'1e9:1, 2:1'; allowed: gears of 1:1,000,000,000 to 1,0"),
        ("rotation_distance: 32", "rotation_distance: inf", rf"rotation_distance of \[stepper_z\] is 'inf'; {NUMBER}"),
        ("rotation_distance: 32", "rotation_distance: -8", rf"rotation_distance of \[stepper_z\] is '-8'; {NUMBER}"),
        ("rotation_distance: 32", "rotation_distance: 8,0", rf"rotation_distance of \[stepper_z\] is '8,0'; {NUMBER}"),
    ],
)
def test_a_configuration_that_no_axis_can_be_told_of(old: str, new: str, words: str) -> None:
    assert old in CONFIG
    with pytest.raises(Senseless, match=words):
        Machine.of(of(CONFIG.replace(old, new)).sections)


def test_steps_per_mm_by_full_steps_microsteps_and_gears() -> None:
    machine = Machine.of(of(CONFIG).sections)
    # Rotation_Distance.md: full_steps · microsteps · gear ratio / rotation_distance.
    assert [float(each.steps_per_mm) for each in machine.steppers] == [200 * 16 / 40, 400 * 16 / 40, 200 * 16 * 4 / 32]
