"""second_order: two terms of the Taylor series, formula (22)."""

from stepramp.methods.common.method import STEP_BY_STEP, RampMethod, Style
from stepramp.methods.common.taylor import taylor_code, taylor_sides
from stepramp.shapes.constant import ConstantAcceleration

COEFFICIENT = 1.5
"""c of p (1 + q + c q²)."""

METHOD = RampMethod(
    rank=50,
    label="2nd order",
    formula="22",
    summary="formula (22)",
    help="As 1st order with one term more: p (1 + q + 1.5 q²). From rest its first intervals come out too long.",
    style=Style("#0f4f8f", "#3b9df5", dash=(8, 2, 2, 2), file_dash=(6, 1.5, 1.5, 1.5)),
    arithmetics=STEP_BY_STEP,
    sides=taylor_sides(COEFFICIENT),
    shape=ConstantAcceleration,
    code=taylor_code(
        COEFFICIENT,
        title="p = p (1 + q + 1.5 q^2), formula (22)",
        series="1 + q + $coefficient * q * q",
        label="2nd order",
        help="Formula 22: p (1 + q + 1.5 q²), best with a base speed.",
    ),
    is_shown_at_first=True,
)
