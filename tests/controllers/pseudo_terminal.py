"""A pseudo-terminal in place of a board on a cable that can be unplugged."""

from __future__ import annotations

import os
import select
import threading
import tty
from typing import Self


class PseudoTerminal:
    """Plugged in while the context lasts. What is at its far end says what it answers; port: the name of the near one.

    That is asked time and again, whether somebody has sent something or not: what moves there goes on.
    """

    def __init__(self) -> None:
        self._unplugged = threading.Event()
        self._far_end, near_end = os.openpty()
        tty.setraw(near_end)
        self.port = os.ttyname(near_end)
        os.close(near_end)
        self._thread = threading.Thread(target=self._serve)

    def exchange(self, data: bytes) -> bytes:
        """Take what was sent, and return what comes back."""
        raise NotImplementedError

    def opened(self) -> None:
        """Notice that somebody has opened the near end."""

    def unplug(self) -> None:
        self._unplugged.set()
        self._thread.join()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def _serve(self) -> None:
        is_open = False
        while not self._unplugged.is_set():
            data = b""
            if select.select([self._far_end], [], [], 0.005)[0]:
                try:
                    data = os.read(self._far_end, 4096)
                except OSError:
                    # Nobody has the port open: what Linux says of a pseudo-terminal until somebody does. Nobody hears.
                    is_open = False
                    self.exchange(b"")
                    self._unplugged.wait(0.01)
                    continue
            if not is_open:
                is_open = True
                self.opened()
            if said := self.exchange(data):
                os.write(self._far_end, said)
        os.close(self._far_end)
