"""frame.c against the committed frames, and against this language's own encoder."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware.controller_host import Driver, missing_compiler
from firmware.protocol import crc16, decode_frame, encode_frame
from tools import require

REFERENCE = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())
messages = st.one_of(
    st.binary(min_size=1, max_size=56), st.lists(st.sampled_from([0, 1, 255]), min_size=1, max_size=56)
)


@pytest.fixture(scope="module")
def driver() -> Iterator[Driver]:
    require(*missing_compiler())
    with Driver() as running:
        yield running


@given(data=st.binary(max_size=100))
def test_the_crc_is_the_documented_one(driver: Driver, data: bytes) -> None:
    assert int(driver.ask("crc", data.hex() or "-")) == crc16(data)
    assert int(driver.ask("crc", b"123456789".hex())) == REFERENCE["crc16_of_123456789"] == 0x29B1


@pytest.mark.parametrize("case", REFERENCE["frames"], ids=lambda case: case["name"])
def test_reference_frames_both_ways(driver: Driver, case: dict[str, Any]) -> None:
    message = bytes([case["kind"]]) + case["session"].to_bytes(2, "little") + bytes([case["tag"]])
    message += bytes.fromhex(case["body"])
    assert driver.ask("frame", case["frame"]) == message.hex()
    assert driver.ask("encode", message.hex()) == case["frame"]


@given(message=messages)
def test_any_message_both_ways(driver: Driver, message: bytes | list[int]) -> None:
    message = bytes(message)
    frame = encode_frame(message)
    assert driver.ask("encode", message.hex()) == frame.hex()
    assert driver.ask("frame", frame.hex()) == message.hex()
    assert decode_frame(frame) == message


@given(noise=st.binary(max_size=200), message=messages)
def test_noise_then_a_zero_then_a_frame(driver: Driver, noise: bytes, message: bytes | list[int]) -> None:
    answer = driver.ask("frame", (noise + b"\0" + encode_frame(bytes(message))).hex())
    assert answer.split()[-1] == bytes(message).hex()


@given(message=messages, data=st.data())
def test_a_damaged_byte_is_noticed(driver: Driver, message: bytes | list[int], data: st.DataObject) -> None:
    frame = bytearray(encode_frame(bytes(message)))
    frame[data.draw(st.integers(0, len(frame) - 2))] ^= data.draw(st.integers(1, 255))
    assert driver.ask("frame", bytes(frame).hex()) != bytes(message).hex()


@given(length=st.integers(57, 300), fill=st.integers(0, 255))
def test_frames_that_are_too_long_are_dropped(driver: Driver, length: int, fill: int) -> None:
    body = encode_frame(bytes([fill]) * min(length, 250))
    assert driver.ask("frame", body.hex()) == ""


@pytest.mark.parametrize("frame", ["00", "0100", "010100", "02ff00", "03ffff00"])
def test_frames_that_are_too_short_are_dropped(driver: Driver, frame: str) -> None:
    assert driver.ask("frame", frame) == ""
