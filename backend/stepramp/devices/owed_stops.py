"""Stops that were asked for and that no controller has granted yet: the next connection at their port begins with them.

While nobody is connected a motor may move: a board with a supply of its own goes on without us.
"""

import threading

from stepramp.devices.stops import Order


class OwedStops:
    """By port, since a device may be forgotten whose motor moves on. For any thread."""

    def __init__(self, order: Order) -> None:
        self._order = order
        self._lock = threading.Lock()
        self._at_ports: dict[str, set[int]] = {}

    def owe(self, port: str) -> int:
        """Note that a stop was asked for, and return its number."""
        number = self._order.next()
        with self._lock:
            self._at_ports.setdefault(port, set()).add(number)
        return number

    def newest(self, port: str) -> int | None:
        """Return the number of the last stop that is owed at a port; None when none is."""
        with self._lock:
            return max(self._at_ports.get(port, ()), default=None)

    def settle(self, port: str, number: int, *, of_all_axes: bool) -> None:
        """Note that a stop was granted; one of all axes does what was owed before it, too."""
        with self._lock:
            owed = self._at_ports.get(port, set())
            left = {each for each in owed if each > number or (each < number and not of_all_axes)}
            self._at_ports[port] = left
            if not left:
                del self._at_ports[port]
