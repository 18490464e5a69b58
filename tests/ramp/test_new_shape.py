"""A ramp of another shape: what asks a slope follows it, what holds for constant acceleration only refuses it."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from designs import design, document
from stepramp.controllers.stepramp.playback import formula_ramp
from stepramp.design import Design, RampShape
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export
from stepramp.numerics.numbers import Number
from stepramp.numerics.slope import Slope
from stepramp.ramp.error_curves import error_curves
from stepramp.ramp.on_chip import design_refusal
from stepramp.ramp.plan import real_ramp
from stepramp.ramp.table_delays import ramp_delays
from stepramp.shapes import SHAPES

HZ, BASE, SLEW, STEEPEST = 2e6, 100.0, 1000.0, 5000.0
GROWTH = STEEPEST / SLEW
"""Gain of speed a step: the acceleration is v times it, and largest at slew speed [1/s]."""


class EvenGrowth(Slope):
    """The speed grows evenly over position, and so as a power of e over time."""

    @property
    def length(self) -> float:
        return (self.slew_speed - self.base_speed) * self.slew_speed / self.acceleration

    def acceleration_over(self, steps: float) -> float:
        return (self.slew_speed - self.base_speed) * self.slew_speed / steps

    def speeds(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        places = (first + np.arange(count)).astype(number)
        return number(self.base_speed) + places * number(self.acceleration / self.slew_speed)

    def durations(self, number: Number) -> NDArray[np.floating]:
        speeds = self.speeds(0, self.steps + 1, number)
        return number(self.timer_hz / (self.acceleration / self.slew_speed)) * np.log(speeds[1:] / speeds[:-1])


@pytest.fixture(autouse=True)
def even_growth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SHAPES, "even_growth", EvenGrowth)


def shaped(method: str = "exact", **changes: Any) -> Design:
    """Return a design whose ramp has the shape; its name is checked before, at the start of the program."""
    plain = design(method__name=method, ramp__base_speed_steps_per_s=BASE, **changes)
    return plain.model_copy(
        update={"ramp": plain.ramp.model_copy(update={"shape": RampShape.model_construct(name="even_growth")})}
    )


def speed(place: float) -> float:
    return BASE + GROWTH * place


def instants() -> Iterator[float]:
    """Yield when each step of the ramp begins and the last one ends [s]."""
    for step in range(181):
        yield math.log(speed(step) / BASE) / GROWTH


def test_methods_in_closed_form_follow_it() -> None:
    # 900 steps/s to gain, 5 a step.
    exact, midpoint, ideal = (real_ramp(shaped(name)) for name in ("exact", "midpoint", "ideal"))
    assert exact.up == pytest.approx([HZ / speed(step) for step in range(1, 181)])
    assert midpoint.up == pytest.approx([HZ / speed(step - 0.5) for step in range(1, 181)])
    assert ideal.up == pytest.approx(HZ * np.diff(list(instants())))
    assert ideal.down == pytest.approx(ideal.up)
    assert real_ramp(shaped("exact", method__arithmetic="float32")).up.dtype == np.float32


def test_errors_and_tables_are_held_against_it() -> None:
    judged = error_curves(shaped("table"), "table", "exact")
    assert judged.reference_ticks[:180] == pytest.approx([HZ / speed(step) for step in range(1, 181)])
    fitted = ramp_delays(shaped(), "us", "ramp_index")
    assert fitted.longest[:181] == pytest.approx([1e6 / speed(step) for step in range(181)])


@pytest.mark.parametrize("name", ["first_order", "second_order", "compromise", "tuned", "austin"])
def test_recurrences_hold_for_constant_acceleration_only(name: str) -> None:
    with pytest.raises(Rejected) as caught:
        real_ramp(shaped(name))
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("method.name", name)
    assert rejection.allowed == "exact, ideal, midpoint, newton, table with ramp.shape.name 'even_growth'"


def test_neither_code_nor_a_controller_computes_it() -> None:
    with pytest.raises(Rejected, match=r"ramp\.shape\.name is 'even_growth'; allowed: constant, in code that computes"):
        export(shaped(), "c_newton", Options())
    asked = shaped("newton", method__arithmetic="fixed")
    assert formula_ramp(asked, range(1, 2**31)) is None
    assert design_refusal(asked) == "The shape of the ramp is even_growth; a controller computes constant acceleration."


def test_a_ramp_that_is_too_long_says_how_steep_it_must_be_in_this_shape() -> None:
    with pytest.raises(Rejected) as caught:
        real_ramp(shaped(ramp__acceleration_steps_per_s2=0.05))
    # 900 · 1000 / 10,000,000
    assert caught.value.rejections[0].allowed.startswith("at least 0.09 steps/s²")


def test_the_usual_shape_is_left_out_of_documents() -> None:
    named = Design.checked(document() | {"ramp": document()["ramp"] | {"shape": {"name": "constant"}}})
    assert named == design()
    assert "shape" not in named.model_dump(mode="json")["ramp"]
    assert shaped().model_dump(mode="json")["ramp"]["shape"] == {"name": "even_growth"}
    with pytest.raises(Rejected, match=r"ramp\.shape\.name is 'jerk_limited'; allowed: constant"):
        Design.checked(document() | {"ramp": document()["ramp"] | {"shape": {"name": "jerk_limited"}}})
