"""Text files as bytes that compiled loops can read: whatever their encoding, ASCII stays ASCII."""

import codecs

import numpy as np
from numpy.typing import NDArray

PIECE_BYTES = 2**20
"""So much is decoded at a time: meanwhile no other thread of this process goes on."""
LONGEST_LINE_BYTES = 2**16
"""So much is looked at of a line that is told of."""

_ENCODINGS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))


def plain(content: bytes) -> bytes:
    """Return a text in UTF-8, or another encoding that has ASCII in it, without a mark at its beginning."""
    for mark, encoding in _ENCODINGS:
        if content.startswith(mark):
            return _decoded(content, len(mark), encoding)
    beginning = content[:64]
    if len(beginning) > 8 and not any(beginning[1::2]) and all(beginning[::2]):
        return _decoded(content, 0, "utf-16-le")
    if len(beginning) > 8 and not any(beginning[::2]) and all(beginning[1::2]):
        return _decoded(content, 0, "utf-16-be")
    return content


def _decoded(content: bytes, begin: int, encoding: str) -> bytes:
    if encoding == "utf-8":
        return content[begin:]
    decoder = codecs.getincrementaldecoder(encoding)("replace")
    pieces = (content[at : at + PIECE_BYTES] for at in range(begin, len(content), PIECE_BYTES))
    return b"".join(decoder.decode(piece).encode("utf-8", "replace") for piece in pieces)


def as_array(content: bytes) -> NDArray[np.uint8]:
    """Return bytes as an array that shares their memory, shape (bytes,)."""
    return np.frombuffer(content, np.uint8)


def line_number(content: bytes, position: int) -> int:
    """Return which line of a text a position is in, counted from 1."""
    before = np.frombuffer(content, np.uint8, position)
    return 1 + (int(np.count_nonzero(before == ord("\n"))) or int(np.count_nonzero(before == ord("\r"))))


def line_from(content: bytes, position: int) -> str:
    """Return a line of a text from a position on."""
    lines = content[position : position + LONGEST_LINE_BYTES].splitlines()
    return lines[0].decode("utf-8", "replace") if lines else ""
