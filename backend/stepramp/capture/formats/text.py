"""Text files as bytes that compiled loops can read: whatever their encoding, ASCII stays ASCII."""

import codecs

import numpy as np
from numpy.typing import NDArray

from stepramp.capture.recording import refused_file

PIECE_BYTES = 2**20
"""So much is decoded at a time: meanwhile no other thread of this process goes on."""
LONGEST_SHOWN = 60

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


def line_at(content: bytes, position: int) -> str:
    """Return the line of a text that begins at a position, with its number, as it stands in a message."""
    before = np.frombuffer(content, np.uint8, position)
    newlines = int(np.count_nonzero(before == ord("\n"))) or int(np.count_nonzero(before == ord("\r")))
    text = content[position : position + 4 * LONGEST_SHOWN].decode("utf-8", "replace")
    line = (text.splitlines() or [""])[0][:LONGEST_SHOWN]
    return f"line {newlines + 1:,}: {line}"


def refuse_bytes(content: bytes) -> None:
    """Raise Rejected for what is no text at all."""
    if 0 in content[:4096]:
        raise refused_file("a binary file of no known kind", "a CSV file of Saleae Logic 2 or sigrok, VCD, or .sr")
