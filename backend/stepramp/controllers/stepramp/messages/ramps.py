"""Delivering, using, storing and reading ramp images."""

from dataclasses import dataclass
from enum import IntEnum

from stepramp.controllers.stepramp.messages.body import Reply, Request

MOST_DATA = 48
"""Most bytes of a ramp image in one message."""


class ReadSource(IntEnum):
    """What a read reads."""

    STORED = 0
    RAM = 1
    PREVIOUS = 2


@dataclass(frozen=True)
class BeginRequest(Request):
    """Announce a ramp image."""

    KIND = 0x10
    LAYOUT = "<HH"
    length: int
    crc: int


@dataclass(frozen=True)
class DataRequest(Request):
    """A part of the ramp image."""

    KIND = 0x11
    HARMLESS_TWICE = False
    LAYOUT = "<H"
    TAIL = range(1, MOST_DATA + 1)
    offset: int
    data: bytes


@dataclass(frozen=True)
class DataReply(Reply):
    """How much has arrived."""

    LAYOUT = "<H"
    received_bytes: int


@dataclass(frozen=True)
class EndRequest(Request):
    """Let the ramp image be checked."""

    KIND = 0x12


@dataclass(frozen=True)
class EndReply(Reply):
    """The ramp image is sound."""

    LAYOUT = "<BB"
    axes: int
    ramps: int


@dataclass(frozen=True)
class CommitRequest(Request):
    """Store the checked ramp image, or the one on trial, and the settings in use."""

    KIND = 0x13
    HARMLESS_TWICE = False


@dataclass(frozen=True)
class ReadRequest(Request):
    """Ask for a part of a ramp image."""

    KIND = 0x14
    LAYOUT = "<BHB"
    source: int
    offset: int
    length: int


@dataclass(frozen=True)
class ReadReply(Reply):
    """A part of a ramp image."""

    LAYOUT = "<H"
    TAIL = range(MOST_DATA + 1)
    total_bytes: int
    data: bytes


@dataclass(frozen=True)
class TryRequest(Request):
    """Use the checked ramp image from now on, without storing it."""

    KIND = 0x15


@dataclass(frozen=True)
class RollBackRequest(Request):
    """Drop what was delivered or is on trial; when there is nothing of the kind, bring the previous ramp back."""

    KIND = 0x16
    HARMLESS_TWICE = False
