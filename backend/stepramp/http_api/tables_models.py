"""What the routes for lookup tables take and answer."""

from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import FailFast, Field, model_validator

from stepramp.design import MOST_STEPS, MOST_TABLE_ROWS, Design, Row, Table
from stepramp.errors import Limits
from stepramp.http_api.answer import Answer, WholeNumbers
from stepramp.ramp.table_check import MICROSECONDS, DelayUnit, RowChange, RowFinding
from stepramp.ramp.table_fit import BYTES_PER_ROW, FittedTable, Floor
from stepramp.ramp.table_fit_linear import BYTES_PER_LINEAR_ROW
from stepramp.ramp.table_play import TableMoves
from stepramp.validation import Document, ListOf, NamesUnits, Within, refuse

MOST_TARGETS = 10_000
MOST_CURVE_ROWS = 64
WISHES = ("rows", "largest_relative_error", "bytes")

RowKind = Literal["constant", "linear"]
DelayUnitName = Literal["us", "ticks"]

FitTo = Annotated[
    Literal["played", "ramp_index"],
    Field(
        description="What the table is fitted to. played: every step that plays a ramp index as gauge libraries and "
        "the method `table` do, up from index 2 and down to index 0. ramp_index: at index k the interval of step k of "
        "the acceleration, for players that count so",
    ),
]


class TableInMicroseconds(Table):
    """A lookup table whose delays are times."""

    interval_unit: Literal["us"] = Field("us", description="Unit of the delays")


class Target(Document):
    """A position that is asked for, and when."""

    at_us: Annotated[int, Within(0, 10**12, "µs")] = Field(description="Instant at which the target is set [µs]")
    target: Annotated[int, Within(-MOST_STEPS, MOST_STEPS, "steps")] = Field(
        description="Position asked for; kept within 0 to range_steps - 1 [steps]"
    )


class PlayPayload(Document):
    """A table and the targets that it is to be played towards."""

    table: TableInMicroseconds
    range_steps: Annotated[int, Within(1, MOST_STEPS, "steps")] = Field(description="Range of the gauge [steps]")
    targets: Annotated[list[Target], FailFast(), ListOf("targets", most=MOST_TARGETS)] = Field(
        description="Targets in the order in which they are set"
    )

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        for number in range(1, len(self.targets)):
            before, at_us = self.targets[number - 1].at_us, self.targets[number].at_us
            if at_us < before:
                limits = Limits(lowest=before, unit="µs", is_whole=True, note=", when the target before it comes")
                refuse(f"targets.{number}.at_us", at_us, limits)
        return self


class CheckPayload(NamesUnits):
    """A table to be checked; its rows may be in any order."""

    rows: Annotated[list[Row], ListOf("rows of two whole numbers", most=MOST_TABLE_ROWS, least=1)] = Field(
        description="[last ramp index of the row [steps], delay [interval_unit]]"
    )
    interval_unit: DelayUnitName = Field("us", description="Unit of the delays")
    frequency_hz: Annotated[float, Within(1, 10**9, "Hz")] | None = Field(
        None, description="Timer frequency; needed for delays in ticks [Hz]"
    )
    slew_interval_us: Annotated[float, Within(0.001, 10**9, "µs")] | None = Field(
        None, description="Delay of the slew speed that the table should lead to [µs]; null: the end is not judged"
    )

    @model_validator(mode="after")
    def _clock_of_ticks(self) -> Self:
        if self.interval_unit == "ticks" and self.frequency_hz is None:
            refuse("frequency_hz", None, "a timer frequency, since interval_unit is 'ticks'")
        return self

    @property
    def unit(self) -> DelayUnit:
        """The unit of the delays."""
        return (
            DelayUnit("ticks", self.frequency_hz)
            if self.interval_unit == "ticks" and self.frequency_hz
            else MICROSECONDS
        )


class FitPayload(Document):
    """A ramp and the size or the quality of the table that is to stand for it: exactly one of the three."""

    design: Design
    rows: Annotated[int, Within(1, MOST_TABLE_ROWS, "rows")] | None = Field(None, description="Most rows [rows]")
    largest_relative_error: Annotated[float, Within(0.000001, 1)] | None = Field(
        None, description="Largest relative error of a delay: 0.05 is 5 %"
    )
    bytes: Annotated[int, Within(4, 6 * MOST_TABLE_ROWS, "bytes")] | None = Field(
        None, description="Most memory: 4 bytes a row of constant delay, 6 a linear one [bytes]"
    )
    row_kind: RowKind = Field(
        "constant", description="Rows of constant delay, or rows whose delay changes by a whole number each step"
    )
    interval_unit: DelayUnitName = Field("us", description="Unit of the delays")
    fit_to: FitTo = "played"

    @model_validator(mode="after")
    def _one_wish(self) -> Self:
        given = [name for name in WISHES if getattr(self, name) is not None]
        if len(given) != 1:
            refuse("rows", self.rows, f"exactly one of {', '.join(WISHES)}; given: {', '.join(given) or 'none'}")
        least = bytes_per_row(self.row_kind)
        if self.bytes is not None and self.bytes < least:
            note = f": those of one {self.row_kind} row"
            refuse("bytes", self.bytes, Limits(lowest=least, unit="bytes", is_whole=True, note=note))
        return self


class FitCurvePayload(Document):
    """A ramp that tables of several sizes are to stand for."""

    design: Design
    most_rows: Annotated[int, Within(1, MOST_CURVE_ROWS, "rows")] = Field(
        32, description="Tables of 1 row to so many are fitted [rows]"
    )
    row_kind: RowKind = Field(
        "constant", description="Rows of constant delay, or rows whose delay changes by a whole number each step"
    )
    interval_unit: DelayUnitName = Field("us", description="Unit of the delays")
    fit_to: FitTo = "played"


class StepsAnswer(Answer):
    """Steps in order of time, one value a step in each list."""

    at_us: WholeNumbers = Field(description="Instant of the step [µs]")
    position: WholeNumbers = Field(description="Position after the step [steps]")
    direction: WholeNumbers = Field(description="1 up, -1 down")
    ramp_index: WholeNumbers = Field(description="Ramp index after the step [steps]")
    delay_us: WholeNumbers = Field(description="Wait after the step [µs]")


class StopAnswer(Answer):
    """The gauge came to rest."""

    at_us: int = Field(description="Instant at which it is at rest [µs]")
    position: int = Field(description="Where [steps]")


class PlayAnswer(Answer):
    """The moves of a gauge."""

    steps: StepsAnswer
    stops: list[StopAnswer]

    @classmethod
    def of(cls, moves: TableMoves) -> Self:
        """Return moves as an answer."""
        stops = zip(moves.stop_at_us.tolist(), moves.stop_position.tolist(), strict=True)
        return cls(steps=moves, stops=[StopAnswer(at_us=at_us, position=position) for at_us, position in stops])


class FindingAnswer(Answer):
    """Something about a row."""

    row: int = Field(description="Row, counted from 0")
    reason: str
    wrong: bool = Field(description="Whether a gauge can't play the table as it stands")


class RowChangeAnswer(Answer):
    """The jump in speed where a row begins."""

    row: int = Field(description="Row, counted from 0; row 0 begins from rest")
    acceleration_steps_per_s2: float = Field(
        description="(v² - u²) / 2, from the row before's speed u to this row's v within one step [steps/s²]"
    )


class CheckAnswer(Answer):
    """What is to be said about a table."""

    findings: list[FindingAnswer]
    row_changes: list[RowChangeAnswer]
    mean_acceleration_steps_per_s2: float = Field(
        description="What would reach the table's top speed in as many steps, v² / (2 S) [steps/s²]"
    )

    @classmethod
    def of(cls, findings: Sequence[RowFinding], changes: Sequence[RowChange], mean: float) -> Self:
        """Return findings and row changes as an answer."""
        return cls(findings=findings, row_changes=changes, mean_acceleration_steps_per_s2=mean)


class FittedTableAnswer(Answer):
    """A lookup table as a design has it."""

    rows: list[tuple[int, int]] = Field(description="[last ramp index of the row [steps], delay [interval_unit]]")
    interval_unit: DelayUnitName


class FloorAnswer(Answer):
    """What no number of rows can mend: delays are whole, and one ramp index serves steps of different speeds."""

    relative_error: float = Field(description="Largest relative error of a table with a row for each ramp index")
    ramp_index: int = Field(description="The first ramp index that has it [steps]")


class FitAnswer(Answer):
    """The best table, and how good it is."""

    table: FittedTableAnswer | None = Field(description="Rows of constant delay, as a design has them; null for linear")
    linear_rows: list[tuple[int, int, int]] | None = Field(
        description="[last ramp index of the row [steps], delay at its first ramp index, what is added each step "
        "[interval_unit]]; null for rows of constant delay"
    )
    interval_unit: DelayUnitName
    rows: int = Field(description="Rows of the table [rows]")
    bytes: int = Field(description="Memory of the table: 4 bytes a row of constant delay, 6 a linear one [bytes]")
    largest_relative_error: float = Field(description="Largest relative error of a delay: 0.05 is 5 %")
    relative_errors: list[float] = Field(description="Largest relative error of each row")
    floor: FloorAnswer

    @classmethod
    def of(cls, fitted: FittedTable, floor: Floor, row_kind: RowKind, interval_unit: DelayUnitName) -> Self:
        """Return a fitted table as an answer."""
        is_linear, count = row_kind == "linear", len(fitted.rows)
        rows = fitted.rows.tolist()
        return cls(
            table=None if is_linear else FittedTableAnswer(rows=rows, interval_unit=interval_unit),
            linear_rows=rows if is_linear else None,
            interval_unit=interval_unit,
            rows=count,
            bytes=count * bytes_per_row(row_kind),
            largest_relative_error=fitted.largest_relative_error,
            relative_errors=fitted.relative_errors.tolist(),
            floor=floor,
        )


class FitCurveAnswer(Answer):
    """The best tables of several sizes: one value a table in each list, more rows from one to the next."""

    rows: list[int] = Field(description="Rows of the table [rows]")
    bytes: list[int] = Field(description="Memory of the table [bytes]")
    largest_relative_error: list[float] = Field(description="Largest relative error of a delay: 0.05 is 5 %")
    floor: FloorAnswer

    @classmethod
    def of(cls, fitted: Sequence[FittedTable], floor: Floor, row_kind: RowKind) -> Self:
        """Return tables for ever more rows as an answer; where a row more changed nothing, the table is there once."""
        different = {len(table.rows): table.largest_relative_error for table in fitted}
        return cls(
            rows=list(different),
            bytes=[count * bytes_per_row(row_kind) for count in different],
            largest_relative_error=list(different.values()),
            floor=floor,
        )


def bytes_per_row(row_kind: RowKind) -> int:
    """Return how much memory a row takes [bytes]."""
    return BYTES_PER_LINEAR_ROW if row_kind == "linear" else BYTES_PER_ROW
