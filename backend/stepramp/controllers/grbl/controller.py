"""A grbl at a serial port: axes that move along one line, with ramps that grbl works out from two settings each.

It answers each line, and is asked how it fares. What it keeps is written only by a push, and by what restores a backup.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from time import sleep

from stepramp.controllers.capabilities import (
    AT_NEXT_START,
    MENDING,
    WAIT_OR_RESTART,
    BacksUp,
    ProvenByStart,
    StoresRamps,
)
from stepramp.controllers.contract import (
    PushMode,
    PushPreview,
    PushReport,
)
from stepramp.controllers.grbl.backup import NOT_WRITTEN, Backup
from stepramp.controllers.grbl.conversation import Answered, Conversation
from stepramp.controllers.grbl.dialect import State
from stepramp.controllers.grbl.identity import Identity
from stepramp.controllers.grbl.machine import GrblMachine
from stepramp.controllers.grbl.memory import Memory
from stepramp.controllers.grbl.motion import SLOWEST_STEPS_PER_S
from stepramp.controllers.grbl.push import PushPlan
from stepramp.controllers.grbl.scales import unlike_words
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.remark import UNLIKE, Unwritten
from stepramp.design import Design
from stepramp.errors import Refused
from stepramp.link.connection import Connection

IN_USE = f"It is in use. {WAIT_OR_RESTART}"
MAY_MOVE = (
    "The controller isn't restarted from here: it carries out its start-up lines ($N) as it starts, which may move "
    f"something. {AT_NEXT_START}, at the machine."
)
RESTORE = f"The settings are not those that were sent. {MENDING}"

_NUMBERED = re.compile(r"[$][0-9]{1,4}")


class GrblController(GrblMachine, StoresRamps, BacksUp, ProvenByStart):
    """A client of grbl 1.1 and grblHAL; see Controller for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called in the midst of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        conversation = Conversation(port, give_way)
        self._memory = Memory(conversation)
        super().__init__(conversation, self._memory, give_way, "grbl")
        self._tell = tell
        self._identity: Identity | None = None

    @property
    def firmware_version(self) -> str | None:
        """Such as 1.1h."""
        return None if self._identity is None else self._identity.version

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Wait until a grbl is there, and learn what it keeps. It is told nothing but questions.

        Raises Refused when something else is there, or what is there moves.
        """
        self._conversation.begin()
        if (banner := self._conversation.banner) is not None:
            Identity.refuse_other(banner.version, banner.rest, self._conversation.name)
        greeted()
        report = self._conversation.look()
        if report.state not in (State.IDLE, State.ALARM):
            raise Refused(
                f"The controller at {self._conversation.name} tells what it keeps only at rest, and its state is "
                f"{report.state.value!r}: connect it again then."
            )
        self._identity = Identity.of(self._said_of_itself(), self._conversation.name)
        self._memory.learn()
        self._know_places()
        self._moves.slowest_steps_per_s = 0.0 if self._identity.is_hal else SLOWEST_STEPS_PER_S
        self._conversation.end_connecting()

    def prepare_push(
        self,
        designs: Sequence[Design],
        first_axis: int | None = None,
        mode: PushMode = "keep",  # noqa: ARG002  # what grbl takes it keeps
    ) -> Callable[[], PushReport]:
        """Work out the settings of the axes, and return the call that sends them; see Controller."""
        self._refuse_senseless()
        plan = PushPlan.of(designs, first_axis, self._places.axes)

        def push() -> PushReport:
            self._memory.refuse_unready()
            self._read_again()
            plan.refuse_other_scales(self._memory.settings)
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            with self._known_again_on_refusal():
                self._memory.write(plan.lines(self._memory.settings))
            self._read_back()
            unlike = unlike_words(plan.other_scales(self._memory.settings))
            verified = not self._memory.differing(plan.wanted) and not unlike
            said = () if verified else (*unlike, RESTORE)
            return plan.report(self._memory.settings, said, verified=verified)

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        self._refuse_senseless()
        return PushPlan.of(designs, first_axis, self._places.axes).preview(self._memory.settings)

    def keep(self) -> None:
        """Refused: nothing is ever on trial."""
        raise Refused("Nothing is on trial: grbl stores each setting at once.")

    def backup(self) -> str:
        """Ask for settings, offsets, start-up lines and version, as lines."""
        self._memory.refuse_unready()
        return self._memory.everything()

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Write what differs of a backup, one setting at a time, and read it back; see BacksUp."""
        backup = Backup.of(text)
        self._memory.refuse_unready()
        reasons, present = {}, Backup.told(self._memory.everything())
        for entry in backup.differing(present):
            reasons[entry.name] = entry.obstacle or self._memory.refusal(entry.line)
        self._read_back()
        self._memory.leave(backup.settings.values)
        left = backup.differing(Backup.told(self._memory.everything()))
        unlike = [each.obstacle or Unwritten(reasons.get(each.name) or f"{each.name} {UNLIKE}") for each in left]
        lacking = ", ".join(backup.lacking(present))
        left_alone = (f"The backup doesn't have {lacking}: that is left as it was.",) if lacking else ()
        # Offsets and start-up lines it reads from its EEPROM whenever it lists them.
        taken = (name for name, reason in reasons.items() if reason is None and _NUMBERED.fullmatch(name))
        in_use = (IN_USE,) if any(taken) else ()
        return (*unlike, *left_alone, *in_use, NOT_WRITTEN)

    @property
    def has_started(self) -> bool:
        """Whether it was heard to start as the port was opened; see ProvenByStart."""
        return self._conversation.has_started

    def take_given(self) -> Mapping[str, str | None]:
        """Return what settings of axes were given since this was last asked; see ProvenByStart."""
        return self._memory.take_given()

    def take_left(self) -> Collection[str]:
        """Return what settings were wanted as they were since this was last asked; see ProvenByStart."""
        return self._memory.take_left()

    def others(self, given: Mapping[str, str]) -> Mapping[str, str | None]:
        """Return those of these settings that are others, with what they are; see ProvenByStart."""
        numbered = {int(name[1:]): value for name, value in given.items() if _NUMBERED.fullmatch(name)}
        differing = self._memory.differing(numbered)
        return {f"${number}": self._memory.settings.values.get(number) for number in differing}

    def refuse_start(self) -> None:
        """Refused unless it rests, and starts without moving anything; its start-up lines are read again for that."""
        self._memory.refuse_unready()
        self._read_again()
        if not self._memory.may_reset:
            raise Refused(MAY_MOVE)

    def _said_of_itself(self) -> list[str]:
        """Return the answer to $I; asked twice where the beginning of a line was still there from somebody before."""
        try:
            return self._conversation.ask("$I")
        except Answered:
            return self._conversation.ask("$I")

    def _read_back(self) -> None:
        """Read what is in use, and where the axes rest by that."""
        self._tell(Progress(PushStage.READING_BACK, 0, 0))
        self._read_again()
