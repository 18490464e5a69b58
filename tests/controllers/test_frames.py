import json
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.stepramp.frames import (
    LONGEST_FRAME,
    LONGEST_MESSAGE,
    FrameSplitter,
    crc16,
    decode_frame,
    encode_frame,
)
from stepramp.controllers.stepramp.messages.message import Message

REFERENCE = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())
MESSAGES = st.binary(max_size=LONGEST_MESSAGE)


def test_the_check_value_of_the_crc() -> None:
    assert crc16(b"123456789") == REFERENCE["crc16_of_123456789"] == 0x29B1


@pytest.mark.parametrize("reference", REFERENCE["frames"], ids=lambda each: each["name"])
def test_reference_frames(reference: dict) -> None:
    message = Message(reference["kind"], reference["session"], reference["tag"], bytes.fromhex(reference["body"]))
    frame = bytes.fromhex(reference["frame"])
    assert encode_frame(message.pack()) == frame
    assert Message.unpack(FrameSplitter().feed(frame)[0]) == message


@given(MESSAGES)
def test_a_frame_holds_one_zero_and_comes_back(message: bytes) -> None:
    frame = encode_frame(message)
    assert frame.index(0) == len(frame) - 1 < LONGEST_FRAME
    assert decode_frame(frame[:-1]) == message


def test_a_message_that_is_too_long_is_refused() -> None:
    with pytest.raises(ValueError, match="57 bytes"):
        encode_frame(bytes(LONGEST_MESSAGE + 1))


@given(st.binary(max_size=80))
def test_noise_never_raises(noise: bytes) -> None:
    decode_frame(noise)
    FrameSplitter().feed(noise)


@given(MESSAGES, st.integers(0), st.integers(1, 255))
def test_a_changed_byte_is_noticed(message: bytes, place: int, change: int) -> None:
    frame = bytearray(encode_frame(message)[:-1])
    frame[place % len(frame)] ^= change
    assert decode_frame(bytes(frame)) is None


@given(st.lists(MESSAGES, max_size=5), st.lists(st.integers(0, 300), max_size=10))
def test_messages_come_through_however_the_bytes_are_cut(messages: list[bytes], cuts: list[int]) -> None:
    stream = b"".join(b"\0" + encode_frame(message) for message in messages)
    places = sorted({0, len(stream), *(cut for cut in cuts if cut < len(stream))})
    splitter = FrameSplitter()
    received = [message for start, end in pairwise(places) for message in splitter.feed(stream[start:end])]
    assert received == messages


def test_a_frame_that_is_too_long_is_dropped_with_all_of_it() -> None:
    splitter = FrameSplitter()
    for _ in range(1000):
        assert splitter.feed(b"\x01" * 50) == []
    assert splitter.feed(b"\0" + encode_frame(b"after")) == [b"after"]
