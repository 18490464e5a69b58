"""SwitecX25: a sketch that has it play the design's lookup table."""

import math
from collections.abc import Iterator

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.remark import Remark, quantity
from stepramp.design import Design, Table
from stepramp.errors import Count, Limits, Rejected, Rejection
from stepramp.exports.machines.sheet import Setting, Sheet
from stepramp.exports.machines.sketch import sketch
from stepramp.methods import METHODS
from stepramp.units import MICROSECONDS_PER_SECOND

MOST_ROWS = 256
"""It counts rows in a byte."""
MOST_VALUE = 65_535
"""Of a ramp index, and of a delay [µs]."""
MOST_STEPS = 32_766
"""On an Uno its ways are int."""
USUAL_RANGE_STEPS = 945
"""Of an X25: 315 degrees of 3 steps each."""

Rows = tuple[tuple[int, int], ...]


def switec_x25(design: Design, name: str) -> Sheet:
    """Return a sketch with SwitecX25; raises Rejected when there is no table, or one that it can't hold."""
    if design.table is None:
        allowed = "a table: this design has none to export; one can be fitted to its ramp"
        raise Rejected([Rejection("table", None, allowed)])
    rows = rows_us(design.table, design.timer.frequency_hz)
    _check(design.table, rows, design.move.steps)
    top = rows[-1][0]
    settings = (
        Setting("maxVel", "ramp index", top, str(top)),
        Setting("accelTable", "rows", len(rows), str(len(rows))),
    )
    remarks = tuple(_remarks(design, rows))
    steps = abs(design.move.steps)
    values = {
        "steps": str(steps),
        "range": str(max(USUAL_RANGE_STEPS, steps + 1)),
        "rows": str(len(rows)),
        "lines": "\n".join(f"  {{{last}, {delay}}}," for last, delay in rows),
    }
    return Sheet(sketch("switec_x25.ino", design, name, values, remarks), settings, remarks)


def rows_us(table: Table, timer_hz: float) -> Rows:
    """Return a table's rows with their delays in µs, rounded up: shorter ones would be faster."""
    if table.interval_unit == "us":
        return tuple((last, delay) for last, delay in table.rows)
    return tuple(
        (last, math.ceil(typed(delay) * MICROSECONDS_PER_SECOND / typed(timer_hz))) for last, delay in table.rows
    )


def _check(table: Table, rows: Rows, steps: int) -> None:
    bad = []
    if len(rows) > MOST_ROWS:
        bad.append(Rejection("table.rows", Count(f"{len(rows)} rows"), f"up to {MOST_ROWS} rows with SwitecX25"))
    note = " with SwitecX25, which counts in 16 bits"
    for number, (row, (_, delay_us)) in enumerate(zip(table.rows, rows, strict=True)):
        if row[0] > MOST_VALUE:
            limits = Limits(0, MOST_VALUE, "steps", is_whole=True, note=note)
            bad.append(Rejection.outside(f"table.rows.{number}.0", row[0], limits))
        if delay_us > MOST_VALUE:
            allowed = f"a delay of up to {MOST_VALUE:,} µs{note}"
            bad.append(Rejection(f"table.rows.{number}.1", row[1], allowed))
    if rows[-1][0] < 1:
        limits = Limits(1, MOST_VALUE, "steps", is_whole=True, note=" in the last row, with SwitecX25")
        bad.append(Rejection.outside(f"table.rows.{len(rows) - 1}.0", rows[-1][0], limits))
    if abs(steps) > MOST_STEPS:
        limits = Limits(-MOST_STEPS, MOST_STEPS, "steps", is_whole=True, note=", but not 0, with SwitecX25")
        bad.append(Rejection.outside("move.steps", steps, limits))
    if bad:
        raise Rejected(bad)


def _remarks(design: Design, rows: Rows) -> Iterator[str]:
    method, steps = design.method, abs(design.move.steps)
    if not method.plays_table:
        yield Remark(
            f"The method {METHODS[method.name].label} is not kept, nor are base speed, slew speed and acceleration: "
            "SwitecX25 plays the lookup table, up to ", quantity(1e6 / rows[-1][1], "steps/s", 6), "."
        )  # fmt: skip
    if steps % 2 == 0 and steps < 2 * rows[-1][0] - 1:
        yield (
            f"A move of {steps:,} steps goes one step too far and comes back: SwitecX25 does so with even moves "
            "that are too short for the table's last row."
        )
    elif method.plays_table:
        yield "It plays the table as planned, but for the time in which the sketch comes round to look."
    if design.table is not None and design.table.interval_unit == "ticks":
        yield "Delays of the table are rounded up from ticks to whole µs."
    if design.move.steps < 0:
        yield "A gauge counts from its stop: the move goes up, though the design's goes down."
