"""Changes of a design: how they are put into it, and which of them give it another shape."""

from collections.abc import Iterable
from typing import Any, TypeVar

from stepramp.design import Design
from stepramp.errors import Change, Rejected, Rejection
from stepramp.methods import METHODS, REFERENCE
from stepramp.shapes import SHAPES, USUAL_SHAPE

D = TypeVar("D", bound=Design)


def with_changes(design: D, changes: Iterable[Change]) -> D:
    """Return the design with other values in some fields. Raises Rejected where that is no design."""
    document = design.model_dump(by_alias=True)
    for change in changes:
        _put(document, change)
    return type(design).checked(document)


def _put(document: dict[str, Any], change: Change) -> None:
    *parts, name = change.field.split(".")
    part = document
    for number, each in enumerate(parts, start=1):
        # A part that isn't there begins with what is put into it; of a name that there isn't, the check says so.
        inner = part[each] = {} if part.get(each) is None else part[each]
        if not isinstance(inner, dict):
            whole = ".".join(parts[:number])
            raise Rejected([Rejection(change.field, change.value, f"{whole} as a whole, which has no such fields")])
        part = inner
    part[name] = change.value


def changed(design: Design, changes: Iterable[Change]) -> Design | None:
    """Return the same; None where that is no design."""
    try:
        return with_changes(design, changes)
    except Rejected:
        return None


def reshaping(design: Design, shape: dict[str, object]) -> tuple[Change, ...]:
    """Return what gives the design a shape, and a method and an arithmetic that make it where its own don't."""
    changes = [Change("ramp.shape", shape)]
    method = design.method
    makes = method.numerics.shape
    if method.plays_table or not (makes is None or issubclass(SHAPES[str(shape["name"])], makes)):
        usual = {"name": REFERENCE, "arithmetic": METHODS[REFERENCE].arithmetics[0]}
        changes.append(Change("method", method.model_dump() | usual))
    elif method.arithmetic == "fixed" and shape["name"] != USUAL_SHAPE:
        # Integers have formulas for constant acceleration only, and float32 not for every long ramp.
        changes.append(Change("method.arithmetic", "float64"))
    return tuple(changes)
