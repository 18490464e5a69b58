"""frame.c against the committed frames, and against this language's own encoder."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.protocol import decode_frame, encode_frame

REFERENCE = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())
messages = st.one_of(
    st.binary(min_size=1, max_size=56), st.lists(st.sampled_from([0, 1, 255]), min_size=1, max_size=56)
)


@pytest.mark.parametrize("case", REFERENCE["frames"], ids=lambda case: case["name"])
def test_reference_frames_both_ways(host: Host, case: dict[str, object]) -> None:
    message = bytes([case["kind"]]) + case["session"].to_bytes(2, "little") + bytes([case["tag"]])
    message += bytes.fromhex(case["body"])
    assert host.ask("frame", case["frame"]) == message.hex()
    assert host.ask("encode", message.hex()) == case["frame"]


@given(message=messages)
def test_any_message_both_ways(host: Host, message: bytes | list[int]) -> None:
    message = bytes(message)
    frame = encode_frame(message)
    assert host.ask("encode", message.hex()) == frame.hex()
    assert host.ask("frame", frame.hex()) == message.hex()
    assert decode_frame(frame) == message


@given(noise=st.binary(max_size=200), message=messages)
def test_noise_then_a_zero_then_a_frame(host: Host, noise: bytes, message: bytes | list[int]) -> None:
    answer = host.ask("frame", (noise + b"\0" + encode_frame(bytes(message))).hex())
    assert answer.split()[-1] == bytes(message).hex()


@given(message=messages, data=st.data())
def test_a_damaged_byte_is_noticed(host: Host, message: bytes | list[int], data: st.DataObject) -> None:
    frame = bytearray(encode_frame(bytes(message)))
    frame[data.draw(st.integers(0, len(frame) - 2))] ^= data.draw(st.integers(1, 255))
    assert host.ask("frame", bytes(frame).hex()) != bytes(message).hex()


@given(length=st.integers(57, 300), fill=st.integers(0, 255))
def test_frames_that_are_too_long_are_dropped(host: Host, length: int, fill: int) -> None:
    body = encode_frame(bytes([fill]) * min(length, 250))
    assert host.ask("frame", body.hex()) == ""


@pytest.mark.parametrize("frame", ["00", "0100", "010100", "02ff00", "03ffff00"])
def test_frames_that_are_too_short_are_dropped(host: Host, frame: str) -> None:
    assert host.ask("frame", frame) == ""
