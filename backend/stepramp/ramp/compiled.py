"""How loops are compiled that numpy can't do."""

from numba import njit

compiled = njit(cache=True, nogil=True)
"""Decorator: compiles once and keeps the result. Other threads go on meanwhile: a long loop keeps no STOP waiting."""
