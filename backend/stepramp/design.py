"""Design: the document that everything starts from.

A design describes an axis, the timer that steps it, a ramp, the method that computes the ramp, a lookup table and a
move. It is one JSON document (`"schema": "stepramp/2"`) and is validated on every way in.
"""

import math
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from stepramp.errors import Limits, Rejected, Rejection
from stepramp.methods import METHODS, REFERENCE
from stepramp.methods.common.method import RampMethod, TunedFor
from stepramp.numerics.numbers import Arithmetic
from stepramp.numerics.slope import ShapeParameters
from stepramp.shapes import SHAPES, USUAL_SHAPE
from stepramp.units import DEGREES_PER_REV, LengthUnit
from stepramp.validation import Document, ListOf, NamesUnits, OneOf, Text, UnitNamedBy, Within, refuse

MOST_STEPS = 10_000_000
"""Longest move and longest ramp [steps]."""

MOST_TABLE_ROWS = 1000

MOST_NAMES = 20
"""Longest list of methods, or of curves; naming one twice is harmless."""

MethodName = Annotated[str, OneOf(METHODS)]
ShapeName = Annotated[str, OneOf(SHAPES)]
Rounding = Literal["nearest", "floor", "carry"]
Schema = Literal["stepramp/1", "stepramp/2"]

SLOWEST_STEPS_PER_S = 0.001
"""Slower speeds than this are none, except 0: their intervals are beyond all numbers [steps/s]."""

LEAST_ACCELERATION = 0.001
"""[steps/s²]"""

LEAST_JERK = 0.001
"""[steps/s³]"""

MOST_DRAWN_POINTS = 200
FIELDS_OF_PARAMETERS = {"jerk": ("jerk_steps_per_s3", "deceleration_jerk_steps_per_s3"), "points": ("points",)}
"""By what a shape takes, the fields of a design's shape that say it; the first one is needed."""
PARAMETERS_IN_WORDS = {"jerk": "a jerk [steps/s³]", "points": "a list of points"}

Speed = Annotated[float, Within(SLOWEST_STEPS_PER_S, 1_000_000, "steps/s")]
Acceleration = Annotated[float, Within(LEAST_ACCELERATION, 1_000_000_000, "steps/s²")]


TRAVEL_UNIT = UnitNamedBy("travel_unit", {"mm": "mm", "deg": "degrees"})
DELAY_UNIT = UnitNamedBy("interval_unit", {"us": "µs", "ticks": "ticks"})


def is_none(value: object) -> bool:
    """Tell what is left out of documents."""
    return value is None


class AxisScale(NamesUnits):
    """What one turn of the motor means. Only shown units depend on it."""

    full_steps_per_rev: Annotated[int, Within(1, 100_000, "full steps")] = Field(
        200, description="Full steps of one turn of the motor [full steps]"
    )
    microsteps: Annotated[int, Within(1, 1024, "per step")] = Field(
        1, description="Pulses of the driver for one full step [steps per full step]"
    )
    travel_per_rev: Annotated[float, Within(0.001, 1_000_000, TRAVEL_UNIT)] = Field(
        360.0, description="Distance that the axis covers in one turn of the motor [travel_unit]"
    )
    travel_unit: Literal["mm", "deg"] = Field("deg", description="Unit of the axis' travel")

    def length_of_step(self, unit: LengthUnit) -> float | None:
        """Return how long a step is [unit]; None in millimetres when the axis' travel isn't known in them."""
        if unit == "steps":
            return 1.0
        lengths_of_turn: dict[LengthUnit, float] = {"rev": 1.0, "deg": DEGREES_PER_REV}
        lengths_of_turn[self.travel_unit] = self.travel_per_rev
        length_of_turn = lengths_of_turn.get(unit)
        return None if length_of_turn is None else length_of_turn / (self.full_steps_per_rev * self.microsteps)


class Timer(Document):
    """The timer that steps the motor."""

    frequency_hz: Annotated[float, Within(1000, 1_000_000_000, "Hz")] = Field(
        description="F: ticks a second of the step timer [Hz]"
    )
    counter_bits: Annotated[int, Within(8, 64, "bits")] = Field(16, description="Width of the timer's counter [bits]")
    shortest_interval_us: Annotated[float, Within(0.001, 1_000_000, "µs")] = Field(
        20.0, description="Least time that the controller needs between two pulses [µs]"
    )


Jerk = Annotated[float, Within(LEAST_JERK, 1e15, "steps/s³")]
DrawnSpeed = Annotated[float, Within(0, 1_000_000, "steps/s")]
DrawnPart = Annotated[float, Within(0.001, 1, "of the acceleration")]
DrawnPoint = Annotated[
    tuple[DrawnSpeed, DrawnPart],
    ListOf("two numbers, the speed [steps/s] and the part of the acceleration that holds there", length=2),
]


class RampShape(Document):
    """How speed grows along a ramp, whose accelerations are the largest along it."""

    name: ShapeName = Field(
        USUAL_SHAPE, description=". ".join(f"{name}: {shape.summary}" for name, shape in SHAPES.items())
    )
    jerk_steps_per_s3: Jerk | None = Field(
        None,
        description="j, of s_curve: the fastest that the acceleration grows and falls on the ramp up [steps/s³]",
        exclude_if=is_none,
    )
    deceleration_jerk_steps_per_s3: Jerk | None = Field(
        None,
        description="The same on the ramp down, of s_curve [steps/s³]; null: the same as on the ramp up",
        exclude_if=is_none,
    )
    points: Annotated[list[DrawnPoint], ListOf("points", most=MOST_DRAWN_POINTS, least=2)] | None = Field(
        None,
        description="Of drawn: [speed [steps/s], part of the acceleration that holds there], with increasing speeds; "
        "monotone cubic in between, level outside",
        exclude_if=is_none,
    )

    @model_validator(mode="after")
    def _own_fields(self) -> Self:
        takes = SHAPES[self.name].takes
        for parameter, (needed, *others) in FIELDS_OF_PARAMETERS.items():
            for field in (needed, *others):
                if parameter not in takes and getattr(self, field) is not None:
                    owners = " or ".join(repr(name) for name, shape in SHAPES.items() if parameter in shape.takes)
                    refuse(field, getattr(self, field), f"none with ramp.shape.name '{self.name}', it is of {owners}")
            if parameter in takes and getattr(self, needed) is None:
                refuse(needed, None, f"{PARAMETERS_IN_WORDS[parameter]}, since ramp.shape.name is '{self.name}'")
        return self

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        for number, ((before, _), (speed, _)) in enumerate(pairwise(self.points or ()), start=1):
            if speed <= before:
                refuse(f"points.{number}.0", speed, f"more than {before:,.15g} steps/s, the speed of the point before")
        return self

    def parameters(self, *, is_down: bool) -> ShapeParameters:
        """Return what the shape has of its own on the ramp up or down."""
        jerk = self.jerk_steps_per_s3
        if is_down and self.deceleration_jerk_steps_per_s3 is not None:
            jerk = self.deceleration_jerk_steps_per_s3
        return ShapeParameters(math.inf if jerk is None else jerk, tuple(self.points or ()))


class RampParameters(Document):
    """The speeds and accelerations that a ramp is computed from."""

    base_speed_steps_per_s: Annotated[float, Within(0, 1_000_000, "steps/s")] = Field(
        0.0, description="v0: speed at which the ramp begins and ends; 0, or at least 0.001 [steps/s]"
    )
    slew_speed_steps_per_s: Speed = Field(description="v: speed that the ramp leads to [steps/s]")
    acceleration_steps_per_s2: Acceleration = Field(description="a: gain of speed a second [steps/s²]")
    deceleration_steps_per_s2: Acceleration | None = Field(
        None, description="d: loss of speed a second [steps/s²]; null: the same as the acceleration"
    )
    shape: RampShape = Field(
        RampShape(),
        description="The usual one is left out of documents",
        # So that they stay readable for programs that know of no other.
        exclude_if=lambda shape: shape == RampShape(),
    )

    @model_validator(mode="after")
    def _base_below_slew(self) -> Self:
        if 0 < self.base_speed_steps_per_s < SLOWEST_STEPS_PER_S:
            refuse(
                "base_speed_steps_per_s",
                self.base_speed_steps_per_s,
                Limits(SLOWEST_STEPS_PER_S, self.slew_speed_steps_per_s, "steps/s", note=", the slew speed, or 0"),
            )
        if self.base_speed_steps_per_s > self.slew_speed_steps_per_s:
            refuse(
                "base_speed_steps_per_s",
                self.base_speed_steps_per_s,
                Limits(0, self.slew_speed_steps_per_s, "steps/s", note=", the slew speed"),
            )
        return self

    @property
    def slowdown_steps_per_s2(self) -> float:
        """The deceleration that holds, given or not [steps/s²]."""
        given = self.deceleration_steps_per_s2
        return self.acceleration_steps_per_s2 if given is None else given


class Method(Document):
    """How the intervals are computed."""

    name: MethodName = Field(
        REFERENCE, description=". ".join(f"{name}: {method.summary}" for name, method in METHODS.items())
    )
    arithmetic: Arithmetic = Field(
        "float64",
        description="Numbers it is computed in: float32 is what C float gives, operation for operation; fixed the "
        "integers of a controller without floating point",
    )
    rounding: Rounding = Field(
        "nearest",
        description="How an interval becomes whole ticks: to the nearest; down; or down with the remainder carried "
        "into the next interval",
    )
    tuned_for: TunedFor = Field(
        "largest_error",
        description="What `tuned` makes least: the largest relative error of an interval, or the error of the time "
        "that the ramp takes",
    )

    @model_validator(mode="after")
    def _arithmetic_of_the_method(self) -> Self:
        possible = self.numerics.arithmetics
        if self.arithmetic not in possible:
            refuse("arithmetic", self.arithmetic, f"{', '.join(possible)} with method.name '{self.name}'")
        return self

    @property
    def numerics(self) -> RampMethod:
        """What computes the ramp."""
        return METHODS[self.name]

    @property
    def plays_table(self) -> bool:
        """Whether the ramp is not computed, but that of the lookup table."""
        return self.numerics.sides is None


Index = Annotated[int, Within(0, MOST_STEPS, "steps")]
Delay = Annotated[int, Within(1, 2**32 - 1, DELAY_UNIT)]
Row = Annotated[tuple[Index, Delay], ListOf("two whole numbers, the last ramp index [steps] and the delay", length=2)]


class Table(NamesUnits):
    """A lookup table as gauge libraries use it."""

    rows: Annotated[list[Row], ListOf("rows of two whole numbers", most=MOST_TABLE_ROWS, least=1)] = Field(
        description="[last ramp index of the row [steps], delay [interval_unit]]: the delay at ramp index k is that of "
        "the first row whose index is at least k",
    )
    interval_unit: Literal["us", "ticks"] = Field("us", description="Unit of the delays")

    @model_validator(mode="after")
    def _sorted(self) -> Self:
        for number in range(1, len(self.rows)):
            before, index = self.rows[number - 1][0], self.rows[number][0]
            if index <= before:
                if before == MOST_STEPS:
                    why = f", so that row {number + 1} can lie behind it"
                    refuse(f"rows.{number - 1}.0", before, Limits(0, MOST_STEPS - 1, "steps", is_whole=True, note=why))
                why = ": more than the ramp index of the row before"
                refuse(f"rows.{number}.0", index, Limits(before + 1, MOST_STEPS, "steps", is_whole=True, note=why))
        return self


NOT_ZERO = ", but not 0"

MovePlan = Literal["this_move", "any_move"]
USUAL_PLAN: MovePlan = "this_move"
"""Left out of documents, as the usual shape is."""


class Move(Document):
    """The move that the design is shown with."""

    steps: Annotated[int, Within(-MOST_STEPS, MOST_STEPS, "steps", NOT_ZERO)] = Field(
        description="Length of the move, negative for backwards [steps]", json_schema_extra={"not": {"const": 0}}
    )
    plan: MovePlan = Field(
        USUAL_PLAN,
        description="this_move: a move too short for the slew speed is planned to a lower peak, within acceleration "
        "and jerk. any_move: the ramp leads to the slew speed whatever the move, and shorter moves take its slowest "
        "intervals, as a controller plays them",
        exclude_if=lambda plan: plan == USUAL_PLAN,
    )

    @model_validator(mode="after")
    def _moves(self) -> Self:
        if self.steps == 0:
            refuse("steps", 0, Limits(-MOST_STEPS, MOST_STEPS, "steps", is_whole=True, note=NOT_ZERO))
        return self


class Design(Document):
    """The design document, version 2; one of version 1 has the usual shape and plan."""

    schema_: Schema = Field(alias="schema", description="Name and version of the document's format")
    name: Annotated[str, Text(100)] = Field("", description="What people call it")
    axis: AxisScale = AxisScale()
    timer: Timer
    ramp: RampParameters
    method: Method = Method()
    table: Table | None = None
    move: Move

    @model_validator(mode="after")
    def _fields_of_the_version(self) -> Self:
        newer = {"ramp.shape": self.ramp.shape != RampShape(), "move.plan": self.move.plan != USUAL_PLAN}
        if self.schema_ == "stepramp/1" and any(newer.values()):
            named = " and ".join(field for field, is_there in newer.items() if is_there)
            refuse("schema", self.schema_, f"stepramp/2 for a design with {named}")
        return self

    @model_validator(mode="after")
    def _table_for_table(self) -> Self:
        if self.method.plays_table and self.table is None:
            refuse("table", None, f"a table, since method.name is '{self.method.name}'")
        return self

    def with_method(self, name: MethodName, arithmetic: Arithmetic | None = None) -> Self:
        """Return the design with another method; with the arithmetic usual for it unless one is given.

        The design's own method keeps its arithmetic. Raises Rejected when there is no lookup table for one that
        plays it.
        """
        if METHODS[name].sides is None and self.table is None:
            raise Rejected([Rejection("table", None, f"a table, since the method is '{name}'")])
        own = self.method.arithmetic if name == self.method.name else METHODS[name].arithmetics[0]
        changes = {"name": name, "arithmetic": arithmetic or own}
        return self.model_copy(update={"method": self.method.model_copy(update=changes)})
