"""JSON from outside: refused where it could be read in two ways, or could not be told back."""

import json
import math
import re
import sys
from collections import Counter
from collections.abc import Iterator
from typing import Self

import numpy as np

from stepramp.errors import Count, Rejected, Rejection
from stepramp.validation import path_in_words

ONCE = "one value, given once"
WHOLE_TEXT = "text without halves of surrogate pairs"
MOST_VALUES = 40_000
"""No document that is valid has more values: 10,000 targets and a table of 1,000 rows are 33,000. To parse and to free
many more takes long, and no other thread goes on meanwhile: a STOP would wait, and jogs would run out."""

_ESCAPED_SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")
_SURROGATE = re.compile("[\ud800-\udfff]")

_BEGINNINGS = ",[{"
"""Before each value but the first of all stands one of them."""

Place = tuple[str | int, ...]


class _NotFinite(float):
    """A number too large for a double, or a word that is none, which is told as it was written."""

    _written: str

    def __new__(cls, written: str) -> Self:
        number = super().__new__(cls, written)
        number._written = written
        return number

    def __str__(self) -> str:
        return self._written


class _Repeating(dict[str, object]):
    """An object that gives a field more than once; `pairs` are all that it gives."""

    pairs: list[tuple[str, object]]


def why_unreadable(error: ValueError) -> str:
    """Return why a text is no JSON, in words, of what parsed_json raised."""
    if not isinstance(error, json.JSONDecodeError):
        return str(error)
    if not error.doc.strip():
        return "It is empty."
    return f"It can't be read from line {error.lineno}, column {error.colno} on."


def parsed_json(text: str, most_values: int = MOST_VALUES) -> object:
    """Return JSON as objects; ValueError when it is none, is nested too deeply, or has numbers of too many digits.

    Raises Rejected for more values than most_values, before it is parsed. For a field that is given more than
    once: which of its values is meant? And for half a surrogate pair: UTF-8 can't carry it, so nothing that holds it
    could be answered.
    """
    if (count := most_values_in(text)) > most_values:
        raise Rejected([Rejection("document", Count(f"{count:,} values"), f"at most {most_values:,} values")])
    are_repeated = False

    def named(pairs: list[tuple[str, object]]) -> dict[str, object]:
        nonlocal are_repeated
        fields = dict(pairs)
        if len(fields) == len(pairs):
            return fields
        are_repeated = True
        repeating = _Repeating(fields)
        repeating.pairs = pairs
        return repeating

    try:
        content: object = json.loads(
            text,
            object_pairs_hook=named,
            # A call for each number, however long that is: between them other threads go on.
            parse_float=_number,
            parse_int=_whole_number,
            parse_constant=_NotFinite,
        )
    except RecursionError:
        raise ValueError("It is nested too deeply.") from None
    except json.JSONDecodeError:
        raise
    except ValueError:
        raise ValueError(f"It has a number of more than {sys.get_int_max_str_digits():,} digits.") from None
    if are_repeated:
        place, values = next(_repeated(content))
        raise Rejected([Rejection(path_in_words(place), values, ONCE)])
    if _ESCAPED_SURROGATE.search(text) and (half := next(_halves(content), None)) is not None:
        place, value = half
        raise Rejected([Rejection(path_in_words(place), value, WHOLE_TEXT)])
    return content


def most_values_in(text: str) -> int:
    """Return how many values JSON has at most, numbers, texts, lists and objects: as many, unless lists are empty.

    What is counted are commas and opening brackets, outside of texts. Unless there are few anyway, so that most JSON
    costs but a look, it is numpy that counts: other threads go on meanwhile.
    """
    count = 1 + sum(map(text.count, _BEGINNINGS))
    if count <= MOST_VALUES:
        return count
    unescaped = text.replace("\\\\", "").replace('\\"', "")
    codes = np.frombuffer(unescaped.encode("utf-8", "surrogatepass"), np.uint8)
    is_outside = ~np.bitwise_xor.accumulate(codes == ord('"'))
    return 1 + sum(int(np.count_nonzero((codes == ord(each)) & is_outside)) for each in _BEGINNINGS)


def _whole_number(written: str) -> int:
    return int(written)


def _number(written: str) -> float:
    number = float(written)
    return number if math.isfinite(number) else _NotFinite(written)


def _repeated(content: object) -> Iterator[tuple[Place, list[object]]]:
    """Yield where fields are that are given more than once, and their values."""
    for place, value in _all_within(content):
        if isinstance(value, _Repeating):
            times = Counter(name for name, _ in value.pairs)
            for repeated in (name for name in value if times[name] > 1):
                yield (*place, repeated), [each for name, each in value.pairs if name == repeated]


def _halves(content: object) -> Iterator[tuple[Place, str]]:
    """Yield texts with half a surrogate pair, and where they are; of a field's name, where the field is."""
    for place, value in _all_within(content):
        if isinstance(value, str) and _SURROGATE.search(value):
            yield place, value
        elif isinstance(value, dict):
            yield from (((*place, name), name) for name in value if _SURROGATE.search(name))


def _all_within(content: object) -> Iterator[tuple[Place, object]]:
    """Yield a value, and all that is within it, with where it is."""
    waiting: list[tuple[Place, object]] = [((), content)]
    while waiting:
        place, value = waiting.pop()
        yield place, value
        if isinstance(value, dict):
            waiting += [((*place, name), each) for name, each in value.items()]
        elif isinstance(value, list):
            waiting += [((*place, number), each) for number, each in enumerate(value)]
