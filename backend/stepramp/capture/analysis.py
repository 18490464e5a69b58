"""Analysis: a recording, and what somebody has chosen of it, as one measured move next to the planned one."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.capture.channels import Choice, chosen
from stepramp.capture.deviation import Alignment, Deviation, deviation_of
from stepramp.capture.recording import LATEST_TICKS, Recording
from stepramp.capture.steps import Edge, Moves, Steps, moves_of, steps_of
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.profile import Profile
from stepramp.units import MICROSECONDS_PER_SECOND

PAUSE_S = 0.2
"""Without a design a longer wait is between two moves [s]."""
LEAST_PAUSE_S = 0.02
"""With a design a pause is longer than this, and than its longest interval several times [s]."""
LONGEST_INTERVALS = 3


@dataclass(frozen=True)
class Wanted:
    """What somebody wants to know of a recording. None stands for what is likeliest."""

    step_channel: str | None = None
    direction_channel: str | None = None
    """Empty: none."""
    edge: Edge | None = None
    move_number: int | None = None
    """Counted from 1."""
    alignment: Alignment = "first_step"
    shortest_pulse_us: float | None = None
    longest_wait_us: float | None = None
    """A longer wait is between two moves [µs]."""


@dataclass(frozen=True)
class MeasuredMove:
    """One of the moves. Arrays of shape (steps,)."""

    number: int
    """Counted from 1."""
    begin_s: float
    """Instant of its first step in the recording [s]."""
    time_s: NDArray[np.float64]
    """Instants of its steps, from its first one on [s]."""
    direction_level: int
    """Level of the direction channel, or UNKNOWN."""
    short_pulses: NDArray[np.int64]
    """Steps whose pulses are too short, counted from 0, shape (short pulses,)."""
    short_pulse_us: NDArray[np.float64]
    """How long those are [µs], shape (short pulses,)."""


@dataclass(frozen=True)
class Analysis:
    """What a recording shows."""

    recording: Recording
    choice: Choice
    pause_s: float
    """Longer waits are between moves [s]."""
    steps: Steps
    moves: Moves
    move: MeasuredMove | None
    """The one that was chosen; None when there are no steps."""
    deviation: Deviation | None
    """From the planned move; None without a design or without steps."""


def analysed(recording: Recording, wanted: Wanted, profile: Profile | None) -> Analysis:
    """Return what a recording shows; profile: of the design that its move is held against.

    Raises Rejected for channels and moves that aren't there, and one channel for both.
    """
    choice = chosen(recording, wanted.step_channel, wanted.direction_channel, wanted.edge)
    steps = steps_of(recording, choice.step, choice.direction, choice.edge)
    pause_s = _pause_s(wanted.longest_wait_us, profile)
    moves = moves_of(steps, min(LATEST_TICKS, math.floor(pause_s / recording.tick_s)))
    if not moves.first.size:
        if wanted.move_number is not None:
            raise Rejected(
                [Rejection("move_number", wanted.move_number, "none, since the step channel has no such edge")]
            )
        return Analysis(recording, choice, pause_s, steps, moves, None, None)
    number = _number(wanted.move_number, moves, profile)
    move = _measured(recording, steps, moves, number, wanted.shortest_pulse_us)
    deviation = None if profile is None else deviation_of(move.time_s, profile.time_s, wanted.alignment)
    return Analysis(recording, choice, pause_s, steps, moves, move, deviation)


def _pause_s(longest_wait_us: float | None, profile: Profile | None) -> float:
    if longest_wait_us is not None:
        return longest_wait_us / MICROSECONDS_PER_SECOND
    if profile is None:
        return PAUSE_S
    return max(LEAST_PAUSE_S, LONGEST_INTERVALS * int(profile.intervals_ticks.max()) / profile.timer_hz)


def _number(wanted: int | None, moves: Moves, profile: Profile | None) -> int:
    """Return the number of the move that is wanted; else of that whose length is nearest, or of the longest."""
    if wanted is None:
        unlike = -moves.steps if profile is None else np.abs(moves.steps - profile.intervals_ticks.size)
        return int(np.argmin(unlike)) + 1
    if not 1 <= wanted <= moves.first.size:
        raise Rejected(
            [Rejection("move_number", wanted, f"a whole number from 1 to {moves.first.size:,}: the moves there are")]
        )
    return wanted


def _measured(
    recording: Recording, steps: Steps, moves: Moves, number: int, shortest_pulse_us: float | None
) -> MeasuredMove:
    first = int(moves.first[number - 1])
    last = first + int(moves.steps[number - 1])
    ticks, pulses = steps.ticks[first:last], steps.pulse_ticks[first:last]
    tick_us = float(recording.tick_s * MICROSECONDS_PER_SECOND)
    short = np.empty(0, np.int64)
    if shortest_pulse_us is not None:
        # Whole ticks are compared: a pulse of just that length is long enough.
        least = math.ceil(round(shortest_pulse_us / tick_us, 6))
        short = np.flatnonzero((pulses >= 0) & (pulses < least))
    time_s = (ticks - ticks[0]) * float(recording.tick_s)
    return MeasuredMove(
        number=number,
        begin_s=float(int(ticks[0]) * recording.tick_s),
        time_s=time_s,
        direction_level=int(steps.direction_levels[first]),
        short_pulses=short,
        short_pulse_us=pulses[short] * np.float64(tick_us),
    )
