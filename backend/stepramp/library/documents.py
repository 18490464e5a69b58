"""What was measured, computed or reported: any document that can be told back as it came, quickly."""

import math
from typing import Any

from stepramp.errors import Count
from stepramp.validation import refuse

DEEPEST = 32
"""Levels of objects and lists in each other: what StepRamp answers has five at most."""
LARGEST = 2**63
"""No whole number of StepRamp's is as large. To write thousands of digits takes long, and keeps a STOP waiting."""


def tellable(document: dict[str, Any]) -> dict[str, Any]:
    """Return a document that can be told back as it came; ValueError as validation has it for another."""
    level: list[object] = [document]
    for _ in range(DEEPEST):
        below: list[object] = []
        for each in level:
            below.extend(each.values() if isinstance(each, dict) else each if isinstance(each, list) else ())
            if isinstance(each, float) and not math.isfinite(each):
                refuse("", each, "a document whose numbers are finite")
            if isinstance(each, int) and not -LARGEST <= each < LARGEST:
                refuse("", Count("one with a longer one"), "a document whose whole numbers have up to 64 bits")
        level = below
    if level:
        refuse("", Count("one nested more deeply"), f"a document of up to {DEEPEST} levels")
    return document
