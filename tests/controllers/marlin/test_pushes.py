"""Pushing designs to a Marlin: settings, rounded down, stored and loaded again, and backed up before."""

from __future__ import annotations

import copy
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.bench import by, only_rejection, to
from controllers.marlin.bench import Bench
from controllers.marlin.emulator import DEFAULTS
from designs import design
from stepramp.controllers.contract import OwnTerms, PushReport
from stepramp.controllers.marlin.backup import Backup
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.controllers.marlin.ramp import marlin_ramp
from stepramp.controllers.marlin.read_settings import read_settings
from stepramp.controllers.marlin.settings import Settings, is_same
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused, Rejected

OWN_INTERVALS = "The method Exact is not kept: Marlin works its intervals out itself."
STARTS = "Base speed 0 steps/s is not kept: Marlin starts and ends at 120 steps/s."
SCALE = "The design has 50 steps per mm, Marlin 80 per mm: the design's steps are sent, not its lengths."
ROUNDED = "Acceleration 5,000 steps/s² is rounded down to 4,960 steps/s²."


def push(controller: MarlinController, *designs: Design, axis: int | None = 0, mode: str = "keep") -> PushReport:
    return controller.prepare_push(designs, axis if len(designs) == 1 else None, mode)()  # type: ignore[arg-type]


def stored(bench: Bench) -> dict[str, dict[str, float]]:
    assert bench.marlin.eeprom.settings is not None
    return bench.marlin.eeprom.settings


def test_what_is_sent_and_read_back(bench: Bench, controller: MarlinController) -> None:
    report = push(controller, design(), axis=1)
    # 1000 / 80 = 12.5 mm/s; 5000 / 80 = 62.5 mm/s², of which M201 keeps 62.
    assert bench.told() == ["M201 Y62", "M203 Y12.5", "M500", "M501"]
    assert (stored(bench)["M201"]["Y"], stored(bench)["M203"]["Y"]) == (62.0, 12.5)
    gain, speed = report.items
    assert (speed.requested, speed.sent, speed.read_back, speed.unit, speed.axis) == (1000, 1000, 1000, "steps/s", 1)
    assert speed.own == OwnTerms("M203 Y", "mm/s", 12.5, 12.5)
    assert (gain.requested, gain.sent, gain.own) == (5000, 4960, OwnTerms("M201 Y", "mm/s²", 62.0, 62.0))
    assert (report.verified, report.kept, report.sequence, report.segments) == (True, True, None, None)
    assert report.warnings == (STARTS, OWN_INTERVALS, ROUNDED, SCALE)
    assert bench.marlin.steps == 0
    assert not controller.status().on_trial


def test_what_was_sent_before_a_refusal_is_known(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.lacks = ("M203",)
    with pytest.raises(Refused, match=r"refuses 'M203 Y12\.5': it knows no such command"):
        push(controller, design(), axis=1)
    assert controller.preview_push([design()], 1).items[0].on_device == 4960
    assert controller.status().on_trial


def test_an_acceleration_that_all_axes_share_is_raised_but_never_lowered(
    bench: Bench, controller: MarlinController
) -> None:
    fast = design(ramp__acceleration_steps_per_s2=160_000)
    report = push(controller, fast, design(), axis=None)
    # 160,000 / 80 = 2000 mm/s², and M204 T is 1000.
    # What becomes more comes last.
    assert bench.told()[:5] == ["M203 X12.5", "M201 Y62", "M203 Y12.5", "M201 X2000", "M204 T2000"]
    assert stored(bench)["M204"] == {"P": 500, "R": 500, "T": 2000}
    assert report.items[-1].own == OwnTerms("M204 T", "mm/s²", 2000.0, 2000.0)
    assert (report.items[-1].name, report.items[-1].sent) == ("Acceleration, for all axes", 160_000)
    assert any("M204 T is raised to 2000 mm/s²: it holds for all axes" in loss for loss in report.warnings)


def test_the_extruder_on_its_own_has_the_acceleration_of_a_retract(bench: Bench, controller: MarlinController) -> None:
    push(controller, design(), axis=3)
    # 5000 / 93 = 53.76 mm/s², 1000 / 93 = 10.7526… mm/s.
    assert bench.told()[:3] == ["M201 E53", "M203 E10.75", "M204 R53"]
    assert controller._places.axes[3].effective_acceleration == 53


def test_a_preview_says_what_would_change_and_what_is_lost(controller: MarlinController) -> None:
    preview = controller.preview_push([design(ramp__base_speed_steps_per_s=100)], 0)
    gain, speed = preview.items
    assert (speed.on_device, speed.to_send, speed.differs) == (40_000, 1000, True)
    assert gain.own == OwnTerms("M201 X", "mm/s²", 62.0, 500.0)
    assert not preview.same
    assert preview.warnings == (
        "Base speed 100 steps/s is not kept: Marlin starts and ends at 120 steps/s.",
        OWN_INTERVALS,
        ROUNDED,
        SCALE,
    )
    push(controller, design())
    assert controller.preview_push([design()], 0).same


def test_where_jerk_is_built_in_a_move_begins_with_it(bench: Bench) -> None:
    bench.marlin.on_the_way_out = lambda said: said.replace(b"J0.08", b"X10.00 Y10.00 Z0.40 E5.00")
    bench.controller.connect()
    warnings = bench.controller.preview_push([design()], 0).warnings
    assert "M205 X10: a move begins at up to 800 steps/s at once, without a ramp." in warnings


def test_trying_and_rolling_back(bench: Bench, controller: MarlinController) -> None:
    report = push(controller, design(), mode="try")
    assert (report.verified, report.kept, bench.marlin.eeprom.writes) == (True, False, 0)
    assert "forgets these settings" in report.warnings[-1]
    assert (controller.status().on_trial, bench.marlin.settings["M203"]["X"]) == (True, 12.5)
    controller.roll_back()
    assert (controller.status().on_trial, bench.marlin.settings) == (False, DEFAULTS)
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()
    push(controller, design(), mode="try")
    controller.keep()
    assert stored(bench)["M203"]["X"] == 12.5
    assert not controller.status().on_trial


def test_one_that_stores_nothing_says_so(bench: Bench) -> None:
    bench.marlin.has_eeprom = False
    bench.controller.connect()
    report = push(bench.controller, design())
    assert (report.verified, report.kept) == (True, False)
    assert any("built without EEPROM_SETTINGS" in warning for warning in report.warnings)
    assert bench.controller.status().on_trial
    with pytest.raises(Refused, match="built without EEPROM_SETTINGS"):
        bench.controller.keep()


@given(
    st.floats(10, 30_000),
    st.floats(400, 5e6),
    st.sampled_from(["2.22", "5.00", "8.89", "80.00", "93.00", "314.96", "400.00"]),
)
def test_neither_speed_nor_acceleration_is_more_than_asked(speed: float, gain: float, per_mm: str) -> None:
    """Also where the steps per mm are more than is told, by half of the last place; a whole number is what it says."""
    told = Fraction(float(np.float32(per_mm)))
    most = told if per_mm.endswith("00") else told + Fraction("0.005")
    ramp = marlin_ramp(design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain), own=told)
    assert Fraction(float(np.float32(ramp.speed))) * most <= Fraction(str(speed))
    assert int(ramp.acceleration) * most <= Fraction(str(gain))
    # Rounded down to a hundredth of a mm/s, and then to a float: both may come together.
    less = float(told / most)
    assert float(ramp.speed_steps_per_s) == pytest.approx(less * speed, abs=1.1e-2 * float(told) + 4e-7 * speed)
    assert float(ramp.acceleration_steps_per_s2) == pytest.approx(less * gain, abs=1.01 * float(told) + 4e-7 * gain)


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        # M201 keeps whole mm/s², and with 0 no move would ever begin.
        ({"ramp__acceleration_steps_per_s2": 79}, "ramp.acceleration_steps_per_s2", "a number from 80 to"),
        ({"ramp__deceleration_steps_per_s2": 79}, "ramp.deceleration_steps_per_s2", "a number from 80 to"),
        # M503 lists two decimals: a slower one is told as 0.
        ({"ramp__slew_speed_steps_per_s": 0.7}, "ramp.slew_speed_steps_per_s", "a number from 0.8 to"),
    ],
)
def test_what_would_be_nonsense_is_rejected(
    bench: Bench, controller: MarlinController, changes: dict[str, object], field: str, allowed: str
) -> None:
    for ask in (
        lambda: controller.prepare_push([design(**changes)], 0),
        lambda: controller.preview_push([design(**changes)], 0),
    ):
        named, _, told = only_rejection(ask)
        assert named == field
        assert told.startswith(allowed)
        assert "with Marlin at 80 steps/mm" in told
    assert bench.told() == []


def test_it_is_refused_while_something_moves(bench: Bench, controller: MarlinController) -> None:
    send = controller.prepare_push([design()], 0)
    controller.move_by(by(8000))
    with pytest.raises(Refused, match="The motor moves"):
        send()
    bench.rest()
    bench.marlin.move_as_somebody_else(Y=4000)
    with pytest.raises(Refused, match="Something moves that was not asked for here"):
        send()
    assert bench.marlin.eeprom.writes == 0
    assert bench.marlin.settings == DEFAULTS


def test_nothing_is_said_while_it_stores(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.storing_s = 3.0
    assert push(controller, design(), design(), design(), axis=None).verified
    assert bench.marlin.bytes_lost == 0


def test_what_it_did_not_keep_is_found_by_loading_it(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.eeprom.is_broken = True
    report = push(controller, design())
    assert (report.verified, report.kept) == (False, False)
    assert [item.read_back for item in report.items] == [40_000, 40_000]
    assert "Restore a backup" in report.warnings[-1]


def test_a_setting_that_it_clips_is_not_stored(bench: Bench, controller: MarlinController) -> None:
    """As with LIMITED_MAX_FR_EDITING."""
    numbered = bench.marlin._checked
    bench.marlin._checked = lambda text: (numbered(text) or "").replace("M203 X12.5", "M203 X11.0")  # type: ignore[method-assign]
    report = push(controller, design())
    assert not report.verified
    assert bench.marlin.eeprom.writes == 0


def test_positions_outlast_a_push(bench: Bench, controller: MarlinController) -> None:
    controller.move_by(by(700))
    bench.rest()
    controller.set_position(to(50))
    push(controller, design())
    assert controller.status().axes[0].position_steps == 50
    controller.move_by(by(10))
    bench.rest()
    assert bench.marlin.position[0] == 710


# Backups.


def test_a_backup_has_all_that_can_be_read(controller: MarlinController) -> None:
    text = controller.backup()
    for line in ("; M115", "; M503", "echo:  M201 X500.00 Y500.00 Z100.00 E5000.00", "echo:  M206 X0.00 Y0.00 Z0.00"):
        assert line in text.splitlines()
    assert "FIRMWARE_NAME:Marlin 2.1.2.5" in text


def test_restoring_writes_only_what_differs(bench: Bench, controller: MarlinController) -> None:
    text = controller.backup()
    push(controller, design())
    bench.marlin.lines.clear()
    assert controller.use_backup(text) == ()
    assert stored(bench) == DEFAULTS
    assert bench.told() == [
        "M203 X500.00 Y500.00 Z5.00 E25.00", "M201 X500.00 Y500.00 Z100.00 E5000.00", "M500", "M501"
    ]  # fmt: skip
    assert controller.preview_push([design()], 0).items[1].on_device == 40_000


def test_what_of_a_backup_cant_be_written_is_told(bench: Bench, controller: MarlinController) -> None:
    text = controller.backup().replace("X0.00 Y0.00 Z0.00", "X1.00 Y0.00 Z0.00")
    left = controller.use_backup(text + "echo:  G29 S3 I0 J0 Z0.10\nM666 X0.20\nM999\n")
    assert bench.marlin.settings["M206"]["X"] == 1.0
    assert "G29 S3 I0 J0 Z0.10 can't be written again." in left
    assert "M666 X0.20 is not as in the backup." in left
    assert any("refuses 'M666 X0.20': it knows no such command" in remark for remark in left)
    assert "M999" not in bench.told()


def test_one_whose_settings_make_no_sense_is_connected_and_restored(bench: Bench, controller: MarlinController) -> None:
    text, broken = controller.backup(), copy.deepcopy(DEFAULTS)
    broken["M201"]["X"] = 0.0
    bench.marlin.eeprom.settings = broken
    bench.port.close()
    bench.reopen()
    again = bench.controller
    again.connect()
    status = again.status()
    assert ([axis.position_told for axis in status.axes], again.most_axes) == ([False], 0)
    assert "The settings of axis X make no sense" in str(status.trouble)
    for ask in (lambda: again.move_by(by(100)), lambda: again.preview_push([design()], 0)):
        with pytest.raises(Refused, match="The settings of axis X make no sense"):
            ask()
    assert again.use_backup(text) == ()
    assert stored(bench) == DEFAULTS
    assert ([axis.position_told for axis in again.status().axes], again.status().trouble) == ([True] * 4, None)
    again.move_by(by(100))
    bench.rest()
    assert bench.marlin.position[0] == 100


@pytest.mark.parametrize("with_an_older_one", [False, True])
def test_a_power_cut_while_it_stores_is_restored(bench: Bench, with_an_older_one: bool) -> None:
    own = copy.deepcopy(DEFAULTS)
    own["M92"]["X"], own["M201"]["X"] = 160.0, 750.0
    bench.marlin.eeprom.settings = copy.deepcopy(own)
    text = (
        "M92 X160.00 Y80.00 Z400.00 E93.00\nM203 X500 Y500 Z5 E25\nM201 X750 Y500 Z100 E5000\n"
        if with_an_older_one
        else ""
    )
    for attempt in ("before", "after"):
        bench.port.close()
        bench.marlin.power_up()
        bench.reopen()
        bench.controller.connect()
        if attempt == "before":
            text = text or bench.controller.backup()
            bench.marlin.dies_at_write = bench.marlin.eeprom.writes + 1
            with pytest.raises(DeviceLost, match="does not answer"):
                push(bench.controller, design())
    # It has come up with its defaults.
    assert bench.marlin.settings == DEFAULTS
    left = bench.controller.use_backup(text)
    assert stored(bench) == own
    assert not with_an_older_one or left == ()
    assert bench.controller.status().axes[0].steps_per_mm == 160


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("", "text"),
        ("nothing of the kind", "text"),
        ("M92 X80\nM203 X500\n", "text"),
        ("M92 X80\nM203 X500\nM201 X0\n", "M201 X"),
        ("M92 X80 Y0\nM203 X500 Y5\nM201 X5 Y5\n", "M92 Y"),
        ("M92 X80\nM203 X500\nM201 X0.50\n", "M201 X"),
        ("M92 X80\nM203 X0.001\nM201 X5\n", "M203 X"),
        ("M92 X80\nM203 X500\nM201 X5\nM204 P500 R500 T0.00\n", "M204 T"),
        ("G20\nM92 X80\nM203 X500\nM201 X5\n", "text"),
        ("M92 X80\nM203 X500\nM201 X5\nM92 X0\n", "M92 X"),
        ("M92 X80\nM203 X500\nM201 X5\nM201 X6\n", "M201 X"),
        ("M92 X80 X-80\nM203 X500\nM201 X5\n", "M92 X"),
        ("M92 X80\nM203 X500\nM201 X5\nM204 P500 R500 T9\nM204 T8\n", "M204 T"),
        ("M92 X80\nM203 X500\nM201 X5\nM92 T0 E93\nM92 T1 E0\n", "M92 T1 E"),
    ],
)
def test_what_is_no_backup_is_rejected(bench: Bench, controller: MarlinController, text: str, field: str) -> None:
    named, _, _ = only_rejection(lambda: controller.use_backup(text))
    assert named == field
    assert bench.told() == []


def test_a_backup_may_tell_the_same_twice_and_have_several_extruders() -> None:
    text = "M92 X80.00\nM203 X500.00\nM201 X5.00\nM204 P500.00 T9.00\n"
    more = "M92 X80\nM204 T9\nM92 T0 E93.00\nM92 T1 E95.00\n"
    assert Backup.of(text + more).lines(Backup.of(text)) == ["M204 T9", "M92 T0 E93.00", "M92 T1 E95.00"]


# What it has, as designs.

LISTING = """echo:; Steps per unit:
echo:  M92 X80.00 Y80.00 Z400.00 E93.00
echo:; Maximum feedrates (units/s):
echo:  M203 X300.00 Y300.00 Z5.00 E25.00
echo:; Maximum Acceleration (units/s2):
echo:  M201 X3000.00 Y500.00 Z100.00 E10000.00
echo:; Acceleration (units/s2): P<print_accel> R<retract_accel> T<travel_accel>
echo:  M204 P500.00 R1500.00 T1000.00
ok
"""


def test_a_listing_becomes_designs() -> None:
    x, y, z, e = read_settings(LISTING, design())
    assert [axis.name for axis in (x, y, z, e)] == ["X", "Y", "Z", "E"]
    # 400 steps a turn of 5 mm; 300 mm/s · 80; 1000 mm/s² of M204 T, 500 of M201, 1500 of M204 R.
    assert (x.design.axis.travel_per_rev, x.design.axis.travel_unit) == (5.0, "mm")
    assert x.design.ramp.slew_speed_steps_per_s == 24_000
    gains = [axis.design.ramp.acceleration_steps_per_s2 for axis in (x, y, z, e)]
    assert gains == [80_000, 40_000, 40_000, 139_500]
    assert "The acceleration is that of M204 T, 1,000 mm/s², less than its M201." in x.remarks
    assert any("M204 R, 1,500 mm/s², on its own" in remark for remark in e.remarks)
    assert len(y.remarks) == 1
    assert read_settings("G1 X5", design()) == []


@pytest.mark.parametrize(
    "text",
    [
        LISTING.replace("echo:", ""),
        LISTING.replace(".00", ""),
        "\n".join(line for line in LISTING.splitlines() if ";" not in line),
        "Recv: " + LISTING.replace("\n", "\r\n"),
    ],
)
def test_listings_of_other_versions(text: str) -> None:
    assert [axis.name for axis in read_settings(text, design())][-1] == "E"


def test_a_listing_in_inches_is_rejected() -> None:
    assert only_rejection(lambda: read_settings("G20\n" + LISTING, design()))[1] == "G20"


@given(st.decimals("5", "3200", places=2), st.decimals("0.5", "900", places=2), st.integers(1, 9999))
def test_pushing_what_was_read_changes_nothing(per_mm: object, speed: object, gain: int) -> None:
    if not float(str(speed)) * float(str(per_mm)) < 900_000:
        return
    [axis] = read_settings(f"M92 X{per_mm}\nM203 X{speed}\nM201 X{gain}.00", design())
    pushed = marlin_ramp(axis.design, own=Fraction(float(np.float32(str(per_mm)))))
    assert (float(pushed.speed), int(pushed.acceleration)) == (float(str(speed)), gain)


def test_settings_that_no_design_has() -> None:
    text = "M92 X3200\nM203 X99999\nM201 X5"
    with pytest.raises(Rejected, match=r"^With M203 99999 the slew speed of axis X is 319,996,800; allowed: a nu"):
        read_settings(text, design())
    field, _, allowed = only_rejection(lambda: read_settings(text, design()))
    assert field == "text"
    assert "settings of axis X that a design can have" in allowed


def test_telling_the_same() -> None:
    """It tells two decimals."""
    assert is_same(Fraction("12.35"), Fraction("12.345"))
    assert not is_same(Fraction("12.35"), Fraction("12.34"))
    assert not is_same(None, Fraction(1))
    assert Settings.of(["M203 X1e5 Y."]).number("M203", "Y") is None


def raises(ask: Callable[[], object]) -> Rejected:
    with pytest.raises(Rejected) as caught:
        ask()
    return caught.value


def test_more_designs_than_axes(controller: MarlinController) -> None:
    [rejection] = raises(lambda: controller.preview_push([design()] * 5)).rejections
    assert (rejection.field, rejection.allowed) == ("axes", "up to 4 designs")
    [rejection] = raises(lambda: controller.preview_push([design()], 4)).rejections
    assert (rejection.field, rejection.value) == ("to_axis", 4)
