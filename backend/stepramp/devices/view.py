"""What is known of a device at one moment."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from time import monotonic

from stepramp.controllers.capabilities import CapabilityName
from stepramp.controllers.contract import Activity, AxisStatus, ControllerStatus, PushReport, StoredRamp
from stepramp.controllers.inputs import InputStatus, StopCause
from stepramp.controllers.progress import Progress
from stepramp.devices.proof import Proof, pending_words
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import FREE, Span, trouble_of
from stepramp.errors import Refused, Rejected


class DeviceState(StrEnum):
    """Where a device is between connecting and being lost."""

    CONNECTING = "connecting"
    READY = "ready"
    MOVING = "moving"
    STOPPING = "stopping"
    WRITING = "writing"
    LOST = "lost"


STATES = {activity: DeviceState(activity.value) for activity in Activity}
UNDER_WAY = (DeviceState.MOVING, DeviceState.STOPPING)


@dataclass(frozen=True)
class AxisView:
    """An axis as it was at one moment; positions [steps], speed without sign [steps/s]."""

    axis: int
    state: DeviceState
    position_steps: int
    target_steps: int
    speed_steps_per_s: float
    steps_made: int
    steps_per_mm: float | None = None
    """As the controller itself is set; None for one that counts in steps only."""
    microsteps: int | None = None
    """How many of its steps the controller makes of a full step; None where it doesn't tell."""
    lowest_steps: int | None = None
    """Soft limits; None for none."""
    highest_steps: int | None = None
    counts_from_known: bool | None = None
    """Whether its controller says that it is known to be there; None for one that doesn't tell."""
    may_be_elsewhere: bool = False
    """It may be elsewhere than its controller counts, or count from another place: see unknown_positions."""
    homing: bool | None = None
    """Whether it is being homed; None for a controller that doesn't tell."""
    position_told: bool = True
    """Whether the controller tells where it is; otherwise position and target say nothing."""

    @property
    def position_known(self) -> bool | None:
        """Whether it is known that it is there; None for a controller that doesn't tell."""
        return self.counts_from_known and not self.may_be_elsewhere

    @property
    def limits_hold(self) -> bool:
        """Whether it has soft limits and is kept within them: to be homed is to go wherever the switch is."""
        return not self.homing and Span(self.lowest_steps, self.highest_steps) != FREE

    @property
    def is_beyond_limits(self) -> bool:
        """Whether it is where its soft limits let nothing send it: they may be set wherever it is."""
        return self.position_told and not Span(self.lowest_steps, self.highest_steps).contains(self.position_steps)

    def away(self) -> "AxisView":
        """Return the axis as it is while its controller is started anew: it makes no steps, and was there."""
        return replace(
            self, state=DeviceState.CONNECTING, target_steps=self.position_steps, speed_steps_per_s=0.0, homing=None
        )

    def limited(self, span: Span) -> "AxisView":
        """Return the axis with soft limits."""
        return replace(self, lowest_steps=span.lowest_steps, highest_steps=span.highest_steps)

    def stopping(self) -> "AxisView":
        """Return the axis as it is once a stop was granted; where it will come to rest is still to be asked."""
        if self.state is not DeviceState.MOVING:
            return self
        return replace(self, state=DeviceState.STOPPING, target_steps=self.position_steps)


@dataclass(frozen=True)
class DeviceView:
    """A device as it was at one moment. Position, target and speed are those of axis 0."""

    id: str
    port: str
    name: str
    family: str
    """The name of the family of its controller."""
    capabilities: tuple[CapabilityName, ...] = ()
    """What the controller can do besides what all can; known once connected."""
    state: DeviceState = DeviceState.CONNECTING
    message: str | None = None
    """Why the device is lost, or what keeps its motors from being moved."""
    midst: tuple[str, ...] = ()
    """What was going on when it was lost, for somebody who wonders what has come of it."""
    displaced_by: str = ""
    """Which other board is at its port while it is lost, with which the message ends; empty for none."""
    displaced_as: str = ""
    """The id of that one."""
    position_steps: int = 0
    target_steps: int = 0
    speed_steps_per_s: float = 0.0
    axes: tuple[AxisView, ...] = ()
    """Each axis that has a ramp; the first one in any case, once connected."""
    timer_hz: int | None = None
    """Known once connected, as are the clocks, the firmware's version and the ramp; None without a step timer."""
    clocks_hz: tuple[int, ...] | None = None
    most_axes: int | None = None
    """How many axes it can have; known once connected."""
    firmware_version: str | None = None
    ramp: StoredRamp | None = None
    on_trial: bool = False
    motors_on: bool = False
    starved: int | None = None
    pushed: PushReport | None = None
    """The last push over this connection, or before its controller was started anew from here."""
    backup: str | None = None
    """The name of the last backup that was saved over this connection, or that before it was lost."""
    half_written: str | None = None
    """What to do about settings in the midst of which it was lost, until what it had before is written."""
    lacks_backup: str | None = None
    """The name of the backup of what it had before; None for none."""
    unproven: tuple[str, ...] = ()
    """Settings that it was given, and of which its next start proves whether they are stored."""
    unproven_damage: str | None = None
    """Why it isn't known what of that it was given before, as a sentence; None: it is."""
    proof: Proof | None = None
    """What its last start has shown of such; None for nothing."""
    proving: bool = False
    """Its controller is started anew from here to prove them; all else is how it was before."""
    progress: Progress | None = None
    """How far the push has come that is under way."""
    shuttle: Shuttle | None = None
    """An axis goes there and back."""
    ended_by: Refused | Rejected | None = None
    """What such a one was refused, by which it ended by itself, until another motion is asked for."""
    unknown_positions: tuple[int, ...] = ()
    """Axes that may be elsewhere than they count, since the device was lost, or somebody else has homed them."""
    zeroing: tuple[int, ...] = ()
    """Axes on their way to the stop of a gauge, which says where they are once they have come there."""
    after_homing: Mapping[int, int] = field(default_factory=dict)
    """Axes that are being homed, or wait for their name, and what the place that they find is to be called [steps]."""
    inputs: tuple[InputStatus, ...] | None = None
    """Those that are for something; None for a controller without any."""
    stopped_by: tuple[StopCause, ...] | None = None
    """What has stopped all motion, until it is acknowledged; None for a controller without inputs."""
    in_control: str | None = None
    """The page that is in control of the device."""
    in_control_at: str | None = None
    """Where that page is; None where pages are on this machine only, or none is."""
    stops: int = 0
    """A number that grows with each stop."""
    stop_refused: str | None = None
    """Why it doesn't stop, though that was asked for, until it rests or sets out anew; None: it has refused no stop."""
    soft_limits: Mapping[int, Span] = field(default_factory=dict)
    """Of the axes that have some."""
    heard_s: float = field(default=0.0, compare=False)
    """When the controller said so, by the monotonic clock; 0 before it has said anything [s]."""

    def __post_init__(self) -> None:
        """Have each axis say whether it may be elsewhere."""
        unknown = self.unknown_positions
        if any(axis.may_be_elsewhere != (axis.axis in unknown) for axis in self.axes):
            axes = tuple(replace(axis, may_be_elsewhere=axis.axis in unknown) for axis in self.axes)
            object.__setattr__(self, "axes", axes)

    @property
    def unproven_words(self) -> str | None:
        """What is to be said of the unproven ones that are in use; None for nothing."""
        others = () if self.proof is None else self.proof.not_kept
        return pending_words([name for name in self.unproven if name not in others])

    @property
    def age_s(self) -> float | None:
        """How long ago the controller said so [s]; None before it has said anything."""
        return monotonic() - self.heard_s if self.heard_s else None

    def with_status(self, status: ControllerStatus) -> "DeviceView":
        """Return the device as its controller now says it is."""
        first = status.axes[0]
        resting = {axis.axis: axis.position_steps for axis in status.axes if axis.activity is Activity.READY}
        not_kept = None if self.proof is None else self.proof.trouble
        of_limits = trouble_of(self.soft_limits, status.axes)
        words = (self.stop_refused, status.trouble, of_limits, self.half_written, not_kept, self.unproven_damage)
        said = [each for each in words if each]
        if self.ended_by is not None and str(self.ended_by) not in said:
            said.append(f"To and fro has ended: {self.ended_by}")
        arrived = [axis for axis in self.zeroing if resting.get(axis) == 0]
        untold = {axis.axis for axis in self.axes if not axis.position_told}
        # Homed by somebody else: where its limits are now depends on what it counted from when they were set.
        homed = {axis.axis for axis in status.axes if axis.position_told and axis.axis in untold} & set(
            self.soft_limits
        )
        found = {axis.axis for axis in status.axes if axis.position_known and not axis.homing} & {*self.after_homing}
        nameless = {axis for axis in found if self.after_homing[axis]}
        rests = status.activity is Activity.READY
        return replace(
            self,
            # Not done before the places that were found have their names.
            state=DeviceState.MOVING if rests and nameless else STATES[status.activity],
            position_steps=first.position_steps,
            target_steps=first.target_steps,
            speed_steps_per_s=first.speed_steps_per_s,
            axes=tuple(_axis_view(axis, self.soft_limits.get(axis.axis, FREE)) for axis in status.axes),
            ramp=status.ramp,
            on_trial=status.on_trial,
            motors_on=status.motors_on,
            starved=status.starved,
            message=" ".join(said) or None,
            midst=(),
            inputs=None if status.of_inputs is None else status.of_inputs.inputs,
            stopped_by=None if status.of_inputs is None else status.of_inputs.stopped_by,
            zeroing=tuple(axis for axis in self.zeroing if axis not in resting),
            unknown_positions=tuple(sorted({*self.unknown_positions, *homed})),
            proving=False,
        ).with_known_positions({*arrived, *(found - nameless)})

    def with_kept(self, remarks: Iterable[str]) -> "DeviceView":
        """Return the device once what was on trial is stored: the report of its last push is of that then."""
        if self.pushed is None or self.pushed.kept:
            return self
        sequence = None if self.ramp is None else self.ramp.sequence
        return replace(self, pushed=self.pushed.as_kept(sequence, remarks))

    def with_zeroing(self, axes: Collection[int]) -> "DeviceView":
        """Return the device once axes have set out to the stop of a gauge."""
        return replace(self, zeroing=(*self.zeroing, *axes))

    def without_errand(self, axes: Collection[int] | None) -> "DeviceView":
        """Return the device once axes, or all, go somewhere else than they were on their way to by themselves."""
        zeroing = () if axes is None else tuple(axis for axis in self.zeroing if axis not in axes)
        return replace(self, shuttle=None, zeroing=zeroing)

    def with_homing(self, positions_steps: Mapping[int, int]) -> "DeviceView":
        """Return the device once axes are being homed, with what the places that they find are to be called [steps].

        Until those have their names where they are isn't known: soft limits would hold at other places.
        """
        unknown = tuple(sorted({*self.unknown_positions, *positions_steps}))
        return replace(self, after_homing={**self.after_homing, **positions_steps}, unknown_positions=unknown)

    def without_homing(self, axes: Collection[int]) -> "DeviceView":
        """Return the device once nothing is to be done any more after axes were homed."""
        left = {axis: at for axis, at in self.after_homing.items() if axis not in axes}
        return replace(self, after_homing=left)

    def anew(self, port: str, name: str) -> "DeviceView":
        """Return the device as it is while it is connected again: what is known of it stays, what it said doesn't."""
        return DeviceView(
            self.id,
            port,
            name,
            self.family,
            capabilities=self.capabilities,
            unknown_positions=self.unknown_positions,
            in_control=self.in_control,
            in_control_at=self.in_control_at,
            stops=self.stops,
            soft_limits=self.soft_limits,
            backup=self.backup,
            half_written=self.half_written,
            lacks_backup=self.lacks_backup,
            unproven=self.unproven,
            unproven_damage=self.unproven_damage,
            proof=self.proof,
        )

    def starting_anew(self) -> "DeviceView":
        """Return the device as it is while its controller is started anew: where it was, that forgets.

        It is known that it is the same one, so what was pushed to it, and what axes it has, stay in view.
        """
        unknown = tuple(sorted({*self.unknown_positions, *(axis.axis for axis in self.axes)}))
        return replace(
            self.anew(self.port, self.name),
            axes=tuple(axis.away() for axis in self.axes),
            most_axes=self.most_axes,
            firmware_version=self.firmware_version,
            ramp=self.ramp,
            pushed=self.pushed,
            proving=True,
            unknown_positions=unknown,
        )

    def known_before(self, before: "DeviceView") -> "DeviceView":
        """Return the device with what was known of its board when that was let go of."""
        unknown = tuple(sorted({*self.unknown_positions, *before.unknown_positions}))
        return replace(self, soft_limits={**before.soft_limits, **self.soft_limits}, unknown_positions=unknown)

    def limited(self, spans: Mapping[int, Span], shown: Collection[AxisView]) -> "DeviceView":
        """Return the device with these soft limits, besides those that other axes have.

        shown: the axes in whose steps they are meant.
        """
        now = {axis: span for axis, span in spans.items() if span != FREE}
        for each in shown:
            if each.axis in now:
                span = now[each.axis]
                now[each.axis] = replace(span, microsteps=each.microsteps, steps_per_mm=each.steps_per_mm)
        limits = {**{axis: span for axis, span in self.soft_limits.items() if axis not in spans}, **now}
        axes = tuple(each.limited(limits.get(each.axis, FREE)) for each in self.axes)
        return replace(self, soft_limits=limits, axes=axes)

    def stopping(self, axes: Collection[int] | None) -> "DeviceView":
        """Return the device as it is once a stop of axes, or all, was granted, before it is asked again."""
        now = tuple(each.stopping() if axes is None or each.axis in axes else each for each in self.axes)
        slows_down = self.state is DeviceState.MOVING and DeviceState.MOVING not in {axis.state for axis in now}
        target_steps = now[0].target_steps if now else self.target_steps
        state = DeviceState.STOPPING if slows_down else self.state
        return replace(self, axes=now, state=state, target_steps=target_steps)

    def with_known_positions(self, axes: Collection[int]) -> "DeviceView":
        """Return the device once somebody has said where axes are."""
        return replace(self, unknown_positions=tuple(axis for axis in self.unknown_positions if axis not in axes))

    def lost(self, message: str) -> "DeviceView":
        """Return the device as it is once its controller is no longer there: what it said last stays, and its age."""
        axes = tuple(replace(axis, state=DeviceState.LOST) for axis in self.axes)
        # What went on was seen while it was there: of a lost one, part of that can't be told any more.
        midst = self.midst if self.state is DeviceState.LOST else tuple(self._midst())
        return replace(
            self,
            state=DeviceState.LOST,
            message=" ".join((message, *midst)),
            midst=midst,
            displaced_by="",
            displaced_as="",
            axes=axes,
            unknown_positions=tuple(sorted({*self.unknown_positions, *(axis.axis for axis in self.axes)})),
            progress=None,
            shuttle=None,
            after_homing={},
            proving=False,
        )

    def displaced(self, by: str, device_id: str) -> "DeviceView":
        """Return the device as it is while it is lost, and another board is at its port; not one that is back."""
        if self.state is not DeviceState.LOST:
            return self
        other = (
            f"Another board is at its port now, {by}: that is device {device_id}. This one is connected again once it "
            "is back."
        )
        before = self._message_without_other
        return replace(self, message=f"{before} {other}".lstrip(), displaced_by=other, displaced_as=device_id)

    def displaced_no_more(self, device_id: str) -> "DeviceView":
        """Return the device as it is once another one is forgotten, whether that was at its port or not."""
        if not device_id or self.displaced_as != device_id:
            return self
        return replace(self, message=self._message_without_other or None, displaced_by="", displaced_as="")

    @property
    def _message_without_other(self) -> str:
        return (self.message or "").removesuffix(self.displaced_by).rstrip()

    def still_lost(self, message: str, now: "DeviceView") -> "DeviceView":
        """Return the device as it was before an attempt to connect it failed; what it doesn't say itself is of now."""
        return replace(
            self.lost(message),
            port=now.port,
            name=now.name,
            unknown_positions=now.unknown_positions,
            in_control=now.in_control,
            in_control_at=now.in_control_at,
            stops=now.stops,
            soft_limits=now.soft_limits,
        )

    def left_half_written(self) -> "DeviceView":
        """Return the device as it is lost while it is given settings. Lost again, it lacks what it had at first."""
        if self.half_written or "backup" not in self.capabilities:
            return self
        saved = f" What it had is saved as {self.backup}: restore that." if self.backup else ""
        half_written = f"It was lost while it was given settings: some may be new, some old, or its defaults.{saved}"
        return replace(self, half_written=half_written, lacks_backup=self.backup)

    def let_go(self) -> "DeviceView":
        """Return the device as it is once it is disconnected on purpose.

        Until it is connected again it may be moved by others, and count anew: nobody knows where its limits are then.
        """
        unknown = tuple(sorted({*self.unknown_positions, *self.soft_limits}))
        return replace(self.lost("Disconnected."), unknown_positions=unknown)

    def _midst(self) -> Iterator[str]:
        """Yield what was going on, for somebody who wonders what has come of it."""
        if self.half_written:
            yield self.half_written
        elif self.state is DeviceState.WRITING and "backup" not in self.capabilities:
            yield "It was being given ramps or settings: it has the old ones or the new ones whole, never a mixture."
        for axis in self.axes:
            if axis.state in UNDER_WAY:
                heard = f", last heard of at {axis.position_steps:,} steps" if axis.position_told else ""
                yield f"Axis {axis.axis} was moving{heard}."


def _axis_view(status: AxisStatus, span: Span) -> AxisView:
    return AxisView(
        axis=status.axis,
        state=STATES[status.activity],
        position_steps=status.position_steps,
        target_steps=status.target_steps,
        speed_steps_per_s=status.speed_steps_per_s,
        steps_made=status.steps_made,
        steps_per_mm=status.steps_per_mm,
        microsteps=status.microsteps,
        lowest_steps=span.lowest_steps,
        highest_steps=span.highest_steps,
        counts_from_known=status.position_known,
        homing=status.homing,
        position_told=status.position_told,
    )
