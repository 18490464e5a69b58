"""What a remedy is called on its button."""

import pytest

from designs import document
from frontend.modules import Modules


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ({"length": "steps", "time": "s"}, "Lower the slew speed to 12,000 steps/s and the jerk to 400,000 steps/s³"),
        # 200 · 16 steps/rev, 8 mm/rev: 12,000 / 3200 = 3.75 rev/s = 30 mm/s; 400,000 / 400 = 1,000 mm/s³.
        ({"length": "mm", "time": "s"}, "Lower the slew speed to 30 mm/s and the jerk to 1,000 mm/s³"),
        ({"length": "rev", "time": "min"}, "Lower the slew speed to 225 rev/min and the jerk to 27,000,000 rev/min³"),
    ],
)
def test_a_remedy_is_told_in_the_units_that_are_shown(modules: Modules, units: dict[str, str], words: str) -> None:
    axis = {"full_steps_per_rev": 200, "microsteps": 16, "travel_per_rev": 8, "travel_unit": "mm"}
    told = [
        {"text": "12,000 steps/s", "value": 12_000, "unit": "steps/s", "rounding": "down", "axis": None},
        {"text": "400,000 steps/s³", "value": 400_000, "unit": "steps/s³", "rounding": "down", "axis": None},
    ]
    text = "lower the slew speed to 12,000 steps/s and the jerk to 400,000 steps/s³"
    remedy = {"text": text, "changes": [], "told": told}
    assert modules.call("model/told.js", "remedyWords", units, document(axis=axis), remedy) == words


def test_a_remedy_about_something_else_is_told_as_it_is(modules: Modules) -> None:
    remedy = {"text": "raise the supply to 36 V", "changes": []}
    units = {"length": "mm", "time": "s"}
    assert modules.call("model/told.js", "remedyWords", units, document(), remedy) == "Raise the supply to 36 V"
