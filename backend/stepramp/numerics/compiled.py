"""How loops are compiled that numpy can't do: kept from one run to the next for as long as no source has changed.

Code calls code of other modules and takes constants from them; what is kept of one module alone, as numba keeps it,
would go on with what the others were before.
"""

import hashlib
from pathlib import Path

import numpy as np
from numba import config, njit
from numpy.typing import NDArray

PACKAGE = Path(__file__).parents[1]
SOURCES = ("numerics", "shapes", "methods", "ramp", "capture")
"""Folders of all that is compiled, and of what it calls and takes its constants from."""


def cache_folder(package: Path, parent: Path) -> Path:
    """Return where machine code made of these sources is kept: their names, sizes and times are in its name."""
    digest = hashlib.sha256()
    for source in sorted(path for folder in SOURCES for path in (package / folder).rglob("*.py")):
        about = source.stat()
        digest.update(f"{source.relative_to(package)} {about.st_size} {about.st_mtime_ns}\n".encode())
    return parent / f"stepramp-{digest.hexdigest()[:12]}"


config.CACHE_DIR = str(cache_folder(PACKAGE, Path(config.CACHE_DIR or PACKAGE / "__pycache__")))  # type: ignore[attr-defined]

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
