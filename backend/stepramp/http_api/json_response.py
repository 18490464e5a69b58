"""JSON responses of answers and numpy arrays, without the framework's encoder, which is many times slower.

Arrays are written in slices: while orjson writes, no other thread of this process goes on, not even to answer a stop.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
import orjson
from starlette.responses import Response

from stepramp.http_api.answer import Answer

A = TypeVar("A")
_Parts = dict[str, object] | list[object]

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
    for bit in _bits(_measured(content)[0]):
        gathered.append(bit)
        size += len(bit)
        if size >= PIECE_BYTES:
            yield b"".join(gathered)
            gathered, size = [], 0
    if gathered:
        yield b"".join(gathered)


@dataclass(frozen=True)
class _Long:
    """What has so many values that its parts are written one after the other."""

    parts: _Parts


def _measured(content: object) -> tuple[object, int]:
    """Return content with its answers as dictionaries and what is long as such, and about how many values it has."""
    if isinstance(content, np.ndarray):
        return content, content.size
    if isinstance(content, Answer):
        content = content.content
    if isinstance(content, dict):
        fields = {name: _measured(value) for name, value in content.items()}
        parts: _Parts = {name: part for name, (part, _) in fields.items()}
        count = sum(size for _, size in fields.values())
    elif isinstance(content, list | tuple):
        items = [_measured(value) for value in content]
        parts = [part for part, _ in items]
        count = sum(size for _, size in items)
    else:
        return content, 1
    return (_Long(parts) if count >= SLICE else parts), 1 + count


def _bits(content: object) -> Iterator[bytes]:
    if isinstance(content, np.ndarray) and content.size > SLICE:
        for begin in range(0, len(content), SLICE):
            yield (b"," if begin else b"[") + json_bytes(content[begin : begin + SLICE])[1:-1]
        yield b"]"
    elif not isinstance(content, _Long):
        yield json_bytes(content)
    elif isinstance(content.parts, dict):
        for number, (name, value) in enumerate(content.parts.items()):
            yield (b"," if number else b"{") + json_bytes(name) + b":"
            yield from _bits(value)
        yield b"}"
    else:
        for number, value in enumerate(content.parts):
            yield b"," if number else b"["
            yield from _bits(value)
        yield b"]"


def _content(value: object) -> dict[str, object]:
    """Return what stands for a value that JSON doesn't know. Raises TypeError when nothing does."""
    if isinstance(value, Answer):
        return value.content
    raise TypeError(f"{type(value).__name__} is no part of an answer.")
