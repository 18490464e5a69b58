"""What a ramp method is: its numerics, what people are told of it, its C, and how a controller computes it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.errors import Rejected, Rejection
from stepramp.methods.common.fixed_point import FixedIntervals, Format, Scaled
from stepramp.numerics.numbers import NUMBERS, Arithmetic, Number
from stepramp.numerics.slope import Slope
from stepramp.shapes.constant import ConstantAcceleration

TunedFor = Literal["largest_error", "time"]

SideIntervals = Callable[[Any], NDArray[np.floating]]
"""Of a slope of the method's shape, the intervals [ticks], shape (steps,), from the slow end."""
SideIntervalsInNumbers = Callable[[Any, Number], NDArray[np.floating]]
SideIntervalsInIntegers = Callable[[ConstantAcceleration], FixedIntervals]

CLOSED_FORM: tuple[Arithmetic, ...] = ("float64", "float32")
"""What needs a square root is not for integers."""
STEP_BY_STEP: tuple[Arithmetic, ...] = ("float32", "float64", "fixed")
"""Errors add up, and the target most often has C float."""


@dataclass(frozen=True)
class Sides:
    """The two sides of a ramp by one method in one arithmetic. Raises Rejected for a slope that it can't compute."""

    up: SideIntervals
    down: SideIntervals


@dataclass(frozen=True)
class Style:
    """How a method's line is drawn."""

    light: str
    """Colour on a light ground, also in files."""
    dark: str
    """Colour on a dark ground."""
    dash: tuple[float, ...] | None = None
    """Dashes and gaps on the page [px]; None: solid, which only the reference and a table's staircase are."""
    file_dash: tuple[float, ...] | None = None
    """The same in files [line widths]."""
    file_width: float = 1.2
    """[points]"""


@dataclass(frozen=True)
class FixedCode:
    """What is a method's own in C that computes in integers: a $name in it is the name of the ramp."""

    field: str
    """Of a side, besides its first x."""
    constants: Callable[[Format, int], tuple[int | Scaled, ...]]
    """The values of that field for a side's format and the ramp index of its first x, in 2^-24 steps."""
    change: str
    """The function that takes x one step on."""
    state_field: str = ""
    """Of the state of a motor along a side, besides its x …"""
    state_value: str = ""
    """… and what it begins with."""


@dataclass(frozen=True)
class Code:
    """A method in C99, bit for bit; exports/c_formula.py puts moves around it."""

    title: str
    """The formula, in ASCII."""
    label: str
    help: str
    side: str
    """The side of a ramp in floating-point numbers: a template, filled with the name and with `constants`."""
    constants: Callable[[ConstantAcceleration, ConstantAcceleration, Number], dict[str, np.floating]]
    """Of the two sides, up and down, in numbers of the type."""
    fixed: FixedCode


@dataclass(frozen=True)
class OnChip:
    """How a controller computes a method while it plays it."""

    number: int
    """In a ramp image; see docs/serial_protocol.md."""
    steps: Callable[[Scaled, int, bool, Format, NDArray[np.uint32], NDArray[np.uint8]], None]
    """From x with a ramp index, up or down, fill mantissas and exponents with x after each further step."""
    down_refusal: Callable[[ConstantAcceleration], str | None]
    """Why a slope can't be computed downwards, as a sentence with what is allowed; None when it can."""


@dataclass(frozen=True)
class TuningReport:
    """What tuning found, and how much better it is than formulas (20), (22) and (23), in float64."""

    coefficient_up: float
    coefficient_down: float
    largest_relative_error: dict[str, float]
    """By method, the largest relative error of an interval of either side, without sign."""
    time_error: dict[str, float]
    """By method, how much longer both sides take together than the exact ones, as a part of their time."""


@dataclass(frozen=True)
class RampMethod:
    """A method: everything that is its own."""

    rank: int
    """Where it stands in lists: methods with less stand before it."""
    label: str
    """What people call it; short."""
    help: str
    """What it is good for, in a sentence or two."""
    summary: str
    """The same for programmers, in a few words."""
    style: Style
    arithmetics: tuple[Arithmetic, ...]
    """Those that it can be computed in, the usual one first."""
    sides: Callable[[Arithmetic, TunedFor], Sides] | None
    """What computes a ramp. None: it is not computed, the design's lookup table has it."""
    shape: type[Slope] | None = None
    """The shape that a ramp must have; None: any."""
    formula: str = ""
    """Its number in Eiderman's paper."""
    code: Code | None = None
    on_chip: OnChip | None = None
    tuning: Callable[[Any, Any, TunedFor], TuningReport] | None = None
    """What tuning does for the two sides of a ramp, up and down; None: nothing is tuned."""
    is_shown_at_first: bool = False
    """Whether the page shows it until a person chooses."""


def mirrored(side: SideIntervalsInNumbers) -> Callable[[Arithmetic, TunedFor], Sides]:
    """Return the sides of a method that decelerates as it accelerates, backwards."""
    return in_numbers(side, side)


def in_numbers(up: SideIntervalsInNumbers, down: SideIntervalsInNumbers) -> Callable[[Arithmetic, TunedFor], Sides]:
    """Return the sides of a method that computes in floating-point numbers."""

    def sides(arithmetic: Arithmetic, _: TunedFor) -> Sides:
        number = NUMBERS[arithmetic]
        return Sides(lambda slope: up(slope, number), lambda slope: down(slope, number))

    return sides


def step_by_step(
    up: SideIntervalsInNumbers,
    down: SideIntervalsInNumbers,
    fixed_up: SideIntervalsInIntegers,
    fixed_down: SideIntervalsInIntegers,
) -> Callable[[Arithmetic, TunedFor], Sides]:
    """Return the sides of a method that computes in integers, too."""

    def sides(arithmetic: Arithmetic, tuned_for: TunedFor) -> Sides:
        if arithmetic == "fixed":
            return Sides(_ticks_of(fixed_up), _ticks_of(fixed_down))
        return in_numbers(up, down)(arithmetic, tuned_for)

    return sides


def _ticks_of(side: SideIntervalsInIntegers) -> SideIntervals:
    def ticks(slope: ConstantAcceleration) -> NDArray[np.floating]:
        if slope.steps < 1:
            return np.empty(0)
        try:
            return side(slope).ticks
        except ValueError as error:
            allowed = f"float64 for this ramp. {error}".removesuffix(".")
            raise Rejected([Rejection("method.arithmetic", "fixed", allowed)]) from None

    return ticks
