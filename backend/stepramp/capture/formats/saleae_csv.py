"""Digital data as Saleae Logic 2 exports it: CSV, a time in seconds and a level of each channel for each change."""

import re
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from stepramp.capture.formats.csv_table import Head, head_of, rows_of
from stepramp.capture.recording import CUT, Recording, distinct, refused_file, unknown_remark
from stepramp.errors import shown

PLACES = 12
"""Instants are kept in picoseconds."""
_TIME = re.compile(r"time\s*(?:[\[(]\s*(s|ms|us|µs|\u03bcs|ns)\s*[\])])?", re.IGNORECASE)
_DATE = re.compile(r"\d{4}-\d\d-\d\d")
_UNIT_PLACES = {"s": 0, "ms": 3, "us": 6, "\u03bcs": 6, "ns": 9}
"""By the unit casefolded, which makes the sign for micro the Greek letter."""


def csv_of_steps(channel: str, ticks: NDArray[np.int64], timer_hz: int) -> str:
    """Return steps as such a file: a channel whose every edge is one, at instants in ticks of a timer [Hz].

    They come from `ticks`, shape (steps,), at least one; read again they are the same to half a picosecond.
    """
    instants = [(tick * 10**PLACES + timer_hz // 2) // timer_hz for tick in ticks.tolist()]
    before = [(instants[0], 0)]
    rows = before + [(instant, 1 - number % 2) for number, instant in enumerate(instants)]
    lines = (f"{_seconds(instant)},{level}" for instant, level in rows)
    return "\n".join((f"Time [s],{channel}", *lines, ""))


def _seconds(picoseconds: int) -> str:
    whole, rest = divmod(abs(picoseconds), 10**PLACES)
    return f"{'-' if picoseconds < 0 else ''}{whole}.{rest:0{PLACES}}"


def is_saleae_csv(head: Head) -> bool:
    """Tell whether the first column is a time."""
    return bool(head.titles) and _TIME.fullmatch(head.titles[0]) is not None


def read_saleae_csv(content: bytes) -> Recording:
    """Return what a file of Saleae Logic 2 has captured.

    Raises Rejected for a file that is none, or has rows that can't be read.
    """
    head = head_of(content)
    if head.rows and _DATE.match(head.rows[0][0]):
        raise refused_file(
            f"a CSV file whose times are dates, such as {shown(head.rows[0][0])}",
            "times in seconds: export again from Logic 2 without ISO 8601 timestamps",
        )
    match = _TIME.fullmatch(head.titles[0])
    unit = (match[1] or "s").casefold() if match else "s"
    levels = head.level_columns(1)
    rows = rows_of(content, head, levels, True, PLACES - _UNIT_PLACES[unit], 10**PLACES)
    return Recording(
        format="saleae_csv",
        channels=distinct([head.titles[each] if each < len(head.titles) else "" for each in levels]),
        first_levels=rows.first_levels,
        edge_ticks=rows.ticks,
        edge_codes=rows.codes,
        begin_ticks=rows.first_ticks,
        end_ticks=rows.last_ticks,
        tick_s=Fraction(1, 10**PLACES),
        remarks=head.left_out_remark(1) + unknown_remark(rows.unknown_levels) + ((CUT,) if rows.is_cut_off else ()),
    )
