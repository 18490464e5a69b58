"""Ramps on their way to a Tic and back."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import by, only_rejection, to
from controllers.interruption import interruptions
from controllers.tic.bench import Bench
from controllers.tic.emulator import TicEmulator
from designs import design
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import Refused


def test_a_push_is_sent_read_back_and_told(bench: Bench) -> None:
    bench.controller.connect()
    figures_asked = {"base_speed_steps_per_s": 12.34567, "deceleration_steps_per_s2": 2500.125}
    asked = design(axis__microsteps=1, **{f"ramp__{name}": value for name, value in figures_asked.items()})
    preview = bench.controller.preview_push([asked], 0)
    assert bench.told() == []
    report = bench.controller.prepare_push([asked], 0, "try")()
    assert bench.tic.ramp == [123_456, 10_000_000, 250_012, 500_000]
    figures = [(item.name, item.unit, item.requested, item.sent, item.read_back) for item in report.items]
    assert figures == [
        ("Starting speed", "steps/s", 12.34567, 12.3456, 12.3456),
        ("Full speed", "steps/s", 1000, 1000, 1000),
        ("Acceleration", "steps/s²", 5000, 5000, 5000),
        ("Deceleration", "steps/s²", 2500.125, 2500.12, 2500.12),
    ]
    assert (report.verified, report.kept, report.bytes, report.segments) == (True, False, 24, None)
    assert (report.largest_deviation_us, report.sequence) == (None, None)
    assert [(item.own.term, item.own.unit, item.own.sent, item.own.on_device) for item in report.items if item.own] == [
        ("Starting speed", "steps/10,000 s", 123_456, 123_456),
        ("Max speed", "steps/10,000 s", 10_000_000, 10_000_000),
        ("Max acceleration", "steps/100 s²", 500_000, 500_000),
        ("Max deceleration", "steps/100 s²", 250_012, 250_012),
    ]
    assert report.warnings == (
        "The method Exact is not kept: a Tic works its intervals out itself.",
        "Base speed 12.34567 steps/s is rounded down to 12.3456 steps/s.",
        "Deceleration 2,500.125 steps/s² is rounded down to 2,500.12 steps/s².",
        "The Tic forgets these figures when it is reset or switched off.",
    )
    assert preview.warnings == report.warnings
    # What a Tic has when it is new.
    assert [(item.on_device, item.to_send) for item in preview.items] == [
        (0, 12.3456), (200, 1000), (400, 5000), (400, 2500.12)
    ]  # fmt: skip
    assert not preview.same
    assert bench.controller.preview_push([asked], 0).same
    assert bench.controller.status().on_trial
    assert bench.tic.steps == 0


def test_a_table_is_lost_and_that_is_said(controller: TicController) -> None:
    preview = controller.preview_push([design(method__name="table")], 0)
    assert preview.warnings[0] == "The lookup table is not kept: a Tic works its intervals out itself."


def test_a_speed_that_its_timer_makes_faster_is_named(controller: TicController) -> None:
    """The guide's own example: at 491,803,279 of its units steps are 60 ticks apart, 1.66 % too fast."""
    warnings = controller.preview_push([design(ramp__slew_speed_steps_per_s=49_180.3279)], 0).warnings
    assert (
        "Slew speed 49,180.3279 steps/s comes out as 50,000 steps/s: a Tic takes 60 whole thirds of a µs for a step, "
        "rounded down." in warnings
    )
    assert not any("comes out as" in each for each in controller.preview_push([design()], 0).warnings)


@pytest.mark.parametrize(("step_mode", "microsteps"), [(0, 1), (5, 32), (6, 2), (9, 256)])
def test_another_step_mode_is_told(bench: Bench, step_mode: int, microsteps: int) -> None:
    bench.tic.step_mode = step_mode
    bench.controller.connect()
    told = f"The design has 16 steps a full step, the Tic {microsteps} (its step mode): its steps are sent as"
    warnings = bench.controller.preview_push([design(axis__microsteps=16)], 0).warnings
    assert any(each.startswith(told) for each in warnings)
    warnings = bench.controller.preview_push([design(axis__microsteps=microsteps)], 0).warnings
    assert not any("step mode" in each for each in warnings)


def test_rolling_back_brings_the_ramp_of_the_settings(bench: Bench, controller: TicController) -> None:
    controller.roll_back()
    assert bench.tic.ramp == [0, 2_000_000, 40_000, 40_000]
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()


def test_a_ramp_that_was_changed_at_the_usb_port_is_seen(tic: TicEmulator, controller: TicController) -> None:
    assert controller.preview_push([design()], 0).same
    before = controller.status().ramp
    tic.exchange(bytes([0xE6, 0, 0, 0x2D, 0x31, 0x01]))
    assert controller.status().ramp != before
    changed = {item.name: item.on_device for item in controller.preview_push([design()], 0).items if item.differs}
    assert changed == {"Full speed": 2000}


@pytest.mark.parametrize(
    ("designs", "first_axis", "rejected"),
    [(2, None, ("axes", "2 designs")), (1, 1, ("to_axis", 1)), (0, None, ("axes", "0 designs"))],
)
def test_a_tic_has_one_axis(
    controller: TicController, designs: int, first_axis: int | None, rejected: tuple[str, object]
) -> None:
    *found, allowed = only_rejection(lambda: controller.prepare_push([design()] * designs, first_axis, "try"))
    assert (tuple(found), allowed.endswith("a Tic has one axis")) == (rejected, True)


def test_no_push_while_the_motor_moves(bench: Bench, controller: TicController) -> None:
    push = controller.prepare_push([design(ramp__slew_speed_steps_per_s=20)], 0, "try")
    controller.move_by(by(5000))
    before = bench.tic.ramp
    for refused in (
        push,
        controller.roll_back,
        lambda: controller.set_position(to(0)),
        lambda: controller.zero([0], 5),
    ):
        with pytest.raises(Refused, match="The motor moves: stop it first"):
            refused()
    assert bench.tic.ramp == before
    assert bench.rest().axes[0].position_steps == 5000


def test_a_backup_brings_back_what_was_in_use(bench: Bench, controller: TicController) -> None:
    text = controller.backup()
    controller.roll_back()
    assert controller.use_backup(text) == ("The Tic forgets these figures when it is reset or switched off.",)
    assert bench.tic.ramp == [0, 10_000_000, 500_000, 500_000]
    assert controller.status().on_trial
    bench.tic.stored_ramp = [0, 10_000_000, 0, 500_000]
    text = controller.backup()
    assert controller.use_backup(text) == ()
    assert not controller.status().on_trial
    assert bench.tic.steps == 0


def test_a_backup_through_a_line_that_loses_bytes(bench: Bench, controller: TicController) -> None:
    text, lost = controller.backup(), iter([True, False, True])
    controller.roll_back()
    bench.tic.on_the_way_in = lambda sent: sent[:-1] if sent[0] == 0xE6 and next(lost, False) else sent
    controller.use_backup(text)
    assert bench.tic.ramp == [0, 10_000_000, 500_000, 500_000]


def test_of_a_settings_file_the_ramp_is_used_and_the_rest_is_told(bench: Bench, controller: TicController) -> None:
    text = "product: T825\ncurrent_limit: 174\nmax_speed: 2000000\nmax_accel: 40000\nstep_mode: 8\n"
    assert controller.use_backup(text) == (
        "The step mode is not as in the backup: it makes 1 of a full step, in the backup 8. The Tic Control Center "
        "sets it.",
        "The Tic keeps other settings than in the backup, of which its serial port writes none: current_limit 192 (in "
        "the backup 174), step_mode 1 (in the backup 8). ticcmd --settings FILE or the Tic Control Center writes them.",
    )
    assert bench.tic.ramp == [0, 2_000_000, 40_000, 40_000]


@pytest.mark.parametrize(
    ("text", "value", "allowed"),
    [
        ("$120=250\n", "1 lines", "a backup of a Tic, or its settings file: lines 'max_speed: …' and 'max_accel: …'"),
        ("max_speed: fast\nmax_accel: 40000", "max_speed: fast", "whole numbers of a Tic's units"),
        ("max_speed: 2000000\nmax_accel: 99", "max_accel: 99", "accelerations from 100 to 2,147,483,647"),
        ("max_speed: 2000000\nmax_accel: 400\nstep_mode: 3", "step_mode: 3", "a step mode of a Tic: full"),
    ],
)
def test_what_is_no_backup_is_rejected(
    bench: Bench, controller: TicController, text: str, value: str, allowed: str
) -> None:
    rejected = only_rejection(lambda: controller.use_backup(text))
    assert rejected[0] == "text"
    assert value in str(rejected[1])
    assert allowed in rejected[2]
    assert bench.told() == []


def test_no_backup_is_written_while_the_motor_moves(bench: Bench, controller: TicController) -> None:
    text = controller.backup()
    controller.move_by(by(5000))
    with pytest.raises(Refused, match="The motor moves: stop it first"):
        controller.use_backup(text)
    assert bench.tic.ramp == [0, 10_000_000, 500_000, 500_000]


@pytest.mark.parametrize("write", ["push", "roll back", "restore"])
def test_a_stop_at_any_place_of_a_write_loses_none_of_it(bench: Bench, write: str) -> None:
    bench.controller.connect()
    text, ramp = bench.controller.backup(), bench.tic.ramp
    writes: dict[str, tuple[Callable[[], object], int]] = {
        "push": (bench.controller.prepare_push([design(ramp__slew_speed_steps_per_s=300)], 0, "try"), 3_000_000),
        "roll back": (bench.controller.roll_back, ramp[1]),
        "restore": (lambda: bench.controller.use_backup(text), ramp[1]),
    }
    do, speed = writes[write]
    for interruption in interruptions(bench, bench.controller.stop, apart=5):
        bench.controller.prepare_push([design()], 0, "try")()
        with interruption:
            do()
        assert bench.tic.ramp[1] == speed, interruption.place
        if not interruption.came:
            break
    assert interruption.place >= 10
    assert bench.tic.steps == 0
