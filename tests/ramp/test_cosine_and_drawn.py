"""Ramps whose speed is half a wave, and whose acceleration is drawn over the speed, against mpmath."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from stepramp.numerics.slope import ShapeParameters
from stepramp.shapes.constant import ConstantAcceleration
from stepramp.shapes.cosine import Cosine
from stepramp.shapes.drawn import Drawn

HZ = 16e6
Point = tuple[float, float]


def state_at(slope: Cosine, place: int) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Return time and speed at a place: v(t) = v0 + Δ (1 - cos(π t / T)) / 2 integrated, with a = π Δ / 2 T."""
    base, gain = mpmath.mpf(slope.base_speed), mpmath.mpf(slope.slew_speed) - mpmath.mpf(slope.base_speed)
    whole = mpmath.pi * gain / (2 * mpmath.mpf(slope.acceleration))

    def walked(time: mpmath.mpf) -> mpmath.mpf:
        return base * time + gain / 2 * (time - whole / mpmath.pi * mpmath.sin(mpmath.pi * time / whole))

    low, high = mpmath.mpf(0), whole
    for _ in range(130):
        middle = (low + high) / 2
        low, high = (middle, high) if walked(middle) < place else (low, middle)
    return low, base + gain * (1 - mpmath.cos(mpmath.pi * low / whole)) / 2


@given(
    base=st.floats(0, 300), gain=st.floats(1, 5000), acceleration=st.floats(10, 1e6), part=st.floats(0, 1),
)  # fmt: skip
def test_a_cosine_has_the_digits_of_its_numbers(base: float, gain: float, acceleration: float, part: float) -> None:
    slope = Cosine(HZ, base, base + gain, acceleration)
    assume(1 <= slope.length < 1e6)
    step = 1 + int(part * (slope.steps - 1))
    with mpmath.workdps(40):
        (before, _), (time, speed) = state_at(slope, step - 1), state_at(slope, step)
        duration = HZ * (time - before)
    assert slope.speeds(0, slope.steps + 1, np.float64)[step] == pytest.approx(float(speed), rel=1e-12)
    assert slope.durations(np.float64)[step - 1] == pytest.approx(float(duration), rel=1e-9)
    assert slope.speeds(step, 1, np.float32)[0] == pytest.approx(float(speed), rel=1e-4)


def test_a_cosine_to_a_lower_peak_has_no_more_jerk() -> None:
    slope = Cosine(HZ, 100, 1100, 5000)
    lower = slope.lowered(350)
    # v'' is largest at its ends: Δ/2 (π/T)², and with a = π Δ / 2 T it is 2 a² / Δ.
    assert lower.acceleration == pytest.approx(5000 * math.sqrt(0.25))
    assert 2 * lower.acceleration**2 / 250 == pytest.approx(2 * slope.acceleration**2 / 1000)


def monotone_cubic(points: Sequence[Point]) -> Callable[[mpmath.mpf], mpmath.mpf]:
    """Return the curve of Fritsch and Butland through points, in the form of Hermite's polynomials."""
    x, y = ([mpmath.mpf(point[i]) for point in points] for i in (0, 1))
    widths = [after - before for before, after in pairwise(x)]
    rises = [(after - before) / width for before, after, width in zip(y[:-1], y[1:], widths, strict=True)]

    def at_an_end(h0: mpmath.mpf, h1: mpmath.mpf, d0: mpmath.mpf, d1: mpmath.mpf) -> mpmath.mpf:
        slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
        if mpmath.sign(slope) != mpmath.sign(d0):
            return mpmath.mpf(0)
        return 3 * d0 if mpmath.sign(d0) != mpmath.sign(d1) and abs(slope) > abs(3 * d0) else slope

    slopes = [rises[0], *[mpmath.mpf(0)] * (len(x) - 2), rises[-1]]
    if len(x) > 2:
        for k in range(1, len(x) - 1):
            if rises[k - 1] * rises[k] > 0:
                first, second = 2 * widths[k] + widths[k - 1], widths[k] + 2 * widths[k - 1]
                slopes[k] = (first + second) / (first / rises[k - 1] + second / rises[k])
        slopes[0] = at_an_end(widths[0], widths[1], rises[0], rises[1])
        slopes[-1] = at_an_end(widths[-1], widths[-2], rises[-1], rises[-2])

    def value(at: mpmath.mpf) -> mpmath.mpf:
        at = min(max(at, x[0]), x[-1])
        k = max(i for i in range(len(x) - 1) if x[i] <= at)
        t = (at - x[k]) / widths[k]
        rests = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2, t**2 * (3 - 2 * t), t**2 * (t - 1)
        return (
            rests[0] * y[k]
            + rests[1] * widths[k] * slopes[k]
            + rests[2] * y[k + 1]
            + rests[3] * widths[k] * slopes[k + 1]
        )

    return value


DRAWN = [
    (0, 1000, 5000, ((0, 1.0), (300, 0.9), (600, 0.5), (1000, 0.2)), 1e-10),
    (100, 900, 5000, ((0, 1.0), (300, 0.9), (600, 0.5), (1000, 0.2)), 1e-10),
    (0, 1000, 50, ((0, 1.0), (300, 0.9), (600, 0.5), (1000, 0.2)), 1e-10),
    (0, 1000, 5000, ((0, 0.5), (2000, 1.0)), 1e-10),
    (0.5, 800, 900, ((10, 0.2), (20, 1.0), (30, 0.6), (31, 0.7)), 1e-9),
    (0, 1000, 5000, ((0, 0.3), (50, 0.9), (60, 1), (500, 0.001)), 1e-8),
]  # fmt: skip


@pytest.mark.parametrize(("base", "slew", "acceleration", "points", "close"), DRAWN)
def test_a_drawn_acceleration_is_integrated(
    base: float, slew: float, acceleration: float, points: tuple[Point, ...], close: float
) -> None:
    slope, drawn = Drawn(HZ, base, slew, acceleration, ShapeParameters(points=points)), monotone_cubic(points)
    speeds, durations = slope.speeds(0, slope.steps + 1, np.float64), slope.durations(np.float64)
    with mpmath.workdps(25):

        def integral(power: int, low: float, high: float) -> float:
            kinks = [low, *(speed for speed, _ in points if low < speed < high), high]
            return float(mpmath.quad(lambda v: v**power / (acceleration * drawn(v)), kinks))

        assert slope.length == pytest.approx(integral(1, base, slew), rel=close)
        for step in (1, 2, slope.steps // 3, slope.steps - 1, slope.steps):
            assert integral(1, base, speeds[step]) == pytest.approx(step, rel=close)
            assert durations[step - 1] == pytest.approx(HZ * integral(0, speeds[step - 1], speeds[step]), rel=close)
    assert slope.speeds(1, slope.steps, np.float32) == pytest.approx(speeds[1:], rel=1e-4)


@given(
    base=st.just(0.0) | st.floats(0.001, 500), gain=st.floats(1, 5000), acceleration=st.floats(1000, 1e5),
    kinks=st.lists(st.floats(0, 6000), min_size=2, max_size=6, unique=True),
)  # fmt: skip
def test_a_drawn_line_that_is_level_is_constant_acceleration(
    base: float, gain: float, acceleration: float, kinks: list[float]
) -> None:
    points = tuple((speed, 1.0) for speed in sorted(kinks))
    drawn = Drawn(HZ, base, base + gain, acceleration, ShapeParameters(points=points))
    constant = ConstantAcceleration(HZ, base, base + gain, acceleration)
    assert drawn.length == pytest.approx(constant.length, rel=1e-12)
    steps = min(drawn.steps, constant.steps)
    assert drawn.speeds(1, steps, np.float64) == pytest.approx(constant.speeds(1, steps, np.float64), rel=1e-12)
    assert drawn.durations(np.float64)[:steps] == pytest.approx(constant.durations(np.float64)[:steps], rel=1e-10)


def test_a_drawn_curve_stays_between_the_points_beside_it() -> None:
    points = ((0, 0.2), (100, 1.0), (120, 1.0), (300, 0.001), (1000, 0.9))
    slope = Drawn(HZ, 0, 1000, 1.0, ShapeParameters(points=points))
    for (low, before), (high, after) in pairwise(points):
        within = slope.accelerations(np.linspace(low, high, 500))
        assert within.min() >= min(before, after) * (1 - 1e-12)
        assert within.max() <= max(before, after) * (1 + 1e-12)
    assert list(slope.accelerations(np.array([0.0, 100, 120, 300, 1000, 2000]))) == [0.2, 1, 1, 0.001, 0.9, 0.9]
