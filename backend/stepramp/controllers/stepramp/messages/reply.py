"""Replies: how a request went, and what the controller says then."""

import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeVar

from stepramp.controllers.stepramp.messages.body import Reply


class ReplyStatus(IntEnum):
    """How a request went: the first byte of each reply."""

    OK = 0
    UNKNOWN_KIND = 1
    BAD_LENGTH = 2
    STALE_SESSION = 3
    MOVING = 4
    NO_RAMP = 5
    OUT_OF_RANGE = 6
    OUT_OF_ORDER = 7
    BAD_CRC = 8
    BAD_RAMP = 9
    WRITING = 10
    BAD_VERSION = 11
    TOO_FAST = 12
    STOPPED = 13
    AT_LIMIT = 14


@dataclass(frozen=True)
class Refusal:
    """A reply with a status other than ok."""

    status: ReplyStatus
    detail: int = 0


R = TypeVar("R", bound=Reply)


def pack_reply(reply: Reply | Refusal) -> bytes:
    """Return a reply's body, its status included."""
    if isinstance(reply, Refusal):
        return struct.pack("<BH", reply.status, reply.detail)
    return bytes([ReplyStatus.OK]) + reply.pack()


def unpack_reply(reply_type: type[R], body: bytes) -> R | Refusal:
    """Return a reply's body as an object; ValueError for one that makes no sense."""
    if not body:
        raise ValueError("A reply without a status.")
    status = ReplyStatus(body[0])
    if status is ReplyStatus.OK:
        return reply_type.unpack(body[1:])
    if len(body) != 3:
        raise ValueError(f"A refusal of {len(body)} bytes; allowed: 3.")
    return Refusal(status, int.from_bytes(body[1:], "little"))
