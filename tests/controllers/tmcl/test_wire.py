"""What goes over the wire to a module and back; PyTrinamic's own encoder is asked the same."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytrinamic.tmcl import TMCLReply, TMCLRequest

from stepramp.controllers.tmcl.wire import Command, Reply, Status, reply_of, request, told

INT_32 = st.integers(-(2**31), 2**31 - 1)
BYTE = st.integers(0, 255)


@pytest.mark.parametrize(
    ("frame", "sent"),
    [
        # Examples of the makers' manuals, sections 3.6.1 to 3.6.8.
        (request(Command.SAP, 5, 0, 1000), "01 05 05 00 00 00 03 e8 f6"),
        (request(Command.ROR, 0, 0, 51200), "01 01 00 00 00 00 c8 00 ca"),
        (request(Command.ROL, 0, 0, 51200), "01 02 00 00 00 00 c8 00 cb"),
        (request(Command.MST), "01 03 00 00 00 00 00 00 04"),
        (request(Command.MVP, 0, 0, 90000), "01 04 00 00 00 01 5f 90 f5"),
        (request(Command.MVP, 0, 0, -1000), "01 04 00 00 ff ff fc 18 17"),
        (request(Command.GAP, 0, 0), "01 06 00 00 00 00 00 00 07"),
        (request(Command.STAP, 6, 0), "01 07 06 00 00 00 00 00 0e"),
        (request(Command.RSAP, 6, 0), "01 08 06 00 00 00 00 00 0f"),
    ],
)
def test_commands_as_bytes(frame: bytes, sent: str) -> None:
    assert frame.hex(" ") == sent


@given(st.sampled_from(Command), BYTE, BYTE, INT_32)
def test_commands_are_those_of_pytrinamic(command: Command, kind: int, motor: int, value: int) -> None:
    frame = request(command, kind, motor, value)
    assert frame == TMCLRequest(1, command, kind, motor, value).to_buffer()


@given(BYTE, BYTE, BYTE, BYTE, INT_32)
def test_replies_are_read_as_pytrinamic_writes_them(
    host: int, address: int, status: int, command: int, value: int
) -> None:
    frame = TMCLReply(host, address, status, command, value).to_buffer()
    assert reply_of(frame) == Reply(address, status, command, value)


@given(st.binary(min_size=9, max_size=9), st.integers(0, 8), st.integers(0, 7))
def test_a_bit_that_flipped_is_noticed(frame: bytes, place: int, bit: int) -> None:
    whole = bytearray(frame[:8] + bytes([sum(frame[:8]) % 256]))
    assert reply_of(bytes(whole)) is not None
    whole[place] ^= 1 << bit
    assert reply_of(bytes(whole)) is None


def test_values_beyond_32_bits_are_no_command() -> None:
    with pytest.raises(struct.error):
        request(Command.MVP, 0, 0, 2**31)


def test_what_a_module_refuses_is_told_in_words() -> None:
    assert "EEPROM, is locked" in told(Status.EEPROM_LOCKED)
    assert told(77) == "it answers with status 77"
