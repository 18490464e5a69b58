"""Designs for tests: a document that is valid, and changes to it."""

from __future__ import annotations

import copy
from typing import Any

from stepramp.design import Design


def document(**changes: Any) -> dict[str, Any]:
    """Return a valid design document; a change is named by its path with __ between its parts."""
    valid: dict[str, Any] = {
        "schema": "stepramp/1",
        "name": "Test",
        "axis": {"full_steps_per_rev": 200, "microsteps": 2, "travel_per_rev": 8.0, "travel_unit": "mm"},
        "timer": {"frequency_hz": 2_000_000, "counter_bits": 16, "shortest_interval_us": 20},
        "ramp": {
            "base_speed_steps_per_s": 0,
            "slew_speed_steps_per_s": 1000,
            "acceleration_steps_per_s2": 5000,
            "deceleration_steps_per_s2": None,
        },
        "method": {"name": "exact", "arithmetic": "float64", "rounding": "nearest"},
        "table": {"rows": [[10, 5000], [30, 1500], [100, 1000], [150, 800], [300, 600]], "interval_unit": "us"},
        "move": {"steps": 2000},
    }
    changed = copy.deepcopy(valid)
    for path, value in changes.items():
        *parents, name = path.split("__")
        place = changed
        for parent in parents:
            place = place[parent]
        place[name] = value
    return changed


def design(**changes: Any) -> Design:
    """Return the valid design, changed."""
    return Design.checked(document(**changes))
