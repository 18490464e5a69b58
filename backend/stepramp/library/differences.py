"""What two designs differ in, field by field."""

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Difference:
    """A field that is not the same in both; None where one of them hasn't got it."""

    field: str
    before: object
    after: object


def differences(before: object, after: object, field: str = "") -> Iterator[Difference]:
    """Yield the fields that differ, by their paths, such as "ramp.accel"; lists, such as a table's rows, as a whole."""
    if isinstance(before, dict) and isinstance(after, dict):
        for name in [*before, *(each for each in after if each not in before)]:
            yield from differences(before.get(name), after.get(name), f"{field}.{name}" if field else name)
    elif before != after:
        yield Difference(field, before, after)
