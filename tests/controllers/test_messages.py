import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.messages import (
    REPLY,
    REQUESTS,
    DataReply,
    DataRequest,
    DoneReply,
    EndReply,
    HelloReply,
    Message,
    MoveReply,
    ReadReply,
    Refusal,
    Reply,
    ReplyStatus,
    StatusReply,
    pack_reply,
    unpack_reply,
)

FRAMES = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())["frames"]
REPLIES: dict[int, type[Reply]] = {
    0x01: HelloReply,
    0x02: StatusReply,
    0x10: DoneReply,
    0x11: DataReply,
    0x12: EndReply,
    0x13: DoneReply,
    0x14: ReadReply,
    0x20: MoveReply,
    0x21: MoveReply,
    0x30: DoneReply,
    0x31: DoneReply,
}
NAMES = {"bytes": "data", "received": "received_bytes", "total": "total_bytes"}


def meant(reference: dict) -> dict:
    """Return what a reference frame means, in the names of the dataclasses."""
    said = {name: value for name, value in reference.get("means", {}).items() if name != "status"}
    if "firmware_version" in said:
        said |= dict(
            zip(("firmware_major", "firmware_minor", "firmware_patch"), said.pop("firmware_version"), strict=True)
        )
    named = {NAMES.get(name, name): value for name, value in said.items()}
    return {name: bytes.fromhex(value) if name == "data" else value for name, value in named.items()}


@pytest.mark.parametrize("reference", [each for each in FRAMES if each["kind"] < REPLY], ids=lambda each: each["name"])
def test_reference_requests(reference: dict) -> None:
    body = bytes.fromhex(reference["body"])
    request = REQUESTS[reference["kind"]].unpack(body)
    assert request.pack() == body
    assert vars(request) == meant(reference)


@pytest.mark.parametrize("reference", [each for each in FRAMES if each["kind"] >= REPLY], ids=lambda each: each["name"])
def test_reference_replies(reference: dict) -> None:
    body = bytes.fromhex(reference["body"])
    reply = unpack_reply(REPLIES[reference["kind"] - REPLY], body)
    assert pack_reply(reply) == body
    status = reference["means"]["status"]
    expected = meant(reference) if status == 0 else {"status": ReplyStatus(status), **meant(reference)}
    assert vars(reply) == expected
    assert isinstance(reply, Refusal) == (status != 0)


@given(st.binary(max_size=60))
def test_bytes_become_a_reply_or_a_value_error(body: bytes) -> None:
    for reply_type in REPLIES.values():
        try:
            reply = unpack_reply(reply_type, body)
        except ValueError:
            continue
        assert pack_reply(reply) == body


@given(st.binary(max_size=60))
def test_bytes_become_a_request_or_a_value_error(body: bytes) -> None:
    for request_type in REQUESTS.values():
        try:
            request = request_type.unpack(body)
        except ValueError:
            continue
        assert request.pack() == body


def test_a_header_that_is_cut_is_no_message() -> None:
    assert Message.unpack(b"\x01\x02\x03") is None


@pytest.mark.parametrize("length", [0, 49])
def test_data_is_1_to_48_bytes_long(length: int) -> None:
    with pytest.raises(ValueError, match="DataRequest"):
        DataRequest.unpack(bytes(2 + length))
