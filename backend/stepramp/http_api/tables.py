"""Routes for lookup tables: play, check and fit them. They keep nothing."""

import numpy as np
from fastapi import APIRouter

from stepramp.design import MOST_TABLE_ROWS
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import PLANNING
from stepramp.http_api.planned import Planned
from stepramp.http_api.tables_models import (
    CheckAnswer,
    CheckPayload,
    FitAnswer,
    FitCurveAnswer,
    FitCurvePayload,
    FitPayload,
    PlayAnswer,
    PlayPayload,
    RowKind,
    bytes_per_row,
)
from stepramp.ramp.table_check import check_table, mean_acceleration, row_changes
from stepramp.ramp.table_delays import RampDelays, ramp_delays
from stepramp.ramp.table_fit import FittedTable, fit_error, fit_rows, floor_of
from stepramp.ramp.table_fit_linear import fit_linear_error, fit_linear_rows
from stepramp.ramp.table_play import TableMoves, play_table

router = APIRouter(prefix="/table", tags=["lookup tables"], route_class=JsonRoute)


@router.post("/play")
async def play(request: PlayPayload) -> Planned[PlayAnswer]:
    """Play a table as a gauge library does: targets may change in flight; it stops before it reverses."""
    return Planned(PLANNING, lambda: PlayAnswer.of(_played(request)))


@router.post("/check")
@PLANNING.serves
def check(request: CheckPayload) -> CheckAnswer:
    """Check a table: what is wrong with each row, and the acceleration that each row change asks for."""
    return CheckAnswer.of(
        check_table(request.rows, request.slew_interval_us, request.unit),
        row_changes(request.rows, request.unit),
        mean_acceleration(request.rows, request.unit),
    )


@router.post("/fit")
@PLANNING.serves
def fit(request: FitPayload) -> FitAnswer:
    """Fit a table to a ramp: the least error for a number of rows or bytes, or the fewest rows for an error."""
    ramp = ramp_delays(request.design, request.interval_unit, request.fit_to)
    return FitAnswer.of(_fitted(ramp, request), floor_of(ramp), request.row_kind, request.interval_unit)


@router.post("/fit/curve")
@PLANNING.serves
def fit_curve(request: FitCurvePayload) -> FitCurveAnswer:
    """Fit tables of 1 row, 2 rows and so on to a ramp: how much smaller the error gets with each more."""
    ramp = ramp_delays(request.design, request.interval_unit, request.fit_to)
    fitted = [_fitted_rows(ramp, rows, request.row_kind) for rows in range(1, request.most_rows + 1)]
    return FitCurveAnswer.of(fitted, floor_of(ramp), request.row_kind)


def _played(request: PlayPayload) -> TableMoves:
    rows = np.array(request.table.rows, dtype=np.int64)
    at_us = np.array([each.at_us for each in request.targets], dtype=np.int64)
    targets = np.array([each.target for each in request.targets], dtype=np.int64)
    return play_table(rows, request.range_steps, at_us, targets)


def _fitted(ramp: RampDelays, request: FitPayload) -> FittedTable:
    is_linear = request.row_kind == "linear"
    if request.largest_relative_error is not None:
        return (fit_linear_error if is_linear else fit_error)(ramp, request.largest_relative_error)
    rows = min(request.rows or (request.bytes or 0) // bytes_per_row(request.row_kind), MOST_TABLE_ROWS)
    return _fitted_rows(ramp, rows, request.row_kind)


def _fitted_rows(ramp: RampDelays, rows: int, row_kind: RowKind) -> FittedTable:
    return (fit_linear_rows if row_kind == "linear" else fit_rows)(ramp, rows)
