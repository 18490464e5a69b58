"""Which steps of a long move to draw, so that the curve looks the same."""

import numpy as np
from numpy.typing import NDArray

from stepramp.ramp.profile import Phase

POINTS_PER_BUCKET = 4


def kept_steps(
    curve: NDArray[np.int64] | NDArray[np.float64], phases: tuple[Phase, ...], most: int
) -> NDArray[np.int64]:
    """Return about `most` steps, counted from 0 and increasing, that carry a curve's shape.

    A move of up to `most` steps keeps them all. Otherwise each phase is cut into buckets, and of each bucket the
    first, least, greatest and last value are kept: corners and extremes stay. Buckets are narrow at the slow ends of
    a move, where a curve changes most from one step to the next; a level stretch keeps its two ends.

    curve: one value a step, shape (N,).
    """
    if curve.size <= most:
        return np.arange(curve.size)
    buckets = max(1, most // POINTS_PER_BUCKET // len(phases))
    starts = np.unique(np.concatenate([_bucket_starts(phase, buckets) for phase in phases]))
    ends = np.append(starts[1:], curve.size)
    least, greatest = _extremes(curve, starts, ends)
    kept = np.unique(np.concatenate((starts, least, greatest, ends - 1)))
    return _without_level_inside(curve, kept)


def _bucket_starts(phase: Phase, buckets: int) -> NDArray[np.int64]:
    """Return where the buckets of a phase begin: evenly in time for a ramp from rest, i ~ t², so evenly in sqrt(i)."""
    steps = phase.last_step - phase.first_step + 1
    even = np.linspace(0, 1, buckets, endpoint=False)
    match phase.name:
        case "accelerate":
            cuts = np.floor(even**2 * steps)
        case "decelerate":
            cuts = np.floor((1 - (1 - even) ** 2) * steps)
        case _:
            cuts = np.floor(even * steps)
    return phase.first_step - 1 + cuts.astype(np.int64)


def _extremes(
    curve: NDArray[np.int64] | NDArray[np.float64], starts: NDArray[np.int64], ends: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where each bucket is least and greatest, the first place of several."""
    bucket = np.repeat(np.arange(starts.size), ends - starts)
    places = []
    for extreme in (np.minimum, np.maximum):
        at = np.flatnonzero(curve == extreme.reduceat(curve, starts)[bucket])
        places.append(at[np.searchsorted(at, starts)])
    return places[0], places[1]


def _without_level_inside(curve: NDArray[np.int64] | NDArray[np.float64], kept: NDArray[np.int64]) -> NDArray[np.int64]:
    """Leave out kept steps whose neighbours on both sides have the same value."""
    values = curve[kept]
    inside = np.zeros(kept.size, bool)
    inside[1:-1] = (values[1:-1] == values[:-2]) & (values[1:-1] == values[2:])
    return kept[~inside]
