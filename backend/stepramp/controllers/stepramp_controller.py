"""The family of controllers that speak docs/serial_protocol.md."""

import secrets
from collections.abc import Callable
from time import monotonic, sleep
from typing import TypeVar

from stepramp.controllers.controller import Activity, ControllerStatus, PushReport, StoredRamp
from stepramp.controllers.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.messages import (
    MOST_DATA,
    PROTOCOL_VERSION,
    REPLY,
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
    unpack_reply,
)
from stepramp.controllers.push import plan_push
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused, Rejected, Rejection
from stepramp.link.serial_port import SerialPort
from stepramp.units import speed_from_interval

HELLO_INTERVAL_S = 0.25
HELLO_TIMEOUT_S = 5.0
"""Many boards reset when their port is opened, and are deaf for up to 2 s."""
GARBAGE_S = 0.05
REPLY_TIMEOUT_S = 0.2
MOST_REPEATS = 3
WRITE_POLL_S = 0.02
WRITE_TIMEOUT_S = 10.0
"""Two slots of 512 bytes at 3.4 ms a byte, and more than twice that for slower memory."""
FURTHEST_STEPS = 2**31 - 1

ACTIVITIES = {
    MotorState.IDLE: Activity.READY,
    MotorState.MOVING: Activity.MOVING,
    MotorState.STOPPING: Activity.STOPPING,
    MotorState.WRITING: Activity.WRITING,
}

REFUSALS = {
    ReplyStatus.MOVING: "The motor moves: stop it first.",
    ReplyStatus.NO_RAMP: "The controller has no ramp yet: push a design first.",
    ReplyStatus.WRITING: "The controller is storing a ramp: try again in a few seconds.",
    ReplyStatus.BAD_CRC: "The ramp arrived damaged; the controller keeps the one it had.",
    ReplyStatus.BAD_RAMP: "The controller refuses segment {detail} of the ramp; it keeps the one it had.",
    ReplyStatus.BAD_VERSION: (
        f"The controller speaks version {{detail}} of the protocol, this program version {PROTOCOL_VERSION}: "
        "update the older of the two."
    ),
}

R = TypeVar("R", bound=Reply)


class StepRampController:
    """A client of the protocol; see Controller for what its calls do."""

    def __init__(self, port: SerialPort, give_way: Callable[[float], None] = sleep) -> None:
        """Talk over an open port.

        give_way: called between two frames of a long exchange with how long there is time for other calls [s].
        """
        self._port = port
        self._give_way = give_way
        self._splitter = FrameSplitter()
        self._session = 0
        self._tag = 0
        self._hello: HelloReply | None = None

    @property
    def identity(self) -> HelloReply:
        """What the controller said in reply to hello; DeviceLost before there was one."""
        if self._hello is None:
            raise DeviceLost(f"Port {self._port.name} is not connected.")
        return self._hello

    @property
    def timer_hz(self) -> int:
        """Ticks a second of the step timer [Hz]."""
        return self.identity.timer_frequency_hz

    @property
    def firmware_version(self) -> str:
        """Version of the firmware."""
        said = self.identity
        return f"{said.firmware_major}.{said.firmware_minor}.{said.firmware_patch}"

    def connect(self) -> None:
        """Shake hands: drop what a reset left on the line, then say hello until it is answered.

        Raises DeviceLost when nothing answers, Refused when another protocol version does.
        """
        self._session = 1 + secrets.randbelow(0xFFFF)
        self._tag = 0
        message = Message(HelloRequest.KIND, self._session, self._tag, HelloRequest().pack())
        deadline = monotonic() + HELLO_TIMEOUT_S
        while self._port.read(GARBAGE_S) and monotonic() < deadline:
            pass
        reply = None
        while reply is None and monotonic() < deadline:
            # The lone zero ends whatever noise the board took for the beginning of a frame.
            self._port.write(b"\0" + encode_frame(message.pack()))
            reply = self._await_reply(message, HELLO_INTERVAL_S)
        if reply is None:
            raise DeviceLost(f"Nothing at {self._port.name} answers as a StepRamp controller.")
        self._hello = self._understood(reply, HelloReply)

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing."""
        return self._meaning(self._ask(StatusRequest(), StatusReply))

    def prepare_push(self, design: Design) -> Callable[[], PushReport]:
        """Work out the ramp image, without the port, and return the call that stores it; see Controller."""
        plan = plan_push(design, self.identity)

        def push() -> PushReport:
            stored, sequence = self.store(plan.image.encode())
            return plan.report(stored, sequence)

        return push

    def store(self, image: bytes) -> tuple[bytes, int]:
        """Store a ramp image: send, read back from RAM, commit, read back from EEPROM.

        Returns what was read back and the ramp's sequence number. Raises Refused when the controller can't take it,
        or holds something else than what was sent: then the ramp it had stays active.
        """
        self._ask(BeginRequest(len(image), crc16(image)), DoneReply)
        for offset in range(0, len(image), MOST_DATA):
            self._ask(DataRequest(offset, image[offset : offset + MOST_DATA]), DataReply)
        self._ask(EndRequest(), EndReply)
        if self._read(ReadSource.STAGED) != image:
            raise Refused("The controller's memory holds another ramp than the one sent; it keeps the one it had.")
        self._ask(CommitRequest(), DoneReply)
        written = self._await_written()
        return self._read(ReadSource.STORED), written.ramp_sequence

    def move_by(self, by_steps: int) -> None:
        """Begin to move by so many steps; see Controller."""
        asked = Rejection("by_steps", by_steps, "not 0, and a target from -2,147,483,648 to 2,147,483,647 steps")
        if by_steps == 0 or not -FURTHEST_STEPS - 1 <= by_steps <= FURTHEST_STEPS:
            raise Rejected([asked])
        self._ask(MoveByRequest(by_steps), MoveReply, asked)

    def move_to(self, to_steps: int) -> None:
        """Begin to move to a position [steps]; see Controller."""
        asked = Rejection("to_steps", to_steps, "a target from -2,147,483,648 to 2,147,483,647 steps")
        if not -FURTHEST_STEPS - 1 <= to_steps <= FURTHEST_STEPS:
            raise Rejected([asked])
        self._ask(MoveToRequest(to_steps), MoveReply, asked)

    def stop(self) -> None:
        """Begin to slow down with the ramp."""
        self._ask(StopRequest(), DoneReply)

    def halt(self) -> None:
        """Make no further step."""
        self._ask(HaltRequest(), DoneReply)

    def _read(self, source: ReadSource) -> bytes:
        """Return a whole ramp image; empty when there is none."""
        data = b""
        while True:
            reply = self._ask(ReadRequest(source, len(data), MOST_DATA), ReadReply)
            data += reply.data
            if not reply.data or len(data) >= reply.total_bytes:
                return data

    def _await_written(self) -> StatusReply:
        deadline = monotonic() + WRITE_TIMEOUT_S
        while (reply := self._ask(StatusRequest(), StatusReply)).state == MotorState.WRITING:
            if monotonic() >= deadline:
                raise Refused(f"The controller has been storing the ramp for {WRITE_TIMEOUT_S:g} s without an end.")
            self._give_way(WRITE_POLL_S)
        if reply.write_result:
            raise Refused("The controller could not store the ramp in its memory; it keeps the one it had.")
        return reply

    def _meaning(self, reply: StatusReply) -> ControllerStatus:
        moves = reply.interval_ticks > 0
        return ControllerStatus(
            activity=ACTIVITIES[MotorState(reply.state)],
            position_steps=reply.position_steps,
            target_steps=reply.target_steps,
            speed_steps_per_s=speed_from_interval(reply.interval_ticks, self.timer_hz) if moves else 0.0,
            ramp=StoredRamp(reply.ramp_sequence, reply.ramp_crc) if reply.ramp_sequence else None,
        )

    def _ask(self, request: Request, reply_type: type[R], asked: Rejection | None = None) -> R:
        """Send a request and return its reply; an unanswered one is repeated with the same tag.

        asked: what to reject when the controller finds a value out of range.
        """
        self._give_way(0.0)
        self._tag = (self._tag + 1) & 0xFF
        message = Message(request.KIND, self._session, self._tag, request.pack())
        for _ in range(1 + MOST_REPEATS):
            self._port.write(encode_frame(message.pack()))
            reply = self._await_reply(message, REPLY_TIMEOUT_S)
            if reply is not None:
                return self._understood(reply, reply_type, asked)
        raise DeviceLost(f"The controller at {self._port.name} does not answer.")

    def _await_reply(self, request: Message, timeout_s: float) -> Message | None:
        """Return the reply to a request; what else comes in is the answer to an earlier one, or noise."""
        deadline = monotonic() + timeout_s
        while (left_s := deadline - monotonic()) > 0:
            for frame in self._splitter.feed(self._port.read(left_s)):
                reply = Message.unpack(frame)
                if reply is not None and (reply.kind, reply.session, reply.tag) == (
                    request.kind | REPLY,
                    request.session,
                    request.tag,
                ):
                    return reply
        return None

    def _understood(self, message: Message, reply_type: type[R], asked: Rejection | None = None) -> R:
        """Return a reply's body; a refusal becomes the exception that says so."""
        try:
            reply = unpack_reply(reply_type, message.body)
        except ValueError as error:
            raise DeviceLost(f"The controller at {self._port.name} gives answers without sense: {error}") from error
        if not isinstance(reply, Refusal):
            return reply
        if reply.status is ReplyStatus.STALE_SESSION:
            raise DeviceLost(f"The controller at {self._port.name} was restarted: its position is no longer known.")
        if reply.status is ReplyStatus.OUT_OF_RANGE and asked is not None:
            raise Rejected([asked])
        unexpected = f"The controller refuses: {reply.status.name.lower()} ({reply.detail})."
        raise Refused(REFUSALS.get(reply.status, unexpected).format(detail=reply.detail))
