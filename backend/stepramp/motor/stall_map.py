"""The stall map: a grid of verdicts that is refined where its border runs.

Pure: which points are to be played, and what becomes of the others. Who plays them, and where, is not its affair.
Rows and columns are counted from 0; docs/motor.md has the picture.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Point = tuple[int, int]
"""Row and column."""
PlayAll = Callable[[list[Point]], Iterator[tuple[Point, int]]]
"""Yields each of the points with its verdict, in any order. It ends early when nobody waits for them any more."""

UNKNOWN = -1
COARSE = 8
"""Cells of the first grid along each side."""
FIRST_HALVING = 1.5
"""As many times the points of the first grid are played when cells are first halved: a guess, for the progress."""


@dataclass(frozen=True)
class Picture:
    """The map so far."""

    verdicts: NDArray[np.int8]
    """Shape (cells + 1, cells + 1), UNKNOWN where nothing is known yet."""
    played: int
    """How many points were played."""
    progress: float
    """How much is done, from 0 to 1, as far as can be told."""


def stall_map(cells: int, play_all: PlayAll) -> Iterator[Picture]:
    """Yield the map as it grows, whenever a verdict has come; the last one is the whole, unless play_all ended early.

    cells: a power of two, 8 or more.

    First the corners of 8 × 8 cells are played. Cells whose corners differ are halved, and the cells beside them; the
    other points have the verdict of the four equal corners around them. Wherever a finer cell then differs, its corners
    and those of the cells beside it are played, too, so that what touches it is followed; and so on down to cells of 1.
    """
    spacing = cells // COARSE
    known = np.full((cells + 1, cells + 1), UNKNOWN, np.int8)
    played = np.zeros(known.shape, bool)
    wanted = np.zeros(known.shape, bool)
    wanted[::spacing, ::spacing] = True
    done, levels = 0.0, _shares(cells)
    share = next(levels)
    while True:
        shown = _shown(known, spacing)
        batch = _spread_out(wanted)
        for number, (point, verdict) in enumerate(play_all(batch), start=1):
            known[point] = shown[point] = verdict
            played[point] = True
            yield Picture(shown.copy(), int(played.sum()), done + share * number / len(batch))
        if not played[wanted].all():
            return
        done, share = done + share, 0.0
        at = known[::spacing, ::spacing], played[::spacing, ::spacing]
        wanted = np.zeros(known.shape, bool)
        wanted[::spacing, ::spacing] = _corners(_beside_the_border(at[0])) & ~at[1]
        if wanted.any():
            continue
        if spacing == 1:
            yield Picture(known, int(played.sum()), 1.0)
            return
        wanted = _halved(known, spacing)
        spacing, share = spacing // 2, next(levels)


def _halved(known: NDArray[np.int8], spacing: int) -> NDArray[np.bool_]:
    """Fill in what needn't be played at half the spacing; return what is to be."""
    half = spacing // 2
    coarse, fine = known[::spacing, ::spacing], known[::half, ::half]
    is_needed = _corners(np.kron(_beside_the_border(coarse), np.ones((2, 2), bool)))
    is_left = (fine == UNKNOWN) & ~is_needed
    # The cell before a point is as good as the one behind it: it is in no cell that differs.
    fine[is_left] = np.kron(coarse, np.ones((2, 2), np.int8))[:-1, :-1][is_left]
    wanted = np.zeros(known.shape, bool)
    wanted[::half, ::half] = is_needed & (fine == UNKNOWN)
    return wanted


def _beside_the_border(corners: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Return which cells have corners that differ, or lie beside such a cell; one less each way than corners."""
    four = [corners[:-1, :-1], corners[1:, :-1], corners[:-1, 1:], corners[1:, 1:]]
    around = np.pad(np.max(four, 0) != np.min(four, 0), 1)
    near: NDArray[np.bool_] = sliding_window_view(around, (3, 3)).max((2, 3))
    return near


def _corners(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which points are a corner of one of the cells; one more each way than cells."""
    touched: NDArray[np.bool_] = sliding_window_view(np.pad(cells, 1), (2, 2)).max((2, 3))
    return touched


def _shown(known: NDArray[np.int8], spacing: int) -> NDArray[np.int8]:
    """Return what is known, with the verdict of equal corners inside of their cells."""
    coarse = known[:: 2 * spacing, :: 2 * spacing]
    shown = known.copy()
    if len(coarse) <= COARSE:
        return shown
    is_even = ~_beside_the_border(coarse)
    inside = np.where(is_even, coarse[:-1, :-1], UNKNOWN)
    filled = np.kron(inside, np.ones((2 * spacing, 2 * spacing), np.int8))
    within = shown[:-1, :-1]
    within[within == UNKNOWN] = filled[within == UNKNOWN]
    return shown


def _spread_out(wanted: NDArray[np.bool_]) -> list[Point]:
    """Return the wanted points, in an order in which a few of them already show the whole."""
    points = np.argwhere(wanted)
    order = np.random.default_rng(0).permutation(len(points))
    return [(int(row), int(column)) for row, column in points[order]]


def _shares(cells: int) -> Iterator[float]:
    """Yield which share of the whole each level takes, the coarse one first: each that of the last one twice."""
    levels = (cells // COARSE).bit_length()
    parts = [1.0, *(FIRST_HALVING * 2**level for level in range(levels - 1))]
    yield from (part / sum(parts) for part in parts)
