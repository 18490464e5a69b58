"""Changes of speed against what was ordered."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from firmware.checker import CYCLES_PER_S
from firmware.flight.exchange import ORDERS, Exchange
from firmware.flight.judgement import Judgement, at, us
from firmware.flight.setting import Ticks
from firmware.flight.speed import Piece, may_rest
from firmware.protocol import RUN, STOP

AHEAD_MS, AHEAD_STEPS = 20.0, 24
"""A request has come into effect after so long and so many more steps: what is queued is played before."""


def judge_orders(piece: Piece, found: Judgement) -> None:
    """The speed dips for an order only, doesn't rise after a stop, and stays at that of a run."""
    intervals = np.diff(piece.steps).astype(float)
    flight = piece.flight
    orders = flight.orders
    _judge_dips(piece, intervals, [one for one in orders if one.kind in ORDERS], found)
    for number, one in enumerate(orders):
        until = orders[number + 1].arrived if number + 1 < len(orders) else np.inf
        first = int(np.searchsorted(piece.steps, one.answered + AHEAD_MS * CYCLES_PER_S / 1e3))
        first += AHEAD_STEPS
        part = intervals[first : max(int(np.searchsorted(piece.steps, until)) - 1, 0)]
        if one.kind not in (STOP, RUN) or part.size == 0:
            continue
        wanted = one.values[flight.axis] if one.kind == RUN else 0
        part = part[: _steps_in_direction(piece.forward[first:], wanted)]
        away = _goes_away(part, float(piece.in_cycles(abs(wanted))) if wanted else np.inf) - 2 * piece.late
        if part.size and away.max() > 0:
            what = f"a run at {us(float(piece.in_cycles(abs(wanted))))}" if wanted else "a stop"
            worst = int(away.argmax())
            found.add(
                f"{piece.where(first + worst)}: {us(part[worst])}, {us(away[worst])} off after {what} {at(one.arrived)}"
            )


def _steps_in_direction(forward: npt.NDArray[np.bool_], wanted: int) -> int:
    """Return how many intervals there are before the motor turns; none when it has yet to turn."""
    if wanted and forward[0] != (wanted > 0):
        return 0
    turns = np.flatnonzero(forward != forward[0])
    return int(turns[0]) - 1 if turns.size else forward.size


def _goes_away(intervals: Ticks, wanted: float) -> Ticks:
    """Return by how much intervals are farther from the one wanted than one before them, on the same side of it."""
    nearest_above = np.maximum(np.minimum.accumulate(intervals), wanted)
    nearest_below = np.minimum(np.maximum.accumulate(intervals), wanted)
    with np.errstate(invalid="ignore"):
        return np.maximum(np.where(np.isfinite(nearest_above), intervals - nearest_above, 0), nearest_below - intervals)


def _judge_dips(piece: Piece, intervals: Ticks, orders: Sequence[Exchange], found: Judgement) -> None:
    """Where the motor has slowed down and rises again before rest, an order has told it to."""
    for first, last in dips(intervals, 2 * piece.late):
        interval = intervals[first]
        if may_rest(piece, interval) or may_rest(piece, intervals[first - 1]):
            continue
        begin = piece.steps[first] - AHEAD_MS * CYCLES_PER_S / 1e3 - AHEAD_STEPS * interval
        if not any(begin <= one.answered and one.arrived <= piece.steps[last + 1] for one in orders):
            found.add(f"{piece.where(first)}: the speed dips to {us(interval)} with no order")


def dips(intervals: Ticks, least: float) -> list[tuple[int, int]]:
    """Return the first and last place of each slowest speed, from which it has fallen and rises by at least so much."""
    found, first, last, is_falling = list[tuple[int, int]](), 0, 0, False
    extreme = intervals[0] if intervals.size else 0.0
    for place in (np.flatnonzero(np.diff(intervals)) + 1).tolist():
        interval = intervals[place]
        if is_falling:
            if interval > extreme:
                first, extreme = place, interval
            if interval >= extreme - least:
                last = place
            else:
                found.append((first, last))
                is_falling, extreme = False, interval
        elif interval > extreme + least:
            first, last, is_falling, extreme = place, place, True, interval
        else:
            extreme = min(extreme, interval)
    return found
