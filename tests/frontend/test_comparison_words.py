"""One ramp against another in words."""

import pytest

from frontend.modules import Modules


@pytest.mark.parametrize(
    ("now", "expected"),
    [
        ((1.12, 5000, 25), "same peak acceleration: 12 % longer, a quarter of the jerk"),
        ((1, 5000, 100), "same peak acceleration: as long, the same jerk"),
        ((0.8, 6000, 50), "peak acceleration 20 % higher: 20 % shorter, half the jerk"),
        ((2.5, 2500, 12.7), "peak acceleration 50 % lower: 2.5 times as long, an eighth of the jerk"),
        ((1, 15_000, 130), "peak acceleration 3 times as high: as long, 30 % more jerk"),
        ((1, 5000, 450), "same peak acceleration: as long, 4.5 times the jerk"),
        ((1, 5000, 80), "same peak acceleration: as long, 20 % less jerk"),
        ((1, 5000, 2.3), "same peak acceleration: as long, 2.3 % of the jerk"),
        ((1, 5000, 0), "same peak acceleration: as long, hardly any jerk"),
        ((1.999, 5000, 199.9), "same peak acceleration: 2 times as long, 2 times the jerk"),
        ((1, 0.01, 100), "peak acceleration over 99.9 % lower: as long, the same jerk"),
    ],
)
def test_a_ramp_is_compared(modules: Modules, now: tuple[float, ...], expected: str) -> None:
    names = ("duration", "acceleration", "jerk")
    before = dict(zip(names, (1, 5000, 100), strict=True))
    present = dict(zip(names, now, strict=True))
    assert modules.call("model/comparison_words.js", "comparisonWords", present, before) == expected


def test_a_ramp_without_any_acceleration_is_compared_by_what_it_has(modules: Modules) -> None:
    still = {"duration": 2, "acceleration": 0, "jerk": 0}
    words = modules.call("model/comparison_words.js", "comparisonWords", {**still, "duration": 3}, still)
    assert words == "same peak acceleration: 50 % longer, the same jerk"
