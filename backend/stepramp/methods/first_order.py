"""first_order: one term of the Taylor series, formula (20)."""

from stepramp.methods.common.method import STEP_BY_STEP, RampMethod, Style
from stepramp.methods.common.taylor import taylor_code, taylor_on_chip, taylor_sides
from stepramp.shapes.constant import ConstantAcceleration

COEFFICIENT = 0.0
"""c of p (1 + q + c q²)."""

METHOD = RampMethod(
    rank=40,
    label="1st order",
    formula="20",
    summary="formula (20)",
    help="Each interval from the one before with three multiplications. From rest it errs most in its first steps.",
    style=Style("#d2601a", "#ee6a1a", dash=(9, 3), file_dash=(7, 2)),
    arithmetics=STEP_BY_STEP,
    sides=taylor_sides(COEFFICIENT),
    shape=ConstantAcceleration,
    code=taylor_code(
        COEFFICIENT,
        title="p = p (1 + q), formula (20)",
        series="1 + q",
        label="1st order",
        help="Formula 20: p (1 + q), the quickest.",
    ),
    on_chip=taylor_on_chip(0, COEFFICIENT),
    is_shown_at_first=True,
)
