"""Settings that somebody changes at a Marlin's display, and listings of which bytes are lost: nothing is trusted."""

from __future__ import annotations

import copy
from collections.abc import Callable

import pytest

from controllers.bench import at, by, to
from controllers.marlin.bench import Bench
from controllers.marlin.emulator import DEFAULTS, MarlinEmulator
from designs import design
from stepramp.controllers.contract import Activity, AxisCommand
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.controllers.remark import Unwritten
from stepramp.errors import Refused, Rejected


@pytest.fixture(params=[True, False], ids=["tells M92", "lists only"])
def _tells(request: pytest.FixtureRequest, marlin: MarlinEmulator) -> None:
    marlin.tells_scales = request.param


@pytest.mark.parametrize(
    ("code", "letter", "value", "words"),
    [
        ("M92", "X", 160.0, "M92 X is 160, and was 80"),
        ("M201", "X", 20.0, "M201 X is 20, and was 500"),
        ("M204", "T", 30.0, "M204 T is 30, and was 1,000"),
    ],
)
def test_a_push_that_was_worked_out_with_other_settings_is_refused(
    bench: Bench, controller: MarlinController, code: str, letter: str, value: float, words: str
) -> None:
    bench.marlin.change_at_the_display(code, letter, value)
    send = controller.prepare_push([design()], 0)
    with pytest.raises(Refused, match=f"{words} as this push was worked out: it was changed meanwhile"):
        send()
    assert bench.told() == []
    # The next one knows.
    report = controller.prepare_push([design()], 0)()
    assert report.verified
    marlin = bench.marlin.settings
    assert marlin["M203"]["X"] * marlin["M92"]["X"] == 1000
    gain = min(marlin["M201"]["X"], marlin["M204"]["T"]) * marlin["M92"]["X"]
    assert 5000 * 0.96 < gain <= 5000


def test_what_others_have_changed_is_no_hindrance(bench: Bench, controller: MarlinController) -> None:
    """Of settings that the push doesn't depend on."""
    bench.marlin.change_at_the_display("M92", "Y", 160.0)
    bench.marlin.change_at_the_display("M203", "X", 7.0)
    assert controller.prepare_push([design()], 0)().verified


def test_another_scale_after_a_push_is_not_verified(bench: Bench, controller: MarlinController) -> None:
    carry_out = bench.marlin._set

    def changed_at_the_end(code: str, words: dict[str, float]) -> None:
        carry_out(code, words)
        if code == "M203":
            carry_out("M92", {"X": 40.0})

    bench.marlin._set = changed_at_the_end  # type: ignore[method-assign]
    report = controller.prepare_push([design()], 0)()
    assert not report.verified
    assert bench.marlin.eeprom.writes == 0


def test_keeping_stores_what_is_in_use_by_now(bench: Bench, controller: MarlinController) -> None:
    controller.prepare_push([design()], 0, "try")()
    bench.marlin.change_at_the_display("M205", "B", 10_000.0)
    controller.keep()
    assert bench.marlin.eeprom.settings == bench.marlin.settings


# Motions.

MOTIONS: dict[str, Callable[[MarlinController], None]] = {
    "by": lambda controller: controller.move_by(by(800)),
    "to": lambda controller: controller.move_to(to(1200)),
    "run": lambda controller: controller.run(at(500)),
}


@pytest.mark.usefixtures("_tells")
@pytest.mark.parametrize("is_seen", [False, True], ids=["asked at once", "looked at before"])
@pytest.mark.parametrize("begin", MOTIONS)
def test_other_steps_per_mm_move_nothing_other_than_asked(
    bench: Bench, controller: MarlinController, begin: str, is_seen: bool
) -> None:
    controller.move_by(by(400))
    bench.rest()
    controller.set_position(to(300))
    # It counts 400 steps as 800 then, and nothing has moved.
    bench.marlin.change_at_the_display("M92", "X", 160.0)
    assert bench.marlin.position[0] == 800
    made = bench.marlin.steps
    if is_seen:
        status = controller.status()
        assert "Steps per mm (M92) were changed at the machine: X from 80 to 160." in str(status.trouble)
    # Also then: who asks need not have read the status.
    with pytest.raises(Refused, match=r"X from 80 to 160\. Nothing was moved: ask again"):
        MOTIONS[begin](controller)
    status = controller.status()
    assert (status.axes[0].position_steps, status.axes[0].steps_per_mm) == (300, 160)
    assert bench.marlin.steps == made
    MOTIONS[begin](controller)
    if begin == "run":
        bench.ask_for(0.9)
        bench.pass_time(0.5)
        before = bench.marlin.position[0]
        bench.pass_time(0.5)
        assert bench.marlin.position[0] - before == pytest.approx(250, abs=15)
        controller.stop()
        return
    status = bench.rest()
    assert status.trouble is None
    way = {"by": 800, "to": 900}[begin]
    assert bench.marlin.position[0] - 800 == way
    assert status.axes[0].position_steps == 300 + way


@pytest.mark.usefixtures("_tells")
@pytest.mark.parametrize(("axis", "letter", "now"), [(0, "X", 90.0), (2, "Z", 420.0)])
def test_steps_per_mm_set_at_the_display_are_told_at_once_however_near_it_rests_to_0(
    bench: Bench, controller: MarlinController, axis: int, letter: str, now: float
) -> None:
    """Of 10 steps it makes 11, and of 40 42: less than the hundredths of mm tell of a motion."""
    way = {"X": 10, "Z": 40}[letter]
    controller.move_by([AxisCommand(axis, way, "by_steps")])
    bench.rest()
    bench.marlin.lines.clear()
    bench.ask_for(3)
    assert set(bench.marlin.lines) == {"M114"}, "what was begun here, and rests, takes no more questions"
    bench.marlin.change_at_the_display("M92", letter, now)
    status = bench.ask_for(3)
    assert (status.axes[axis].position_steps, status.axes[axis].steps_per_mm) == (way, now)
    assert f"Steps per mm (M92) were changed at the machine: {letter} from" in (status.trouble or "")
    asked = [line for line in bench.marlin.lines if line != "M114"]
    assert asked in (["M92", "M503", "M503"], ["M503", "M503", "M503"]), "once for each change"


def test_a_run_ends_at_its_soft_limits_with_other_steps_per_mm(bench: Bench, controller: MarlinController) -> None:
    controller.move_by(by(400))
    bench.rest()
    bench.marlin.change_at_the_display("M92", "X", 160.0)
    with pytest.raises(Refused, match="ask again"):
        controller.run(at(2000))
    controller.keep_within({0: (-1000, 1000)})
    controller.run(at(2000))
    bench.ask_for(3)
    assert controller.status().axes[0].position_steps == 1000
    assert bench.marlin.position[0] == 800 + 600


def test_a_listing_in_inches_is_seen_before_a_way_is_told(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.on_the_way_out = lambda said: said.replace(b"G21 ; (mm)", b"G20 ; (in)").replace(b"X80.00", b"X3.15")
    with pytest.raises(Refused, match="counts in inches"):
        controller.move_by(by(400))
    assert bench.told() == []
    assert controller.status().activity is Activity.READY


def test_where_it_rests_is_called_the_same_after_a_restore_of_other_steps_per_mm(
    bench: Bench, controller: MarlinController
) -> None:
    text = controller.backup().replace("M92 X80.00", "M92 X160.00")
    controller.move_by(by(400))
    bench.rest()
    assert controller.use_backup(text) == ()
    status = controller.status()
    assert (status.axes[0].position_steps, status.axes[0].steps_per_mm, status.trouble) == (400, 160, None)
    # It was asked for: the next motion is by these.
    controller.move_by(by(160))
    assert bench.rest().axes[0].position_steps == 560


# Backups.


def test_restoring_compares_with_what_is_in_use_by_now(bench: Bench, controller: MarlinController) -> None:
    text = controller.backup()
    controller.move_by(by(400))
    bench.rest()
    bench.marlin.change_at_the_display("M92", "X", 160.0)
    bench.marlin.change_at_the_display("M203", "X", 50.0)
    assert "X from 80 to 160" in str(controller.status().trouble)
    assert controller.use_backup(text) == ()
    assert controller.status().trouble is None
    assert bench.marlin.settings == bench.marlin.eeprom.settings == DEFAULTS


def test_what_could_not_be_written_is_not_stored(bench: Bench, controller: MarlinController) -> None:
    text = controller.backup()
    controller.prepare_push([design()], 0, "try")()
    bench.marlin.lacks = ("M201",)
    remarks = controller.use_backup(text)
    assert any("M201 X500.00 Y500.00 Z100.00 E5000.00 is not as in the backup" in remark for remark in remarks)
    assert "It is not stored, since what is in use isn't what the backup says." in remarks
    assert any(isinstance(each, Unwritten) for each in remarks)
    assert bench.marlin.eeprom.writes == 0
    assert controller.status().on_trial


@pytest.mark.parametrize("nth", [1, 2])
def test_a_byte_lost_on_the_way_makes_no_other_backup(bench: Bench, controller: MarlinController, nth: int) -> None:
    told = [0]

    def lose(said: bytes) -> bytes:
        told[0] += said.count(b"M92 X80.00")
        return said.replace(b"M92 X80.00", b"M92 X0.00") if told[0] == nth else said

    bench.marlin.on_the_way_out = lose
    text = controller.backup()
    assert "echo:  M92 X80.00 Y80.00 Z400.00 E93.00" in text.splitlines()
    assert told[0] > 2


def test_a_byte_lost_while_connecting_makes_no_other_scale(bench: Bench) -> None:
    told = [0]

    def lose(said: bytes) -> bytes:
        told[0] += said.count(b"M92 X80.00")
        return said.replace(b"M92 X80.00", b"M92 X8.00") if told[0] == 1 else said

    bench.marlin.on_the_way_out = lose
    bench.controller.connect()
    assert bench.controller.status().axes[0].steps_per_mm == 80


def test_a_line_that_never_tells_the_same_twice_is_refused(bench: Bench, controller: MarlinController) -> None:
    told = [0]

    def garble(said: bytes) -> bytes:
        told[0] += 1
        return said.replace(b"M92 X80.00", b"M92 X8%d.00" % (told[0] % 10))

    bench.marlin.on_the_way_out = garble
    with pytest.raises(Refused, match="is disturbed: what the controller tells of its settings is another thing each"):
        controller.backup()


# Marlin 1.0.


def test_a_marlin_whose_m204_means_something_else_is_refused(bench: Bench) -> None:
    old = copy.deepcopy(DEFAULTS)
    old["M204"] = {"S": 500.0, "T": 1000.0}
    bench.marlin.firmware = "Marlin V1; Sprinter/grbl mashup for gen6"
    bench.marlin.eeprom.settings = old
    with pytest.raises(Refused, match=r"is older than 1\.1: with M204 it sets S for all moves, and T for retracts"):
        bench.controller.connect()


def test_a_backup_of_one_is_rejected(bench: Bench, controller: MarlinController) -> None:
    text = controller.backup().replace("M204 P500.00 R500.00 T1000.00", "M204 S500.00 T1000.00")
    with pytest.raises(Rejected, match=r"M204 S500\.00 T1000\.00.*from 1\.1 on"):
        controller.use_backup(text)
    assert bench.told() == []
