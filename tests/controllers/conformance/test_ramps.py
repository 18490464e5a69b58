from __future__ import annotations

import pytest

from controllers.conformance.answers import moved, refused
from controllers.protocol_line import Line
from controllers.ramps import IMAGE, SIDE, four_axes, image_of
from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    StopRequest,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    ReadReply,
    ReadRequest,
    RollBackRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.settings import WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import MachineState, StatusFlag
from stepramp.controllers.stepramp.ramp_image import RampImage, SegmentRamp
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.ramp.segments import Segment


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
        WriteSettingsRequest(StepRampSettings().pack()),
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
