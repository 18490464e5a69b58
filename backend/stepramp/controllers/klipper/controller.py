"""A Klipper behind its server, Moonraker: axes that move along one line, with limits that all of them share.

It answers each request, and tells unasked how it fares. What it keeps is written only by a push that stores, and by
what restores a backup.
"""

import binascii
from collections.abc import Callable, Collection, Mapping, Sequence
from time import monotonic, sleep

from stepramp.controllers.axes import refuse_ramp_axis
from stepramp.controllers.capabilities import BacksUp, DrawsLines, LooksFirst, StoresRamps, TriesRamps
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
from stepramp.controllers.klipper.backup import Backup
from stepramp.controllers.klipper.conversation import GOING_S, Answered, Conversation, Port
from stepramp.controllers.klipper.machine import Limits
from stepramp.controllers.klipper.memory import Memory, stored_differs
from stepramp.controllers.klipper.moves import BUSY, Moves
from stepramp.controllers.klipper.push import PushPlan
from stepramp.controllers.klipper.seen import DISCONNECTED, READY, STARTUP, Seen
from stepramp.controllers.klipper.stopping import Stopping
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused

CONNECT_S = 4.5
"""So long connecting may take, once the port is open, without a stop that is owed [s]."""
LEFT_S = 3.5
"""So long what an earlier connection has left in Klipper's plan is given to come to rest [s]."""
LOOK_S = 0.1
NOT_RESTARTED = "Klipper was not restarted: that it starts with this is known of its file only."
OTHERS = (
    "What moves was told to Klipper by somebody else, and Klipper can't slow it down: end it at the printer, or halt "
    "it here, which shuts Klipper down."
)


class KlipperController(Controller, StoresRamps, TriesRamps, DrawsLines, BacksUp, LooksFirst):
    """A client of Klipper; see Controller for what its calls do."""

    def __init__(self, port: Port, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None) -> None:
        """Talk over an open Moonraker.

        give_way: called in the midst of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        self._tell = tell
        self._conversation = Conversation(port, give_way)
        self._memory = Memory(self._conversation)
        self._stopping = Stopping(self._conversation)
        self._moves = Moves(self._conversation, self._memory, self._stopping, give_way)

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        """None: the clocks of its boards are Klipper's own affair."""
        return ()

    @property
    def timer_hz(self) -> int | None:
        """None, as said."""
        return None

    @property
    def most_axes(self) -> int:
        """x, y and z; none of a Klipper that isn't ready and tells of none."""
        return len(self._memory.machine.steppers) if self._memory.knows_axes else 0

    @property
    def firmware_version(self) -> str | None:
        """Such as v0.12.0-85-gd785b396."""
        return self._memory.version

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Find out whether it is Klipper, and learn what it keeps. It is told nothing but questions.

        Raises Refused when something else is there, or Klipper doesn't run, starts, or has motors that are no axes.
        One that doesn't start for its configuration is connected all the same: a backup may be written to it.
        DeviceLost when it takes longer than CONNECT_S.
        """
        began_s = monotonic()
        name, state = self._conversation.name, self._conversation.begin()
        left_s = CONNECT_S - (monotonic() - began_s)
        if state == DISCONNECTED:
            raise Refused(f"Moonraker answers at {name}, but Klipper doesn't run: start it first.")
        if state == STARTUP:
            raise Refused(f"Klipper at {name} is still starting: connect it again in a moment.")
        self._memory.trouble = None if state == READY else state
        greeted()
        with self._conversation.within(left_s):
            self._memory.learn()
            if self._is_ready:
                self._moves.rest_at(self._conversation.subscribe())
        self._conversation.restarts = 0

    def disconnect(self) -> None:
        """Leave the printer alone: what was told comes to rest, since no more is told."""
        self._moves.put_back_state()

    def status(self) -> ControllerStatus:
        """Ask what Klipper is doing, and have what moves go on."""
        if not self._is_ready:
            return self._status_of_unready()
        while True:
            stops = self._stopping.count
            seen = self._look()
            self._moves.go_on(seen)
            # What was seen before a stop in the midst doesn't go with what was seen after it.
            if self._stopping.count == stops:
                return self._status(seen)

    def listen(self) -> ControllerStatus | None:
        """Return what Klipper has told unasked, and have what moves go on."""
        seen = self._conversation.listen() if self._is_ready else None
        self._refuse_restarted()
        if seen is None:
            return None
        self._moves.go_on(seen)
        return self._status(seen)

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        """Work out the limits of the axes, and return the call that sets them; see Controller."""
        plan = self._plan(designs, first_axis, mode)

        def push() -> PushReport:
            self._refuse_unready()
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            remarks = list[str]()
            self._moves.await_rest()
            if mode == "keep":
                # First what can be refused, and what lasts.
                remarks += self._memory.store(plan.options)
            in_use = self._memory.use(plan.options)
            if mode == "keep":
                self._tell(Progress(PushStage.READING_BACK, 0, 0))
                remarks += self._memory.start_anew()
                in_use = self._memory.in_use(self._look())
                if self._memory.awaits_start:
                    remarks.append("Limits of z hold from Klipper's next start on.")
            read_back = self._known(in_use) if mode == "keep" else in_use
            verified = plan.is_had(read_back) and (mode == "try" or plan.is_had(self._memory.stored))
            return plan.report(read_back, remarks, mode, verified=verified)

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        plan = self._plan(designs, first_axis, "keep")
        seen = self._conversation.last
        return plan.preview(self._known(self._memory.in_use(seen)), self._memory.consequences(plan.options, seen))

    def look_first(self) -> None:
        """Look at how it fares, and at the configuration's files; see LooksFirst."""
        if self._is_ready:
            self._look()
            self._memory.look_at_files()

    def keep(self) -> tuple[str, ...]:
        """Write the limits in use to the configuration, and return what there is to say; Refused when it has them."""
        self._refuse_unready()
        in_use = self._memory.in_use(self._moves.await_rest())
        if not stored_differs(self._memory.stored, in_use):
            raise Refused("Nothing is on trial: Klipper's configuration has the limits that are in use.")
        options = {"max_accel": repr(float(in_use.accel)), "max_velocity": repr(float(in_use.velocity))}
        return (*self._memory.store(options), NOT_RESTARTED)

    def roll_back(self) -> None:
        """Set the limits that the configuration has; Refused when no others are in use."""
        self._refuse_unready()
        stored = self._memory.stored
        if not stored_differs(stored, self._memory.in_use(self._moves.await_rest())):
            raise Refused("Nothing is on trial: Klipper's configuration has the limits that are in use.")
        options = {"max_accel": repr(float(stored.accel)), "max_velocity": repr(float(stored.velocity))}
        if stored_differs(stored, self._memory.use(options)):
            raise Refused("The limits are not those of the configuration: push again.")

    def backup(self) -> str:
        """Read the configuration's files and the limits in use, as JSON in which each line of a file is one."""
        return self._memory.everything(self._quiet())

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Write what differs of a backup, and have Klipper read it where that costs nothing; see BacksUp."""
        backup = Backup.of(text)
        seen, homes_by = self._quiet(), self._memory.homes_by
        remarks = list(self._memory.restore(backup, seen))
        if seen is None:
            return (*remarks, "Klipper isn't ready: say FIRMWARE_RESTART, so that it reads its configuration again.")
        remarks += self._memory.start_anew()
        if self._memory.homes_by != homes_by and (remark := self._moves.count_as_klipper()) is not None:
            remarks.append(remark)
        for word, name in (("VELOCITY", "max_velocity"), ("ACCEL", "max_accel")):
            has = getattr(self._look().toolhead, name)
            if word in backup.limits and backup.limits[word] != has:
                remarks.append(f"{name} in use is {has:,.10g}, as its configuration has it, not as in the backup.")
        return tuple(remarks)

    def line(self, steps: Sequence[AxisCommand], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line; Rejected with an axis whose ramp is to be played."""
        refuse_ramp_axis(ramp_axis, "Klipper")
        self.move_by(steps)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move by so many steps from the target; axes that are told together go along a line."""
        self._refuse_unready()
        self._moves.by(steps)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move to positions [steps]; axes that are told together go along a line."""
        self._refuse_unready()
        self._moves.to(positions)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run at speeds, negative for backwards [steps/s]; it has to be asked how it fares, else it comes to rest."""
        self._refuse_unready()
        self._moves.run(speeds)

    def keep_within(self, ends: Mapping[int, Ends]) -> None:
        """Have runs end at these positions, as at the end of a travel."""
        self._moves.ends = ends

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes rest positions [steps], once they are homed. Klipper isn't told of it."""
        self._refuse_unready()
        self._moves.set_position(positions)

    def stop(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # one plan, whichever is named
        """Add nothing to the plan any more: it is played to its end, which is at rest, within 2 s and the slowing down.

        What an earlier connection has left there comes to rest by itself. Refused while what somebody else has told
        Klipper moves, as a print that isn't paused: only a halt ends that.
        """
        self._stopping.note()
        self._stopping.let_end()
        deadline_s = monotonic() + LEFT_S
        while (seen := self._seen_moving()) is not None and self._moves.do_others_go_on(seen):
            if seen.virtual_sdcard.is_active or monotonic() > deadline_s:
                raise Refused(OTHERS)
            self._conversation.wait(LOOK_S)

    def halt(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # as stop
        """Make no further step: Klipper is shut down, unless it rests. It has to be restarted and homed then."""
        self._stopping.note()
        if (seen := self._seen_moving()) is None:
            return
        if self._conversation.awaits_script or self._moves.is_under_way(seen) or seen.is_printing or seen.is_busy:
            self._stopping.shut_down()
            self._memory.was_halted = True

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps slowing down from a speed [steps/s] takes."""
        return self._moves.steps_to_rest(axis, speed_steps_per_s)

    def _plan(self, designs: Sequence[Design], first_axis: int | None, mode: PushMode) -> PushPlan:
        self._refuse_unready()
        ratio = self._conversation.last.cruise_ratio
        return PushPlan.of(designs, first_axis, self._memory.machine, ratio, mode)

    @property
    def _is_ready(self) -> bool:
        """Whether it was ready when it was connected."""
        return self._memory.trouble is None

    def _seen_moving(self) -> Seen | None:
        """Return how it fares, asked now; None where nothing can move.

        So it is where it wasn't ready when it was connected, and while it starts anew, as it was told here. Moonraker
        may call it ready for a moment longer than it reaches it.
        """
        deadline_s = monotonic() + GOING_S
        while self._is_ready:
            if self._memory.is_starting and self._conversation.state() != READY:
                return None
            try:
                return self._look()
            except Answered:
                if not self._memory.is_starting or monotonic() > deadline_s:
                    raise
            self._conversation.wait(LOOK_S)
        return None

    def _refuse_unready(self) -> None:
        if not self._is_ready:
            raise Refused(f"Klipper isn't ready: {self._memory.trouble}")

    def _refuse_restarted(self) -> None:
        if self._conversation.restarts and not self._memory.is_starting:
            raise DeviceLost(f"Klipper at {self._conversation.name} was restarted: its position is no longer known.")

    def _look(self) -> Seen:
        self._refuse_restarted()
        seen = self._conversation.look()
        self._refuse_restarted()
        return seen

    def _quiet(self) -> Seen | None:
        """Return how it fares; None while it isn't ready. Refused while it prints or moves."""
        if not self._is_ready:
            return None
        seen = self._look()
        if seen.is_printing or self._moves.is_under_way(seen):
            raise Refused(BUSY)
        return seen if seen.webhooks.state == READY else None

    def _known(self, in_use: Limits) -> Limits:
        """Return limits with those of z as its configuration has them: it tells no others of z."""
        stored = self._memory.stored
        return Limits(in_use.velocity, in_use.accel, stored.z_velocity, stored.z_accel)

    def _status(self, seen: Seen) -> ControllerStatus:
        axes = self._moves.axes(seen)
        activities = {axis.activity for axis in axes}
        activity = next((each for each in UNDER_WAY if each in activities), Activity.READY)
        in_use = self._memory.in_use(seen)
        return ControllerStatus(
            activity=activity,
            axes=axes,
            ramp=StoredRamp(sequence=None, crc=_crc(in_use)),
            on_trial=stored_differs(self._memory.stored, in_use),
            motors_on=seen.has_current or activity is not Activity.READY,
            trouble=self._moves.inability(seen) or self._moves.past_trouble or self._moves.unhomed(seen),
        )

    def _status_of_unready(self) -> ControllerStatus:
        """Return that nothing can be done; DeviceLost once it is ready, to be connected anew."""
        self._refuse_restarted()
        info = self._conversation.ask("printer.info")
        if isinstance(info, dict) and info.get("state") == READY:
            self._conversation.restarts += 1
        self._refuse_restarted()
        return ControllerStatus(
            activity=Activity.READY,
            axes=(AxisStatus.untold(),),
            ramp=None,
            on_trial=False,
            motors_on=False,
            trouble=f"Klipper isn't ready: {' '.join(str(self._memory.trouble).split())}",
        )


def _crc(limits: Limits) -> int:
    """Tells the limits in use apart."""
    values = (limits.velocity, limits.accel, limits.z_velocity, limits.z_accel)
    return binascii.crc_hqx(",".join(map(str, values)).encode(), 0xFFFF)
