"""CSV as sigrok-cli and PulseView write it: a row for each sample, or, with times, for each that is another."""

import re
from fractions import Fraction

from stepramp.capture.formats.csv_table import Head, head_of, rows_of
from stepramp.capture.recording import CUT, Recording, distinct, refused_file, unknown_remark
from stepramp.errors import shown

_RATE = re.compile(r"(?:;|META)\s*samplerate:\s*(.*)", re.IGNORECASE)
_FREQUENCY = re.compile(r"(\d{1,15}(?:\.\d{1,15})?)\s*([kMG]?)(?:Hz)?")
_CHANNELS = re.compile(r";\s*Channels \(\d+/\d+\):\s*(.*)")
_PREFIX = {"": 1, "k": 1000, "M": 10**6, "G": 10**9}
_SLOWEST_HZ, _FASTEST_HZ = Fraction(1, 1000), 10**12
_UNITS = {"seconds": 1, "milliseconds": 1000, "microseconds": 10**6, "nanoseconds": 10**9, "picoseconds": 10**12}
"""By the title of the column of times, how many of its unit are a second."""


def is_sigrok_csv(head: Head) -> bool:
    """Tell whether a CSV file has what only sigrok writes."""
    says_so = any("libsigrok" in each or _RATE.match(each) for each in head.comments)
    return says_so or "logic" in head.titles or (bool(head.titles) and head.titles[0] in _UNITS)


def read_sigrok_csv(content: bytes) -> Recording:
    """Return what a CSV file of sigrok has captured.

    Raises Rejected for a file that doesn't say how much time passes from row to row, or has rows that can't be read.
    """
    head = head_of(content)
    if head.titles[:1] == ("samples",):
        raise refused_file(
            "a CSV file of sigrok that counts samples in place of times, and leaves some out",
            "one with times or with all samples: export as .sr first, and that as CSV",
        )
    rate = _sample_rate(head)
    has_time = _has_time(head)
    unit = _UNITS.get(head.titles[0]) if has_time and head.titles else None
    if has_time and unit is None:
        unit = _unit_at(rate)
    levels = _level_columns(head, has_time)
    left_out = () if "logic" in head.titles else head.left_out_remark(int(has_time))
    # sigrok counts whole units from sample to sample, 41 ns at 24 MHz: its times run ahead of its own samples.
    step = int(unit / rate) if unit and rate else 0
    rows = rows_of(content, head, levels, has_time, 0, unit or 1, step)
    if has_time and rate and (step == 0 or rows.uneven):
        raise refused_file(
            f"a CSV file of sigrok whose times don't fit its samplerate of {float(rate):,.10g} Hz",
            "times and samplerate as sigrok wrote them, neither of them changed",
        )
    if has_time and rate is None:
        tick_s = Fraction(1, unit or 1)
    elif rate is None:
        raise refused_file(
            "a CSV file of sigrok without times or samplerate",
            "one with times, or with its header, which has the samplerate",
        )
    else:
        tick_s = 1 / rate
    by_step = step or 1
    return Recording(
        format="sigrok_csv",
        channels=distinct(_names(head, levels, has_time)),
        first_levels=rows.first_levels,
        edge_ticks=rows.ticks // by_step,
        edge_codes=rows.codes,
        begin_ticks=rows.first_ticks // by_step,
        end_ticks=rows.last_ticks // by_step,
        tick_s=tick_s,
        sample_rate_hz=rate,
        remarks=left_out + unknown_remark(rows.unknown_levels) + ((CUT,) if rows.is_cut_off else ()),
    )


def _sample_rate(head: Head) -> Fraction | None:
    for comment in head.comments:
        if match := _RATE.match(comment):
            return _frequency(match[1])
    return None


def _frequency(text: str) -> Fraction | None:
    """Return a samplerate [Hz]; None for 0, which is none."""
    written = _FREQUENCY.fullmatch(text.strip())
    rate = Fraction(-1) if written is None else Fraction(written[1]) * _PREFIX[written[2]]
    if rate and not _SLOWEST_HZ <= rate <= _FASTEST_HZ:
        raise refused_file(
            f"a CSV file of sigrok with the samplerate {shown(text)}",
            "as sigrok writes it, from 0.001 Hz to 1000 GHz: a number with a point, and Hz, kHz, MHz or GHz",
        )
    return rate or None


def _has_time(head: Head) -> bool:
    if head.titles:
        return head.titles[0] in _UNITS or head.titles[0] == "Time"
    return any(row[0] not in ("0", "1") for row in head.rows)


def _unit_at(rate: Fraction | None) -> int:
    """Return how many of the unit are a second that sigrok takes for times when it doesn't name it."""
    if rate is None:
        raise refused_file(
            "a CSV file of sigrok with times of an unknown unit", "one with its header, which has the samplerate"
        )
    return 1000 if rate <= 1000 else 10**6 if rate <= 10**6 else 10**9


def _level_columns(head: Head, has_time: bool) -> list[int]:
    if "logic" in head.titles:
        return [each for each, title in enumerate(head.titles) if title == "logic"]
    return head.level_columns(int(has_time))


def _names(head: Head, levels: list[int], has_time: bool) -> list[str]:
    """Return the names of channels: the titles of their columns, or what the comments say."""
    if head.titles and "logic" not in head.titles and head.titles[0] not in _UNITS:
        return [head.titles[each] for each in levels]
    listed = next((match[1] for each in head.comments if (match := _CHANNELS.match(each))), "")
    names = [each.strip() for each in listed.split(",")] if listed else []
    columns = [each - has_time for each in levels]
    return [names[each] if each < len(names) else f"D{each}" for each in columns]
