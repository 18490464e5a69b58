"""The family of controllers that speak docs/serial_protocol.md."""

from collections.abc import Callable, Collection, Sequence
from time import sleep

from stepramp.controllers.capabilities import (
    DrawsLines,
    HasInputs,
    HasSettings,
    RestoresRamps,
    StoresRamps,
    TracesMoves,
    TriesRamps,
    ZeroesGauges,
)
from stepramp.controllers.contract import (
    UNDER_WAY,
    Activity,
    AxisCommand,
    Controller,
    ControllerStatus,
    NextTrace,
    PushMode,
    PushPreview,
    PushReport,
    Trace,
)
from stepramp.controllers.inputs import StopCause
from stepramp.controllers.progress import Tell
from stepramp.controllers.stepramp.conversation import Conversation
from stepramp.controllers.stepramp.messages.axes import AxesRequest, mask_of
from stepramp.controllers.stepramp.messages.body import DoneReply
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
from stepramp.controllers.stepramp.messages.report import MOST_REPORTS_HZ, ReportNotice, ReportRequest
from stepramp.controllers.stepramp.messages.session import HelloReply, RampInUse
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.messages.trace import TraceNotice
from stepramp.controllers.stepramp.motion_checks import MotionChecks
from stepramp.controllers.stepramp.push_remedies import plan_or_remedies
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.stepramp.speed_limits import interval_ticks
from stepramp.controllers.stepramp.status import status_after, status_of
from stepramp.controllers.stepramp.storage import Storage, refuse_in_emergency
from stepramp.controllers.stepramp.tracing import Tracing
from stepramp.controllers.stepramp.transfer import Transfer
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection


class StepRampController(
    Controller,
    StoresRamps,
    TriesRamps,
    RestoresRamps,
    HasSettings[StepRampSettings],
    TracesMoves,
    DrawsLines,
    ZeroesGauges,
    HasInputs,
):
    """A client of the protocol; see Controller, and the capabilities, for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called between two frames of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        self._port_name = port.name
        self._conversation = Conversation(port, give_way)
        self._conversation.stopped_by = self._stopped_by
        self._conversation.moving_axis = self._moving_axis
        transfer = Transfer(self._conversation, give_way, tell)
        self._storage = Storage(self._conversation, transfer, port.name, self.connect, self._use)
        self._hello: HelloReply | None = None
        self._status: ControllerStatus | None = None
        self._report: ReportNotice | None = None
        self._tracing = Tracing(self._conversation, give_way)
        self._checks = MotionChecks()

    @property
    def identity(self) -> HelloReply:
        """What the controller said in reply to hello; DeviceLost before there was one."""
        if self._hello is None:
            raise DeviceLost(f"Port {self._port_name} is not connected.")
        return self._hello

    @property
    def lacks(self) -> tuple[type, ...]:
        """The protocols of what controllers with other firmware can; see Controller."""
        return () if self.identity.has_inputs else (HasInputs,)

    @property
    def clocks_hz(self) -> tuple[int, int]:
        """The fast and the slow clock of the step timer [Hz]."""
        return self.identity.fast_clock_hz, self.identity.slow_clock_hz

    @property
    def timer_hz(self) -> int:
        """Ticks a second of the clock that the ramps in use are played with [Hz]; without any, of the slow one."""
        fast, slow = self.clocks_hz
        image = self._storage.image
        return fast if image is not None and image.fast_clock else slow

    @property
    def most_axes(self) -> int:
        """How many axes it said in reply to hello that it can have."""
        return self.identity.axes

    @property
    def firmware_version(self) -> str:
        """Version of the firmware."""
        said = self.identity
        return f"{said.firmware_major}.{said.firmware_minor}.{said.firmware_patch}"

    @property
    def trace(self) -> Callable[[], Trace] | None:
        """What works out the trace of the last move that was traced; see Controller."""
        return self._tracing.trace

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Shake hands, and learn which settings and ramps are in use; nothing moves.

        greeted: called in between: a stop need not wait until all is learnt.
        """
        self._hello = self._conversation.begin()
        self._storage.has_soft_limits = self._hello.has_soft_limits
        greeted()
        self._storage.learn_settings()
        self._storage.learn_image(RampInUse(self._hello.ramp_in_use))
        self._conversation.ask(ReportRequest(MOST_REPORTS_HZ), DoneReply)

    def disconnect(self) -> None:
        """Ask for no more reports."""
        self._conversation.ask(ReportRequest(0), DoneReply)

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing, axis by axis."""
        replies = self._status_replies()
        # What was reported before these replies is older than they are.
        self._take_notices()
        status = status_of(
            replies, self.timer_hz, self._storage.settings.inputs or (), has_ramp=self._storage.image is not None
        )
        self._checks.run_no_more(axis.axis for axis in status.axes if axis.activity is Activity.READY)
        self._status, self._report = status, None
        return status

    def listen(self) -> ControllerStatus | None:
        """Return what the reports since the last call say; None when there was none."""
        self._hear()
        report, self._report = self._report, None
        before = self._status
        if report is None or before is None or before.activity is Activity.WRITING:
            return None
        after = status_after(before, report, self._checks.running, self.timer_hz)
        if after is None:
            return self.status()
        self._status = after
        return after

    def stops_of_others(self) -> int:
        """Return how many stops of others were heard; see Controller. What else has come in waits to be listened to."""
        self._conversation.listen()
        return self._conversation.stops_of_others

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        """Work out the ramp image, without the port, and return the call that sends it; see Controller."""
        present = self._storage.image
        plan = plan_or_remedies(designs, self.identity, self._storage.settings, first_axis, present)

        def push() -> PushReport:
            if first_axis is not None and self._storage.image is not present:
                raise Refused("The controller's ramps were changed in the meantime: push again.")
            kept = mode == "keep"
            if kept:
                self._refuse_in_emergency()
            stored, sequence = self.store(plan.image.encode()) if kept else self.try_out(plan.image.encode())
            return plan.report(stored, sequence, kept=kept)

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        present, present_hz = self._storage.image, self.timer_hz
        plan = plan_or_remedies(designs, self.identity, self._storage.settings, first_axis, present)
        return plan.preview(present, present_hz)

    def store(self, image: bytes) -> tuple[bytes, int]:
        """Store a ramp image; see Storage."""
        return self._storage.store(image)

    def try_out(self, image: bytes) -> tuple[bytes, int]:
        """Use a ramp image without storing it; see Storage."""
        return self._storage.try_out(image)

    def keep(self) -> None:
        """Store the ramps and settings in use."""
        self._refuse_in_emergency()
        self._storage.keep()

    def roll_back(self) -> None:
        """Use the stored ramps and settings again; Refused when nothing else is in use."""
        self._storage.roll_back(self.status())

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones; Refused when there are none."""
        self._storage.restore(self.status())

    def settings(self) -> StepRampSettings:
        """Ask for the settings in use."""
        return self._storage.read_settings()

    def use_settings(self, settings: StepRampSettings) -> None:
        """Use other settings until a roll back or a reset."""
        self._storage.use_settings(settings)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move axes by so many steps; see Controller."""
        self._move(steps, MoveByRequest)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move axes to positions [steps]; see Controller."""
        self._move(positions, MoveToRequest)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run axes at speeds [steps/s]; see Controller."""
        intervals = self._checks.intervals_of(speeds)
        rejected = self._checks.unless_too_fast(self._moving, speeds, intervals)
        self._tracing.prepare(intervals, self._hear)
        request = RunRequest(mask_of(intervals), tuple(intervals[axis] for axis in sorted(intervals)))
        self._conversation.ask(request, DoneReply, rejected)
        self._checks.running |= {axis: abs(interval) for axis, interval in intervals.items() if interval}
        self._tracing.runs(intervals, self._checks.playbacks, self.timer_hz)

    def line(self, steps: Sequence[AxisCommand], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line; see Controller."""
        values = self._checks.whole_values(steps)
        axis = self._checks.ramp_axis(values, ramp_axis)
        rejected = self._checks.unless_line_too_fast(steps, values, axis)
        ordered = tuple(values[each] for each in sorted(values))
        self._tracing.prepare(values, self._hear)
        self._conversation.ask(LineRequest(mask_of(values), axis, ordered), TargetsReply, rejected)
        self._checks.run_no_more(values)
        self._tracing.goes_along_a_line(values, self._checks.playbacks[axis], self.timer_hz)

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes are these positions [steps]."""
        values = self._checks.whole_values(positions)
        ordered = tuple(values[axis] for axis in sorted(values))
        self._conversation.ask(SetPositionRequest(mask_of(values), ordered), DoneReply)

    def zero(self, axes: Collection[int], steps: int) -> None:
        """Call the places where axes are so many steps and move them to 0."""
        commands = [AxisCommand(axis, axis, "axes") for axis in axes]
        self._checks.known_axes(commands)
        rejected = self._checks.unless_too_fast(self._moving, commands, self._checks.slew_intervals(axes))
        self._tracing.prepare(axes, self._hear)
        self._conversation.ask(ZeroRequest(mask_of(axes), steps), DoneReply, rejected)
        self._checks.run_no_more(axes)
        self._tracing.moves(dict.fromkeys(axes, -steps), self._checks.playbacks, self.timer_hz)

    def acknowledge(self) -> None:
        """Take motions again after an emergency stop or a driver's fault; see HasInputs."""
        self._conversation.ask(AcknowledgeRequest(), DoneReply)

    def home(self, fast: Sequence[AxisCommand], slow: AxisCommand, back_off_steps: int) -> None:
        """Begin to find axes' limit switches; see HasInputs."""
        intervals = self._checks.homing_intervals(fast)
        slow_interval = self._checks.slow_interval(slow, intervals)
        rejected = self._checks.unless_not_to_home(self._moving, fast, intervals)
        ordered = tuple(intervals[axis] for axis in sorted(intervals))
        self._tracing.prepare(intervals, self._hear)
        self._conversation.ask(
            HomeRequest(mask_of(intervals), slow_interval, back_off_steps, ordered), DoneReply, rejected
        )
        self._checks.running |= {axis: abs(interval) for axis, interval in intervals.items()}
        self._tracing.runs(intervals, self._checks.playbacks, self.timer_hz)
        # Only its first approach is a run: where that ends is for the switch to say.
        self._tracing.change(intervals)

    def stop(self, axes: Collection[int] | None = None) -> None:
        """Begin to slow down with the ramp."""
        self._tracing.change(axes)
        self._conversation.ask(StopRequest(self._mask(axes)), DoneReply)

    def halt(self, axes: Collection[int] | None = None) -> None:
        """Make no further step."""
        self._tracing.change(axes)
        self._conversation.ask(HaltRequest(self._mask(axes)), DoneReply)

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps an axis takes to slow down from a speed [steps/s]."""
        return self._checks.playbacks[axis].steps_from(interval_ticks(speed_steps_per_s, self.timer_hz))

    def trace_moves(self, axis: int | None, every_steps: int) -> NextTrace:
        """Trace every so many-th step of each move of an axis from now on; see Controller."""
        if axis is not None:
            self._checks.known_axes([AxisCommand(axis, 0, "traced_axis")])
        return self._tracing.arm(axis, every_steps)

    def _moving_axis(self) -> int | None:
        axes = () if self._status is None else self._status.axes
        return next((axis.axis for axis in axes if axis.activity in UNDER_WAY), None)

    def _stopped_by(self) -> tuple[StopCause, ...]:
        of_inputs = self.status().of_inputs
        return () if of_inputs is None else of_inputs.stopped_by

    def _refuse_in_emergency(self) -> None:
        """Refuse by what was last heard: a controller of this version sees to it itself."""
        if self._status is not None:
            refuse_in_emergency(self._status)

    def _move(self, commands: Sequence[AxisCommand], request: type[AxesRequest]) -> None:
        values = self._checks.whole_values(commands)
        rejected = self._checks.unless_too_fast(self._moving, commands, self._checks.slew_intervals(values))
        starts = self._tracing.prepare(values, self._hear)
        targets = self._conversation.ask(
            request(mask_of(values), tuple(values[axis] for axis in sorted(values))), TargetsReply, rejected
        )
        if len(targets.targets_steps) != len(values):
            told = f"{len(targets.targets_steps)} targets for {len(values)} axes"
            raise DeviceLost(f"The controller at {self._port_name} gives answers without sense: {told}.")
        self._checks.run_no_more(values)
        reached = dict(zip(sorted(values), targets.targets_steps, strict=True))
        distances = {axis: reached[axis] - start for axis, start in starts.items()}
        self._tracing.moves(distances, self._checks.playbacks, self.timer_hz)

    def _moving(self, anew: bool) -> dict[int, int]:
        """Return the axes that move with their present intervals [ticks], as last heard or as asked anew."""
        status = self._status if self._status is not None and not anew else self.status()
        moving = [axis for axis in status.axes if axis.activity in UNDER_WAY]
        return {axis.axis: interval_ticks(axis.speed_steps_per_s, self.timer_hz) for axis in moving}

    def _status_replies(self) -> list[StatusReply]:
        """Ask axis by axis, and again when something more urgent came in between: a stop makes the answers old."""
        image = self._storage.image
        count = len(image.axes) if image else 1
        while True:
            others = self._conversation.requests_made
            replies = [self._conversation.ask(StatusRequest(axis), StatusReply) for axis in range(count)]
            if self._conversation.requests_made == others + count:
                return replies

    def _hear(self) -> None:
        """Take what the controller has said unasked, up to now."""
        self._conversation.listen()
        self._take_notices()

    def _take_notices(self) -> None:
        for notice in self._conversation.notices():
            if isinstance(notice, ReportNotice):
                self._report = notice
            elif isinstance(notice, TraceNotice):
                self._tracing.take(notice)

    def _mask(self, axes: Collection[int] | None) -> bytes:
        """Return which axes are to stop: nothing, which is all, also when one of them is unknown."""
        known = range(len(self._checks.playbacks))
        return b"" if axes is None or not all(axis in known for axis in axes) else bytes([mask_of(axes)])

    def _use(self) -> None:
        """Check what is asked against the ramps and settings in use."""
        self._checks.use(self._storage.image, self.identity, self._storage.settings)
        self._conversation.roles = self._storage.settings.inputs or ()
        self._conversation.soft_limits = self._storage.settings.soft_limits or ()
