"""Stops that were asked for and that no controller has granted yet: the next connection there begins with them.

While nobody is connected a motor may move: a board with a supply of its own goes on without us.
"""

import threading
from dataclasses import dataclass, replace

from stepramp.devices.stops import Order
from stepramp.link.ports import Port, location_of


@dataclass(frozen=True)
class _To:
    """What a stop is owed to: whatever is at a port, by its name and where that leads, and a board that is known."""

    places: frozenset[str]
    unit: tuple[int, int, str] | None
    is_halt: bool

    @classmethod
    def of(cls, at: Port, *, is_halt: bool) -> "_To":
        return cls(frozenset({at.port, at.location}), at.unit, is_halt)

    def is_at(self, at: Port) -> bool:
        return bool(self.places & {at.port, at.location}) or (self.unit is not None and self.unit == at.unit)

    def left(self, at: Port) -> "_To | None":
        """Return what it is owed to once it was granted there; None for nothing."""
        if self.unit is not None and self.unit == at.unit:
            return None
        here = {at.port, at.location}
        places = frozenset(each for each in self.places - here if location_of(each) not in here)
        return replace(self, places=places) if places or self.unit else None


class OwedStops:
    """By port and by what is plugged in there, since a device may be forgotten whose motor moves on. For any thread.

    Whatever is next connected at the port, by any of its names, is stopped, and so is a board that is known by its
    serial number, wherever it comes back.
    """

    def __init__(self, order: Order) -> None:
        self._order = order
        self._lock = threading.Lock()
        # By each stop's number.
        self._owed: dict[int, _To] = {}

    def owe(self, at: Port, *, is_halt: bool = False) -> int:
        """Note that a stop was asked for, and return its number. is_halt: it is to be at once, without a ramp."""
        number = self._order.next()
        with self._lock:
            self._owed[number] = _To.of(at, is_halt=is_halt)
        return number

    def newest(self, at: Port) -> int | None:
        """Return the number of the last stop that is owed there; None when none is."""
        with self._lock:
            return max((number for number, to in self._owed.items() if to.is_at(at)), default=None)

    def is_halt(self, at: Port) -> bool:
        """Tell whether a halt is among what is owed there: whoever asked for it wants no slowing down."""
        with self._lock:
            return any(to.is_halt for to in self._owed.values() if to.is_at(at))

    def settle(self, at: Port, number: int, *, of_all_axes: bool) -> None:
        """Note that a stop was granted there; one of all axes does what was owed before it, too.

        What is owed to a board that is known goes on being owed to it when another one at its port was stopped.
        """
        with self._lock:
            for each in [each for each in self._owed if each == number or (each < number and of_all_axes)]:
                left = self._owed[each].left(at)
                if left is None:
                    del self._owed[each]
                else:
                    self._owed[each] = left
