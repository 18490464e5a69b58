"""What is around the virtual controller: an emergency stop, a driver's fault, and a switch at each end of its axes.

They are wired to whichever inputs the settings name for them.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from stepramp.controllers.stepramp.input_roles import INPUTS, InputRole
from stepramp.controllers.stepramp.messages.axes import MOST_AXES
from stepramp.controllers.stepramp.messages.status import StopBit
from stepramp.controllers.surroundings import SurroundingsChange, Switches

CAUSES = {"emergency_stop": StopBit.EMERGENCY_STOP, "driver_fault": StopBit.DRIVER_FAULT}


@dataclass
class VirtualWorld:
    """Places of axes are counted from where they were at first, whatever the controller calls its positions."""

    emergency_stop: bool = False
    """Whether it is pressed."""
    driver_fault: bool = False
    switches: list[Switches] = field(default_factory=lambda: [Switches()] * MOST_AXES)
    places: list[int] = field(default_factory=lambda: [0] * MOST_AXES)
    """Where the axes are [steps], as long as nothing moves them."""

    def change(self, change: SurroundingsChange) -> None:
        """Press, release and put elsewhere what is to be."""
        if change.emergency_stop is not None:
            self.emergency_stop = change.emergency_stop
        if change.driver_fault is not None:
            self.driver_fault = change.driver_fault
        for axis, switches in change.switches.items():
            self.switches[axis] = switches


class VirtualInputs:
    """The controller's inputs in this world. place: where an axis is [steps]."""

    def __init__(self, world: VirtualWorld, place: Callable[[int], int]) -> None:
        self._world = world
        self._place = place
        self._roles: tuple[InputRole, ...] = ()
        self.stopped_by = StopBit(0)
        """What has stopped motion and was not acknowledged."""

    def use(self, roles: Iterable[InputRole]) -> None:
        """Take inputs for these from now on."""
        self._roles = tuple(roles)

    @property
    def active(self) -> int:
        """The inputs that are active, a bit each."""
        return sum(1 << INPUTS.index(role.input) for role in self._roles if self._is_active(role))

    @property
    def active_stops(self) -> StopBit:
        """Which emergency stops and driver's faults are active."""
        bits = StopBit(0)
        for role in self._roles:
            if role.role in CAUSES and self._is_active(role):
                bits |= CAUSES[role.role]
        return bits

    def limits(self, axis: int) -> list[InputRole]:
        """Return the limit switches of an axis."""
        return [role for role in self._roles if role.axis == axis]

    def limit(self, axis: int, direction: int) -> InputRole | None:
        """Return the limit switch that an axis comes to in a direction, an active one first; None: it has none."""
        end = "high" if direction > 0 else "low"
        there = [role for role in self.limits(axis) if role.end == end]
        return next((role for role in there if self._is_active(role)), there[0] if there else None)

    def in_the_way(self, axis: int, direction: int) -> InputRole | None:
        """Return the active limit switch that an axis would go into in a direction."""
        role = self.limit(axis, direction)
        return role if role is not None and self._is_active(role) else None

    def beyond(self, axis: int, direction: int) -> int:
        """Return how far an axis is beyond the last place where its switch in a direction isn't active [steps]."""
        at = self._world.switches[axis].at("high" if direction > 0 else "low")
        return 0 if at is None else self._place(axis) - (at - direction)

    def steps_to_change(self, axis: int) -> int | None:
        """Return how many steps an axis makes at least before a limit switch of it changes; None: it has none."""
        switches, place = self._world.switches[axis], self._place(axis)
        ways = []
        for role in self.limits(axis):
            if (at := switches.at(role.end)) is not None:
                ways.append(abs(place - at) + (1 if self._is_active(role) else 0))
        return min(ways, default=None)

    def _is_active(self, role: InputRole) -> bool:
        if role.axis is None:
            return self._world.emergency_stop if role.role == "emergency_stop" else self._world.driver_fault
        return self._world.switches[role.axis].is_active(role.end, self._place(role.axis))
