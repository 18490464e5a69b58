"""What a Marlin tells is rounded to two decimals: no more is sent than asked, and that it is rounded is said."""

from __future__ import annotations

import copy

import pytest

from controllers.bench import at, by
from controllers.marlin.bench import Bench
from controllers.marlin.emulator import DEFAULTS
from designs import design
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.controllers.marlin.read_settings import read_settings


def with_scale(bench: Bench, scale: float) -> MarlinController:
    settings = copy.deepcopy(DEFAULTS)
    settings["M92"]["X"], settings["M203"]["X"] = scale, 5000.0
    bench.marlin.eeprom.settings = settings
    bench.controller.connect()
    bench.marlin.lines.clear()
    return bench.controller


@pytest.mark.parametrize("scale", [8.888889, 2.2249, 2.215, 133.3333, 80.0])
def test_no_more_than_asked_is_sent(bench: Bench, scale: float) -> None:
    controller = with_scale(bench, scale)
    report = controller.prepare_push([design()], 0)()
    assert report.verified
    marlin = bench.marlin.settings
    assert 985 < marlin["M203"]["X"] * marlin["M92"]["X"] <= 1000
    assert 4850 < marlin["M201"]["X"] * marlin["M92"]["X"] <= 5000
    said = [warning for warning in report.warnings if "rounded: speed and acceleration are sent" in warning]
    assert len(said) == (scale != 80)
    controller.run(at(500))
    feeds = [float(line.partition("F")[2]) for line in bench.told() if line.startswith("G1")]
    assert all(495 < feed / 60 * marlin["M92"]["X"] <= 500 for feed in feeds)
    controller.stop()


def test_how_far_it_may_be_off_is_said(bench: Bench) -> None:
    controller = with_scale(bench, 8.888889)
    assert (
        "M92 X is told as 8.89, rounded: speed and acceleration are sent for up to 8.895 steps/mm. Ways of 890 steps "
        "or more may come out a step short or long."
    ) in controller.preview_push([design()], 0).warnings
    controller.move_by(by(60_000))
    status = bench.rest()
    assert status.axes[0].position_steps == bench.marlin.position[0] != 60_000
    assert "rests short of its target: X 8 steps. " in str(status.trouble)
    assert "other steps per mm than it tells (M92), rounded to two decimals: X 8.89." in str(status.trouble)


def test_one_that_goes_too_far_says_so(bench: Bench) -> None:
    controller = with_scale(bench, 2.2249)
    controller.move_by(by(-20_000))
    status = bench.rest()
    assert status.axes[0].position_steps == bench.marlin.position[0] == -20_044
    assert "rests elsewhere than at its target: X 44 steps too far. " in str(status.trouble)


def test_a_speed_is_restored_as_it_was(bench: Bench, controller: MarlinController) -> None:
    """Of three decimals it told two, and was restored faster than it was."""
    controller.prepare_push([design(ramp__slew_speed_steps_per_s=8998.8)], 0)()
    pushed = copy.deepcopy(bench.marlin.eeprom.settings)
    text = controller.backup()
    controller.prepare_push([design()], 0)()
    assert controller.use_backup(text) == ()
    assert bench.marlin.eeprom.settings == pushed


def test_steps_per_mm_that_are_restored_as_they_were_told_are_named(bench: Bench) -> None:
    controller = with_scale(bench, 8.888889)
    text = controller.backup()
    # As after a power cut.
    bench.marlin.change_at_the_display("M92", "X", 80.0)
    assert controller.use_backup(text) == (
        "M92 X8.89 is what Marlin told, rounded to two decimals: where it was set to more, set that again.",
    )
    assert controller.use_backup(text) == ()


@pytest.mark.parametrize(("letter", "axis"), [("X", 0), ("E", 3)])
def test_a_push_of_what_was_read_changes_nothing_though_m204_holds(
    bench: Bench, controller: MarlinController, letter: str, axis: int
) -> None:
    bench.marlin.change_at_the_display("M201", "X", 3000.0)
    controller._learn()
    before = copy.deepcopy(bench.marlin.settings)
    read = read_settings(controller.backup(), design())[axis].design
    preview = controller.preview_push([read], axis)
    assert preview.same
    assert [item.own and item.own.term for item in preview.items] == [
        f"M204 {'R' if letter == 'E' else 'T'}", f"M203 {letter}"
    ]  # fmt: skip
    report = controller.prepare_push([read], axis)()
    assert (report.verified, bench.marlin.settings) == (True, before)
    assert not any("is raised" in warning for warning in report.warnings)
    assert not any(line.startswith(("M201", "M204")) for line in bench.told())


def test_an_axis_is_limited_by_its_own_once_all_others_gain_more(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.change_at_the_display("M201", "X", 3000.0)
    controller._learn()
    # X has 1000 mm/s² of M204 T already, which Y raises to 2000.
    slow, fast = (design(ramp__acceleration_steps_per_s2=gain) for gain in (80_000, 160_000))
    assert controller.prepare_push([slow, fast])().verified
    marlin = bench.marlin.settings
    assert (marlin["M201"]["X"], marlin["M201"]["Y"], marlin["M204"]["T"]) == (1000, 2000, 2000)
