"""In which order figures are written of which a power cut may keep some from being."""

from collections.abc import Callable, Iterable
from typing import TypeVar

T = TypeVar("T")


def lowered_first(figures: Iterable[T], is_raised: Callable[[T], bool]) -> list[T]:
    """Return speeds and accelerations in the order in which they are written: those that become more come last.

    Whatever cuts that short, what is there by then is no more than what there was, or no more than what is to be: a
    new speed that is high never meets an old acceleration that is.
    """
    return sorted(figures, key=is_raised)
