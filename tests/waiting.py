"""Waiting for what comes about by itself: with an end, so that what never does fails."""

import time
from collections.abc import Callable
from typing import Any

PATIENCE_S = 60.0
"""What isn't over by then never ends: no promise, which is measured where nothing else runs (`./dev bench`)."""


def until(condition: Callable[[], Any], within_s: float = PATIENCE_S) -> Any:
    """Wait until a condition holds, and return what it gave."""
    deadline = time.monotonic() + within_s
    while not (found := condition()):
        assert time.monotonic() < deadline, "it did not come about in time"
        time.sleep(0.03)
    return found
