"""What holds for ramps of every shape: laws, short moves, methods, what is refused."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from designs import design, document
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export
from stepramp.ramp.error_curves import error_curves
from stepramp.ramp.plan import plan_of, real_ramp
from stepramp.ramp.profile import profile_of
from stepramp.ramp.slopes import peak_of, playable_slopes_of, slopes_of
from stepramp.ramp.table_delays import ramp_delays

SHAPES: dict[str, dict[str, Any]] = {
    "constant": {"name": "constant"},
    "s_curve": {"name": "s_curve", "jerk_steps_per_s3": 50_000},
    "cosine": {"name": "cosine"},
    "drawn": {"name": "drawn", "points": [[0, 1], [400, 0.9], [1000, 0.3]]},
}


TOLD = {"s_curve": "S-curve, jerk 50000 steps/s^3", "cosine": "Cosine", "drawn": "Drawn, 3 points"}


def shaped(name: str, method: str = "exact", **changes: Any) -> Design:
    return Design.checked(shaped_document(name, method, **changes))


def shaped_document(name: str, method: str = "exact", **changes: Any) -> dict[str, Any]:
    return document(schema="stepramp/2", method={"name": method}, ramp__shape=SHAPES[name], **changes)


shapes = st.one_of(
    st.just({"name": "constant"}),
    st.builds(lambda jerk: {"name": "s_curve", "jerk_steps_per_s3": jerk}, st.floats(1000, 1e8)),
    st.just({"name": "cosine"}),
    st.builds(
        lambda speeds, parts: {"name": "drawn", "points": list(zip(sorted(speeds), parts, strict=True))},
        st.lists(st.integers(0, 9000), min_size=3, max_size=3, unique=True),
        st.lists(st.floats(0.05, 1), min_size=3, max_size=3),
    ),
)  # fmt: skip

moves = st.builds(
    lambda shape, base, gain, up, ratio, steps, plan: design(
        schema="stepramp/2", timer__frequency_hz=1e9, move={"steps": steps, "plan": plan},
        ramp={
            "base_speed_steps_per_s": base, "slew_speed_steps_per_s": base + gain, "acceleration_steps_per_s2": up,
            "deceleration_steps_per_s2": up * ratio, "shape": shape,
        },
    ),
    shapes, st.sampled_from([0, 20, 300]), st.floats(50, 8000), st.floats(200, 1e5), st.sampled_from([1, 0.3, 2.5]),
    st.integers(1, 5000), st.sampled_from(["this_move", "any_move"]),
)  # fmt: skip


@given(moves)
def test_no_ramp_exceeds_its_speed_its_acceleration_or_its_jerk(asked: Design) -> None:
    assume(all(slope.length < 1e5 for slope in slopes_of(asked)))
    ramp, plan = asked.ramp, plan_of(asked)
    assert plan.intervals.size == asked.move.steps
    speeds = asked.timer.frequency_hz / plan.real_intervals
    assert speeds.max() <= ramp.slew_speed_steps_per_s * (1 + 1e-12)
    squares = np.concatenate(([ramp.base_speed_steps_per_s], speeds)) ** 2
    implied = np.diff(squares)[1:] / 2
    assert implied.max(initial=0) <= ramp.acceleration_steps_per_s2 * (1 + 1e-9)
    assert -implied.min(initial=0) <= ramp.slowdown_steps_per_s2 * (1 + 1e-9)
    if ramp.shape.name == "s_curve":
        for slope in slopes_of(asked):
            # From one step's centre to the next the mean acceleration grows by at most j times the time between them.
            fastest = slope.speeds(0, slope.steps + 1, np.float64)
            steepness = np.diff(fastest) / (slope.durations(np.float64) / slope.timer_hz)
            times = np.cumsum(slope.durations(np.float64)) / slope.timer_hz
            centres = times - np.diff(times, prepend=0) / 2
            growth = np.abs(np.diff(steepness)) / np.diff(centres)
            noise = 1e-9 * slope.acceleration / np.diff(centres)
            assert np.all(growth <= slope.parameters.jerk * (1 + 1e-6) + noise)


@given(moves, st.sampled_from([1e6, 16e6]))
def test_rounding_to_ticks_adds_no_more_than_half_a_tick_does(asked: Design, timer_hz: float) -> None:
    """Of a delay of c ticks: 1 in 2c to the speed, and that twice, of its square, to the acceleration."""
    assume(all(slope.length < 1e5 for slope in slopes_of(asked)))
    ramp = asked.ramp
    timer = asked.timer.model_copy(update={"frequency_hz": timer_hz, "min_delay_us": 1.0})
    ticks = plan_of(asked.model_copy(update={"timer": timer})).intervals
    speeds, part = timer_hz / ticks, 1 / (2 * ticks)
    assert np.all(speeds <= ramp.slew_speed_steps_per_s * (1 + part) * (1 + 1e-12))
    # Each square is within this of that of the plan: 1 / (1 ± part)² of it.
    off = speeds**2 * (1 / (1 - part) ** 2 - 1)
    implied, rounding = np.diff(speeds**2) / 2, (off[1:] + off[:-1]) / 2
    assert np.all(implied <= ramp.acceleration_steps_per_s2 * (1 + 1e-9) + rounding)
    assert np.all(-implied <= ramp.slowdown_steps_per_s2 * (1 + 1e-9) + rounding)


@given(moves)
def test_a_symmetric_ramp_comes_down_as_it_goes_up(asked: Design) -> None:
    same = asked.model_copy(update={"ramp": asked.ramp.model_copy(update={"deceleration_steps_per_s2": None})})
    assume(all(slope.length < 1e5 for slope in slopes_of(same)))
    real = real_ramp(same)
    assert np.array_equal(real.up, real.down)
    played = plan_of(same).intervals
    # Of an odd number of steps the one in the middle has no other.
    assert np.array_equal(played[: played.size // 2], played[::-1][: played.size // 2])


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("method", ["exact", "midpoint", "ideal", "newton"])
def test_every_shape_is_played_by_what_is_not_for_constant_acceleration_only(name: str, method: str) -> None:
    judged = error_curves(shaped(name, method), method, "ideal")
    # From rest the first interval of ideal is twice that of others, or more; behind it they are close.
    assert np.all(np.abs(judged.relative_error[10:-10]) < 0.06)
    assert judged.profile.intervals_ticks.size == 2000


@pytest.mark.parametrize("name", ["s_curve", "cosine", "drawn"])
def test_newton_in_float64_keeps_to_the_exact_ramp(name: str) -> None:
    judged = error_curves(
        shaped(name, "newton", method__arithmetic="float64", timer__frequency_hz=1e9), "newton", "exact"
    )
    assert np.all(np.abs(judged.relative_error[20:-20]) < 0.02)
    with pytest.raises(Rejected, match=rf"method\.arithmetic is 'fixed'; allowed: float32, float64 with .*'{name}'"):
        plan_of(shaped(name, "newton", method__arithmetic="fixed"))


@pytest.mark.parametrize("name", ["s_curve", "cosine", "drawn"])
def test_recurrences_of_constant_acceleration_are_refused_by_name(name: str) -> None:
    for method in ("first_order", "second_order", "compromise", "tuned", "austin"):
        with pytest.raises(Rejected) as caught:
            plan_of(shaped(name, method))
        [rejection] = caught.value.rejections
        assert (rejection.field, rejection.value) == ("method.name", method)
        assert rejection.allowed == f"exact, ideal, midpoint, newton, table with ramp.shape.name '{name}'"


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("steps", [1, 2, 3, 50, 199])
def test_short_moves_of_every_shape(name: str, steps: int) -> None:
    profile = profile_of(shaped(name, move__steps=steps))
    assert profile.intervals_ticks.size == steps
    assert [warning.field for warning in profile.warnings][:1] == ["move.steps"]
    if name in ("s_curve", "cosine"):
        up, down = slopes_of(shaped(name, move__steps=steps))
        assert up.length + down.length == pytest.approx(steps, rel=1e-9)
        # The peak is the speed in the middle, where the slew interval is played if at all.
        assert up.slew_speed == peak_of(shaped(name, move__steps=steps))
    else:
        assert peak_of(shaped(name, move__steps=steps)) is None


def test_the_kink_of_a_move_cut_out_of_a_longer_ramp_is_told() -> None:
    cut = shaped("s_curve", move={"steps": 100, "plan": "any_move"})
    [_, kink] = profile_of(cut).warnings
    assert kink.field == "move.plan"
    # The ramp of 150 steps to 1000 steps/s at 5000 steps/s² and 50,000 steps/s³: level from step 8.3 on.
    assert "jumps from 5,000 steps/s² to -5,000 steps/s²" in kink.message
    for smooth in (shaped("s_curve", move__steps=100), shaped("drawn", move={"steps": 100, "plan": "any_move"})):
        assert all(warning.field != "move.plan" for warning in profile_of(smooth).warnings)
    constant = shaped("constant", move={"steps": 100, "plan": "any_move"})
    assert list(plan_of(constant).intervals) == list(plan_of(shaped("constant", move__steps=100)).intervals)


@pytest.mark.parametrize("name", ["s_curve", "cosine"])
def test_a_ramp_of_less_than_a_step_says_so(name: str) -> None:
    tiny = shaped(name, ramp__slew_speed_steps_per_s=3, ramp__acceleration_steps_per_s2=100)
    [warning] = [each for each in profile_of(tiny).warnings if each.field == "ramp.acceleration_steps_per_s2"]
    assert warning.message.startswith("At 100 steps/s² the whole ramp would take less than one step: there is no ramp.")
    assert "slew speed of" not in warning.message


@pytest.mark.parametrize("name", ["s_curve", "cosine", "drawn"])
def test_a_table_is_fitted_to_every_shape(name: str) -> None:
    fitted = ramp_delays(shaped(name), "us", "ramp_index")
    up = real_ramp(shaped(name)).up
    assert fitted.longest[: up.size] == pytest.approx(up / 2)


@pytest.mark.parametrize("name", ["s_curve", "cosine", "drawn"])
def test_files_hold_every_shape(name: str) -> None:
    asked = shaped(name)
    rows = export(asked, "csv", Options()).content.decode().splitlines()[1:]
    assert [int(row.split(",")[1]) for row in rows] == list(plan_of(asked).intervals)
    header = export(asked, "c_segments", Options()).content.decode()
    assert f"steps/s^2;\n * {TOLD[name]}.\n" in header
    assert header.isascii()
    assert TOLD[name].split(",")[0] in export(asked, "html", Options()).content.decode()
    with pytest.raises(Rejected, match=rf"ramp\.shape\.name is '{name}'; allowed: constant, in code that computes"):
        export(asked, "c_newton", Options())


@pytest.mark.parametrize(
    ("ramp", "fields"),
    [
        # Slow enough to be too long, at any jerk: v² / 2a = 5 · 10⁷ steps.
        ({"acceleration_steps_per_s2": 100}, ["ramp.acceleration_steps_per_s2"]),
        # At any acceleration the ramp takes v · sqrt(v/j) = 3.2 · 10⁷ steps.
        ({"acceleration_steps_per_s2": 1e6, "jerk": 1.0}, ["ramp.shape.jerk_steps_per_s3"]),
        ({"acceleration_steps_per_s2": 100, "jerk": 1.0},
         ["ramp.shape.jerk_steps_per_s3", "ramp.acceleration_steps_per_s2"]),
    ],
)  # fmt: skip
def test_a_ramp_that_is_too_long_names_what_would_make_it_shorter(ramp: dict[str, float], fields: list[str]) -> None:
    asked = document(
        schema="stepramp/2", ramp__slew_speed_steps_per_s=100_000, move__plan="any_move",
        ramp__acceleration_steps_per_s2=ramp["acceleration_steps_per_s2"],
        ramp__shape={"name": "s_curve", "jerk_steps_per_s3": ramp.get("jerk", 1e6)},
    )  # fmt: skip
    with pytest.raises(Rejected) as caught:
        playable_slopes_of(Design.checked(asked))
    assert [each.field for each in caught.value.rejections] == fields
    # What is told makes it short enough.
    for rejection in caught.value.rejections:
        limits, (*_, name) = rejection.limits, rejection.field.split(".")
        assert limits is not None
        (asked["ramp"]["shape"] if "jerk" in name else asked["ramp"])[name] = limits.lowest
    assert max(slope.length for slope in playable_slopes_of(Design.checked(asked))) == pytest.approx(1e7, rel=1e-4)


WRONG = [
    ({"name": "s_curve"}, "ramp.shape.jerk_steps_per_s3", "a jerk [steps/s³], since ramp.shape.name is 's_curve'"),
    ({"name": "drawn"}, "ramp.shape.points", "a list of points, since ramp.shape.name is 'drawn'"),
    ({"name": "cosine", "jerk_steps_per_s3": 5}, "ramp.shape.jerk_steps_per_s3",
     "none with ramp.shape.name 'cosine', it is of 's_curve'"),
    ({"name": "s_curve", "jerk_steps_per_s3": 0}, "ramp.shape.jerk_steps_per_s3",
     "a number from 0.001 to 1,000,000,000,000,000 steps/s³"),
    ({"name": "drawn", "points": [[0, 1]]}, "ramp.shape.points", "a list of 2 to 200 points"),
    ({"name": "drawn", "points": [[0, 1], [0, 0.5]]}, "ramp.shape.points.1.0",
     "more than 0 steps/s, the speed of the point before"),
    ({"name": "drawn", "points": [[0, 1], [5, 1.5]]}, "ramp.shape.points.1.1",
     "a number from 0.001 to 1 of the acceleration"),
    ({"name": "trapezoid"}, "ramp.shape.name", "constant, s_curve, cosine, drawn, torque"),
]  # fmt: skip


@pytest.mark.parametrize(("shape", "field", "allowed"), WRONG)
def test_a_wrong_shape_is_refused_at_its_field(shape: dict[str, Any], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        design(schema="stepramp/2", ramp__shape=shape)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.allowed) == (field, allowed)


def test_documents_of_version_1_stay_as_they_are_and_have_nothing_newer() -> None:
    old = document()
    assert Design.checked(old).model_dump(mode="json", by_alias=True)["schema"] == "stepramp/1"
    assert "plan" not in Design.checked(old).model_dump(mode="json")["move"]
    with pytest.raises(Rejected, match=r"schema is 'stepramp/1'; allowed: stepramp/2 for a design with ramp\.shape"):
        design(ramp__shape=SHAPES["cosine"])
    with pytest.raises(Rejected, match=r"stepramp/2 for a design with move\.plan"):
        design(move__plan="any_move")
    kept = shaped("drawn", move={"steps": 5, "plan": "any_move"})
    assert Design.checked(kept.model_dump(mode="json", by_alias=True)) == kept


@pytest.mark.parametrize("name", ["s_curve", "cosine"])
@pytest.mark.parametrize("acceleration", [600.0, 1000.0, 2000.0, 4000.0, 5000.0, 7000.0])
def test_short_moves_by_themselves_lose_no_step_to_rounding(name: str, acceleration: float) -> None:
    """Sides that are whole to the last bits: of two steps each takes one, and none is quicker than from rest."""
    first = profile_of(shaped(name, "ideal", ramp__acceleration_steps_per_s2=acceleration, move__steps=20_000))
    for steps in (2, 4, 6, 20):
        short = profile_of(shaped(name, "ideal", ramp__acceleration_steps_per_s2=acceleration, move__steps=steps))
        assert short.plan.sides == (steps // 2, steps // 2)
        assert short.intervals_ticks[0] >= first.intervals_ticks[0] - 1


def test_newton_is_no_faster_than_the_ramp_it_follows() -> None:
    shape = {"name": "s_curve", "jerk_steps_per_s3": 4e8}
    ramp = {"base_speed_steps_per_s": 400.0, "slew_speed_steps_per_s": 3000.0, "acceleration_steps_per_s2": 1e6}
    given = design(schema="stepramp/2", method__name="newton", ramp=ramp | {"shape": shape}, move__steps=1000)
    assert profile_of(given).intervals_ticks.min() == round(2e6 / 3000)


def test_a_method_that_comes_beyond_the_slew_speed_is_warned_of() -> None:
    # From rest the second interval of newton is half of the first: sqrt(2 a) = 63.2, so 126.5 steps/s.
    given = design(method__name="newton", ramp__slew_speed_steps_per_s=120.0, ramp__acceleration_steps_per_s2=2000.0)
    [message] = [each.message for each in profile_of(given).warnings if each.field == "method.name"]
    assert "Step 2 runs at 126.491 steps/s, beyond the ramp's highest speed of 120 steps/s" in message
    assert not [each for each in profile_of(given.with_method("exact")).warnings if each.field == "method.name"]
