import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from stepramp.ramp.kinematics import ramp_steps
from stepramp.ramp.recurrences import first_order_down, first_order_up
from tools import require

RAMPS = [
    (1_000_000, 100, 2000, 4000),
    (2_000_000, 0, 1000, 5000),
    (2_000_000, 0, 2000, 4000),
    (16_000_000, 3.7, 33_333.3, 12_345.6),
    (100_000_000, 0.5, 50_000, 1e6),
    (10_000, 10, 400, 100),
    (1_000_000, 0, 150_000, 1e7),
]


@pytest.fixture(scope="session")
def c_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*([] if shutil.which("gcc") else ["gcc"]))
    program = tmp_path_factory.mktemp("c") / "first_order"
    source = Path(__file__).with_name("first_order.c")
    flags = ["-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    subprocess.run(["gcc", *flags, "-o", str(program), str(source), "-lm"], check=True)
    return program


@pytest.mark.parametrize(("timer_hz", "base", "slew", "acceleration"), RAMPS)
def test_float32_is_what_a_c_compiler_gives_bit_for_bit(
    c_program: Path, timer_hz: float, base: float, slew: float, acceleration: float
) -> None:
    steps = ramp_steps(base, slew, acceleration)
    words = [repr(float(number)) for number in (timer_hz, base, slew, acceleration)]
    printed = subprocess.run(
        [c_program, *words, str(steps), str(steps)], check=True, capture_output=True, text=True
    ).stdout.split()
    expected = np.array([int(word, 16) for word in printed], dtype=np.uint32)

    up = first_order_up(timer_hz, base, slew, acceleration, steps, np.float32)
    down = first_order_down(timer_hz, base, slew, acceleration, steps, np.float32)

    assert up.dtype == down.dtype == np.float32
    np.testing.assert_array_equal(np.concatenate((up, down[::-1])).view(np.uint32), expected)


def test_from_rest_the_second_interval_is_half_the_first() -> None:
    # Formula (20) with p = p1 = F / sqrt(2 a): m p p = -1/2. The exact ratio is sqrt(1/2).
    up = first_order_up(2e6, 0, 2000, 4000, 2, np.float64)
    assert up[1] / up[0] == pytest.approx(0.5, rel=1e-12)


def test_largest_error_of_formula_20_from_rest_is_29_percent_at_step_2() -> None:
    up = first_order_up(1e6, 0, 2000, 4000, 500, np.float64)
    exact = 1e6 / np.sqrt(2 * 4000 * np.arange(1, 501))
    error = up / exact - 1
    assert int(np.abs(error).argmax()) + 1 == 2
    assert error.min() == pytest.approx(0.5 / 0.5**0.5 - 1, rel=1e-9)  # -29.3 %


def test_intervals_stay_between_slew_and_initial_interval() -> None:
    for timer_hz, base, slew, acceleration in RAMPS:
        steps = ramp_steps(base, slew, acceleration)
        for side in (first_order_up, first_order_down):
            intervals = side(timer_hz, base, slew, acceleration, steps, np.float64)
            assert intervals.min() >= timer_hz / slew * (1 - 1e-12)
            assert intervals.max() <= timer_hz / (base**2 + 2 * acceleration) ** 0.5 * (1 + 1e-12)
            assert np.all(np.diff(intervals) <= 0)


def test_a_ramp_without_steps_has_no_intervals() -> None:
    assert first_order_up(1e6, 100, 100, 4000, 0, np.float32).size == 0
    assert first_order_down(1e6, 100, 100, 4000, 0, np.float32).size == 0
