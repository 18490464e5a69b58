"""Files of a Klipper's configuration: copied, written and restored from backups."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.conftest import Clock
from controllers.klipper.bench import SLOW, Bench, pushed
from controllers.klipper.moonraker import Moonraker
from controllers.klipper.printer import CONFIG, MACROS, Printer
from designs import design
from stepramp.controllers.klipper.backup import Backup
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.errors import DeviceLost, Refused, Rejected


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


def test_each_push_leaves_a_copy_of_its_own_however_soon_it_comes(bench: Bench, controller: KlipperController) -> None:
    faster = design(ramp__slew_speed_steps_per_s=16_000, ramp__acceleration_steps_per_s2=80_000)
    for each in (SLOW, faster, SLOW):
        assert controller.prepare_push([each], 0)().verified
    copies = sorted(path for path in bench.printer.files if ".stepramp-" in path)
    assert len(copies) == 3
    assert bench.printer.files[copies[0]] == CONFIG


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
