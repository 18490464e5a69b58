"""A machine that is spoken to as grbl is: axes that move along one line, jogs, and stops as bytes in between.

It answers each line, and is asked how it fares. What it keeps, and how that is written, is its family's.
"""

import binascii
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Protocol

from stepramp.controllers.axes import refuse_axes, refuse_ramp_axis
from stepramp.controllers.capabilities import DrawsLines
from stepramp.controllers.contract import (
    UNDER_WAY,
    Activity,
    AxisCommand,
    AxisStatus,
    Controller,
    ControllerStatus,
    Ends,
    StoredRamp,
)
from stepramp.controllers.grbl.conversation import Answered, Conversation
from stepramp.controllers.grbl.dialect import DEAF_ALARMS, Report, State
from stepramp.controllers.grbl.moves import Moves
from stepramp.controllers.grbl.places import Places
from stepramp.controllers.grbl.settings import STAYS_ON, Known
from stepramp.controllers.grbl.stopping import Stopping
from stepramp.errors import Refused

ALWAYS_ON = 255
"""Of $1: the motors keep their current."""


class Remembers(Protocol):
    """What is known of what a machine keeps."""

    def learn_in_use(self) -> None:
        """Read what is in use."""

    def has_scales(self, axes: int) -> bool:
        """Ask again, and return whether the steps per mm of so many axes are those that were last read."""

    @property
    def settings(self) -> Known:
        """As they were last read."""

    @property
    def may_reset(self) -> bool:
        """Whether nothing sets out when it starts anew."""

    @property
    def may_unlock(self) -> bool:
        """Whether nothing sets out when it is unlocked."""


def _unknown_axis(report: Report) -> AxisStatus:
    """Return what is told of the first axis where its settings make no sense."""
    return AxisStatus.untold(Activity.MOVING if report.is_under_way else Activity.READY)


class GrblMachine(Controller, DrawsLines):
    """A client of such a machine; see Controller for what its calls do."""

    def __init__(
        self, conversation: Conversation, memory: Remembers, give_way: Callable[[float], None], called: str
    ) -> None:
        """Talk in a conversation. called: what people call its firmware."""
        self._conversation = conversation
        self._remembers = memory
        self._called = called
        self._places = Places()
        self._stopping = Stopping(conversation, lambda: memory.may_reset)
        self._moves = Moves(conversation, self._places, self._stopping, give_way, self._ask_for_scales, called)

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        """None: its own timer is its own affair."""
        return ()

    @property
    def timer_hz(self) -> int | None:
        """None, as said."""
        return None

    @property
    def most_axes(self) -> int:
        """As many as it tells positions of."""
        return len(self._places.axes)

    def disconnect(self) -> None:
        """Leave the controller alone: a run ends by itself, since it isn't told to go on any more."""

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing, and have axes that run go on."""
        while True:
            stops = self._stopping.count
            report = self._moves.look()
            self._stopping.note(report)
            self._moves.go_on(report)
            self._heed_others(report)
            # What was seen before a stop in the midst doesn't go with what was seen after it.
            if self._stopping.count == stops:
                break
        axes = self._moves.axes(report) or (_unknown_axis(report),)
        activities = {axis.activity for axis in axes}
        activity = next((each for each in UNDER_WAY if each in activities), Activity.READY)
        return ControllerStatus(
            activity=activity,
            axes=axes,
            ramp=StoredRamp(sequence=None, crc=self._crc),
            on_trial=False,
            motors_on=activity is not Activity.READY or self._remembers.settings.number(STAYS_ON) >= ALWAYS_ON,
            trouble=None if report.state is State.RUN else self._moves.inability(report) or self._places.trouble,
        )

    def listen(self) -> ControllerStatus | None:
        """Return None: it says nothing of its motion unasked."""
        return None

    def line(self, steps: Sequence[AxisCommand], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line; Rejected with an axis whose ramp is to be played."""
        refuse_ramp_axis(ramp_axis, self._called)
        self.move_by(steps)

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move by so many steps from the target; axes that are told together go along a line."""
        self._refuse_senseless()
        self._moves.by(steps)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move to positions [steps]; axes that are told together go along a line."""
        self._refuse_senseless()
        self._moves.to(positions)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run at speeds, negative for backwards [steps/s]; it has to be asked how it fares, else it comes to rest."""
        self._refuse_senseless()
        self._moves.run(speeds)

    def keep_within(self, ends: Mapping[int, Ends]) -> None:
        """Have runs end at these positions: their jogs lead no further."""
        self._moves.ends = ends

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes rest positions [steps]; one that is locked is unlocked. It isn't told of it."""
        self._refuse_senseless()
        refuse_axes(positions, len(self._places.axes))
        report = self._moves.look()
        if report.is_under_way:
            raise Refused("The motor moves: stop it first.")
        if report.state is State.ALARM:
            if self._conversation.alarm in DEAF_ALARMS:
                raise Refused(self._moves.inability(report) or "")
            if not self._remembers.may_unlock:
                raise Refused(
                    "The controller is locked, and carries something out when it is unlocked, which may move: "
                    "unlock it at the machine."
                )
            self._conversation.ask("$X")
            self._stopping.was_halted = False
            report = self._moves.look()
        if self._places.changed:
            report = self._begun_anew(report)
        self._places.call({each.axis: int(each.value) for each in positions}, self._places.counted(report))
        self._moves.rest_at(report)

    def stop(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # one plan, whichever is named
        """Begin to slow down: all axes, since they move by one plan."""
        self._stopping.stop()

    def halt(self, axes: Collection[int] | None = None) -> None:  # noqa: ARG002  # as stop
        """Make no further step; where a controller is that moved isn't known then."""
        self._stopping.halt()

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps slowing down from a speed [steps/s] takes."""
        return self._moves.steps_to_rest(axis, speed_steps_per_s)

    def _know_places(self) -> None:
        """Take the scales as they were just read, and where the axes rest."""
        report = self._moves.look()
        self._places.learn(self._remembers.settings, report)
        self._moves.rest_at(report)

    def _read_again(self) -> None:
        """Read what is in use again, and where the axes rest by that."""
        self._remembers.learn_in_use()
        self._know_places()

    def _ask_for_scales(self) -> Sequence[str]:
        """Ask for the steps per mm again, which somebody else may have set; return how they have changed."""
        if self._remembers.has_scales(len(self._places.axes)):
            return ()
        self._read_again()
        return self._places.rescaled

    def _heed_others(self, report: Report) -> None:
        """Ask for the steps per mm again once axes are told to rest elsewhere, though nothing was begun here."""
        is_deaf = report.state is State.ALARM and self._conversation.alarm in DEAF_ALARMS
        if report.state not in (State.IDLE, State.ALARM) or is_deaf:
            return
        if self._places.is_elsewhere(report):
            try:
                self._ask_for_scales()
            except Answered:
                # It tells them only at rest, and has set out by now: the next status asks.
                return
        self._places.note_rest(report)

    def _begun_anew(self, report: Report) -> Report:
        """Have it start anew once its steps per mm have changed, and return how it fares then.

        Until then it counts axes that a line doesn't name by what they were: they would set out with others.
        """
        if report.state is not State.IDLE or not self._remembers.may_reset:
            raise Refused(
                f"{self._places.change_words} The controller has to be started anew before it moves, and "
                "can't be from here, since that may move something: do that at the machine, and connect it again."
            )
        self._conversation.reset()
        return self._moves.look()

    @contextmanager
    def _known_again_on_refusal(self) -> Iterator[None]:
        """Read what it keeps again when it refuses something: what was sent before that is written."""
        try:
            yield
        except Answered:
            self._read_again()
            raise

    def _refuse_senseless(self) -> None:
        """Refused where not even the first axis has settings that make sense."""
        if not self._places.axes:
            raise Refused(self._places.trouble or "The controller tells of no axis.")

    @property
    def _crc(self) -> int:
        """Tells the ramps of all axes apart."""
        scales = [f"{each.steps_per_mm}/{each.most_rate}/{each.acceleration}" for each in self._places.axes]
        return binascii.crc_hqx(",".join(scales).encode(), 0xFFFF)
