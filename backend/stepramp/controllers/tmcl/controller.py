"""A TMCL module at a serial port: one or several motors, each with a ramp that the module computes itself.

It answers each command, and is asked whether it has what it was told. That may come twice: targets are absolute.
"""

import binascii
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from time import sleep

from stepramp.controllers.axes import MOST_AXES, refuse_axes
from stepramp.controllers.capabilities import BacksUp, StoresRamps, TriesRamps
from stepramp.controllers.contract import (
    UNDER_WAY,
    Activity,
    AxisCommand,
    Controller,
    ControllerStatus,
    PushMode,
    PushPreview,
    PushReport,
    StoredRamp,
)
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.tmcl.axis import Axis
from stepramp.controllers.tmcl.backup import Backup, lines_of
from stepramp.controllers.tmcl.conversation import Conversation, Denied
from stepramp.controllers.tmcl.modules import Module, module_of
from stepramp.controllers.tmcl.motions import Motions
from stepramp.controllers.tmcl.program import RUNS, Program
from stepramp.controllers.tmcl.push import PushPlan
from stepramp.controllers.tmcl.ramps import Ramps
from stepramp.controllers.tmcl.restoring import Restoring
from stepramp.controllers.tmcl.stopping import Stopping
from stepramp.design import Design
from stepramp.errors import DeviceLost
from stepramp.link.connection import Connection


class _Connected:
    """What there is once it is known which module it is."""

    def __init__(self, module: Module, version: str, conversation: Conversation, tell: Tell) -> None:
        self.module, self.version = module, version
        self.motors = [Axis(conversation, module, number) for number in range(module.axes)]
        axes = self.motors[:MOST_AXES]
        self.program = Program(conversation)
        self.stopping = Stopping(conversation, self.program, self.motors)
        self.ramps = Ramps(module, axes, self.stopping, tell)
        self.motions = Motions(self.motors, self.program, self.ramps, self.stopping)
        self.axes = axes


class TmclController(Controller, StoresRamps, TriesRamps, BacksUp):
    """A client of a TMCL module; see Controller for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called in the midst of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        self._tell = tell
        self._conversation = Conversation(port, give_way)
        self._found: _Connected | None = None

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        """None: a module's own clock is its own affair."""
        return ()

    @property
    def timer_hz(self) -> int | None:
        """None, as said."""
        return None

    @property
    def most_axes(self) -> int:
        """As many as the module has motors, of the first MOST_AXES."""
        return 0 if self._found is None else len(self._found.axes)

    @property
    def firmware_version(self) -> str | None:
        """Such as 1.13."""
        return None if self._found is None else self._found.version

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Find out which module is there, and learn its ramps. It is told nothing but questions.

        Raises Refused when something else is there, or a module that isn't known.
        """
        number, version = self._conversation.begin()
        self._found = _Connected(module_of(number, self._conversation.name), version, self._conversation, self._tell)
        greeted()
        self._there.ramps.learn()
        self._there.program.refuse_restarted()
        self._there.motions.learn()

    def disconnect(self) -> None:
        """Leave the module alone: what still moves goes on."""

    def status(self) -> ControllerStatus:
        """Ask what the module is doing."""
        there = self._there
        while True:
            stops = there.stopping.count
            there.program.refuse_restarted()
            axes = tuple(there.motions.status(number) for number in range(len(there.axes)))
            activities = {axis.activity for axis in axes}
            activity = next((each for each in UNDER_WAY if each in activities), Activity.READY)
            if activity is Activity.READY:
                there.ramps.look_at_microsteps_in_turn([axis.position_steps for axis in axes])
            axes = tuple(replace(axis, microsteps=there.ramps.microsteps[axis.axis].count) for axis in axes)
            program = RUNS if activity is Activity.READY and there.program.runs else None
            # What was seen before a stop in the midst doesn't go with what was seen after it.
            if there.stopping.count == stops:
                break
        return ControllerStatus(
            activity=activity,
            axes=axes,
            ramp=StoredRamp(sequence=None, crc=self._crc),
            on_trial=there.ramps.on_trial,
            # At rest with what they are set to for that.
            motors_on=True,
            trouble=program or there.motions.inability() or there.motions.past_trouble,
        )

    def listen(self) -> ControllerStatus | None:
        """Return None: a module says nothing unasked."""
        return None

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        """Work out the figures of the ramps, and return the call that sends them; see Controller."""
        there = self._there
        plan = PushPlan.of(designs, first_axis, there.ramps)

        def push() -> PushReport:
            there.motions.refuse_moving()
            there.ramps.look_at_microsteps()
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            try:
                there.ramps.use(plan.ramps)
            except Denied:
                # What was sent before that is in use.
                there.ramps.look()
                raise
            microsteps = [each.count for each in there.ramps.microsteps]
            report = replace(plan, microsteps=microsteps).report(there.ramps.in_use, mode)
            if report.kept:
                there.ramps.keep(plan.ramps)
            return report

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        return PushPlan.of(designs, first_axis, self._there.ramps).preview(self._there.ramps.in_use)

    def keep(self) -> None:
        """Store the ramps in use of all axes, in the module's EEPROM; Refused when that is locked."""
        self._there.motions.refuse_moving()
        self._there.ramps.keep(range(len(self._there.axes)))

    def roll_back(self) -> None:
        """Use the stored ramps again; Refused when no others are in use."""
        self._there.motions.refuse_moving()
        self._there.ramps.roll_back()

    def backup(self) -> str:
        """Ask for every setting that is stored, as it is in use, as lines."""
        self._there.motions.refuse_moving()
        return "\n".join(lines_of(self._there.module, self._there.version, self._there.motors)) + "\n"

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Write and store what differs of a backup, one setting at a time, and read it back; see BacksUp."""
        there = self._there
        backup = Backup.sound(text, there.module)
        there.motions.refuse_moving()
        return Restoring(there.motors, there.ramps).restore(backup)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move by so many steps from the target; Refused while the motor runs at a speed, or slows down."""
        refuse_axes(steps, len(self._there.axes))
        self._there.motions.by(steps)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move to positions [steps]."""
        refuse_axes(positions, len(self._there.axes))
        self._there.motions.to(positions)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run at speeds, rounded towards 0, negative for backwards [steps/s]; 0 stops."""
        refuse_axes(speeds, len(self._there.axes))
        self._there.motions.run(speeds)

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where motors rest positions [steps]."""
        refuse_axes(positions, len(self._there.axes))
        self._there.motions.set_position(positions)

    def stop(self, axes: Collection[int] | None = None) -> None:
        """Begin to slow down, with the acceleration, whatever the deceleration is; ends the module's own program."""
        self._there.motions.note_stop(axes)
        self._there.stopping.stop(axes)

    def halt(self, axes: Collection[int] | None = None) -> None:
        """Come to rest with the highest acceleration that the chip has; ends the module's own program."""
        self._there.motions.note_stop(axes)
        self._there.stopping.halt(axes)

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps slowing down from a speed [steps/s] takes."""
        ramps = self._there.ramps
        return ramps.in_use[axis].steps_to_rest(speed_steps_per_s, ramps.units[axis])

    @property
    def _there(self) -> _Connected:
        if self._found is None:
            raise DeviceLost(f"No TMCL module was found at {self._conversation.name}.")
        return self._found

    @property
    def _crc(self) -> int:
        """Tells the ramps of all axes apart."""
        return binascii.crc_hqx(repr(self._there.ramps.in_use).encode(), 0xFFFF)
