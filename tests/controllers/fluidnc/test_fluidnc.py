from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.fluidnc.emulator import FILE, FluidNcEmulator
from controllers.grbl.bench import Bench, at, by, to
from controllers.grbl.test_stops import MOTIONS, stopped_anywhere
from designs import design
from stepramp.controllers.contract import Activity, AxisCommand
from stepramp.controllers.fluidnc.controller import FluidNcController
from stepramp.controllers.fluidnc.push import PushPlan
from stepramp.controllers.fluidnc.ramp import TIMER
from stepramp.controllers.fluidnc.read_settings import read_settings
from stepramp.controllers.grbl.conversation import Answered
from stepramp.controllers.grbl.settings import AxisSettings
from stepramp.controllers.remark import Unwritten
from stepramp.errors import DeviceLost, Refused, Rejected

# 250 steps/mm: 240 mm/min and 4 mm/s².
SLOW = design(ramp__slew_speed_steps_per_s=1000, ramp__acceleration_steps_per_s2=1000)


def test_connecting_only_asks(bench: Bench, fluidnc: FluidNcEmulator) -> None:
    bench.controller.connect()
    assert fluidnc.lines == ["$I", "$CD", "$CONFIG/FILENAME", "$LOCALFS/SHOW=/CONFIG.YAML"]
    controller = bench.controller
    assert (controller.firmware_version, controller.most_axes, controller.clocks_hz) == ("v3.7.2", 3, ())
    status = controller.status()
    assert [axis.steps_per_mm for axis in status.axes] == [250, 250, 250]
    assert (status.on_trial, status.motors_on, fluidnc.steps) == (False, False, 0)


def test_one_that_does_not_start_on_opening_is_found_where_it_is(bench: Bench, fluidnc: FluidNcEmulator) -> None:
    fluidnc.starts_on_open = False
    fluidnc.exchange(b"")
    bench.controller.connect()
    assert bench.controller.firmware_version == "v3.7.2"


@pytest.mark.parametrize(
    ("banner", "version", "words"),
    [
        (
            "Grbl 1.1h ['$' for help]",
            "[VER:1.1h.20190830:]",
            r"is no FluidNC but grbl 1\.1h, which is another family",
        ),
        ("Grbl 3.7 [FluidNC v3.7.2 (wifi) '$' for help]", "[VER:1.1f.20210803:]", "is no FluidNC but"),
    ],
)
def test_other_firmwares_are_refused(
    bench: Bench, fluidnc: FluidNcEmulator, banner: str, version: str, words: str
) -> None:
    fluidnc.banner, fluidnc.version = banner, [version]
    bench.port.close()
    bench.reopen()
    with pytest.raises(Refused, match=words):
        bench.controller.connect()


def test_a_file_that_can_not_be_read(bench: Bench, fluidnc: FluidNcEmulator) -> None:
    fluidnc.has_file_system = False
    bench.controller.connect()
    assert isinstance(bench.controller, FluidNcController)
    bench.controller.prepare_push([SLOW], 0)()
    assert bench.controller.status().on_trial
    # What was found stands for what is stored.
    bench.controller.roll_back()
    assert (fluidnc.settings[110], fluidnc.settings[120]) == (500, 10)


@pytest.mark.parametrize("name", ["stop!.yaml", "why?.yaml", "~config.yaml", "x" * 80 + ".yaml", "", "caf\u00e9.yaml"])
def test_a_file_with_a_name_that_would_be_obeyed_is_not_asked_for(
    bench: Bench, fluidnc: FluidNcEmulator, name: str
) -> None:
    fluidnc.file_name = name
    bench.controller.connect()
    assert fluidnc.lines == ["$I", "$CD", "$CONFIG/FILENAME"]
    assert (fluidnc.state, bench.controller.status().on_trial) == ("Idle", False)


@pytest.mark.parametrize("decimals", [3, 6])
def test_trying_sets_items_one_at_a_time_and_writes_nothing(
    controller: FluidNcController, fluidnc: FluidNcEmulator, decimals: int
) -> None:
    fluidnc.decimals = decimals
    assert not controller.preview_push([SLOW], 1).same
    report = controller.prepare_push([SLOW], 1, "try")()
    assert fluidnc.lines[:3] == ["$CD", "$/AXES/Y/ACCELERATION_MM_PER_SEC2=4", "$/AXES/Y/MAX_RATE_MM_PER_MIN=240"]
    assert (report.verified, report.kept) == (True, False)
    assert [(item.requested, item.sent, item.read_back) for item in report.items] == [(1000,) * 3] * 2
    assert [item.own.term for item in report.items if item.own] == [
        "axes/y/max_rate_mm_per_min",
        "axes/y/acceleration_mm_per_sec2",
    ]
    assert "FluidNC forgets this when it is restarted or switched off: its configuration's file stays as it is." in (
        report.warnings
    )
    assert controller.preview_push([SLOW], 1).same
    assert controller.status().on_trial
    controller.roll_back()
    assert (fluidnc.settings[111], fluidnc.settings[121]) == (500, 10)
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()
    assert (fluidnc.has_written, fluidnc.file, fluidnc.eeprom.writes) == (False, FILE, 0)


def test_steps_per_mm_that_others_set_are_noticed_before_a_push_and_a_motion(
    bench: Bench, controller: FluidNcController, fluidnc: FluidNcEmulator
) -> None:
    for _ in range(2):
        controller.move_by([by(300), by(100, 1)])
        bench.rest()
    assert fluidnc.lines[:3] == [f"$/AXES/{letter}/STEPS_PER_MM" for letter in "XYZ"]
    send, before = controller.prepare_push([SLOW], 0, "try"), len(fluidnc.lines)
    fluidnc.settings[100] = 1000.0
    with pytest.raises(Refused, match=r"axes/x/steps_per_mm was 250 and is 1,000 now: .* Nothing was written: push"):
        send()
    assert fluidnc.lines[before:] == ["$CD"]
    fluidnc.settings[101] = 100.0
    assert controller.prepare_push([SLOW], 0, "try")().verified
    assert (fluidnc.settings[110] * 1000 / 60, fluidnc.settings[120] * 1000) == (1000, 1000)
    for begin in (lambda: controller.move_by([by(300)]), lambda: controller.run([at(500)])):
        with pytest.raises(Refused, match="axes/y/steps_per_mm has changed from 250 to 100, so X and Y may"):
            begin()
    assert fluidnc.position == [600, 200, 0]
    controller.set_position([to(0), to(0, 1)])
    controller.move_by([by(300), by(50, 1)])
    bench.rest()
    assert fluidnc.position == [900, 250, 0]


def test_steps_per_mm_that_others_set_at_rest_are_told_at_once(
    bench: Bench, controller: FluidNcController, fluidnc: FluidNcEmulator
) -> None:
    controller.move_by([by(300), by(100, 1)])
    bench.rest()
    fluidnc.lines.clear()
    bench.ask_for(3)
    assert fluidnc.lines == [], "what was begun here, and rests, takes no more questions"
    fluidnc.settings[101] = 100.0
    status = bench.ask_for(3)
    assert [(axis.position_steps, axis.steps_per_mm) for axis in status.axes] == [(300, 250), (100, 100), (0, 250)]
    assert "axes/y/steps_per_mm has changed from 250 to 100, so Y may" in (status.trouble or "")
    asked = [f"$/AXES/{letter}/STEPS_PER_MM" for letter in "XY"]
    assert fluidnc.lines == [*asked, "$CD"], "once for each change"


@pytest.mark.parametrize("has_file_system", [True, False])
def test_its_file_has_the_steps_per_mm_that_it_tells_rounded(
    bench: Bench, fluidnc: FluidNcEmulator, has_file_system: bool
) -> None:
    fluidnc.file = FILE.replace("steps_per_mm: 250", "steps_per_mm: 8.8888889 # 1600 / 180", 1)
    fluidnc.has_file_system = has_file_system
    fluidnc.power_up()
    bench.controller.connect()
    assert isinstance(bench.controller, FluidNcController)
    report = bench.controller.prepare_push([SLOW], 0, "try")()
    assert report.verified
    told = [warning for warning in report.warnings if "told rounded" in warning]
    assert len(told) == (0 if has_file_system else 1)
    # 6,750 mm/min and 112.5 mm/s², or a little less.
    slack = 0.001 if has_file_system else 0.5
    assert 6750 - slack < fluidnc.settings[110] <= 6750
    assert 112.5 - slack < fluidnc.settings[120] <= 112.5
    bench.controller.move_by([by(30)])
    assert bench.rest().axes[0].position_steps == 30
    read = read_settings(bench.controller.backup(), design())[0]
    assert bench.controller.preview_push([read.design], 0).same


def test_an_item_that_is_refused_is_set_back(controller: FluidNcController, fluidnc: FluidNcEmulator) -> None:
    # 400,000 steps/s at 96,000 mm/min.
    fast = design(ramp__slew_speed_steps_per_s=400_000, ramp__acceleration_steps_per_s2=1000)
    with pytest.raises(Answered, match=r"refuses .*max_rate_mm_per_min=95999\.997.* in use: roll back"):
        controller.prepare_push([fast], 0)()
    assert fluidnc.settings[110] == 500
    # What was taken before is known: 1000 / 250 = 4 mm/s².
    assert fluidnc.settings[120] == 4
    assert controller.preview_push([fast], 0).items[1].on_device == 1000


def test_what_is_refused_of_a_backup_keeps_nothing_else_from_being_set(
    controller: FluidNcController, fluidnc: FluidNcEmulator
) -> None:
    text = controller.backup().replace("max_rate_mm_per_min: 500.000", "max_rate_mm_per_min: 95999.997", 1)
    refused, _ = controller.use_backup(text.replace("acceleration_mm_per_sec2: 10.000", "acceleration_mm_per_sec2: 12"))
    assert isinstance(refused, Unwritten)
    assert "refuses '$/axes/x/max_rate_mm_per_min=96000.0'" in refused
    assert [fluidnc.settings[number] for number in (110, 120, 121, 122)] == [500, 12, 12, 12]


def test_what_a_backup_lacks_is_left_alone_and_told(controller: FluidNcController, fluidnc: FluidNcEmulator) -> None:
    fluidnc.dumps_as = lambda text: text.replace("    steps_per_mm: 250.000\n", "", 1)
    text = controller.backup()
    fluidnc.dumps_as = lambda text: text
    lacking, _ = controller.use_backup(text)
    assert lacking == "The backup doesn't have axes/x/steps_per_mm: that is left as it was."
    # And not put to what FluidNC takes for one that isn't there.
    assert fluidnc.settings[100] == 250
    axes_y = text.partition("  y:\n")
    with pytest.raises(Rejected, match=r"axes/y/steps_per_mm is 80 and 250.000; allowed: each item once in a backup"):
        controller.use_backup(f"{axes_y[0]}  y:\n    steps_per_mm: 80\n{axes_y[2]}")


@given(st.floats(0.01, 400_000), st.floats(0.3, 2e7))
def test_never_more_than_asked_for(speed: float, gain: float) -> None:
    scale = AxisSettings(np.float32(250), np.float32(500), np.float32(10))
    asked = design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain)
    [(_, rate), (_, most)] = reversed(PushPlan.of([asked], 0, [scale]).wanted.items())
    assert float(np.float32(rate)) * 250 / 60 <= speed * (1 + 1e-15)
    assert float(np.float32(most)) * 250 <= gain * (1 + 1e-15)


@pytest.mark.parametrize(
    ("axis", "changes", "words"),
    [
        (3, {}, "to_axis is 3; allowed: an axis of this controller: 0 to 2"),
        (0, {"ramp__slew_speed_steps_per_s": 0.001}, "with FluidNC at 250 steps/mm"),
        (0, {"ramp__acceleration_steps_per_s2": 3e7}, "with FluidNC at 250 steps/mm"),
    ],
)
def test_what_fluidnc_can_not_take(
    controller: FluidNcController, axis: int, changes: dict[str, float], words: str
) -> None:
    with pytest.raises(Rejected, match=words):
        controller.prepare_push([design(**changes)], axis)


def test_nothing_is_set_while_it_moves_or_after_a_limit_was_hit(
    bench: Bench, controller: FluidNcController, fluidnc: FluidNcEmulator
) -> None:
    controller.move_by([by(2000)])
    with pytest.raises(Refused, match="only at rest, and its state is 'Jog'"):
        controller.prepare_push([SLOW], 0)()
    bench.rest()
    fluidnc.state = "Alarm"
    fluidnc._say("ALARM:1")
    for act in (controller.prepare_push([SLOW], 0), controller.backup, controller.roll_back):
        with pytest.raises(Refused, match="a limit was hit"):
            act()
    assert not any(line.startswith("$/") and "=" in line for line in fluidnc.lines)


def test_a_backup_is_everything_and_is_set_again(controller: FluidNcController, fluidnc: FluidNcEmulator) -> None:
    saved = controller.backup()
    assert "# [VER:3.7 FluidNC v3.7.2:]" in saved
    assert "      tmc_2209:\n        microsteps: 16\n" in saved
    assert "# # Mine, as the wiki has it" in saved
    controller.prepare_push([SLOW], 0)()
    fluidnc.settings[101] = 80.0
    controller._memory.learn_in_use()
    controller._read_back()
    remarks = controller.use_backup(saved)
    assert [fluidnc.settings[number] for number in (110, 120, 101)] == [500, 10, 250]
    assert remarks == (
        "Only steps per mm, highest rates and accelerations were set, until a restart: its file is not written to.",
    )
    with pytest.raises(Rejected, match="a backup of a FluidNC, or its configuration"):
        controller.use_backup("$100=250\n")


@pytest.mark.parametrize("lost", ["steps_per_mm: 250.000", "# Mine, as the wiki has it", "[G54:0.000"])
def test_a_byte_that_is_lost_as_a_backup_is_read_is_not_in_it(
    controller: FluidNcController, fluidnc: FluidNcEmulator, lost: str
) -> None:
    whole, left = controller.backup(), [lost.encode()]

    def lose(said: bytes) -> bytes:
        return said.replace(left[0], left.pop()[:-1], 1) if left and left[0] in said else said

    fluidnc.on_the_way_out = lose
    assert controller.backup() == whole
    assert left == []


def test_a_restart_brings_back_what_the_file_has(bench: Bench, controller: FluidNcController) -> None:
    controller.prepare_push([SLOW], 0)()
    bench.grbl.power_up()
    with pytest.raises(DeviceLost, match="was restarted"):
        controller.status()
    bench.port.close()
    bench.reopen()
    bench.controller.connect()
    assert not bench.controller.status().on_trial
    assert bench.grbl.settings[110] == 500


def test_a_reset_keeps_what_is_tried(bench: Bench, controller: FluidNcController) -> None:
    """As the halt of what moves is one."""
    controller.prepare_push([SLOW], 0)()
    controller.move_by([by(2000)])
    bench.ask_for(0.9)
    controller.halt()
    assert controller.status().on_trial
    assert (bench.grbl.settings[110], bench.grbl.settings[120]) == (240, 4)
    controller.roll_back()
    assert (bench.grbl.settings[110], bench.grbl.settings[120]) == (500, 10)


def test_moves_runs_and_positions(bench: Bench, controller: FluidNcController) -> None:
    controller.line([by(1000), by(500, 1)])
    assert [axis.position_steps for axis in bench.rest().axes] == [1000, 500, 0]
    controller.run([at(900.0)])
    assert bench.ask_for(2.0).axes[0].runs
    controller.stop()
    bench.rest()
    controller.set_position([AxisCommand(0, 0, "position_steps")])
    controller.move_to([to(-250)])
    assert bench.rest().axes[0].position_steps == -250
    with pytest.raises(Rejected, match="ramp_axis is 0; allowed: null: along a line FluidNC keeps to the limits"):
        controller.line([by(1)], 0)
    with pytest.raises(Rejected, match="steps/s either way, or 0"):
        controller.run([at(TIMER.slowest_steps_per_s - 1)])


@pytest.mark.parametrize("macro", ["startup_line0", "startup_line1", "after_reset", "after_unlock"])
def test_nothing_that_a_macro_would_carry_out_sets_out(bench: Bench, fluidnc: FluidNcEmulator, macro: str) -> None:
    fluidnc.starts_on_open = False
    bench.port.close()
    bench.reopen()
    fluidnc.file = FILE.replace(f"  {macro}:", f"  {macro}: G53 G0 Z5")
    bench.controller.connect()
    bench.controller.halt()
    bench.controller.stop()
    bench.controller.move_by([by(2000)])
    bench.ask_for(0.9)
    bench.controller.halt()
    bench.ask_for(0.9)
    assert fluidnc.state == "Alarm"
    if macro == "after_unlock":
        with pytest.raises(Refused, match="carries something out when it is unlocked"):
            bench.controller.set_position([to(0)])
    else:
        bench.controller.set_position([to(0)])
    bench.pass_time(5.0)
    assert fluidnc.position[2] == 0
    # Such macros there are, and they would.
    fluidnc.state = "Alarm" if macro == "after_unlock" else "Idle"
    fluidnc.exchange(b"$X\n" if macro == "after_unlock" else b"\x18")
    bench.pass_time(5.0)
    assert fluidnc.position[2] == 1250


def test_a_locked_one_is_unlocked_by_setting_its_position(bench: Bench, controller: FluidNcController) -> None:
    bench.grbl.state = "Alarm"
    assert "can't move" in (controller.status().trouble or "")
    controller.set_position([to(0)])
    assert controller.status().trouble is None


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("begin", MOTIONS)
@pytest.mark.parametrize("is_on_its_way", [False, True])
def test_a_stop_at_any_place_of_a_motion_is_final(
    bench: Bench, controller: FluidNcController, stop: str, begin: str, is_on_its_way: bool
) -> None:
    assert stopped_anywhere(bench, controller, stop, begin, is_on_its_way, answers_after_s=0.02) > 0


def test_a_status_while_it_stops(bench: Bench, controller: FluidNcController) -> None:
    controller.move_by([by(2000)])
    bench.ask_for(0.9)
    controller.stop()
    assert controller.status().axes[0].activity is Activity.STOPPING
