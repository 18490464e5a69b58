"""STOP is final: what was asked of a device before a stop was answered moves nothing afterwards.

All that is asked and all that is stopped is numbered in one order. A motion carries the number of the moment at which
it was asked, and is refused at the last instant before its bytes go out when a stop came after that, or is not answered
yet.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import time_ns

from stepramp.errors import Refused

NS_PER_NUMBER = 1000
"""No server gives so many numbers that the next to start would begin among them; a JavaScript number holds them."""


OVERTAKEN = "A stop came first: what was asked before it is not carried out."


class Overtaken(Refused):
    """A stop came after what was asked, or is still to be answered."""


class Order:
    """Numbers that grow, for all devices together: a greater one came later. For any thread.

    They begin with the time: what a server that was started earlier told is from before them all.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last = time_ns() // NS_PER_NUMBER
        self._last_stop = self._last

    def next(self) -> int:
        """Return the number of the present moment."""
        with self._lock:
            self._last += 1
            return self._last

    def stop(self) -> int:
        """Return the number of the present moment, at which something is stopped."""
        with self._lock:
            self._last += 1
            self._last_stop = self._last
            return self._last

    @property
    def last_stop(self) -> int:
        """The number of the last stop: no device has told a greater one."""
        with self._lock:
            return self._last_stop


class Stops:
    """The stops of one device, or of all, for any thread.

    of_all: stops that hold for this device, too.
    """

    def __init__(self, order: Order, of_all: "Stops | None" = None) -> None:
        self._order = order
        self._of_all = of_all
        self._lock = threading.Lock()
        # A stop of all that came before there was this device holds for it, too.
        self._last = order.stop()
        self._unanswered = 0

    @property
    def last(self) -> int:
        """Number of the last stop: it grows with each."""
        with self._lock:
            own = self._last
        return own if self._of_all is None else max(own, self._of_all.last)

    def note(self) -> None:
        """Note a stop: what was asked before now moves nothing."""
        with self._lock:
            self._last = self._order.stop()

    @contextmanager
    def unanswered(self) -> Iterator[None]:
        """Let nothing move while a stop is being answered, nor afterwards what was asked until then."""
        with self._lock:
            self._unanswered += 1
            self._last = self._order.stop()
        try:
            yield
        finally:
            with self._lock:
                self._unanswered -= 1
                self._last = self._order.stop()

    def end(self) -> None:
        """Let nothing move any more, whenever it is asked for."""
        with self._lock:
            self._unanswered += 1
            self._last = self._order.stop()

    def have_overtaken(self, request_number: int) -> bool:
        """Tell whether a stop came after what was asked then, or is still to be answered."""
        with self._lock:
            overtaken = self._unanswered > 0 or request_number < self._last
        return overtaken or (self._of_all is not None and self._of_all.have_overtaken(request_number))

    def refuse_overtaken(self, request_number: int) -> None:
        """Raise Overtaken when a stop came after what was asked then, or is still to be answered."""
        if self.have_overtaken(request_number):
            raise Overtaken(OVERTAKEN)
