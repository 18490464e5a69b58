"""Design: the document that everything starts from.

A design describes an axis, the timer that steps it, a ramp, the method that computes the ramp, a lookup table and a
move. It is one JSON document (`"schema": "stepramp/2"`) and is validated on every way in.
"""

import math
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from stepramp.drive_train import Drive, Load, Motor, drive_train_of
from stepramp.errors import Change, Choices, Limits, Rejected, Rejection, Told
from stepramp.methods import METHODS, REFERENCE
from stepramp.methods.common.method import RampMethod, TunedFor
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.numbers import Arithmetic
from stepramp.numerics.slope import ShapeParameters
from stepramp.shapes import SHAPES, USUAL_SHAPE
from stepramp.units import DEGREES_PER_REV, LengthUnit
from stepramp.validation import Document, ListOf, NamesUnits, OneOf, Text, UnitNamedBy, Within, is_none, refuse

MOST_STEPS = 10_000_000
"""Longest move and longest ramp [steps]."""

MOST_TABLE_ROWS = 1000

MOST_MICROSTEPS = 1024

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

MOST_ACCELERATION = 1e9
"""[steps/s²]"""

LEAST_JERK = 0.001
"""[steps/s³]"""

MOST_DRAWN_POINTS = 200
FIELDS_OF_PARAMETERS = {
    "jerk": ("jerk_steps_per_s3", "deceleration_jerk_steps_per_s3"),
    "points": ("points",),
    "margin": ("margin",),
}
"""By what a shape takes, the fields of a design's shape that say it; the first one is needed."""
PARAMETERS_IN_WORDS = {
    "jerk": "a jerk [steps/s³]",
    "points": "a list of points",
    "margin": "the part of the motor's torque that is used, such as 0.6",
}

Speed = Annotated[float, Within(SLOWEST_STEPS_PER_S, 1_000_000, "steps/s")]
Acceleration = Annotated[float, Within(LEAST_ACCELERATION, MOST_ACCELERATION, "steps/s²")]


TRAVEL_UNIT = UnitNamedBy("travel_unit", {"mm": "mm", "deg": "degrees"})
DELAY_UNIT = UnitNamedBy("interval_unit", {"us": "µs", "ticks": "ticks"})


class AxisScale(NamesUnits):
    """What one turn of the motor means: for shown units, and for the motor's model where there is a motor."""

    full_steps_per_rev: Annotated[int, Within(1, 100_000, "full steps")] = Field(
        200, description="Full steps of one turn of the motor [full steps]"
    )
    microsteps: Annotated[int, Within(1, MOST_MICROSTEPS, "per step")] = Field(
        1, description="Pulses of the driver for one full step [steps per full step]"
    )
    travel_per_rev: Annotated[float, Within(0.001, 1_000_000, TRAVEL_UNIT)] = Field(
        360.0, description="Distance that the axis covers in one turn of the motor [travel_unit]"
    )
    travel_unit: Literal["mm", "deg"] = Field("deg", description="Unit of the axis' travel")

    @property
    def steps_per_rev(self) -> int:
        """Pulses of the driver for one turn of the motor [steps]."""
        return self.full_steps_per_rev * self.microsteps

    def length_of_step(self, unit: LengthUnit) -> float | None:
        """Return how long a step is [unit]; None in millimetres when the axis' travel isn't known in them."""
        if unit == "steps":
            return 1.0
        lengths_of_turn: dict[LengthUnit, float] = {"rev": 1.0, "deg": DEGREES_PER_REV}
        lengths_of_turn[self.travel_unit] = self.travel_per_rev
        length_of_turn = lengths_of_turn.get(unit)
        return None if length_of_turn is None else length_of_turn / self.steps_per_rev


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

    margin: Annotated[float, Within(0.05, 1)] | None = Field(
        None,
        description="m, of torque: how much of the motor's pull-out torque is used; 0.6 keeps the usual reserve",
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
                what = PARAMETERS_IN_WORDS[parameter]
                refuse(needed, None, Choices.needed(what, "ramp.shape.name", self.name))
        return self

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        for number, ((before, _), (speed, _)) in enumerate(pairwise(self.points or ()), start=1):
            if speed <= before:
                least = Told.of(before, "steps/s", figures=15)
                allowed = f"more than {least}, the speed of the point before"
                refuse(f"points.{number}.0", speed, allowed, told=(least,))
        return self

    def parameters(self, drive_train: DriveTrain | None, *, is_down: bool) -> ShapeParameters:
        """Return what the shape has of its own on the ramp up or down."""
        jerk = self.jerk_steps_per_s3
        if is_down and self.deceleration_jerk_steps_per_s3 is not None:
            jerk = self.deceleration_jerk_steps_per_s3
        return ShapeParameters(
            jerk=math.inf if jerk is None else jerk,
            points=tuple(self.points or ()),
            drive_train=drive_train,
            margin=1.0 if self.margin is None else self.margin,
        )


USUAL_RAMP_SHAPE = RampShape()
"""Left out of documents, so that they stay readable for programs that know of no other."""


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
        USUAL_RAMP_SHAPE,
        description="The usual one is left out of documents",
        exclude_if=lambda shape: shape == USUAL_RAMP_SHAPE,
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
            refuse("arithmetic", self.arithmetic, Choices(tuple(possible), Change("method.name", self.name)))
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
    motor: Motor | None = Field(None, description="The motor; null: nothing is known of it", exclude_if=is_none)
    drive: Drive | None = Field(
        None, description="What drives the motor; null: 24 V and its rated current, as rms", exclude_if=is_none
    )
    load: Load | None = Field(None, description="What the motor moves; null: itself alone", exclude_if=is_none)

    @model_validator(mode="after")
    def _fields_of_the_version(self) -> Self:
        newer = {
            "ramp.shape": self.ramp.shape != USUAL_RAMP_SHAPE,
            "move.plan": self.move.plan != USUAL_PLAN,
            **{name: getattr(self, name) is not None for name in ("motor", "drive", "load")},
        }
        if self.schema_ == "stepramp/1" and any(newer.values()):
            named = " and ".join(field for field, is_there in newer.items() if is_there)
            refuse("schema", self.schema_, f"stepramp/2 for a design with {named}")
        return self

    @model_validator(mode="after")
    def _table_for_table(self) -> Self:
        if self.method.plays_table and self.table is None:
            refuse("table", None, Choices.needed("a table", "method.name", self.method.name))
        return self

    @model_validator(mode="after")
    def _motor_for_torque(self) -> Self:
        if "margin" in SHAPES[self.ramp.shape.name].takes and self.motor is None:
            refuse("motor", None, Choices.needed("a motor", "ramp.shape.name", self.ramp.shape.name))
        return self

    @model_validator(mode="after")
    def _measured_within_reason(self) -> Self:
        if self.motor is not None and self.motor.stalled is not None:
            self._drive_train(self.motor)
        return self

    @property
    def drive_train(self) -> DriveTrain | None:
        """The motor with its drive and its load; None while nothing is known of the motor."""
        if self.motor is None:
            return None
        return self._drive_train(self.motor)

    def _drive_train(self, motor: Motor) -> DriveTrain:
        return drive_train_of(motor, self.drive, self.load, self.axis.steps_per_rev, self.axis.full_steps_per_rev)

    def with_method(self, name: MethodName, arithmetic: Arithmetic | None = None) -> Self:
        """Return the design with another method; with the arithmetic usual for it unless one is given.

        The design's own method keeps its arithmetic. Raises Rejected for what is no method, for an arithmetic that it
        isn't computed in, and when there is no lookup table for one that plays it.
        """
        if name not in tuple(METHODS):
            raise Rejected([Rejection("method.name", name, ", ".join(METHODS))])
        if METHODS[name].sides is None and self.table is None:
            raise Rejected([Rejection("table", None, f"a table, since the method is '{name}'")])
        own = self.method.arithmetic if name == self.method.name else METHODS[name].arithmetics[0]
        changes = {"name": name, "arithmetic": own if arithmetic is None else arithmetic}
        try:
            method = Method.checked(self.method.model_dump() | changes)
        except Rejected as rejected:
            raise Rejected([each.within("method.") for each in rejected.rejections]) from None
        return self.model_copy(update={"method": method})
