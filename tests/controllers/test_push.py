import numpy as np
import pytest

from designs import design
from firmware.protocol import crc16
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.playback import unpacked
from stepramp.controllers.stepramp.push import PushPlan, plan_push
from stepramp.controllers.stepramp.push_limits import PushLimits
from stepramp.controllers.stepramp.ramp_image import FormulaRamp, RampImage, SegmentRamp
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import HELLO
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.plan import ramp_of

FAST = {"timer__frequency_hz": 16_000_000}


def limits(**changes: object) -> HelloReply:
    return HelloReply(**{**vars(HELLO), **changes})


def planned(*designs: Design, hello: HelloReply = HELLO, settings: StepRampSettings | None = None) -> PushPlan:
    return plan_push(designs, hello, settings or StepRampSettings())


def segments_of(plan: PushPlan, axis: int = 0) -> SegmentRamp:
    ramp = plan.image.axes[axis]
    assert isinstance(ramp, SegmentRamp)
    return ramp


def rejected(*designs: Design, hello: HelloReply = HELLO, settings: StepRampSettings | None = None) -> Rejection:
    with pytest.raises(Rejected) as caught:
        planned(*designs, hello=hello, settings=settings)
    return caught.value.rejections[0]


@pytest.mark.parametrize("lengths", [(2000, 40), (40, 2000), (40, 41)])
def test_axes_whose_ramps_differ_by_the_peak_of_their_moves_have_each_their_own(lengths: tuple[int, int]) -> None:
    shape = {"name": "s_curve", "jerk_steps_per_s3": 200_000.0}
    both = [
        design(
            schema="stepramp/2", method__name="exact", ramp__shape=shape, ramp__slew_speed_steps_per_s=2000.0,
            ramp__acceleration_steps_per_s2=8000.0, move__steps=steps,
        )
        for steps in lengths
    ]  # fmt: skip
    pushed = plan_push(both, limits(), StepRampSettings())
    for axis, own in enumerate(both):
        sent, planned = unpacked(pushed.image.axes[axis]), ramp_of(own)
        assert (sent.up.size, sent.slew) == (planned.up.size, planned.slew)


def test_a_ramp_that_fits_is_sent_as_it_is() -> None:
    plan = planned(design())
    ramp, sent = ramp_of(design()), unpacked(plan.image.axes[0])
    assert plan.bounds_ticks == (0,)
    assert np.array_equal(sent.up, ramp.up)
    assert np.array_equal(sent.down, ramp.down)
    assert sent.slew == ramp.slew
    assert segments_of(plan).down == segments_of(plan).up


def test_the_report_of_a_good_push() -> None:
    plan = planned(design(ramp__deceleration_steps_per_s2=2500))
    report = plan.report(plan.image.encode(), 7, kept=True)
    rows = {item.name: (item.unit, item.requested, item.sent, item.read_back) for item in report.items}
    crc = rows.pop("Ramp image")
    assert rows == {
        "Up ramp steps": ("steps", 100, 100, 100),
        "First interval": ("µs", 10_000.0, 10_000.0, 10_000.0),
        "Slew interval": ("µs", 1000.0, 1000.0, 1000.0),
        "Down ramp steps": ("steps", 200, 200, 200),
        "Last interval": ("µs", 14_142.0, 14_142.0, 14_142.0),
    }
    assert crc == ("CRC-16", *[crc16(plan.image.encode())] * 3)
    assert [item.axis for item in report.items] == [0] * 5 + [None]
    assert (report.verified, report.kept, report.largest_deviation_us) == (True, True, 0)
    assert (report.sequence, report.bytes, report.warnings) == (7, len(plan.image.encode()), ())
    assert report.segments == len(segments_of(plan).up) + len(segments_of(plan).down)


def test_the_report_tells_what_is_there_instead() -> None:
    plan = planned(design())
    other = planned(design(ramp__slew_speed_steps_per_s=500)).image.encode()
    report = plan.report(other, 1, kept=True)
    slew = next(item for item in report.items if item.name == "Slew interval")
    assert not report.verified
    assert (slew.sent, slew.read_back) == (1000.0, 2000.0)
    assert "not what was sent" in report.warnings[0]
    unreadable = plan.report(b"\xff" * 20, 1, kept=True)
    assert unreadable.items[0].read_back is None


def test_a_ramp_without_steps_has_no_first_interval() -> None:
    flat = planned(design(ramp__base_speed_steps_per_s=1000))
    names = [item.name for item in flat.report(flat.image.encode(), 1, kept=True).items]
    assert ("First interval" in names) == bool(segments_of(flat).up)


# ---- several axes ----


def test_no_move_is_planned_for_a_push(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of ten million steps would hold it up, and nothing of it is sent."""

    def play(*_: object) -> None:
        raise AssertionError("a move has been planned")

    monkeypatch.setattr("stepramp.ramp.plan.play", play)
    assert planned(design(move__steps=10_000_000)).image == planned(design()).image


def test_equal_ramps_are_sent_once() -> None:
    plan = planned(design(), design(name="Other", move__steps=5), design(ramp__slew_speed_steps_per_s=500))
    assert plan.image.axes[0] == plan.image.axes[1] != plan.image.axes[2]
    assert len(plan.image.ramps) == 2
    report = plan.report(plan.image.encode(), 1, kept=False)
    assert [item.name for item in report.items if "slew" in item.name.lower()] == [
        "Axis 0: slew interval",
        "Axis 1: slew interval",
        "Axis 2: slew interval",
    ]
    assert report.segments == plan.image.sent_segments


def test_one_design_replaces_the_ramp_of_one_axis() -> None:
    present = planned(design(), design(ramp__slew_speed_steps_per_s=500)).image
    slower = design(ramp__slew_speed_steps_per_s=300)
    plan = plan_push([slower], HELLO, StepRampSettings(), 1, present)
    assert plan.image.axes == (present.axes[0], planned(slower).image.axes[0])
    added = plan_push([slower], HELLO, StepRampSettings(), 2, present)
    assert added.image.axes[:2] == present.axes
    assert unpacked(added.image.axes[2]).slew == ramp_of(slower).slew


@pytest.mark.parametrize(("axis", "axes"), [(1, 0), (2, 1), (-1, 1), (4, 4)])
def test_an_axis_that_would_leave_a_gap(axis: int, axes: int) -> None:
    present = planned(*[design()] * axes).image if axes else None
    with pytest.raises(Rejected) as caught:
        plan_push([design()], HELLO, StepRampSettings(), axis, present)
    assert caught.value.rejections[0].field == "to_axis"


def test_more_designs_than_axes() -> None:
    assert rejected(*[design()] * 5).field == "axes"
    assert rejected().field == "axes"


def test_the_largest_ramp_is_made_coarser_first() -> None:
    large = design(ramp__acceleration_steps_per_s2=600, ramp__deceleration_steps_per_s2=1100)
    small = design(ramp__acceleration_steps_per_s2=20_000)
    plan = planned(large, small)
    assert len(plan.image.encode()) <= 440
    assert plan.bounds_ticks[0] > 0 == plan.bounds_ticks[1]
    warnings = plan.report(plan.image.encode(), 1, kept=True).warnings
    assert len(warnings) == 1
    assert "intervals of axis 0" in warnings[0]


def test_axes_that_cant_all_move_at_once_are_told() -> None:
    quick = design(**FAST, ramp__slew_speed_steps_per_s=35_000, ramp__acceleration_steps_per_s2=1e9)
    plan = planned(quick, quick, quick, quick)
    [warning] = plan.report(plan.image.encode(), 1, kept=True).warnings
    # 4 (533 / 4) / 457, 457 fast ticks being 35,000 steps/s.
    assert "all 4 axes together would take 117 %" in warning
    assert planned(quick, quick).report(b"", 1, kept=True).warnings[1:] == ()


def test_which_pulse_width_would_do_is_told() -> None:
    """By hand, in fast ticks: 20,000 steps/s are 800. Four axes need 533 + 128 w, a line 181 + 32 w, one 106 + 32 w."""
    quick = design(**FAST, ramp__slew_speed_steps_per_s=20_000, ramp__acceleration_steps_per_s2=1e9)
    plan = planned(quick, quick, quick, quick, settings=StepRampSettings(pulse_width_us=10))
    [warning] = plan.report(plan.image.encode(), 1, kept=True).warnings
    # 4 (1813 / 4) / 800.
    assert "all 4 axes together would take 227 %" in warning
    assert warning.endswith("except along a line, or with a pulse width of at most 2 µs (now 10 µs).")
    plan = planned(quick, quick, quick, quick, settings=StepRampSettings(pulse_width_us=20))
    [warning] = plan.report(plan.image.encode(), 1, kept=True).warnings
    assert "line" not in warning
    alone = rejected(quick, settings=StepRampSettings(pulse_width_us=29))
    assert "20,000" not in alone.allowed
    assert alone.allowed.endswith("or with a pulse width of at most 21 µs (now 29 µs)")


# ---- as fast as segments are prepared ----

STEEP = {**FAST, "ramp__slew_speed_steps_per_s": 29_000, "ramp__acceleration_steps_per_s2": 900_000}


def shortest_row_s(plan: PushPlan) -> float:
    """Return how long the quickest eight segments in a row of an image last [s]."""
    rows = []
    for each in plan.image.axes:
        assert isinstance(each, SegmentRamp)
        for segments in (each.up, each.down):
            lengths = [sum(s.interval + i * s.add for i in range(s.count)) / 16e6 for s in segments]
            rows += [sum(lengths[i : i + 8]) for i in range(len(lengths) - 7)]
    return min(rows)


def test_more_axes_get_fewer_segments_in_the_same_time() -> None:
    one, two = planned(design(**STEEP)), planned(*[design(**STEEP)] * 2)
    assert one.keeps_pace
    assert shortest_row_s(one) >= 8 * 0.35e-3
    assert two.keeps_pace
    assert shortest_row_s(two) >= 2 * 8 * 0.35e-3
    assert two.bounds_ticks[0] > one.bounds_ticks[0]
    assert two.report(two.image.encode(), 1, kept=True).warnings[0].startswith("To fit the controller")


def test_axes_near_their_limits_get_fewer_still() -> None:
    """Where four of them come to 29,000 steps/s of 30,000 they take 97 % of the processor that they may."""
    four = planned(*[design(**{**STEEP, "ramp__acceleration_steps_per_s2": 290_000})] * 4)
    assert four.keeps_pace
    last = segments_of(four).up[-8:]
    lasting_s = sum(s.count * s.interval + s.add * s.count * (s.count - 1) // 2 for s in last) / 16e6
    assert lasting_s >= 4 * 8 * 0.7e-3 * 533 / 552


def test_ramps_that_stay_must_keep_pace_with_more_axes_too() -> None:
    steep = design(**STEEP)
    one = planned(steep)
    assert one.keeps_pace
    two = plan_push([steep], HELLO, StepRampSettings(), 1, one.image)
    assert two.out_of_pace == (0,)
    assert two.report(two.image.encode(), 1, kept=True).warnings[-1].endswith("push the designs of all axes together.")


@pytest.mark.parametrize(("acceleration", "base_speed", "keeps_pace"), [(4e8, 0, False), (1e9, 20_000, True)])
def test_up_and_down_count_together_where_each_has_few_segments(
    acceleration: float, base_speed: float, keeps_pace: bool
) -> None:
    """A short move plays one right after the other, within 0.7 ms. Up to seven may be ready beforehand."""
    steep = {"ramp__slew_speed_steps_per_s": 149_000, "ramp__base_speed_steps_per_s": base_speed}
    plan = planned(design(**FAST | steep, ramp__acceleration_steps_per_s2=acceleration))
    (ramp,) = plan.image.axes
    assert isinstance(ramp, SegmentRamp)
    assert plan.keeps_pace == keeps_pace == (len(ramp.up) + len(ramp.down) < 8)
    assert len(ramp.up) < 8


def test_a_ramp_too_short_for_its_segments_is_sent_with_a_warning() -> None:
    steeper = {**STEEP, "ramp__acceleration_steps_per_s2": 2_500_000}
    plan = planned(*[design(**steeper)] * 4)
    assert not plan.keeps_pace
    warnings = plan.report(plan.image.encode(), 1, kept=True).warnings
    assert any("all 4 motors moving together may have to wait" in warning for warning in warnings)


# ---- clocks ----


def test_the_clock_is_that_of_the_designs() -> None:
    assert planned(design()).image.fast_clock is False
    plan = planned(design(**FAST))
    assert (plan.image.fast_clock, plan.timer_hz) == (True, 16_000_000)
    assert unpacked(plan.image.axes[0]).slew == 16_000


def test_a_timer_that_is_no_clock_of_the_controller() -> None:
    rejection = rejected(design(timer__frequency_hz=1_000_000))
    assert (rejection.field, rejection.value) == ("axes.0.timer.frequency_hz", 1_000_000)
    assert "16,000,000 or 2,000,000 Hz" in rejection.allowed
    with pytest.raises(Rejected) as caught:
        plan_push([design(timer__frequency_hz=1_000_000)], HELLO, StepRampSettings(), 0)
    assert caught.value.rejections[0].field == "timer.frequency_hz"


def test_all_axes_have_one_clock() -> None:
    rejection = rejected(design(), design(**FAST))
    assert (rejection.field, rejection.value) == ("axes.1.timer.frequency_hz", 16_000_000)
    assert rejection.allowed.startswith("2,000,000 Hz, that of axis 0")
    present = planned(design(), design()).image
    with pytest.raises(Rejected, match="2,000,000 Hz, that of the axes that keep their ramps"):
        plan_push([design(**FAST)], HELLO, StepRampSettings(), 0, present)
    alone = plan_push([design(**FAST)], HELLO, StepRampSettings(), 0, planned(design()).image)
    assert alone.image.fast_clock


# ---- memory ----


def test_a_smaller_memory_takes_a_coarser_ramp_with_the_least_bound() -> None:
    exact, coarse = planned(design()), planned(design(), hello=limits(most_segments=20))
    assert exact.image.sent_segments > coarse.image.sent_segments
    assert coarse.image.sent_segments <= 20
    report = coarse.report(coarse.image.encode(), 1, kept=True)
    assert 0 < report.largest_deviation_us <= coarse.bounds_ticks[0] / 2
    assert "To fit the controller's memory" in report.warnings[0]
    small = planned(design(), hello=limits(largest_image_bytes=80))
    assert len(small.image.encode()) <= 80
    # With one segment less than the exact ramp takes, an interval moves by a tick: half a microsecond at 2 MHz.
    least = planned(design(), hello=limits(most_segments=exact.image.sent_segments - 1))
    [warning] = least.report(least.image.encode(), 1, kept=True).warnings
    assert warning.endswith(" were changed by up to 1 tick: at most 0.5 µs from the design.")


def test_a_ramp_that_no_bound_makes_fit_is_refused() -> None:
    rejection = rejected(design(), hello=limits(most_segments=2))
    assert rejection.field == "axes.0.ramp.acceleration_steps_per_s2"
    assert "at most 2 segments" in rejection.allowed
    rejection = rejected(design(method__name="table"), hello=limits(most_segments=2))
    assert rejection.field == "axes.0.table.rows"
    assert rejection.reason.startswith("Too long for this controller: 10 of 2 segments")


def test_the_ramps_that_stay_count_too() -> None:
    uneven = design(ramp__acceleration_steps_per_s2=1500, ramp__deceleration_steps_per_s2=2500)
    present = planned(uneven, design(ramp__acceleration_steps_per_s2=4000)).image
    assert len(present.encode()) > 400
    with pytest.raises(Rejected, match="Too long for this controller") as caught:
        plan_push([design(ramp__acceleration_steps_per_s2=10)], HELLO, StepRampSettings(), 2, present)
    assert caught.value.rejections[0].field == "ramp.acceleration_steps_per_s2"


def test_compression_keeps_the_limits_that_the_design_keeps() -> None:
    hello = limits(shortest_intervals=(16_000,) * 4, most_segments=20)
    plan = planned(design(), hello=hello)
    assert plan.bounds_ticks[0] > 0
    assert segments_of(plan).keeps(range(2000, 2**28))


# ---- speeds ----


@pytest.mark.parametrize(
    ("changes", "hello", "field", "allowed"),
    [
        ({"ramp__slew_speed_steps_per_s": 160_000}, {}, "ramp.slew_speed_steps_per_s", "to 142,857.1428 steps/s"),
        (
            {"ramp__slew_speed_steps_per_s": 0.005, "ramp__acceleration_steps_per_s2": 1},
            {},
            "ramp.slew_speed_steps_per_s",
            "from 0.00745059",
        ),
        ({}, {"longest_interval_ticks": 9999}, "ramp.acceleration_steps_per_s2", "4,999.5 µs"),
        ({"method__name": "table"}, {"longest_interval_ticks": 4999}, "table.rows.0.1", "to 2,499 µs"),
        ({"method__name": "table"}, {"shortest_intervals": (11_200,) * 4}, "table.rows.4.1", "from 700 to"),
        (
            {"method__name": "table", "table__interval_unit": "ticks"},
            {"shortest_intervals": (5600,) * 4, "longest_interval_ticks": 2**24 - 1},
            "table.rows.4.1",
            "from 700 to 16,777,215 ticks",
        ),
    ],
)
def test_intervals_that_the_controller_cant_play(changes: dict, hello: dict, field: str, allowed: str) -> None:
    rejection = rejected(design(**changes), hello=limits(**hello))
    assert rejection.field == f"axes.0.{field}"
    assert allowed in rejection.allowed
    assert "this controller" in rejection.allowed


def test_the_fastest_speed_that_is_allowed_is_taken() -> None:
    quick = {"ramp__slew_speed_steps_per_s": 142_857, "ramp__acceleration_steps_per_s2": 1e8}
    assert segments_of(planned(design(**quick))).slew_interval_ticks == 14
    quick = FAST | {"ramp__slew_speed_steps_per_s": 150_943, "ramp__acceleration_steps_per_s2": 1e8}
    assert segments_of(planned(design(**quick))).slew_interval_ticks == 106


@pytest.mark.parametrize(
    ("settings", "fastest"),
    [
        (StepRampSettings(), 16_000_000 / 106),
        (StepRampSettings(pulse_width_us=10), 16_000_000 / (106 + 320)),
        (StepRampSettings(outputs="gauges"), 5000),
    ],
)
def test_settings_make_it_slower(settings: StepRampSettings, fastest: float) -> None:
    assert PushLimits.of(HELLO, settings, 16_000_000).of_segments.start == round(16_000_000 / fastest)
    above = design(**FAST, ramp__slew_speed_steps_per_s=fastest * 1.01, ramp__acceleration_steps_per_s2=1e8)
    assert rejected(above, settings=settings).field == "axes.0.ramp.slew_speed_steps_per_s"


# ---- formulas ----


def by_formula(**changes: object) -> Design:
    return design(method__name="newton", method__arithmetic="fixed", **changes)


def test_a_formula_that_the_controller_computes_takes_no_segments() -> None:
    plan = planned(by_formula(), design())
    assert isinstance(plan.image.axes[0], FormulaRamp)
    assert RampImage.decode(plan.image.encode()) == plan.image
    report = plan.report(plan.image.encode(), 1, kept=True)
    assert (report.verified, report.largest_deviation_us) == (True, 0)
    assert next(item for item in report.items if item.name == "Axis 0: up ramp steps").read_back == 100


def test_a_formula_is_sent_as_segments_to_a_controller_that_computes_none() -> None:
    plan = planned(by_formula(), hello=limits(more=bytes([0b1110, 24, 32])))
    assert segments_of(plan).up
    assert isinstance(planned(by_formula(), hello=limits(protocol_version=2, more=b"")).image.axes[0], FormulaRamp)


def test_a_formula_that_is_too_fast_to_be_computed_is_sent_as_segments() -> None:
    quick = by_formula(**FAST, ramp__slew_speed_steps_per_s=40_000, ramp__acceleration_steps_per_s2=1e7)
    assert isinstance(planned(quick).image.axes[0], SegmentRamp)
