"""The virtual controller's machine: up to four motors, alone, at the same time, or along a straight line."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import TypeVar

from stepramp.controllers.stepramp.input_roles import INPUTS
from stepramp.controllers.stepramp.messages.axes import MOST_AXES, mask_of
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.messages.status import AxisState, StopBit
from stepramp.controllers.stepramp.playback import playback_of, unpacked
from stepramp.controllers.stepramp.ramp_image import AxisRamp, RampImage
from stepramp.controllers.stepramp.settings import MOST_GAUGES, StepRampSettings
from stepramp.controllers.stepramp.speed_limits import Pace, SpeedLimits
from stepramp.controllers.virtual.homing import Stage, VirtualHoming
from stepramp.controllers.virtual.line import VirtualLine
from stepramp.controllers.virtual.motor_state import state_of
from stepramp.controllers.virtual.soft_limits import VirtualSoftLimits
from stepramp.controllers.virtual.streams import TraceRecorder
from stepramp.controllers.virtual.world import VirtualInputs, VirtualWorld
from stepramp.ramp.playback.motor import Motor
from stepramp.ramp.playback.trajectory import Playback
from stepramp.units import ticks_from_us

POSITIONS = range(-(2**31), 2**31)
GUARD_LATE_S = 0.256
"""So much later than their settings say boards may notice that nobody asks any more [s]."""

T = TypeVar("T")


class VirtualMachine:
    """Motors that move by a clock [s]. They are where the last call of `settle` found them."""

    def __init__(self, clock: Callable[[], float], hello: HelloReply, world: VirtualWorld) -> None:
        self._clock = clock
        self._hello = hello
        self._settings = StepRampSettings()
        self._origins = list(world.places)
        """At which place each axis' position 0 is [steps]."""
        self.inputs = VirtualInputs(world, self.place)
        self._homing: dict[int, VirtualHoming] = {}
        self._known: set[int] = set()
        self._soft_limits = VirtualSoftLimits(self._known, self.position)
        self._settled = 0
        self._ramps: Sequence[AxisRamp] = ()
        self._timer_hz = hello.slow_clock_hz
        self._positions = [0] * MOST_AXES
        self._playbacks: list[Playback] = []
        self._motors: list[Motor] = []
        self._line: VirtualLine | None = None
        self._enabled_s: float | None = None
        """Since when the motors are switched on; None: they are not."""
        self._rested_s = 0.0
        self._heard_s = 0.0
        self.trace: TraceRecorder | None = None

    @property
    def axes(self) -> int:
        """Axes of the image in use; 0 without one."""
        return len(self._motors)

    @property
    def moving(self) -> bool:
        """Whether any axis moves."""
        return self._line is not None or any(motor.moving for motor in self._motors)

    @property
    def on_a_line(self) -> bool:
        """Whether a line is under way."""
        return self._line is not None

    @property
    def homing(self) -> Collection[int]:
        """The axes that are being homed."""
        return self._homing.keys()

    @property
    def known(self) -> Collection[int]:
        """The axes whose position is known."""
        return self._known

    def place(self, axis: int) -> int:
        """Return where in its world an axis is [steps]."""
        return self.position(axis) + self._origins[axis]

    @property
    def enabled(self) -> bool:
        """Whether the motors are switched on."""
        return self._enabled_s is not None

    def use(self, image: RampImage | None, settings: StepRampSettings) -> None:
        """Use the ramps of an image from now on, at rest; None: there are none."""
        self._settings = settings
        fast = image is not None and image.fast_clock
        self._timer_hz = self._hello.fast_clock_hz if fast else self._hello.slow_clock_hz
        for axis, motor in enumerate(self._motors):
            self._positions[axis] = motor.position
        self._playbacks = [playback_of(ramp) for ramp in image.axes] if image else []
        self._motors = [self._motor(axis) for axis in range(len(self._playbacks))]
        self._ramps = image.axes if image else ()
        self._settled = self._now()
        self._soft_limits.use(settings.soft_limits or ())
        roles = settings.inputs or ()
        self.inputs.use(
            role for role in roles if settings.outputs != "gauges" or role.input not in INPUTS[-MOST_GAUGES:]
        )

    def watch(self, trace: TraceRecorder | None) -> None:
        """Trace the moves of an axis that begin from now on; None: no more of them."""
        self.trace = trace
        for axis, motor in enumerate(self._motors):
            motor.watch = trace if trace is not None and trace.axis == axis else None

    def steps_a_trace_value(self, axis: int, values_a_second: int) -> int:
        """Return k, so that every k-th step of an axis comes so many times a second at full speed."""
        return -(-(self._timer_hz // values_a_second) // self._playbacks[axis].slew_interval)

    def heard(self) -> None:
        """Note that a request has come: what runs at a speed may go on."""
        self._heard_s = self._clock()

    def settle(self) -> None:
        """Move to where all motors are by now."""
        silence_s = (self._settings.silence_s or 0) + GUARD_LATE_S
        was_moving, guarded_until = self.moving, int((self._heard_s + silence_s) * self._timer_hz)
        if self._now() > guarded_until:
            self._settle_until(guarded_until)
            all_end = self._settings.silence_ends_moves
            self.stop([axis for axis, motor in enumerate(self._motors) if motor.running or all_end])
        self._settle_until(self._now())
        self._note_rest(was_moving)
        hold_ms = self._settings.enable_hold_ms
        if not self.moving and hold_ms is not None and self._clock() - self._rested_s >= hold_ms / 1000:
            self._enabled_s = None

    def state(self, axis: int) -> AxisState:
        """Return what an axis is doing."""
        return self._line.state(axis) if self._line else self._asked(axis, state_of, AxisState.IDLE)

    def position(self, axis: int) -> int:
        """Return where an axis is [steps]."""
        return self._asked(axis, lambda motor: motor.position, self._positions[axis])

    def target(self, axis: int) -> int:
        """Return where an axis will come to rest [steps]."""
        if self._line is not None and self._line.leads(axis):
            return self._line.target(axis)
        return self._asked(axis, lambda motor: motor.target, self._positions[axis])

    def interval(self, axis: int) -> int:
        """Return the present interval of an axis [ticks]; 0 at rest."""
        return self._line.interval(axis) if self._line else self._asked(axis, lambda motor: motor.interval, 0)

    def steps_made(self, axis: int) -> int:
        """Return the steps of an axis since it last set out from rest."""
        return self._asked(axis, lambda motor: motor.steps_made, 0)

    def move_by(self, steps: Mapping[int, int]) -> dict[int, int] | Refusal:
        """Move axes from their targets, those that run from where they are, and return the new targets."""
        targets = {axis: self._motors[axis].target + count for axis, count in steps.items()}
        return self._out_of_range(targets) or self.move_to(targets)

    def move_to(self, targets: dict[int, int]) -> dict[int, int] | Refusal:
        """Move axes to positions, and return them."""
        refusal = (
            self._without_pins(targets)
            or self._blocked({axis: target - self.position(axis) for axis, target in targets.items()})
            or self._soft_limits.refuse_targets(targets)
            or self._too_fast({axis: self._playbacks[axis].slew_interval for axis in targets})
        )
        if refusal is None:
            self._begin(targets)
        return refusal or targets

    def _begin(self, targets: Mapping[int, int]) -> None:
        ready = self._ready()
        for axis, target in targets.items():
            self._motors[axis].move_to(target, ready)
        self._enable()

    def run(self, intervals: Mapping[int, int]) -> Refusal | None:
        """Run axes at intervals [ticks], negative for backwards; 0: stop."""
        running = {axis: interval for axis, interval in intervals.items() if interval}
        if refusal := self._without_pins(intervals):
            return refusal
        for axis, interval in running.items():
            if not self._playbacks[axis].slew_interval <= abs(interval) <= self._hello.longest_interval_ticks:
                return Refusal(ReplyStatus.OUT_OF_RANGE, axis)
        refusal = (
            self._blocked(running)
            or self._soft_limits.refuse_runs(running)
            or self._too_fast({axis: abs(each) for axis, each in running.items()})
        )
        if refusal is None:
            self.stop(axis for axis in intervals if axis not in running)
            ready = self._ready()
            for axis, interval in running.items():
                direction = 1 if interval > 0 else -1
                self._motors[axis].run(abs(interval), direction, ready, self._soft_limits.end(axis, direction))
            self._enable()
        return refusal

    def line(self, steps: dict[int, int], ramp_axis: int) -> dict[int, int] | Refusal:
        """Move axes along a straight line, at rest, and return their targets."""
        targets = {axis: self._motors[axis].position + count for axis, count in steps.items()}
        going = [axis for axis, count in steps.items() if count]
        if refusal := self._without_pins(steps):
            return refusal
        if ramp_axis >= self.axes or self._settings.outputs == "gauges":
            return Refusal(ReplyStatus.OUT_OF_RANGE, ramp_axis)
        paces = [Pace(self._playbacks[ramp_axis].slew_interval, line_axes=len(going))] if going else []
        refusal = (
            self._out_of_range(targets)
            or self._blocked(steps)
            or self._soft_limits.refuse_targets({axis: targets[axis] for axis in going})
            or self._too_much(paces)
        )
        if refusal is None and going:
            watches = {self.trace.axis: self.trace} if self.trace and self.trace.axis in going else {}
            led = {axis: self._motors[axis] for axis in going}
            self._line = VirtualLine(led, {axis: steps[axis] for axis in going}, self._playbacks[ramp_axis], watches)
            self._line.begin(self._ready())
            self._enable()
            self.settle()
        return refusal or targets

    def set_position(self, positions: Mapping[int, int]) -> None:
        """Call the places of axes at rest these positions [steps]."""
        for axis, position in positions.items():
            self._origins[axis] += self._motors[axis].position - position
            self._motors[axis].set_position(position)
        self._known.update(positions)

    def zero(self, axes: Collection[int], steps: int) -> Refusal | None:
        """Call the places of axes at rest so many steps, and move them to 0."""
        slew_intervals = {axis: self._playbacks[axis].slew_interval for axis in axes}
        refusal = self._without_pins(axes) or self._blocked(dict.fromkeys(axes, -1)) or self._too_fast(slew_intervals)
        if refusal is None:
            self.set_position(dict.fromkeys(axes, steps))
            self._begin(dict.fromkeys(axes, 0))
        return refusal

    def home(self, intervals: Mapping[int, int], slow_interval: int, back_off_steps: int) -> Refusal | None:
        """Begin to find the limit switches of axes at rest, at intervals [ticks], negative for backwards."""
        for axis, interval in intervals.items():
            shortest = min(abs(interval), slow_interval)
            longest = max(abs(interval), slow_interval)
            slew = self._playbacks[axis].slew_interval
            fits = slew <= shortest and longest <= self._hello.longest_interval_ticks and back_off_steps > 0
            if not fits or self.inputs.limit(axis, interval) is None:
                return Refusal(ReplyStatus.OUT_OF_RANGE, axis)
        fast = {axis: abs(interval) for axis, interval in intervals.items()}
        if refusal := self._without_pins(intervals) or self._blocked({}) or self._too_fast(fast):
            return refusal
        ready = self._ready()
        for axis, interval in intervals.items():
            direction = 1 if interval > 0 else -1
            self._known.discard(axis)
            self._homing[axis] = VirtualHoming(axis, direction, slow_interval, back_off_steps)
            if self.inputs.in_the_way(axis, direction):
                self._homing[axis].look(self._motors[axis], self.inputs, ready)
            else:
                self._motors[axis].run(abs(interval), direction, ready)
        self._enable()
        return None

    def emergency(self) -> Refusal | None:
        """Refuse to change what inputs are for: an emergency stop may be pressed still."""
        pressed = self.inputs.stopped_by & StopBit.EMERGENCY_STOP
        return Refusal(ReplyStatus.STOPPED, self.inputs.active) if pressed else None

    def acknowledge(self) -> Refusal | None:
        """Let motions be taken again."""
        if self.inputs.active_stops:
            return Refusal(ReplyStatus.STOPPED, self.inputs.active)
        self.inputs.stopped_by = StopBit(0)
        return None

    def stop(self, axes: Iterable[int]) -> None:
        """Slow axes down to rest, a line as a whole; what has not set out yet doesn't."""
        self._end(axes, Motor.stop, VirtualLine.stop)

    def halt(self, axes: Iterable[int]) -> None:
        """Make no further step with axes; a line ends as a whole."""
        axes = list(axes)
        self._lose_places(axes)
        self._end(axes, Motor.halt, VirtualLine.halt)

    def look(self) -> None:
        """Look at the inputs, and do what they say."""
        if stops := self.inputs.active_stops:
            self.inputs.stopped_by |= stops
            self.halt(range(self.axes))
        for axis in range(self.axes):
            self._home_on(axis)
            if self.state(axis) == AxisState.IDLE:
                continue
            if (role := self.inputs.in_the_way(axis, self._direction(axis))) is not None:
                self._end_at_limit(axis, at_once=role.stops == "at_once")

    def _end_at_limit(self, axis: int, *, at_once: bool) -> None:
        """Stop an axis, or the line that it is on, which doesn't end its being homed."""
        if at_once:
            self._lose_places([axis])
        if self._line is not None:
            (self._line.halt if at_once else self._line.stop)()
            self._settle_at(self._settled)
        elif at_once:
            self._motors[axis].halt()
        else:
            self._motors[axis].stop()

    def _home_on(self, axis: int) -> None:
        homing = self._homing.get(axis)
        if homing is None:
            return
        homing.look(self._motors[axis], self.inputs, self._settled)
        if homing.stage is Stage.FOUND:
            self._motors[axis].halt()
            self.set_position({axis: self.inputs.beyond(axis, homing.direction)})
        if homing.stage in (Stage.FOUND, Stage.GIVEN_UP):
            del self._homing[axis]

    def _end(self, axes: Iterable[int], end: Callable[[Motor], None], end_line: Callable[[VirtualLine], None]) -> None:
        was_moving = self.moving
        for axis in axes:
            self._homing.pop(axis, None)
            if self._line is None:
                end(self._motors[axis])
            elif self._line.state(axis):
                end_line(self._line)
                self._settle_at(self._settled)
        self._note_rest(was_moving)

    def _lose_places(self, axes: Iterable[int]) -> None:
        """Note that it isn't known where axes are that are halted at speed, on a line all of them."""
        named = set(axes)
        if self._line is not None and any(self._line.state(axis) for axis in named):
            named |= {axis for axis in range(self.axes) if self._line.leads(axis)}
        self._known -= {axis for axis in named if 0 < self.interval(axis) < self._longest(axis)}

    def _longest(self, axis: int) -> int:
        ramp = unpacked(self._ramps[axis])
        return int(max([self._playbacks[axis].slew_interval, *ramp.up, *ramp.down]))

    def _direction(self, axis: int) -> int:
        return self._motors[axis].direction if self._line is None else self._line.direction(axis)

    def _settle_until(self, until: int) -> None:
        """Let time go on, and look at the inputs whenever one of them may have changed."""
        while self.moving and (look := self._next_look()) is not None and look < until:
            self._settle_at(look)
            self.look()
        self._settle_at(until)
        self.look()

    def _next_look(self) -> int | None:
        """Return when a limit switch may have changed, at the earliest, or a homing goes on; None: nothing may."""
        looks = []
        for axis in range(self.axes):
            due = self._motors[axis].due_ticks if self._line is None else self._line.due_ticks
            ways = [self.inputs.steps_to_change(axis)]
            if axis in self._homing:
                ways += [self._homing[axis].steps_to_turn, 1]
            steps = min((way for way in ways if way is not None), default=None)
            if steps is not None and self.state(axis) != AxisState.IDLE:
                looks.append(due + max(0, steps - 1) * self._fastest)
        return min(looks, default=None)

    @property
    def _fastest(self) -> int:
        return min(playback.slew_interval for playback in self._playbacks)

    def _settle_at(self, now: int) -> None:
        self._settled = now
        if self._line is not None:
            if not self._line.settle(now):
                self._line = None
            return
        for motor in self._motors:
            motor.settle(now)

    def _motor(self, axis: int) -> Motor:
        setup_ticks = round(ticks_from_us(self._settings.direction_setup_us, self._timer_hz))
        watch = self.trace if self.trace is not None and self.trace.axis == axis else None
        return Motor(self._playbacks[axis], setup_ticks, self._positions[axis], watch)

    def _ready(self) -> int:
        """Return from when on motors can set out: they are given time to hold [ticks]."""
        now_s = self._clock()
        enabled_s = now_s if self._enabled_s is None else self._enabled_s
        return int(max(now_s, enabled_s + self._settings.enable_lead_ms / 1000) * self._timer_hz)

    def _enable(self) -> None:
        """Switch the motors on if one of them is to move."""
        if self.moving and self._enabled_s is None:
            self._enabled_s = self._clock()

    def _note_rest(self, was_moving: bool) -> None:
        if was_moving and not self.moving:
            self._rested_s = self._clock()

    def _now(self) -> int:
        return int(self._clock() * self._timer_hz)

    def _asked(self, axis: int, what: Callable[[Motor], T], without: T) -> T:
        return what(self._motors[axis]) if axis < self.axes else without

    def _blocked(self, directions: Mapping[int, int]) -> Refusal | None:
        """Refuse motions after an emergency stop, and those into a limit switch, by the sign of their directions."""
        if self.inputs.stopped_by:
            return Refusal(ReplyStatus.STOPPED, self.inputs.active)
        for axis, direction in directions.items():
            if direction and (role := self.inputs.in_the_way(axis, direction)) is not None:
                return Refusal(ReplyStatus.AT_LIMIT, axis | INPUTS.index(role.input) << 8)
        return None

    def _too_fast(self, shortest: Mapping[int, int]) -> Refusal | None:
        """Refuse axes with these shortest intervals [ticks] if they can't be served next to those that move."""
        going = dict(shortest)
        for axis, motor in enumerate(self._motors):
            if motor.moving:
                going[axis] = motor.shortest_interval(shortest.get(axis))
        return self._too_much([Pace(interval, self._playbacks[axis].by_formula) for axis, interval in going.items()])

    def _too_much(self, paces: Collection[Pace]) -> Refusal | None:
        share = SpeedLimits.of(self._hello, self._settings, self._timer_hz).share(paces)
        return Refusal(ReplyStatus.TOO_FAST, int(100 * share)) if share > 1 else None

    def _without_pins(self, axes: Collection[int]) -> Refusal | None:
        """Refuse axes of which one is a gauge too many."""
        are_gauges = self._settings.outputs == "gauges"
        return Refusal(ReplyStatus.OUT_OF_RANGE, mask_of(axes)) if are_gauges and max(axes) >= MOST_GAUGES else None

    def _out_of_range(self, targets: Mapping[int, int]) -> Refusal | None:
        for axis, target in targets.items():
            if target not in POSITIONS:
                return Refusal(ReplyStatus.OUT_OF_RANGE, axis)
        return None
