"""Limits as they stand in a message: rounded to the side on which they are kept, so that what is told is allowed."""

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

from stepramp.errors import StepUnit, Told

FIGURES = 6
NOISE_FIGURES = 12
"""Beyond these figures a limit is what floating point makes of it."""


def at_least(limit: float, figures: int = FIGURES) -> str:
    """Return a lower limit as words, rounded up to so many figures."""
    return f"at least {_in_words(_rounded(limit, figures, ROUND_CEILING))}"


def at_most(limit: float, figures: int = FIGURES) -> str:
    """Return an upper limit as words, rounded down to so many figures."""
    return f"at most {_in_words(_rounded(limit, figures, ROUND_FLOOR))}"


def told_lowest(limit: float, unit: StepUnit) -> Told:
    """Return a lower limit as a message has it, rounded up."""
    return Told(f"{_in_words(_rounded(limit, FIGURES, ROUND_CEILING))} {unit}", limit, unit, "up")


def told_highest(limit: float, unit: StepUnit) -> Told:
    """Return an upper limit as a message has it, rounded down."""
    return Told(f"{_in_words(_rounded(limit, FIGURES, ROUND_FLOOR))} {unit}", limit, unit, "down")


def lowest(limit: float, figures: int = FIGURES) -> float:
    """Return a lower limit rounded up to so many figures."""
    return float(_rounded(limit, figures, ROUND_CEILING))


def highest(limit: float, figures: int = FIGURES) -> float:
    """Return an upper limit rounded down to so many figures."""
    return float(_rounded(limit, figures, ROUND_FLOOR))


def _rounded(limit: float, figures: int, rounding: str) -> Decimal:
    return Context(prec=figures, rounding=rounding).plus(Decimal(f"{limit:.{NOISE_FIGURES}g}"))


def _in_words(limit: Decimal) -> str:
    return f"{limit.normalize():,f}"
