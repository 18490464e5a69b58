"""A FluidNC at a serial port: axes that move along one line, with ramps that it works out from two items each.

It is spoken to as grbl is. What is pushed holds until a restart; nothing is ever written to its files.
"""

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from time import sleep

from stepramp.controllers.capabilities import BacksUp, TriesRamps
from stepramp.controllers.contract import ControllerStatus, PushMode, PushPreview, PushReport
from stepramp.controllers.fluidnc.configuration import ITEMS, LETTERS, Configuration
from stepramp.controllers.fluidnc.memory import Memory
from stepramp.controllers.fluidnc.push import PushPlan, acceleration_of, rate_of
from stepramp.controllers.fluidnc.ramp import TIMER
from stepramp.controllers.grbl.conversation import Answered, Conversation
from stepramp.controllers.grbl.dialect import State
from stepramp.controllers.grbl.machine import GrblMachine
from stepramp.controllers.grbl.numbers import is_same
from stepramp.controllers.grbl.settings import Known
from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.remark import UNLIKE, Unwritten
from stepramp.design import Design
from stepramp.errors import Count, Refused, Rejected, Rejection
from stepramp.link.connection import Connection

_VERSION = re.compile(r"\[VER:\d+\.\d+ FluidNC (?P<version>[^\s:\]]+)[^\]]*\]?")
ALLOWED = "a backup of a FluidNC, or its configuration"
NOT_WRITTEN = (
    "Only steps per mm, highest rates and accelerations were set, until a restart: its file is not written to."
)


class FluidNcController(GrblMachine, TriesRamps, BacksUp):
    """A client of FluidNC 3 and later; see Controller for what its calls do."""

    def __init__(
        self, port: Connection, give_way: Callable[[float], None] = sleep, tell: Tell = lambda _: None
    ) -> None:
        """Talk over an open port.

        give_way: called in the midst of a long exchange with how long there is time for other calls [s].
        tell: called with how far a push has come.
        """
        conversation = Conversation(port, give_way, "FluidNC")
        self._memory = Memory(conversation)
        super().__init__(conversation, self._memory, give_way, "FluidNC")
        self._moves.slowest_steps_per_s = TIMER.slowest_steps_per_s
        self._tell = tell
        self._version: str | None = None

    @property
    def firmware_version(self) -> str | None:
        """Such as v3.7.2."""
        return self._version

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Wait until a FluidNC is there, and learn what it has. It is told nothing but questions.

        Raises Refused when something else is there, or what is there moves.
        """
        self._conversation.begin()
        banner = self._conversation.banner
        if banner is not None and not banner.is_of_fluidnc:
            raise self._other(f"grbl {banner.version}")
        greeted()
        report = self._conversation.look()
        if report.state not in (State.IDLE, State.ALARM):
            raise Refused(
                f"The controller at {self._conversation.name} tells what it keeps only at rest, and its state is "
                f"{report.state.value!r}: connect it again then."
            )
        said = self._said_of_itself()
        found = next((each["version"] for each in map(_VERSION.match, said) if each is not None), None)
        if found is None:
            raise self._other(" ".join(said) or "a firmware that doesn't tell which it is")
        self._version = found
        self._memory.learn()
        self._know_places()
        self._conversation.end_connecting()

    def prepare_push(
        self,
        designs: Sequence[Design],
        first_axis: int | None = None,
        mode: PushMode = "try",  # noqa: ARG002  # it is asked for nothing else
    ) -> Callable[[], PushReport]:
        """Work out the items of the axes, and return the call that sets them; see Controller."""
        self._refuse_senseless()
        plan = PushPlan.of(designs, first_axis, self._places.axes)

        def push() -> PushReport:
            self._memory.refuse_unready()
            self._read_again()
            plan.refuse_other_scales(self._memory.settings)
            self._tell(Progress(PushStage.SENDING, 0, plan.bytes))
            with self._known_again_on_refusal():
                self._memory.use(plan.wanted)
            self._read_back()
            return plan.report(self._memory.settings)

        return push

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Work out what a push would change; see Controller."""
        self._refuse_senseless()
        return PushPlan.of(designs, first_axis, self._places.axes).preview(self._memory.settings)

    def roll_back(self) -> None:
        """Set what its file has; Refused when nothing else is in use."""
        self._memory.refuse_unready()
        wanted = self._differing(self._memory.stored)
        if not wanted:
            raise Refused("Nothing is on trial: in use is what the controller's file has.")
        with self._known_again_on_refusal():
            self._memory.use(wanted)
        self._read_back()
        if self._differing(self._memory.stored):
            raise Refused("In use is not what the controller's file has: restart it.")

    def backup(self) -> str:
        """Ask for the configuration in use, the file it is from, offsets and version, as lines."""
        self._memory.refuse_unready()
        return self._memory.everything()

    def use_backup(self, text: str) -> tuple[str, ...]:
        """Set what differs of a backup, one item at a time, and read it back; see BacksUp."""
        backup = Configuration.of(text.splitlines())
        if backup.axis(0) is None:
            raise Rejected([Rejection("text", Count(f"{len(text.splitlines())} lines"), ALLOWED)])
        paths = [f"axes/{letter}/{item}" for letter in LETTERS[: len(self._places.axes)] for item in ITEMS]
        twice = [(path, f"{backup.twice[path]} and {backup.items[path]}") for path in paths if path in backup.twice]
        if twice:
            raise Rejected([Rejection(path, Count(values), "each item once in a backup") for path, values in twice])
        lacking = [path for path in paths if path not in backup.items]
        self._memory.refuse_unready()
        # What FluidNC takes for an item that isn't there is not what it had.
        wanted = self._differing(backup, scales=True, but=lacking)
        refused = {path: self._refusal(path, wanted[path]) for path in self._memory.in_order(wanted)}
        self._read_back()
        left = self._differing(backup, scales=True, but=lacking)
        unlike = [Unwritten(refused.get(path) or f"{path} {UNLIKE}") for path in left]
        left_alone = (f"The backup doesn't have {', '.join(lacking)}: that is left as it was.",) if lacking else ()
        return (*unlike, *left_alone, NOT_WRITTEN)

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing, and have axes that run go on."""
        return replace(super().status(), on_trial=bool(self._differing(self._memory.stored)))

    def _refusal(self, path: str, value: str) -> str | None:
        """Set an item of a backup; return why it is refused, as a sentence, or None."""
        try:
            self._memory.use({path: value})
        except Answered as error:
            return str(error)
        return None

    def _read_back(self) -> None:
        self._tell(Progress(PushStage.READING_BACK, 0, 0))
        self._memory.learn_in_use()
        self._know_places()

    def _differing(self, wanted: Known, *, scales: bool = False, but: Collection[str] = ()) -> dict[str, str]:
        """Return the items of axes that are others than wanted, as they should be.

        scales: steps per mm, too. but: paths that are left out.
        """
        found: dict[str, str] = {}
        for axis, there in enumerate(self._places.axes):
            should = wanted.axis(axis)
            if should is None:
                continue
            pairs = {
                acceleration_of(axis): (there.acceleration, should.acceleration),
                rate_of(axis): (there.most_rate, should.most_rate),
            }
            if scales:
                scale = f"{rate_of(axis).rpartition('/')[0]}/steps_per_mm"
                pairs = {scale: (there.steps_per_mm, should.steps_per_mm)} | pairs
            found |= {
                path: str(meant) for path, (has, meant) in pairs.items() if path not in but and not is_same(has, meant)
            }
        return found

    def _said_of_itself(self) -> list[str]:
        """Return the answer to $I; asked twice where the beginning of a line was still there from somebody before."""
        try:
            return self._conversation.ask("$I")
        except Answered:
            return self._conversation.ask("$I")

    def _other(self, what: str) -> Refused:
        return Refused(f"What is at {self._conversation.name} is no FluidNC but {what}, which is another family.")
