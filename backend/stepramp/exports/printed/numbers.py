"""Numbers as people read them: grouped, without exponents, with no more figures than they carry."""

from decimal import Decimal

FIGURES = 6


def plain(value: float, figures: int = FIGURES) -> str:
    """Return a number in so many significant figures.

    >>> plain(1234567.8), plain(0.00001), plain(100.0), plain(-0.05)
    ('1,234,570', '0.00001', '100', '-0.05')
    """
    return f"{Decimal(f'{value:.{figures}g}').normalize() + 0:,f}"


def signed(value: float, figures: int = 3) -> str:
    """Return a number with its sign; 0 has none.

    >>> signed(12.345), signed(-0.5), signed(0.0)
    ('+12.3', '-0.5', '0')
    """
    return f"+{plain(value, figures)}" if value > 0 else plain(value, figures)
