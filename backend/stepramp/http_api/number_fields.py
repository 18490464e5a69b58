"""What number fields take, for the page to import: it has neither limits nor units of its own."""

from collections.abc import Iterator
from typing import Any

from stepramp.design import Design
from stepramp.http_api.motion_models import AxisLimits
from stepramp.http_api.settings_models import MODELS
from stepramp.validation import Document

NumberField = dict[str, object]
"""The least and most that a number takes, its unit, and if it is whole."""


def design_fields() -> dict[str, NumberField]:
    """Return what the numbers of a design take, by path, such as "move.steps" or, of any row, "table.rows.1"."""
    return _number_fields(Design)


def device_fields() -> dict[str, NumberField]:
    """Return what the numbers of the settings of any family take, and those of soft limits, by name."""
    models: list[type[Document]] = [*MODELS, AxisLimits]
    return {path: field for model in models for path, field in _number_fields(model).items()}


def _number_fields(model: type[Document]) -> dict[str, NumberField]:
    schema = model.model_json_schema()
    return dict(_numbers_in(schema, schema.get("$defs", {}), ""))


def _numbers_in(schema: dict[str, Any], definitions: dict[str, Any], place: str) -> Iterator[tuple[str, NumberField]]:
    parts = [*schema.get("properties", {}).items(), *enumerate(schema.get("items", {}).get("prefixItems", ()))]
    for name, given in parts:
        for choice in given.get("anyOf", [given]):
            kind = definitions[choice["$ref"].removeprefix("#/$defs/")] if "$ref" in choice else choice
            yield from _numbers_in(kind, definitions, f"{place}{name}.")
            if kind.get("type") in ("integer", "number"):
                limits = [kind["minimum"], kind["maximum"]]
                is_whole = kind["type"] == "integer"
                yield f"{place}{name}", {"limits": limits, "unit": kind.get("x-unit", ""), "isWhole": is_whole}
