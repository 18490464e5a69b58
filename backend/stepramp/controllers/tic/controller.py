"""A Pololu Tic at a serial port: one motor, with a ramp that the Tic computes itself.

A Tic answers no command, so each is checked by what the Tic then says of itself, and repeated if need be. That is safe:
targets are absolute.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from time import sleep

from stepramp.controllers.capabilities import BacksUp, TriesRamps, ZeroesGauges
from stepramp.controllers.contract import (
    Activity,
    AxisCommand,
    AxisStatus,
    Controller,
    ControllerStatus,
    PushMode,
    PushPreview,
    PushReport,
    StoredRamp,
)
from stepramp.controllers.microsteps import Microsteps
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.tic.backup import Backup, backup_text
from stepramp.controllers.tic.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tic.course import Course
from stepramp.controllers.tic.memory import Memory
from stepramp.controllers.tic.push import VOLATILE, PushPlan
from stepramp.controllers.tic.ramp import steps_per_s
from stepramp.controllers.tic.ramp_in_use import RampInUse
from stepramp.controllers.tic.setting_out import SettingOut
from stepramp.controllers.tic.settings import Settings
from stepramp.controllers.tic.stopping import Stopping
from stepramp.controllers.tic.targets import of_the_axis, target_of, velocity_of, within_32_bits
from stepramp.controllers.tic.variables import Flag, Input, InputState, PlanningMode, Variables
from stepramp.controllers.tic.wire import Write, write
from stepramp.design import Design
from stepramp.errors import Refused
from stepramp.link.connection import Connection

SERIAL_CONTROL = 0
"""The control mode in which a Tic obeys its serial port."""


class TicController(Controller, TriesRamps, ZeroesGauges, BacksUp):
    """A client of a Tic's serial protocol; see Controller for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called in the midst of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        self._port_name = port.name
        self._tell = tell
        self._conversation = Conversation(port, give_way)
        self._memory = Memory(self._conversation, port.name)
        self._stopping = Stopping(self._conversation, self._memory, port.name)
        self._course = Course(self._conversation, self._memory, self._stopping)
        self._setting_out = SettingOut(self._conversation, self._memory, self._stopping, self._course, give_way)
        self._ramp_in_use = RampInUse(self._conversation, self._memory, self._stopping, tell)
        self._microsteps = Microsteps("The Tic", "its step mode")

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
        if self._memory.control_mode() != SERIAL_CONTROL:
            raise Refused(
                f"The Tic at {self._port_name} takes its targets from another input than its serial port: set its "
                "control mode to 'Serial / I²C / USB' in the Tic Control Center."
            )
        greeted()
        self._ramp_in_use.learn()
        self._microsteps.learn(self._memory.microsteps())
        self._setting_out.learn_timeout()
        self._course.learn(self._memory.look())

    def disconnect(self) -> None:
        """Leave the Tic alone: what still moves slows down once its command timeout is over."""

    def status(self) -> ControllerStatus:
        """Ask what the Tic is doing; while it does what was asked over this connection, keep it from timing out."""
        while True:
            stops = self._stopping.count
            status = self._status()
            # What was seen before a stop in the midst doesn't go with what was seen after it.
            if self._stopping.count == stops:
                return status

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
        plan = PushPlan.of(designs, first_axis, self._microsteps.count)

        def push() -> PushReport:
            self._read_microsteps(self._at_rest())
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            self._ramp_in_use.use(plan.ramp)
            return replace(plan, microsteps=self._microsteps.count).report(self._ramp_in_use.ramp)

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        plan = PushPlan.of(designs, first_axis, self._microsteps.count)
        return plan.preview(self._ramp_in_use.ramp)

    def roll_back(self) -> None:
        """Use the ramp of the Tic's settings again; Refused when no other is in use."""
        self._ramp_in_use.learn()
        if not self._ramp_in_use.is_on_trial:
            raise Refused("Nothing is on trial: the ramp of the Tic's settings is in use.")
        self._at_rest()
        self._ramp_in_use.use(self._ramp_in_use.stored_ramp)

    def backup(self) -> str:
        """Ask for all settings, as a settings file, and for what is in use beside them."""
        self._ramp_in_use.look()
        return backup_text(self._settings(), self._memory.in_use())

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Use the ramp of a backup, or of a settings file, and read it back; see BacksUp."""
        backup, now = Backup.of(text), self._settings()
        self._at_rest()
        self._ramp_in_use.use(backup.ramp)
        self._ramp_in_use.learn()
        forgotten = (VOLATILE,) if self._ramp_in_use.is_on_trial else ()
        return (*backup.left(self._memory.microsteps(), now), *forgotten)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move by so many steps from the target; Refused while the motor runs at a speed, or slows down."""
        asked, stops = of_the_axis(steps), self._stopping.count
        position, seen = self._setting_out.resting_position()
        self._move(asked, position + int(asked.value), seen, stops)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move to a position [steps]."""
        asked, stops = of_the_axis(positions), self._stopping.count
        self._move(asked, int(asked.value), self._memory.look(), stops)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run at a speed, rounded towards 0, negative for backwards [steps/s]; 0 stops."""
        asked, stops = of_the_axis(speeds), self._stopping.count
        units = velocity_of(asked, self._ramp_in_use.ramp)
        if units:
            seen = self._memory.look()
            self._refuse_other_microsteps(seen)
            self._setting_out.at_velocity(units, seen, stops)
        else:
            self.stop()

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the place where the motor rests a position [steps]."""
        asked = of_the_axis(positions)
        position = within_32_bits(asked, int(asked.value))
        count, seen = self._memory.microsteps(), self._at_rest()
        if position:
            self._microsteps.refuse_changed(count, seen.position)
        for _ in range(1 + MOST_REPEATS):
            self._conversation.send(write(Write.HALT_AND_SET_POSITION, position))
            if self._memory.input() == Input(InputState.HALT, 0) and self._memory.look().position == position:
                self._course.count_from(position)
                self._microsteps.learn(count)
                return
        raise Refused("The Tic doesn't take the position: is its serial line disturbed?")

    def zero(self, axes: Collection[int], steps: int) -> None:
        """Call the place where the motor is so many steps, and move it to 0."""
        stops = self._stopping.count
        self._setting_out.refuse_unable(self._memory.look())
        self.set_position([AxisCommand(axis, steps, "axes") for axis in sorted(set(axes))])
        self._move(AxisCommand(0, 0, "axes"), 0, self._memory.look(), stops)

    def stop(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # one motor, whichever is named
        """Begin to slow down with the ramp; a Tic that heads somewhere nevertheless is halted."""
        self._stopping.stop()

    def halt(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # as stop
        """Make no further step."""
        self._stopping.halt()

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:  # noqa: ARG002  # as stop
        """Return how many steps slowing down from a speed [steps/s] takes."""
        return self._ramp_in_use.ramp.steps_to_rest(speed_steps_per_s)

    def _settings(self) -> Settings:
        """Ask for all settings, which takes so long that a Tic that holds its motor might time out meanwhile."""
        return self._memory.settings(lambda: self._course.prolong(self._memory.general()))

    def _move(self, asked: AxisCommand, target: int, seen: Variables, stops: int) -> None:
        target = target_of(asked, target, seen.position)
        self._refuse_other_microsteps(seen)
        self._setting_out.to_position(target, seen, stops)

    def _at_rest(self) -> Variables:
        """Return how the Tic fares; Refused while the motor moves."""
        if (seen := self._memory.look()).is_under_way:
            raise Refused("The motor moves: stop it first.")
        return seen

    def _read_microsteps(self, seen: Variables) -> None:
        """Read the step mode: whoever is at the Tic's USB port may have changed it."""
        self._microsteps.note(self._memory.microsteps(), seen.position)

    def _refuse_other_microsteps(self, seen: Variables) -> None:
        """Refused where the step mode is another one than was told, or the place isn't known since it has changed."""
        self._microsteps.refuse_changed(self._memory.microsteps(), seen.position)
        if (trouble := self._microsteps.trouble) is not None:
            raise Refused(trouble)

    def _status(self) -> ControllerStatus:
        general = self._memory.general()
        self._course.prolong(general)
        seen = self._memory.variables(general)
        self._course.note(seen)
        axis = self._axis_status(seen)
        if axis.activity is Activity.READY:
            # Whoever is at its USB port may have changed it.
            self._ramp_in_use.look()
            self._read_microsteps(seen)
            self._setting_out.learn_timeout()
        return ControllerStatus(
            activity=axis.activity,
            axes=(replace(axis, microsteps=self._microsteps.count),),
            ramp=StoredRamp(sequence=None, crc=self._ramp_in_use.ramp.crc),
            on_trial=self._ramp_in_use.is_on_trial,
            motors_on=Flag.ENERGIZED in general.flags,
            trouble=(
                self._setting_out.inability(general.conditions) or self._microsteps.trouble or self._course.past_trouble
            ),
        )

    def _axis_status(self, seen: Variables) -> AxisStatus:
        activity, target = Activity.READY, seen.position
        if seen.is_under_way:
            activity, target = self._aim(seen)
        return AxisStatus(
            axis=0,
            activity=activity,
            position_steps=seen.position,
            target_steps=target,
            speed_steps_per_s=steps_per_s(abs(seen.velocity)),
            steps_made=self._course.steps_made(seen.position),
        )

    def _aim(self, seen: Variables) -> tuple[Activity, int]:
        """Return what a motor that moves does, and where it will come to rest: its position as long as it runs."""
        if seen.general.planning is PlanningMode.TARGET_POSITION:
            return Activity.MOVING, seen.general.target_position
        if seen.target_velocity or seen.general.is_homing:
            return Activity.MOVING, seen.position
        steps_to_rest = self._ramp_in_use.ramp.steps_to_rest(steps_per_s(abs(seen.velocity)))
        return Activity.STOPPING, seen.position + (steps_to_rest if seen.velocity > 0 else -steps_to_rest)
