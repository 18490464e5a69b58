"""What a FluidNC keeps: items in use, which a restart forgets, and the file that it has them from.

The file is read, and never written: `$CD=…` rewrites it whole, without its comments, and what some versions write they
can't read again (`NO PIN`, in 4.0.1). So whatever happens, a restart (`$Bye`, or the power) brings back what was there
before. A reset by Ctrl-X doesn't: FluidNC reads its file only as it starts.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from stepramp.controllers.fluidnc.configuration import AT_START, AT_UNLOCKING, Configuration
from stepramp.controllers.given_numbers import may_be_told
from stepramp.controllers.grbl.conversation import Answered, Conversation
from stepramp.controllers.grbl.dialect import DEAF_ALARMS, LONGEST_LINE, State
from stepramp.controllers.grbl.listings import Listings
from stepramp.controllers.order import lowered_first
from stepramp.errors import Refused

LISTING_S = 5.0
"""So long a listing of all may take [s]: 8 KB at 115200 baud take 0.7 s."""
TAKEN = " What was sent before that is in use: roll back, or push again."
_PLAIN = re.compile(r"[A-Za-z0-9_./-]+")
"""A name of a file that has no byte in it which would be obeyed at once."""
DUMP, FILE_NAME, SHOW = "$CD", "$Config/Filename", "$LocalFS/Show"


def file_in(backup: Sequence[str]) -> list[str]:
    """Return the lines of the file that a backup has as comments, at its end; [] for a text that is none."""
    head = f"# {SHOW}"
    return [line.removeprefix("# ") for line in backup[backup.index(head) + 1 :]] if head in backup else []


class Memory:
    """The memory of a FluidNC as it was last read."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._listings = Listings(conversation)
        self.settings = Configuration({}, frozenset(), {})
        """As in use."""
        self.stored = self.settings
        """As its file has it; as it was found, where the file can't be read."""
        self._file_read: Configuration | None = None

    @property
    def may_reset(self) -> bool:
        """Whether nothing sets out when the controller starts anew: it carries macros out then."""
        return bool(self.settings.items) and not self.settings.carries_out(AT_START)

    @property
    def may_unlock(self) -> bool:
        """Whether nothing sets out when it is unlocked: it carries a macro out then."""
        return not self.settings.carries_out(AT_UNLOCKING)

    def learn(self) -> None:
        """Read what is in use, and what the file has."""
        self._file_read = None
        self.learn_in_use()
        self.stored = self.settings
        with suppress(Answered):
            file = Configuration.of(self._file(self._listings.heard))
            if file.axis(0) is not None:
                self.stored = self._file_read = file
                self.settings = self.settings.with_scales_of(file)

    def learn_in_use(self) -> None:
        """Read what is in use."""
        told = Configuration.of(self._listings.heard(DUMP, LISTING_S))
        self.settings = told if self._file_read is None else told.with_scales_of(self._file_read)

    def has_scales(self, axes: int) -> bool:
        """Ask again, and return whether the steps per mm of so many axes are those that were last read.

        Each is asked for alone: the whole configuration takes 0.7 s.
        """
        return all(self._has_scale(axis) for axis in range(axes))

    def _has_scale(self, axis: int) -> bool:
        there = self.settings.axis(axis)
        try:
            said = self._conversation.ask(f"$/{self.settings.scale_name(axis)}")
            told = next(line.rpartition("=")[2] for line in said if "=" in line)
            return there is not None and may_be_told(told, float(there.steps_per_mm))
        except (Answered, StopIteration, ValueError):
            return False

    def everything(self) -> str:
        """Return all that can be read, as it was told; Refused where it isn't told the same twice."""
        said = ["# $I", *(f"# {line}" for line in self._conversation.ask("$I", LISTING_S))]
        said += [f"# {DUMP}", *self._listings.agreed(DUMP, LISTING_S)]
        said += ["# $#", *(f"# {line}" for line in self._listings.agreed("$#", LISTING_S))]
        with suppress(Answered):
            said += [f"# {SHOW}", *(f"# {line}" for line in self._file(self._listings.agreed))]
        return "\n".join(said) + "\n"

    def refuse_unready(self) -> None:
        """Refused where an item wouldn't be taken, or may not be: only at rest, and not after a hit limit switch."""
        report = self._conversation.look()
        if report.state is State.ALARM and self._conversation.alarm in DEAF_ALARMS:
            raise Refused("The controller is in alarm since a limit was hit: reset it at the machine first.")
        if report.state not in (State.IDLE, State.ALARM):
            raise Refused(f"The controller takes settings only at rest, and its state is {report.state.value!r}.")

    def use(self, wanted: Mapping[str, str]) -> None:
        """Set items, one at a time; one that is refused is set back, since it may be in use all the same.

        Raises Answered when one is refused.
        """
        after = ""
        for path in self.in_order(wanted):
            try:
                self._conversation.ask(f"$/{path}={wanted[path]}")
            except Answered as error:
                with suppress(Answered, ValueError):
                    self._conversation.ask(f"$/{path}={float(self.settings.items.get(path, ''))}")
                raise Answered(error.line, error.code, after) from error
            after = TAKEN

    def in_order(self, wanted: Mapping[str, str]) -> list[str]:
        """Return the paths of items in the order in which they are set."""
        return lowered_first(wanted, lambda path: self._is_less_than(path, wanted[path]))

    def _is_less_than(self, path: str, value: str) -> bool:
        """Whether an item in use is a number, and less than another one."""
        with suppress(ValueError):
            return float(self.settings.items.get(path, "")) < float(value)
        return False

    def _file(self, read: Callable[[str, float], list[str]]) -> list[str]:
        """Read the file of the configuration; Answered when it can't be."""
        told = self._conversation.ask(FILE_NAME)
        name = next((line.partition("=")[2].strip() for line in told if "=" in line), "")
        line = f"{SHOW}=/{name.removeprefix('/')}"
        return read(line, LISTING_S) if _PLAIN.fullmatch(name) and len(line) <= LONGEST_LINE else []
