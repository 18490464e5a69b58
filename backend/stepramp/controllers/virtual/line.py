"""The virtual controller's straight lines: one motor leads, and the others pulse together with it."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.stepramp.messages.status import AxisState
from stepramp.controllers.virtual.motor_state import state_of
from stepramp.ramp.playback.motor import InstantsOf, Motor, PulseListener
from stepramp.ramp.playback.trajectory import Playback


def follower_steps(leader_steps: int, steps: int, made: int) -> int:
    """Return how many of its steps an axis has made once the leader has made so many of its own; see ramp.line."""
    return (2 * made * steps + leader_steps) // (2 * leader_steps)


class VirtualLine:
    """Axes on their way along a straight line. The motors' own positions follow it.

    motors: all that the line leads, by axis; steps: how far each goes, at least one of them somewhere.
    """

    def __init__(
        self,
        motors: Mapping[int, Motor],
        steps: Mapping[int, int],
        playback: Playback,
        watches: Mapping[int, PulseListener],
    ) -> None:
        self._motors, self._steps = motors, steps
        self._starts = {axis: motor.position for axis, motor in motors.items()}
        self._leader_steps = max(map(abs, steps.values()))
        watched = [_Followed(watches[axis], self._leader_steps, abs(steps[axis])) for axis in watches]
        self._leader = Motor(playback, 0, watch=_Together(watched))

    def begin(self, ready: int) -> None:
        """Set out at an instant."""
        self._leader.move_to(self._leader_steps, ready)

    def settle(self, now: int) -> bool:
        """Move to where the line is by now, and return whether it goes on."""
        self._leader.settle(now)
        for axis, motor in self._motors.items():
            motor.set_position(self._at(axis, self._leader.position))
            motor.steps_made = abs(motor.position - self._starts[axis])
        return self._leader.moving

    def stop(self) -> None:
        """Slow down to rest, along the line."""
        self._leader.stop()

    def halt(self) -> None:
        """Make no further step."""
        self._leader.halt()

    def state(self, axis: int) -> AxisState:
        """Return what an axis is doing."""
        return state_of(self._leader) if self._steps.get(axis) else AxisState.IDLE

    def target(self, axis: int) -> int:
        """Return where an axis that goes along will come to rest [steps]."""
        return self._at(axis, self._leader.target)

    @property
    def due_ticks(self) -> int:
        """When the leader's present interval ends."""
        return self._leader.due_ticks

    def direction(self, axis: int) -> int:
        """Return which way an axis goes, by its sign; 0 for one that doesn't."""
        return self._steps.get(axis, 0)

    def leads(self, axis: int) -> bool:
        """Tell whether an axis goes along."""
        return axis in self._steps

    def interval(self, axis: int) -> int:
        """Return an axis' share of the leader's present interval [ticks]; 0 at rest."""
        steps = abs(self._steps.get(axis, 0))
        return self._leader.interval * self._leader_steps // steps if steps else 0

    def _at(self, axis: int, made: int) -> int:
        """Return the position of an axis once the leader has made so many steps."""
        steps = self._steps[axis]
        follows = follower_steps(self._leader_steps, abs(steps), made)
        return self._starts[axis] + (follows if steps > 0 else -follows)


class _Together:
    """Tells several watches of the leader's pulses."""

    def __init__(self, watches: list["_Followed"]) -> None:
        self._watches = watches

    def set_out(self) -> None:
        for watch in self._watches:
            watch.set_out()

    def pulses(self, first: int, count: int, instants_of: InstantsOf) -> None:
        for watch in self._watches:
            watch.pulses(first, count, instants_of)

    def at_rest(self) -> None:
        for watch in self._watches:
            watch.at_rest()


class _Followed:
    """Tells a watch of the pulses of one axis, from those of the leader."""

    def __init__(self, watch: PulseListener, leader_steps: int, steps: int) -> None:
        self._watch, self._leader_steps, self._steps = watch, leader_steps, steps

    def set_out(self) -> None:
        self._watch.set_out()

    def pulses(self, first: int, count: int, instants_of: InstantsOf) -> None:
        made = follower_steps(self._leader_steps, self._steps, first - 1)
        more = follower_steps(self._leader_steps, self._steps, first + count - 1) - made

        def instants(steps: NDArray[np.int64]) -> NDArray[np.int64]:
            # Step m comes with the leader's step ceil(n_l (2 m - 1) / (2 n)).
            return instants_of(-(-(self._leader_steps * (2 * steps - 1)) // (2 * self._steps)))

        if more:
            self._watch.pulses(made + 1, more, instants)

    def at_rest(self) -> None:
        self._watch.at_rest()
