"""JSON responses of answers and numpy arrays, without the framework's encoder, which is many times slower.

Arrays are written in slices: while orjson writes, no other thread of this process goes on, not even to answer a stop.
"""

from collections.abc import Iterator, Mapping
from typing import Generic, TypeVar

import numpy as np
import orjson
from starlette.responses import Response

from stepramp.http_api.answer import Answer

A = TypeVar("A")

SLICE = 4096
"""So many values are written at a time, which takes about 0.2 ms."""
PIECE_BYTES = 2**16
"""What is made bit by bit is put together to pieces of at least so many bytes, but for the last."""


class JsonResponse(Response, Generic[A]):
    """An answer, written at once in the thread that makes it."""

    def __init__(self, answer: A, status: int = 200, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(b"".join(json_pieces(answer)), status, headers, media_type="application/json")


def json_bytes(content: object) -> bytes:
    """Return content, which may hold answers, numpy arrays and numbers, as JSON."""
    return orjson.dumps(content, _content, orjson.OPT_SERIALIZE_NUMPY)


def json_pieces(content: object) -> Iterator[bytes]:
    """Yield the same as json_bytes in pieces of some 10,000 bytes."""
    gathered: list[bytes] = []
    size = 0
    for bit in _bits(content):
        gathered.append(bit)
        size += len(bit)
        if size >= PIECE_BYTES:
            yield b"".join(gathered)
            gathered, size = [], 0
    if gathered:
        yield b"".join(gathered)


def _bits(content: object) -> Iterator[bytes]:
    if not _is_long(content):
        yield json_bytes(content)
    elif isinstance(content, Answer):
        yield from _bits(content.content)
    elif isinstance(content, dict):
        for number, (name, value) in enumerate(content.items()):
            yield (b"," if number else b"{") + json_bytes(name) + b":"
            yield from _bits(value)
        yield b"}"
    elif isinstance(content, np.ndarray):
        for begin in range(0, len(content), SLICE):
            yield (b"," if begin else b"[") + json_bytes(content[begin : begin + SLICE])[1:-1]
        yield b"]"
    elif isinstance(content, list | tuple):
        for number, value in enumerate(content):
            yield b"," if number else b"["
            yield from _bits(value)
        yield b"]"


def _is_long(content: object) -> bool:
    return _values(content) > SLICE


def _values(content: object) -> int:
    """Return about how many values are to be written."""
    if isinstance(content, np.ndarray):
        return content.size
    if isinstance(content, Answer):
        return _values(content.content)
    if isinstance(content, dict):
        return sum(map(_values, content.values()), 1)
    if isinstance(content, list | tuple):
        return sum(map(_values, content), 1)
    return 1


def _content(value: object) -> dict[str, object]:
    """Return what stands for a value that JSON doesn't know. Raises TypeError when nothing does."""
    if isinstance(value, Answer):
        return value.content
    raise TypeError(f"{type(value).__name__} is no part of an answer.")
