"""Rows of numbers, compiled: an instant, and a level for each column."""

import numpy as np

from stepramp.capture.recording import LATEST_TICKS
from stepramp.numerics.compiled import compiled

POSITION, ROW, LAST_TICKS, FIRST_TICKS, UNKNOWN_LEVELS, PROBLEM, STEP_TICKS, UNEVEN = range(8)
"""What the state of a reading is made of, as indices."""
STATE = 8
FINE, CUT_OFF, BAD_TIME, BAD_LEVEL, BAD_COLUMNS, BACKWARDS, LATE = range(7)
"""What can be wrong with a row."""

_POWERS = 10 ** np.arange(19, dtype=np.int64)
_NEWLINE, _RETURN, _MINUS, _PLUS, _POINT, _ZERO, _ONE, _NINE, _QUOTE, _SPACE, _SMALL_E, _LARGE_E = map(
    ord, '\n\r-+.019" eE'
)
_UNKNOWN = tuple(b"xXzZ")
_MOST_FIGURES = 18
_NONE = 1_000_000
"""An exponent, or a number of decimals, that stands for none at all."""
NO_LEVEL = -2


@compiled
def _is_line_end(letter):  # type: ignore[no-untyped-def]  # compiled
    return letter in (_NEWLINE, _RETURN)


@compiled
def _skip_blank(data, at):  # type: ignore[no-untyped-def]  # compiled
    while at < data.size and (data[at] == _SPACE or data[at] == _QUOTE):
        at += 1
    return at


@compiled
def _mantissa(data, at, comma):  # type: ignore[no-untyped-def]  # compiled
    """Return a decimal number without its point, how many of its figures are behind the point, and where it ends.

    A number of no figures has more behind its point than any other.
    """
    mantissa, figures, decimals, begin, is_behind = np.int64(0), 0, 0, at, False
    while at < data.size:
        letter = data[at]
        if _ZERO <= letter <= _NINE:
            if figures < _MOST_FIGURES:
                mantissa = 10 * mantissa + np.int64(letter) - _ZERO
                figures += 1 if mantissa else 0
                decimals += 1 if is_behind else 0
            elif not is_behind:
                decimals -= 1
        elif letter in (_POINT, comma) and not is_behind:
            is_behind = True
        else:
            break
        at += 1
    return mantissa, decimals if at - begin > is_behind else _NONE, at


@compiled
def _exponent(data, at):  # type: ignore[no-untyped-def]  # compiled
    """Return what stands behind an e, 0 without one, _NONE when it is no number; and where it ends."""
    if at >= data.size or (data[at] != _SMALL_E and data[at] != _LARGE_E):
        return 0, at
    is_negative, at = _sign(data, at + 1)
    value, begin = np.int64(0), at
    while at < data.size and _ZERO <= data[at] <= _NINE:
        if value < _NONE // 10 - 1:
            value = 10 * value + np.int64(data[at]) - _ZERO
        at += 1
    if at == begin:
        return _NONE, at
    return -value if is_negative else value, at


@compiled
def _sign(data, at):  # type: ignore[no-untyped-def]  # compiled
    """Return whether there is a minus, and where it or a plus ends."""
    if at < data.size and (data[at] == _MINUS or data[at] == _PLUS):
        return data[at] == _MINUS, at + 1
    return False, at


@compiled
def _instant(data, at, comma, places):  # type: ignore[no-untyped-def]  # compiled
    """Return a decimal number in units of 10**-places, where it ends, and what is wrong with it."""
    is_negative, at = _sign(data, at)
    mantissa, decimals, at = _mantissa(data, at, comma)
    exponent, at = _exponent(data, at)
    if _NONE in (decimals, exponent):
        return np.int64(0), at, BAD_TIME
    shift = places - decimals + exponent
    if mantissa == 0 or shift < -_MOST_FIGURES:
        return np.int64(0), at, FINE
    if shift > _MOST_FIGURES or (shift > 0 and mantissa > LATEST_TICKS // _POWERS[shift]):
        return np.int64(0), at, LATE
    if shift >= 0:
        mantissa *= _POWERS[shift]
    else:
        mantissa = (mantissa + _POWERS[-shift] // 2) // _POWERS[-shift]
    if mantissa > LATEST_TICKS:
        return np.int64(0), at, LATE
    return -mantissa if is_negative else mantissa, at, FINE


@compiled
def _level(data, at, delimiter):  # type: ignore[no-untyped-def]  # compiled
    """Return a level, -1 for an unknown one and NO_LEVEL for what is none, and where its field ends."""
    at = _skip_blank(data, at)
    level = np.int64(-1)
    if at < data.size and not _is_line_end(data[at]) and data[at] != delimiter:
        letter = data[at]
        if letter in (_ZERO, _ONE):
            level = np.int64(letter) - _ZERO
        elif letter not in _UNKNOWN:
            level = np.int64(NO_LEVEL)
        at = _skip_blank(data, at + 1)
        if at < data.size and not _is_line_end(data[at]) and data[at] != delimiter:
            level = np.int64(NO_LEVEL)
    return level, at


@compiled
def _read_row(data, at, row, now, channels, has_time, delimiter, comma, places):  # type: ignore[no-untyped-def]  # compiled
    """Put the levels of a row into `now`; return its instant, where it ends, and what is wrong with it."""
    instant = row
    if has_time:
        instant, at, problem = _instant(data, _skip_blank(data, at), comma, places)
        at = _skip_blank(data, at)
        if problem != FINE:
            return instant, at, CUT_OFF if at >= data.size and problem == BAD_TIME else problem
    for column in range(channels.size):
        if at >= data.size:
            return instant, at, CUT_OFF
        if has_time or column:
            if data[at] != delimiter:
                return instant, at, BAD_COLUMNS if _is_line_end(data[at]) else BAD_TIME
            at += 1
        if at >= data.size and channels[column] >= 0:
            return instant, at, CUT_OFF
        if channels[column] >= 0:
            now[column], at = _level(data, at, delimiter)
            if now[column] == NO_LEVEL:
                return instant, at, BAD_LEVEL
        while channels[column] < 0 and at < data.size and not _is_line_end(data[at]) and data[at] != delimiter:
            at += 1
    return instant, at, BAD_COLUMNS if at < data.size and not _is_line_end(data[at]) else FINE


@compiled
def _take_levels(now, instant, levels, first_levels, channels, ticks, codes, found):  # type: ignore[no-untyped-def]  # compiled
    """Note where levels change; return how many edges there are then, and how many levels are unknown."""
    unknown = 0
    for column in range(channels.size):
        channel, level = channels[column], now[column]
        if channel < 0:
            continue
        if level < 0:
            unknown += 1
        elif levels[channel] < 0:
            levels[channel] = first_levels[channel] = level
        elif levels[channel] != level:
            levels[channel] = level
            ticks[found], codes[found] = instant, 2 * channel + level
            found += 1
    return found, unknown


@compiled
def read_rows(  # type: ignore[no-untyped-def]  # compiled
    data, state, levels, first_levels, ticks, codes, channels, has_time, delimiter, comma, places
):
    """Read rows until there is no more room for edges, or no row; return how many edges were found.

    state: what is between two calls, by the names above; levels, first_levels: of each channel.
    channels: for each column behind the time the number of its channel, -1 for what is none.
    """
    found, now = 0, np.empty(channels.size, np.int8)
    while found + channels.size <= ticks.size:
        at = state[POSITION]
        while at < data.size and (_is_line_end(data[at]) or data[at] == _SPACE):
            at += 1
        state[POSITION] = at
        if at >= data.size:
            break
        instant, at, problem = _read_row(data, at, state[ROW], now, channels, has_time, delimiter, comma, places)
        if problem == FINE and state[ROW] and instant < state[LAST_TICKS]:
            problem = BACKWARDS
        state[PROBLEM] = problem
        if problem != FINE:
            break
        if state[ROW] == 0:
            state[FIRST_TICKS] = instant
        state[UNEVEN] += state[STEP_TICKS] > 0 and instant % max(state[STEP_TICKS], 1) != 0
        state[LAST_TICKS] = instant
        state[ROW] += 1
        state[POSITION] = at
        found, unknown = _take_levels(now, instant, levels, first_levels, channels, ticks, codes, found)
        state[UNKNOWN_LEVELS] += unknown
    return found
