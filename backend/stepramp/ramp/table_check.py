"""What is wrong with a lookup table, row by row, and the acceleration that it asks for."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from stepramp.design import Row
from stepramp.ramp.table_delays import WIDEST
from stepramp.units import MICROSECONDS_PER_SECOND, speed_from_interval

HARSH = 10
"""A row change is harsh when it asks for so many times the mean acceleration of the table."""


@dataclass(frozen=True)
class RowFinding:
    """Something about a row, counted from 0; `wrong` when the table can't be played as it stands."""

    row: int
    reason: str
    wrong: bool


@dataclass(frozen=True)
class RowChange:
    """The jump in speed where a row begins, counted from 0: row 0 begins from rest."""

    row: int
    acceleration_steps_per_s2: float
    """(v² - u²) / 2, as if the speed changed from the row before's u to this row's v within one step [steps/s²]."""


@dataclass(frozen=True)
class DelayUnit:
    """The unit of a table's delays."""

    name: str
    per_second: float


MICROSECONDS = DelayUnit("µs", MICROSECONDS_PER_SECOND)


def row_changes(rows: Sequence[Row], unit: DelayUnit = MICROSECONDS) -> list[RowChange]:
    """Return the acceleration that each row change asks for; rows with delays above 0."""
    speeds = [0.0] + [speed_from_interval(delay, unit.per_second) for _, delay in rows]
    jumps = [(after**2 - before**2) / 2 for before, after in pairwise(speeds)]
    return [RowChange(number, acceleration) for number, acceleration in enumerate(jumps)]


def mean_acceleration(rows: Sequence[Row], unit: DelayUnit = MICROSECONDS) -> float:
    """Return the acceleration that would reach the table's top speed in as many steps: v² / (2 S) [steps/s²].

    S is the last ramp index before the last row, where the top speed begins, but at least 1; 1 for a table of one row.
    """
    top = speed_from_interval(rows[-1][1], unit.per_second)
    steps = max(1, rows[-2][0]) if len(rows) > 1 else 1
    return top**2 / (2 * steps)


def check_table(
    rows: Sequence[Row], slew_interval_us: float | None = None, unit: DelayUnit = MICROSECONDS
) -> list[RowFinding]:
    """Return what is to be said about a table's rows, in their order; rows with delays above 0.

    slew_interval_us: the delay of the slew speed that the table should lead to [µs]; without it the end is not judged.
    """
    findings = [finding for number in range(len(rows)) for finding in _of_row(rows, number, unit)]
    slew_interval = None if slew_interval_us is None else slew_interval_us * unit.per_second / MICROSECONDS_PER_SECOND
    if slew_interval is not None and rows[-1][1] > slew_interval * 1.5:
        reason = (
            f"the last row is missing: the table ends at {rows[-1][1]:,} {unit.name}, "
            f"far from the {slew_interval:,.0f} {unit.name} of the slew speed"
        )
        findings.append(RowFinding(len(rows) - 1, reason, wrong=False))
    return findings


def _of_row(rows: Sequence[Row], number: int, unit: DelayUnit) -> Iterator[RowFinding]:
    index, delay = rows[number]
    for name, value in (("ramp index", index), ("delay", delay)):
        if value > WIDEST:
            yield RowFinding(number, f"{name} {value:,} is wider than 16 bits, at most {WIDEST:,}", wrong=True)
    if number == 0:
        return
    index_before, delay_before = rows[number - 1]
    if index <= index_before:
        reason = f"ramp index {index:,} does not increase: the row before ends at {index_before:,}"
        yield RowFinding(number, reason, wrong=True)
    if delay > delay_before:
        reason = f"delay {delay:,} {unit.name} rises: the row before has {delay_before:,} {unit.name}"
        yield RowFinding(number, reason, wrong=False)
        return
    acceleration = row_changes(rows, unit)[number].acceleration_steps_per_s2
    mean = mean_acceleration(rows, unit)
    if acceleration > HARSH * mean:
        reason = (
            f"asks for a jump of {acceleration:,.0f} steps/s² within a step; the ramp's mean is {mean:,.0f} steps/s²"
        )
        yield RowFinding(number, reason, wrong=False)
