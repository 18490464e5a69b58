"""Designs to start from: one JSON file each, with a title, a description and a design document."""

import json
from importlib.resources import files
from typing import Any

NAMES = ("lead_screw", "laser_table", "gauge")


def all_examples() -> list[dict[str, Any]]:
    """Return the examples in the order they are shown: title, description and design document of each."""
    folder = files("stepramp.examples")
    return [json.loads((folder / f"{name}.json").read_text(encoding="utf-8")) for name in NAMES]
