"""The options of [printer] that limit axes: which of them are written, and which are lowered with others."""

from collections.abc import Iterator, Mapping

from stepramp.controllers.klipper.configuration import Sections
from stepramp.controllers.klipper.machine import PRINTER

CAPPED = {"max_z_velocity": "max_velocity", "max_z_accel": "max_accel"}
"""Options that Klipper doesn't start with where they are above another one."""


def to_write(sections: Sections, options: Mapping[str, str]) -> tuple[dict[str, str], tuple[str, ...]]:
    """Return what has to be written to a configuration so that it has options, and what else there is to say of that.

    What is another text of the same number is left: 100.0 is no other than 100.
    """
    lowered, there = dict(_capped(sections, options)), sections.get(PRINTER, {})
    wanted = {
        name: value
        for name, value in {**options, **lowered}.items()
        if name not in there or number(there[name]) != float(value)
    }
    return wanted, tuple(
        f"{name} is lowered to {float(value):,.10g} with {CAPPED[name]}: Klipper doesn't start with more."
        for name, value in lowered.items()
    )


def with_options(sections: Sections, options: Mapping[str, str]) -> dict[str, dict[str, str]]:
    """Return a configuration with other options of [printer]."""
    return {name: {**each, **(options if name == PRINTER else {})} for name, each in sections.items()}


def number(text: str) -> float:
    """Return a number; infinity for what is none."""
    try:
        return float(text)
    except ValueError:
        return float("inf")


def _capped(sections: Sections, options: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield what has to be lowered with options, so that Klipper starts."""
    for name, by in CAPPED.items():
        there = sections.get(PRINTER, {}).get(name)
        if by in options and name not in options and there is not None and number(there) > float(options[by]):
            yield name, options[by]
