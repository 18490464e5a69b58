"""Routes for lookup tables: play, check and fit them. They keep nothing."""

from typing import Annotated, Literal, Self

import numpy as np
from fastapi import APIRouter
from pydantic import FailFast, Field, model_validator
from starlette.responses import Response

from stepramp.design import MOST_STEPS, MOST_TABLE_ROWS, Design, Row, Table
from stepramp.http_api import table_models as models
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import PLANNING
from stepramp.http_api.planned import Planned
from stepramp.ramp.table_check import MICROSECONDS, DelayUnit, check_table, mean_acceleration, row_changes
from stepramp.ramp.table_delays import RampDelays, ramp_delays
from stepramp.ramp.table_fit import BYTES_PER_ROW, FittedTable, fit_error, fit_rows, floor_of
from stepramp.ramp.table_fit_linear import BYTES_PER_LINEAR_ROW, fit_linear_error, fit_linear_rows
from stepramp.ramp.table_play import TableMoves, play_table
from stepramp.validation import Document, ListOf, OneOf, Within, refuse

router = APIRouter(prefix="/table", tags=["lookup tables"], route_class=JsonRoute)

MOST_TARGETS = 10_000
MOST_CURVE_ROWS = 64
WISHES = ("rows", "largest_relative_error", "bytes")

FitTo = Annotated[
    Annotated[Literal["played", "ramp_index"], OneOf()],
    Field(
        description="What the table is fitted to. played: every step that plays a ramp index as gauge libraries and "
        "the method `table` do, up from index 2 and down to index 0. ramp_index: at index k the interval of step k of "
        "the acceleration, for players that count so",
    ),
]


class TableInMicroseconds(Table):
    """A lookup table whose delays are times."""

    interval_unit: Annotated[Literal["us"], OneOf()] = Field("us", description="Unit of the delays")


class Target(Document):
    """A position that is asked for, and when."""

    at_us: Annotated[int, Within(0, 10**12, "µs")] = Field(description="Instant at which the target is set [µs]")
    target: Annotated[int, Within(-MOST_STEPS, MOST_STEPS, "steps")] = Field(
        description="Position asked for; kept within 0 to range_steps - 1 [steps]"
    )


class PlayRequest(Document):
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
                refuse(f"targets.{number}.at_us", at_us, f"not before the target before it, at {before:,} µs")
        return self


class CheckRequest(Document):
    """A table to be checked; its rows may be in any order."""

    rows: Annotated[list[Row], ListOf("rows of two whole numbers", most=MOST_TABLE_ROWS, least=1)] = Field(
        description="[last ramp index of the row [steps], delay [interval_unit]]"
    )
    interval_unit: Annotated[Literal["us", "ticks"], OneOf()] = Field("us", description="Unit of the delays")
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


class FitRequest(Document):
    """A ramp and the size or the quality of the table that is to stand for it: exactly one of the three."""

    design: Design
    rows: Annotated[int, Within(1, MOST_TABLE_ROWS, "rows")] | None = Field(None, description="Most rows [rows]")
    largest_relative_error: Annotated[float, Within(0.000001, 1)] | None = Field(
        None, description="Largest relative error of a delay: 0.05 is 5 %"
    )
    bytes: Annotated[int, Within(6, 6 * MOST_TABLE_ROWS, "bytes")] | None = Field(
        None, description="Most memory: 4 bytes a row of constant delay, 6 a linear one [bytes]"
    )
    row_kind: Annotated[Literal["constant", "linear"], OneOf()] = Field(
        "constant", description="Rows of constant delay, or rows whose delay changes by a whole number each step"
    )
    interval_unit: Annotated[Literal["us", "ticks"], OneOf()] = Field("us", description="Unit of the delays")
    fit_to: FitTo = "played"

    @model_validator(mode="after")
    def _one_wish(self) -> Self:
        given = [name for name in WISHES if getattr(self, name) is not None]
        if len(given) != 1:
            refuse("rows", self.rows, f"exactly one of {', '.join(WISHES)}; given: {', '.join(given) or 'none'}")
        return self


class FitCurveRequest(Document):
    """A ramp that tables of several sizes are to stand for."""

    design: Design
    most_rows: Annotated[int, Within(1, MOST_CURVE_ROWS, "rows")] = Field(
        32, description="Tables of 1 row to so many are fitted [rows]"
    )
    row_kind: Annotated[Literal["constant", "linear"], OneOf()] = Field(
        "constant", description="Rows of constant delay, or rows whose delay changes by a whole number each step"
    )
    interval_unit: Annotated[Literal["us", "ticks"], OneOf()] = Field("us", description="Unit of the delays")
    fit_to: FitTo = "played"


@router.post("/play", response_model=models.PlayAnswer)
async def play(request: PlayRequest) -> Response:
    """Play a table as a gauge library does: targets may change in flight; it stops before it reverses."""
    return Planned(PLANNING, lambda: models.play_content(_played(request)))


@router.post("/check")
@PLANNING.serves
def check(request: CheckRequest) -> models.CheckAnswer:
    """Check a table: what is wrong with each row, and the acceleration that each row change asks for."""
    return models.check_answer(
        check_table(request.rows, request.slew_interval_us, request.unit),
        row_changes(request.rows, request.unit),
        mean_acceleration(request.rows, request.unit),
    )


@router.post("/fit")
@PLANNING.serves
def fit(request: FitRequest) -> models.FitAnswer:
    """Fit a table to a ramp: the least error for a number of rows or bytes, or the fewest rows for an error."""
    ramp = ramp_delays(request.design, request.interval_unit, request.fit_to)
    return models.fit_answer(_fitted(ramp, request), floor_of(ramp), request.row_kind, request.interval_unit)


@router.post("/fit/curve")
@PLANNING.serves
def fit_curve(request: FitCurveRequest) -> models.FitCurveAnswer:
    """Fit tables of 1 row, 2 rows and so on to a ramp: how much smaller the error gets with each more."""
    ramp = ramp_delays(request.design, request.interval_unit, request.fit_to)
    fitted = [_fitted_rows(ramp, rows, request.row_kind) for rows in range(1, request.most_rows + 1)]
    return models.fit_curve_answer(fitted, floor_of(ramp), request.row_kind)


def _played(request: PlayRequest) -> TableMoves:
    rows = np.array(request.table.rows, dtype=np.int64)
    at_us = np.array([each.at_us for each in request.targets], dtype=np.int64)
    targets = np.array([each.target for each in request.targets], dtype=np.int64)
    return play_table(rows, request.range_steps, at_us, targets)


def _fitted(ramp: RampDelays, request: FitRequest) -> FittedTable:
    is_linear = request.row_kind == "linear"
    if request.largest_relative_error is not None:
        return (fit_linear_error if is_linear else fit_error)(ramp, request.largest_relative_error)
    bytes_per_row = BYTES_PER_LINEAR_ROW if is_linear else BYTES_PER_ROW
    rows = min(request.rows or (request.bytes or 0) // bytes_per_row, MOST_TABLE_ROWS)
    return _fitted_rows(ramp, rows, request.row_kind)


def _fitted_rows(ramp: RampDelays, rows: int, row_kind: Literal["constant", "linear"]) -> FittedTable:
    return (fit_linear_rows if row_kind == "linear" else fit_rows)(ramp, rows)
