import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.stepramp.messages.axes import axes_of, mask_of
from stepramp.controllers.stepramp.messages.body import DoneReply, Reply
from stepramp.controllers.stepramp.messages.kinds import NOTICE_KINDS, REQUESTS, unpack_notice
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.motion import (
    AcknowledgeRequest,
    HaltRequest,
    HomeRequest,
    LineRequest,
    MoveByRequest,
    TargetsReply,
)
from stepramp.controllers.stepramp.messages.ramps import DataReply, DataRequest, EndReply, ReadReply
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus, pack_reply, unpack_reply
from stepramp.controllers.stepramp.messages.report import ReportNotice
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.messages.settings import LimitsReply, SettingsReply, WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import AxisState, InputsStatus, StatusReply
from stepramp.controllers.stepramp.messages.trace import TraceNotice, TraceReply

FRAMES = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())["frames"]
REQUEST_FRAMES = [each for each in FRAMES if each["kind"] < REPLY]
REPLY_FRAMES = [each for each in FRAMES if each["kind"] >= REPLY and each["kind"] not in NOTICE_KINDS]
NOTICE_FRAMES = [each for each in FRAMES if each["kind"] in NOTICE_KINDS]
REPLIES: dict[int, type[Reply]] = {
    0x01: HelloReply,
    0x02: StatusReply,
    0x03: DoneReply,
    0x04: TraceReply,
    0x10: DoneReply,
    0x11: DataReply,
    0x12: EndReply,
    0x13: DoneReply,
    0x14: ReadReply,
    0x15: DoneReply,
    0x16: DoneReply,
    0x17: SettingsReply,
    0x18: DoneReply,
    0x20: TargetsReply,
    0x21: TargetsReply,
    0x22: DoneReply,
    0x23: TargetsReply,
    0x24: DoneReply,
    0x25: DoneReply,
    0x26: DoneReply,
    0x27: DoneReply,
    0x30: DoneReply,
    0x31: DoneReply,
    0x19: LimitsReply,
    0x1A: DoneReply,
}


@pytest.mark.parametrize("reference", REQUEST_FRAMES, ids=lambda each: each["name"])
def test_reference_requests(reference: dict) -> None:
    body = bytes.fromhex(reference["body"])
    assert REQUESTS[reference["kind"]].unpack(body).pack() == body


@pytest.mark.parametrize("reference", REPLY_FRAMES, ids=lambda each: each["name"])
def test_reference_replies(reference: dict) -> None:
    body = bytes.fromhex(reference["body"])
    reply = unpack_reply(REPLIES[reference["kind"] - REPLY], body)
    assert pack_reply(reply) == body
    assert isinstance(reply, Refusal) == (body[0] != 0)


@pytest.mark.parametrize("reference", NOTICE_FRAMES, ids=lambda each: each["name"])
def test_reference_notices(reference: dict) -> None:
    body = bytes.fromhex(reference["body"])
    assert NOTICE_KINDS[reference["kind"]].unpack(body).pack() == body


def test_every_request_has_a_reply() -> None:
    assert set(REQUESTS) == set(REPLIES)


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


@given(st.sampled_from(sorted(NOTICE_KINDS)), st.binary(max_size=60))
def test_bytes_become_a_notice_or_none(kind: int, body: bytes) -> None:
    notice = unpack_notice(Message(kind, 1, 0, body))
    assert notice is None or notice.pack() == body


def test_a_kind_that_is_no_notice() -> None:
    assert unpack_notice(Message(0xC2, 1, 0, bytes(7))) is None


def test_a_header_that_is_cut_is_no_message() -> None:
    assert Message.unpack(b"\x01\x02\x03") is None


@pytest.mark.parametrize("length", [0, 49])
def test_data_is_1_to_48_bytes_long(length: int) -> None:
    with pytest.raises(ValueError, match="DataRequest"):
        DataRequest.unpack(bytes(2 + length))


def test_masks() -> None:
    assert mask_of([3, 0, 3]) == 0b1001
    assert axes_of(0b1001) == [0, 3]
    assert axes_of(0) == []


def test_a_request_has_one_value_for_each_axis_of_its_mask() -> None:
    assert MoveByRequest(0b101, (7, -1)).pack().hex() == "0507000000ffffffff"
    assert MoveByRequest.unpack(bytes.fromhex("0507000000ffffffff")).by_axis == {0: 7, 2: -1}
    assert LineRequest(0b11, 1, (7, -1)).pack().hex() == "030107000000ffffffff"
    assert LineRequest.unpack(bytes.fromhex("030107000000ffffffff")).by_axis == {0: 7, 1: -1}
    for wrong in (lambda: MoveByRequest(0b101, (7,)), lambda: LineRequest(0b1, 0, (7, 8))):
        with pytest.raises(ValueError, match="values for"):
            wrong()


def test_a_stop_names_axes_or_none() -> None:
    assert (HaltRequest().pack(), HaltRequest(bytes([5])).pack()) == (b"", b"\x05")


def test_settings_are_12_bytes_or_more() -> None:
    for length in (12, 24, 51):
        assert WriteSettingsRequest.unpack(bytes(range(length))).settings == bytes(range(length))
    for length in (11, 52):
        with pytest.raises(ValueError, match="WriteSettingsRequest"):
            WriteSettingsRequest.unpack(bytes(length))


def test_a_report() -> None:
    report = ReportNotice.unpack(bytes.fromhex("e803 09 feffffff 88130000 05000000 00000000"))
    assert report == ReportNotice(1000, 0b1001, ((-2, 5000), (5, 0)))
    assert [report.state_of(axis) for axis in (0, 1)] == [AxisState.MOVING, AxisState.STOPPING]
    with pytest.raises(ValueError, match="3"):
        ReportNotice(0, 3, ((0, 0),))


def test_a_trace_frame() -> None:
    trace = TraceNotice.unpack(bytes.fromhex("82 0300 0a000000 3412 ffff"))
    assert (trace.axis, trace.is_last, trace.every_steps, trace.first_step) == (2, True, 3, 10)
    assert trace.values == (0x1234, 0xFFFF)
    with pytest.raises(ValueError, match="TraceNotice"):
        TraceNotice.unpack(bytes(7 + 2 * 13))


@pytest.mark.parametrize(
    ("place", "value"), [(4, b"\0\0\0\0"), (8, b"\0\0\0\0"), (8, b"\7\0\0\0"), (35, b"\0"), (35, b"\5"), (43, b"\3")]
)
def test_a_hello_without_sense(place: int, value: bytes) -> None:
    hello = bytearray(
        HelloReply(2, 0, 2, 0, 16_000_000, 2_000_000, (1, 2, 3, 4), (5, 6, 7), 9, 8, 488, 250, 4, 1, 0, 0, 0).pack()
    )
    hello[place : place + len(value)] = value
    with pytest.raises(ValueError, match=r"."):
        unpack_reply(HelloReply, b"\0" + bytes(hello))


def test_refusals_carry_a_detail() -> None:
    assert unpack_reply(DoneReply, b"\x0c\x8f\x00") == Refusal(ReplyStatus.TOO_FAST, 143)


def test_a_hello_of_version_3() -> None:
    body = HelloReply(2, 0, 2, 0, 16_000_000, 2_000_000, (1, 2, 3, 4), (5, 6, 7), 9, 8, 488, 250, 4, 1, 0, 0, 0).pack()
    third = b"\x00" + b"\x03" + body[1:] + bytes.fromhex("0f 18 20")
    said = unpack_reply(HelloReply, third)
    assert isinstance(said, HelloReply)
    assert (len(third), said.protocol_version, said.has_inputs, said.more) == (48, 3, True, b"\x0f\x18\x20")
    assert unpack_reply(HelloReply, third + b"\x99").more == b"\x0f\x18\x20\x99"
    assert not unpack_reply(HelloReply, third[:45] + bytes.fromhex("0b 0c 1b")).has_inputs
    assert not unpack_reply(HelloReply, b"\x00" + body).has_inputs
    with pytest.raises(ValueError, match="version 3 with 2 bytes"):
        unpack_reply(HelloReply, third[:-1])


def test_a_status_with_inputs() -> None:
    plain = bytes.fromhex("00 01 01 88ffffff d0070000 a00f0000 78000000 03000000 3412 06 02")
    assert (len(plain), unpack_reply(StatusReply, plain).inputs) == (27, None)
    said = unpack_reply(StatusReply, plain + bytes.fromhex("0301 02 05 08"))
    assert said.inputs == InputsStatus(active=0x103, stopped_by=2, known_axes=0b101, homing_axes=0b1000)
    later = unpack_reply(StatusReply, plain + bytes.fromhex("0301 02 05 08 ffff"))
    assert (later.inputs, later.pack()) == (said.inputs, plain[1:] + bytes.fromhex("0301 02 05 08 ffff"))


def test_what_is_asked_of_inputs() -> None:
    assert (AcknowledgeRequest.KIND, AcknowledgeRequest().pack()) == (0x26, b"")
    home = HomeRequest(0b101, 40_000, 50, (-5000, 4000))
    assert (home.KIND, home.pack().hex(" ")) == (0x27, "05 40 9c 00 00 32 00 78 ec ff ff a0 0f 00 00")
    assert HomeRequest.unpack(home.pack()).by_axis == {0: -5000, 2: 4000}
    with pytest.raises(ValueError, match="values for"):
        HomeRequest(0b1, 40_000, 50, ())
    # Carried out a second time they might undo a stop that came in between.
    assert not AcknowledgeRequest.HARMLESS_TWICE
    assert not HomeRequest.HARMLESS_TWICE


def test_refusals_of_inputs() -> None:
    assert unpack_reply(DoneReply, b"\x0d\x01\x01") == Refusal(ReplyStatus.STOPPED, 0x101)
    assert unpack_reply(DoneReply, b"\x0e\x02\x07") == Refusal(ReplyStatus.AT_LIMIT, 0x702)
