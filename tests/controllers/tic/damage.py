"""What is done to bytes on their way."""

from __future__ import annotations

from collections.abc import Callable


def losing(place: int) -> Callable[[bytes], bytes]:
    """Return what loses one byte on the way, the one at a place, counted from now on."""
    left = [place]

    def lose(data: bytes) -> bytes:
        at_byte, left[0] = left[0], left[0] - len(data)
        return data[:at_byte] + data[at_byte + 1 :] if 0 <= at_byte < len(data) else data

    return lose


def flipping(place: int, bit: int) -> Callable[[bytes], bytes]:
    """Return what flips a bit of one byte on the way."""
    left = [place]

    def flip(data: bytes) -> bytes:
        at_byte, left[0] = left[0], left[0] - len(data)
        flipped = bytearray(data)
        if 0 <= at_byte < len(data):
            flipped[at_byte] ^= 1 << bit
        return bytes(flipped)

    return flip
