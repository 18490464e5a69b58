"""The virtual controller's machine: up to four motors, alone, at the same time, or along a straight line."""

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import TypeVar

from stepramp.controllers.stepramp.messages.axes import MOST_AXES, mask_of
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.messages.status import AxisState
from stepramp.controllers.stepramp.playback import playback_of
from stepramp.controllers.stepramp.ramp_image import RampImage
from stepramp.controllers.stepramp.settings import MOST_GAUGES, StepRampSettings
from stepramp.controllers.stepramp.speed_limits import Pace, SpeedLimits
from stepramp.controllers.virtual.line import VirtualLine
from stepramp.controllers.virtual.motor_state import state_of
from stepramp.controllers.virtual.streams import TraceRecorder
from stepramp.ramp.playback.motor import Motor
from stepramp.ramp.playback.trajectory import Playback
from stepramp.units import ticks_from_us

POSITIONS = range(-(2**31), 2**31)
GUARD_S = 1.28
"""So long an axis runs at a speed after the last request [s]; boards that count in steps of 0.256 s may take less."""

T = TypeVar("T")


class VirtualMachine:
    """Motors that move by a clock [s]. They are where the last call of `settle` found them."""

    def __init__(self, clock: Callable[[], float], hello: HelloReply) -> None:
        self._clock = clock
        self._hello = hello
        self._settings = StepRampSettings()
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
        was_moving, guarded_until = self.moving, int((self._heard_s + GUARD_S) * self._timer_hz)
        if self._now() > guarded_until:
            self._settle_at(guarded_until)
            self.stop(axis for axis, motor in enumerate(self._motors) if motor.running)
        self._settle_at(self._now())
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
        refusal = self._without_pins(targets) or self._too_fast(
            {axis: self._playbacks[axis].slew_interval for axis in targets}
        )
        if refusal is None:
            ready = self._ready()
            for axis, target in targets.items():
                self._motors[axis].move_to(target, ready)
            self._enable()
        return refusal or targets

    def run(self, intervals: Mapping[int, int]) -> Refusal | None:
        """Run axes at intervals [ticks], negative for backwards; 0: stop."""
        running = {axis: interval for axis, interval in intervals.items() if interval}
        if refusal := self._without_pins(intervals):
            return refusal
        for axis, interval in running.items():
            if not self._playbacks[axis].slew_interval <= abs(interval) <= self._hello.longest_interval_ticks:
                return Refusal(ReplyStatus.OUT_OF_RANGE, axis)
        refusal = self._too_fast({axis: abs(interval) for axis, interval in running.items()})
        if refusal is None:
            self.stop(axis for axis in intervals if axis not in running)
            ready = self._ready()
            for axis, interval in running.items():
                self._motors[axis].run(abs(interval), 1 if interval > 0 else -1, ready)
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
        refusal = self._out_of_range(targets) or self._too_much(paces)
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
            self._motors[axis].set_position(position)

    def zero(self, axes: Collection[int], steps: int) -> Refusal | None:
        """Call the places of axes at rest so many steps, and move them to 0."""
        slew_intervals = {axis: self._playbacks[axis].slew_interval for axis in axes}
        refusal = self._without_pins(axes) or self._too_fast(slew_intervals)
        if refusal is None:
            self.set_position(dict.fromkeys(axes, steps))
            self.move_to(dict.fromkeys(axes, 0))
        return refusal

    def stop(self, axes: Iterable[int]) -> None:
        """Slow axes down to rest, a line as a whole; what has not set out yet doesn't."""
        was_moving = self.moving
        for axis in axes:
            if self._line is None:
                self._motors[axis].stop()
            elif self._line.state(axis):
                self._line.stop()
                self.settle()
        self._note_rest(was_moving)

    def halt(self, axes: Iterable[int]) -> None:
        """Make no further step with axes; a line ends as a whole."""
        was_moving = self.moving
        for axis in axes:
            if self._line is None:
                self._motors[axis].halt()
            elif self._line.state(axis):
                self._line.halt()
                self.settle()
        self._note_rest(was_moving)

    def _settle_at(self, now: int) -> None:
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
