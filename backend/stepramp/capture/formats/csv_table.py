"""CSV files of levels: what stands before their rows, and the edges in them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from stepramp.capture.formats import csv_rows
from stepramp.capture.formats.text import as_array, line_from, line_number
from stepramp.capture.recording import (
    LATEST_TICKS,
    MOST_CHANNELS,
    UNKNOWN,
    EdgeList,
    refused_file,
    refused_line,
)
from stepramp.errors import shown

COMMENTS = (";", "META ")
"""How lines begin that stand before the rows: sigrok-cli also writes what it was told of its input."""
LONGEST_HEAD_BYTES = 2**16
LOOKED_AT_ROWS = 100
"""So many rows tell which columns are levels."""
_LEVELS = {"0", "1", "x", "X", "z", "Z", ""}
_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
_BROKEN_NUMBER = re.compile(r"[-+]?\d*[.,]\d*([eE][-+]?\d+)?")
_NUMBER = re.compile(r"[-+]?\d+([.,]\d*)?([eE][-+]?\d+)?")


@dataclass(frozen=True)
class Head:
    """What stands before the rows of a CSV file, and its first rows."""

    comments: tuple[str, ...]
    titles: tuple[str, ...]
    """Of the columns, as many as the first row has; none without a line of titles."""
    delimiter: str
    rows_begin: int
    rows: tuple[tuple[str, ...], ...]
    """The first rows."""
    row_lines: tuple[int, ...] = ()
    """Which lines of the file these are, counted from 1."""

    @property
    def width(self) -> int:
        """How many columns there are."""
        return len(self.rows[0]) if self.rows else len(self.titles)

    def level_columns(self, begin: int) -> list[int]:
        """Return the columns from `begin` on that hold levels in most of the first rows, and no broken number.

        So a level that is none is refused with its line, wherever it stands; what was measured in volts is left out.
        """
        return [each for each in range(begin, self.width) if self._holds_levels(each)]

    def _holds_levels(self, column: int) -> bool:
        fields = [row[column] for row in self.rows if column < len(row)]
        odd = [field for field in fields if field not in _LEVELS]
        return 2 * len(odd) < len(fields) and not any(_BROKEN_NUMBER.fullmatch(field) for field in odd)

    def left_out_remark(self, begin: int) -> tuple[str, ...]:
        """Return what to say of the columns from `begin` on that hold something else than levels, and where."""
        odd = [(each, self._first_odd(each)) for each in range(begin, self.width)]
        told = [f"{self._title(column)} ({shown(where[1])} in line {where[0]:,})" for column, where in odd if where]
        return (f"Left out, since they hold no levels: {', '.join(told)}.",) if told else ()

    def _first_odd(self, column: int) -> tuple[int, str] | None:
        fields = ((line, row[column]) for line, row in zip(self.row_lines, self.rows, strict=True) if column < len(row))
        return next(((line, field) for line, field in fields if field not in _LEVELS), None)

    def _title(self, column: int) -> str:
        return self.titles[column] if column < len(self.titles) else f"column {column + 1}"


@dataclass(frozen=True)
class Rows:
    """The edges in the rows of a CSV file; see Recording."""

    first_levels: NDArray[np.int8]
    ticks: NDArray[np.int64]
    codes: NDArray[np.uint8]
    first_ticks: int
    last_ticks: int
    count: int
    unknown_levels: int
    uneven: int
    """How many instants are no multiples of what they were to be multiples of."""
    is_cut_off: bool


def head_of(content: bytes) -> Head:
    """Return what stands before the rows of a CSV file, whatever its line ends and delimiter."""
    lines = _LINE.findall(content[:LONGEST_HEAD_BYTES].decode("utf-8", "replace"))
    if len(content) > LONGEST_HEAD_BYTES:
        lines.pop()
    comments, place, titles = [], 0, ""
    while lines and (lines[0].startswith(COMMENTS) or not lines[0].strip()):
        comments.append(lines.pop(0).strip())
        # Not the decoded line's own length: it may hold bytes of another encoding.
        place = _after_line(content, place)
    delimiter = _delimiter(lines[0]) if lines else ","
    if lines and not _is_row(lines[0], delimiter):
        titles = lines.pop(0)
        place = _after_line(content, place)
    first_line = 1 + len(comments) + bool(titles)
    numbered = [(number, line) for number, line in enumerate(lines[:LOOKED_AT_ROWS], first_line) if line.strip()]
    rows = tuple(_fields(line, delimiter) for _, line in numbered)
    row_lines = tuple(number for number, _ in numbered)
    return Head(tuple(comments), _fields(titles, delimiter) if titles else (), delimiter, place, rows, row_lines)


def rows_of(
    content: bytes,
    head: Head,
    levels: Sequence[int],
    has_time: bool,
    places: int,
    ticks_per_s: int,
    step_ticks: int = 0,
) -> Rows:
    """Return the edges in the rows of a CSV file.

    levels: the columns that hold levels. places: an instant is told in 10**-places of the unit that the file has; its
    rows are the instants when it has none. ticks_per_s: how many of these are a second. step_ticks: what instants are
    to be multiples of; 0: of nothing.

    Raises Rejected for a row that is none, or too early, and for too many channels or edges.
    """
    if head.titles and len(head.titles) != head.width:
        titles = shown(head.delimiter.join(head.titles))
        raise refused_file(
            f"a CSV file with {len(head.titles)} titles, {titles}, for {head.width} columns", "a title for each column"
        )
    if not 1 <= len(levels) <= MOST_CHANNELS:
        _refuse_columns(head, len(levels), has_time)
    channels = np.full(head.width - has_time, -1, np.int16)
    channels[np.array(levels) - has_time] = np.arange(len(levels))
    state = np.zeros(csv_rows.STATE, np.int64)
    state[csv_rows.POSITION], state[csv_rows.STEP_TICKS] = head.rows_begin, step_ticks
    known, first = np.full((2, len(levels)), UNKNOWN, np.int8)
    comma = ord("," if head.delimiter != "," else ".")
    data, edges = as_array(content), EdgeList()
    layout = (channels, has_time, ord(head.delimiter), comma, places)
    edges.fill(lambda: int(csv_rows.read_rows(data, state, known, first, edges.ticks, edges.codes, *layout)))
    problem = int(state[csv_rows.PROBLEM])
    if problem not in (csv_rows.FINE, csv_rows.CUT_OFF):
        _refuse_row(content, head, levels, problem, int(state[csv_rows.POSITION]), LATEST_TICKS // ticks_per_s)
    return Rows(
        first,
        edges.all_ticks(),
        edges.all_codes(),
        int(state[csv_rows.FIRST_TICKS]),
        int(state[csv_rows.LAST_TICKS]),
        int(state[csv_rows.ROW]),
        int(state[csv_rows.UNKNOWN_LEVELS]),
        int(state[csv_rows.UNEVEN]),
        problem == csv_rows.CUT_OFF,
    )


def _refuse_columns(head: Head, count: int, has_time: bool) -> NoReturn:
    """Refuse a file of too many columns of levels, or of none: then tell of a row that has something else in them."""
    what = f"a CSV file with {count} columns of levels"
    if not count:
        odd = (row for row in head.rows if any(each not in _LEVELS for each in row[has_time:]))
        what = f"a CSV file without a column of levels: it has {shown(head.delimiter.join(next(odd, head.titles)))}"
    raise refused_file(what, f"1 to {MOST_CHANNELS} such columns, of 0 and 1, or X where a level is unknown")


def _refuse_row(
    content: bytes, head: Head, levels: Sequence[int], problem: int, position: int, latest_s: int
) -> NoReturn:
    line = line_from(content, position)
    fields = _fields(line, head.delimiter)
    level = next((fields[each] for each in levels if each < len(fields) and fields[each] not in _LEVELS), line)
    time = f"the time {shown(fields[0])}"
    what, allowed = {
        csv_rows.BAD_TIME: (time, "a number, such as 0.000125"),
        csv_rows.BAD_LEVEL: (f"the level {shown(level)}", "0, 1, or X where it is unknown"),
        csv_rows.BAD_COLUMNS: (
            f"{line.count(head.delimiter) + 1} columns",
            f"{head.width}, as the first row has",
        ),
        csv_rows.BACKWARDS: (time, "at least that of the row before, since times never go back"),
        csv_rows.LATE: (time, f"from -{latest_s:,} to {latest_s:,} s"),
    }[problem]
    raise refused_line(line_number(content, position), what, allowed)


def _delimiter(line: str) -> str:
    outside = re.sub(r'"[^"]*"', "", line)
    return next((each for each in ("\t", ";") if each in outside), ",")


def _fields(line: str, delimiter: str) -> tuple[str, ...]:
    pattern = rf'"[^"]*"|[^{re.escape(delimiter)}"]+|{re.escape(delimiter)}'
    fields = [""]
    for part in re.findall(pattern, line.strip("\r\n")):
        if part == delimiter:
            fields.append("")
        else:
            fields[-1] += part.strip('"')
    return tuple(each.strip() for each in fields)


def _is_row(line: str, delimiter: str) -> bool:
    fields = _fields(line, delimiter)
    return bool(_NUMBER.fullmatch(fields[0])) and all(each in _LEVELS or _NUMBER.fullmatch(each) for each in fields[1:])


def _after_line(content: bytes, begin: int) -> int:
    found = re.compile(rb"\r\n|\r|\n").search(content, begin)
    return len(content) if found is None else found.end()
