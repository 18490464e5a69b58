"""Columns of numbers, as answers have them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.int64] | NDArray[np.float64]
Columns = Mapping[str, Column]
"""Columns of the same length by their names."""


@dataclass(frozen=True)
class Table:
    """Columns under the name of what they are of; a name of '' stands for a table that is the only one."""

    name: str
    columns: Columns
