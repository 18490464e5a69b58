from __future__ import annotations

import pytest

from controllers.conformance.answers import refused
from controllers.protocol_line import SESSION, Line
from controllers.ramps import IMAGE
from stepramp.controllers.stepramp.frames import encode_frame
from stepramp.controllers.stepramp.messages.body import Request
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.motion import HaltRequest, RunRequest, StopRequest
from stepramp.controllers.stepramp.messages.ramps import BeginRequest, CommitRequest, DataReply, DataRequest
from stepramp.controllers.stepramp.messages.reply import ReplyStatus, unpack_reply
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.status import MachineState, StatusRequest


def test_hello(line: Line) -> None:
    said = line.hello()
    assert (said.protocol_version, said.fast_clock_hz, said.slow_clock_hz, said.axes) == (3, 16_000_000, 2_000_000, 4)
    assert (said.shortest_intervals, said.shortest_line_intervals) == ((106, 246, 388, 533), (133, 160, 181))
    assert (said.longest_interval_ticks, said.largest_image_bytes, said.most_segments) == (2**28 - 1, 440, 250)
    assert (said.ramp_sequence, said.image_crc, said.ramp_in_use) == (0, 0, 0)


def test_a_version_that_is_not_spoken(line: Line) -> None:
    newest = line.hello().protocol_version
    refused(line, HelloRequest(1), ReplyStatus.BAD_VERSION, newest)
    refused(line, HelloRequest(newest + 1), ReplyStatus.BAD_VERSION, newest)
    assert line.status().state == MachineState.IDLE


def test_session_0_is_none(line: Line) -> None:
    reply = line.exchange(Message(HelloRequest.KIND, 0, 1, HelloRequest().pack()))
    assert reply is not None
    assert reply.body[0] == ReplyStatus.OUT_OF_RANGE


@pytest.mark.parametrize("request_", [StatusRequest(0), CommitRequest(), RunRequest(1, (5000,))])
def test_another_session_is_stale(line: Line, request_: Request) -> None:
    reply = line.exchange(Message(request_.KIND, SESSION + 1, 77, request_.pack()))
    assert reply == Message(request_.KIND | REPLY, SESSION + 1, 77, bytes([ReplyStatus.STALE_SESSION, 0, 0]))


@pytest.mark.parametrize("request_", [StopRequest(), HaltRequest()])
@pytest.mark.parametrize("session", [0, SESSION + 1])
def test_stop_and_halt_are_obeyed_whoever_asks(line: Line, request_: Request, session: int) -> None:
    """And each time: also when the header is that of the last request."""
    line.use(IMAGE)
    for _ in range(2):
        line.good(RunRequest(1, (5000,)))
        line.wait_until(lambda status: status.steps_made > 0)
        reply = line.exchange(Message(request_.KIND, session, 77, request_.pack()))
        assert reply == Message(request_.KIND | REPLY, session, 77, bytes([ReplyStatus.OK]))
        line.wait_for_rest()


def test_a_new_hello_ends_the_session(line: Line) -> None:
    line.exchange(Message(HelloRequest.KIND, SESSION - 1, 0, HelloRequest().pack()))
    refused(line, StatusRequest(0), ReplyStatus.STALE_SESSION)


def test_unknown_kinds_and_wrong_lengths(line: Line) -> None:
    wrong = (
        (0x7F, b"", ReplyStatus.UNKNOWN_KIND, 0x7F),
        (0x02, b"", ReplyStatus.BAD_LENGTH, 0),
        (0x01, b"", ReplyStatus.BAD_LENGTH, 0),
        (0x03, b"xx", ReplyStatus.BAD_LENGTH, 2),
        (0x04, b"x", ReplyStatus.BAD_LENGTH, 1),
        (0x10, bytes(3), ReplyStatus.BAD_LENGTH, 3),
        (0x11, bytes(2), ReplyStatus.BAD_LENGTH, 2),
        (0x11, bytes(51), ReplyStatus.BAD_LENGTH, 51),
        (0x18, bytes(11), ReplyStatus.BAD_LENGTH, 11),
        (0x20, b"\x01" + bytes(3), ReplyStatus.BAD_LENGTH, 4),
        (0x21, b"\x03" + bytes(4), ReplyStatus.BAD_LENGTH, 5),
        (0x22, b"\x01" + bytes(8), ReplyStatus.BAD_LENGTH, 9),
        (0x23, b"\x03\x00" + bytes(4), ReplyStatus.BAD_LENGTH, 6),
        (0x25, b"\x01", ReplyStatus.BAD_LENGTH, 1),
        (0x30, b"\x01\x01", ReplyStatus.BAD_LENGTH, 2),
    )
    for tag, (kind, body, status, detail) in enumerate(wrong, start=100):
        reply = line.exchange(Message(kind, SESSION, tag, body))
        assert reply == Message(kind | REPLY, SESSION, tag, bytes([status, detail, 0]))


@pytest.mark.parametrize(
    "noise",
    [
        bytes(5),
        b"Grbl 1.1h ['$' for help]\r\n\0",
        b"\x01" * 200 + b"\0",
        b"\xff\x55\0",
        encode_frame(Message(StatusRequest.KIND, SESSION, 9, b"\0").pack())[:4] + b"\0",
        encode_frame(b"\x02\xef\xbe")[:-1] + b"\0",
    ],
)
def test_noise_is_not_answered_and_does_no_harm(line: Line, noise: bytes) -> None:
    line.write(noise)
    assert line.read(0.1) is None
    assert line.status().state == MachineState.IDLE


def test_a_flipped_bit_is_not_answered(line: Line) -> None:
    frame = bytearray(encode_frame(Message(StopRequest.KIND, SESSION, 9, b"").pack()))
    frame[2] ^= 0x10
    line.write(bytes(frame))
    assert line.read(0.1) is None


def test_a_repeated_request_is_answered_again_and_not_done_again(line: Line) -> None:
    line.good(BeginRequest(60, 0))
    data = DataRequest(0, bytes(range(48)))
    message = Message(data.KIND, SESSION, 200, data.pack())
    first = line.exchange(message)
    assert first is not None
    assert line.exchange(message) == first
    assert unpack_reply(DataReply, first.body) == DataReply(48)
    refused(line, data, ReplyStatus.OUT_OF_ORDER, 48)


def test_an_axis_that_is_not_there(line: Line) -> None:
    refused(line, StatusRequest(4), ReplyStatus.OUT_OF_RANGE, 4)
    assert line.status(3).position_steps == 0
