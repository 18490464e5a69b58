"""What docs/serial_protocol.md demands of every controller: the virtual one, and the firmware in the simulator."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from controllers.protocol_line import SESSION, Line
from designs import design
from simulator.avr import SimulatedController, build_firmware, missing_tools
from stepramp.controllers.frames import crc16, encode_frame
from stepramp.controllers.messages import (
    REPLY,
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    HaltRequest,
    HelloReply,
    HelloRequest,
    Message,
    MotorState,
    MoveByRequest,
    MoveReply,
    MoveToRequest,
    ReadReply,
    ReadRequest,
    Refusal,
    ReplyStatus,
    Request,
    StatusRequest,
    StopRequest,
    unpack_reply,
)
from stepramp.controllers.push import unpacked
from stepramp.controllers.ramp_image import RampImage
from stepramp.controllers.stepramp_controller import StepRampController
from stepramp.controllers.virtual import VirtualController
from stepramp.errors import Refused, Rejected
from stepramp.link.serial_port import SerialPort
from stepramp.ramp.segments import Segment
from tools import require

LONG_MOVE = 100_000
SIDE = (Segment(4000, 1, 0), Segment(2828, 2, -519), Segment(2000, 40, -25))
IMAGE = RampImage(SIDE, 1000, (Segment(4000, 20, -100), Segment(2000, 20, -50)))


@pytest.fixture(params=["virtual", "firmware"])
def port(request: pytest.FixtureRequest, tmp_path: Path, plug_in: Callable) -> Iterator[str]:
    if request.param == "virtual":
        yield plug_in(VirtualController())
        return
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path) as controller:
        yield controller.port


@pytest.fixture
def line(port: str) -> Iterator[Line]:
    line = Line(port)
    yield line
    line.port.close()


def refused(line: Line, request: Request, status: ReplyStatus, detail: int | None = None) -> None:
    reply = line.ask(request)
    assert isinstance(reply, Refusal), reply
    assert reply.status is status
    assert detail in (None, reply.detail)


def test_hello(line: Line) -> None:
    assert line.hello() == HelloReply(1, 0, 1, 0, 2_000_000, 40, 2**24 - 1, 500, 120, 1, 0, 0)


def test_a_version_that_is_not_spoken(line: Line) -> None:
    refused(line, HelloRequest(2), ReplyStatus.BAD_VERSION, 1)
    assert line.status().state == MotorState.IDLE


def test_session_0_is_none(line: Line) -> None:
    reply = line.exchange(Message(HelloRequest.KIND, 0, 1, HelloRequest().pack()))
    assert reply is not None
    assert reply.body[0] == ReplyStatus.OUT_OF_RANGE


@pytest.mark.parametrize("request_type", [StatusRequest, CommitRequest, HaltRequest])
def test_another_session_is_stale(line: Line, request_type: type[Request]) -> None:
    reply = line.exchange(Message(request_type.KIND, SESSION + 1, 77, b""))
    assert reply == Message(request_type.KIND | REPLY, SESSION + 1, 77, bytes([ReplyStatus.STALE_SESSION, 0, 0]))


def test_a_new_hello_ends_the_session(line: Line) -> None:
    line.exchange(Message(HelloRequest.KIND, SESSION - 1, 0, HelloRequest().pack()))
    refused(line, StatusRequest(), ReplyStatus.STALE_SESSION)


def test_unknown_kinds_and_wrong_lengths(line: Line) -> None:
    wrong = (
        (0x7F, b"", ReplyStatus.UNKNOWN_KIND, 0x7F),
        (0x02, b"x", ReplyStatus.BAD_LENGTH, 1),
        (0x01, b"", ReplyStatus.BAD_LENGTH, 0),
        (0x10, bytes(3), ReplyStatus.BAD_LENGTH, 3),
        (0x11, bytes(2), ReplyStatus.BAD_LENGTH, 2),
        (0x11, bytes(51), ReplyStatus.BAD_LENGTH, 51),
        (0x20, bytes(5), ReplyStatus.BAD_LENGTH, 5),
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
        encode_frame(Message(StatusRequest.KIND, SESSION, 9, b"").pack())[:4] + b"\0",
        encode_frame(b"\x02\xef\xbe")[:-1] + b"\0",
    ],
)
def test_noise_is_not_answered_and_does_no_harm(line: Line, noise: bytes) -> None:
    line.write(noise)
    assert line.read(0.1) is None
    assert line.status().state == MotorState.IDLE


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


def test_a_ramp_is_stored_and_outlives_the_connection(port: str) -> None:
    line = Line(port)
    assert line.stored() == b""
    other = RampImage(SIDE, 900, SIDE)
    for sequence, image in enumerate((IMAGE, other, other, IMAGE), start=1):
        line.store(image)
        status = line.status()
        assert (status.ramp_sequence, status.ramp_crc, status.write_result) == (sequence, crc16(image.encode()), 0)
        assert line.stored() == image.encode()
    line.port.close()
    line = Line(port)
    assert (line.hello().ramp_sequence, line.hello().ramp_crc) == (4, crc16(IMAGE.encode()))
    assert line.stored() == IMAGE.encode()
    line.port.close()


def test_the_largest_image(line: Line) -> None:
    intervals = [2_000_000 - 16_000 * index + 3 * index * index for index in range(90)]
    side = tuple(Segment(interval, 300 + index, -(index % 2)) for index, interval in enumerate(intervals))
    images = [RampImage(side[:count], 1000, ()) for count in range(1, 91)]
    largest = max((image for image in images if len(image.encode()) <= 500), key=lambda image: len(image.encode()))
    assert len(largest.encode()) > 485
    line.store(largest)
    assert line.stored() == largest.encode()


def test_end_tells_how_many_segments_there_are(line: Line) -> None:
    assert line.deliver(IMAGE.encode()) == EndReply(3, 2)
    assert line.deliver(RampImage(SIDE, 1000, SIDE).encode()) == EndReply(3, 3)
    assert line.deliver(RampImage((), 1000, ()).encode()) == EndReply(0, 0)


def test_data_must_come_in_order(line: Line) -> None:
    refused(line, DataRequest(0, b"x"), ReplyStatus.OUT_OF_ORDER, 0)
    refused(line, EndRequest(), ReplyStatus.OUT_OF_ORDER)
    refused(line, CommitRequest(), ReplyStatus.OUT_OF_ORDER)
    refused(line, BeginRequest(501, 0), ReplyStatus.OUT_OF_RANGE)
    line.good(BeginRequest(20, 0))
    refused(line, DataRequest(1, b"x"), ReplyStatus.OUT_OF_ORDER, 0)
    line.good(DataRequest(0, bytes(12)), DataReply)
    refused(line, EndRequest(), ReplyStatus.OUT_OF_ORDER, 12)
    refused(line, DataRequest(12, bytes(9)), ReplyStatus.OUT_OF_RANGE)
    refused(line, CommitRequest(), ReplyStatus.OUT_OF_ORDER)


def test_what_was_delivered_can_be_read(line: Line) -> None:
    line.good(BeginRequest(20, 0))
    line.good(DataRequest(0, bytes(range(12))), DataReply)
    assert line.good(ReadRequest(1, 4, 48), ReadReply) == ReadReply(12, bytes(range(4, 12)))
    assert line.good(ReadRequest(1, 4, 2), ReadReply) == ReadReply(12, bytes([4, 5]))
    assert line.good(ReadRequest(1, 12, 48), ReadReply) == ReadReply(12, b"")
    for bad in (ReadRequest(2, 0, 1), ReadRequest(0, 0, 0), ReadRequest(0, 0, 49)):
        refused(line, bad, ReplyStatus.OUT_OF_RANGE)


def test_a_wrong_crc_or_a_bad_ramp_changes_nothing(line: Line) -> None:
    line.store(IMAGE)
    encoded = RampImage(SIDE, 900, SIDE).encode()
    assert line.deliver(encoded, crc=crc16(encoded) ^ 1) == Refusal(ReplyStatus.BAD_CRC, crc16(encoded))
    refused(line, CommitRequest(), ReplyStatus.OUT_OF_ORDER)
    for image, segment in (
        (RampImage((*SIDE, Segment(39, 1, 0)), 1000, ()), 3),
        (RampImage(SIDE, 1000, (Segment(100, 8, -10), *SIDE)), 3),
        (RampImage((Segment(5000, 0, 0),), 1000, ()), 0),
        (RampImage(SIDE, 39, SIDE), None),
        (RampImage((Segment(2**24, 1, 0),), 1000, ()), 0),
    ):
        reply = line.deliver(image.encode())
        assert isinstance(reply, Refusal)
        assert reply.status is ReplyStatus.BAD_RAMP
        assert segment in (None, reply.detail)
    assert isinstance(line.deliver(encoded + b"\0"), Refusal)
    assert isinstance(line.deliver(encoded[:-1]), Refusal)
    assert isinstance(line.deliver(b""), Refusal)
    assert line.stored() == IMAGE.encode()
    assert line.status().ramp_sequence == 1


def test_without_a_ramp_nothing_moves(line: Line) -> None:
    refused(line, MoveByRequest(1), ReplyStatus.NO_RAMP)
    refused(line, MoveToRequest(1), ReplyStatus.NO_RAMP)


def test_while_writing(line: Line) -> None:
    assert isinstance(line.deliver(IMAGE.encode()), EndReply)
    line.good(CommitRequest())
    assert line.status().state == MotorState.WRITING
    for request in (BeginRequest(1, 0), EndRequest(), CommitRequest(), MoveByRequest(1), MoveToRequest(1)):
        refused(line, request, ReplyStatus.WRITING)
    line.good(StopRequest())
    line.good(HaltRequest())
    line.wait_for(MotorState.IDLE)
    assert line.stored() == IMAGE.encode()


@pytest.mark.parametrize("steps", [1, 2, 3, 42, 43, 44, 82, 83, 84, 300, -1, -83, -300])
def test_a_move_ends_exactly_where_it_should(line: Line, steps: int) -> None:
    line.store(IMAGE)
    assert line.good(MoveByRequest(steps), MoveReply) == MoveReply(steps)
    status = line.wait_for(MotorState.IDLE)
    assert (status.position_steps, status.target_steps, status.interval_ticks) == (steps, steps, 0)
    assert status.steps_made == abs(steps)


def test_positions_add_up(line: Line) -> None:
    line.store(IMAGE)
    position = 0
    for steps in (10, -30, 7, 120, -107):
        position += steps
        assert line.good(MoveByRequest(steps), MoveReply) == MoveReply(position)
        assert line.wait_for(MotorState.IDLE).position_steps == position
    assert line.good(MoveToRequest(-5), MoveReply) == MoveReply(-5)
    assert line.wait_for(MotorState.IDLE).position_steps == -5
    assert line.good(MoveToRequest(-5), MoveReply) == MoveReply(-5)
    assert line.status().state == MotorState.IDLE


def test_targets_out_of_range(line: Line) -> None:
    line.store(IMAGE)
    refused(line, MoveByRequest(0), ReplyStatus.OUT_OF_RANGE)
    line.good(MoveByRequest(1), MoveReply)
    line.wait_for(MotorState.IDLE)
    refused(line, MoveByRequest(2**31 - 1), ReplyStatus.OUT_OF_RANGE)
    assert line.good(MoveByRequest(-(2**31)), MoveReply) == MoveReply(1 - 2**31)
    line.good(HaltRequest())
    assert line.status().state == MotorState.IDLE


def test_while_moving(line: Line) -> None:
    line.store(IMAGE)
    line.good(MoveByRequest(LONG_MOVE), MoveReply)
    for request in (
        BeginRequest(1, 0),
        DataRequest(0, b"x"),
        EndRequest(),
        CommitRequest(),
        MoveByRequest(1),
        MoveToRequest(1),
    ):
        refused(line, request, ReplyStatus.MOVING)
    assert line.stored() == IMAGE.encode()
    status = line.status()
    assert (status.state, status.target_steps) == (MotorState.MOVING, LONG_MOVE)
    assert status.position_steps == status.steps_made > 0
    assert line.hello().ramp_sequence == 1
    assert line.status().state == MotorState.MOVING
    line.good(HaltRequest())


def down_steps(longer_than: int) -> int:
    return int(np.argmax(np.append(unpacked(IMAGE).down <= longer_than, True)))


@pytest.mark.parametrize("wait_s", [0.0, 0.01, 0.02, 0.2])
def test_a_stop_follows_the_way_down(line: Line, wait_s: float) -> None:
    line.store(IMAGE)
    line.good(MoveByRequest(-LONG_MOVE), MoveReply)
    time.sleep(wait_s)
    before = line.status()
    line.good(StopRequest())
    after = line.status()
    end = line.wait_for(MotorState.IDLE)
    assert before.state == MotorState.MOVING
    assert after.state in (MotorState.STOPPING, MotorState.IDLE)
    assert end.position_steps == end.target_steps == -end.steps_made
    assert before.steps_made <= end.steps_made < LONG_MOVE
    assert end.steps_made - before.steps_made >= down_steps(before.interval_ticks)
    line.good(StopRequest())
    assert line.status().position_steps == end.position_steps


def test_a_stop_on_the_way_down_changes_nothing(line: Line) -> None:
    slow = RampImage(SIDE, 1000, (Segment(60_000, 40, -1500),))
    line.store(slow)
    line.good(MoveByRequest(100), MoveReply)
    while (status := line.status()).steps_made < 70:
        assert status.state == MotorState.MOVING
    line.good(StopRequest())
    assert line.status().state == MotorState.STOPPING
    assert line.wait_for(MotorState.IDLE).position_steps == 100


def test_a_halt_is_at_once_and_keeps_the_position(line: Line) -> None:
    line.store(IMAGE)
    line.good(MoveByRequest(LONG_MOVE), MoveReply)
    time.sleep(0.1)
    line.good(HaltRequest())
    status = line.status()
    assert (status.state, status.interval_ticks) == (MotorState.IDLE, 0)
    assert 0 < status.position_steps == status.target_steps == status.steps_made < LONG_MOVE
    assert line.status() == status
    line.good(MoveToRequest(0), MoveReply)
    assert line.wait_for(MotorState.IDLE).position_steps == 0


def test_stop_and_halt_at_rest_do_nothing(line: Line) -> None:
    for request in (StopRequest(), HaltRequest()):
        line.good(request)
        assert line.status().state == MotorState.IDLE


def test_the_client_pushes_and_moves(port: str) -> None:
    serial_port = SerialPort(port)
    controller = StepRampController(serial_port)
    controller.connect()
    report = controller.prepare_push(design(ramp__deceleration_steps_per_s2=2500))()
    assert report.verified
    assert report.largest_deviation_us == 0
    controller.move_by(LONG_MOVE)
    with pytest.raises(Refused, match="moves"):
        controller.move_by(1)
    controller.halt()
    with pytest.raises(Rejected):
        controller.move_by(2**31 - 1)
    serial_port.close()


def test_a_board_that_resets_when_its_port_is_opened(tmp_path: Path) -> None:
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path, boot_ms=1000) as simulated:
        serial_port = SerialPort(simulated.port)
        controller = StepRampController(serial_port)
        controller.connect()
        assert controller.status().position_steps == 0
        serial_port.close()
