"""Something at a serial port that is no controller, and says what it likes as often as it likes."""

from __future__ import annotations

import os
import select
import threading
import time
import tty
from collections.abc import Callable
from contextlib import suppress
from typing import Self


class OddDevice:
    """Plugged in while the context lasts. port: where.

    answer: returns what it says to what it has heard. says: what it says besides, whether anybody listens or not, each
    every_s seconds. It hears nothing without an answer: what is sent to it piles up.
    """

    def __init__(self, answer: Callable[[bytes], bytes] | None = None, says: bytes = b"", every_s: float = 1.0) -> None:
        self._answer, self._says, self._every_s = answer, says, every_s
        self._far_end, self._near_end = os.openpty()
        tty.setraw(self._near_end)
        os.set_blocking(self._far_end, False)
        self.port = os.ttyname(self._near_end)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._talk)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        os.close(self._near_end)
        os.close(self._far_end)

    def _talk(self) -> None:
        next_s = time.monotonic()
        while not self._ended.is_set():
            hears = [self._far_end] if self._answer else []
            if select.select(hears, [], [], min(0.005, self._every_s))[0] and self._answer:
                self._say(self._answer(os.read(self._far_end, 4096)))
            if self._says and time.monotonic() >= next_s:
                next_s += self._every_s
                self._say(self._says)

    def _say(self, data: bytes) -> None:
        # What nobody reads is lost, as on a wire.
        with suppress(BlockingIOError):
            os.write(self._far_end, data)
