"""table: not computed, but looked up in the design's table, as gauge libraries do."""

from stepramp.methods.common.method import CLOSED_FORM, RampMethod, Style

METHOD = RampMethod(
    place=100,
    label="Table",
    summary="the lookup table",
    help="The lookup table: the delay of a step is that of the first row that reaches it. Cheapest on the chip.",
    style=Style("#d557ab", "#e687b6"),
    # It makes no difference.
    arithmetics=CLOSED_FORM,
    sides=None,
    is_shown_at_first=True,
)
