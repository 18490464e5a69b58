"""The virtual controller: the protocol, limits and behaviour of the firmware, with nothing attached.

It moves in real time by its clock. Opening its port resets it as it resets a board: position 0, no session, at rest.
Its memory outlives that, so that a ramp is still there after the next connect.
"""

import time
from collections.abc import Callable
from typing import Any

from stepramp.controllers.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.messages import (
    MOST_DATA,
    PROTOCOL_VERSION,
    REPLY,
    REQUESTS,
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    DoneReply,
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
    ReadSource,
    Refusal,
    Reply,
    ReplyStatus,
    Request,
    StatusReply,
    StatusRequest,
    StopRequest,
    pack_reply,
)
from stepramp.controllers.push import unpacked
from stepramp.controllers.ramp_image import MOST_SEGMENTS, BadRampImage, RampImage
from stepramp.controllers.virtual_memory import LARGEST_IMAGE_BYTES, VirtualMemory
from stepramp.controllers.virtual_motion import VirtualMotor

TIMER_HZ = 2_000_000
INTERVALS_TICKS = range(40, 2**24)
AT_REST_ONLY = (BeginRequest, DataRequest, EndRequest, CommitRequest, MoveByRequest, MoveToRequest)
POSITIONS = range(-(2**31), 2**31)
FIRMWARE_VERSION = (0, 1, 0)


class VirtualController:
    """The other end of sim://; a VirtualDevice of the link.

    clock: seconds that only grow [s]; tests bring their own.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.memory = VirtualMemory()
        self._handlers: dict[type[Request], Callable[[Any], Reply | Refusal]] = {
            StatusRequest: self._status,
            BeginRequest: self._begin,
            DataRequest: self._data,
            EndRequest: self._end,
            CommitRequest: self._commit,
            ReadRequest: self._read,
            MoveByRequest: self._move_by,
            MoveToRequest: self._move_to,
            StopRequest: self._stop,
            HaltRequest: self._halt,
        }
        self.opened()

    def opened(self) -> None:
        """Reset: all but the memory is forgotten."""
        self.memory.settle(self._clock())
        self.memory.cut_power()
        self._splitter = FrameSplitter()
        self._session = 0
        self._last_answer: dict[tuple[int, int, int], Message] = {}
        self._motor = VirtualMotor(self._clock, TIMER_HZ)
        self._announced: BeginRequest | None = None
        self._staged = bytearray()
        self._checked = False
        self._writing = False
        self._load()

    def exchange(self, sent: bytes) -> bytes:
        """Take bytes and return the frames they are answered with."""
        requests = (Message.unpack(frame) for frame in self._splitter.feed(sent))
        return b"".join(encode_frame(self._answer(request).pack()) for request in requests if request is not None)

    def _answer(self, request: Message) -> Message:
        self._settle()
        header = (request.session, request.kind, request.tag)
        if header in self._last_answer and request.kind != HelloRequest.KIND:
            return self._last_answer[header]
        reply = Message(request.kind | REPLY, request.session, request.tag, pack_reply(self._reply_to(request)))
        self._last_answer = {header: reply}
        return reply

    def _settle(self) -> None:
        """Let everything happen for which there was time."""
        self._motor.settle()
        self.memory.settle(self._clock())
        if self._writing and not self.memory.writing:
            self._writing = False
            self._load()

    def _load(self) -> None:
        """Make the ramp in the memory the active one."""
        self._sequence, self._image = self.memory.active()
        self._ramp = unpacked(RampImage.decode(self._image, INTERVALS_TICKS)) if self._sequence else None

    def _reply_to(self, message: Message) -> Reply | Refusal:
        if message.kind != HelloRequest.KIND and message.session != self._session:
            return Refusal(ReplyStatus.STALE_SESSION)
        if message.kind not in REQUESTS:
            return Refusal(ReplyStatus.UNKNOWN_KIND, message.kind)
        try:
            request = REQUESTS[message.kind].unpack(message.body)
        except ValueError:
            return Refusal(ReplyStatus.BAD_LENGTH, len(message.body))
        if isinstance(request, AT_REST_ONLY) and (self._motor.moving or self._writing):
            return Refusal(ReplyStatus.MOVING if self._motor.moving else ReplyStatus.WRITING)
        if isinstance(request, HelloRequest):
            return self._hello(request, message.session)
        return self._handlers[type(request)](request)

    def _hello(self, request: HelloRequest, session: int) -> Reply | Refusal:
        if request.protocol_version != PROTOCOL_VERSION:
            return Refusal(ReplyStatus.BAD_VERSION, PROTOCOL_VERSION)
        if not session:
            return Refusal(ReplyStatus.OUT_OF_RANGE)
        self._session = session
        major, minor, patch = FIRMWARE_VERSION
        return HelloReply(
            protocol_version=PROTOCOL_VERSION,
            firmware_major=major,
            firmware_minor=minor,
            firmware_patch=patch,
            timer_frequency_hz=TIMER_HZ,
            shortest_interval_ticks=INTERVALS_TICKS.start,
            longest_interval_ticks=INTERVALS_TICKS.stop - 1,
            largest_image_bytes=LARGEST_IMAGE_BYTES,
            most_segments=MOST_SEGMENTS,
            axes=1,
            ramp_sequence=self._sequence,
            ramp_crc=self._ramp_crc,
        )

    @property
    def _ramp_crc(self) -> int:
        return crc16(self._image) if self._sequence else 0

    def _status(self, _: StatusRequest) -> Reply:
        motor = self._motor
        state = MotorState.WRITING if self._writing else MotorState.IDLE
        if motor.moving:
            state = MotorState.STOPPING if motor.stopping else MotorState.MOVING
        return StatusReply(
            state=state,
            position_steps=motor.position,
            target_steps=motor.target,
            interval_ticks=motor.interval_ticks,
            steps_made=motor.steps_made,
            ramp_sequence=self._sequence,
            ramp_crc=self._ramp_crc,
            write_result=0,
        )

    def _begin(self, request: BeginRequest) -> Reply | Refusal:
        if request.length > LARGEST_IMAGE_BYTES:
            return Refusal(ReplyStatus.OUT_OF_RANGE, LARGEST_IMAGE_BYTES)
        self._announced, self._staged, self._checked = request, bytearray(), False
        return DoneReply()

    def _data(self, request: DataRequest) -> Reply | Refusal:
        if self._announced is None or request.offset != len(self._staged):
            return Refusal(ReplyStatus.OUT_OF_ORDER, len(self._staged))
        if len(self._staged) + len(request.data) > self._announced.length:
            return Refusal(ReplyStatus.OUT_OF_RANGE, self._announced.length)
        self._staged += request.data
        return DataReply(len(self._staged))

    def _end(self, _: EndRequest) -> Reply | Refusal:
        if self._announced is None or len(self._staged) != self._announced.length:
            return Refusal(ReplyStatus.OUT_OF_ORDER, len(self._staged))
        if crc16(bytes(self._staged)) != self._announced.crc:
            return Refusal(ReplyStatus.BAD_CRC, crc16(bytes(self._staged)))
        try:
            image = RampImage.decode(bytes(self._staged), INTERVALS_TICKS)
        except BadRampImage as bad:
            return Refusal(ReplyStatus.BAD_RAMP, bad.segment)
        self._checked = True
        return EndReply(len(image.up), len(image.down))

    def _commit(self, _: CommitRequest) -> Reply | Refusal:
        if not self._checked:
            return Refusal(ReplyStatus.OUT_OF_ORDER, len(self._staged))
        self._writing = True
        self.memory.begin_write(bytes(self._staged), self._clock())
        return DoneReply()

    def _read(self, request: ReadRequest) -> Reply | Refusal:
        if request.source not in list(ReadSource):
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.source)
        if not 1 <= request.length <= MOST_DATA:
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.length)
        image = bytes(self._staged) if request.source == ReadSource.STAGED else self._image
        return ReadReply(len(image), image[request.offset : request.offset + request.length])

    def _move_by(self, request: MoveByRequest) -> Reply | Refusal:
        return self._move(request.steps, allowed=request.steps != 0)

    def _move_to(self, request: MoveToRequest) -> Reply | Refusal:
        return self._move(request.position_steps - self._motor.position, allowed=True)

    def _move(self, steps: int, *, allowed: bool) -> Reply | Refusal:
        if self._ramp is None:
            return Refusal(ReplyStatus.NO_RAMP)
        target = self._motor.position + steps
        if not allowed or target not in POSITIONS:
            return Refusal(ReplyStatus.OUT_OF_RANGE)
        if steps:
            self._motor.move(self._ramp, steps)
        return MoveReply(target)

    def _stop(self, _: StopRequest) -> Reply:
        if self._ramp is not None:
            self._motor.stop(self._ramp)
        return DoneReply()

    def _halt(self, _: HaltRequest) -> Reply:
        self._motor.halt()
        return DoneReply()
