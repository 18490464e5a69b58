"""Pushing designs to a grbl: two settings an axis, rounded down, read back, and backed up before."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from controllers.grbl.bench import Bench, by, to
from controllers.grbl.emulator import Eeprom
from designs import design
from stepramp.controllers.contract import OwnTerms, PushReport
from stepramp.controllers.grbl import conversation
from stepramp.controllers.grbl.controller import IN_USE, GrblController
from stepramp.controllers.grbl.push import PushPlan
from stepramp.controllers.grbl.ramp import GrblRamp, grbl_losses
from stepramp.controllers.grbl.read_settings import read_settings
from stepramp.controllers.grbl.settings import Settings, kept_acceleration
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused, Rejected

SCALE = "The design has 50 steps per mm, grbl 250 per mm: the design's steps are sent, not its lengths."
PATIENCE_S = 10.0
OWN_INTERVALS = "The method Exact is not kept: grbl works its intervals out itself, one speed for each 10 ms."


def push(controller: GrblController, *designs: Design, axis: int | None = 0) -> PushReport:
    return controller.prepare_push(designs, axis if len(designs) == 1 else None)()


def fields_of(ask: Callable[[], object]) -> list[tuple[str, object, str]]:
    with pytest.raises(Rejected) as caught:
        ask()
    return [(each.field, each.value, each.allowed) for each in caught.value.rejections]


def test_what_is_sent_and_read_back(bench: Bench, controller: GrblController) -> None:
    report = push(controller, design(), axis=1)
    # 1000 steps/s · 60 / 250 = 240 mm/min; 5000 / 250 = 20 mm/s². A reset would show the same list again.
    assert bench.grbl.lines == ["$$", "$N", "$111=240.000", "$121=20.000", "$$", "$N"]
    assert (bench.grbl.eeprom.settings[121], bench.grbl.eeprom.settings[111]) == (20.0, 240.0)
    speed, gain = report.items
    assert (speed.requested, speed.sent, speed.read_back, speed.unit, speed.axis) == (1000, 1000, 1000, "steps/s", 1)
    assert speed.own == OwnTerms("$111", "mm/min", 240.0, 240.0)
    assert gain.own == OwnTerms("$121", "mm/s²", 20.0, 20.0)
    assert (report.verified, report.kept, report.sequence, report.segments) == (True, True, None, None)
    assert report.warnings == (OWN_INTERVALS, SCALE)
    assert bench.grbl.steps == 0
    assert controller.steps_to_rest(1, 1000) == 100 + 60


def test_all_axes_at_once(bench: Bench, controller: GrblController) -> None:
    other = design(ramp__slew_speed_steps_per_s=500), design(ramp__acceleration_steps_per_s2=999)
    report = push(controller, design(), *other)
    assert any("Axis 2: Acceleration 999 steps/s² is rounded down to 998.7" in loss for loss in report.warnings)
    assert [bench.grbl.eeprom.settings[number] for number in (110, 111, 112)] == [240, 120, 240]
    # 999 / 250 = 3.996 would be kept as 3.9960001.
    assert [bench.grbl.eeprom.settings[number] for number in (120, 121)] == [20, 20]
    assert bench.grbl.eeprom.settings[122] == pytest.approx(3.995, rel=1e-7)
    assert fields_of(lambda: push(controller, *[design()] * 4)) == [("axes", "4 designs", "up to 3 designs")]
    assert fields_of(lambda: push(controller, design(), axis=3)) == [
        ("to_axis", 3, "an axis of this controller: 0 to 2")
    ]


def test_a_preview_says_what_would_change_and_what_is_lost(controller: GrblController) -> None:
    preview = controller.preview_push([design(ramp__base_speed_steps_per_s=100)], 0)
    speed, gain = preview.items
    assert (speed.on_device, speed.to_send, speed.differs) == (pytest.approx(2083.333333), 1000, True)
    assert gain.own == OwnTerms("$120", "mm/s²", 20.0, 10.0)
    assert not preview.same
    assert preview.warnings == ("Base speed 100 steps/s is not kept: grbl starts from 0.", OWN_INTERVALS, SCALE)
    push(controller, design())
    assert controller.preview_push([design()], 0).same


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {"ramp__deceleration_steps_per_s2": 4000},
            "Acceleration 5,000 steps/s² is not kept: grbl has one acceleration for both, so the smaller one, 4,000 "
            "steps/s², is sent.",
        ),
        (
            {"ramp__deceleration_steps_per_s2": 6000},
            "Deceleration 6,000 steps/s² is not kept: grbl has one acceleration for both, so the smaller one, 5,000 "
            "steps/s², is sent.",
        ),
        (
            {"schema": "stepramp/2", "ramp__shape": {"name": "cosine"}},
            "The shape Cosine is not kept: grbl's acceleration is constant.",
        ),
        ({"method__name": "table"}, "The lookup table is not kept: grbl works its intervals out itself, one speed"),
        (
            {"ramp__slew_speed_steps_per_s": 40_000},
            "Slew speed 40,000 steps/s is more than the 30,000 steps/s that grbl",
        ),
        ({"ramp__slew_speed_steps_per_s": 20}, "Slew speed 20 steps/s is not kept: on an Uno grbl makes no fewer than"),
    ],
)
def test_each_loss_is_named(changes: dict[str, object], told: str) -> None:
    assert any(loss.startswith(told) for loss in grbl_losses(design(**changes)))


def test_what_was_sent_before_a_refusal_is_told_and_known(bench: Bench, controller: GrblController) -> None:
    bench.grbl.most[120] = 15.0
    with pytest.raises(Refused, match=r"refuses '\$120=20.000'.*What was sent before that is stored: restore a backup"):
        push(controller, design())
    # 240 mm/min · 250 / 60, and 10 mm/s² as before.
    assert [item.on_device for item in controller.preview_push([design()], 0).items] == [1000, 2500]
    assert controller.steps_to_rest(0, 1000) == 200 + 60


def test_the_smaller_acceleration_is_sent() -> None:
    for lower in ({"ramp__deceleration_steps_per_s2": 4000}, {"ramp__acceleration_steps_per_s2": 4000}):
        both = {"ramp__deceleration_steps_per_s2": 5000} | lower
        assert GrblRamp.of(design(**both), np.float32(250)).acceleration_text == "16.000"


@given(st.floats(5, 30_000), st.floats(10, 5e6), st.sampled_from([5.0, 80.0, 250.0, 314.961, 3200.0]))
@example(1000.0, 460.0, 250.0)  # 1.84 mm/s² is more in float32, but not as the 6624 mm/min² that grbl makes of it
def test_neither_speed_nor_acceleration_is_more_than_asked(speed: float, gain: float, per_mm: float) -> None:
    if speed < per_mm / 60 * 1.01:
        return
    scale = np.float32(per_mm)
    ramp = GrblRamp.of(design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain), scale)
    exact_scale = Fraction(float(scale))
    rate = Fraction(float(np.float32(float(ramp.rate))))
    assert rate * exact_scale / 60 <= Fraction(str(speed))
    assert kept_acceleration(ramp.acceleration) * exact_scale <= Fraction(str(gain))
    assert ramp.speed_steps_per_s <= speed
    assert ramp.acceleration_steps_per_s2 <= gain
    assert ramp.speed_steps_per_s == pytest.approx(speed, abs=float(exact_scale) * 3e-5 + 4e-7 * speed)
    assert ramp.acceleration_steps_per_s2 == pytest.approx(gain, abs=float(exact_scale) * 2e-3 + 4e-7 * gain)


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        # Less than 0.002 mm/s² may become 0, with which grbl hangs; slower than 1 mm/min it plans nothing.
        ({"ramp__acceleration_steps_per_s2": 0.25}, "ramp.acceleration_steps_per_s2", "a number from 0.5 to"),
        ({"ramp__deceleration_steps_per_s2": 0.25}, "ramp.deceleration_steps_per_s2", "a number from 0.5 to"),
        ({"ramp__slew_speed_steps_per_s": 4}, "ramp.slew_speed_steps_per_s", "a number from 4.16667 to"),
    ],
)
def test_what_would_hang_it_is_rejected(
    bench: Bench, controller: GrblController, changes: dict[str, object], field: str, allowed: str
) -> None:
    for ask in (
        lambda: controller.prepare_push([design(**changes)], 0),
        lambda: controller.preview_push([design(**changes)], 0),
    ):
        [(named, _, told)] = fields_of(ask)
        assert named == field
        assert told.startswith(allowed)
        assert "with grbl at 250 steps/mm" in told
    [(named, _, _)] = fields_of(lambda: controller.prepare_push([design(), design(**changes)]))
    assert named == f"axes.1.{field}"
    assert bench.grbl.lines == []


def test_grblhals_own_limit_is_told(bench: Bench, controller: GrblController) -> None:
    bench.grbl.most[110] = 200.0
    with pytest.raises(Refused, match=r"refuses '\$110=240.000': the value is out of its range \(error:52\)"):
        push(controller, design())


def test_it_is_refused_while_something_moves_and_after_a_limit_was_hit(
    bench: Bench, controller: GrblController
) -> None:
    send = controller.prepare_push([design()], 0)
    controller.move_by([by(2000)])
    with pytest.raises(Refused, match="only at rest, and its state is 'Jog'"):
        send()
    bench.rest()
    for state, words in (("Hold", "its state is 'Hold'"), ("Check", "its state is 'Check'")):
        bench.grbl.state = state
        with pytest.raises(Refused, match=words):
            send()
    bench.grbl.state = "Alarm"
    controller._conversation.alarm = 1
    with pytest.raises(Refused, match="in alarm since a limit was hit"):
        send()
    assert bench.grbl.eeprom.writes == 0


def test_one_that_is_locked_takes_settings_and_stays_locked(bench: Bench) -> None:
    bench.grbl.eeprom.settings[22] = 1.0
    bench.grbl.power_up()
    bench.controller.connect()
    assert push(bench.controller, design()).verified
    assert bench.grbl.state == "Alarm"


def test_one_setting_at_a_time_so_that_none_is_lost(bench: Bench, controller: GrblController) -> None:
    push(controller, design(), design(), design())
    assert bench.grbl.bytes_lost == 0
    assert bench.grbl.eeprom.writes == 6


def started_again(bench: Bench) -> GrblController:
    """Open the port again, which starts it anew, and return the client that is connected then."""
    bench.port.close()
    bench.reopen()
    bench.controller.connect()
    assert isinstance(bench.controller, GrblController)
    return bench.controller


@pytest.fixture
def _patient(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait as long as for a real one: what answers at once costs nothing by that, also where the machine is busy."""
    del bench
    monkeypatch.setattr(conversation, "ANSWER_S", PATIENCE_S)
    monkeypatch.setattr(conversation, "GREETING_S", PATIENCE_S)


@pytest.mark.usefixtures("_patient")
def test_what_is_stored_is_seen_at_its_next_start(bench: Bench, controller: GrblController) -> None:
    assert controller.has_started
    push(controller, design())
    given = controller.take_given()
    assert given == {"$110": "240.000", "$120": "20.000"}
    assert controller.take_given() == {}
    again = started_again(bench)
    assert again.has_started
    assert again.others({"$110": "240.000", "$120": "20"}) == {}


@pytest.mark.usefixtures("_patient")
@pytest.mark.parametrize("fault", ["is_broken", "is_worn"])
def test_what_its_eeprom_did_not_keep_is_found_by_its_next_start(
    bench: Bench, controller: GrblController, fault: str
) -> None:
    setattr(bench.grbl.eeprom, fault, True)
    report = push(controller, design())
    # It tells what it has in use, also after a reset by 0x18.
    assert report.verified
    bench.grbl.exchange(b"\x18")
    assert bench.grbl.settings[110] == 240
    again = started_again(bench)
    assert again.others({"$110": "240.000", "$120": "20.000"}) == {"$110": "500.000", "$120": "10.000"}
    assert again.others({"$113": "1"}) == {"$113": None}


def test_one_that_goes_on_and_greets_has_not_started(bench: Bench, controller: GrblController) -> None:
    push(controller, design())
    bench.grbl.eeprom.settings[110] = 77.0
    bench.grbl.starts_on_open, bench.grbl.greets_after_s = False, 0.003
    again = started_again(bench)
    assert again._conversation.banner is not None
    assert not again.has_started
    assert not again.others({"$110": "240.000"})


def test_a_push_resets_nothing_and_positions_stay(bench: Bench, controller: GrblController) -> None:
    controller.move_by([by(700)])
    bench.rest()
    controller.set_position([to(50)])
    bench.grbl.on_the_way_in = lambda data: data.replace(b"\x18", b"it is reset\n")
    push(controller, design())
    assert controller.status().axes[0].position_steps == 50
    controller.move_by([by(1)])
    bench.rest()
    assert bench.grbl.position[0] == 701
    assert "ITISRESET" not in bench.grbl.lines


def test_it_is_started_anew_only_where_that_moves_nothing(bench: Bench, controller: GrblController) -> None:
    controller.refuse_start()
    # Somebody has stored it since it was connected.
    bench.grbl.eeprom.startup[0] = "G0 X10"
    with pytest.raises(Refused, match=r"start-up lines \(\$N\) as it starts, which may move something"):
        controller.refuse_start()
    bench.grbl.eeprom.startup[0] = "G54"
    controller.refuse_start()
    controller.move_by([by(20_000)])
    with pytest.raises(Refused, match="only at rest"):
        controller.refuse_start()


def test_what_was_given_is_told_as_far_as_that_is_known(bench: Bench, controller: GrblController) -> None:
    bench.grbl.most[120] = 15.0
    with pytest.raises(Refused):
        push(controller, design())
    assert controller.take_given() == {"$110": "240.000", "$120": None}
    text = controller.backup().replace("$110=240.000", "$110=300.000").replace("$1=25", "$1=30")
    restored(bench, text)
    given = controller.take_given()
    # What is as in the backup already was given nothing, and other settings than those of axes aren't told.
    assert given == {"$110": "300.000"}
    assert controller.take_left() == {f"${number}" for number in bench.grbl.settings if number >= 100} - {"$110"}
    assert not controller.take_left()


@pytest.mark.parametrize("later", [500.0, 100.0])
def test_a_push_that_was_worked_out_with_other_steps_per_mm_is_refused(
    bench: Bench, controller: GrblController, later: float
) -> None:
    send = controller.prepare_push([design()], 0)
    bench.grbl.settings[100] = bench.grbl.eeprom.settings[100] = later
    with pytest.raises(Refused, match=rf"\$100 was 250 and is {later:g} now: .* Nothing was written: push again\."):
        send()
    assert bench.grbl.eeprom.writes == 0
    report = controller.prepare_push([design()], 0)()
    assert report.verified
    assert [item.read_back for item in report.items] == [1000, 5000]
    assert bench.grbl.eeprom.settings[110] * later / 60 == 1000
    assert bench.grbl.eeprom.settings[120] * later == 5000


@given(st.floats(0.5, 900), st.floats(100, 5000), st.floats(1000, 9e4))
@example(8.8888889, 1000.0, 2000.0)
@example(2.2224, 1000.0, 2000.0)
@example(78.740157, 1000.0, 2000.0)
@example(899.7405072268443, 4498.47698121515, 1000.0)
def test_no_more_is_sent_than_was_asked_though_steps_per_mm_are_told_rounded(
    per_mm: float, speed: float, gain: float
) -> None:
    real = Fraction(float(np.float32(per_mm)))
    told = Settings.of([f"$100={float(real):.3f}", "$110=500.000", "$120=10.000"]).axis(0)
    assert told is not None
    if told.slack_per_mm == 0:
        assert f"{float(real):.3f}".endswith("00")
        return
    asked = design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain)
    ramp = PushPlan.of([asked], 0, [told]).ramps[0]
    # A number is what was typed, not the binary fraction next to it.
    assert Fraction(float(ramp.rate)) * real / 60 <= Fraction(repr(speed))
    assert kept_acceleration(ramp.acceleration) * real <= Fraction(repr(gain))


def test_that_steps_per_mm_are_told_rounded_is_said(bench: Bench) -> None:
    bench.grbl.eeprom.settings[100] = float(np.float32(8.8888889))
    bench.grbl.power_up()
    bench.controller.connect()
    report = push(bench.controller, design())
    assert report.verified
    words = (
        "8.889 steps/mm are told rounded: speeds and accelerations are worked out with the 8.8895 that they may be. "
        "Further than 1,000 mm, 8,889 steps, from where the controller counts from, places may be off by a step or "
        "more."
    )
    assert words in report.warnings
    settings = bench.grbl.eeprom.settings
    assert settings[110] * settings[100] / 60 <= 1000
    assert settings[120] * settings[100] <= 5000
    [axis] = read_settings(bench.controller.backup(), design())[:1]
    assert words in axis.remarks
    assert bench.controller.preview_push([axis.design], 0).same


def test_steps_per_mm_that_were_heard_wrong_are_not_pushed_with(bench: Bench) -> None:
    bench.grbl.on_the_way_out = lambda said: said.replace(b"$100=250.000", b"$100=25.000")
    bench.controller.connect()
    bench.grbl.on_the_way_out = lambda said: said
    with pytest.raises(Refused, match=r"\$100 was 25 and is 250 now"):
        push(bench.controller, design())
    assert bench.grbl.eeprom.writes == 0
    assert push(bench.controller, design()).verified


def test_what_is_read_back_counts_by_the_steps_per_mm_that_are_read_back(
    bench: Bench, controller: GrblController
) -> None:
    def others(_: bytes) -> bytes:
        if bench.grbl.eeprom.writes == 2:
            bench.grbl.settings[100] = bench.grbl.eeprom.settings[100] = 500.0
        return _

    bench.grbl.on_the_way_in = others
    report = push(controller, design())
    assert not report.verified
    assert [item.read_back for item in report.items] == [2000, 10_000]
    assert "$100 was 250 and is 500 now: what was sent was worked out with the former." in report.warnings


# Backups.


def restored(bench: Bench, text: str) -> tuple[str, ...]:
    return bench.controller.use_backup(text)


def test_a_backup_has_all_that_can_be_read(controller: GrblController) -> None:
    text = controller.backup()
    for line in ("[VER:1.1h.20190830:]", "$120=10.000", "[G54:0.000,0.000,0.000]", "$N0=", "; $$"):
        assert line in text.splitlines()


def test_restoring_writes_only_what_differs(bench: Bench, controller: GrblController) -> None:
    text = controller.backup()
    push(controller, design())
    writes = bench.grbl.eeprom.writes
    remarks = restored(bench, text)
    assert bench.grbl.eeprom.settings == Eeprom().settings
    assert bench.grbl.eeprom.writes == writes + 2
    assert remarks == (IN_USE, "What G28 and G30 go to can't be written again: go there, and say G28.1 or G30.1.")
    assert controller.preview_push([design()], 0).items[0].on_device == pytest.approx(2083.333333)


@pytest.mark.parametrize("dies_at", [1, 2])
def test_a_power_cut_in_the_midst_of_a_push_is_restored(bench: Bench, controller: GrblController, dies_at: int) -> None:
    eeprom = bench.grbl.eeprom
    eeprom.settings |= {100: 80.0, 110: 3000.0, 120: 200.0}
    eeprom.startup[0], eeprom.offsets[2] = "G54", (1.0, -2.0, 3.5)
    bench.grbl.power_up()
    with pytest.raises(DeviceLost):
        controller.status()
    bench.port.close()
    bench.reopen()
    bench.controller.connect()
    text, before = bench.controller.backup(), (dict(eeprom.settings), list(eeprom.startup), dict(eeprom.offsets))
    bench.grbl.dies_at_write = eeprom.writes + dies_at
    with pytest.raises(DeviceLost, match="does not answer"):
        push(bench.controller, design())
    bench.port.close()
    bench.grbl.power_up()
    bench.reopen()
    bench.controller.connect()
    assert eeprom.settings != before[0]
    assert restored(bench, text)[:-1] == (IN_USE,)
    assert (eeprom.settings, eeprom.startup, eeprom.offsets) == before


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("", "text"),
        ("nothing of the kind", "text"),
        ("$100=250\n$110=500\n$120=10\n$121=0", "$121"),
        ("$100=250\n$110=500\n$120=10\n$101=nan", "$101"),
        ("$100=250\n$110=99999999999\n$120=10\n", "$110"),
        ("$100=250\n$110=500\n$120=10\n$130=99999999999\n", "$130"),
        ("$100=250\n$110=500\n$120=10\n$100=1\n", "$100"),
        ("$100=250\n$110=500\n$120=10\n$N0=G54\n$N0=\n", "$N0"),
        ("$100=250\n$110=500\n$120=10\n[G54:1,0,0]\n[G54:2,0,0]\n", "G54"),
    ],
)
def test_what_is_no_backup_is_rejected(bench: Bench, controller: GrblController, text: str, field: str) -> None:
    [(named, _, _)] = fields_of(lambda: controller.use_backup(text))
    assert named == field
    assert bench.grbl.eeprom.writes == 0
