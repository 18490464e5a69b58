"""Waiting for what comes about by itself: with an end, so that what never does fails."""

import time
from collections.abc import Callable
from typing import Any


def until(condition: Callable[[], Any], within_s: float = 60) -> Any:
    """Wait until a condition holds, and return what it gave."""
    deadline = time.monotonic() + within_s
    while not (found := condition()):
        assert time.monotonic() < deadline, "it did not come about in time"
        time.sleep(0.03)
    return found
