import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.controllers.messages import HelloReply
from stepramp.controllers.push import plan_push, unpacked
from stepramp.errors import Rejected
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.timer import rescaled


def limits(
    *, timer_hz: int = 2_000_000, intervals: range = range(40, 2**24), most_bytes: int = 500, most_segments: int = 120
) -> HelloReply:
    return HelloReply(1, 0, 1, 0, timer_hz, intervals.start, intervals.stop - 1, most_bytes, most_segments, 1, 0, 0)


def test_a_ramp_that_fits_is_sent_as_it_is() -> None:
    plan = plan_push(design(), limits())
    ramp, sent = ramp_of(design()), unpacked(plan.image)
    assert plan.bound_ticks == 0
    assert np.array_equal(sent.up, ramp.up)
    assert np.array_equal(sent.down, ramp.down)
    assert sent.slew == ramp.slew
    assert plan.image.down == plan.image.up


def test_the_report_of_a_good_push() -> None:
    plan = plan_push(design(ramp__deceleration_steps_per_s2=2500), limits())
    report = plan.report(plan.image.encode(), 7)
    rows = {item.name: (item.unit, item.requested, item.sent, item.read_back) for item in report.items}
    crc = rows.pop("Ramp image CRC")
    assert rows == {
        "Up ramp steps": ("steps", "100", "100", "100"),
        "First interval": ("µs", "10,000.0", "10,000.0", "10,000.0"),
        "Slew interval": ("µs", "1,000.0", "1,000.0", "1,000.0"),
        "Down ramp steps": ("steps", "200", "200", "200"),
        "Last interval": ("µs", "14,142.0", "14,142.0", "14,142.0"),
    }
    assert crc[1] == crc[2] == crc[3]
    assert report.verified
    assert report.largest_deviation_us == 0
    assert (report.sequence, report.bytes, report.warnings) == (7, len(plan.image.encode()), ())
    assert report.segments == len(plan.image.up) + len(plan.image.down)


def test_the_report_tells_what_was_stored_instead() -> None:
    plan = plan_push(design(), limits())
    other = plan_push(design(ramp__slew_speed_steps_per_s=500), limits()).image.encode()
    report = plan.report(other, 1)
    slew = next(item for item in report.items if item.name == "Slew interval")
    assert not report.verified
    assert (slew.sent, slew.read_back) == ("1,000.0", "2,000.0")
    assert "not what was sent" in report.warnings[0]
    unreadable = plan.report(b"\xff" * 20, 1)
    assert unreadable.items[0].read_back == "unreadable"


def test_a_ramp_without_steps_has_no_first_interval() -> None:
    flat = plan_push(design(ramp__base_speed_steps_per_s=1000), limits())
    names = [item.name for item in flat.report(flat.image.encode(), 1).items]
    assert ("First interval" in names) == bool(flat.image.up)


@given(st.sampled_from([1_000_000, 2_000_000, 16_000_000, 1_234_567]))
def test_another_timer_moves_intervals_by_half_a_tick_at_most(timer_hz: int) -> None:
    plan = plan_push(design(), limits(timer_hz=timer_hz, most_bytes=10_000))
    ramp = rescaled(ramp_of(design()), 2_000_000, timer_hz)
    sent = unpacked(plan.image)
    assert np.abs(sent.up - ramp.up).max() <= plan.bound_ticks
    report = plan.report(plan.image.encode(), 1)
    assert report.largest_deviation_us <= (plan.bound_ticks + 0.5) / timer_hz * 1e6 + 1e-6
    assert bool(report.warnings) == bool(report.largest_deviation_us)


def test_a_smaller_memory_takes_a_coarser_ramp_with_the_least_bound() -> None:
    exact = plan_push(design(), limits())
    coarse = plan_push(design(), limits(most_segments=20))
    assert exact.image.sent_segments > coarse.image.sent_segments
    assert coarse.image.sent_segments <= 20
    report = coarse.report(coarse.image.encode(), 1)
    assert 0 < report.largest_deviation_us <= coarse.bound_ticks / 2
    assert "To fit the controller's memory" in report.warnings[0]
    small = plan_push(design(), limits(most_bytes=80))
    assert len(small.image.encode()) <= 80


def test_a_ramp_that_no_bound_makes_fit_is_refused() -> None:
    with pytest.raises(Rejected, match="at most 2 segments") as caught:
        plan_push(design(), limits(most_segments=2))
    assert caught.value.rejections[0].field == "ramp.acceleration_steps_per_s2"
    with pytest.raises(Rejected, match="this one takes 10 segments") as caught:
        plan_push(design(method__name="table"), limits(most_segments=2))
    assert caught.value.rejections[0].field == "table.rows"


def test_compression_keeps_the_limits_that_the_design_keeps() -> None:
    fastest = design(ramp__slew_speed_steps_per_s=1000)
    plan = plan_push(fastest, limits(intervals=range(2000, 2**24), most_segments=20))
    assert plan.bound_ticks > 0
    assert plan.image.keeps(range(2000, 2**24))


@pytest.mark.parametrize(
    ("changes", "intervals", "field", "allowed"),
    [
        ({"ramp__slew_speed_steps_per_s": 60_000}, range(40, 2**24), "ramp.slew_speed_steps_per_s", "50,000 steps/s"),
        (
            {"ramp__slew_speed_steps_per_s": 0.1, "ramp__acceleration_steps_per_s2": 1},
            range(40, 2**24),
            "ramp.slew_speed_steps_per_s",
            "from 0.119209",
        ),
        ({}, range(40, 10_000), "ramp.acceleration_steps_per_s2", "4,999.5 µs"),
        ({"method__name": "table"}, range(40, 5000), "table.rows.0.1", "to 2,499.5 µs"),
        ({"method__name": "table"}, range(1400, 2**24), "table.rows.4.1", "from 700 to"),
        (
            {"method__name": "table", "table__interval_unit": "ticks"},
            range(700, 2**24),
            "table.rows.4.1",
            "from 700 to 16,777,215 ticks",
        ),
    ],
)
def test_intervals_that_the_controller_cant_play(changes: dict, intervals: range, field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        plan_push(design(**changes), limits(intervals=intervals))
    rejection = caught.value.rejections[0]
    assert rejection.field == field
    assert allowed in rejection.allowed
    assert "this controller" in rejection.allowed


def test_the_fastest_speed_that_is_allowed_is_taken() -> None:
    plan = plan_push(design(ramp__slew_speed_steps_per_s=50_000, ramp__acceleration_steps_per_s2=1_000_000), limits())
    assert plan.image.slew_interval_ticks == 40
