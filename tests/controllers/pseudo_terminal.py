"""A pseudo-terminal in place of a board on a cable that can be unplugged."""

from __future__ import annotations

import itertools
import os
import select
import tempfile
import threading
import tty
from pathlib import Path
from typing import Self

PATIENCE_S = 10.0
_numbers = itertools.count()
_used: set[str] = set()
_links = tempfile.TemporaryDirectory(prefix="stepramp-ports-")


def far_end_of_a_new_one() -> tuple[int, str]:
    """Return the far end of a pseudo-terminal, and the near one's name, which none had before in this process.

    Systems give the lowest number that is free: what a server keeps of a port would be of the next board at it.
    """
    in_between = []
    try:
        while True:
            far_end, near_end = os.openpty()
            tty.setraw(near_end)
            name = os.ttyname(near_end)
            os.close(near_end)
            if name not in _used:
                _used.add(name)
                return far_end, name
            in_between.append(far_end)
    finally:
        for each in in_between:
            os.close(each)


class PseudoTerminal:
    """Plugged in while the context lasts. What is at its far end says what it answers; port: the name of the near one.

    That is asked time and again, whether somebody has sent something or not: what moves there goes on. The name is one
    of its own, and is gone once it is unplugged: no server, also of other tests that run at the same time, looks for
    what it has lost at a pseudo-terminal that has the same number then.
    """

    def __init__(self) -> None:
        self._unplugged = threading.Event()
        self._closed = threading.Event()
        self._closed.set()
        self._far_end, near_end = far_end_of_a_new_one()
        self._link = Path(_links.name) / f"tty{next(_numbers)}"
        self._link.symlink_to(near_end)
        self.port = str(self._link)
        self._thread = threading.Thread(target=self._serve)

    def exchange(self, data: bytes) -> bytes:
        """Take what was sent, and return what comes back."""
        raise NotImplementedError

    def opened(self) -> None:
        """Notice that somebody has opened the near end."""

    def wait_until_closed(self) -> None:
        """Wait until it is noticed that the near end is closed: if it is opened earlier, nobody knows that it was."""
        assert self._closed.wait(PATIENCE_S)

    def unplug(self) -> None:
        self._unplugged.set()
        self._thread.join()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def _serve(self) -> None:
        while not self._unplugged.is_set():
            data = b""
            if select.select([self._far_end], [], [], 0.005)[0]:
                try:
                    data = os.read(self._far_end, 4096)
                except OSError:
                    # Nobody has the port open: what Linux says of a pseudo-terminal until somebody does. Nobody hears.
                    self._closed.set()
                    self.exchange(b"")
                    self._unplugged.wait(0.01)
                    continue
            if self._closed.is_set():
                self._closed.clear()
                self.opened()
            if said := self.exchange(data):
                os.write(self._far_end, said)
        self._link.unlink(missing_ok=True)
        os.close(self._far_end)
