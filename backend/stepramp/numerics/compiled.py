"""How loops are compiled that numpy can't do."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

compiled = njit(cache=True, nogil=True)
"""Decorator: compiles once and keeps the result. Other threads go on meanwhile: a long loop keeps no STOP waiting."""


def counted(first: int, count: int) -> NDArray[np.int64]:
    """Return whole numbers, `count` of them from `first` on: as numpy's arange, which lets no other thread go on."""
    numbers: NDArray[np.int64] = np.empty(count, np.int64)
    _count(numbers, first)
    return numbers


@compiled
def _count(out, first):  # type: ignore[no-untyped-def]  # compiled
    for i in range(out.size):
        out[i] = first + i
