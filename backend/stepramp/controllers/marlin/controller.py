"""A Marlin at a serial port: axes that move along one line, with ramps that it works out from a few settings.

It answers each line. What it keeps is written only by a push, and by what restores a backup.
"""

import binascii
from collections.abc import Callable, Collection, Mapping, Sequence
from time import sleep

from stepramp.controllers.axes import refuse_axes, refuse_ramp_axis
from stepramp.controllers.capabilities import BacksUp, DrawsLines, StoresRamps, TriesRamps
from stepramp.controllers.contract import (
    UNDER_WAY,
    Activity,
    AxisCommand,
    AxisStatus,
    Controller,
    ControllerStatus,
    Ends,
    PushMode,
    PushPreview,
    PushReport,
    StoredRamp,
)
from stepramp.controllers.marlin.backup import Backup
from stepramp.controllers.marlin.conversation import Conversation
from stepramp.controllers.marlin.exchange import Answered
from stepramp.controllers.marlin.memory import NotStored
from stepramp.controllers.marlin.moves import Moves
from stepramp.controllers.marlin.places import Places
from stepramp.controllers.marlin.push import RESTORE, VOLATILE, PushPlan
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.remark import OnTrial, Unwritten
from stepramp.design import Design
from stepramp.errors import Refused
from stepramp.link.connection import Connection

SETS_OUT_WITHIN_S = 0.1
"""So long it may take until a quick stop ends all steps [s]: it is read between other things."""
NOT_ALL = Unwritten("It is not stored, since what is in use isn't what the backup says.")
SENSELESS = (
    "The settings of axis X make no sense, so no axis can be used: restore a backup of this device, or set M92, M201 "
    "and M203 at the machine."
)


class MarlinController(Controller, StoresRamps, TriesRamps, DrawsLines, BacksUp):
    """A client of Marlin; see Controller for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called in the midst of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        self._tell = tell
        self._conversation = Conversation(port, give_way)
        self._places = Places()
        self._moves = Moves(self._conversation, self._places)
        self._memory = self._moves.memory
        self._version: str | None = None

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        """None: Marlin's own timer is its own affair."""
        return ()

    @property
    def timer_hz(self) -> int | None:
        """None, as said."""
        return None

    @property
    def most_axes(self) -> int:
        """As many of X, Y, Z and E as it tells settings of."""
        return len(self._places.axes)

    @property
    def firmware_version(self) -> str | None:
        """Such as 2.1.2.5."""
        return self._version

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Wait until a Marlin is there, and learn what it keeps. It is told nothing but questions.

        Raises Refused when something else is there.
        """
        self._version = self._conversation.begin() or None
        greeted()
        self._learn()
        self._moves.rest_at(self._conversation.place())
        self._conversation.be_patient()

    def disconnect(self) -> None:
        """Leave the controller alone: a run ends by itself, since it isn't told to go on any more."""

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing, and have axes that run go on."""
        while True:
            stops = self._moves.stopping.count
            seen = self._moves.look()
            # What was seen before a stop in the midst doesn't go with what was seen after it.
            if self._moves.stopping.count == stops:
                break
        # One is told in any case, though it can't be moved.
        axes = self._moves.axes(seen) or (AxisStatus.untold(),)
        activities = {axis.activity for axis in axes}
        activity = next((each for each in UNDER_WAY if each in activities), Activity.READY)
        return ControllerStatus(
            activity=activity,
            axes=axes,
            ramp=StoredRamp(sequence=None, crc=self._crc),
            on_trial=self._memory.on_trial,
            motors_on=activity is not Activity.READY,
            trouble=self._moves.trouble or (None if self._places.axes else SENSELESS),
        )

    def listen(self) -> ControllerStatus | None:
        """Return None: what a Marlin says unasked is nothing of its motion."""
        return None

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        """Work out the settings of the axes, and return the call that sends them; see Controller."""
        self._refuse_senseless()
        plan = PushPlan.of(designs, first_axis, self._places.axes, self._memory.settings)

        def push() -> PushReport:
            self._memory.refuse_unready()
            self._learn()
            self._refuse_senseless()
            plan.refuse_changed(self._memory.settings)
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            try:
                self._memory.write(plan.lines)
            except Answered:
                # What was sent before that is in use.
                self._learn()
                raise
            self._tell(Progress(PushStage.READING_BACK, 0, 0))
            self._learn()
            remarks: list[str] = [] if mode == "keep" else [VOLATILE]
            if mode == "keep" and not self._memory.differing(plan.wanted):
                remarks = self._store()
            verified = not self._memory.differing(plan.wanted)
            kept = mode == "keep" and verified and not remarks
            return plan.report(
                self._memory.settings, remarks if verified else [*remarks, RESTORE], verified=verified, kept=kept
            )

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        self._refuse_senseless()
        present = self._memory.settings
        return PushPlan.of(designs, first_axis, self._places.axes, present).preview(present)

    def keep(self) -> None:
        """Store all settings in use (M500), and load them again; Refused when that fails."""
        self._memory.refuse_unready()
        self._learn()
        before = self._memory.settings
        self._memory.store()
        self._learn()
        if self._memory.settings != before:
            raise Refused(RESTORE)

    def roll_back(self) -> None:
        """Use the stored settings again (M501); Refused when no others are in use."""
        if not self._memory.on_trial:
            raise Refused("Nothing is on trial.")
        self._memory.refuse_unready()
        self._memory.load()
        self._memory.on_trial = False
        self._learn()

    def backup(self) -> str:
        """Ask for all settings and the firmware, as lines."""
        self._memory.refuse_unready()
        return self._memory.everything()

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Write what differs of a backup, one setting at a time, store it, and read it back; see BacksUp."""
        backup = Backup.of(text)
        self._memory.refuse_unready()
        self._learn()
        present = Backup(self._memory.settings)
        remarks = list(backup.rounded(present))
        for line in backup.lines(present):
            try:
                self._memory.write([line])
            except Answered as error:
                remarks.append(str(error))
        self._learn()
        if backup.is_unwritten(Backup(self._memory.settings)):
            # Storing would put what is in use in place of what is stored, and that may be the better one.
            remarks += [NOT_ALL, VOLATILE]
        else:
            remarks += self._store()
        # It was asked for, also where it has changed steps per mm: what was told of others is over.
        self._moves.know_scales()
        self._moves.trouble = None
        return (*backup.left(Backup(self._memory.settings)), *remarks)

    def line(self, steps: Sequence[AxisCommand], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line; Rejected with an axis whose ramp is to be played."""
        refuse_ramp_axis(ramp_axis, "Marlin")
        self.move_by(steps)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move by so many steps; those told together go along a line. Refused while something moves."""
        self._refuse_senseless()
        self._moves.by(steps)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move to positions [steps]; as with move_by."""
        self._refuse_senseless()
        self._moves.to(positions)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run at speeds, negative for backwards [steps/s]; it has to be asked how it fares, else it comes to rest."""
        self._refuse_senseless()
        self._moves.run(speeds)

    def keep_within(self, ends: Mapping[int, Ends]) -> None:
        """Have runs end at these positions: their ways lead no further."""
        self._moves.ends = ends

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes rest positions [steps]. It isn't told of it."""
        self._refuse_senseless()
        refuse_axes(positions, len(self._places.axes))
        self._moves.refuse_moving()
        self._moves.call({each.axis: int(each.value) for each in positions})

    def stop(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # one plan, whichever is named
        """Make no further step: Marlin's only stop. All axes, since they move by one plan."""
        self._moves.stopping.stop()

    def halt(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # as stop
        """Make no further step; as stop, and with the last resort where it doesn't answer."""
        self._moves.stopping.halt()

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:  # noqa: ARG002  # all end at once
        """Return how many steps it takes until a stop has got there, from a speed [steps/s]."""
        return int(speed_steps_per_s * SETS_OUT_WITHIN_S) + 1

    @property
    def _crc(self) -> int:
        """Tells the ramps of all axes apart."""
        return binascii.crc_hqx(repr(self._places.axes).encode(), 0xFFFF)

    def _refuse_senseless(self) -> None:
        """Refused where not even the first axis has settings that make sense."""
        if not self._places.axes:
            raise Refused(SENSELESS)

    def _learn(self) -> None:
        self._moves.learn()

    def _store(self) -> list[str]:
        """Store what is in use, and read it back from there; return why that couldn't be done."""
        try:
            self._memory.store()
        except NotStored as error:
            self._learn()
            return [OnTrial(f"It is not stored: {error}"), VOLATILE]
        self._learn()
        return []
