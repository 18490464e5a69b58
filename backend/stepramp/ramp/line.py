"""Straight lines: one axis leads and plays a ramp, the others make their steps together with it.

The axis with most steps leads, the first of several. After the leader's pulse i of n_l, a follower of n steps has made
i n / n_l of them, rounded to the nearest, halves up (Bresenham): at each pulse of the leader it is at most half a step
from the straight line, and it pulses only together with the leader. Steps of a follower that are k apart are at least
floor(k n_l / n) intervals of the leader apart: less than one interval short of what is even.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, Table
from stepramp.errors import Rejected, Rejection, StepUnit, Told
from stepramp.ramp.move import play
from stepramp.ramp.plan import real_ramp
from stepramp.ramp.profile import Profile, profile_of
from stepramp.units import ticks_from_us

QUANTITIES: dict[str, tuple[str, StepUnit]] = {
    "base_speed_steps_per_s": ("base speed", "steps/s"),
    "slew_speed_steps_per_s": ("slew speed", "steps/s"),
    "acceleration_steps_per_s2": ("acceleration", "steps/s²"),
    "deceleration_steps_per_s2": ("deceleration", "steps/s²"),
    "shape.jerk_steps_per_s3": ("jerk", "steps/s³"),
    "shape.deceleration_jerk_steps_per_s3": ("jerk of the deceleration", "steps/s³"),
}
"""What an axis limits a line in: its ramp's fields, their names and their units."""
OPEN = {
    "deceleration_steps_per_s2": "acceleration_steps_per_s2",
    "shape.deceleration_jerk_steps_per_s3": "shape.jerk_steps_per_s3",
}
"""What may be left open: it is then the other."""
SHAPE = "shape."

Allowance = dict[str, float]
"""The most that an axis does in its own ramp, by the fields of QUANTITIES."""


@dataclass(frozen=True)
class Limit:
    """What makes a line slower than its leader's own move."""

    field: str
    """Path of the field where it can be changed, from `designs` on."""
    axis: int
    """The axis that limits, counted from 0."""
    message: str
    told: tuple[Told, ...] = ()
    """The quantities of the message, in their order."""


def leader_of(designs: Sequence[Design]) -> int:
    """Return the axis that leads a line: the first of those with most steps, counted from 0."""
    return max(range(len(designs)), key=lambda axis: steps_of(designs[axis]))


def steps_together(leader_steps: int, steps: int) -> NDArray[np.int64]:
    """Return with which step of the leader each step of an axis comes, counted from 1, shape (steps,).

    Step m comes with step i = ceil(n_l (2 m - 1) / (2 n)), where floor((2 i n + n_l) / (2 n_l)) grows to m. An axis
    with as many steps as the leader makes each with the leader's.

    leader_steps: n_l; steps: n, from 1 to n_l.
    """
    halves = leader_steps * (2 * np.arange(1, steps + 1) - 1)
    together: NDArray[np.int64] = -(-halves // (2 * steps))
    return together


def line_profile(designs: Sequence[Design], leader: int) -> tuple[Profile, tuple[Limit, ...]]:
    """Return the leader's profile along the line, and what makes it slower than the leader's own move.

    A leader whose method computes its ramp is given the base speed, slew speed, acceleration, deceleration and, where
    its shape limits it, the jerk that every axis allows: each the least of all axes, n_l / n times an axis' own. The
    leader's shape holds for all: an axis whose shape has no limit of jerk allows any. An axis with a lookup table
    allows its top speed and the steepest constant acceleration from rest that is nowhere faster than the table.

    A leader with a lookup table plays it with all delays made longer by one factor: the least with which no follower
    is faster than it is at the same one of its own steps when it moves alone.

    Raises Rejected as profile_of does; the fields are paths from `designs` on, of the axis that is to blame.
    """
    if designs[leader].method.plays_table:
        with fields_of(leader):
            own = profile_of(designs[leader])
        design, limits = _stretched(designs, leader)
        return (profile_of(design) if limits else own), limits
    allowances = [_allowance(design) for design in designs]
    design, limiting = _slowed(designs, leader, allowances)
    try:
        profile = profile_of(design)
    except Rejected as error:
        raise Rejected([_where_it_is_limited(each, designs, leader, limiting) for each in error.rejections]) from error
    return profile, tuple(_limit(designs, leader, allowances, *each) for each in limiting.items())


def steps_of(design: Design) -> int:
    """Return the length of a design's move, whichever its direction [steps]."""
    return abs(design.move.steps)


def called(designs: Sequence[Design], axis: int) -> str:
    """Return what a message calls an axis: its name, if it has one, and its place in the list."""
    return f"{designs[axis].name} (axis {axis})".lstrip()


@contextmanager
def fields_of(axis: int) -> Iterator[None]:
    """Have what is rejected of a design name its fields from `designs` on."""
    try:
        yield
    except Rejected as error:
        raise Rejected([_at(axis, each) for each in error.rejections]) from error


def _at(axis: int, rejection: Rejection) -> Rejection:
    return rejection.within(f"designs.{axis}.")


def _slowed(designs: Sequence[Design], leader: int, allowances: Sequence[Allowance]) -> tuple[Design, dict[str, int]]:
    """Return the leader's design with the ramp of the line, and which other axis limits which quantity."""
    n_l = steps_of(designs[leader])
    # Multiplied before divided: an axis that allows exactly what the leader has must not come out a rounding below it.
    allowed = [
        {name: own * n_l / steps_of(design) for name, own in allowance.items()}
        for design, allowance in zip(designs, allowances, strict=True)
    ]
    least = {name: min(each[name] for each in allowed) for name in QUANTITIES}
    if designs[leader].ramp.shape.jerk_steps_per_s3 is None:
        least = {name: each for name, each in least.items() if not name.startswith(SHAPE)}
    limiting = {
        name: next(axis for axis, each in enumerate(allowed) if each[name] == low)
        for name, low in least.items()
        if low < allowed[leader][name]
    }
    of_shape = {name.removeprefix(SHAPE): each for name, each in least.items() if name.startswith(SHAPE)}
    of_ramp = {name: each for name, each in least.items() if not name.startswith(SHAPE)}
    shape = designs[leader].ramp.shape.model_copy(update=of_shape)
    ramp = designs[leader].ramp.model_copy(update=of_ramp | {"shape": shape})
    return designs[leader].model_copy(update={"ramp": ramp}), limiting


def _allowance(design: Design) -> Allowance:
    if design.method.plays_table:
        return _table_allowance(design)
    own = {name: _given(design, name) for name in QUANTITIES}
    held = {name: own[OPEN[name]] if each is None and name in OPEN else each for name, each in own.items()}
    return {name: math.inf if each is None else each for name, each in held.items()}


def _given(design: Design, quantity: str) -> float | None:
    ramp = design.ramp.shape if quantity.startswith(SHAPE) else design.ramp
    given: float | None = getattr(ramp, quantity.removeprefix(SHAPE))
    return given


def _table_allowance(design: Design) -> Allowance:
    """Return a table's top speed, and the constant accelerations from rest that stay below it and end no sooner."""
    ramp, timer_hz = real_ramp(design), design.timer.frequency_hz

    def steepest(side: NDArray[np.floating]) -> float:
        speeds = timer_hz / np.append(side, ramp.slew)
        return float((speeds**2 / (2 * np.arange(1, speeds.size + 1))).min())

    accelerations = (steepest(np.asarray(side)) for side in (ramp.up, ramp.down))
    return dict(zip(QUANTITIES, (0.0, timer_hz / ramp.slew, *accelerations, math.inf, math.inf), strict=True))


def _stretched(designs: Sequence[Design], leader: int) -> tuple[Design, tuple[Limit, ...]]:
    """Return the design of a leader with a lookup table, its delays made longer as the followers need it."""
    design = designs[leader]
    stretch_for = {axis: _stretch_for(designs, leader, axis) for axis in range(len(designs)) if axis != leader}
    axis = max(stretch_for, key=lambda follower: stretch_for[follower], default=leader)
    # Less than any timer shows comes of rounding, as when both axes have the same table.
    if axis == leader or stretch_for[axis] <= 1 + 1e-12:
        return design, ()
    message = (
        f"{called(designs, axis)} can't follow the table of {called(designs, leader)} at full speed: "
        f"along the line its delays are {stretch_for[axis]:.6g} times as long."
    )
    part = "table" if designs[axis].method.plays_table else "ramp"
    field = f"designs.{axis}.{part}"
    try:
        table = _stretched_table(design, stretch_for[axis])
    except Rejected as error:
        allowed = f"one that slows each delay of {called(designs, leader)} to {error.rejections[0].allowed}"
        raise Rejected([Rejection(field, designs[axis].model_dump()[part], allowed)]) from error
    return design.model_copy(update={"table": table}), (Limit(field, axis, message),)


def _stretched_table(design: Design, factor: float) -> Table:
    """Return a design's table in ticks, all delays so many times as long and rounded to the nearest tick.

    Raises Rejected when one is longer than a table may hold.
    """
    assert design.table is not None
    unit = ticks_from_us(1, design.timer.frequency_hz) if design.table.interval_unit == "us" else 1
    rows = [(index, float(np.floor(delay * unit * factor + 0.5))) for index, delay in design.table.rows]
    return Table.checked({"rows": rows, "interval_unit": "ticks"})


def _stretch_for(designs: Sequence[Design], leader: int, axis: int) -> float:
    """Return how many times as long a leader's intervals have to be, so that a follower is nowhere too fast."""
    n_l, n = steps_of(designs[leader]), steps_of(designs[axis])
    given_s = play(real_ramp(designs[leader]), n_l) / designs[leader].timer.frequency_hz
    with fields_of(axis):
        alone_s = play(real_ramp(designs[axis]), n) / designs[axis].timer.frequency_hz
    # The follower's step that is under way in each interval of the leader: ceil(i n / n_l), here counted from 0.
    under_way = (np.arange(1, n_l + 1) * n - 1) // n_l
    return float((alone_s[under_way] * n / n_l / given_s).max())


def _limit(designs: Sequence[Design], leader: int, allowances: Sequence[Allowance], quantity: str, axis: int) -> Limit:
    own, led = allowances[axis][quantity], allowances[leader][quantity]
    name, unit = QUANTITIES[quantity]
    line = own * steps_of(designs[leader]) / steps_of(designs[axis])
    allowed, played, wanted = told = tuple(
        replace(Told.of(value, unit), axis=of) for value, of in ((own, axis), (line, leader), (led, leader))
    )
    message = (
        f"{called(designs, axis)} allows a {name} of {allowed}: "
        f"along the line that of {called(designs, leader)} is {played} instead of {wanted}."
    )
    return Limit(f"designs.{axis}.{_field_of(designs[axis], quantity)[0]}", axis, message, told)


def _field_of(design: Design, quantity: str) -> tuple[str, object]:
    """Return the field of a design where what it allows can be changed, and what stands there."""
    if design.method.plays_table:
        return "table.rows", design.table and design.table.rows
    name = OPEN.get(quantity, quantity) if _given(design, quantity) is None else quantity
    return f"ramp.{name}", _given(design, name)


def _where_it_is_limited(
    rejection: Rejection, designs: Sequence[Design], leader: int, limiting: Mapping[str, int]
) -> Rejection:
    """Return what is rejected of a line's ramp with the field and the value of the axis that limits it."""
    quantity = rejection.field.removeprefix("ramp.")
    axis = limiting.get(quantity, leader)
    if axis == leader:
        return _at(leader, rejection)
    field, value = _field_of(designs[axis], quantity)
    share = f"{steps_of(designs[leader]):,} steps to {steps_of(designs[axis]):,} of this axis"
    allowed = f"{rejection.allowed}, counted for axis {leader}, which leads the line with {share}"
    return Rejection(f"designs.{axis}.{field}", value, allowed)
