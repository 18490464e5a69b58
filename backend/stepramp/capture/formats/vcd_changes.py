"""The changes in a VCD file, compiled."""

import numpy as np

from stepramp.capture.recording import LATEST_TICKS, UNKNOWN
from stepramp.numerics.compiled import compiled

POSITION, TICKS, FIRST_TICKS, IS_TIMED, UNKNOWN_LEVELS, PROBLEM, IN_COMMENT, LEVEL_OF_VECTOR = range(8)
"""What the state of a reading is made of, as indices."""
STATE = 8
FINE, CUT_OFF, BAD_WORD, BAD_TIME, BACKWARDS, UNDECLARED, LATE = range(7)
"""What can be wrong."""

BASE = 95
MOST_LETTERS = 9
"""Letters of the longest name that stands for a channel."""
NO_CHANNEL = -1
UNDECLARED_CHANNEL = -2
NO_LEVEL = -2

_COMMENT = np.frombuffer(b"$comment", np.uint8)
_END = np.frombuffer(b"$end", np.uint8)
_UNKNOWN_LEVELS = tuple(b"xXzZ")
_OF_VECTORS = tuple(b"bBrRsS")
_HASH, _DOLLAR, _ZERO, _ONE, _NINE, _SPACE = map(ord, "#$019 ")


def key_of(name: bytes) -> int:
    """Return a number that stands for a short name of printable letters."""
    key = 0
    for letter in name:
        key = key * BASE + letter - 32
    return key


@compiled
def _key(data, begin, end):  # type: ignore[no-untyped-def]  # compiled
    key = np.int64(0)
    for at in range(begin, min(end, begin + MOST_LETTERS)):
        key = key * BASE + data[at] - 32
    return key


@compiled
def _channel(data, begin, end, keys, channels):  # type: ignore[no-untyped-def]  # compiled
    """Return the channel that a name stands for, NO_CHANNEL for none of ours, UNDECLARED_CHANNEL for none at all."""
    if end == begin or end - begin > MOST_LETTERS:
        return UNDECLARED_CHANNEL
    key = _key(data, begin, end)
    low, high = 0, keys.size
    while low < high:
        middle = (low + high) // 2
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    return np.int64(channels[low]) if low < keys.size and keys[low] == key else UNDECLARED_CHANNEL


@compiled
def _is(data, begin, end, word):  # type: ignore[no-untyped-def]  # compiled
    if end - begin != word.size:
        return False
    return (data[begin:end] == word).all()


@compiled
def _level(letter):  # type: ignore[no-untyped-def]  # compiled
    """Return a level, UNKNOWN, or NO_LEVEL for what is none."""
    if letter in (_ZERO, _ONE):
        return np.int64(letter) - _ZERO
    return UNKNOWN if letter in _UNKNOWN_LEVELS else NO_LEVEL


@compiled
def _time(data, begin, end):  # type: ignore[no-untyped-def]  # compiled
    """Return an instant, and what is wrong with it."""
    ticks = np.int64(0)
    if begin == end:
        return ticks, BAD_TIME
    for at in range(begin, end):
        if not _ZERO <= data[at] <= _NINE:
            return ticks, BAD_TIME
        ticks = 10 * ticks + np.int64(data[at]) - _ZERO
        if ticks > LATEST_TICKS:
            return ticks, LATE
    return ticks, FINE


@compiled
def _read_time(data, begin, end, state):  # type: ignore[no-untyped-def]  # compiled
    """Take the instant that a word tells; return what is wrong with it."""
    instant, problem = _time(data, begin + 1, end)
    if problem == FINE and state[IS_TIMED] and instant < state[TICKS]:
        problem = BACKWARDS
    if problem == FINE:
        if not state[IS_TIMED]:
            state[FIRST_TICKS], state[IS_TIMED] = instant, 1
        state[TICKS] = instant
    return problem


@compiled
def _read_word(data, begin, end, state):  # type: ignore[no-untyped-def]  # compiled
    """Return the level that a word tells, or NO_LEVEL; where the name of its channel begins; and what is wrong."""
    first, level, name, problem = data[begin], NO_LEVEL, begin, FINE
    if state[IN_COMMENT]:
        state[IN_COMMENT] = not _is(data, begin, end, _END)
    elif state[LEVEL_OF_VECTOR] != NO_LEVEL:
        level = state[LEVEL_OF_VECTOR]
        state[LEVEL_OF_VECTOR] = NO_LEVEL
    elif _level(first) != NO_LEVEL:
        level, name = _level(first), begin + 1
    elif first == _HASH:
        problem = _read_time(data, begin, end, state)
    elif first == _DOLLAR:
        state[IN_COMMENT] = _is(data, begin, end, _COMMENT)
    elif first in _OF_VECTORS:
        # Of a vector the last bit, which is all of a vector of one; the word behind it names it.
        state[LEVEL_OF_VECTOR] = max(_level(data[end - 1]), UNKNOWN)
    else:
        problem = BAD_WORD
    return level, name, problem


@compiled
def _take_level(level, channel, state, levels, first_levels, ticks, codes, found):  # type: ignore[no-untyped-def]  # compiled
    """Note a channel's level; return how many edges there are then.

    Simulators call a pin unknown until it first changes: what it is before its first 1 then, is 0.
    """
    if level < 0 and levels[channel] < 0:
        levels[channel] = NO_LEVEL
        return found
    if level == 1 and levels[channel] == NO_LEVEL:
        levels[channel] = first_levels[channel] = 0
    if level < 0:
        state[UNKNOWN_LEVELS] += 1
    elif levels[channel] < 0:
        levels[channel] = first_levels[channel] = level
    elif levels[channel] != level:
        levels[channel] = level
        ticks[found], codes[found] = state[TICKS], 2 * channel + level
        return found + 1
    return found


@compiled
def read_changes(data, state, levels, first_levels, ticks, codes, keys, channels):  # type: ignore[no-untyped-def]  # compiled
    """Read words until there is no more room for edges, or no word; return how many edges were found.

    state: what is between two calls, by the names above. levels, first_levels: of each channel. keys: of the names that
    were declared, increasing; channels: the channel of each, or NO_CHANNEL.
    """
    found = 0
    while state[PROBLEM] == FINE and found < ticks.size:
        begin = state[POSITION]
        while begin < data.size and data[begin] <= _SPACE:
            begin += 1
        end = begin
        while end < data.size and data[end] > _SPACE:
            end += 1
        state[POSITION] = begin
        if begin == end:
            break
        if end == data.size and not _is(data, begin, end, _END):
            state[PROBLEM] = CUT_OFF
            break
        level, name, problem = _read_word(data, begin, end, state)
        channel = NO_CHANNEL if level == NO_LEVEL else _channel(data, name, end, keys, channels)
        state[PROBLEM] = UNDECLARED if channel == UNDECLARED_CHANNEL else problem
        if state[PROBLEM] == FINE:
            state[POSITION] = end
            if channel != NO_CHANNEL:
                found = _take_level(level, channel, state, levels, first_levels, ticks, codes, found)
    return found
