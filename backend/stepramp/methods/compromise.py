"""compromise: two terms of the Taylor series without the factor 1.5, which overshoots less, formula (23)."""

from stepramp.methods.common.method import STEP_BY_STEP, RampMethod, Style
from stepramp.methods.common.taylor import taylor_code, taylor_on_chip, taylor_sides
from stepramp.shapes.constant import ConstantAcceleration

COEFFICIENT = 1.0
"""c of p (1 + q + c q²)."""

METHOD = RampMethod(
    rank=60,
    label="Compromise",
    formula="23",
    summary="formula (23)",
    help="As 2nd order without the factor 1.5: p (1 + q + q²). It errs between 1st and 2nd order.",
    style=Style("#664717", "#f2cd6c", dash=(6, 2, 1.5, 2, 1.5, 2), file_dash=(5, 1.5, 1, 1.5, 1, 1.5)),
    arithmetics=STEP_BY_STEP,
    sides=taylor_sides(COEFFICIENT),
    shape=ConstantAcceleration,
    code=taylor_code(
        COEFFICIENT,
        title="p = p (1 + q + q^2), formula (23)",
        series="1 + q + q * q",
        label="Compromise",
        help="Formula 23: p (1 + q + q²), best of the three from rest.",
    ),
    on_chip=taylor_on_chip(1, COEFFICIENT),
    is_shown_at_first=True,
)
