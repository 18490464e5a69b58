"""Lookup tables as the gauge library plays them: targets that change in flight, and a stop before each reversal.

"A Simplified Acceleration Model" (SwitecX25, 2012) describes the logic; where its words and the library's recorded
moves differ, the record holds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_STEPS
from stepramp.errors import Count, Rejected, Rejection
from stepramp.numerics.compiled import compiled


@dataclass(frozen=True)
class TableMoves:
    """What a gauge does: its steps in order of time, and where it came to rest."""

    at_us: NDArray[np.int64]
    """Instant of each step [µs], shape (steps,)."""
    position: NDArray[np.int64]
    """Position after each step [steps], shape (steps,)."""
    direction: NDArray[np.int64]
    """1 up, -1 down, shape (steps,)."""
    ramp_index: NDArray[np.int64]
    """Ramp index after each step, shape (steps,)."""
    delay_us: NDArray[np.int64]
    """Wait after each step [µs], shape (steps,)."""
    stop_at_us: NDArray[np.int64]
    """Instant of each stop: the end of the last step's delay [µs], shape (stops,)."""
    stop_position: NDArray[np.int64]
    """Position of each stop [steps], shape (stops,)."""


def play_table(
    rows: NDArray[np.int64], range_steps: int, target_at_us: NDArray[np.int64], targets: NDArray[np.int64]
) -> TableMoves:
    """Return the moves that a table makes towards targets that are set at given instants, from rest at position 0.

    After each step the ramp index falls when fewer steps than it are left, or none, and rises otherwise, up to the
    last row's; the delay at a ramp index is that of the first row whose index is at least as high. At rest, the
    direction is that of the target. Targets are kept within 0 to range_steps - 1. A step that is due
    when a target is set is made first; at rest, the first step comes at the instant of the target.

    rows: last ramp index and delay [µs] of each row, shape (rows, 2). target_at_us: instants, not falling [µs];
    targets: positions [steps]; both of shape (targets,). Raises Rejected beyond 10,000,000 steps.
    """
    kept = np.clip(targets, 0, range_steps - 1)
    indices, delays = np.ascontiguousarray(rows[:, 0]), np.ascontiguousarray(rows[:, 1])
    parts = (indices, delays, range_steps, target_at_us, kept)
    steps = np.empty((0, 5), np.int64)
    stops = np.empty((target_at_us.size, 2), np.int64)
    made, _ = _play(*parts, steps, stops)
    if made > MOST_STEPS:
        raise Rejected(
            [Rejection("targets", Count(f"{targets.size} targets"), f"moves of at most {MOST_STEPS:,} steps in all")]
        )
    steps = np.empty((made, 5), np.int64)
    _, stopped = _play(*parts, steps, stops)
    return TableMoves(*np.ascontiguousarray(steps.T), *np.ascontiguousarray(stops[:stopped].T))


@compiled
def _play(indices, delays, range_steps, target_at_us, targets, steps, stops):  # type: ignore[no-untyped-def]  # compiled
    """Write as many steps as there is room for, and all stops; return how many of each there are."""
    top = indices[-1]
    made, stopped, known = 0, 0, 0
    position, target, ramp_index, direction = 0, 0, 0, 1
    at, resting = 0, True
    while made <= MOST_STEPS:
        while known < targets.size and target_at_us[known] < at + resting:
            target = targets[known]
            known += 1
        if ramp_index == 0 and position == target:
            if not resting:
                stops[stopped] = (at, position)
                stopped, resting = stopped + 1, True
            elif known == targets.size:
                break
            else:
                at = target_at_us[known]
            continue
        resting = False
        if ramp_index == 0:
            direction = 1 if position < target else -1
            ramp_index = 1
        position = min(max(position + direction, 0), range_steps)
        left = (target - position) * direction
        if left < ramp_index:
            ramp_index -= 1
        elif ramp_index < top:
            ramp_index += 1
        delay = delays[np.searchsorted(indices, ramp_index)]
        if made < steps.shape[0]:
            steps[made] = (at, position, direction, ramp_index, delay)
        made += 1
        at += delay
    return made, stopped
