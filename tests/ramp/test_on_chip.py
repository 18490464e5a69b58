import itertools
import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from designs import design
from ramp.test_fixed_point import State, exponential, interval, length, newton_step, taylor_step
from stepramp.design import Design
from stepramp.methods.common.fixed_point import FixedIntervals, Format, Scaled
from stepramp.methods.common.taylor import fixed_taylor_down, fixed_taylor_up
from stepramp.methods.newton import fixed_newton_down, fixed_newton_up
from stepramp.ramp.on_chip import (
    Factor,
    MotorState,
    OnChipMotor,
    OnChipRamp,
    OnChipSide,
    design_refusal,
    on_chip_ramp,
    slopes_refusal,
)
from stepramp.ramp.plan import plan_of
from stepramp.shapes.constant import ConstantAcceleration as Slope

COEFFICIENTS = {"first_order": 0.0, "compromise": 1.0}
METHODS: tuple[str, ...] = ("first_order", "compromise", "newton")
GRID = [
    (Slope(timer, base, slew, up), Slope(timer, base, slew, down))
    for timer, base, slew, up, down in itertools.product(
        [2e6, 16e6], [0.0, 0.3, 70.0], [0.5, 345.6, 5001.0, 150_000.0], [1.0, 4000.0, 1e6], [1.0, 4000.0, 7777.0, 1e6]
    )
    if slew > base
]


def possible(method: str, most_steps: int) -> list[tuple[Slope, Slope]]:
    """Return the slopes of the grid that can be computed and are so short."""
    found = [sides for sides in GRID if max(side.length for side in sides) < most_steps]
    return [sides for sides in found if slopes_refusal(*sides, method) is None]


def slopes(timer_hz: float, slew: float, base_part: float, index: float, ratio: float) -> tuple[Slope, Slope]:
    """Return slopes by v² / 2 a of the slew speed and d / a."""
    base, acceleration = slew * base_part, slew**2 / 2 / index
    return Slope(timer_hz, base, slew, acceleration), Slope(timer_hz, base, slew, acceleration * ratio)


both_slopes = st.builds(
    slopes,
    st.sampled_from([2e6, 16e6]),
    exponential(0.5, 150_000),
    st.just(0.0) | st.floats(0.001, 0.95),
    exponential(1.1, 3000),
    st.just(1.0) | exponential(0.01, 100),
)
methods = st.sampled_from(METHODS)


def nearest(x: State, form: Format) -> int:
    """The interval of x in whole ticks, halves up."""
    multiplier, bits = form.outputs[x.exponent]
    return math.floor(Fraction(interval(x, multiplier), 2**bits) + Fraction(1, 2))


def stepped(x: State, method: str, up: bool, index: int, form: Format) -> State:
    if method == "newton":
        return newton_step(x, index)
    return taylor_step(x, round(COEFFICIENTS[method] * 2**16), up, form)


@pytest.mark.parametrize("method", METHODS)
def test_a_move_of_full_length_is_that_of_the_plan(method: str) -> None:
    documents = [
        design(
            method__name=method,
            method__arithmetic="fixed",
            ramp__base_speed_steps_per_s=base,
            ramp__acceleration_steps_per_s2=up,
            ramp__deceleration_steps_per_s2=down,
            move__steps=steps,
        )
        for base, up, down, steps in itertools.product([0, 70], [5000, 777.7], [None, 1234], [1500, 2000])
    ]
    for document in documents:
        np.testing.assert_array_equal(on_chip_ramp(document).move(document.move.steps), plan_of(document).intervals)


@pytest.mark.parametrize("method", METHODS)
def test_both_sides_of_a_full_move_are_those_of_the_fixed_format(method: str) -> None:
    for up, down in possible(method, 20_000):
        if method == "newton":
            sides = fixed_newton_up(up), fixed_newton_down(down)
        else:
            sides = fixed_taylor_up(up, COEFFICIENTS[method]), fixed_taylor_down(down, COEFFICIENTS[method])
        slew = np.floor(up.slew_interval + 0.5)
        rounded = [np.maximum(np.floor(side.ticks + 0.5), slew) for side in sides]
        # What would be shorter than pS is the slew interval itself, not that of an x of pS.
        rounded[0][at_shortest(sides[0], Format.of(up))] = slew
        ramp = OnChipRamp.of(up, down, method)
        rounded = [np.minimum(r, side.longest_interval) for r, side in zip(rounded, (ramp.up, ramp.down), strict=True)]
        expected = np.concatenate((rounded[0], np.full(3, slew), rounded[1][::-1]))
        np.testing.assert_array_equal(ramp.move(up.steps + down.steps + 3), expected)


def at_shortest(side: FixedIntervals, form: Format) -> NDArray[np.bool_]:
    return (side.mantissas == form.shortest.mantissa) & (side.exponents == form.shortest.exponent)


@given(both_slopes, methods, st.floats(0, 1))
@example((Slope(2e6, 0.0, 1.0, 0.3032653298563167), Slope(2e6, 0.0, 1.0, 0.11156508007421492)), "first_order", 1.0)
@example((Slope(2e6, 0.0, 1.0, 0.0410424993119494), Slope(2e6, 0.0, 1.0, 0.0009652270681138547)), "newton", 0.1875)
def test_a_short_move_rises_as_far_as_it_can_holds_and_falls(
    sides: tuple[Slope, Slope], method: str, part: float
) -> None:
    assume(slopes_refusal(*sides, method) is None)
    n_up, n_down = (side.steps for side in sides)
    ramp = OnChipRamp.of(*sides, method)
    ratio = sides[1].acceleration / sides[0].acceleration
    steps = 1 + int(part * (n_up + n_down - 2))

    move = ramp.move(steps)

    assert move.size == steps
    motor = OnChipMotor(ramp)
    u = motor.fitting(steps, steps)
    if u == 0:
        # A single step up may be all of the ramp up.
        assert 1 + (n_down if n_up == 1 else steps_down_by_hand(1, sides)) > steps
        assert set(move) == {max(nearest(State(*side.form.longest), side.form) for side in (ramp.up, ramp.down))}
        return
    up, down = ramp.up.form, ramp.down.form
    xs = [State(*up.longest)]
    for i in range(1, u):
        xs.append(stepped(xs[-1], method, True, up.first_ramp_index + i * 2**24, wide_open(up)))
    assert move[:u].tolist() == [limited(x, ramp, ramp.up) for x in xs]
    motor.up(u)
    m = motor.steps_down
    assert m == pytest.approx(n_down if u == n_up else min(steps_down_by_hand(u, sides), n_down), abs=ratio != 1)
    assert u + m <= steps
    assert u == n_up or motor.fitting(steps - u, 1) == 0
    if u == n_up:
        return
    assert set(move[u : steps - m + 1]) <= {move[u - 1]}
    # The ramp down: from the same speed, if that is one of its own.
    ramp_down = [carried_by_hand(State(*ramp.up.clamped(Scaled(*xs[-1]))), math.sqrt(ratio), down)]
    for left in range(m - 2, -1, -1):
        ramp_down.append(stepped(ramp_down[-1], method, False, down.first_ramp_index + left * 2**24, wide_open(down)))
    expected = [limited(x, ramp, ramp.down) for x in ramp_down]
    np.testing.assert_allclose(move[steps - m + 1 :], expected[1:], rtol=1e-4, atol=2)


def steps_down_by_hand(u: int, sides: tuple[Slope, Slope]) -> int:
    return max(math.ceil(u * sides[0].acceleration / sides[1].acceleration - 1 / 512), 1)


def wide_open(form: Format) -> Format:
    """The same without an end for small x."""
    return replace(form, shortest=Scaled(15 << 24, 3))


def limited(x: State, ramp: OnChipRamp, side: OnChipSide) -> int:
    """The interval of x, within those of the ramp."""
    return min(max(nearest(x, side.form), ramp.slew_interval), nearest(State(*side.form.longest), side.form))


def carried_by_hand(x: State, ratio: float, form: Format) -> State:
    if ratio == 1:
        return x
    ends = (math.ldexp(length(State(*end)), -32) for end in (form.shortest, form.longest))
    shortest, longest = ends
    wanted = min(max(math.ldexp(length(x), -32) * ratio, shortest), longest)
    return State(*Scaled.of(wanted))


@given(exponential(1e-6, 1e6), exponential(1e-4, 0.7))
def test_a_factor_multiplies_to_a_part_in_2_to_the_27(ratio: float, x: float) -> None:
    factor = Factor.of(ratio)
    assert 2**28 <= factor.mantissa < 2**32
    product = factor.times(Scaled.of(x))
    assert 15 * 2**24 <= product.mantissa <= 240 * 2**24
    assert math.ldexp(product.mantissa, -32 - 4 * product.exponent) == pytest.approx(x * ratio, rel=2**-27)


commands = st.lists(st.tuples(st.sampled_from(["up", "down", "fit"]), st.integers(1, 40)), max_size=40)


@given(both_slopes, methods, commands)
@settings(max_examples=300)
def test_any_way_comes_to_rest_with_intervals_within_the_ramp(
    sides: tuple[Slope, Slope], method: str, given_commands: list[tuple[str, int]]
) -> None:
    assume(slopes_refusal(*sides, method) is None)
    ramp = OnChipRamp.of(*sides, method)
    motor = OnChipMotor(ramp)
    played: list[int] = []
    for command, count in given_commands:
        if command == "fit":
            room = motor.steps_down + count
            fitting = motor.fitting(room, 1000)
            played += motor.up(fitting).tolist()
            assert motor.steps_down <= room - fitting
            assert motor.slews or motor.fitting(room - fitting, 1) == 0
        else:
            before = motor.steps_down
            found = motor.up(count) if command == "up" else motor.down(count)
            played += found.tolist()
            assert command == "up" or motor.steps_down <= max(before - found.size, 0)
        assert motor.steps_up <= ramp.up.steps
        assert motor.steps_down <= ramp.down.steps
    ramp_down = motor.down(motor.steps_down + 1)
    assert motor.state is MotorState.REST
    assert ramp_down.size <= ramp.down.steps
    played += ramp_down.tolist()
    if played:
        slowest = max(side.ticks(side.form.longest) for side in (ramp.up, ramp.down))
        assert max(played) <= slowest
        assert min(played) >= min(ramp.slew_interval, ramp.up.longest_interval, ramp.down.longest_interval)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ratio", [0.03, 0.4, 1.0, 2.5, 30.0])
def test_turning_again_and_again_leaves_no_trace(method: str, ratio: float) -> None:
    motor = OnChipMotor(OnChipRamp.of(*slopes(2e6, 2000, 0, 900, ratio), method))
    motor.up(400)
    position = motor.steps_up, motor.steps_down
    speed = motor.hold_interval
    for _ in range(100):
        assert motor.down(1).tolist() == [speed]
        assert motor.up(1).tolist() == [speed]
        assert (motor.steps_up, motor.steps_down) == pytest.approx(position, abs=1 if ratio > 20 else 0)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ratio", [0.2, 1.0, 3.0])
def test_a_second_ramp_up_is_like_the_first(method: str, ratio: float) -> None:
    up, down = slopes(2e6, 2000, 0, 900, ratio)
    straight = OnChipMotor(OnChipRamp.of(up, down, method)).up(900)
    motor = OnChipMotor(OnChipRamp.of(up, down, method))
    motor.up(800)
    motor.down(motor.steps_down // 2)
    reached = motor.steps_up
    again = motor.up(1000)[5:]
    # One place off, and what the two formulas lose on the ramp down.
    np.testing.assert_allclose(again, straight[-again.size :], rtol=0.02)
    assert abs(straight.size - reached - again.size - 5) < 2 + 1 / ratio


def test_a_ramp_down_from_the_top_begins_with_ps() -> None:
    up, down = slopes(2e6, 1000, 0, 90.5, 1)
    motor = OnChipMotor(OnChipRamp.of(up, down, "first_order"))
    assert motor.up(1000).size == 90
    assert motor.slews
    assert motor.hold_interval == 2000
    assert motor.up(1).size == 0
    assert motor.steps_down == 90
    np.testing.assert_array_equal(motor.down(99), np.floor(fixed_taylor_down(down, 0).ticks[::-1] + 0.5))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (
            {"method__name": "second_order"},
            "The method is second_order; a controller computes first_order, compromise or newton.",
        ),
        ({"method__arithmetic": "float32"}, "The arithmetic is float32; a controller computes in fixed."),
        ({"method__rounding": "carry"}, "The rounding is carry; a controller rounds to the nearest tick."),
        (
            {"ramp__acceleration_steps_per_s2": 1e6},
            "The acceleration takes 0 and the deceleration 100 steps; computed on the controller both must take at "
            "least 1: such a ramp is better stored.",
        ),
        ({"ramp__deceleration_steps_per_s2": 1.5}, "The deceleration takes 333,333 steps; in fixed arithmetic"),
        (
            {"ramp__acceleration_steps_per_s2": 1e6 / 2 / 16_777_215, "method__name": "newton"},
            "The slew speed is 16,777,215 steps away from rest; computed on the controller it must be at most",
        ),
    ],
)
def test_a_design_that_a_controller_cannot_compute_is_refused_with_the_reason(
    changes: dict[str, object], reason: str
) -> None:
    refused = fixed(**changes)
    assert str(design_refusal(refused)).startswith(reason)
    with pytest.raises(ValueError, match=reason[:20]):
        on_chip_ramp(refused)


def fixed(**changes: object) -> Design:
    usual: dict[str, object] = {"method__name": "compromise", "method__arithmetic": "fixed"}
    return design(**{**usual, "ramp__deceleration_steps_per_s2": 5000, **changes})


def test_a_design_that_a_controller_can_compute_is_not_refused() -> None:
    for method in METHODS:
        assert design_refusal(fixed(method__name=method)) is None
