"""Ramps that a controller computes while it plays them, in whole ticks. They are of constant acceleration.

The arithmetic is fixed_point's, bit for bit. What is defined here is the motion along such a ramp when no list
of it is stored: where a ramp down begins, how long it is, and how a ramp up goes on from within a ramp down. A move of
full length is that of plan.plan_of; docs/decisions/0009-formulas-on-the-chip.md has what is different in a short one.

The position on the ramp is the distance from rest, in steps of the side that the motor is on, with 8 bits of fraction:
each step up adds 1 to that of the acceleration, each step down takes 1 from that of the deceleration. Where the motor
turns it is multiplied by the ratio of the accelerations, as x is by its root.

No interval that a recurrence gives is used beyond the ends of the ramp: it is at least that of slew speed, at most p1.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, MethodName
from stepramp.methods import METHODS
from stepramp.methods.common.fixed_point import (
    LEAST_MANTISSA,
    MANTISSA_BITS,
    RAMP_INDEX_BITS,
    Format,
    Scaled,
    intervals_of,
    refusal,
)
from stepramp.ramp.slopes import constant_slopes_of
from stepramp.shapes.constant import ConstantAcceleration

ON_CHIP = {name: method.on_chip for name, method in METHODS.items() if method.on_chip}
"""The methods that a controller can compute, by name."""
MOST_ON_CHIP_INDEX = 2**24 - 2
"""Largest v² / 2 a of the slew speed [steps]: the ramp index has 24 bits."""

POSITION_BITS = 8
"""Of fraction, in a position on the ramp."""

_ONE_STEP = 1 << RAMP_INDEX_BITS
_WHOLE = 1 << POSITION_BITS
_NO_TICKS: NDArray[np.int64] = np.empty(0, np.int64)


class Factor(NamedTuple):
    """A ratio: mantissa / 2³² · 16^exponent, with a mantissa of 2²⁸ or more."""

    mantissa: int
    exponent: int

    @classmethod
    def of(cls, ratio: float) -> Self:
        """Return a ratio above 0, rounded to its mantissa."""
        exponent = 0
        while ratio >= 1:
            ratio, exponent = ratio / 16, exponent + 1
        while ratio < 1 / 16:
            ratio, exponent = ratio * 16, exponent - 1
        mantissa = round(math.ldexp(ratio, 32))
        return cls(mantissa, exponent) if mantissa < 2**32 else cls(2**28, exponent + 1)

    def times(self, x: Scaled) -> Scaled:
        """Return x times this, rounded down; its exponent may be beyond those that x can have."""
        product, exponent = x.mantissa * self.mantissa, x.exponent - self.exponent
        if product < LEAST_MANTISSA << MANTISSA_BITS:
            product, exponent = product << 4, exponent + 1
        return Scaled(product >> MANTISSA_BITS, exponent)


@dataclass(frozen=True)
class OnChipSide:
    """What a controller knows of one side of the ramp."""

    steps: int
    """n_up or n_down, at least 1."""
    form: Format
    carry: Factor | None
    """√(a of this side / a of the other), by which x comes from there to here; None when both are equal."""

    def clamped(self, x: Scaled) -> Scaled:
        """Return x, or the end of this side that it is beyond."""
        if _is_longer(x, self.form.longest):
            return self.form.longest
        return self.form.shortest if _is_longer(self.form.shortest, x) else x

    def ticks(self, x: Scaled) -> int:
        """Return the interval of x in whole ticks."""
        found = intervals_of(self.form, np.array([x.mantissa], np.uint32), np.array([x.exponent], np.uint8))
        return int(found.whole_ticks[0])

    @property
    def longest_interval(self) -> int:
        """The interval p1 in whole ticks, of which no other is longer."""
        return self.ticks(self.form.longest)


@dataclass(frozen=True)
class OnChipRamp:
    """A ramp as a controller is sent it that computes it while it plays it."""

    method: MethodName
    up: OnChipSide
    down: OnChipSide
    slew_interval: int
    """[ticks]."""

    @classmethod
    def of(cls, up: ConstantAcceleration, down: ConstantAcceleration, method: MethodName) -> Self:
        """Return the ramp of two slopes with one base speed, slew speed and timer.

        Raises ValueError where slopes_refusal gives a reason.
        """
        if reason := slopes_refusal(up, down, method):
            raise ValueError(reason)
        ratio = math.sqrt(down.acceleration / up.acceleration)
        same = up.acceleration == down.acceleration
        return cls(
            method=method,
            up=OnChipSide(up.steps, Format.of(up), None if same else Factor.of(1 / ratio)),
            down=OnChipSide(down.steps, Format.of(down), None if same else Factor.of(ratio)),
            slew_interval=math.floor(up.slew_interval + 0.5),
        )

    @property
    def creep_interval(self) -> int:
        """Interval of moves that are too short for one step up and the ramp down from it [ticks].

        It is p1 of the slower side, which either can begin and end with.
        """
        return max(side.longest_interval for side in (self.up, self.down))

    def move(self, steps: int) -> NDArray[np.int64]:
        """Return the intervals of a move of so many steps, at least 1, in order of time [ticks], shape (steps,).

        It takes the largest u with u + m(u) ≤ steps; what is left over runs at the highest speed it came to.
        """
        motor = OnChipMotor(self)
        climbed = motor.fitting(steps, steps)
        if climbed == 0:
            return np.full(steps, self.creep_interval, np.int64)
        up = motor.up(climbed)
        held = np.full(steps - climbed - motor.steps_down, motor.hold_interval, np.int64)
        return np.concatenate((up, held, motor.down(motor.steps_down)))


class MotorState(Enum):
    """Where a motor is."""

    REST = 0
    UP = 1
    """On the ramp up, or at slew speed."""
    DOWN = 2


class OnChipMotor:
    """A motor on its way along a ramp, as the controller computes it: interval for interval, at most to slew speed.

    At any time intervals of `hold_interval` may be played in between; that changes nothing here.
    """

    def __init__(self, ramp: OnChipRamp) -> None:
        self.ramp = ramp
        self.state = MotorState.REST
        self._x = ramp.up.form.longest
        self._position = 0
        """Distance from rest, with POSITION_BITS of fraction [steps of the present side]."""
        self._interval = 0

    @property
    def steps_up(self) -> int:
        """Steps up from rest to here, u, to the nearest [steps]."""
        position = self._position_up if self.state is MotorState.DOWN else self._position
        return (position + _WHOLE // 2) >> POSITION_BITS

    @property
    def steps_down(self) -> int:
        """Steps of the ramp down from here to rest, m [steps]."""
        return self._steps_down_from(self._position) if self.state is MotorState.UP else _rounded_up(self._position)

    @property
    def slews(self) -> bool:
        """Whether the ramp up has come to its end."""
        return self.state is MotorState.UP and self._is_top(self._position)

    @property
    def hold_interval(self) -> int:
        """The interval that keeps the present speed: the last one, or at the end of the ramp up that of slew speed."""
        return self.ramp.slew_interval if self.slews else self._interval

    def fitting(self, steps_left: int, most: int) -> int:
        """Return how many of the next `most` steps up leave enough of steps_left for the ramp down after them."""
        begin = self._begin_of_ramp_up
        least, above = 0, 1 + max(min(most, self._room_from(begin), steps_left), 0)
        while above - least > 1:
            count = (least + above) // 2
            if count + self._steps_down_from(begin + count * _WHOLE) <= steps_left:
                least = count
            else:
                above = count
        return least

    def up(self, most: int) -> NDArray[np.int64]:
        """Return the next intervals of the ramp up [ticks], shape (at most `most`,); none at slew speed.

        From rest the first is p1. From within a ramp down it is the last interval, held: x is carried over, and the
        position is what it was before the step that this interval was.
        """
        begin = self._begin_of_ramp_up
        count = min(most, self._room_from(begin))
        if count < 1:
            return _NO_TICKS
        first = []
        if self.state is not MotorState.UP:
            if self.state is MotorState.REST:
                self._x, self._interval = self.ramp.up.form.longest, self.ramp.up.longest_interval
            else:
                self._x = _carried(self._x, self.ramp.down, self.ramp.up)
            first = [self._interval]
        self.state = MotorState.UP
        last = (begin >> POSITION_BITS) + len(first) - 1
        index = self.ramp.up.form.first_ramp_index + last * _ONE_STEP
        self._position = begin + count * _WHOLE
        if self._is_top(self._position):
            self._position = self.ramp.up.steps * _WHOLE
        return np.concatenate((np.array(first, np.int64), self._stepped(self.ramp.up, index, count - len(first))))

    def down(self, most: int) -> NDArray[np.int64]:
        """Return the next intervals of the ramp down [ticks], shape (at most `most`,); none at rest.

        From slew speed the first is one step of the recurrence from pS. From within a ramp up it is the last interval,
        held, and x is carried over.
        """
        if most < 1 or self.state is MotorState.REST:
            return _NO_TICKS
        first = []
        if self.slews:
            self._x, self._position = self.ramp.down.form.shortest, self.ramp.down.steps * _WHOLE
        elif self.state is MotorState.UP:
            self._position = _converted(self._position, self.ramp.up, self.ramp.down) - _WHOLE
            self._x = _carried(self._x, self.ramp.up, self.ramp.down)
            first = [self._interval]
        self.state = MotorState.DOWN
        count = min(most - len(first), self.steps_down)
        index = self.ramp.down.form.first_ramp_index + self.steps_down * _ONE_STEP
        self._position = max(self._position - count * _WHOLE, 0)
        stepped = self._stepped(self.ramp.down, index, count)
        if self._position == 0:
            self.state = MotorState.REST
        return np.concatenate((np.array(first, np.int64), stepped))

    @property
    def _position_up(self) -> int:
        """Distance from rest before the last step down, in steps up."""
        return _converted(self._position + _WHOLE, self.ramp.down, self.ramp.up)

    @property
    def _begin_of_ramp_up(self) -> int:
        """The position before the next step up. From within a ramp down that step takes the last one back."""
        return self._position_up - _WHOLE if self.state is MotorState.DOWN else self._position

    def _room_from(self, position: int) -> int:
        """Return how many steps up there are to slew speed."""
        return self.ramp.up.steps - ((position + _WHOLE // 2) >> POSITION_BITS)

    def _is_top(self, position: int) -> bool:
        return self._room_from(position) == 0

    def _steps_down_from(self, position: int) -> int:
        """Return the steps of the ramp down from a position on the ramp up."""
        if self._is_top(position):
            return self.ramp.down.steps
        return _rounded_up(_converted(position, self.ramp.up, self.ramp.down))

    def _stepped(self, side: OnChipSide, index: int, count: int) -> NDArray[np.int64]:
        """Return the next intervals by the recurrence; index: k of the last one."""
        if count < 1:
            return _NO_TICKS
        mantissas, exponents = np.empty(count, np.uint32), np.empty(count, np.uint8)
        up, form = side is self.ramp.up, side.form
        ON_CHIP[self.ramp.method].steps(self._x, index, up, form, mantissas, exponents)
        self._x = Scaled(int(mantissas[-1]), int(exponents[-1]))
        found = intervals_of(form, mantissas, exponents).whole_ticks
        ticks = np.clip(found, self.ramp.slew_interval, side.longest_interval)
        self._interval = int(ticks[-1])
        return ticks


def _rounded_up(position: int) -> int:
    return (position + _WHOLE - 1) >> POSITION_BITS


def _converted(position: int, here: OnChipSide, there: OnChipSide) -> int:
    """Return a position in steps of the other side: times the ratio of the accelerations, at least 1 step."""
    if here.carry is not None:
        x = Scaled(position, 0)
        while x.mantissa < LEAST_MANTISSA:
            x = Scaled(x.mantissa << 4, x.exponent + 1)
        x = here.carry.times(here.carry.times(x))
        position = (
            (x.mantissa + (1 << 4 * x.exponent >> 1)) >> 4 * x.exponent if x.exponent >= 0 else there.steps * _WHOLE
        )
    return min(max(position, _WHOLE), there.steps * _WHOLE)


def _carried(x: Scaled, here: OnChipSide, there: OnChipSide) -> Scaled:
    """Return x in the scale of the other side."""
    x = here.clamped(x)
    return there.clamped(x if there.carry is None else there.carry.times(x))


def slopes_refusal(up: ConstantAcceleration, down: ConstantAcceleration, method: MethodName) -> str | None:
    """Return why a controller can't compute these slopes, as a sentence with what is allowed, else None."""
    if up.steps < 1 or down.steps < 1:
        return (
            f"The acceleration takes {up.steps:,} and the deceleration {down.steps:,} steps; computed on the "
            f"controller both must take at least 1: such a ramp is better stored."
        )
    if reason := refusal(up) or ON_CHIP[method].down_refusal(down):
        return reason
    index = max(slope.slew_speed**2 / (2 * slope.acceleration) for slope in (up, down))
    if index > MOST_ON_CHIP_INDEX:
        return (
            f"The slew speed is {index:,.0f} steps away from rest; computed on the controller it must be at most "
            f"{MOST_ON_CHIP_INDEX:,}, which takes a higher acceleration."
        )
    return None


def design_refusal(design: Design) -> str | None:
    """Return why a controller can't compute a design's ramp while it plays it, as a sentence, else None."""
    method, methods = design.method, tuple(ON_CHIP)
    if method.name not in methods:
        return f"The method is {method.name}; a controller computes {', '.join(methods[:-1])} or {methods[-1]}."
    if method.arithmetic != "fixed":
        return f"The arithmetic is {method.arithmetic}; a controller computes in fixed."
    if method.rounding != "nearest":
        return f"The rounding is {method.rounding}; a controller rounds to the nearest tick."
    slopes = constant_slopes_of(design)
    if slopes is None:
        return f"The shape of the ramp is {design.ramp.shape.name}; a controller computes constant acceleration."
    return slopes_refusal(*slopes, method.name)


def on_chip_ramp(design: Design) -> OnChipRamp:
    """Return a design's ramp as a controller computes it. Raises ValueError where design_refusal gives a reason."""
    slopes, reason = constant_slopes_of(design), design_refusal(design)
    if slopes is None or reason is not None:
        raise ValueError(reason)
    return OnChipRamp.of(*slopes, design.method.name)


def _is_longer(x: Scaled, other: Scaled) -> bool:
    return (-x.exponent, x.mantissa) > (-other.exponent, other.mantissa)
