import itertools
import math
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from stepramp.methods.common.fixed_point import MOST_INTERVAL_TICKS, MOST_RAMP_INDEX, FixedIntervals, Format, refusal
from stepramp.methods.common.taylor import (
    MOST_TAYLOR_DECELERATION,
    fixed_taylor_down,
    fixed_taylor_up,
    taylor_deceleration_refusal,
    taylor_down,
    taylor_up,
)
from stepramp.methods.newton import fixed_newton_down, fixed_newton_up, newton_down, newton_up
from stepramp.shapes.constant import ConstantAcceleration as Slope
from tools import require

COEFFICIENTS = {"first_order": 0.0, "second_order": 1.5, "compromise": 1.0}


class Run(NamedTuple):
    """One side of a slope by one method; by newton where there is no coefficient."""

    slope: Slope
    coefficient: float | None
    up: bool

    def fixed(self) -> FixedIntervals:
        if self.coefficient is None:
            return fixed_newton_up(self.slope) if self.up else fixed_newton_down(self.slope)
        return (fixed_taylor_up if self.up else fixed_taylor_down)(self.slope, self.coefficient)

    def float64(self) -> NDArray[np.floating]:
        if self.coefficient is None:
            return (newton_up if self.up else newton_down)(self.slope, np.float64)
        return (taylor_up if self.up else taylor_down)(self.slope, self.coefficient, np.float64)


class State(NamedTuple):
    mantissa: int
    exponent: int


def within(value: int, bits: int) -> int:
    assert 0 <= value < 2**bits
    return value


# The same arithmetic in Python's unbounded integers, with the width of every intermediate result asserted.


def normal(mantissa: int, exponent: int) -> State:
    if mantissa < 15 * 2**24:
        mantissa, exponent = mantissa * 16, exponent + 1
    elif mantissa >= 240 * 2**24 and exponent > 0:
        mantissa, exponent = mantissa // 16, exponent - 1
    return State(mantissa, exponent)


def length(x: State) -> float:
    """x exactly: a mantissa of 32 bits and a power of 2 fit in a double."""
    return math.ldexp(x.mantissa, -4 * x.exponent)


def taylor_step(x: State, c: int, up: bool, form: Format) -> State:
    high = within(x.mantissa // 2**16, 16)
    low = x.mantissa // 2**8 % 256
    q = within((within(high * high + 128, 32)) // 256, 24)
    upper = within(256 * high + 3 * (low | 1), 24)
    square = within(q // 256 * (q // 256 + 1), 32)
    c2, c1, c0 = c // 2**16, c // 2**8 % 256, c % 256
    shift = 2 ** (8 + 8 * x.exponent)
    second = within(c2 * square + c1 * (square // 2**8) + c0 * (square // 2**16) + shift // 2, 40) // shift
    # Not limited to 24 bits as in the code: the clamps below must give the same.
    factor = q - second if up else q + second
    product = upper // 256 * factor + upper % 256 * (factor // 256) + shift // 2
    if 0 <= factor < 2**24:
        within(product, 40)
    change = product // shift
    x = normal(within(x.mantissa - change if up else x.mantissa + change, 34), x.exponent)
    if length(x) < length(State(*form.shortest)):
        x = State(*form.shortest)
    if length(x) > length(State(*form.longest)):
        x = State(*form.longest)
    return x


def newton_step(x: State, k: int) -> State:
    rounded = within((x.mantissa + 2**15) // 2**16, 16)
    square = within(rounded * rounded, 32)
    scaled = within(within(k, 56) // 256**x.exponent, 32)
    k3, k2, k1, k0 = (scaled // 256**place % 256 for place in (3, 2, 1, 0))
    product = within(k3 * square + k2 * (square // 2**8) + k1 * (square // 2**16) + k0 * (square // 2**24), 33)
    error = 2**31 - product
    change = within(rounded * within(abs(error) // 256, 24), 40) // 256
    sign = 1 if error > 0 else -1
    # A short move may turn down from an x that is far too small for there: then x grows by up to a half.
    return normal(within(rounded * 2**16 + sign * change, 33), x.exponent)


def states(run: Run) -> Iterator[State]:
    """Yield the states of a run in order of time; upwards, the first is p1 itself."""
    form, steps = Format.of(run.slope), run.slope.steps
    x = State(*(form.longest if run.up else form.shortest))
    k = form.first_ramp_index + (0 if run.up else steps * 2**24)
    if run.up:
        yield x
    for _ in range(steps - run.up):
        if run.coefficient is None:
            k += 2**24 if run.up else -(2**24)
            x = newton_step(x, k)
        else:
            x = taylor_step(x, round(run.coefficient * 2**16), run.up, form)
        yield x


def interval(x: State, multiplier: int) -> int:
    high = within(x.mantissa // 2**16 * multiplier, 40) // 256
    rounded = within((multiplier + 2**15) // 2**16, 8)
    return within(high + x.mantissa // 2**8 % 256 * rounded, 32)


def slope_from_index(timer_hz: float, acceleration: float, index: float, steps: float) -> Slope:
    """Return a slope that begins so many steps from rest and is so many steps long."""
    return Slope(
        timer_hz, math.sqrt(2 * acceleration * index), math.sqrt(2 * acceleration * (index + steps)), acceleration
    )


def exponential(least: float, most: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(least), math.log(most)).map(math.exp)


slopes = st.builds(
    slope_from_index,
    timer_hz=exponential(1e4, 1e8),
    acceleration=exponential(1, 1e7),
    index=st.just(0.0) | exponential(1e-3, MOST_RAMP_INDEX),
    steps=st.floats(1, 400),
)


@given(slopes, st.none() | st.sampled_from([0.0, 1.0, 1.5, 4.0]) | st.floats(0, 4), st.booleans())
def test_every_step_is_that_of_unbounded_integers_and_none_outgrows_its_width(
    slope: Slope, coefficient: float | None, up: bool
) -> None:
    assume(slope.steps >= 1 and refusal(slope) is None)
    run = Run(slope, coefficient, up)
    expected = list(states(run))[:: 1 if up else -1]
    outputs = Format.of(slope).outputs

    fixed = run.fixed()

    assert list(zip(fixed.mantissas.tolist(), fixed.exponents.tolist(), strict=True)) == expected
    assert fixed.intervals.tolist() == [interval(x, outputs[x.exponent].multiplier) for x in expected]
    assert fixed.fraction_bits.tolist() == [outputs[x.exponent].fraction_bits for x in expected]
    assert fixed.ticks.tolist() == (fixed.intervals / 2.0**fixed.fraction_bits).tolist()


@given(slopes)
def test_a_format_holds_p1_and_ps_to_a_part_in_2_to_the_28(slope: Slope) -> None:
    assume(slope.steps >= 1 and refusal(slope) is None)
    form = Format.of(slope)
    for scaled, ticks in ((form.longest, slope.initial_interval), (form.shortest, slope.slew_interval)):
        assert 15 * 2**24 <= scaled.mantissa < 240 * 2**24
        x = math.ldexp(length(State(*scaled)), -32)
        assert x * slope.timer_hz / math.sqrt(slope.acceleration) == pytest.approx(ticks, rel=2**-28)
        output = form.outputs[scaled.exponent]
        assert 2**16 - 2**7 <= output.multiplier < 2**24 - 2**15
        assert output.fraction_bits in (0, 8, 16, 24)


@pytest.fixture(scope="session")
def c_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*([] if shutil.which("gcc") else ["gcc"]))
    program = tmp_path_factory.mktemp("c") / "fixed_point"
    source = Path(__file__).with_name("fixed_point.c")
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-fsanitize=undefined", "-fno-sanitize-recover"]
    subprocess.run(["gcc", *flags, "-o", str(program), str(source)], check=True)
    return program


def line_for_c(run: Run) -> str:
    form, newton = Format.of(run.slope), run.coefficient is None
    start = form.longest if run.up else form.shortest
    index = form.first_ramp_index + (0 if run.up else run.slope.steps * 2**24)
    words = ["newton" if newton else "taylor", int(run.up), *start, run.slope.steps - run.up]
    words += [index if newton else round(run.coefficient * 2**16), *form.longest, *form.shortest]
    return " ".join(map(str, words + [output.multiplier for output in form.outputs]))


def grid() -> list[Run]:
    numbers = itertools.product(
        [10_000.0, 2e6, 16e6, 1e8], [1.0, 77.7, 4000.0, 1e7], [0.0, 0.5, 30.0, 5000.0], [2.0, 345.6, 5001.0, 2e5]
    )
    found = [Slope(timer, base, slew, a) for timer, a, base, slew in numbers if slew > base]
    fit = [slope for slope in found if 1 <= slope.steps <= 60_000 and refusal(slope) is None]
    assert len(fit) > 80
    return [Run(slope, c, up) for slope in fit for c in (0.0, 1.0, 1.5, 2 / 3, 4.0, None) for up in (True, False)]


def test_a_c_compiler_gives_the_same_bits(c_program: Path) -> None:
    runs = grid()
    lines = "\n".join(map(line_for_c, runs)).encode()
    printed = subprocess.run([c_program], input=lines, check=True, capture_output=True).stdout
    from_c = np.frombuffer(printed, dtype=np.uint32).reshape(-1, 3)
    at = 0
    for run in runs:
        fixed = run.fixed()
        computed = np.stack((fixed.mantissas, fixed.exponents, fixed.intervals), axis=1)[:: 1 if run.up else -1]
        computed = computed[int(run.up) :]
        np.testing.assert_array_equal(from_c[at : at + len(computed)], computed, err_msg=str(run))
        at += len(computed)
    assert at == len(from_c)


def usual_slopes(count: int) -> list[Slope]:
    """Return ramps as steppers have them: of 10 to 10,000 steps, timed by a counter of 16 bits."""
    random = np.random.default_rng(7)

    def draw(least: float, most: float) -> float:
        return math.exp(random.uniform(math.log(least), math.log(most)))

    found: list[Slope] = []
    while len(found) < count:
        slew = draw(100, 50_000)
        base = 0.0 if random.random() < 0.5 else draw(1, slew)
        slope = Slope(draw(2.5e5, 2e7), base, slew, draw(100, 1e6))
        if 10 <= slope.steps <= 10_000 and slope.initial_interval < 2**16 and slope.slew_interval >= 20:
            found.append(slope)
    return found


def error_ticks(run: Run) -> float:
    return float(np.abs(run.fixed().ticks - run.float64()).max())


def relative_error(run: Run) -> float:
    """Return the largest error against float64 beyond one tick, as a part of the interval."""
    expected = run.float64()
    return float((np.maximum(np.abs(run.fixed().ticks - expected) - 1, 0) / expected).max())


def test_usual_ramps_are_those_of_float64_to_about_a_tick() -> None:
    for slope in usual_slopes(500):
        for coefficient in (0.0, 1.0, None):
            assert error_ticks(Run(slope, coefficient, True)) < 1.5
        assert error_ticks(Run(slope, 1.5, True)) < 2.5
        assert error_ticks(Run(slope, None, False)) < 1.5


def test_usual_taylor_decelerations_are_those_of_float64_to_a_thousandth() -> None:
    for slope, coefficient in itertools.product(usual_slopes(500), COEFFICIENTS.values()):
        assert relative_error(Run(slope, coefficient, False)) < 1e-3


@given(slopes, st.none() | st.sampled_from(list(COEFFICIENTS.values())))
def test_all_accelerations_are_those_of_float64_to_a_tick_and_a_part_in_5_000(
    slope: Slope, coefficient: float | None
) -> None:
    assume(slope.steps >= 1 and refusal(slope) is None)
    assert relative_error(Run(slope, coefficient, True)) < 2e-4


@pytest.mark.parametrize("coefficient", [*COEFFICIENTS.values(), None])
@pytest.mark.parametrize(("index", "steps"), [(0, MOST_RAMP_INDEX - 2), (9.4e6, 1e6), (1.6e7, 7e5)])
def test_the_longest_accelerations_do_not_stall(index: float, steps: float, coefficient: float | None) -> None:
    assert relative_error(Run(slope_from_index(1e8, 1, index, steps), coefficient, True)) < 2e-4


@pytest.mark.parametrize("coefficient", COEFFICIENTS.values())
def test_the_longest_taylor_deceleration_is_that_of_float64_to_a_hundredth(coefficient: float) -> None:
    slope = slope_from_index(1e7, 10, 0, MOST_TAYLOR_DECELERATION)
    assert relative_error(Run(slope, coefficient, False)) < 0.01


def test_a_slope_beyond_the_format_is_refused_with_what_is_allowed() -> None:
    too_fast = Slope(10_000, 0, 10_001, 1e6)
    too_slow = Slope(1e9, 0, 100, 1)
    too_gentle = Slope(1e8, 0, 5800, 1)
    assert refusal(too_fast) == (
        "The slew interval is 0.9999 ticks; in fixed arithmetic it must be at least 1, which is 10,000 steps/s with "
        "this timer."
    )
    assert "707,106,781 ticks" in str(refusal(too_slow))
    assert f"at most {MOST_INTERVAL_TICKS:,}" in str(refusal(too_slow))
    assert "16,820,000 steps away from rest" in str(refusal(too_gentle))
    # 5,800² / 2 / 2²⁴ = 1.0025501: what is told is rounded up, so that it is allowed.
    assert "at least 1.00256 steps/s²" in str(refusal(too_gentle))
    assert refusal(Slope(1e8, 0, 5800, 1.00256)) is None
    for slope in (too_fast, too_slow, too_gentle):
        for run in (Run(slope, c, up) for c in (1.0, None) for up in (True, False)):
            with pytest.raises(ValueError, match="in fixed arithmetic"):
                run.fixed()


@pytest.mark.parametrize(
    "slope",
    [
        Slope(10_000, 0, 10_000, 1e6),
        Slope(MOST_INTERVAL_TICKS * math.sqrt(2), 0, 100, 1),
        Slope(1e8, 0, math.sqrt(2 * MOST_RAMP_INDEX - 1), 1),
        Slope(1e8, 0.5, 200_000, 1e7),
        Slope(10_000, 0, 5000, 1e7),
    ],
    ids=str,
)
def test_a_slope_at_the_limit_is_computed(slope: Slope) -> None:
    assert refusal(slope) is None
    assert Run(slope, 1.0, True).fixed().ticks.size == slope.steps
    assert Run(slope, None, False).fixed().ticks.size == slope.steps


def test_only_a_taylor_deceleration_is_limited_in_length() -> None:
    slope = slope_from_index(1e7, 10, 0, MOST_TAYLOR_DECELERATION + 1.5)
    assert refusal(slope) is None
    assert "262,145 steps" in str(taylor_deceleration_refusal(slope))
    with pytest.raises(ValueError, match="within 262,144"):
        fixed_taylor_down(slope, 0)
    assert fixed_newton_down(slope).ticks.size == slope.steps


@pytest.mark.parametrize("coefficient", [-0.001, 4.001, math.nan])
def test_a_coefficient_beyond_its_range_is_refused(coefficient: float) -> None:
    with pytest.raises(ValueError, match="allowed: 0 to 4"):
        fixed_taylor_up(Slope(1e6, 0, 2000, 4000), coefficient)


def test_a_ramp_without_steps_has_no_intervals() -> None:
    slope = Slope(1e6, 100, 100, 4000)
    assert refusal(slope) is None
    for run in (Run(slope, c, up) for c in (1.0, None) for up in (True, False)):
        assert run.fixed().ticks.size == 0
