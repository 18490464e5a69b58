"""What a grbl keeps: its settings and start-up lines, read, and written one at a time.

It reads its settings as it is powered up or reset by its pin, and no more: what it tells of them after that is what it
has in use, also after a reset by 0x18. Offsets and start-up lines it reads whenever it lists them.
"""

from collections.abc import Collection, Iterable, Mapping

from stepramp.controllers.grbl.conversation import UNREADABLE, Answered, Conversation
from stepramp.controllers.grbl.dialect import DEAF_ALARMS, State, moves_nothing
from stepramp.controllers.grbl.listings import Listings
from stepramp.controllers.grbl.settings import REPORTS_INCHES, STEPS_PER_MM, TRAVEL, Settings, is_told_same
from stepramp.errors import Refused

VERSION, SETTINGS, PLACES, STARTUP = "$I", "$$", "$#", "$N"
TAKEN = " What was sent before that is stored: restore a backup of this device, or push again."


class Memory:
    """The memory of a grbl as it was last read."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._listings = Listings(conversation)
        self.settings = Settings({})
        self._startup: list[str] | None = None
        self._given: dict[str, str | None] = {}
        self._left: set[str] = set()

    @property
    def may_reset(self) -> bool:
        """Whether nothing sets out when the controller starts anew: it carries its start-up lines out then."""
        if self._startup is None:
            return False
        return all(moves_nothing(_block_of(line)) for line in self._startup)

    @property
    def may_unlock(self) -> bool:
        """True: nothing is carried out when a grbl is unlocked."""
        return True

    def learn(self) -> None:
        """Read the settings and the start-up lines."""
        self.settings = Settings.of(self._listings.heard(SETTINGS))
        self._startup = self._listings.heard(STARTUP)

    def learn_in_use(self) -> None:
        """Read the settings, each of which is in use as it is stored."""
        self.learn()

    def has_scales(self, axes: int) -> bool:
        """Ask again, and return whether the steps per mm of so many axes are those that were last read."""
        told = Settings.of(self._listings.heard(SETTINGS)).values
        # And the unit that places are told in.
        numbers = (REPORTS_INCHES, *range(STEPS_PER_MM, STEPS_PER_MM + axes))
        return all(told.get(number) == self.settings.values.get(number) for number in numbers)

    def everything(self) -> str:
        """Return all that can be read, as it was told; Refused where it isn't told the same twice."""
        said = [f"; {VERSION}", *self._conversation.ask(VERSION)]
        for listing in (SETTINGS, PLACES, STARTUP):
            said += [f"; {listing}", *self._listings.agreed(listing)]
        return "\n".join(said) + "\n"

    def refuse_unready(self) -> None:
        """Refused where a setting wouldn't be taken, or may not be: only at rest, and not after a hit limit switch."""
        report = self._conversation.look()
        if report.state is State.ALARM and self._conversation.alarm in DEAF_ALARMS:
            raise Refused("The controller is in alarm since a limit was hit: reset it at the machine first.")
        if report.state not in (State.IDLE, State.ALARM):
            raise Refused(f"The controller takes settings only at rest, and its state is {report.state.value!r}.")

    def write(self, lines: Iterable[str]) -> None:
        """Write settings, one at a time: while it writes, it loses what is sent; Answered when one is refused."""
        after = ""
        for line in lines:
            try:
                self._give(line)
            except Answered as error:
                raise Answered(error.line, error.code, after) from error
            after = TAKEN

    def refusal(self, line: str) -> str | None:
        """Write a setting, or something else of a backup; return why it is refused, as a sentence, or None."""
        for is_last in (False, True):
            try:
                self._give(line)
            except Answered as error:
                # What it couldn't read it has put to its default by then: so it can be written.
                if is_last or error.code != UNREADABLE:
                    return str(error)
            else:
                break
        return None

    def leave(self, numbers: Iterable[int]) -> None:
        """Note that settings are wanted as they are now, unless they were given something."""
        self._left = {f"${number}" for number in numbers if _is_of_axis(number)} - self._given.keys()

    def take_given(self) -> Mapping[str, str | None]:
        """Return what settings of axes were given since this was last asked; see ProvenByStart."""
        given, self._given = self._given, {}
        return given

    def take_left(self) -> Collection[str]:
        """Return what settings of axes were left since this was last asked; see ProvenByStart."""
        left, self._left = self._left, set()
        return left

    def differing(self, wanted: Mapping[int, str]) -> list[int]:
        """Return the numbers of settings that are others than wanted, as they were last read."""
        return [number for number, value in wanted.items() if not is_told_same(self.settings.values.get(number), value)]

    def _give(self, line: str) -> None:
        """Send what is to be stored. Until it is answered nobody knows which value a setting has."""
        name, _, value = line.partition("=")
        is_of_axis = name[1:].isdecimal() and _is_of_axis(int(name[1:]))
        if is_of_axis:
            self._given[name] = None
        self._conversation.ask(line)
        if is_of_axis:
            self._given[name] = value


def _is_of_axis(number: int) -> bool:
    return STEPS_PER_MM <= number < TRAVEL + 10


def _block_of(line: str) -> str:
    """Return what a start-up line, listed as $N0=G54, carries out."""
    return line.partition("=")[2] if line.startswith("$N") else ""
