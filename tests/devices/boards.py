"""Boards that say nothing, lose answers, or come unplugged, and what was asked of them."""

from __future__ import annotations

from collections import Counter

from controllers.conftest import Clock
from stepramp.controllers.stepramp.frames import FrameSplitter
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.virtual.controller import VirtualController

WAITED_FOR_S = 0.2
"""How long an answer is waited for before its request is repeated, by decision of the protocol's client."""


class Silent:
    """Answers nothing."""

    def opened(self) -> None:
        pass

    def exchange(self, _: bytes) -> bytes:
        return b""


class Witness:
    """The virtual controller, what was asked of it, and when stops were answered. It loses answers when told to.

    lasts_s: by how much the motors' clock goes on with each exchange. unanswered: how many requests of a kind get no
    answer, each of them waited for by that clock, too.
    """

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.controller = VirtualController(clock)
        self.seen: list[int | str] = []
        self.loses: int | None = None
        self.lasts_s = 0.0
        self.unanswered: Counter[int] = Counter()
        self._splitter = FrameSplitter()

    def opened(self) -> None:
        self.controller.opened()

    def exchange(self, sent: bytes) -> bytes:
        self.clock.now_s += self.lasts_s
        said = self.controller.exchange(sent)
        for frame in self._splitter.feed(sent):
            message = Message.unpack(frame)
            if message is not None:
                self.seen.append(message.kind)
                if self.unanswered[message.kind] > 0:
                    self.unanswered[message.kind] -= 1
                    self.clock.now_s += WAITED_FOR_S
                    return b""
                if self.loses is not None:
                    self.loses -= 1
                    if self.loses < 0:
                        self.loses = None
                        return b""
        return said


class OwnSupply(Witness):
    """A board that opening its port doesn't reset, and whose cable can come out while its motor moves on."""

    is_plugged_in = True

    def opened(self) -> None:
        pass

    def exchange(self, sent: bytes) -> bytes:
        if not self.is_plugged_in:
            raise OSError(5, "Input/output error")
        return super().exchange(sent)


class HeldUp(OwnSupply):
    """What is sent to it waits on the way while that is held up, and gets there afterwards."""

    is_held_up = False
    _waiting = b""

    def exchange(self, sent: bytes) -> bytes:
        sent, self._waiting = self._waiting + sent, b""
        if self.is_held_up:
            self._waiting = sent
            return b""
        return super().exchange(sent)


class UnpluggedAt(OwnSupply):
    """Its cable comes out just when it is told something of a kind."""

    kind: int | None = None

    def exchange(self, sent: bytes) -> bytes:
        for frame in FrameSplitter().feed(sent):
            message = Message.unpack(frame)
            if message is not None and message.kind == self.kind:
                self.is_plugged_in, self.kind = False, None
        return super().exchange(sent)
