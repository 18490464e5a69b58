"""Which steps of a long move to draw, so that the curve looks the same."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled, counted
from stepramp.ramp.profile import Phase

POINTS_PER_BUCKET = 4
REST_SHARE = 4
"""How much coarser the rest of a move is drawn than the part that is looked at."""


def kept_steps(
    curve: NDArray[np.int64] | NDArray[np.float64],
    phases: tuple[Phase, ...],
    most: int,
    span: tuple[int, int] | None = None,
) -> NDArray[np.int64]:
    """Return about `most` steps, counted from 0 and increasing, that carry a curve's shape.

    A move of up to `most` steps keeps them all. Otherwise each phase is cut into buckets, and of each bucket the
    first, least, greatest and last value are kept: corners and extremes stay. Buckets are narrow at the slow ends of
    a move, where a curve changes most from one step to the next; a level part keeps its two ends.

    curve: one value a step, shape (N,).
    span: first and last step, counted from 1, of the only part that is wanted; None: the whole move.
    """
    first, last = span or (1, curve.size)
    if last - first < most:
        return counted(first - 1, last - first + 1)
    return _without_level_inside([curve], _thinned([curve], _within(phases, first, last), most))


def kept_steps_of_all(
    curves: Sequence[NDArray[np.int64] | NDArray[np.float64]],
    phases: tuple[Phase, ...],
    most: int,
    span: tuple[int, int] | None = None,
) -> NDArray[np.int64]:
    """Return about `most` steps, counted from 0 and increasing, that carry the shapes of several curves at once.

    As kept_steps, but a part where all curves are level keeps only its two ends in a short move too.

    curves: one value a step each, shape (N,), at least one.
    span: first and last step of a part of the move, counted from 1, that gets the points; the rest then has about a
    quarter as many, so that the whole move can still be drawn.
    """
    size = curves[0].size
    first, last = span or (1, size)
    if span is None or (first <= 1 and last >= size):
        return _without_level_inside(curves, _thinned(curves, phases, most))
    around = _thinned(curves, phases, most // REST_SHARE)
    return _without_level_inside(curves, np.union1d(around, _thinned(curves, _within(phases, first, last), most)))


def _within(phases: tuple[Phase, ...], first: int, last: int) -> tuple[Phase, ...]:
    """Return the parts of phases that lie between two steps, counted from 1."""
    cut = (Phase(each.name, max(each.first_step, first), min(each.last_step, last)) for each in phases)
    return tuple(each for each in cut if each.first_step <= each.last_step)


def _thinned(
    curves: Sequence[NDArray[np.int64] | NDArray[np.float64]], phases: tuple[Phase, ...], most: int
) -> NDArray[np.int64]:
    """Return the steps to keep of adjoining phases, level parts still whole."""
    begin, end = phases[0].first_step - 1, phases[-1].last_step
    if end - begin <= most:
        return counted(begin, end - begin)
    buckets = max(1, most // POINTS_PER_BUCKET // len(phases))
    starts = _in_order([_bucket_starts(phase, buckets) for phase in phases])
    ends = np.append(starts[1:], end)
    kept = [starts, ends - 1]
    for curve in curves:
        least, greatest = np.empty_like(starts), np.empty_like(starts)
        _find_extremes(curve, starts, ends, least, greatest)
        kept += [least, greatest]
    return _in_order(kept)


def _in_order(parts: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return all steps of several lists, each once: quicker than numpy's unique, which doesn't count on order."""
    steps = np.sort(np.concatenate(parts), kind="stable")
    once: NDArray[np.int64] = steps[np.append(True, steps[1:] != steps[:-1])]
    return once


def _bucket_starts(phase: Phase, buckets: int) -> NDArray[np.int64]:
    """Return where the buckets of a phase begin: evenly in time for a ramp from rest, i ~ t², so evenly in sqrt(i)."""
    steps = phase.last_step - phase.first_step + 1
    even = _even_parts(buckets)
    match phase.name:
        case "accelerate":
            cuts = np.floor(even**2 * steps)
        case "decelerate":
            cuts = np.floor((1 - (1 - even) ** 2) * steps)
        case _:
            cuts = np.floor(even * steps)
    return phase.first_step - 1 + cuts.astype(np.int64)


@lru_cache(maxsize=64)
def _even_parts(buckets: int) -> NDArray[np.float64]:
    """Return where so many even parts of the whole begin; short answers have few, which many ask for."""
    even = np.linspace(0, 1, buckets, endpoint=False)
    even.setflags(write=False)
    return even


@compiled
def _find_extremes(curve, starts, ends, least, greatest):  # type: ignore[no-untyped-def]  # compiled
    """Find where a curve is least and greatest in each bucket, the first place of several."""
    for bucket in range(starts.size):
        low = high = starts[bucket]
        for i in range(starts[bucket] + 1, ends[bucket]):
            if curve[i] < curve[low]:
                low = i
            if curve[i] > curve[high]:
                high = i
        least[bucket], greatest[bucket] = low, high


def _without_level_inside(
    curves: Sequence[NDArray[np.int64] | NDArray[np.float64]], kept: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Leave out kept steps whose neighbours on both sides have the same values."""
    inside = np.zeros(kept.size, bool)
    inside[1:-1] = True
    for curve in curves:
        values = curve[kept]
        inside[1:-1] &= (values[1:-1] == values[:-2]) & (values[1:-1] == values[2:])
    return kept[~inside]
