"""How loops are compiled that numpy can't do: kept from one run to the next for as long as no source has changed.

Code calls code of other modules and takes constants from them; what is kept of one module alone, as numba keeps it,
would go on with what the others were before.
"""

from pathlib import Path

import numpy as np
from numba import config, njit
from numpy.typing import NDArray

from stepramp.numerics.code_folder import code_folder, use

PACKAGE = Path(__file__).parents[1]

# What somebody names by NUMBA_CACHE_DIR may be others' too: nothing is removed there.
OWN = PACKAGE / "__pycache__"

_folder = code_folder(PACKAGE, Path(config.CACHE_DIR or OWN))  # type: ignore[attr-defined]
if _folder.parent == OWN:
    use(_folder)
config.CACHE_DIR = str(_folder)  # type: ignore[attr-defined]

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
