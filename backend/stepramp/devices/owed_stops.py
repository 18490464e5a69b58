"""Stops that were asked for and that no controller has granted yet: the next connection there begins with them.

While nobody is connected a motor may move: a board with a supply of its own goes on without us.
"""

import threading

from stepramp.devices.stops import Order
from stepramp.link.ports import Port


class OwedStops:
    """By port and by what is plugged in there, since a device may be forgotten whose motor moves on. For any thread.

    Whatever is next connected at the port is stopped, and so is a board that is known by its serial number, wherever it
    comes back.
    """

    def __init__(self, order: Order) -> None:
        self._order = order
        self._lock = threading.Lock()
        # Each stop's number, and what it is owed to: the name of a port, the identity of what was plugged in.
        self._owed: dict[int, set[object]] = {}

    def owe(self, at: Port) -> int:
        """Note that a stop was asked for, and return its number."""
        number = self._order.next()
        with self._lock:
            self._owed[number] = {at.port, at.identity}
        return number

    def newest(self, at: Port) -> int | None:
        """Return the number of the last stop that is owed there; None when none is."""
        with self._lock:
            return max((number for number, to in self._owed.items() if to & {at.port, at.identity}), default=None)

    def settle(self, at: Port, number: int, *, of_all_axes: bool) -> None:
        """Note that a stop was granted there; one of all axes does what was owed before it, too.

        What is owed to a board that is known goes on being owed to it when another one at its port was stopped.
        """
        is_known = at.identity != at.port
        with self._lock:
            for each in [each for each in self._owed if each == number or (each < number and of_all_axes)]:
                to = self._owed[each]
                left = set() if is_known and at.identity in to else to - {at.port}
                if left:
                    self._owed[each] = left
                else:
                    del self._owed[each]
