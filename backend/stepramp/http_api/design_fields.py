"""What a design's number fields take, for the page to import: it has neither limits nor units of its own."""

from collections.abc import Iterator
from typing import Any

from stepramp.design import Design

NumberField = dict[str, object]


def number_fields() -> dict[str, NumberField]:
    """Return by path, such as "move.steps", the least and most that each number takes, its unit, and if it is whole."""
    schema = Design.model_json_schema()
    return dict(_numbers_of(schema, schema["$defs"], ""))


def _numbers_of(schema: dict[str, Any], definitions: dict[str, Any], place: str) -> Iterator[tuple[str, NumberField]]:
    for name, given in schema.get("properties", {}).items():
        for choice in given.get("anyOf", [given]):
            kind = definitions[choice["$ref"].removeprefix("#/$defs/")] if "$ref" in choice else choice
            yield from _numbers_of(kind, definitions, f"{place}{name}.")
            if kind.get("type") in ("integer", "number"):
                limits = [kind["minimum"], kind["maximum"]]
                is_whole = kind["type"] == "integer"
                yield f"{place}{name}", {"limits": limits, "unit": kind.get("x-unit", ""), "isWhole": is_whole}
