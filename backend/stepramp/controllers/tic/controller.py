"""A Pololu Tic at a serial port: one motor, with a ramp that the Tic computes itself.

A Tic answers no command, so each is checked by what the Tic then says of itself, and repeated if need be. That is safe:
targets are absolute. What it was told last it keeps through errors, and obeys again once they are over; so a target is
told and read back before the Tic is allowed to move, never the other way round.
"""

from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from time import sleep
from typing import NoReturn, TypeVar

from stepramp.controllers.capabilities import TriesRamps, ZeroesGauges
from stepramp.controllers.contract import (
    Activity,
    AnswerUnknown,
    AxisCommand,
    AxisStatus,
    Controller,
    ControllerStatus,
    PushMode,
    PushPreview,
    PushReport,
    StoredRamp,
)
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.tic.conditions import BY_ITSELF, told, told_afterwards
from stepramp.controllers.tic.conversation import Conversation
from stepramp.controllers.tic.push import PushPlan
from stepramp.controllers.tic.ramp import LEAST_SPEED, TicRamp, speed_units, steps_per_s
from stepramp.controllers.tic.variables import (
    COMMAND_TIMEOUT,
    CONTROL_MODE,
    GENERAL,
    INPUT,
    MOTION,
    RAMP,
    STORED_RAMP,
    TARGET_VELOCITY,
    UP_TIME,
    Block,
    Condition,
    Flag,
    General,
    Input,
    InputState,
    OperationState,
    PlanningMode,
    Variables,
)
from stepramp.controllers.tic.wire import Quick, Write, quick, write
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused, Rejected, Rejection
from stepramp.link.connection import Connection

T = TypeVar("T")

SERIAL_CONTROL = 0
"""The control mode in which a Tic obeys its serial port."""
MOST_REPEATS = 3
STARTING_POLLS = 10
STARTING_POLL_S = 0.02
"""A Tic needs at most 10 ms until its motor's current is steady; safe start is left for 200 ms."""
LEAST_TIMEOUT_MS = 1000
"""A command timeout that a device keeps up, since it asks for a status each half second; what a Tic comes with."""
SLOW_DOWN = write(Write.TARGET_VELOCITY, 0)
HALT = quick(Quick.HALT_AND_HOLD)
NEUTRAL = (Input(InputState.TARGET_VELOCITY, 0), Input(InputState.HALT, 0))
AT_A_SWITCH = "The Tic has stopped at a limit switch: it does not go on when the switch is released."
ONE_AXIS = "0: a Tic has one axis"


class TicController(Controller, TriesRamps, ZeroesGauges):
    """A client of a Tic's serial protocol; see Controller for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called between two commands of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        self._port_name = port.name
        self._conversation = Conversation(port, give_way)
        self._give_way = give_way
        self._tell = tell
        self._ramp = self._stored_ramp = TicRamp(0, 0, 1, 1)
        self._up_time_ms: int | None = None
        self._stops = 0
        self._leads = False
        """The Tic moves, or holds its motor, for what was asked over this connection: so it is kept from timing out."""
        self._is_going = False
        """What was asked for last had not come to its end yet, when the Tic was last looked at."""
        self._holds = False
        """The motor had its current, when the Tic was last looked at."""
        self._past_trouble: str | None = None
        """What ended the last motion, or let go of the motor, since it was last moved or its position set."""
        self._timeout_ms = 0
        self._set_out_at = 0

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        """None: a Tic's own timer is its own affair."""
        return ()

    @property
    def timer_hz(self) -> int | None:
        """None, as said."""
        return None

    @property
    def most_axes(self) -> int:
        """One: a Tic drives one motor."""
        return 1

    @property
    def firmware_version(self) -> str | None:
        """None: a Tic doesn't tell it over its serial port."""
        return None

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Find out whether a Tic is there, and learn its ramp. It is told nothing but questions.

        Raises Refused when something else is there, or the Tic takes its targets from elsewhere.
        """
        self._conversation.begin()
        if self._conversation.read(CONTROL_MODE) != (SERIAL_CONTROL,):
            raise Refused(
                f"The Tic at {self._port_name} takes its targets from another input than its serial port: set its "
                "control mode to 'Serial / I²C / USB' in the Tic Control Center."
            )
        greeted()
        self._ramp, self._stored_ramp = self._read_ramp(RAMP), self._read_ramp(STORED_RAMP)
        (self._timeout_ms,) = self._conversation.read(COMMAND_TIMEOUT)
        seen = self._look()
        self._set_out_at, self._holds = seen.position, seen.general.holds

    def disconnect(self) -> None:
        """Leave the Tic alone: what still moves slows down once its command timeout is over."""

    def status(self) -> ControllerStatus:
        """Ask what the Tic is doing; while it does what was asked over this connection, keep it from timing out."""
        seen = self._look()
        self._note_trouble(seen)
        axis = self._axis_status(seen)
        if axis.activity is Activity.READY:
            # Whoever is at its USB port may have changed it.
            self._ramp = self._read_ramp(RAMP)
            (self._timeout_ms,) = self._conversation.read(COMMAND_TIMEOUT)
        return ControllerStatus(
            activity=axis.activity,
            axes=(axis,),
            ramp=StoredRamp(sequence=None, crc=self._ramp.crc),
            on_trial=self._ramp != self._stored_ramp,
            motors_on=Flag.ENERGIZED in seen.general.flags,
            trouble=self._trouble(seen.general.conditions),
        )

    def listen(self) -> ControllerStatus | None:
        """Return None: a Tic says nothing unasked."""
        return None

    def prepare_push(
        self,
        designs: Sequence[Design],
        first_axis: int | None = None,
        mode: PushMode = "keep",  # noqa: ARG002  # what isn't stored is always tried
    ) -> Callable[[], PushReport]:
        """Work out the four figures of the ramp, and return the call that sends them; see Controller."""
        plan = PushPlan.of(designs, first_axis)

        def push() -> PushReport:
            self._refuse_moving()
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            self._use(plan.ramp)
            return plan.report(self._ramp)

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        return PushPlan.of(designs, first_axis).preview(self._ramp)

    def roll_back(self) -> None:
        """Use the ramp of the Tic's settings again; Refused when no other is in use."""
        self._ramp, self._stored_ramp = self._read_ramp(RAMP), self._read_ramp(STORED_RAMP)
        if self._ramp == self._stored_ramp:
            raise Refused("Nothing is on trial: the ramp of the Tic's settings is in use.")
        self._refuse_moving()
        self._use(self._stored_ramp)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move by so many steps from the target; Refused while the motor runs at a speed, or slows down."""
        command, stops = _of_the_axis(steps), self._stops
        position, seen = self._resting_position()
        self._move(command, position + int(command.value), seen, stops)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move to a position [steps]."""
        command, stops = _of_the_axis(positions), self._stops
        self._move(command, int(command.value), self._look(), stops)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run at a speed, rounded towards 0, negative for backwards [steps/s]; 0 stops."""
        command, stops = _of_the_axis(speeds), self._stops
        units = self._velocity(command)
        if units:
            told_so = Input(InputState.TARGET_VELOCITY, units)
            self._set_out(write(Write.TARGET_VELOCITY, units), told_so, self._look(), stops)
        else:
            self.stop()

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the place where the motor rests a position [steps]."""
        command = _of_the_axis(positions)
        position = _within_32_bits(command, int(command.value))
        self._refuse_moving()
        for _ in range(1 + MOST_REPEATS):
            self._conversation.send(write(Write.HALT_AND_SET_POSITION, position))
            if self._input() == Input(InputState.HALT, 0) and self._look().position == position:
                self._set_out_at, self._past_trouble = position, None
                return
        raise Refused("The Tic doesn't take the position: is its serial line disturbed?")

    def zero(self, axes: Collection[int], steps: int) -> None:
        """Call the place where the motor is so many steps, and move it to 0."""
        stops = self._stops
        self._refuse_unable(self._look())
        self.set_position([AxisCommand(axis, steps, "axes") for axis in sorted(set(axes))])
        self._move(AxisCommand(0, 0, "axes"), 0, self._look(), stops)

    def stop(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # one motor, whichever is named
        """Begin to slow down with the ramp; a Tic that heads somewhere nevertheless is halted."""
        self._stops += 1
        for command in (*[SLOW_DOWN] * (1 + MOST_REPEATS), HALT, HALT):
            self._conversation.send(command)
            if self._heads_nowhere():
                return
        raise Refused(f"The Tic at {self._port_name} doesn't stop when it is told to: cut the power of its motor.")

    def halt(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # as stop
        """Make no further step."""
        self._stops += 1
        for _ in range(1 + MOST_REPEATS):
            self._conversation.send(HALT)
            if self._input() == Input(InputState.HALT, 0):
                return
        raise Refused(f"The Tic at {self._port_name} doesn't halt when it is told to: cut the power of its motor.")

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:  # noqa: ARG002  # as stop
        """Return how many steps slowing down from a speed [steps/s] takes."""
        return self._ramp.steps_to_rest(speed_steps_per_s)

    # Moving.

    def _move(self, command: AxisCommand, target: int, seen: Variables, stops: int) -> None:
        target = _within_32_bits(command, target)
        if abs(target - seen.position) >= 2**31:
            allowed = f"a way of less than 2,147,483,648 steps from {seen.position:,}: a Tic goes the shorter way round"
            raise Rejected([Rejection(command.field, int(command.value), allowed)])
        self._set_out(write(Write.TARGET_POSITION, target), Input(InputState.TARGET_POSITION, target), seen, stops)

    def _set_out(self, command: bytes, told_so: Input, seen: Variables, stops: int) -> None:
        """Tell the Tic a target, see that it has it, and let it move; Refused when something keeps it from moving.

        stops: how many had come when it was asked for.
        """
        self._refuse_unable(seen)
        self._tell_target(command, told_so, stops)
        if not seen.velocity:
            self._set_out_at = seen.position
        self._let_move(told_so, stops)
        self._leads = self._is_going = self._holds = True
        self._past_trouble = None

    def _tell_target(self, command: bytes, told_so: Input, stops: int) -> None:
        for _ in range(1 + MOST_REPEATS):
            self._refuse_stopped(stops)
            self._conversation.send(command)
            if self._input() == told_so:
                return
        self._give_up("The Tic doesn't take its target: is its serial line disturbed?", stops)

    def _let_move(self, told_so: Input, stops: int) -> None:
        """End what keeps the Tic from moving until it is told to; it has its target by now."""
        for _ in range(STARTING_POLLS):
            general = self._general()
            self._refuse_stopped(stops)
            if general.operation is OperationState.NORMAL and self._acting_on(general) == told_so:
                return
            if general.conditions:
                energize = [quick(Quick.ENERGIZE)] if Condition.DEENERGIZED in general.conditions else []
                self._conversation.send(*energize, quick(Quick.EXIT_SAFE_START))
            self._give_way(STARTING_POLL_S)
        self._give_up(_cannot_move(general.conditions), stops)

    def _give_up(self, reason: str, stops: int) -> NoReturn:
        """Refuse a motion, and have the Tic forget what it was told of it."""
        self._refuse_stopped(stops)
        self.stop()
        raise Refused(reason)

    def _note_trouble(self, seen: Variables) -> None:
        """Keep the Tic from timing out, and note what has ended its motion or let go of its motor."""
        stopped = self._leads and not self._goes_on(seen)
        let_go, self._holds = self._holds and not seen.general.holds, seen.general.holds
        if stopped and _is_held_by_a_switch(seen):
            self._past_trouble = AT_A_SWITCH
        elif stopped or let_go:
            self._past_trouble = told_afterwards(seen.general.conditions, stopped=stopped, let_go=let_go)

    def _goes_on(self, seen: Variables) -> bool:
        """Keep the Tic from timing out; but once something else has ended its motion, let it not go on by itself.

        Returns whether it still does what was asked, or had done that before.
        """
        # At a limit switch it rests with its target ahead, and would go on once the switch is released.
        if seen.general.operation is OperationState.NORMAL and not _is_held_by_a_switch(seen):
            self._conversation.send(quick(Quick.RESET_COMMAND_TIMEOUT))
            self._is_going = _is_under_way(seen)
            return True
        done = not self._is_going or self._input() in (*NEUTRAL, Input(InputState.TARGET_POSITION, seen.position))
        self._leads = self._is_going = False
        self.stop()
        return done

    def _trouble(self, conditions: Condition) -> str | None:
        return self._inability(conditions) or self._past_trouble

    def _inability(self, conditions: Condition) -> str | None:
        """Return what keeps the Tic from moving until something is mended, as a sentence; None for nothing."""
        if conditions & BY_ITSELF:
            return _cannot_move(conditions & BY_ITSELF)
        if 0 < self._timeout_ms < LEAST_TIMEOUT_MS:
            return (
                f"The Tic can't move: its command timeout is {self._timeout_ms} ms, so it would stop before StepRamp "
                f"speaks to it again; set it to at least {LEAST_TIMEOUT_MS:,} ms in the Tic Control Center."
            )
        return None

    def _refuse_unable(self, seen: Variables) -> None:
        """Refuse a motion before anything is said of it, when something is in its way that no command ends."""
        if (reason := self._inability(seen.general.conditions)) is not None:
            raise Refused(reason)

    def _acting_on(self, general: General) -> Input | None:
        """Return what the Tic makes steps for, as it is told such things; None for nothing."""
        if general.planning is PlanningMode.TARGET_POSITION:
            return Input(InputState.TARGET_POSITION, general.target_position)
        if general.planning is PlanningMode.TARGET_VELOCITY:
            return Input(InputState.TARGET_VELOCITY, self._conversation.read(TARGET_VELOCITY)[0])
        return None

    def _heads_nowhere(self) -> bool:
        """Whether the Tic has no target: neither one that it was told, nor that of its settings for errors."""
        if self._input() not in NEUTRAL:
            return False
        general = self._general()
        if Flag.HOMING in general.flags:
            return False
        return Flag.ENERGIZED not in general.flags or general.planning is not PlanningMode.TARGET_POSITION

    def _resting_position(self) -> tuple[int, Variables]:
        """Return where the motor rests, or will: seen twice in a row, since moves count from there; and all seen."""
        last = None
        for _ in range(1 + MOST_REPEATS):
            seen = self._look()
            is_under_way = _is_under_way(seen)
            if is_under_way and seen.general.planning is not PlanningMode.TARGET_POSITION:
                raise Refused("The motor runs, so it isn't known yet where it comes to rest: say a position, or wait.")
            position = seen.general.target_position if is_under_way else seen.position
            if position == last:
                return position, seen
            last = position
        raise Refused("The Tic tells another position each time: is its serial line disturbed?")

    def _velocity(self, command: AxisCommand) -> int:
        """Return a speed in the Tic's units; Rejected when the ramp in use doesn't lead to it."""
        units = speed_units(command.value)
        if abs(units) > self._ramp.max_speed or (command.value and abs(units) < LEAST_SPEED):
            fastest = steps_per_s(self._ramp.max_speed)
            allowed = (
                f"from {-fastest:,.10g} to {fastest:,.10g} steps/s, the full speed of the ramp in use, and 0 or at "
                f"least {steps_per_s(LEAST_SPEED):g} either way"
            )
            raise Rejected([Rejection(command.field, command.value, allowed)])
        return units

    def _refuse_moving(self) -> None:
        if _is_under_way(self._look()):
            raise Refused("The motor moves: stop it first.")

    def _refuse_stopped(self, stops: int) -> None:
        if self._stops != stops:
            raise AnswerUnknown("A stop came first: what was asked before it is not carried out.")

    # Asking.

    def _use(self, ramp: TicRamp) -> None:
        """Have the Tic use a ramp, and see that it does."""
        for _ in range(1 + MOST_REPEATS):
            self._conversation.send(*ramp.commands)
            self._tell(Progress(PushStage.READING_BACK, 0, 0))
            self._ramp = self._read_ramp(RAMP)
            if self._ramp == ramp:
                return
        raise Refused("The Tic has other figures than those that were sent: is its serial line disturbed?")

    def _read_ramp(self, blocks: Sequence[Block]) -> TicRamp:
        return self._sensible(
            lambda: TicRamp.told(*(value for block in blocks for value in self._conversation.read(block)))
        )

    def _input(self) -> Input:
        """Return what the Tic was last told."""
        return self._sensible(lambda: Input.of(*self._conversation.read(INPUT)))

    def _general(self) -> General:
        return self._sensible(lambda: General.of(*self._conversation.read(GENERAL)))

    def _look(self) -> Variables:
        """Return how the Tic fares; DeviceLost when it was restarted since the last time."""
        general = self._general()
        self._refuse_restarted()
        (target_velocity,) = self._conversation.read(TARGET_VELOCITY)
        # Last, so that what is told to have ended is told where.
        position, velocity = self._conversation.read(MOTION)
        return Variables(general, target_velocity, position, velocity)

    def _refuse_restarted(self) -> None:
        # Noted at once: something more urgent may look, too, before the next question.
        (up_time_ms,) = self._conversation.read(UP_TIME)
        before_ms, self._up_time_ms = self._up_time_ms, up_time_ms
        if before_ms is not None and (up_time_ms - before_ms) % 2**32 >= 2**31:
            raise DeviceLost(f"The Tic at {self._port_name} was restarted: its position is no longer known.")

    def _sensible(self, read: Callable[[], T]) -> T:
        """Return what was read, read again when no Tic says so: noise that has the right length."""
        for _ in range(1 + MOST_REPEATS):
            with suppress(ValueError):
                return read()
        raise DeviceLost(f"The Tic at {self._port_name} gives answers without sense.")

    def _axis_status(self, seen: Variables) -> AxisStatus:
        activity, target = Activity.READY, seen.position
        if _is_under_way(seen):
            activity, target = self._course(seen)
        return AxisStatus(
            axis=0,
            activity=activity,
            position_steps=seen.position,
            target_steps=target,
            speed_steps_per_s=steps_per_s(abs(seen.velocity)),
            steps_made=abs(seen.position - self._set_out_at),
        )

    def _course(self, seen: Variables) -> tuple[Activity, int]:
        """Return what a motor that moves does, and where it will come to rest: its position as long as it runs."""
        if seen.general.planning is PlanningMode.TARGET_POSITION:
            return Activity.MOVING, seen.general.target_position
        if seen.target_velocity or Flag.HOMING in seen.general.flags:
            return Activity.MOVING, seen.position
        steps_to_rest = self._ramp.steps_to_rest(steps_per_s(abs(seen.velocity)))
        return Activity.STOPPING, seen.position + (steps_to_rest if seen.velocity > 0 else -steps_to_rest)


def _cannot_move(conditions: Condition) -> str:
    return f"The Tic can't move: {told(conditions) or 'it does not start up'}."


def _is_under_way(seen: Variables) -> bool:
    """Whether the motor moves, or is about to: a limit switch may keep it from its target."""
    if seen.velocity or Flag.HOMING in seen.general.flags:
        return True
    is_normal = seen.general.operation is OperationState.NORMAL
    return bool(_ahead(seen)) and is_normal and not _is_held_by_a_switch(seen)


def _is_held_by_a_switch(seen: Variables) -> bool:
    """Whether the motor rests at a limit switch, with something ahead of it."""
    limit = Flag.FORWARD_LIMIT if _ahead(seen) > 0 else Flag.REVERSE_LIMIT
    return bool(_ahead(seen)) and not seen.velocity and limit in seen.general.flags


def _ahead(seen: Variables) -> int:
    """Return how far the Tic's target is ahead, in steps or as a speed, with its sign; 0: nowhere."""
    return {
        PlanningMode.OFF: 0,
        PlanningMode.TARGET_POSITION: seen.general.target_position - seen.position,
        PlanningMode.TARGET_VELOCITY: seen.target_velocity,
    }[seen.general.planning]


def _of_the_axis(commands: Sequence[AxisCommand]) -> AxisCommand:
    """Return what is asked of the only axis; Rejected when another one is named, or one twice."""
    for number, each in enumerate(commands):
        if each.axis or number:
            beside = each.field.rpartition(".")[0] + ".axis" if "." in each.field else "axis"
            field = each.field if each.field == "axes" else beside
            raise Rejected([Rejection(field, each.axis, "each axis once" if not each.axis else ONE_AXIS)])
    return commands[0]


def _within_32_bits(command: AxisCommand, position: int) -> int:
    """Return a position; Rejected when a Tic can't count so far."""
    if not -(2**31) <= position < 2**31:
        allowed = "a target from -2,147,483,648 to 2,147,483,647 steps"
        raise Rejected([Rejection(command.field, int(command.value), allowed)])
    return position
