"""A board on a cable that can be unplugged: the virtual controller behind a pseudo-terminal."""

from __future__ import annotations

from pathlib import Path

from controllers.pseudo_terminal import PseudoTerminal
from stepramp.controllers.stepramp.frames import FrameSplitter
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.virtual.controller import VirtualController


class UsbBoard(PseudoTerminal):
    """Plugged in while the context lasts.

    unplug_at: the cable comes out when a request of this kind has arrived; after: so many of them.
    """

    def __init__(self, controller: VirtualController | None = None) -> None:
        super().__init__()
        self.controller = controller or VirtualController()
        self.requests: list[int] = []
        self.unheard: list[int] = []
        self._is_mute = False
        self._unplug_at: tuple[int, int] | None = None
        self._splitter = FrameSplitter()

    def unplug_at(self, kind: int, after: int = 1) -> None:
        self._unplug_at = (kind, after + self.requests.count(kind))

    def mute(self) -> None:
        """Hear and answer nothing from now on, as a controller that hangs."""
        self._is_mute = True

    def speak(self) -> None:
        """Hear and answer again."""
        self._is_mute = False

    def exchange(self, data: bytes) -> bytes:
        is_mute = self._is_mute
        self._note(data, self.unheard if is_mute else self.requests)
        return b"" if self._unplugged.is_set() else self.controller.exchange(b"" if is_mute else data)

    def _note(self, data: bytes, requests: list[int]) -> None:
        for frame in self._splitter.feed(data):
            message = Message.unpack(frame)
            if message is not None:
                requests.append(message.kind)
        if self._unplug_at is not None:
            kind, count = self._unplug_at
            if self.requests.count(kind) >= count:
                self._unplugged.set()


class Cable:
    """A port whose name stays while boards come and go: the same controller, reset when it is plugged in, or not."""

    def __init__(self, port: Path) -> None:
        self.port = port
        self.controller = VirtualController()
        self.board: UsbBoard | None = None

    def plug_in(self, *, is_reset: bool = True) -> UsbBoard:
        """Plug the board in; one with a supply of its own may not be reset by that."""
        if is_reset:
            self.controller.opened()
        self.board = UsbBoard(self.controller)
        self.board.__enter__()
        self.port.symlink_to(self.board.port)
        return self.board

    def unplug(self) -> None:
        self.port.unlink(missing_ok=True)
        if self.board is not None:
            self.board.unplug()
