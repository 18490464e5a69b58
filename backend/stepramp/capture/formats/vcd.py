"""Value change dumps, as sigrok, simulators and many analysers write them."""

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import NoReturn

import numpy as np

from stepramp.capture.formats import vcd_changes
from stepramp.capture.formats.text import as_array, line_at
from stepramp.capture.recording import (
    CUT,
    LATEST_TICKS,
    MOST_CHANNELS,
    UNKNOWN,
    EdgeList,
    FormatName,
    Recording,
    distinct,
    refused_file,
    unknown_remark,
)

_SECTION = re.compile(rb"\$(\w+)\s(.*?)\s?\$end(?=\s|$)", re.DOTALL)
_HEAD_ENDS = re.compile(rb"\$enddefinitions\s+\$end")
_TIMESCALE = re.compile(r"(\d{1,6})\s*(s|ms|us|ns|ps|fs)")
_UNITS = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}
_SINGLE = {"wire", "reg", "tri", "logic", "bit", "supply0", "supply1", "wand", "wor", "tri0", "tri1", "trireg", "port"}
MOST_DECLARED = 100_000
LONGEST_HEAD_BYTES = 2**24


@dataclass(frozen=True)
class _Declared:
    names: list[str]
    """Of the channels."""
    channel_of: dict[bytes, int]
    """By the short name that stands for it."""
    has_others: bool


def is_vcd(beginning: bytes) -> bool:
    """Tell whether a file begins as value change dumps do."""
    return (
        re.match(rb"(META .*\s)*\s*\$(date|version|comment|timescale|scope|var|enddefinitions|attrbegin)\b", beginning)
        is not None
    )


def read_vcd(content: bytes, format_name: FormatName = "vcd") -> Recording:
    """Return what a value change dump has captured: its wires of one bit.

    Raises Rejected for a file that ends before its values, declares no such wire, or has values that can't be read.
    """
    head = _HEAD_ENDS.search(content, 0, LONGEST_HEAD_BYTES)
    if head is None:
        raise refused_file("a VCD file that ends within its declarations", "a whole one, with $enddefinitions")
    sections = _SECTION.findall(content[: head.end()])
    declared = _declared(sections)
    keys = sorted((vcd_changes.key_of(name), channel) for name, channel in declared.channel_of.items())
    key, channels = np.array([each for each, _ in keys], np.int64), np.array([each for _, each in keys], np.int16)
    state = np.zeros(vcd_changes.STATE, np.int64)
    state[vcd_changes.POSITION] = head.end()
    state[vcd_changes.LEVEL_OF_VECTOR] = vcd_changes.NO_LEVEL
    levels, first = np.full((2, len(declared.names)), UNKNOWN, np.int8)
    data, edges = as_array(content), EdgeList()
    read = vcd_changes.read_changes
    edges.fill(lambda: int(read(data, state, levels, first, edges.ticks, edges.codes, key, channels)))
    problem = int(state[vcd_changes.PROBLEM])
    if problem not in (vcd_changes.FINE, vcd_changes.CUT_OFF):
        _refuse_word(content, problem, int(state[vcd_changes.POSITION]))
    others = ("Vectors and numbers are left out: only wires of one bit are read.",) if declared.has_others else ()
    return Recording(
        format=format_name,
        channels=distinct(declared.names),
        first_levels=first,
        edge_ticks=edges.all_ticks(),
        edge_codes=edges.all_codes(),
        begin_ticks=int(state[vcd_changes.FIRST_TICKS]),
        end_ticks=int(state[vcd_changes.TICKS]),
        tick_s=_tick_s(sections),
        remarks=(
            *others,
            *unknown_remark(int(state[vcd_changes.UNKNOWN_LEVELS])),
            *([CUT] if problem == vcd_changes.CUT_OFF else []),
        ),
    )


def _tick_s(sections: list[tuple[bytes, bytes]]) -> Fraction:
    given = next((body for kind, body in sections if kind == b"timescale"), b"").decode("ascii", "replace").strip()
    match = _TIMESCALE.fullmatch(given)
    if match is None or not int(match[1]):
        raise refused_file(f"a timescale of {given!r}", "a whole number and s, ms, us, ns, ps or fs, such as 100 ns")
    return Fraction(int(match[1]), 10 ** _UNITS[match[2]])


def _declared(sections: list[tuple[bytes, bytes]]) -> _Declared:
    names: list[str] = []
    channel_of: dict[bytes, int] = {}
    has_others = False
    for body in [body for kind, body in sections if kind == b"var"][:MOST_DECLARED]:
        words = body.split(None, 3)
        if len(words) < 4:
            raise refused_file(f"$var {body.decode('utf-8', 'replace')}", "$var, a type, a width, a code and a name")
        kind, width, code, name = words
        if len(code) > vcd_changes.MOST_LETTERS:
            raise refused_file(f"a code of {len(code)} letters", f"codes of up to {vcd_changes.MOST_LETTERS} letters")
        if code in channel_of:
            continue
        if width != b"1" or kind.decode("ascii", "replace") not in _SINGLE:
            has_others = True
            channel_of[code] = vcd_changes.NO_CHANNEL
            continue
        channel_of[code] = len(names)
        names.append(name.decode("utf-8", "replace"))
    if not 1 <= len(names) <= MOST_CHANNELS:
        raise refused_file(f"a VCD file of {len(names):,} wires of one bit", f"1 to {MOST_CHANNELS} of them")
    return _Declared(names, channel_of, has_others)


def _refuse_word(content: bytes, problem: int, position: int) -> NoReturn:
    allowed = {
        vcd_changes.BAD_WORD: "a time as #125, or a level of 0, 1, x or z",
        vcd_changes.BAD_TIME: "a time as # and a whole number",
        vcd_changes.BACKWARDS: "times that never go back: at least the one before",
        vcd_changes.UNDECLARED: "codes of wires that were declared",
        vcd_changes.LATE: f"times of at most {LATEST_TICKS:,} ticks",
    }[problem]
    begin = max(content.rfind(b"\n", 0, position), content.rfind(b"\r", 0, position)) + 1
    raise refused_file(line_at(content, begin), allowed)
