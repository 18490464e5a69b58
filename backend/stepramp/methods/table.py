"""table: not computed, but looked up in the design's table, as gauge libraries do."""

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.method import CLOSED_FORM, RampMethod, Style
from stepramp.numerics.ramp import RealRamp


def table_ramp(indices: NDArray[np.int64], delays: NDArray[np.float64]) -> RealRamp:
    """Return the ramp that a lookup table stands for, in the unit of the delays.

    The delay at ramp index k is that of the first row whose index is at least k. Under acceleration the first step
    is already at index 2, and a deceleration ends at index 0: so the gauge library counts, and so its recorded moves
    go. Top speed is the last row's.

    indices: last ramp index of each row [steps], increasing, shape (rows,).
    delays: delay of each row, shape (rows,).
    """
    top = int(indices[-1])

    def delay(k: NDArray[np.int64]) -> NDArray[np.float64]:
        found: NDArray[np.float64] = delays[np.searchsorted(indices, k, side="left")]
        return found

    return RealRamp(up=delay(np.arange(2, top + 1)), slew=float(delays[-1]), down=delay(np.arange(top)))


METHOD = RampMethod(
    rank=100,
    label="Table",
    summary="the lookup table",
    help="The lookup table: the delay of a step is that of the first row that reaches it. Cheapest on the chip.",
    style=Style("#d557ab", "#e687b6"),
    # It makes no difference.
    arithmetics=CLOSED_FORM,
    sides=None,
    is_shown_at_first=True,
)
