from __future__ import annotations

import json
import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.conftest import Clock
from controllers.klipper.bench import Bench, by
from controllers.klipper.moonraker import Moonraker
from controllers.klipper.printer import CONFIG, MACROS, Printer
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.klipper import memory
from stepramp.controllers.klipper.backup import Backup
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.errors import DeviceLost, Refused, Rejected

# 80 steps/mm in x, 160 in y, 400 in z.
SLOW = design(ramp__slew_speed_steps_per_s=8000, ramp__acceleration_steps_per_s2=80_000)
Z_SLOW = design(ramp__slew_speed_steps_per_s=800, ramp__acceleration_steps_per_s2=8000)


def pushed(controller: KlipperController, mode: str = "keep", axis: int = 0) -> None:
    report = controller.prepare_push([SLOW], axis, mode)()  # type: ignore[arg-type]
    assert report.verified, report


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
    controller.keep()
    assert "max_velocity: 100.0 " in printer.files["printer.cfg"]
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.keep()


def test_a_backup_is_everything_and_restores_it(bench: Bench, controller: KlipperController) -> None:
    saved = controller.backup()
    assert json.loads(saved)["files"]["macros/start.cfg"] == MACROS.split("\n")
    assert json.loads(saved)["limits"] == {
        "VELOCITY": 300,
        "ACCEL": 3000,
        "MINIMUM_CRUISE_RATIO": 0.5,
        "SQUARE_CORNER_VELOCITY": 5,
    }
    bench.printer.corner = 8.0
    pushed(controller)
    bench.printer.files["macros/start.cfg"] = "[gcode_macro START]\ngcode: G28\n"
    controller.use_backup(saved)
    assert bench.printer.files["printer.cfg"] == CONFIG
    assert bench.printer.files["macros/start.cfg"] == MACROS
    assert (bench.printer.velocity, bench.printer.accel, bench.printer.corner) == (300, 3000, 5)
    bench.moonraker.asked.clear()
    controller.use_backup(saved)
    assert "POST /server/files/upload" not in bench.moonraker.methods


@pytest.mark.parametrize("withheld", [(200, b"# f\xfcnf\n"), (503, b"{}"), (500, b"no JSON")])
def test_a_file_that_can_not_be_read_is_copied_before_a_restore_overwrites_it(
    bench: Bench, controller: KlipperController, withheld: tuple[int, bytes]
) -> None:
    saved = controller.backup()
    edited = CONFIG + "\n# weeks of work\n"
    bench.printer.files["printer.cfg"] = edited
    bench.moonraker.withheld["printer.cfg"] = withheld
    bench.moonraker.refuses_copies = True
    with pytest.raises(Refused, match=r"printer.cfg can't be copied, so it isn't written to. Klipper at"):
        controller.use_backup(saved)
    assert bench.printer.files["printer.cfg"] == edited
    bench.moonraker.refuses_copies = False
    remarks = controller.use_backup(saved)
    assert bench.printer.files["printer.cfg"] == CONFIG
    [copy] = [path for path, text in bench.printer.files.items() if text == edited]
    assert f"printer.cfg as it was is {copy} on the printer." in remarks


def including(clock: Clock, pattern: str) -> Bench:
    """Return a printer whose limits are in a file that is included by a pattern."""
    main = CONFIG.replace("max_velocity: 300  ; as it came\n", "").replace("macros/*.cfg", pattern)
    return Bench(clock, {"printer.cfg": main, "hw/limits.cfg": "[printer]\nmax_velocity = 250\n"})


def test_no_copy_is_included(clock: Clock) -> None:
    bench = including(clock, "hw/*.cfg")
    controller = bench.connected()
    saved = controller.backup()
    assert controller.prepare_push([SLOW], 0)().verified
    # Somebody adds a section with which Klipper doesn't start.
    edited = bench.printer.files["hw/limits.cfg"] + "[probe_typo]\npin: PA2\n"
    bench.printer.files["hw/limits.cfg"] = edited
    controller.use_backup(saved)
    assert edited in bench.printer.files.values()
    assert (bench.printer.velocity, "probe_typo" in bench.printer.sections) == (250, False)


def test_where_any_copy_would_be_included_nothing_is_written(clock: Clock) -> None:
    bench = including(clock, "hw/*")
    controller, before = bench.connected(), dict(bench.printer.files)
    with pytest.raises(Refused, match=r"includes whatever lies beside hw/limits.cfg.*Have it include \*.cfg only"):
        controller.prepare_push([SLOW], 0)()
    assert bench.printer.files == before


def test_a_restore_to_a_configuration_that_includes_more_is_not_started_and_says_what(clock: Clock) -> None:
    bench = including(clock, "hw/*.cfg")
    controller = bench.connected()
    saved = controller.backup()
    bench.printer.files["hw/new.cfg"] = "[probe_typo]\npin: PA2\n"
    with pytest.raises(Refused, match=r"says something else: it includes hw/new.cfg, too: take that away"):
        controller.use_backup(saved)
    assert bench.printer.restarts == 0


def test_files_that_change_while_they_are_written_are_not_started(bench: Bench, controller: KlipperController) -> None:
    upload = bench.moonraker._upload

    def change(kind: str, body: bytes) -> tuple[int, bytes]:
        bench.printer.files["macros/start.cfg"] = "[probe_typo]\npin: PA2\n"
        return upload(kind, body)

    bench.moonraker._upload = change  # type: ignore[method-assign]
    with pytest.raises(Refused, match="somebody has changed it meanwhile"):
        controller.prepare_push([SLOW], 0)()
    assert bench.printer.restarts == 0


def test_a_backup_of_a_klipper_that_reads_another_file_is_not_written(
    bench: Bench, controller: KlipperController
) -> None:
    text = Backup("old.cfg", {}, {"old.cfg": CONFIG}).text
    with pytest.raises(Rejected, match=r"text is 'old.cfg'; allowed: a backup whose first file .*reads, printer.cfg"):
        controller.use_backup(text)
    assert "old.cfg" not in bench.printer.files


def test_a_file_that_is_gone_is_written_anew(bench: Bench, controller: KlipperController) -> None:
    saved = controller.backup()
    del bench.printer.files["macros/start.cfg"]
    controller.use_backup(saved)
    assert bench.printer.files == {"printer.cfg": CONFIG, "macros/start.cfg": MACROS}


@pytest.mark.parametrize("bytes_written", [0, 10, 200, 500])
def test_a_power_cut_in_the_midst_of_a_write(clock: Clock, bytes_written: int) -> None:
    bench = Bench(clock)
    controller = bench.connected()
    saved = controller.backup()
    bench.moonraker.cuts_upload_after = bytes_written
    with pytest.raises(DeviceLost):
        controller.prepare_push([SLOW], 0)()
    bench.printer.state, bench.printer.message = "error", "Unable to parse config file"
    bench.reopen()
    bench.controller.connect()
    bench.controller.use_backup(saved)
    assert bench.printer.files["printer.cfg"] == CONFIG


def test_a_file_that_is_not_what_was_sent(
    controller: KlipperController, moonraker: Moonraker, printer: Printer
) -> None:
    moonraker.garbles_upload = True
    with pytest.raises(Refused, match=r"printer.cfg is not what was sent: restore a backup"):
        controller.prepare_push([SLOW], 0)()
    assert printer.restarts == 0


def test_a_file_of_which_a_part_was_taken(
    controller: KlipperController, moonraker: Moonraker, printer: Printer
) -> None:
    saved = controller.backup()
    moonraker.fails_upload_after = 0
    with pytest.raises(Refused, match=r"No space left on device. printer.cfg isn't as it was: restore a backup"):
        controller.prepare_push([SLOW], 0)()
    assert printer.restarts == 0
    controller.use_backup(saved)
    assert printer.files["printer.cfg"] == CONFIG


def test_limits_that_are_not_taken(controller: KlipperController, printer: Printer) -> None:
    printer.refuses = "Unknown command: SET_VELOCITY_LIMIT"
    with pytest.raises(Refused, match="Klipper at moonraker://printer:7125 says: Unknown command"):
        controller.prepare_push([SLOW], 0, "try")()


@pytest.mark.parametrize(
    "change",
    [
        lambda document: document | {"backup_of": "grbl"},
        lambda document: document | {"limits": {"VELOCITY": -1}},
        lambda document: document | {"limits": {"VELOCITY": 0}},
        lambda document: document | {"limits": {"X=1\nM112": 1}},
        lambda document: document | {"files": {"../moonraker.conf": [""], "printer.cfg": [""]}},
        lambda document: document | {"files": {"/etc/passwd": [""], "printer.cfg": [""]}},
        lambda document: document | {"files": {}},
        lambda document: document | {"more": 1},
    ],
)
def test_what_is_no_backup_is_rejected(
    controller: KlipperController, printer: Printer, change: Callable[[dict[str, object]], dict[str, object]]
) -> None:
    text = json.dumps(change(json.loads(controller.backup())))
    with pytest.raises(Rejected, match="a backup of a Klipper"):
        controller.use_backup(text)
    assert printer.scripts == []


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("kinematics: cartesian", "kinematics: cartesi", "its kinematics are cartesi"),
        ("max_velocity: 300", "max_velocity: 0", r"max_velocity of \[printer\] is '0'"),
        ("[stepper_z]", "[stepper_z", "can't be read"),
        ("microsteps: 16", "", r"\[stepper_x\] has no microsteps"),
    ],
)
def test_a_backup_with_which_klipper_would_not_start_is_not_written(
    controller: KlipperController, printer: Printer, old: str, new: str, words: str
) -> None:
    text = Backup("printer.cfg", {}, {"printer.cfg": CONFIG.replace(old, new)}).text
    with pytest.raises(Rejected, match=words):
        controller.use_backup(text)
    assert printer.files["printer.cfg"] == CONFIG


@given(st.dictionaries(st.from_regex(r"[a-z]{1,8}\.cfg", fullmatch=True), st.text(st.characters(codec="utf-8"))))
def test_files_come_back_as_they_were(files: dict[str, str]) -> None:
    backup = Backup("printer.cfg", {"VELOCITY": 0.1}, {**files, "printer.cfg": CONFIG})
    assert Backup.of(backup.text) == backup


def test_a_klipper_that_does_not_start_with_it(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails() -> None:
        bench.printer.state, bench.printer.message = "error", "Option 'max_accel' is not valid."

    monkeypatch.setattr(memory, "RESTART_S", 0.05)
    monkeypatch.setattr(bench.printer, "restart", fails)
    with pytest.raises(Refused, match=r"Klipper doesn't start: Option 'max_accel' is not valid. Restore a backup"):
        controller.prepare_push([SLOW], 0)()


def restart_in_steps(bench: Bench, monkeypatch: pytest.MonkeyPatch, *states: str) -> None:
    """Have a restart lead through states that last for a moment each; bench.interrupt is called in each of them."""
    restart, begun_s = bench.printer.restart, []

    def begin() -> None:
        restart()
        bench.printer.state = states[0]
        begun_s.append(bench.clock.now_s)

    def go_on() -> None:
        if begun_s and bench.printer.state != "shutdown":
            passed = int((bench.clock.now_s - begun_s[0]) / 0.2)
            bench.printer.state = [*states, "ready"][min(passed, len(states))]

    monkeypatch.setattr(bench.printer, "restart", begin)
    give_way = bench.controller._conversation._give_way
    monkeypatch.setattr(bench.controller._conversation, "_give_way", lambda pause_s: (go_on(), give_way(pause_s)))


@pytest.mark.parametrize("what", ["stop", "halt"])
def test_a_stop_while_it_starts_anew_is_answered_and_the_push_proven(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    """At each instant: nothing moves then, and that it has started is no loss, since it was told to."""
    restart_in_steps(bench, monkeypatch, "startup", "disconnected", "startup")
    states: list[str] = []

    def interrupt() -> None:
        if bench.printer.restarts:
            monkeypatch.setattr(bench, "interrupt", lambda: None)
            getattr(controller, what)()
            states.append(bench.printer.state)
            monkeypatch.setattr(bench, "interrupt", interrupt)

    bench.interrupt = interrupt
    report = controller.prepare_push([SLOW], 0)()
    bench.interrupt = lambda: None
    assert {"startup", "disconnected", "ready"} <= set(states)
    assert (report.verified, report.kept) == (True, True)
    assert "printer.emergency_stop" not in bench.moonraker.methods
    assert controller.status().activity is Activity.READY


def test_a_halt_of_what_somebody_else_begins_as_it_has_started_is_told_by_the_push(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch
) -> None:
    restart_in_steps(bench, monkeypatch, "startup")

    def interrupt() -> None:
        if bench.printer.restarts and bench.printer.state == "ready" and bench.printer.prints != "printing":
            bench.printer.prints = "printing"
            controller.halt()

    bench.interrupt = interrupt
    with pytest.raises(Refused, match="All is written, and Klipper was halted before it was seen to start with it"):
        controller.prepare_push([SLOW], 0)()
    assert bench.printer.state == "shutdown"
