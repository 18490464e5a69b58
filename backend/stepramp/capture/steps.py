"""Steps: the edges of a channel that make a motor step, and the moves that they make."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.capture.recording import UNKNOWN, Recording
from stepramp.numerics.compiled import compiled

Edge = Literal["rising", "falling", "both"]
LEADS_TO: dict[Edge, int] = {"falling": 0, "rising": 1, "both": 2}
"""The level that an edge leads to; 2: either."""

NO_END = -1
"""Length of a pulse that had not ended when the capture did."""


@dataclass(frozen=True)
class Steps:
    """The steps in a recording. Arrays of shape (steps,)."""

    ticks: NDArray[np.int64]
    """Instants, not decreasing [ticks]."""
    pulse_ticks: NDArray[np.int64]
    """How long the level lasts that a step begins with, or NO_END [ticks]."""
    direction_levels: NDArray[np.int8]
    """Level of the direction channel, UNKNOWN without one."""


@dataclass(frozen=True)
class Moves:
    """Moves: steps without a pause or a change of direction between them. Arrays of shape (moves,)."""

    first: NDArray[np.int64]
    """The first step of each, counted from 0."""
    steps: NDArray[np.int64]
    """How many steps each has."""


def steps_of(recording: Recording, step_channel: int, direction_channel: int | None, edge: Edge) -> Steps:
    """Return the steps that a channel makes. A direction that changes together with a step holds for that step."""
    direction = UNKNOWN if direction_channel is None else direction_channel
    known = np.int8(UNKNOWN if direction_channel is None else recording.first_levels[direction_channel])
    arguments = (recording.edge_ticks, recording.edge_codes, step_channel, direction, known, LEADS_TO[edge])
    count = _count(recording.edge_codes, step_channel, LEADS_TO[edge])
    steps = Steps(np.empty(count, np.int64), np.full(count, NO_END, np.int64), np.empty(count, np.int8))
    _find_steps(*arguments, steps.ticks, steps.pulse_ticks, steps.direction_levels)
    return steps


def moves_of(steps: Steps, pause_ticks: int) -> Moves:
    """Return the moves that steps make; a wait of more than pause_ticks is between two of them."""
    begins = np.empty(_count_moves(steps.ticks, steps.direction_levels, pause_ticks), np.int64)
    _find_moves(steps.ticks, steps.direction_levels, pause_ticks, begins)
    return Moves(begins, np.diff(begins, append=steps.ticks.size))


@compiled
def _count(codes, channel, level):  # type: ignore[no-untyped-def]  # compiled
    count = 0
    for code in codes:
        count += code >> 1 == channel and level in (2, code & 1)
    return count


@compiled
def _find_steps(  # type: ignore[no-untyped-def]  # compiled
    ticks, codes, step_channel, direction_channel, known, level, step_ticks, pulse_ticks, directions
):
    found, found_before, is_pulse = 0, 0, False
    for number in range(codes.size):
        channel, leads_to = codes[number] >> 1, codes[number] & 1
        if channel == direction_channel:
            known = np.int8(leads_to)
        elif channel == step_channel:
            if is_pulse:
                pulse_ticks[found - 1] = ticks[number] - step_ticks[found - 1]
            is_pulse = level in (2, leads_to)
            if is_pulse:
                step_ticks[found] = ticks[number]
                found += 1
        if number + 1 == codes.size or ticks[number + 1] != ticks[number]:
            # All steps of one instant have the direction that it ends with.
            directions[found_before:found] = known
            found_before = found


@compiled
def _is_new(ticks, directions, pause, step):  # type: ignore[no-untyped-def]  # compiled
    return step == 0 or ticks[step] - ticks[step - 1] > pause or directions[step] != directions[step - 1]


@compiled
def _count_moves(ticks, directions, pause):  # type: ignore[no-untyped-def]  # compiled
    count = 0
    for step in range(ticks.size):
        count += _is_new(ticks, directions, pause, step)
    return count


@compiled
def _find_moves(ticks, directions, pause, begins):  # type: ignore[no-untyped-def]  # compiled
    found = 0
    for step in range(ticks.size):
        if _is_new(ticks, directions, pause, step):
            begins[found] = step
            found += 1
