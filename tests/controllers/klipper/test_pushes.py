from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.conftest import Clock
from controllers.klipper.bench import SLOW, Bench, by, pushed
from controllers.klipper.printer import CONFIG, MACROS, Printer
from designs import design
from stepramp.controllers.klipper.backup import Backup
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.controllers.klipper.ramp import KLIPPER
from stepramp.controllers.per_mm import PerMm
from stepramp.errors import Refused, Rejected

# 80 steps/mm in x, 160 in y, 400 in z.
Z_SLOW = design(ramp__slew_speed_steps_per_s=800, ramp__acceleration_steps_per_s2=8000)


def test_trying_sets_limits_one_at_a_time_and_writes_no_file(bench: Bench, controller: KlipperController) -> None:
    report = controller.prepare_push([SLOW], 0, "try")()
    assert bench.printer.scripts == ["SET_VELOCITY_LIMIT ACCEL=1000", "SET_VELOCITY_LIMIT VELOCITY=100"]
    assert bench.printer.files == {"printer.cfg": CONFIG, "macros/start.cfg": MACROS}
    assert (report.verified, report.kept) == (True, False)
    assert [(item.own.term, item.own.sent, item.own.on_device) for item in report.items if item.own] == [
        ("max_velocity", 100, 100),
        ("max_accel", 1000, 1000),
    ]
    assert [(item.requested, item.sent, item.read_back) for item in report.items] == [(8000,) * 3, (80_000,) * 3]
    assert "Klipper forgets these limits when it is restarted." in report.warnings
    assert controller.status().on_trial
    controller.roll_back()
    assert (bench.printer.velocity, bench.printer.accel) == (300, 3000)
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()


def test_keeping_writes_the_file_after_a_copy_and_klipper_reads_it_anew(
    bench: Bench, controller: KlipperController
) -> None:
    report = controller.prepare_push([SLOW], 0)()
    assert (report.verified, report.kept) == (True, True)
    expected = CONFIG.replace("max_velocity: 300", "max_velocity: 100").replace("max_accel: 3000", "max_accel: 1000")
    assert bench.printer.files.pop("printer.cfg") == expected
    [copy] = set(bench.printer.files) - {"macros/start.cfg"}
    assert copy.startswith("printer.cfg.stepramp-")
    assert bench.printer.files[copy] == CONFIG
    assert f"printer.cfg as it was is {copy} on the printer." in report.warnings
    assert bench.printer.restarts == 1
    methods = bench.moonraker.methods
    assert methods.index("server.files.copy") < methods.index("POST /server/files/upload")
    assert methods.index("POST /server/files/upload") < methods.index("printer.restart")
    assert not controller.status().on_trial
    assert controller.preview_push([SLOW], 0).same


@pytest.mark.parametrize(
    ("prepare", "words"),
    [
        (lambda printer: setattr(printer, "has_current", True), "they have current"),
        (lambda printer: setattr(printer, "save_config_pending", True), "calibrations that nobody has saved"),
        (
            lambda printer: printer.files.update(
                {"macros/late.cfg": "[delayed_gcode x]\ninitial_duration: 2\ngcode: G28"}
            ),
            r"with \[delayed_gcode x\] it carries something out when it starts",
        ),
    ],
)
def test_klipper_is_not_restarted_where_that_costs_something(
    clock: Clock, prepare: Callable[[Printer], None], words: str
) -> None:
    bench = Bench(clock)
    prepare(bench.printer)
    bench.printer.sections = bench.printer._read()
    report = bench.connected().prepare_push([SLOW], 0)()
    assert bench.printer.restarts == 0
    [remark] = [each for each in report.warnings if "was not restarted" in each]
    assert re.search(words, remark)
    # In use at once all the same, and in the file.
    assert (bench.printer.velocity, report.verified, report.kept) == (100, True, True)
    assert "max_velocity: 100 " in bench.printer.files["printer.cfg"]


def test_calibrations_made_since_it_was_connected_are_not_lost(bench: Bench, controller: KlipperController) -> None:
    unsaved = "it has calibrations that nobody has saved yet (SAVE_CONFIG)."
    bench.printer.save_config_pending = True
    controller.status()
    assert f"Storing it doesn't restart Klipper: {unsaved}" in controller.preview_push([SLOW], 0).warnings
    bench.printer.save_config_pending = False
    controller.status()
    assert any("Storing it restarts" in each for each in controller.preview_push([SLOW], 0).warnings)

    def calibrate() -> None:
        # In the midst of the push.
        bench.printer.save_config_pending = bench.printer.files["printer.cfg"] != CONFIG

    bench.interrupt = calibrate
    report = controller.prepare_push([SLOW], 0)()
    assert bench.printer.restarts == 0
    assert any("Klipper was not restarted" in each and each.endswith(unsaved) for each in report.warnings)


def test_a_preview_tells_the_lines_that_are_written_and_that_klipper_is_restarted(clock: Clock) -> None:
    config = CONFIG.replace("max_z_velocity: 5", "max_z_velocity: 150")
    bench = Bench(clock, {"printer.cfg": config, "macros/start.cfg": MACROS})
    controller = bench.connected()
    told = controller.preview_push([SLOW], 0).warnings
    assert told[:3] == (
        "Storing it writes max_accel: 1000, max_velocity: 100, max_z_velocity: 100 to [printer] of Klipper's "
        "configuration.",
        "max_z_velocity is lowered to 100 with max_velocity: Klipper doesn't start with more.",
        "Storing it restarts Klipper: its axes have to be homed again after that.",
    )
    assert told[1] in controller.prepare_push([SLOW], 0)().warnings
    before = config.split("\n")
    lines = set(bench.printer.files["printer.cfg"].split("\n")).difference(before)
    assert lines == {"max_accel: 1000", "max_velocity: 100  ; as it came", "max_z_velocity: 100"}
    bench.printer.has_current = True
    controller.look_first()
    told = controller.preview_push([design(ramp__slew_speed_steps_per_s=4000)], 0).warnings
    assert "Storing it doesn't restart Klipper: a restart switches the motors off, and they have current." in told


@pytest.mark.parametrize("there", ["100", "100.0"])
def test_what_klipper_has_already_is_not_written_and_leaves_its_axes_homed(clock: Clock, there: str) -> None:
    config = CONFIG.replace("max_velocity: 300", f"max_velocity: {there}").replace("max_accel: 3000", "max_accel: 1000")
    bench = Bench(clock, {"printer.cfg": config, "macros/start.cfg": MACROS})
    controller, files = bench.connected(), dict(bench.printer.files)
    controller.look_first()
    preview = controller.preview_push([SLOW], 0)
    assert preview.same
    assert preview.warnings[:2] == (
        "Storing it writes nothing: Klipper's configuration has this already.",
        "Storing it doesn't restart Klipper: it has started with this already.",
    )
    report = controller.prepare_push([SLOW], 0)()
    assert (report.verified, report.kept) == (True, True)
    assert "Nothing is written: Klipper's configuration has this already." in report.warnings
    assert "Klipper was not restarted: it has started with this already." in report.warnings
    assert (bench.printer.files, bench.printer.restarts, bench.printer.homed) == (files, 0, "xyz")


def test_what_was_written_while_motors_had_current_is_proven_by_the_next_push(
    controller: KlipperController, printer: Printer
) -> None:
    printer.has_current = True
    pushed(controller)
    printer.has_current = False
    controller.look_first()
    told = controller.preview_push([SLOW], 0).warnings
    assert "Storing it restarts Klipper: its axes have to be homed again after that." in told
    pushed(controller)
    assert printer.restarts == 1


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "position_max: 250",
            "position_max: 240",
            "Storing it doesn't restart Klipper: its files have been changed since it started, by somebody else.",
        ),
        (
            "max_velocity: 300",
            "max_velocity: 250",
            "Storing it is refused: Klipper goes by max_velocity 300, and its file has 250: somebody has changed it "
            "since it started. Say RESTART first.",
        ),
        ("", "", "Storing it is refused: Moonraker doesn't give printer.cfg: away."),
    ],
)
def test_a_preview_tells_what_somebody_else_has_changed(
    bench: Bench, controller: KlipperController, old: str, new: str, words: str
) -> None:
    bench.printer.files["printer.cfg"] = CONFIG.replace(old, new)
    if "away" in words:
        bench.moonraker.withheld["printer.cfg"] = 500, b'{"error": {"message": "away"}}'
    controller.look_first()
    preview = controller.preview_push([SLOW], 0)
    assert words in preview.warnings
    assert not preview.same
    if words.startswith("Storing it is refused: "):
        assert not any("restart" in each for each in preview.warnings if each != words)
        with pytest.raises(Refused) as caught:
            controller.prepare_push([SLOW], 0)()
        assert words == f"Storing it is refused: {caught.value}"


def test_files_that_are_not_given_take_no_preview_away(bench: Bench, controller: KlipperController) -> None:
    bench.file_lasts_s = 1000.0
    controller.look_first()
    assert "Storing it is refused: It doesn't give its files." in controller.preview_push([SLOW], 0).warnings
    pushed(controller, "try")


def test_what_somebody_else_has_changed_is_neither_overwritten_nor_started(bench: Bench) -> None:
    controller = bench.connected()
    bench.printer.files["printer.cfg"] = CONFIG.replace("position_max: 250", "position_max: 240")
    report = controller.prepare_push([SLOW], 0)()
    assert any("changed since it started, by somebody else" in each for each in report.warnings)
    assert "position_max: 240" in bench.printer.files["printer.cfg"]
    assert bench.printer.restarts == 0
    bench.printer.files["printer.cfg"] = CONFIG.replace("max_accel: 3000", "max_accel: 2500")
    before = dict(bench.printer.files)
    with pytest.raises(Refused, match="goes by max_accel 1000, and its file has 2500: somebody has changed it"):
        controller.prepare_push([SLOW], 0)()
    assert bench.printer.files == before


def test_options_in_another_file(clock: Clock) -> None:
    main = CONFIG.replace("max_velocity: 300  ; as it came\n", "").replace("macros/*.cfg", "limits.cfg")
    bench = Bench(clock, {"printer.cfg": main, "limits.cfg": "[printer]\nmax_velocity = 250\n"})
    bench.connected().prepare_push([SLOW], 0)()
    assert bench.printer.files["limits.cfg"] == "[printer]\nmax_velocity = 100\n"
    assert "max_accel: 1000" in bench.printer.files["printer.cfg"]
    assert bench.printer.restarts == 1


def test_what_is_lost_is_told_with_the_controllers_own_figures(bench: Bench) -> None:
    bench.printer.cruise = 0.2
    report = bench.connected().prepare_push([SLOW], 0, "try")()
    # 8000² / (80,000 · 0.8)
    assert any("Moves of less than 1,000 steps stay slower" in each for each in report.warnings)
    assert any("The design has 50 steps per mm, Klipper 80 per mm" in each for each in report.warnings)
    assert not any("comes out" in each for each in report.warnings)
    bench.printer.cruise = 0.0
    bench.controller.status()
    assert not any("stay slower" in each for each in bench.controller.preview_push([SLOW], 0).warnings)


def test_what_fits_exactly_is_sent_as_it_is(controller: KlipperController, printer: Printer) -> None:
    """Each whole speed at 80 steps/mm has no more than four decimals; 9.7125 as a double is a little more than that."""
    for speed in range(1, 1000):
        exact = design(ramp__slew_speed_steps_per_s=speed)
        given_speed = PerMm.of(exact, KLIPPER, own=Fraction(80)).speed
        assert Fraction(given_speed) * 80 == speed
    report = controller.prepare_push([design(ramp__slew_speed_steps_per_s=777)], 0)()
    assert report.verified
    assert "max_velocity: 9.7125 " in printer.files["printer.cfg"]
    assert (report.items[0].sent, report.items[0].read_back) == (777, 777)
    assert not any("rounded down" in each for each in report.warnings)


def test_x_and_y_share_their_limits(controller: KlipperController, printer: Printer) -> None:
    faster = design(ramp__slew_speed_steps_per_s=24_000, ramp__acceleration_steps_per_s2=80_000)
    report = controller.prepare_push([SLOW, faster], None, "try")()
    # y: 150 mm/s and 500 mm/s²; x: 100 mm/s and 1000 mm/s².
    assert (printer.velocity, printer.accel) == (100, 500)
    assert report.verified
    assert [item.sent for item in report.items] == [8000, 40_000, 16_000, 80_000]
    assert any("hold for x and y together" in each for each in report.warnings)


def test_z_has_limits_in_the_file_only(controller: KlipperController, printer: Printer) -> None:
    with pytest.raises(Rejected, match="to_axis is 2; allowed: axis 0 or 1 where nothing is stored"):
        controller.prepare_push([Z_SLOW], 2, "try")
    with pytest.raises(Rejected, match=r"axes.2"):
        controller.prepare_push([SLOW, SLOW, Z_SLOW], None, "try")
    printer.has_current = True
    report = controller.prepare_push([Z_SLOW], 2)()
    assert printer.scripts == []
    assert report.verified
    assert "Limits of z hold from Klipper's next start on." in report.warnings
    assert "max_z_velocity: 2\nmax_z_accel = 20\n" in printer.files["printer.cfg"]
    assert (report.items[0].own.term, report.items[0].own.on_device) == ("max_z_velocity", 2)  # type: ignore[union-attr]


def test_limits_with_which_klipper_would_not_start(controller: KlipperController, printer: Printer) -> None:
    fast_z = design(ramp__slew_speed_steps_per_s=160_000, ramp__acceleration_steps_per_s2=8000)
    with pytest.raises(
        Rejected, match=r"ramp.slew_speed_steps_per_s is 160000.*at most 120,000 steps/s, as max_velocity"
    ):
        controller.prepare_push([fast_z], 2)
    with pytest.raises(Rejected, match=r"axes.2.ramp.slew_speed_steps_per_s .*at most 20,000"):
        controller.prepare_push([SLOW, SLOW, fast_z])
    crawling = design(ramp__slew_speed_steps_per_s=80, ramp__acceleration_steps_per_s2=800)
    report = controller.prepare_push([crawling], 0)()
    assert report.verified
    assert printer.state == "ready"
    assert "max_z_velocity: 1\nmax_z_accel = 10\n" in printer.files["printer.cfg"]
    assert any("max_z_velocity is lowered to 1 with max_velocity" in each for each in report.warnings)


@given(st.floats(0.001, 30_000), st.floats(0.001, 1e6))
def test_never_more_than_asked_for(speed: float, gain: float) -> None:
    bench = Bench(Clock())
    asked = design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain)
    report = bench.connected().prepare_push([asked], 0, "try")()
    assert report.verified
    assert bench.printer.velocity * 80 <= speed * (1 + 1e-15)
    assert bench.printer.accel * 80 <= gain * (1 + 1e-15)
    assert bench.printer.velocity * 80 >= speed - 2e-4


@pytest.mark.parametrize(
    ("axis", "changes", "words"),
    [
        (3, {}, "to_axis is 3; allowed: an axis of this controller: 0 to 2"),
        (0, {"ramp__slew_speed_steps_per_s": 1e-5}, "ramp.slew_speed_steps_per_s"),
    ],
)
def test_what_klipper_can_not_take(
    controller: KlipperController, axis: int, changes: dict[str, float], words: str
) -> None:
    with pytest.raises(Rejected, match=words):
        controller.prepare_push([design(**changes)], axis)


@pytest.mark.parametrize("prints", ["printing", "paused"])
@pytest.mark.parametrize("mode", ["keep", "try"])
def test_nothing_is_written_while_it_prints(bench: Bench, prints: str, mode: str) -> None:
    controller = bench.connected()
    bench.printer.prints = prints
    for act in (
        controller.prepare_push([SLOW], 0, mode),  # type: ignore[arg-type]
        controller.keep,
        controller.roll_back,
        controller.backup,
        lambda: controller.use_backup(Backup("printer.cfg", {}, {"printer.cfg": ""}).text),
    ):
        with pytest.raises(Refused, match=r"prints|busy"):
            act()
    assert (bench.printer.scripts, bench.printer.restarts) == ([], 0)
    assert bench.printer.files["printer.cfg"] == CONFIG


def test_nothing_is_written_while_it_moves(bench: Bench, controller: KlipperController) -> None:
    controller.move_by([by(8000)])
    push = controller.prepare_push([SLOW], 0, "try")
    with pytest.raises(Refused, match="moves"):
        push()
    bench.rest()
    push()


def test_keeping_what_is_on_trial(controller: KlipperController, printer: Printer) -> None:
    pushed(controller, "try")
    printer.files["printer.cfg"] = CONFIG.replace("max_z_accel = 100", "max_z_accel = 2000")
    copied, lowered, not_restarted = controller.keep()
    assert not_restarted == "Klipper was not restarted: that it starts with this is known of its file only."
    assert lowered == "max_z_accel is lowered to 1,000 with max_accel: Klipper doesn't start with more."
    assert copied.startswith("printer.cfg as it was is printer.cfg.stepramp-")
    assert "max_velocity: 100.0 " in printer.files["printer.cfg"]
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.keep()


def test_limits_that_are_not_taken(controller: KlipperController, printer: Printer) -> None:
    printer.refuses = "Unknown command: SET_VELOCITY_LIMIT"
    with pytest.raises(Refused, match="Klipper at moonraker://printer:7125 says: Unknown command"):
        controller.prepare_push([SLOW], 0, "try")()
