"""The arithmetics that a ramp can be computed in."""

from typing import Literal

import numpy as np

Arithmetic = Literal["float64", "float32", "fixed"]
"""float32 is what C float gives, operation for operation; fixed the integers of a controller without floating point."""
Number = type[np.float32] | type[np.float64]
"""Floating-point numbers of one width."""
NUMBERS: dict[Arithmetic, Number] = {"float64": np.float64, "float32": np.float32}
