"""A motor that plays its ramp: where it has come to by a clock of ticks, whatever it is told meanwhile."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stepramp.ramp.playback.trajectory import Playback, Trajectory

ENDLESS_STEPS = 2**48
"""More than a run makes in a lifetime."""

InstantsOf = Callable[[NDArray[np.int64]], NDArray[np.int64]]


class PulseListener(Protocol):
    """What is told of each pulse of a motor."""

    def set_out(self) -> None:
        """Notice that the motor sets out from rest."""

    def pulses(self, first: int, count: int, instants_of: InstantsOf) -> None:
        """Notice pulses, counted from 1 since the motor set out; instants_of returns when some of them came [ticks]."""

    def at_rest(self) -> None:
        """Notice that the motor has come to rest."""


class Motor:
    """A motor that is where the last call of `settle` found it. All instants are ticks of the step timer.

    setup_ticks: from a change of direction to the next pulse.
    """

    def __init__(
        self, playback: Playback, setup_ticks: int, position: int = 0, watch: PulseListener | None = None
    ) -> None:
        self._playback = playback
        self._setup_ticks = setup_ticks
        self.watch = watch
        self._trajectory: Trajectory = []
        self._began = 0
        """Instant of the first pulse of the present train."""
        self._done = 0
        """Pulses of the present train."""
        self._due = 0
        """Instant of the next pulse, or of the end of the last interval."""
        self._ramp_position = self._playback.rest
        self._direction = 1
        self._destination = position
        self._level: int | None = None
        self._run_direction = 0
        """Of a run at a speed; 0: it goes to its destination."""
        self._run_ends = False
        """At its destination, at the latest."""
        self.position = position
        self.moving = False
        self.stopping = False
        self.steps_made = 0
        """Since it last set out from rest."""

    @property
    def due_ticks(self) -> int:
        """When the present interval ends: then comes the next pulse, or rest."""
        return self._due

    @property
    def direction(self) -> int:
        """1 forwards, -1 backwards; of the last pulse, or of the next one."""
        return self._direction

    @property
    def interval(self) -> int:
        """The interval that passes [ticks]; 0 at rest."""
        return self._ramp_position.interval if self.moving else 0

    @property
    def target(self) -> int:
        """Where it will come to rest [steps]; its position at rest, and as long as it runs at a speed."""
        return self.position if self.running else self._destination

    @property
    def running(self) -> bool:
        """Whether it goes on at a speed, without a target that was asked for."""
        return self._run_direction != 0

    @property
    def _endless(self) -> bool:
        return self.running and not self._run_ends

    def shortest_interval(self, commanded: int | None) -> int:
        """Return the shortest interval that it may come to when this one is asked for; None: left to what it does."""
        shortest = commanded or self._level or self._playback.slew_interval
        return min(shortest, self.interval or shortest)

    def settle(self, now: int) -> None:
        """Move to where it is by now."""
        while self.moving and self._due <= now:
            if self._trajectory:
                self._play(now)
            elif not self._endless and self.position == self._destination:
                self._rest()
            else:
                # It has passed its target, or turns: it goes on the other way.
                self._plan_from_rest(self._due + self._setup_ticks)

    def move_to(self, target: int, ready: int) -> None:
        """Go to a position at the ramp's slew speed; at rest, set out at the instant `ready`."""
        self._destination = target
        self._go(0, None, ready)

    def run(self, interval: int, direction: int, ready: int, end: int | None = None) -> None:
        """Go on and on with an interval, not shorter than the ramp's slew interval [ticks]; positions go round.

        end: a position ahead where it comes to rest at the latest; None: nowhere.
        """
        if end is not None:
            self._destination = end
        self._run_ends = end is not None
        self._go(direction, interval, ready)

    def stop(self) -> None:
        """Slow down to rest."""
        if not self.moving or self.stopping:
            return
        self.stopping, self._run_direction = True, 0
        self._destination = self._stop_position()
        if self._ramp_position.interval:
            self._replan()
        else:
            self._rest()

    def halt(self) -> None:
        """Make no further step."""
        if self.moving:
            self._destination = self.position
            self._rest()

    def set_position(self, position: int) -> None:
        """Call the place where it rests a position."""
        self.position = self._destination = position

    def _go(self, run_direction: int, level: int | None, ready: int) -> None:
        self._run_direction, self._level, self.stopping = run_direction, level, False
        if self.moving:
            self._replan()
        elif self.running or self._destination != self.position:
            self._set_out(ready)

    def _stop_position(self) -> int:
        steps = self._playback.steps_to_rest(self._ramp_position) if self._ramp_position.interval else 0
        return _position(self.position + self._direction * steps)

    def _set_out(self, at: int) -> None:
        self.moving, self.steps_made = True, 0
        self._plan_from_rest(at)
        if self.watch:
            self.watch.set_out()

    def _plan_from_rest(self, at: int) -> None:
        self._ramp_position, self._due = self._playback.rest, at
        self._replan()

    def _replan(self) -> None:
        """Plan what comes after the present interval."""
        if not self._ramp_position.interval:
            self._direction = self._run_direction or (1 if self._destination > self.position else -1)
        distance = ENDLESS_STEPS * self._run_direction if self._endless else self._destination - self.position
        self._trajectory = self._playback.trajectory(
            self._ramp_position, max(0, distance * self._direction), self._level
        )
        self._began, self._done = self._due, 0

    def _play(self, now: int) -> None:
        train = self._trajectory[0]
        done, began = self._done, self._began
        self._done = train.pulses_within(now - began)
        self._ramp_position = train.position_after(self._done)
        self._due = began + train.ticks_to(self._done)
        made = self._done - done
        self.position = _position(self.position + self._direction * made)
        self.steps_made += made
        if self._done == train.count:
            self._trajectory.pop(0)
            self._began, self._done = self._due, 0
        if self.watch:
            first = self.steps_made - made + 1
            self.watch.pulses(first, made, lambda pulses: began + train.instants(pulses - first + done))

    def _rest(self) -> None:
        self.moving = self.stopping = False
        self._run_direction = 0
        self._trajectory, self._ramp_position, self._level = [], self._playback.rest, None
        if self.watch:
            self.watch.at_rest()


def _position(steps: int) -> int:
    """Return a number of steps as the position that it is: after the last one comes the first."""
    return (steps + 2**31) % 2**32 - 2**31
