"""Traces: when the steps of a move were made, by the controller's own timer, next to when they were planned.

The controller tells 16 bits of its timer. A value lies within half a wrap of the planned instant, so that this says
which wrap it belongs to.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.contract import Trace
from stepramp.controllers.stepramp.messages.trace import TraceNotice
from stepramp.ramp.playback.trajectory import PulseTrain, pulse_instants

MOST_STEPS = 500_000
"""So many steps of a trace are kept, the first ones: a run may last for days."""
WRAP = 1 << 16
"""The timer counts up to this and begins again [ticks]."""


@dataclass(frozen=True)
class TracedMove:
    """A move as it was asked for: with which pulse of a trajectory each of its steps comes, counted from 1."""

    trajectory: Sequence[PulseTrain]
    pulse_of_step: NDArray[np.int64] | None = None
    """Shape (steps,); None: each step is a pulse."""

    def instants(self, steps: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return when steps come, counted from 1, from the trajectory's first pulse on [ticks], shape of steps."""
        if self.pulse_of_step is None:
            return pulse_instants(self.trajectory, steps)
        return pulse_instants(self.trajectory, self.pulse_of_step[np.minimum(steps, self.pulse_of_step.size) - 1])


class TraceCollector:
    """Collects the trace of one move, and then of the next."""

    def __init__(self, axis: int, every_steps: int) -> None:
        self.axis = axis
        self.every_steps = every_steps
        self._move: Callable[[], TracedMove] | None = None
        self._timer_hz = self._number = 0
        self._has_ended = self._changed = self._is_full = False
        self._steps: list[int] = []
        self._values: list[int] = []

    @property
    def is_under_way(self) -> bool:
        """Whether the end of a move is still to be told."""
        return self._move is not None and not self._has_ended

    def begin(self, move: Callable[[], TracedMove], timer_hz: int, number: int) -> None:
        """Begin with a move that sets out from rest, and has this number.

        move: works the plan out, which takes a while: it is called only when the trace is looked at.
        """
        self._move, self._timer_hz, self._number = cache(move), timer_hz, number
        self._has_ended = self._changed = self._is_full = False
        self._steps, self._values = [], []

    def change(self) -> None:
        """Take no further steps of this move: they are no longer made as planned."""
        if self._move is not None and not self._has_ended:
            self._changed = True

    def take(self, notice: TraceNotice) -> None:
        """Take what the controller tells."""
        if notice.axis != self.axis or self._move is None or self._has_ended:
            return
        self._is_full = self._is_full or len(self._steps) + len(notice.values) > MOST_STEPS
        if not self._changed and not self._is_full:
            self._steps += [notice.first_step + notice.every_steps * index for index in range(len(notice.values))]
            self._values += notice.values
        self._has_ended = notice.is_last

    def trace(self) -> Callable[[], Trace] | None:
        """Return what works out the trace as far as it is known now, in any thread; None before a move was traced."""
        if self._move is None:
            return None
        complete = self._has_ended and not self._is_full
        known = (self.axis, self._number, self.every_steps, self._timer_hz, complete, self._changed)
        return partial(_trace, self._move, self._steps.copy(), self._values.copy(), *known)


def _trace(
    traced_move: Callable[[], TracedMove],
    steps: Sequence[int],
    values: Sequence[int],
    axis: int,
    number: int,
    every_steps: int,
    timer_hz: int,
    complete: bool,
    changed: bool,
) -> Trace:
    move, step = traced_move(), np.array(steps, np.int64)
    planned = move.instants(step)
    if move.pulse_of_step is not None:
        # A follower's first step may come after the leader's first: the trace begins with its own.
        planned = planned - move.instants(np.array([1]))[0]
    measured = extended(np.array(values, np.int64), planned)
    return Trace(axis, number, every_steps, timer_hz, complete, changed, step, planned, measured)


def extended(values: NDArray[np.int64], planned: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return 16-bit values of a timer as instants of 64 bits, each within half a wrap of the planned one [ticks].

    The first value is taken to be on time: all others are counted from it.
    """
    if not values.size:
        return np.empty(0, np.int64)
    late = (values - values[0] - (planned - planned[0]) + WRAP // 2) % WRAP - WRAP // 2
    instants: NDArray[np.int64] = planned + late
    return instants
