"""The virtual controller: the protocol, limits and behaviour of the firmware, with nothing attached.

It moves in real time by its clock. Opening its port resets it as it resets a board: position 0, no session, at rest.
Its memory outlives that, so that its ramps are still there after the next connect.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from stepramp.controllers.stepramp.frames import FrameSplitter, encode_frame
from stepramp.controllers.stepramp.input_roles import INPUTS, is_emergency_stop
from stepramp.controllers.stepramp.messages.axes import ALL_AXES, MOST_AXES, AxesRequest, axes_of, mask_of
from stepramp.controllers.stepramp.messages.body import DoneReply, Notice, Reply, Request
from stepramp.controllers.stepramp.messages.kinds import REQUESTS
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.motion import (
    AcknowledgeRequest,
    HaltRequest,
    HomeRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    SetPositionRequest,
    StopRequest,
    TargetsReply,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataRequest,
    EndRequest,
    ReadRequest,
    RollBackRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus, pack_reply
from stepramp.controllers.stepramp.messages.report import MOST_REPORTS_HZ, ReportNotice, ReportRequest
from stepramp.controllers.stepramp.messages.session import (
    OLDEST_VERSION,
    PROTOCOL_VERSION,
    Ability,
    HelloReply,
    HelloRequest,
)
from stepramp.controllers.stepramp.messages.settings import (
    SETTINGS_BYTES,
    LimitsReply,
    ReadLimitsRequest,
    ReadSettingsRequest,
    SettingsReply,
    WriteLimitsRequest,
    WriteSettingsRequest,
)
from stepramp.controllers.stepramp.messages.status import (
    InputsStatus,
    MachineState,
    StatusFlag,
    StatusReply,
    StatusRequest,
)
from stepramp.controllers.stepramp.messages.trace import TRACE_OFF, TraceReply, TraceRequest
from stepramp.controllers.stepramp.ramp_image import FAST_CLOCK_HZ, SLOW_CLOCK_HZ
from stepramp.controllers.stepramp.settings import OFFSETS, StepRampSettings
from stepramp.controllers.stepramp.soft_limits import bounds_of
from stepramp.controllers.surroundings import AxisSurroundings, Surroundings, SurroundingsChange
from stepramp.controllers.virtual.machine import VirtualMachine
from stepramp.controllers.virtual.memory import LARGEST_IMAGE_BYTES, VirtualMemory
from stepramp.controllers.virtual.store import USUAL, VirtualStore
from stepramp.controllers.virtual.streams import ReportClock, TraceRecorder
from stepramp.controllers.virtual.world import VirtualWorld
from stepramp.errors import Rejected

TRACE_VALUES_A_SECOND = 1000
STATUS_BYTES = 32
"""Of the reply to `status`, with its own status and what is said of inputs."""
HELLO = HelloReply(
    protocol_version=PROTOCOL_VERSION,
    firmware_major=0,
    firmware_minor=2,
    firmware_patch=0,
    fast_clock_hz=FAST_CLOCK_HZ,
    slow_clock_hz=SLOW_CLOCK_HZ,
    shortest_intervals=(106, 246, 388, 533),
    shortest_line_intervals=(133, 160, 181),
    longest_interval_ticks=2**28 - 1,
    shortest_formula_interval=1600,
    largest_image_bytes=LARGEST_IMAGE_BYTES,
    most_segments=250,
    axes=MOST_AXES,
    reset_cause=1,
    ramp_sequence=0,
    image_crc=0,
    ramp_in_use=0,
    more=bytes(
        [
            Ability.FORMULAS | Ability.GAUGES | Ability.INPUTS | Ability.KEEPS | Ability.SOFT_LIMITS,
            len(USUAL),
            STATUS_BYTES,
        ]
    ),
)
"""What it is and can do: as the firmware in `firmware/src/boards/avr/avr_limits.h`."""
AT_REST_ONLY = (
    BeginRequest,
    DataRequest,
    EndRequest,
    CommitRequest,
    TryRequest,
    RollBackRequest,
    WriteSettingsRequest,
    WriteLimitsRequest,
    SetPositionRequest,
    ZeroRequest,
    LineRequest,
    HomeRequest,
)
IN_FLIGHT = (MoveByRequest, MoveToRequest, RunRequest)
FOR_AXES = (AxesRequest, LineRequest, ZeroRequest, HomeRequest)
ALWAYS_OBEYED = (HelloRequest.KIND, StopRequest.KIND, HaltRequest.KIND)
"""Kinds that are obeyed whoever asks, and each time that they come."""
BYTES_ALONE = {
    b"\xff\xff": Message(StopRequest.KIND, 0, 0, b"").pack(),
    b"\xfe\xfe": Message(HaltRequest.KIND, 0, 0, b"").pack(),
}
"""What stops it outside of all frames, and as which message it is answered."""


class VirtualController:
    """The other end of sim://; a VirtualDevice of the link.

    clock: seconds that only grow [s]; tests bring their own.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.memory = VirtualMemory()
        self.world = VirtualWorld()
        self._machine = VirtualMachine(clock, HELLO, self.world)
        self.opened()

    def opened(self) -> None:
        """Reset: all but the memory is forgotten; the axes stay where they are in the world."""
        self.world.places = [self._machine.place(axis) for axis in range(MOST_AXES)]
        self.memory.settle(self._clock())
        self.memory.cut_power()
        self._splitter = FrameSplitter(BYTES_ALONE)
        self._session = 0
        self._version = PROTOCOL_VERSION
        self._last_answer: dict[tuple[int, int, int], Message] = {}
        self._reports = ReportClock()
        self._notice_tags = {ReportNotice.KIND: 0}
        self._machine = VirtualMachine(self._clock, HELLO, self.world)
        self._store = VirtualStore(self.memory, self._clock, HELLO, self._machine.use)
        self._handlers = self._handlers_of(self._store, self._machine)

    def _handlers_of(
        self, store: VirtualStore, machine: VirtualMachine
    ) -> dict[type[Request], Callable[[Any], Reply | Refusal]]:
        return {
            StatusRequest: self._status,
            ReportRequest: self._report,
            TraceRequest: self._trace,
            ReadSettingsRequest: lambda _: SettingsReply(store.packed[: self._settings_bytes]),
            WriteSettingsRequest: self._write_settings,
            ReadLimitsRequest: self._read_limits,
            WriteLimitsRequest: self._write_limits,
            BeginRequest: store.begin,
            DataRequest: store.data,
            EndRequest: lambda _: store.end(),
            CommitRequest: lambda _: machine.emergency() or store.commit(),
            ReadRequest: store.read,
            TryRequest: lambda _: store.try_out(),
            RollBackRequest: lambda _: machine.emergency() or store.roll_back(),
            MoveByRequest: lambda request: _targets(machine.move_by(request.by_axis)),
            MoveToRequest: lambda request: _targets(machine.move_to(request.by_axis)),
            RunRequest: lambda request: machine.run(request.by_axis) or DoneReply(),
            LineRequest: lambda request: _targets(machine.line(request.by_axis, request.ramp_axis)),
            SetPositionRequest: self._set_position,
            ZeroRequest: lambda request: machine.zero(axes_of(request.axes), request.steps) or DoneReply(),
            AcknowledgeRequest: lambda _: machine.acknowledge() or DoneReply(),
            HomeRequest: self._home,
            StopRequest: lambda request: self._stop_or_halt(request, machine.stop),
            HaltRequest: lambda request: self._stop_or_halt(request, machine.halt),
        }

    @property
    def surroundings(self) -> Surroundings:
        """What is around it now."""
        self._settle()
        places = ((axis, self._machine.place(axis), self.world.switches[axis]) for axis in range(MOST_AXES))
        axes = tuple(AxisSurroundings(axis, place, at.low_steps, at.high_steps) for axis, place, at in places)
        return Surroundings(self.world.emergency_stop, self.world.driver_fault, axes)

    def change_surroundings(self, change: SurroundingsChange) -> None:
        """Press, release and put elsewhere what is around it, which its inputs notice at once."""
        self._settle()
        self.world.change(change)
        self._machine.look()

    def exchange(self, sent: bytes) -> bytes:
        """Take bytes, if any, and return the frames they are answered with, then those that nobody asked for."""
        requests = [Message.unpack(frame) for frame in self._splitter.feed(sent)]
        answers = [self._answer(request) for request in requests if request is not None]
        self._settle()
        return b"".join(encode_frame(message.pack()) for message in (*answers, *self._notices()))

    def _answer(self, request: Message) -> Message:
        self._settle()
        self._machine.heard()
        header = (request.session, request.kind, request.tag)
        if header in self._last_answer and request.kind not in ALWAYS_OBEYED:
            return self._last_answer[header]
        reply = Message(request.kind | REPLY, request.session, request.tag, pack_reply(self._reply_to(request)))
        self._last_answer = {header: reply}
        return reply

    def _settle(self) -> None:
        """Let everything happen for which there was time."""
        self._machine.settle()
        self._store.settle()

    def _notices(self) -> Iterator[Message]:
        notices: list[Notice] = []
        if self._reports.is_due(self._clock()):
            notices.append(self._present_report())
        if self._machine.trace is not None:
            notices.extend(self._machine.trace.frames())
        for notice in notices:
            tag = self._notice_tags.get(notice.KIND, 0)
            self._notice_tags[notice.KIND] = (tag + 1) % 256
            yield Message(notice.KIND, self._session, tag, notice.pack())

    def _present_report(self) -> ReportNotice:
        machine, axes = self._machine, range(self._store.axes)
        states = sum(machine.state(axis) << 2 * axis for axis in axes)
        motions = tuple((machine.position(axis), machine.interval(axis)) for axis in axes)
        return ReportNotice(int(self._clock() * 1000) % 2**16, states, motions)

    def _reply_to(self, message: Message) -> Reply | Refusal:
        if message.kind not in ALWAYS_OBEYED and message.session != self._session:
            return Refusal(ReplyStatus.STALE_SESSION)
        if message.kind not in REQUESTS:
            return Refusal(ReplyStatus.UNKNOWN_KIND, message.kind)
        try:
            request = REQUESTS[message.kind].unpack(message.body)
        except ValueError:
            return Refusal(ReplyStatus.BAD_LENGTH, len(message.body))
        if isinstance(request, HelloRequest):
            return self._hello(request, message.session)
        return self._refused_now(request) or self._handlers[type(request)](request)

    def _refused_now(self, request: Request) -> Refusal | None:
        """Refuse what would disturb a move or a write, and what names axes that have no ramp."""
        machine = self._machine
        in_flight, at_rest = isinstance(request, IN_FLIGHT), isinstance(request, AT_REST_ONLY)
        if (at_rest and machine.moving) or (in_flight and (machine.on_a_line or self._are_homed(request))):
            return Refusal(ReplyStatus.MOVING)
        if (at_rest or in_flight) and self._store.writing:
            return Refusal(ReplyStatus.WRITING)
        if isinstance(request, FOR_AXES):
            return self._refused_axes(request.axes)
        return None

    def _are_homed(self, request: Request) -> bool:
        return isinstance(request, AxesRequest) and bool(request.axes & mask_of(self._machine.homing))

    def _refused_axes(self, mask: int) -> Refusal | None:
        if not self._store.make_ready():
            return Refusal(ReplyStatus.NO_RAMP)
        if not 0 < mask < 1 << self._machine.axes:
            return Refusal(ReplyStatus.OUT_OF_RANGE, mask)
        return None

    def _hello(self, request: HelloRequest, session: int) -> Reply | Refusal:
        if request.protocol_version not in (OLDEST_VERSION, PROTOCOL_VERSION):
            return Refusal(ReplyStatus.BAD_VERSION, PROTOCOL_VERSION)
        if not session:
            return Refusal(ReplyStatus.OUT_OF_RANGE)
        self._session, self._version = session, request.protocol_version
        self._reports.start(0, 0.0)
        self._machine.watch(None)
        more = HELLO.more if self._version == PROTOCOL_VERSION else b""
        return replace(self._store.introduced(HELLO), protocol_version=self._version, more=more)

    def _status(self, request: StatusRequest) -> Reply | Refusal:
        machine, store, axis = self._machine, self._store, request.axis
        if axis >= MOST_AXES:
            return Refusal(ReplyStatus.OUT_OF_RANGE, axis)
        moving = MachineState.MOVING if machine.moving else MachineState.IDLE
        flags = StatusFlag.ON_TRIAL if store.on_trial else StatusFlag(0)
        return StatusReply(
            state=MachineState.WRITING if store.writing else moving,
            axis_state=machine.state(axis),
            position_steps=machine.position(axis),
            target_steps=machine.target(axis),
            interval_ticks=machine.interval(axis),
            steps_made=machine.steps_made(axis),
            ramp_sequence=store.sequence,
            image_crc=store.image_crc,
            flags=flags | (StatusFlag.ENABLED if machine.enabled else 0),
            starved=0,
            more=self._inputs_status() if self._version == PROTOCOL_VERSION else b"",
        )

    def _inputs_status(self) -> bytes:
        machine = self._machine
        inputs = machine.inputs
        return InputsStatus(inputs.active, inputs.stopped_by, mask_of(machine.known), mask_of(machine.homing)).pack()

    def _report(self, request: ReportRequest) -> Reply | Refusal:
        if request.rate_hz > MOST_REPORTS_HZ:
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.rate_hz)
        self._reports.start(request.rate_hz, self._clock())
        return DoneReply()

    def _trace(self, request: TraceRequest) -> Reply | Refusal:
        if request.axis == TRACE_OFF:
            self._machine.watch(None)
            return TraceReply(request.every_steps)
        if request.axis >= self._machine.axes:
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.axis)
        usual = self._machine.steps_a_trace_value(request.axis, TRACE_VALUES_A_SECOND)
        every = max(request.every_steps, usual)
        self._machine.watch(TraceRecorder(request.axis, every))
        return TraceReply(every)

    def _write_settings(self, request: WriteSettingsRequest) -> Reply | Refusal:
        if len(request.settings) not in (SETTINGS_BYTES, self._settings_bytes):
            return Refusal(ReplyStatus.BAD_LENGTH, len(request.settings))
        packed = request.settings + self._store.packed[len(request.settings) :]
        try:
            StepRampSettings.unpack(packed[: OFFSETS["inputs"]])
            StepRampSettings.unpack(packed)
        except Rejected as error:
            return Refusal(ReplyStatus.OUT_OF_RANGE, min(_offset(each.field) for each in error.rejections))
        if packed[SETTINGS_BYTES:] != self._store.packed[SETTINGS_BYTES:] and (refusal := self._machine.emergency()):
            return refusal
        if (at := self._new_stop_at(packed)) is not None:
            return Refusal(ReplyStatus.OUT_OF_RANGE, at)
        self._store.use_settings(packed)
        return DoneReply()

    def _new_stop_at(self, packed: bytes) -> int | None:
        """Return where the role lies of an input that would be an emergency stop, and pressed, from now on."""
        at = range(OFFSETS["inputs"], OFFSETS["inputs"] + len(INPUTS))
        new = [each for each in at if packed[each] != self._store.packed[each] and is_emergency_stop(packed[each])]
        return new[0] if new and self.world.emergency_stop else None

    def _read_limits(self, request: ReadLimitsRequest) -> Reply | Refusal:
        if request.axis >= MOST_AXES:
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.axis)
        return LimitsReply(*bounds_of(self._store.limits, request.axis))

    def _write_limits(self, request: WriteLimitsRequest) -> Reply | Refusal:
        if request.axis >= MOST_AXES or request.lowest_steps > request.highest_steps:
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.axis)
        self._store.use_limits(request.axis, LimitsReply(request.lowest_steps, request.highest_steps).pack())
        return DoneReply()

    @property
    def _settings_bytes(self) -> int:
        return len(USUAL) if self._version == PROTOCOL_VERSION else SETTINGS_BYTES

    def _home(self, request: HomeRequest) -> Reply | Refusal:
        refused = self._machine.home(request.by_axis, request.slow_interval_ticks, request.back_off_steps)
        return refused or DoneReply()

    def _set_position(self, request: SetPositionRequest) -> Reply:
        self._machine.set_position(request.by_axis)
        return DoneReply()

    def _stop_or_halt(
        self, request: StopRequest | HaltRequest, do: Callable[[Iterator[int]], None]
    ) -> DoneReply | Refusal:
        axes = self._machine.axes
        mask = request.axes[0] if request.axes else ALL_AXES & (1 << axes) - 1
        if request.axes and not 0 < mask < 1 << axes:
            return Refusal(ReplyStatus.OUT_OF_RANGE, mask)
        do(iter(axes_of(mask)))
        return DoneReply()


def _offset(field: str) -> int:
    """Return where a setting lies when packed, or what an input is for [bytes]."""
    name, _, number = field.partition(".")
    return OFFSETS[name] + (int(number) if name == "inputs" else 0)


def _targets(result: dict[int, int] | Refusal) -> Reply | Refusal:
    return result if isinstance(result, Refusal) else TargetsReply(tuple(result.values()))
