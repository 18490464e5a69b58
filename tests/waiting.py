"""Waiting for what comes about by itself: with an end, so that what never does fails."""

import time
from collections.abc import Callable
from typing import Any

PATIENCE_S = 60.0
"""What isn't over by then never ends: no promise, which is measured where nothing else runs (`./dev bench`)."""


def until(condition: Callable[[], Any], within_s: float = PATIENCE_S) -> Any:
    """Wait until a condition holds, and return what it gave.

    Most of the time nothing is asked: what is waited for needs the processor more, on a busy machine above all.
    """
    deadline = time.monotonic() + within_s
    while True:
        began = time.monotonic()
        if found := condition():
            return found
        assert time.monotonic() < deadline, "it did not come about in time"
        time.sleep(max(0.03, 3 * (time.monotonic() - began)))
