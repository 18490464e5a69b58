"""What completes words of the command line that are some of few."""

from collections.abc import Callable, Iterable


def completing(names: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return what completes a word to one of some names, which are looked up only then."""
    return lambda incomplete: [each for each in names() if each.startswith(incomplete)]


def family_names() -> list[str]:
    """Return the names of the families of controllers."""
    from stepramp.controllers.families import FAMILIES  # noqa: PLC0415  # only to complete a word

    return list(FAMILIES)
