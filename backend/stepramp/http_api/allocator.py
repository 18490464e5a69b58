"""Memory that long moves take is given back: else what a server has kept grows with each of them."""

import ctypes
import sys

MIB = 2**20
BIG_BYTES = 8 * MIB
"""Blocks of this size, arrays of a million steps, are the system's again as soon as they are free."""
SPARE_BYTES = 16 * MIB
"""So much that is free is kept of what smaller ones share, for each thread that has taken some."""
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""As glibc's malloc.h has them; mallopt(3)."""


def give_big_blocks_back() -> None:
    """Have the C library return free memory to the system.

    By itself glibc, once a block of up to 32 MB has been free, keeps as much for each thread, and twice that at its
    end. Other libraries stay as they are.
    """
    if sys.platform != "linux":
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, BIG_BYTES)
        mallopt(M_TRIM_THRESHOLD, SPARE_BYTES)
