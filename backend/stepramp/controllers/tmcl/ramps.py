"""The ramps that a module's axes use, others in their place, and those that are stored."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TypeVar

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.microsteps import Microsteps
from stepramp.controllers.order import lowered_first
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.tmcl.axis import Axis
from stepramp.controllers.tmcl.conversation import MOST_REPEATS, Denied
from stepramp.controllers.tmcl.modules import Module
from stepramp.controllers.tmcl.ramp import TmclRamp
from stepramp.controllers.tmcl.stopping import Stopping
from stepramp.controllers.tmcl.units import Units
from stepramp.controllers.tmcl.wire import Status
from stepramp.errors import Refused

T = TypeVar("T")


class Locked(Refused):
    """A module's memory for settings is locked."""

    def __init__(self) -> None:
        super().__init__(
            "The module's memory for settings, its EEPROM, is locked, so nothing was stored: unlock it, as the "
            "TMCL-IDE does."
        )


class Ramps:
    """The ramps of a module's axes as they were last read. tell: called with how far a push has come."""

    def __init__(self, module: Module, axes: Sequence[Axis], stopping: Stopping, tell: Tell) -> None:
        self.parameters = module.parameters
        self._axes = axes
        self._stopping = stopping
        self._tell = tell
        self.units: list[Units] = []
        """Of each axis."""
        self.microsteps = [
            Microsteps(f"Axis {axis.number}", f"axis parameter {axis.parameters.resolution}") for axis in axes
        ]
        """Of each axis."""
        self._in_turn = 0
        """The axis that is asked for its microsteps next, at rest."""
        self.in_use: list[TmclRamp] = []
        self._told: dict[int, list[str]] = {}
        """In which order axes were last told their figures: in that they are stored."""
        self.on_trial = False
        """Whether other ramps are in use than those that are stored, as far as this connection knows."""

    def learn(self) -> None:
        """Ask for all that is known of the axes; Refused when one has units that aren't."""
        for known, axis in zip(self.microsteps, self._axes, strict=True):
            known.learn(axis.microsteps())
        self._learn_units()

    def learn_again(self) -> None:
        """Ask for the same once others may be in use: where axes are isn't known any more with other microsteps."""
        self.look_at_microsteps()
        self._learn_units()

    def look_at_microsteps(self) -> None:
        """Ask for the microsteps of all axes, at rest: others may have changed them."""
        for known, axis in zip(self.microsteps, self._axes, strict=True):
            known.note(axis.microsteps(), axis.look().position)

    def look_at_microsteps_in_turn(self, positions: Sequence[int]) -> None:
        """Ask one axis, each in its turn, for its microsteps: each question takes as long as where an axis is."""
        number, self._in_turn = self._in_turn, (self._in_turn + 1) % len(self._axes)
        with suppress(Refused):
            self.microsteps[number].note(self._axes[number].microsteps(), positions[number])

    def refuse_other_microsteps(self, number: int, position: int) -> None:
        """Refused where an axis makes another number of steps of a full step than was told."""
        self.microsteps[number].refuse_changed(self._axes[number].microsteps(), position)

    def _learn_units(self) -> None:
        self.units = [axis.units() for axis in self._axes]
        self.look()

    def look(self) -> None:
        """Ask for the ramps in use."""
        names = [each.name for each in TmclRamp.figures()]
        self.in_use = [TmclRamp(**{name: axis.get(axis.parameters.of(name)) for name in names}) for axis in self._axes]

    def use(self, ramps: Mapping[int, TmclRamp]) -> None:
        """Have axes that rest use ramps, and read back what they have; Denied when one doesn't take a figure."""
        self.on_trial = True
        for number, ramp in ramps.items():
            axis = self._axes[number]
            figures = zip(ramp.named, self.in_use[number].named, strict=True)
            in_order = lowered_first(figures, lambda both: both[0][1] > both[1][1])
            for (name, value), _ in in_order:
                axis.set(axis.parameters.of(name), value)
            self._told[number] = [name for (name, _), _ in in_order]
        self._tell(Progress(PushStage.READING_BACK, 0, 0))
        self.look()

    def keep(self, numbers: Iterable[int]) -> None:
        """Store the ramps in use of axes that rest, and see that they are: they are loaded again for that.

        Refused when the memory is locked, or has other figures afterwards.
        """
        self._tell(Progress(PushStage.STORING, 0, 0))
        wanted = {number: self.in_use[number] for number in numbers}
        for number in wanted:
            self.held(self._axes[number], partial(self._store, number))
        self._recall(wanted)
        if any(not ramp.is_kept_by(self.in_use[number], self.units[number]) for number, ramp in wanted.items()):
            raise Refused("The module has stored other figures than it had in use: push again, or restore a backup.")

    def roll_back(self) -> None:
        """Use the stored ramps again at rest; Refused when they were in use."""
        before, was_on_trial = self.in_use, self.on_trial
        self._recall(range(len(self._axes)))
        if not was_on_trial and before == self.in_use:
            raise Refused("Nothing is on trial: the stored ramps are in use.")

    def _recall(self, numbers: Iterable[int]) -> None:
        """Use what is stored."""
        for number in numbers:
            axis = self._axes[number]
            self.held(axis, partial(self._load, axis))
            if axis.look().speed:
                self._stopping.stop([number])
                raise Refused("Loading the stored ramp has set the motor moving, and it was stopped.")
        self.on_trial = False
        self.look()

    def held(self, axis: Axis, job: Callable[[Callable[[], None]], T]) -> T:
        """Store or load figures of an axis that rests, while it is where its target is; return what that does.

        Some firmwares store, and load, the speed that an axis is told in place of that of its ramp: once it was stopped
        that is 0, and loading the ramp's would set it moving. So both are done anew when a stop comes in their midst.

        job: is given what is to be called before each of its commands.
        """
        while True:
            stops = self._stopping.count
            allowed = partial(self._stopping.refuse_stopped, stops)
            try:
                self._hold(axis, allowed)
                return job(allowed)
            except AnswerUnknown:
                if self._stopping.count == stops:
                    raise

    def _hold(self, axis: Axis, allowed: Callable[[], None]) -> None:
        seen = axis.look()
        if seen.speed:
            raise Refused("The motor moves: stop it first.")
        if not any(axis.go_to(seen.position, allowed) for _ in range(1 + MOST_REPEATS)):
            raise Refused("The module doesn't take a target: is its serial line disturbed?")

    def _store(self, number: int, allowed: Callable[[], None]) -> None:
        axis = self._axes[number]
        for name in self._told.get(number) or [name for name, _ in self.in_use[number].named]:
            store(axis, axis.parameters.of(name), allowed)

    def _load(self, axis: Axis, allowed: Callable[[], None]) -> None:
        for each in TmclRamp.figures():
            axis.recall(axis.parameters.of(each.name), allowed)


def store(axis: Axis, parameter: int, allowed: Callable[[], None]) -> None:
    """Store a parameter as it is; Locked when the memory is. allowed: see Conversation.ask."""
    try:
        axis.store(parameter, allowed)
    except Denied as error:
        if error.status == Status.EEPROM_LOCKED:
            raise Locked from error
        raise
