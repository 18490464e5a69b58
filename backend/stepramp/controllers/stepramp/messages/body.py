"""Bodies of messages as objects, and as bytes.

Each body is a dataclass whose fields stand in the order of its layout; a body of no fixed length ends in a field that
holds as many items as there are.
"""

import struct
from dataclasses import dataclass, fields
from typing import ClassVar, Self


@dataclass(frozen=True)
class Body:
    """What follows the header."""

    LAYOUT: ClassVar[str] = "<"
    """Of all fields, as `struct` has it; without the last one when that has no fixed length."""
    TUPLES: ClassVar[dict[str, int]] = {}
    """Fields that hold several values of the layout, and how many."""
    TAIL: ClassVar[range] = range(1)
    """How many items the last field may hold when it has no fixed length."""
    EACH: ClassVar[str] = "B"
    """Layout of one of these items; bytes are a field of type bytes."""

    def pack(self) -> bytes:
        """Return the body as bytes."""
        values = [getattr(self, field.name) for field in fields(self)]
        tail = values.pop() if len(self.TAIL) > 1 else ()
        flat = [each for value in values for each in (value if isinstance(value, tuple) else (value,))]
        items = (item if isinstance(item, tuple) else (item,) for item in tail)
        return struct.pack(self.LAYOUT, *flat) + b"".join(struct.pack("<" + self.EACH, *item) for item in items)

    @classmethod
    def unpack(cls, data: bytes) -> Self:
        """Return bytes as a body; ValueError when their number is wrong."""
        size = struct.calcsize(cls.LAYOUT)
        count, left = divmod(len(data) - size, struct.calcsize("<" + cls.EACH))
        if left or count not in cls.TAIL:
            raise ValueError(f"{cls.__name__} of {len(data)} bytes; allowed: from {size + cls.TAIL[0]}.")
        flat = list(struct.unpack_from(cls.LAYOUT, data))
        named: dict[str, object] = {}
        for field in fields(cls)[: -1 if len(cls.TAIL) > 1 else None]:
            many = cls.TUPLES.get(field.name)
            named[field.name] = flat.pop(0) if many is None else tuple(flat.pop(0) for _ in range(many))
        if len(cls.TAIL) > 1:
            named[fields(cls)[-1].name] = cls._items(data[size:])
        return cls(**named)

    @classmethod
    def _items(cls, tail: bytes) -> object:
        if cls.EACH == "B":
            return tail
        items = struct.iter_unpack("<" + cls.EACH, tail)
        return tuple(item if len(item) > 1 else item[0] for item in items)


class Request(Body):
    """The body of a request."""

    KIND: ClassVar[int]
    HARMLESS_TWICE: ClassVar[bool] = True
    """Whether it may be carried out a second time without harm, or can't be."""


class Reply(Body):
    """The body of a reply, after its status."""


class Notice(Body):
    """The body of a frame that nobody asked for."""

    KIND: ClassVar[int]


@dataclass(frozen=True)
class DoneReply(Reply):
    """Done, or begun: the reply to requests that ask for nothing back."""
