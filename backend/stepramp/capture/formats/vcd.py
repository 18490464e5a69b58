"""Value change dumps, as sigrok, simulators and many analysers write them."""

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import NoReturn

import numpy as np

from stepramp.capture.formats import vcd_changes
from stepramp.capture.formats.text import LONGEST_LINE_BYTES, as_array, line_number
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
    refused_line,
    unknown_remark,
)
from stepramp.errors import shown

_SECTION = re.compile(rb"\$(\w+)\s(.*?)\s?\$end(?=\s|$)", re.DOTALL)
_HEAD_ENDS = re.compile(rb"\$enddefinitions\s+\$end")
_TIMESCALE = re.compile(r"(\d{1,6})\s*(s|ms|us|ns|ps|fs)")
_UNITS = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}
_SINGLE = {"wire", "reg", "tri", "logic", "bit", "supply0", "supply1", "wand", "wor", "tri0", "tri1", "trireg", "port"}
MOST_DECLARED = 100_000
LONGEST_HEAD_BYTES = 2**24
# Lines of sigrok-cli may stand before. No end of one can be taken for the beginning of another: it is looked at once.
_BEGINNING = re.compile(
    rb"(?:META [^\r\n]*[\r\n]+)*\s*\$(date|version|comment|timescale|scope|var|enddefinitions|attrbegin)\b"
)


@dataclass(frozen=True)
class _Declared:
    names: list[str]
    """Of the channels."""
    channel_of: dict[bytes, int]
    """By the short name that stands for it."""
    has_others: bool


def is_vcd(beginning: bytes) -> bool:
    """Tell whether a file begins as value change dumps do."""
    return _BEGINNING.match(beginning) is not None


def read_vcd(content: bytes, format_name: FormatName = "vcd") -> Recording:
    """Return what a value change dump has captured: its wires of one bit.

    Raises Rejected for a file that ends before its values, declares no such wire, or has values that can't be read.
    """
    head = _HEAD_ENDS.search(content, 0, LONGEST_HEAD_BYTES)
    if head is None:
        raise refused_file(
            "a VCD file that ends within its declarations", "a whole one, with $enddefinitions $end behind them"
        )
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
        _refuse_word(content, problem, int(state[vcd_changes.POSITION]), int(state[vcd_changes.TICKS]))
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
        what = f"a VCD file with the timescale {shown(given)}" if given else "a VCD file without a timescale"
        raise refused_file(what, "one with a whole number of s, ms, us, ns, ps or fs, such as $timescale 100 ns $end")
    return Fraction(int(match[1]), 10 ** _UNITS[match[2]])


def _declared(sections: list[tuple[bytes, bytes]]) -> _Declared:
    names: list[str] = []
    channel_of: dict[bytes, int] = {}
    has_others = False
    for body in [body for kind, body in sections if kind == b"var"][:MOST_DECLARED]:
        words = body.split(None, 3)
        if len(words) < 4:
            what = f"a VCD file with the declaration {shown('$var ' + body.decode('utf-8', 'replace'))}"
            raise refused_file(what, "a type, a width, a code and a name behind each $var")
        kind, width, code, name = words
        if len(code) > vcd_changes.MOST_LETTERS:
            what = f"a VCD file with the code {shown(code.decode('utf-8', 'replace'))} for a wire"
            raise refused_file(what, f"codes of up to {vcd_changes.MOST_LETTERS} letters")
        if code in channel_of:
            continue
        if width != b"1" or kind.decode("ascii", "replace") not in _SINGLE:
            has_others = True
            channel_of[code] = vcd_changes.NO_CHANNEL
            continue
        channel_of[code] = len(names)
        names.append(name.decode("utf-8", "replace"))
    if not 1 <= len(names) <= MOST_CHANNELS:
        what = f"a VCD file with {len(names):,} wires of one bit" if names else "a VCD file without a wire of one bit"
        raise refused_file(what, f"1 to {MOST_CHANNELS} such wires")
    return _Declared(names, channel_of, has_others)


def _refuse_word(content: bytes, problem: int, position: int, before_ticks: int) -> NoReturn:
    word = shown(content[position : position + LONGEST_LINE_BYTES].split(None, 1)[0].decode("utf-8", "replace"))
    what, allowed = {
        vcd_changes.BAD_WORD: (word, "a time such as #125, or a level, 0, 1, x or z, before the code of a wire"),
        vcd_changes.BAD_TIME: (f"the time {word}", "# and a whole number"),
        vcd_changes.BACKWARDS: (f"the time {word}", f"at least #{before_ticks}, since times never go back"),
        vcd_changes.UNDECLARED: (word, "codes that a $var has declared"),
        vcd_changes.LATE: (f"the time {word}", f"at most {LATEST_TICKS:,} ticks"),
    }[problem]
    raise refused_line(line_number(content, position), what, allowed)
