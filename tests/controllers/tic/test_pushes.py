"""Ramps on their way to a Tic and back."""

from __future__ import annotations

import pytest

from controllers.tic.bench import Bench, by, only_rejection, to
from controllers.tic.emulator import TicEmulator
from designs import design
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import Refused


def test_a_push_is_sent_read_back_and_told(bench: Bench) -> None:
    bench.controller.connect()
    asked = design(ramp__base_speed_steps_per_s=12.34567, ramp__deceleration_steps_per_s2=2500.125)
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
    assert "the method Exact and" in report.warnings[0]
    assert "switched off" in report.warnings[1]
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
    assert "the lookup table" in preview.warnings[0]


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
