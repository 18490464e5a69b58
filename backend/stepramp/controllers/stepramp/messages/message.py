"""Messages: a header, and a body that is still bytes."""

import struct
from dataclasses import dataclass
from typing import Self

REPLY = 0x80
_HEADER = struct.Struct("<BHB")


@dataclass(frozen=True)
class Message:
    """A request, reply or notice with its header; the body still bytes."""

    kind: int
    session: int
    tag: int
    body: bytes = b""

    def pack(self) -> bytes:
        """Return the message as bytes."""
        return _HEADER.pack(self.kind, self.session, self.tag) + self.body

    @classmethod
    def unpack(cls, message: bytes) -> Self | None:
        """Return bytes as a message; None when they are too few for a header."""
        if len(message) < _HEADER.size:
            return None
        kind, session, tag = _HEADER.unpack_from(message)
        return cls(kind, session, tag, message[_HEADER.size :])
