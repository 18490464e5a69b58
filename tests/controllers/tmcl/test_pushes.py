"""Ramps on their way to a module and back, into its EEPROM and out of it; backups."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import at, by, only_rejection, to
from controllers.interruption import interruptions
from controllers.tmcl import emulator
from controllers.tmcl.bench import Bench
from controllers.tmcl.emulator import AMAX, DMAX, FACTORY, RSAP, SAP, STAP, UNIT_MODE, VMAX, TmclEmulator
from designs import design
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.controllers.tmcl.read_settings import read_settings
from stepramp.errors import DeviceLost, Refused, Rejected


def ramp_of(module: TmclEmulator, axis: int = 0, *, stored: bool = False) -> dict[int, int]:
    """Return what the chip has, or the EEPROM."""
    motor = module.motors[axis]
    return {number: (motor.stored if stored else motor.settings)[number] for number in FACTORY}


PUSHED = {4: 1048, 5: 42, 17: 21, 19: 12, 20: 12, 15: 42, 16: 0, 18: 21}
"""1000 steps/s, 5000 and 2500 steps/s², from 12 steps/s: as the chip has it, v · 2²⁴ / 16 MHz, a · 2⁴¹ / (16 MHz)²."""
ASKED = {"ramp__base_speed_steps_per_s": 12.34, "ramp__deceleration_steps_per_s2": 2500.125}


@pytest.mark.parametrize("unit_mode", [1, 0])
def test_a_push_is_sent_read_back_and_told(bench: Bench, unit_mode: int) -> None:
    bench.module.motors[0].settings[UNIT_MODE] = unit_mode
    bench.controller.connect()
    asked = design(**ASKED)
    preview = bench.controller.preview_push([asked], 0)
    assert bench.told() == []
    report = bench.controller.prepare_push([asked], 0, "try")()
    assert bench.told() == [SAP] * 8
    assert ramp_of(bench.module) == PUSHED
    assert ramp_of(bench.module, stored=True) == FACTORY
    assert (report.verified, report.kept, report.bytes, report.segments) == (True, False, 72, None)
    assert [(item.sent, item.own and item.own.sent) for item in report.items] == [
        (item.read_back, item.own and item.own.on_device) for item in report.items
    ]
    first = report.items[0]
    assert (first.name, first.unit, first.requested, first.axis) == ("Full speed", "steps/s", 1000, 0)
    assert (first.sent, first.own is not None) == (pytest.approx(1048 * 16e6 / 2**24), True)
    if unit_mode:
        # The chip has 999.45: that is told as 999.
        assert (first.own.term, first.own.unit, first.own.sent, first.own.on_device) == ("4 (VMAX)", "pps", 999, 999)
    else:
        assert (first.own.unit, first.own.sent, first.own.on_device) == ("f/2²⁴", 1048, 1048)
    told = " ".join(report.warnings)
    for words in ("Slew speed 1,000 steps/s is rounded down to 999.4", "switched off", "The method Exact", "140"):
        assert words in told
    assert not preview.same
    again = bench.controller.preview_push([asked], 0)
    assert again.same
    assert not any(item.differs for item in again.items)
    assert [(item.on_device, item.to_send, item.own) for item in again.items] == [
        (item.read_back, item.sent, item.own) for item in report.items
    ]
    assert bench.controller.status().on_trial
    assert bench.module.chip.steps == 0


def test_keeping_stores_and_proves_it(bench: Bench) -> None:
    bench.controller.connect()
    report = bench.controller.prepare_push([design(**ASKED)], 0, "keep")()
    assert (report.verified, report.kept) == (True, True)
    assert (bench.told().count(STAP), bench.told().count(RSAP)) == (8, 8)
    assert ramp_of(bench.module, stored=True) == ramp_of(bench.module) == PUSHED
    assert not bench.controller.status().on_trial
    bench.module.power_up()
    assert ramp_of(bench.module) == PUSHED
    assert bench.module.chip.steps == 0


def test_keeping_after_a_stop_stores_no_speed_of_0_and_moves_nothing(bench: Bench, controller: TmclController) -> None:
    """A published firmware stores the speed that the chip is told, which is 0 then, and loads it as such."""
    bench.module.stores_registers = True
    controller.run(at(500))
    bench.pass_time(0.3)
    controller.stop()
    bench.rest()
    steps = bench.module.chip.steps
    controller.keep()
    bench.pass_time(1)
    assert (ramp_of(bench.module, stored=True)[VMAX], bench.module.chip.steps) == (1048, steps)
    controller.stop()
    controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0, "try")()
    controller.roll_back()
    bench.pass_time(1)
    assert (ramp_of(bench.module)[VMAX], bench.module.chip.steps) == (1048, steps)


def push_300(controller: TmclController) -> None:
    report = controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0, "keep")()
    assert (report.verified, report.kept) == (True, True)


WRITES: dict[str, tuple[Callable[[TmclController, str], object], int]] = {
    "push": (lambda controller, _: push_300(controller), 314),
    "keep": (lambda controller, _: controller.keep(), 1048),
    "roll back": (lambda controller, _: controller.roll_back(), FACTORY[VMAX]),
    "restore": (lambda controller, text: controller.use_backup(text), FACTORY[VMAX]),
}
"""What writes, and the speed that is stored by then, of the ramp of a module that had that of FACTORY stored."""


@pytest.mark.parametrize("stores_registers", [False, True])
@pytest.mark.parametrize("write", WRITES)
def test_a_stop_at_any_place_of_a_write_moves_nothing_and_the_write_goes_on(
    bench: Bench, write: str, stores_registers: bool
) -> None:
    bench.controller.connect()
    text, new = bench.controller.backup(), dict(bench.module.motors[0].settings)
    do, stored = WRITES[write]
    for interruption in interruptions(bench, bench.controller.stop):
        bench.module.stores_registers = False
        bench.module.motors[0].settings |= new
        bench.module.motors[0].stored |= new
        bench.controller.prepare_push([design()], 0, "try")()
        bench.module.stores_registers = stores_registers
        bench.controller.stop()
        with interruption:
            do(bench.controller, text)
        bench.pass_time(0.5)
        assert (bench.module.chip.steps, bench.module.chip.speed) == (0, 0), interruption.place
        assert ramp_of(bench.module, stored=True)[VMAX] == ramp_of(bench.module)[VMAX] == stored, interruption.place
        assert not bench.controller.status().on_trial
        if not interruption.came:
            break
    assert interruption.place >= 20


def test_a_locked_memory_is_told_in_words_and_the_ramp_stays_on_trial(bench: Bench, controller: TmclController) -> None:
    bench.module.is_locked = True
    push = controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0, "keep")
    for refused in (push, controller.keep):
        with pytest.raises(Refused, match="its EEPROM, is locked, so nothing was stored"):
            refused()
    assert controller.status().on_trial
    assert ramp_of(bench.module, stored=True) == FACTORY
    controller.roll_back()
    assert ramp_of(bench.module) == FACTORY


def test_what_was_sent_before_a_refusal_is_known(
    bench: Bench, controller: TmclController, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(emulator.WIDTHS, DMAX, 1)
    slow = design(ramp__slew_speed_steps_per_s=300)
    with pytest.raises(Refused, match="it doesn't take the value"):
        controller.prepare_push([slow], 0, "try")()
    [speed, *_] = controller.preview_push([slow], 0).items
    assert ramp_of(bench.module)[VMAX] < FACTORY[VMAX]
    assert speed.on_device == speed.to_send
    assert controller.status().on_trial


def test_a_firmware_that_stores_nothing_says_so(bench: Bench, controller: TmclController) -> None:
    bench.module.has_store_commands = False
    with pytest.raises(Refused, match="The module refuses STAP 4: it doesn't know the command"):
        controller.keep()


def test_rolling_back_brings_the_stored_ramp(bench: Bench, controller: TmclController) -> None:
    controller.roll_back()
    assert ramp_of(bench.module) == FACTORY
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()


@pytest.mark.usefixtures("controller")
def test_a_ramp_that_another_connection_tried_is_rolled_back_too(bench: Bench) -> None:
    other = TmclController(bench.port, bench.give_way)
    other.connect()
    other.roll_back()
    assert ramp_of(bench.module) == FACTORY


def test_the_axis_is_chosen(six: Bench) -> None:
    six.controller.prepare_push([design()], 2, "try")()
    assert [ramp_of(six.module, axis) == FACTORY for axis in range(6)] == [True, True, False, True, True, True]
    report = six.controller.prepare_push([design(), design(ramp__slew_speed_steps_per_s=300)], None, "keep")()
    assert {item.axis for item in report.items} == {0, 1}
    assert any(warning.startswith("Axes 0 and 1: The method") for warning in report.warnings)
    assert ramp_of(six.module, 1, stored=True)[VMAX] == 314
    assert ramp_of(six.module, 2, stored=True) == FACTORY


@pytest.mark.parametrize(
    ("designs", "first_axis", "rejected"),
    [(5, None, ("axes", "5 designs", "1 to 4 designs")), (0, None, ("axes", "0 designs", "1 to 4 designs")),
     (1, 4, ("to_axis", 4, "an axis of this controller: 0 to 3"))],
)  # fmt: skip
def test_axes_that_are_not_there(
    six: Bench, designs: int, first_axis: int | None, rejected: tuple[str, object, str]
) -> None:
    assert only_rejection(lambda: six.controller.prepare_push([design()] * designs, first_axis, "try")) == rejected


def test_nothing_is_written_while_a_motor_moves(bench: Bench, controller: TmclController) -> None:
    push = controller.prepare_push([design(ramp__slew_speed_steps_per_s=20)], 0, "try")
    text = controller.backup()
    controller.move_by(by(5000))
    before = ramp_of(bench.module)
    for refused in (
        push,
        controller.roll_back,
        controller.keep,
        controller.backup,
        lambda: controller.use_backup(text),
        lambda: controller.set_position(to(0)),
    ):
        with pytest.raises(Refused, match="The motor moves: stop it first"):
            refused()
    assert ramp_of(bench.module) == before
    assert bench.rest().axes[0].position_steps == 5000


def test_figures_that_are_not_as_they_were_sent_are_not_stored(bench: Bench) -> None:
    bench.controller.connect()
    push = bench.controller.prepare_push([design()], 0, "keep")
    keep_as_it_was = bench.module._have
    bench.module._have = lambda motor, kind, register: keep_as_it_was(motor, kind, 70 if kind == AMAX else register)
    report = push()
    assert (report.verified, report.kept) == (False, False)
    assert any("not those that were sent" in warning for warning in report.warnings)
    assert STAP not in bench.told()


# Backups.


def test_a_backup_has_every_setting_and_brings_it_back(bench: Bench, controller: TmclController) -> None:
    """Also what isn't pushed, as the current; what a firmware hasn't is left out."""
    text = controller.backup()
    assert text.splitlines()[0] == "module TMCM-1276"
    assert "axis 0 parameter 6 = 128" in text
    assert "parameter 162" not in text
    before = dict(bench.module.motors[0].settings)
    bench.module.motors[0].settings[6] = 200
    controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0, "keep")()
    assert controller.use_backup(text) == ()
    assert bench.module.motors[0].settings == before
    bench.module.power_up()
    assert bench.module.motors[0].settings == before
    assert bench.module.chip.steps == 0


def test_a_backup_in_other_units_brings_them_back_first(bench: Bench, controller: TmclController) -> None:
    text = controller.backup()
    before = dict(bench.module.motors[0].settings)
    bench.module.motors[0].settings[UNIT_MODE] = 0
    assert controller.use_backup(text) == ()
    assert bench.module.motors[0].settings == before
    assert controller.preview_push([design()], 0).same


@pytest.mark.parametrize("stores", range(1, 9))
def test_a_power_cut_while_it_is_stored_is_restored(bench: Bench, stores: int) -> None:
    bench.controller.connect()
    text = bench.controller.backup()
    bench.module.dies_after_stores = stores
    with pytest.raises(DeviceLost):
        bench.controller.prepare_push([design(**ASKED)], 0, "keep")()
    bench.module.dies_after_stores = None
    bench.module.power_up()
    assert ramp_of(bench.module) != FACTORY
    controller = TmclController(bench.port, bench.give_way)
    controller.connect()
    assert controller.use_backup(text) == ()
    assert ramp_of(bench.module, stored=True) == ramp_of(bench.module) == FACTORY


def test_a_locked_memory_is_told_when_a_backup_is_written(bench: Bench, controller: TmclController) -> None:
    text = controller.backup()
    bench.module.motors[0].settings[6] = 200
    bench.module.is_locked = True
    [remark] = controller.use_backup(text)
    assert "its EEPROM, is locked" in remark
    assert (bench.module.motors[0].settings[6], controller.status().on_trial) == (128, True)


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (lambda _: "$100=250\n", "text", "a backup of a TMCL module"),
        (lambda text: text.replace("TMCM-1276", "TMCM-1278"), "text", "of a TMCM-1276"),
        (lambda text: text.replace("parameter 5 = 4889", "parameter 5 = 0"), "axis 0", "a ramp that moves"),
        (lambda text: text.replace("parameter 5 = 4889", "parameter 5 = 7629278"), "axis 0", "a ramp that moves"),
        (lambda text: text.replace("parameter 20 = 9\n", "parameter 20 = 0\n"), "axis 0", "a ramp that moves"),
        (lambda text: text.replace("axis 0 parameter 18", "axis 0 parameter x"), "axis 0", "a ramp that moves"),
        (lambda text: text + "axis 0 parameter 5 = 4888\n", "axis 0 parameter 5", "each parameter once in a backup"),
    ],
    ids=["another family", "another module", "no acceleration", "a halt's", "no stopping speed", "not whole", "twice"],
)
def test_what_is_no_backup_or_would_hang_it_is_rejected(
    bench: Bench, controller: TmclController, change: Callable[[str], str], field: str, words: str
) -> None:
    text = controller.backup()
    assert "parameter 5 = 4889" in text
    found, _, allowed = only_rejection(lambda: controller.use_backup(change(text)))
    assert (found, words in allowed) == (field, True)
    assert bench.told() == []


def test_what_a_module_has_becomes_a_design_whose_push_changes_nothing(six: Bench) -> None:
    six.controller.prepare_push([design(**ASKED)], 1, "try")()
    axes = read_settings(six.controller.backup(), design())
    assert [axis.name for axis in axes] == ["0", "1", "2", "3"]
    read = axes[1].design
    assert (read.name, read.axis.microsteps, read.ramp.base_speed_steps_per_s) == ("TMCM-6212 axis 1", 256, 11)
    assert (read.ramp.acceleration_steps_per_s2, read.ramp.deceleration_steps_per_s2) == (4890, 2445)
    assert six.controller.preview_push([read], 1).same
    before = ramp_of(six.module, 1)
    six.controller.prepare_push([read], 1, "try")()
    changed = {number for number, value in ramp_of(six.module, 1).items() if value != before[number]}
    assert changed <= {4, 19, 20}, "speeds only, and these by less than 1 step/s"


def test_accelerations_below_v1_are_told_and_lost(bench: Bench, controller: TmclController) -> None:
    bench.module.motors[0].settings[16] = 500
    [axis] = read_settings(controller.backup(), design())
    [(remark, told)] = [each for each in zip(axis.remarks, axis.remarks_told, strict=True) if "A1, D1" in each[0]]
    [v1] = told
    assert remark.startswith(f"Up to V1, {v1.text}, the module")
    # 500 · 16 MHz / 2²⁴, of which the module tells whole steps/s.
    assert (v1.unit, v1.value) == ("steps/s", 476)


def test_settings_that_no_design_can_have_are_rejected(controller: TmclController) -> None:
    text = controller.backup().replace("parameter 19 = 0", "parameter 19 = 200000")
    with pytest.raises(Rejected, match="With VSTART 200000 the base speed of axis 0 is 200,000; allowed"):
        read_settings(text, design())
    assert read_settings("M92 X80", design()) == []


def test_a_figure_that_is_listed_twice_is_told(controller: TmclController) -> None:
    [axis] = read_settings(controller.backup() + "axis 0 parameter 5 = 2445\n", design())
    assert axis.design.ramp.acceleration_steps_per_s2 == 2445
    assert "axis 0 parameter 5 = 4889 and 2445 are listed: the last holds." in axis.remarks
