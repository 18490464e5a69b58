"""What only some controllers can do: each capability is a protocol, and a controller has those that it derives from."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeVar, runtime_checkable

from stepramp.controllers.contract import AxisCommand, Controller, NextTrace, Trace
from stepramp.errors import Refused
from stepramp.validation import Document

C = TypeVar("C")
S = TypeVar("S", bound=Document)


@runtime_checkable
class StoresRamps(Protocol):
    """A controller that keeps ramps, and settings if it has some, when it is switched off."""

    def keep(self) -> Sequence[str] | None:
        """Store the ramps and settings in use; return what else there is to say, as sentences, None for nothing."""


@runtime_checkable
class TriesRamps(Protocol):
    """A controller that uses ramps, and settings if it has some, without storing them."""

    def roll_back(self) -> None:
        """Use the stored ramps and settings again; Refused when nothing else is in use."""


@runtime_checkable
class RestoresRamps(Protocol):
    """A controller that keeps the ramps, too, that it had before the stored ones."""

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones; Refused when there are none."""


@runtime_checkable
class HasSettings(Protocol[S]):
    """A controller with settings besides its ramps: a document of the model that its family names."""

    def settings(self) -> S:
        """Ask for the settings in use."""

    def use_settings(self, settings: S) -> None:
        """Use other settings until a roll back or a reset."""


@runtime_checkable
class TracesMoves(Protocol):
    """A controller that tells when it made each step."""

    @property
    def trace(self) -> Callable[[], Trace] | None:
        """What works out the trace of the last move that was traced, in any thread; None before there was one."""

    def trace_moves(self, axis: int | None, every_steps: int) -> NextTrace:
        """Trace every so many-th step of each move of an axis from now on, and return of which; None: no more.

        every_steps: at least; it becomes so many that the port can carry them.
        """


@runtime_checkable
class DrawsLines(Protocol):
    """A controller whose axes go along a straight line together."""

    def line(self, steps: Sequence[AxisCommand], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line.

        ramp_axis: whose ramp the axis with most steps plays; None: that of the slowest axis, so that none is faster
        than on its own.
        """


@runtime_checkable
class ZeroesGauges(Protocol):
    """A controller whose axes find position 0 by running against a stop."""

    def zero(self, axes: Collection[int], steps: int) -> None:
        """Call the places where axes are so many steps and move them to 0, as gauges find their stop."""


@runtime_checkable
class TellsSettings(Protocol):
    """A controller whose settings can be read as text, which its family makes designs of."""

    def backup(self) -> str:
        """Ask for everything that can be read, as lines of text; Refused when it can't be read now."""


@runtime_checkable
class BacksUp(TellsSettings, Protocol):
    """A controller whose settings can be written again from that text, too."""

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Write what a backup says, one setting at a time, and read it back; return what couldn't be, as sentences.

        Of what could be written and isn't as it was to be it returns an Unwritten.

        Rejected when the text is no backup of such a controller, Refused when it can't be written now.
        """


@runtime_checkable
class LooksFirst(Protocol):
    """A controller whose memory others write to, too, so that it is looked at before a push is previewed."""

    def look_first(self) -> None:
        """Read what the next preview tells besides the figures of the push, at rest."""


AT_NEXT_START = "What the controller has stored is proven at its next start"
"""The beginning of every sentence on when that is known of a ProvenByStart."""
WAIT_OR_RESTART = f"{AT_NEXT_START}: wait for that, or restart it now."
MENDING = "Restore a backup of this device, or push again."
"""What to do about one that has something else than was sent."""


@runtime_checkable
class ProvenByStart(Protocol):
    """A controller that uses at once what it is given, and what it has stored only from its next start on.

    A start is what opening its port does with many boards: it forgets where it is by that.
    """

    @property
    def has_started(self) -> bool:
        """Whether it was heard to start as its port was opened: then what it had at first is what it has stored."""

    def take_given(self) -> Mapping[str, str | None]:
        """Return what settings were given since this was last asked, by name, as they were sent.

        None: whether it was taken isn't known.
        """

    def take_left(self) -> Collection[str]:
        """Return the names of settings that were wanted as they were already, and so weren't sent, since then."""

    def others(self, given: Mapping[str, str]) -> Mapping[str, str | None]:
        """Return those of these settings that were others when they were last read, with what they were.

        None: it isn't there.
        """

    def refuse_start(self) -> None:
        """Refused unless it may be started anew from here: it rests, and moves nothing by that."""


@runtime_checkable
class HasInputs(Protocol):
    """A controller that inputs stop, such as limit switches, and that finds its axes' places by them."""

    def acknowledge(self) -> None:
        """Take motions again after an emergency stop or a driver's fault; Refused while one of them is still there."""

    def home(self, fast: Sequence[AxisCommand], slow: AxisCommand, back_off_steps: int) -> None:
        """Begin to find axes' limit switches: position 0 is then where they are not active, just before.

        fast: towards which, and how fast, negative for backwards [steps/s]. slow: without sign, of all [steps/s].
        back_off_steps: so far each goes from its switch before it comes back slowly.

        Rejected for an axis without a switch at that end. It goes on only as long as the controller is asked things.
        """


CapabilityName = Literal[
    "keep", "try", "restore", "settings", "trace", "line", "zero", "inputs", "backup", "import", "prove"
]


@dataclass(frozen=True)
class Capability:
    """What only some controllers can do."""

    name: CapabilityName
    """What the API calls it."""
    of: type
    """The protocol of those that can."""
    words: str
    """What the others can't do, as a refusal says it."""


CAPABILITIES = (
    Capability("keep", StoresRamps, "store ramps"),
    Capability("try", TriesRamps, "try ramps without storing them"),
    Capability("restore", RestoresRamps, "bring back the ramps that it had before"),
    Capability("settings", HasSettings, "be given settings"),
    Capability("trace", TracesMoves, "trace moves"),
    Capability("line", DrawsLines, "move axes along a straight line"),
    Capability("zero", ZeroesGauges, "zero gauges"),
    Capability("inputs", HasInputs, "tell of inputs, nor be homed from here"),
    Capability("backup", BacksUp, "be backed up"),
    Capability("import", TellsSettings, "tell settings that designs can be made of"),
    Capability("prove", ProvenByStart, "be started anew to prove what it has stored"),
)


def capabilities_of(controller: Controller) -> tuple[CapabilityName, ...]:
    """Return the names of what a controller can do besides what all can."""
    return tuple(each.name for each in CAPABILITIES if _has(controller, each.of))


def capabilities_of_class(made: type) -> tuple[CapabilityName, ...]:
    """Return the names of what controllers of a class can do at most; what one lacks is known once it is connected."""
    return tuple(each.name for each in CAPABILITIES if all(hasattr(made, member) for member in _members(each.of)))


def capable(controller: Controller, kind: type[C], called: str, family: str) -> C:
    """Return a controller as one that has a capability, given as its protocol; Refused when it hasn't.

    called: what people call the controller. family: the title of its family.
    """
    if not isinstance(controller, kind):
        raise refusal(kind, called, family)
    if kind in controller.lacks:
        raise Refused(f"{called} can't {_words(kind)}: its firmware is without that, or older.")
    return controller


def refusal(kind: type, called: str, family: str) -> Refused:
    """Return what is raised when a controller hasn't got a capability; as capable."""
    return Refused(f"{called} can't {_words(kind)}: no controller of its family, {family}, can.")


def _has(controller: Controller, kind: type) -> bool:
    return isinstance(controller, kind) and kind not in controller.lacks


def _members(kind: type) -> list[str]:
    return [name for name in vars(kind) if not name.startswith("_")]


def _words(kind: type) -> str:
    return next(each.words for each in CAPABILITIES if each.of is kind)
