"""What the routes for lookup tables answer."""

from collections.abc import Sequence
from typing import Any, Literal

from pydantic import BaseModel, Field

from stepramp.ramp.table_check import RowChange, RowFinding
from stepramp.ramp.table_fit import BYTES_PER_ROW, FittedTable, Floor
from stepramp.ramp.table_fit_linear import BYTES_PER_LINEAR_ROW
from stepramp.ramp.table_play import TableMoves


class StepsAnswer(BaseModel):
    """Steps in order of time, one value a step in each list."""

    at_us: list[int] = Field(description="Instant of the step [µs]")
    position: list[int] = Field(description="Position after the step [steps]")
    direction: list[int] = Field(description="1 up, -1 down")
    ramp_index: list[int] = Field(description="Ramp index after the step [steps]")
    delay_us: list[int] = Field(description="Wait after the step [µs]")


class StopAnswer(BaseModel):
    """The gauge came to rest."""

    at_us: int = Field(description="Instant at which it is at rest [µs]")
    position: int = Field(description="Where [steps]")


class PlayAnswer(BaseModel):
    """The moves of a gauge."""

    steps: StepsAnswer
    stops: list[StopAnswer]


class FindingAnswer(BaseModel):
    """Something about a row."""

    row: int = Field(description="Row, counted from 0")
    reason: str
    wrong: bool = Field(description="Whether a gauge can't play the table as it stands")


class RowChangeAnswer(BaseModel):
    """The jump in speed where a row begins."""

    row: int = Field(description="Row, counted from 0; row 0 begins from rest")
    acceleration_steps_per_s2: float = Field(
        description="(v² - u²) / 2, from the row before's speed u to this row's v within one step [steps/s²]"
    )


class CheckAnswer(BaseModel):
    """What is to be said about a table."""

    findings: list[FindingAnswer]
    row_changes: list[RowChangeAnswer]
    mean_acceleration_steps_per_s2: float = Field(
        description="What would reach the table's top speed in as many steps, v² / (2 S) [steps/s²]"
    )


class FittedTableAnswer(BaseModel):
    """A lookup table as a design has it."""

    rows: list[tuple[int, int]] = Field(description="[last ramp index of the row [steps], delay [interval_unit]]")
    interval_unit: Literal["us", "ticks"]


class FloorAnswer(BaseModel):
    """What no number of rows can mend: delays are whole, and one ramp index serves steps of different speeds."""

    relative_error: float = Field(description="Largest relative error of a table with a row for each ramp index")
    ramp_index: int = Field(description="The first ramp index that has it [steps]")


class FitAnswer(BaseModel):
    """The best table, and how good it is."""

    table: FittedTableAnswer | None = Field(description="Rows of constant delay, as a design has them; null for linear")
    linear_rows: list[tuple[int, int, int]] | None = Field(
        description="[last ramp index of the row [steps], delay at its first ramp index, what is added each step "
        "[interval_unit]]; null for rows of constant delay"
    )
    interval_unit: Literal["us", "ticks"]
    rows: int = Field(description="Rows of the table [rows]")
    bytes: int = Field(description="Memory of the table: 4 bytes a row of constant delay, 6 a linear one [bytes]")
    largest_relative_error: float = Field(description="Largest relative error of a delay: 0.05 is 5 %")
    relative_errors: list[float] = Field(description="Largest relative error of each row")
    floor: FloorAnswer


class FitCurveAnswer(BaseModel):
    """The best tables of several sizes: one value a table in each list, more rows from one to the next."""

    rows: list[int] = Field(description="Rows of the table [rows]")
    bytes: list[int] = Field(description="Memory of the table [bytes]")
    largest_relative_error: list[float] = Field(description="Largest relative error of a delay: 0.05 is 5 %")
    floor: FloorAnswer


def play_content(moves: TableMoves) -> dict[str, Any]:
    """Return moves as a PlayAnswer's content."""
    stops = zip(moves.stop_at_us.tolist(), moves.stop_position.tolist(), strict=True)
    return {
        "steps": {name: getattr(moves, name) for name in StepsAnswer.model_fields},
        "stops": [{"at_us": at_us, "position": position} for at_us, position in stops],
    }


def check_answer(findings: Sequence[RowFinding], changes: Sequence[RowChange], mean: float) -> CheckAnswer:
    """Return findings and row changes as an answer."""
    return CheckAnswer(
        findings=[FindingAnswer(**vars(finding)) for finding in findings],
        row_changes=[RowChangeAnswer(**vars(change)) for change in changes],
        mean_acceleration_steps_per_s2=mean,
    )


def fit_answer(
    fitted: FittedTable, floor: Floor, row_kind: Literal["constant", "linear"], interval_unit: Literal["us", "ticks"]
) -> FitAnswer:
    """Return a fitted table as an answer."""
    is_linear, count = row_kind == "linear", len(fitted.rows)
    rows = [tuple(row) for row in fitted.rows.tolist()]
    return FitAnswer(
        table=None if is_linear else FittedTableAnswer(rows=rows, interval_unit=interval_unit),
        linear_rows=rows if is_linear else None,
        interval_unit=interval_unit,
        rows=count,
        bytes=count * _bytes_per_row(row_kind),
        largest_relative_error=fitted.largest_relative_error,
        relative_errors=fitted.relative_errors.tolist(),
        floor=FloorAnswer(**vars(floor)),
    )


def fit_curve_answer(
    fitted: Sequence[FittedTable], floor: Floor, row_kind: Literal["constant", "linear"]
) -> FitCurveAnswer:
    """Return tables for ever more rows as an answer; where a row more changed nothing, the table is there once."""
    different = {len(table.rows): table.largest_relative_error for table in fitted}
    return FitCurveAnswer(
        rows=list(different),
        bytes=[count * _bytes_per_row(row_kind) for count in different],
        largest_relative_error=list(different.values()),
        floor=FloorAnswer(**vars(floor)),
    )


def _bytes_per_row(row_kind: Literal["constant", "linear"]) -> int:
    return BYTES_PER_LINEAR_ROW if row_kind == "linear" else BYTES_PER_ROW
