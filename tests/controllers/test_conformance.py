"""What docs/serial_protocol.md demands of every controller: the virtual one, and the firmware in the simulator.

What a controller does with a change in flight depends on the instant at which it decides; so positions, targets and
final states are compared then, not instants.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import takewhile
from pathlib import Path

import numpy as np
import pytest

from controllers.protocol_line import SESSION, Line
from controllers.ramps import DOWN_STEPS, FAST_IMAGE, IMAGE, SIDE, four_axes, image_of
from designs import document
from simulator.avr import SimulatedController, build_firmware, missing_tools
from stepramp.controllers.contract import Asked
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import crc16, encode_frame
from stepramp.controllers.stepramp.messages import (
    REPLY,
    SETTINGS_BYTES,
    TRACE_OFF,
    AxisState,
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    HaltRequest,
    HelloRequest,
    LineRequest,
    MachineState,
    Message,
    MoveByRequest,
    MoveToRequest,
    ReadReply,
    ReadRequest,
    ReadSettingsRequest,
    Refusal,
    ReplyStatus,
    ReportNotice,
    ReportRequest,
    Request,
    RollBackRequest,
    RunRequest,
    SetPositionRequest,
    SettingsReply,
    StatusFlag,
    StatusRequest,
    StopRequest,
    TargetsReply,
    TraceNotice,
    TraceReply,
    TraceRequest,
    TryRequest,
    WriteSettingsRequest,
    ZeroRequest,
    unpack_reply,
)
from stepramp.controllers.stepramp.ramp_image import RampImage, SegmentRamp
from stepramp.controllers.stepramp.settings import Settings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.design import Design
from stepramp.errors import Refused, Rejected
from stepramp.link.serial_port import SerialPort
from stepramp.ramp.move import play
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import Segment
from tools import require

LONG_MOVE = 100_000
TOLERANCE_US = 10


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


def moved(line: Line, request: Request) -> tuple[int, ...]:
    return line.good(request, TargetsReply).targets_steps


# ---- sessions and frames ----


def test_hello(line: Line) -> None:
    said = line.hello()
    assert (said.protocol_version, said.fast_clock_hz, said.slow_clock_hz, said.axes) == (2, 16_000_000, 2_000_000, 4)
    assert (said.shortest_intervals, said.shortest_line_intervals) == ((106, 246, 380, 533), (133, 160, 177))
    assert (said.longest_interval_ticks, said.largest_image_bytes, said.most_segments) == (2**28 - 1, 440, 250)
    assert (said.ramp_sequence, said.image_crc, said.ramp_in_use) == (0, 0, 0)


def test_a_version_that_is_not_spoken(line: Line) -> None:
    refused(line, HelloRequest(1), ReplyStatus.BAD_VERSION, 2)
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


# ---- ramps ----


def test_ramps_are_stored_and_outlive_the_connection(port: str) -> None:
    line = Line(port)
    assert line.read_image() == b""
    other = image_of(SegmentRamp(SIDE, 900, SIDE))
    for sequence, image in enumerate((IMAGE, other, other, IMAGE), start=1):
        line.store(image)
        status = line.status()
        assert (status.ramp_sequence, status.image_crc, status.flags) == (sequence, crc16(image.encode()), 0)
        assert line.read_image() == line.read_image(1) == image.encode()
    assert line.read_image(2) == other.encode()
    line.port.close()
    line = Line(port)
    said = line.hello()
    assert (said.ramp_sequence, said.image_crc, said.ramp_in_use) == (4, crc16(IMAGE.encode()), 1)
    assert line.read_image() == IMAGE.encode()
    line.port.close()


def test_the_largest_image(line: Line) -> None:
    intervals = [2_000_000 - 16_000 * index + 3 * index * index for index in range(90)]
    side = tuple(Segment(interval, 300 + index, -(index % 2)) for index, interval in enumerate(intervals))
    images = [image_of(SegmentRamp(side[:count], 1000, ())) for count in range(1, 91)]
    largest = max((image for image in images if len(image.encode()) <= 440), key=lambda image: len(image.encode()))
    assert len(largest.encode()) > 430
    line.store(largest)
    assert line.read_image() == largest.encode()


def test_end_tells_how_many_axes_and_ramps_there_are(line: Line) -> None:
    assert line.deliver(IMAGE.encode()) == EndReply(1, 1)
    assert line.deliver(four_axes().encode()) == EndReply(4, 2)
    assert line.deliver(image_of(SegmentRamp((), 1000, ())).encode()) == EndReply(1, 1)


def test_data_must_come_in_order(line: Line) -> None:
    refused(line, DataRequest(0, b"x"), ReplyStatus.OUT_OF_ORDER, 0)
    for request in (EndRequest(), CommitRequest(), TryRequest()):
        refused(line, request, ReplyStatus.OUT_OF_ORDER)
    refused(line, BeginRequest(489, 0), ReplyStatus.OUT_OF_RANGE)
    line.good(BeginRequest(20, 0))
    refused(line, DataRequest(1, b"x"), ReplyStatus.OUT_OF_ORDER, 0)
    line.good(DataRequest(0, bytes(12)), DataReply)
    refused(line, EndRequest(), ReplyStatus.OUT_OF_ORDER, 12)
    refused(line, DataRequest(12, bytes(9)), ReplyStatus.OUT_OF_RANGE)
    refused(line, CommitRequest(), ReplyStatus.OUT_OF_ORDER)
    refused(line, TryRequest(), ReplyStatus.OUT_OF_ORDER)


def test_what_was_delivered_can_be_read(line: Line) -> None:
    line.good(BeginRequest(20, 0))
    line.good(DataRequest(0, bytes(range(12))), DataReply)
    assert line.good(ReadRequest(1, 4, 48), ReadReply) == ReadReply(12, bytes(range(4, 12)))
    assert line.good(ReadRequest(1, 4, 2), ReadReply) == ReadReply(12, bytes([4, 5]))
    assert line.good(ReadRequest(1, 12, 48), ReadReply) == ReadReply(12, b"")
    for bad in (ReadRequest(3, 0, 1), ReadRequest(0, 0, 0), ReadRequest(0, 0, 49)):
        refused(line, bad, ReplyStatus.OUT_OF_RANGE)


def header(flags: int = 0, axes: int = 1, numbers: bytes = b"\0", ramps: int = 1) -> bytes:
    return bytes([2, flags, axes, ramps]) + numbers


@pytest.mark.parametrize(
    ("image", "detail"),
    [
        (b"", 0xFFFF),
        (b"\x01" + IMAGE.encode()[1:], 0xFFFF),
        (header(flags=2) + IMAGE.encode()[5:], 0xFFFF),
        (header(axes=5, numbers=bytes(5)) + IMAGE.encode()[5:], 0xFFFF),
        (header(axes=2, numbers=b"\0\1", ramps=1) + IMAGE.encode()[5:], 0xFFFF),
        (header(axes=2, numbers=b"\0\0", ramps=2) + 2 * IMAGE.encode()[5:], 0xFFFF),
        (IMAGE.encode() + b"\0", 0xFFFF),
        (IMAGE.encode()[:-1], 0x00FF),
        (header() + b"\x02" + IMAGE.encode()[6:], 0x00FF),
        (image_of(SegmentRamp((*SIDE, Segment(13, 1, 0)), 1000, ())).encode(), 0x0003),
        (image_of(SegmentRamp(SIDE, 1000, (Segment(100, 8, -13), *SIDE))).encode(), 0x0003),
        (image_of(SegmentRamp((Segment(5000, 0, 0),), 1000, ())).encode(), 0x0000),
        (image_of(SegmentRamp(SIDE, 13, SIDE)).encode(), 0x00FF),
        (image_of(SegmentRamp((Segment(2**28, 1, 0),), 1000, ())).encode(), 0x0000),
        (RampImage(True, (SegmentRamp(SIDE, 105, SIDE),)).encode(), 0x00FF),
        (image_of(IMAGE.axes[0], SegmentRamp((*SIDE, Segment(13, 1, 0)), 1000, SIDE)).encode(), 0x0103),
    ],
)
def test_a_bad_ramp_is_refused_and_told_where(line: Line, image: bytes, detail: int) -> None:
    assert line.deliver(image) == Refusal(ReplyStatus.BAD_RAMP, detail)


def test_a_wrong_crc_or_a_bad_ramp_changes_nothing(line: Line) -> None:
    line.store(IMAGE)
    encoded = image_of(SegmentRamp(SIDE, 900, SIDE)).encode()
    assert line.deliver(encoded, crc=crc16(encoded) ^ 1) == Refusal(ReplyStatus.BAD_CRC, crc16(encoded))
    refused(line, CommitRequest(), ReplyStatus.OUT_OF_ORDER)
    assert isinstance(line.deliver(encoded[:-1]), Refusal)
    assert line.read_image() == IMAGE.encode()
    assert line.status().ramp_sequence == 1
    assert moved(line, MoveByRequest(1, (5,))) == (5,)


def test_without_a_ramp_nothing_moves(line: Line) -> None:
    for request in (
        MoveByRequest(1, (1,)),
        MoveToRequest(1, (1,)),
        RunRequest(1, (5000,)),
        LineRequest(1, 0, (1,)),
        ZeroRequest(1, 5),
    ):
        refused(line, request, ReplyStatus.NO_RAMP)
    refused(line, RollBackRequest(), ReplyStatus.NO_RAMP)


def test_while_writing(line: Line) -> None:
    assert isinstance(line.deliver(IMAGE.encode()), EndReply)
    line.good(CommitRequest())
    assert line.status().state == MachineState.WRITING
    for request in (
        BeginRequest(1, 0),
        EndRequest(),
        CommitRequest(),
        TryRequest(),
        RollBackRequest(),
        MoveByRequest(1, (1,)),
        MoveToRequest(1, (1,)),
        RunRequest(1, (5000,)),
        WriteSettingsRequest(Settings().pack()),
    ):
        refused(line, request, ReplyStatus.WRITING)
    line.good(StopRequest())
    line.good(HaltRequest())
    line.wait_for_rest()
    assert line.read_image() == IMAGE.encode()


def test_a_ramp_on_trial_is_used_and_dropped_again(line: Line) -> None:
    line.store(IMAGE)
    line.use(four_axes())
    status = line.status()
    assert (status.ramp_sequence, status.image_crc) == (1, crc16(four_axes().encode()))
    assert status.flags & StatusFlag.ON_TRIAL
    assert line.hello().ramp_in_use == 2
    assert moved(line, MoveByRequest(8, (3,))) == (3,)
    line.wait_for_rest()
    line.good(RollBackRequest())
    status = line.status()
    assert (status.image_crc, status.flags & StatusFlag.ON_TRIAL) == (crc16(IMAGE.encode()), 0)
    refused(line, MoveByRequest(8, (3,)), ReplyStatus.OUT_OF_RANGE, 8)
    assert line.read_image(1) == IMAGE.encode()


def test_a_ramp_on_trial_is_kept(line: Line) -> None:
    line.store(IMAGE)
    line.use(four_axes())
    line.good(CommitRequest())
    line.wait_for_rest()
    status = line.status()
    assert (status.ramp_sequence, status.flags & StatusFlag.ON_TRIAL) == (2, 0)
    assert line.read_image() == four_axes().encode()
    assert line.read_image(2) == IMAGE.encode()


def test_the_previous_ramp_comes_back_and_then_the_other(line: Line) -> None:
    line.store(IMAGE)
    refused(line, RollBackRequest(), ReplyStatus.NO_RAMP)
    line.store(four_axes())
    for sequence, image in ((3, IMAGE), (4, four_axes()), (5, IMAGE)):
        line.good(RollBackRequest())
        status = line.wait_for_rest()
        assert (status.ramp_sequence, status.image_crc) == (sequence, crc16(image.encode()))
        assert line.read_image() == line.read_image(1) == image.encode()
    refused(line, MoveByRequest(2, (1,)), ReplyStatus.OUT_OF_RANGE, 2)


def test_what_was_delivered_is_dropped_by_a_move_and_by_a_roll_back(line: Line) -> None:
    line.store(IMAGE)
    line.store(IMAGE)
    assert isinstance(line.deliver(four_axes().encode()), EndReply)
    assert moved(line, MoveByRequest(1, (3,))) == (3,)
    line.wait_for_rest()
    refused(line, TryRequest(), ReplyStatus.OUT_OF_ORDER)
    assert isinstance(line.deliver(four_axes().encode()), EndReply)
    line.good(RollBackRequest())
    assert (line.status().state, line.status().ramp_sequence) == (MachineState.IDLE, 2)


# ---- settings ----


def test_settings_begin_with_defaults_and_are_kept_with_a_ramp(port: str) -> None:
    line = Line(port)
    ask = ReadSettingsRequest()
    assert Settings.unpack(line.good(ask, SettingsReply).settings) == Settings()
    line.store(IMAGE)
    other = Settings(pulse_width_us=7, direction_setup_us=500, enable_level="high", direction_inverted=(1, 3))
    line.good(WriteSettingsRequest(other.pack()))
    assert line.status().flags & StatusFlag.ON_TRIAL
    assert line.good(ask, SettingsReply).settings == other.pack()
    line.good(RollBackRequest())
    assert line.good(ask, SettingsReply).settings == Settings().pack()
    line.good(WriteSettingsRequest(other.pack()))
    line.good(CommitRequest())
    line.wait_for_rest()
    assert not line.status().flags & StatusFlag.ON_TRIAL
    line.port.close()
    line = Line(port)
    assert line.good(ask, SettingsReply).settings == other.pack()
    line.port.close()


@pytest.mark.parametrize(
    ("place", "value"),
    [(0, 2), (1, 16), (2, 16), (3, 128), (4, 2), (5, 101), (6, 19), (7, 60), (9, 4)],
)
def test_settings_out_of_range(line: Line, place: int, value: int) -> None:
    packed = bytearray(Settings().pack())
    packed[place] = value
    first_byte = {7: 6, 9: 8}.get(place, place)
    refused(line, WriteSettingsRequest(bytes(packed)), ReplyStatus.OUT_OF_RANGE, first_byte)
    assert line.good(ReadSettingsRequest(), SettingsReply).settings == Settings().pack()
    assert len(packed) == SETTINGS_BYTES


# ---- moves ----


@pytest.mark.parametrize("steps", [1, 2, 3, 42, 43, 44, 82, 83, 84, 300, -1, -83, -300])
def test_a_move_ends_exactly_where_it_should(line: Line, steps: int) -> None:
    line.use(IMAGE)
    assert moved(line, MoveByRequest(1, (steps,))) == (steps,)
    status = line.wait_for_rest()
    assert (status.position_steps, status.target_steps, status.interval_ticks) == (steps, steps, 0)
    assert (status.steps_made, status.starved) == (abs(steps), 0)


def test_positions_add_up(line: Line) -> None:
    line.use(FAST_IMAGE)
    position = 0
    for steps in (10, -30, 7, 120, -107):
        position += steps
        assert moved(line, MoveByRequest(1, (steps,))) == (position,)
        assert line.wait_for_rest().position_steps == position
    assert moved(line, MoveToRequest(1, (position,))) == (position,)
    assert line.wait_for_rest().position_steps == position


def test_targets_that_are_too_far(line: Line) -> None:
    line.use(four_axes())
    moved(line, MoveByRequest(2, (5,)))
    line.wait_for_rest()
    refused(line, MoveByRequest(3, (0, 2**31 - 1)), ReplyStatus.OUT_OF_RANGE, 1)
    assert line.status().state == MachineState.IDLE


@pytest.mark.parametrize("mask", [0, 16, 255])
def test_axes_without_a_ramp(line: Line, mask: int) -> None:
    line.use(four_axes())
    values = (1,) * mask.bit_count()
    for request in (MoveByRequest(mask, values), SetPositionRequest(mask, values), ZeroRequest(mask, 5)):
        refused(line, request, ReplyStatus.OUT_OF_RANGE, mask)


def test_axes_move_at_the_same_time_each_with_its_ramp(line: Line) -> None:
    line.use(four_axes())
    assert moved(line, MoveByRequest(0b1011, (300, -200, 50))) == (300, -200, 50)
    assert line.status(2).axis_state == AxisState.IDLE
    line.wait_for_rest()
    assert [line.status(axis).position_steps for axis in range(4)] == [300, -200, 0, 50]
    assert [line.status(axis).steps_made for axis in (0, 1, 3)] == [300, 200, 50]


def test_an_axis_sets_out_while_another_moves(line: Line) -> None:
    line.use(four_axes())
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    moved(line, MoveToRequest(4, (-60,)))
    assert line.wait_for_axis(2).position_steps == -60
    assert line.status(0).axis_state == AxisState.MOVING
    line.good(HaltRequest(bytes([1])))
    assert line.wait_for_rest().position_steps > 0


def test_what_is_refused_while_moving(line: Line) -> None:
    line.store(IMAGE)
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    for request in (
        BeginRequest(1, 0),
        DataRequest(0, b"x"),
        EndRequest(),
        CommitRequest(),
        TryRequest(),
        RollBackRequest(),
        WriteSettingsRequest(Settings().pack()),
        SetPositionRequest(1, (0,)),
        ZeroRequest(1, 5),
        LineRequest(1, 0, (5,)),
    ):
        refused(line, request, ReplyStatus.MOVING)
    assert line.read_image() == IMAGE.encode()
    status = line.wait_until(lambda status: status.steps_made > 0)
    assert (status.state, status.axis_state, status.target_steps) == (1, AxisState.MOVING, LONG_MOVE)
    assert 0 < status.position_steps <= status.steps_made + 1
    assert line.hello().ramp_sequence == 1
    assert line.status().state == MachineState.MOVING
    line.good(HaltRequest())


# ---- changes in flight ----


@pytest.mark.parametrize("target", [-50, 0, 1, 20, 90, 2000])
@pytest.mark.parametrize("wait_s", [0.0, 0.01, 0.1])
def test_a_target_that_changes_in_flight_is_reached(line: Line, target: int, wait_s: float) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (150,)))
    time.sleep(wait_s)
    assert moved(line, MoveToRequest(1, (target,))) == (target,)
    status = line.wait_for_rest()
    assert status.position_steps == status.target_steps == target
    assert status.starved == 0


def test_a_move_by_in_flight_counts_from_where_it_would_come_to_rest(line: Line) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (150,)))
    assert moved(line, MoveByRequest(1, (-250,))) == (-100,)
    assert moved(line, MoveByRequest(1, (30,))) == (-70,)
    assert line.wait_for_rest().position_steps == -70


def test_a_farther_target_while_slowing_down_speeds_it_up_again(line: Line) -> None:
    slow = image_of(SegmentRamp(SIDE, 1000, (Segment(60_000, 40, -1500),)))
    line.use(slow)
    moved(line, MoveByRequest(1, (100,)))
    line.wait_until(lambda status: status.steps_made > 70 and status.interval_ticks > 5000)
    moved(line, MoveToRequest(1, (400,)))
    line.wait_until(lambda status: status.interval_ticks == 1000)
    line.good(HaltRequest())


def test_running_at_a_speed_and_changing_it(line: Line) -> None:
    line.use(IMAGE)
    line.good(RunRequest(1, (1500,)))
    status = line.wait_until(lambda status: status.interval_ticks == 1500)
    assert (status.axis_state, status.target_steps) == (AxisState.MOVING, status.position_steps)
    line.good(RunRequest(1, (1000,)))
    line.wait_until(lambda status: status.interval_ticks == 1000)
    line.good(RunRequest(1, (3000,)))
    before = line.wait_until(lambda status: status.interval_ticks == 3000)
    line.good(RunRequest(1, (-1200,)))
    after = line.wait_until(lambda status: status.interval_ticks == 1200)
    assert after.position_steps > 0 < before.position_steps
    line.wait_until(lambda status: status.position_steps < 0)
    line.good(RunRequest(1, (0,)))
    status = line.wait_for_rest()
    assert status.position_steps == status.target_steps < 0


def test_a_run_goes_on_past_the_last_position(line: Line) -> None:
    """To the first: positions count modulo 2³²."""
    line.use(IMAGE)
    line.good(SetPositionRequest(1, (2**31 - 60,)))
    line.good(RunRequest(1, (2500,)))
    status = line.wait_until(lambda status: status.position_steps < 0)
    assert status.axis_state == AxisState.MOVING
    assert status.position_steps == status.steps_made - 60 - 2**31
    line.good(StopRequest())
    after, end = line.status(), line.wait_for_rest()
    assert after.target_steps == end.target_steps == end.position_steps == end.steps_made - 60 - 2**31


def test_a_move_ends_a_run(line: Line) -> None:
    line.use(IMAGE)
    line.good(RunRequest(1, (2500,)))
    line.wait_until(lambda status: status.interval_ticks == 2500)
    moved(line, MoveToRequest(1, (500,)))
    assert line.wait_for_rest().position_steps == 500


def test_a_move_by_counts_from_where_a_run_is(line: Line) -> None:
    """Or from what is queued already: 10 ms ahead at most, at an interval of 1.25 ms."""
    line.use(IMAGE)
    line.good(RunRequest(1, (2500,)))
    before = line.wait_until(lambda status: status.interval_ticks == 2500)
    (target,) = moved(line, MoveByRequest(1, (400,)))
    after = line.status()
    assert before.position_steps + 400 <= target <= after.position_steps + 400 + 8 + 1
    assert line.wait_for_rest().position_steps == target


def test_a_run_ends_when_nobody_asks_for_anything_and_a_move_goes_on(line: Line) -> None:
    line.use(four_axes())
    line.good(ReportRequest(50))
    moved(line, MoveByRequest(2, (LONG_MOVE,)))
    line.good(RunRequest(1, (1500,)))
    for _ in range(6):  # any request keeps it running
        line.hear(0.4)
        assert line.status().axis_state == AxisState.MOVING
    refused(line, MoveByRequest(1, (2**31 - 1,)), ReplyStatus.OUT_OF_RANGE, 0)  # changes nothing of it
    line.notices.clear()
    for _ in range(100):
        line.hear(0.1)
        if any(report.state_of(0) == AxisState.IDLE for report in reports(line)):
            break
    told = reports(line)
    running = list(takewhile(lambda report: report.state_of(0) == AxisState.MOVING, told))
    # It happened between the last report of the one and the first of the other: on a busy machine some are left out.
    assert (running[-1].time_ms - told[0].time_ms) % 2**16 <= 1350
    assert (told[len(running)].time_ms - told[0].time_ms) % 2**16 >= 950
    assert told[-1].state_of(0) == AxisState.IDLE
    assert told[-1].state_of(1) == AxisState.MOVING
    line.good(StopRequest())
    line.wait_for_rest()


def test_speeds_that_no_ramp_leads_to(line: Line) -> None:
    line.use(four_axes())
    refused(line, RunRequest(1, (999,)), ReplyStatus.OUT_OF_RANGE, 0)
    refused(line, RunRequest(3, (1000, -899)), ReplyStatus.OUT_OF_RANGE, 1)
    refused(line, RunRequest(1, (2**28,)), ReplyStatus.OUT_OF_RANGE, 0)
    assert line.status().state == MachineState.IDLE


# ---- stopping ----


@pytest.mark.parametrize("wait_s", [0.0, 0.01, 0.02, 0.2])
def test_a_stop_follows_the_way_down(line: Line, wait_s: float) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (-LONG_MOVE,)))
    time.sleep(wait_s)
    before = line.status()
    line.good(StopRequest())
    after = line.status()
    end = line.wait_for_rest()
    assert before.axis_state == AxisState.MOVING
    assert after.axis_state in (AxisState.STOPPING, AxisState.IDLE)
    assert end.position_steps == end.target_steps == after.target_steps == -end.steps_made
    assert before.steps_made <= end.steps_made < LONG_MOVE
    longer = [interval for interval in DOWN_STEPS if interval > before.interval_ticks > 0]
    assert end.steps_made - before.steps_made >= len(longer)
    line.good(StopRequest())
    assert line.status().position_steps == end.position_steps


def test_a_stop_on_the_way_down_changes_nothing(line: Line) -> None:
    line.use(image_of(SegmentRamp(SIDE, 1000, (Segment(60_000, 40, -1500),))))
    moved(line, MoveByRequest(1, (100,)))
    line.wait_until(lambda status: status.steps_made > 75)
    line.good(StopRequest())
    assert line.status().axis_state == AxisState.STOPPING
    assert line.wait_for_rest().position_steps == 100


def test_one_axis_stops_and_the_other_goes_on(line: Line) -> None:
    line.use(four_axes())
    moved(line, MoveByRequest(3, (LONG_MOVE, LONG_MOVE)))
    line.good(StopRequest(bytes([2])))
    assert line.wait_for_axis(1).position_steps < LONG_MOVE
    assert line.status(0).axis_state == AxisState.MOVING
    refused(line, StopRequest(bytes([16])), ReplyStatus.OUT_OF_RANGE, 16)
    line.good(StopRequest())
    assert line.wait_for_rest().position_steps < LONG_MOVE


def test_a_move_after_a_stop_in_flight_goes_on(line: Line) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    time.sleep(0.05)
    line.good(StopRequest())
    moved(line, MoveToRequest(1, (400,)))
    assert line.wait_for_rest().position_steps == 400


def test_a_halt_is_at_once_and_keeps_the_position(line: Line) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    time.sleep(0.1)
    line.good(HaltRequest())
    status = line.status()
    assert (status.state, status.interval_ticks) == (MachineState.IDLE, 0)
    assert 0 < status.position_steps == status.target_steps == status.steps_made < LONG_MOVE
    assert line.status() == status
    moved(line, MoveToRequest(1, (0,)))
    assert line.wait_for_rest().position_steps == 0


def test_stop_and_halt_at_rest_do_nothing(line: Line) -> None:
    for request in (StopRequest(), HaltRequest()):
        line.good(request)
        assert line.status().state == MachineState.IDLE


# ---- lines, positions, gauges ----


@pytest.mark.parametrize("steps", [(300, 100, 0, -7), (-50, 120, 120, 1), (1, -1, 0, 0), (0, 0, -83, 0), (0, 5, 0, 0)])
def test_a_line_ends_exactly_where_it_should(line: Line, steps: tuple[int, ...]) -> None:
    line.use(four_axes())
    assert moved(line, LineRequest(15, 0, steps)) == steps
    line.wait_for_rest()
    assert [line.status(axis).position_steps for axis in range(4)] == list(steps)


def test_axes_keep_to_the_line(line: Line) -> None:
    line.use(four_axes())
    moved(line, LineRequest(0b0101, 0, (3000, -1000)))
    refused(line, MoveByRequest(2, (1,)), ReplyStatus.MOVING)
    refused(line, RunRequest(2, (5000,)), ReplyStatus.MOVING)
    for _ in range(5):
        before, follower = line.status(0), line.status(2)
        after = line.status(0)
        assert before.position_steps / 3 - 1 <= -follower.position_steps <= after.position_steps / 3 + 1
    line.good(StopRequest(bytes([4])))
    line.wait_for_rest()
    leader, follower = (line.status(axis).position_steps for axis in (0, 2))
    assert 0 < leader < 3000
    assert -follower == (2 * leader * 1000 + 3000) // 6000
    moved(line, MoveToRequest(0b0101, (0, 0)))
    assert line.wait_for_rest().position_steps == 0


def test_a_halt_ends_a_line(line: Line) -> None:
    line.use(four_axes())
    moved(line, LineRequest(3, 1, (3000, 3000)))
    time.sleep(0.1)
    line.good(HaltRequest())
    assert line.status().state == MachineState.IDLE
    assert 0 < line.status(0).position_steps == line.status(1).position_steps < 3000


def test_axes_beside_a_line_do_not_end_it(line: Line) -> None:
    """Nor does a run of one of them that has ended before, when nobody asks for anything."""
    line.use(four_axes())
    line.good(RunRequest(0b0110, (2500, 1500)))
    line.good(StopRequest())
    line.wait_for_axis(1)
    line.wait_for_axis(2)
    moved(line, LineRequest(0b0011, 0, (LONG_MOVE, 0)))
    line.hear(1.6)
    for request in (StopRequest(bytes([0b0110])), HaltRequest(bytes([0b1110]))):
        assert line.status().axis_state == AxisState.MOVING
        line.good(request)
    assert line.status().axis_state == AxisState.MOVING
    line.good(HaltRequest(bytes([0b1001])))
    assert line.status().state == MachineState.IDLE


def test_a_line_with_the_ramp_of_no_axis(line: Line) -> None:
    line.use(four_axes())
    refused(line, LineRequest(3, 4, (5, 5)), ReplyStatus.OUT_OF_RANGE, 4)


def test_positions_are_set_and_nothing_moves(line: Line) -> None:
    line.use(four_axes())
    line.good(SetPositionRequest(0b0110, (-2000, 2**31 - 1)))
    assert [line.status(axis).position_steps for axis in range(4)] == [0, -2000, 2**31 - 1, 0]
    assert line.status(1).target_steps == -2000
    assert line.status().state == MachineState.IDLE
    refused(line, MoveByRequest(4, (1,)), ReplyStatus.OUT_OF_RANGE, 2)
    assert moved(line, MoveByRequest(2, (5,))) == (-1995,)


def test_a_gauge_runs_to_its_stop(line: Line) -> None:
    line.use(four_axes())
    line.good(ZeroRequest(0b0011, 100))
    assert line.status(0).target_steps == 0
    line.wait_for_rest()
    status = line.status(1)
    assert (status.position_steps, status.steps_made) == (0, 100)


# ---- too fast ----


def fast_axes(interval: int, axes: int = 4) -> RampImage:
    ramp = SegmentRamp((Segment(20_000, 20, -100),), interval, (Segment(20_000, 20, -100),))
    return RampImage(True, (ramp,) * axes)


def test_axes_that_are_too_fast_together(line: Line) -> None:
    line.use(fast_axes(500))
    for mask in (1, 3, 7):
        values = (5,) * mask.bit_count()
        moved(line, MoveByRequest(mask, values))
        line.wait_for_rest()
    reply = line.ask(MoveByRequest(15, (5,) * 4))
    assert isinstance(reply, Refusal)
    assert reply.status is ReplyStatus.TOO_FAST
    assert reply.detail in range(105, 108)
    moved(line, MoveByRequest(7, (LONG_MOVE,) * 3))
    assert line.ask(MoveByRequest(8, (5,))).status is ReplyStatus.TOO_FAST
    assert line.ask(RunRequest(8, (500,))).status is ReplyStatus.TOO_FAST
    line.good(RunRequest(8, (900,)))
    line.good(HaltRequest())


def test_an_axis_that_slows_down_is_still_fast(line: Line) -> None:
    """Whether it is told so in the same request or before."""
    long_way_down = (Segment(220, 60_000, 0),)
    line.use(RampImage(True, (SegmentRamp((), 200, long_way_down), SegmentRamp((), 260, ()))))
    line.good(RunRequest(1, (200,)))
    line.wait_until(lambda status: status.interval_ticks == 200)
    assert line.ask(RunRequest(3, (100_000, 260))).status is ReplyStatus.TOO_FAST
    assert line.ask(RunRequest(3, (0, 260))).status is ReplyStatus.TOO_FAST
    line.good(RunRequest(1, (100_000,)))
    assert line.ask(RunRequest(2, (260,))).status is ReplyStatus.TOO_FAST
    line.wait_until(lambda status: status.interval_ticks == 100_000)
    line.good(RunRequest(2, (260,)))
    line.good(HaltRequest())


def test_wide_pulses_and_gauges_take_longer(line: Line) -> None:
    line.use(fast_axes(200, 1))
    moved(line, MoveByRequest(1, (5,)))
    line.wait_for_rest()
    line.good(WriteSettingsRequest(Settings(pulse_width_us=6).pack()))
    assert line.ask(MoveByRequest(1, (5,))).status is ReplyStatus.TOO_FAST
    line.good(WriteSettingsRequest(Settings(outputs="gauges").pack()))
    assert line.ask(MoveByRequest(1, (5,))).status is ReplyStatus.TOO_FAST


def test_a_line_that_is_too_fast(line: Line) -> None:
    line.use(fast_axes(170))
    moved(line, LineRequest(7, 0, (5, 5, 5)))
    line.wait_for_rest()
    reply = line.ask(LineRequest(15, 0, (5, 5, 5, 5)))
    assert isinstance(reply, Refusal)
    assert reply.status is ReplyStatus.TOO_FAST
    assert line.status().state == MachineState.IDLE


# ---- reports and traces ----


def reports(line: Line) -> list[ReportNotice]:
    return [notice for _, notice in line.notices if isinstance(notice, ReportNotice)]


def test_reports_come_as_often_as_asked_for(line: Line) -> None:
    line.use(four_axes())
    line.hear(0.1)
    assert line.notices == []
    refused(line, ReportRequest(51), ReplyStatus.OUT_OF_RANGE, 51)
    line.good(ReportRequest(50))
    moved(line, MoveByRequest(5, (LONG_MOVE, -LONG_MOVE)))
    line.hear(1.0)
    line.good(ReportRequest(0))
    # By the controller's own clock: on a busy machine all is late, and what the line has no room for is left out.
    pauses_ms = np.diff([report.time_ms for report in reports(line)]) % 65_536
    assert 18 <= np.median(pauses_ms) <= 28
    assert pauses_ms.mean() >= 18
    tags = [message.tag for message, _ in line.notices]
    assert [(tag - tags[0]) % 256 for tag in tags] == list(range(len(tags)))
    assert {message.session for message, _ in line.notices} == {SESSION}
    positions = [report.axes[0][0] for report in reports(line)]
    assert positions == sorted(positions)
    last = reports(line)[-1]
    assert [last.state_of(axis) for axis in range(4)] == [1, 0, 1, 0]
    assert (last.axes[0][1], last.axes[1]) == (1000, (0, 0))
    line.hear(0.1)
    line.notices.clear()
    line.hear(0.1)
    assert line.notices == []
    line.good(HaltRequest())


def test_a_hello_ends_reports(line: Line) -> None:
    line.use(IMAGE)
    line.good(ReportRequest(50))
    line.hear(0.1)
    assert reports(line)
    line.hello()
    line.notices.clear()
    line.hear(0.1)
    assert line.notices == []


def traced(line: Line) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return the steps, the timer's values, and whether the last frame came."""
    frames = [notice for _, notice in line.notices if isinstance(notice, TraceNotice)]
    steps = [frame.first_step + frame.every_steps * index for frame in frames for index in range(len(frame.values))]
    values = [value for frame in frames for value in frame.values]
    return np.array(steps), np.array(values), any(frame.is_last for frame in frames)


@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize("steps", [2, 60, -200])
def test_a_trace_tells_when_steps_were_made(line: Line, every: int, steps: int) -> None:
    slow = image_of(SegmentRamp((Segment(20_000, 20, -400),), 8000, (Segment(20_000, 20, -400),)))
    line.use(slow)
    assert line.good(TraceRequest(0, every), TraceReply) == TraceReply(every)
    moved(line, MoveByRequest(1, (steps,)))
    line.wait_for_rest()
    line.hear(0.3)
    numbers, values, complete = traced(line)
    assert complete
    assert max(len(notice.values) for _, notice in line.notices if isinstance(notice, TraceNotice)) <= 12
    assert numbers.tolist() == list(range(1, abs(steps) + 1, every))
    up = 20_000 - 400 * np.arange(20)
    n_up, n_down = (min(20, -(-abs(steps) // 2)), min(20, abs(steps) // 2))
    intervals = np.concatenate((up[:n_up], np.full(abs(steps) - n_up - n_down, 8000), up[:n_down][::-1]))
    planned = np.concatenate(([0], np.cumsum(intervals)))[numbers - 1]
    late = (values - values[0] - planned + 2**15) % 2**16 - 2**15
    assert np.abs(late).max() <= TOLERANCE_US * 2
    line.good(TraceRequest(TRACE_OFF, 0), TraceReply)


def test_the_controller_chooses_what_the_line_can_carry(line: Line) -> None:
    line.use(IMAGE)
    assert line.good(TraceRequest(0, 0), TraceReply) == TraceReply(2)
    refused(line, TraceRequest(1, 0), ReplyStatus.OUT_OF_RANGE, 1)


# ---- the client ----


def controller_at(port: str) -> tuple[StepRampController, SerialPort]:
    serial_port = SerialPort(port)
    controller = StepRampController(serial_port)
    controller.connect()
    return controller, serial_port


def test_the_client_pushes_and_moves(port: str) -> None:
    controller, serial_port = controller_at(port)
    designs = [Design.checked(document(ramp__deceleration_steps_per_s2=2500)), Design.checked(document())]
    report = controller.prepare_push(designs)()
    assert report.verified
    assert report.largest_deviation_us <= 0.5
    controller.move_by([Asked(0, LONG_MOVE, "by_steps"), Asked(1, -50, "by_steps")])
    with pytest.raises(Refused, match="moves"):
        controller.prepare_push(designs)()
    controller.halt()
    with pytest.raises(Rejected):
        controller.move_by([Asked(0, 2**31 - 1, "by_steps")])
    serial_port.close()


def test_the_client_traces_a_move_against_its_plan(port: str) -> None:
    controller, serial_port = controller_at(port)
    design = Design.checked(document())
    controller.prepare_push([design])()
    every = controller.trace_moves(0, 0)
    controller.move_by([Asked(0, 300, "by_steps")])
    deadline = time.monotonic() + 10
    while (work_out := controller.trace) is None or not (trace := work_out()).complete:
        assert time.monotonic() < deadline
        controller.listen()
        time.sleep(0.02)
    instants = np.concatenate(([0], np.cumsum(play(ramp_of(design), 300))))[:-1]
    assert trace.step.tolist() == list(range(1, 301, every))
    assert np.array_equal(trace.planned_ticks, instants[trace.step - 1])
    assert np.abs(trace.deviation_us).max() <= TOLERANCE_US
    serial_port.close()


@pytest.mark.parametrize("method", ["first_order", "compromise", "newton"])
def test_a_ramp_by_formula_moves_to_its_targets(port: str, method: str) -> None:
    controller, serial_port = controller_at(port)
    design = Design.checked(document(method__name=method, method__arithmetic="fixed"))
    report = controller.prepare_push([design])()
    assert (report.verified, report.segments, report.largest_deviation_us) == (True, 0, 0)
    for target in (1, 2, 30, -77, 200, 400, 0):
        controller.move_to([Asked(0, target, "to_steps")])
        deadline = time.monotonic() + 10
        while (status := controller.status().axes[0]).activity != "ready":
            assert time.monotonic() < deadline
        assert status.position_steps == target
    serial_port.close()


def test_a_board_that_resets_when_its_port_is_opened(tmp_path: Path) -> None:
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path, boot_ms=1000) as simulated:
        controller, serial_port = controller_at(simulated.port)
        assert controller.status().axes[0].position_steps == 0
        serial_port.close()
