import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from stepramp.methods import METHODS
from stepramp.methods.austin import austin_up
from stepramp.methods.common.method import Sides
from stepramp.methods.exact import exact_intervals
from stepramp.numerics.numbers import Arithmetic
from stepramp.shapes.constant import ConstantAcceleration as Slope
from tools import require

SLOPES = [
    Slope(1_000_000, 100, 2000, 4000),
    Slope(2_000_000, 0, 1000, 5000),
    Slope(2_000_000, 0, 2000, 4000),
    Slope(16_000_000, 3.7, 33_333.3, 12_345.6),
    Slope(100_000_000, 0.5, 50_000, 1e6),
    Slope(10_000, 10, 400, 100),
    Slope(1_000_000, 0, 150_000, 1e7),
]
FROM_REST = Slope(1e6, 0, 2000, 4000)
TAYLOR = ("first_order", "second_order", "compromise")


def sides_of(method: str, arithmetic: Arithmetic = "float64") -> Sides:
    """Return the sides of a method that computes its ramp."""
    sides = METHODS[method].sides
    assert sides is not None
    return sides(arithmetic, "largest_error")


@pytest.fixture(scope="session")
def c_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*([] if shutil.which("gcc") else ["gcc"]))
    program = tmp_path_factory.mktemp("c") / "recurrences"
    source = Path(__file__).with_name("recurrences.c")
    flags = ["-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    subprocess.run(["gcc", *flags, "-o", str(program), str(source), "-lm"], check=True)
    return program


@pytest.mark.parametrize("method", [*TAYLOR, "newton"])
@pytest.mark.parametrize("slope", SLOPES, ids=str)
def test_float32_is_what_a_c_compiler_gives_bit_for_bit(c_program: Path, slope: Slope, method: str) -> None:
    numbers = (slope.timer_hz, slope.base_speed, slope.slew_speed, slope.acceleration)
    words = [method, *map(repr, map(float, numbers)), str(slope.steps)]
    printed = subprocess.run([c_program, *words], check=True, capture_output=True, text=True).stdout.split()
    expected = np.array([int(word, 16) for word in printed], dtype=np.uint32)

    sides = sides_of(method, "float32")
    up, down = sides.up(slope), sides.down(slope)

    assert up.dtype == down.dtype == np.float32
    np.testing.assert_array_equal(np.concatenate((up, down[::-1])).view(np.uint32), expected)


@pytest.mark.parametrize(
    ("method", "ratio"),
    [("first_order", 0.5), ("second_order", 0.875), ("compromise", 0.75), ("newton", 0.5), ("exact", 0.5**0.5)],
)
def test_ratio_of_the_first_two_intervals_from_rest(method: str, ratio: float) -> None:
    up = sides_of(method).up(FROM_REST)
    assert up[1] / up[0] == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize(("method", "percent"), [("first_order", 29), ("second_order", 27), ("compromise", 6)])
def test_largest_error_of_an_acceleration_from_rest(method: str, percent: int) -> None:
    error = sides_of(method).up(FROM_REST) / exact_intervals(FROM_REST, np.float64) - 1
    assert round(float(np.abs(error).max()) * 100) == percent


def test_newton_corrects_itself_where_the_others_go_on_erring() -> None:
    exact = exact_intervals(FROM_REST, np.float64)
    for side in (sides_of("newton").up, sides_of("newton").down):
        error = np.abs(side(FROM_REST) / exact - 1)
        assert error[9:].max() < 0.004
    down_20 = np.abs(sides_of("first_order").down(FROM_REST) / exact - 1)
    assert down_20[9] > 0.05


@pytest.mark.parametrize("method", TAYLOR)
@pytest.mark.parametrize("slope", SLOPES, ids=str)
def test_intervals_stay_between_slew_and_initial_interval(method: str, slope: Slope) -> None:
    for side in (sides_of(method).up, sides_of(method).down):
        intervals = side(slope)
        assert intervals.min() >= slope.slew_interval
        assert intervals.max() <= slope.initial_interval
        assert method == "second_order" or np.all(np.diff(intervals) <= 0)


def test_austin_is_avr446_from_rest() -> None:
    # AVR446: c0 = f sqrt(2 alpha / omega') * 0.676 in its units; c1 = c0 - 2 c0 / 5; c2 = c1 - 2 c1 / 9.
    c0 = 0.676 * 1e6 * (2 / 4000) ** 0.5
    c1 = c0 - 2 * c0 / 5
    c2 = c1 - 2 * c1 / 9
    assert austin_up(FROM_REST, np.float64)[:3] == pytest.approx([c0, c1, c2], rel=1e-12)


def test_austin_comes_to_the_true_instants_of_constant_acceleration() -> None:
    ideal = sides_of("ideal").up(FROM_REST)
    error = sides_of("austin").up(FROM_REST) / ideal - 1
    assert np.abs(error[20:]).max() < 2e-3


def test_a_ramp_without_steps_has_no_intervals() -> None:
    for method in METHODS:
        if method != "table":
            sides = sides_of(method, "float32")
            for side in (sides.up, sides.down):
                assert side(Slope(1e6, 100, 100, 4000)).size == 0
