"""Jogging: an axis runs only as long as somebody says, again and again, that it shall."""

import threading
from time import monotonic

LEASE_S = 0.4
"""How long an axis runs on without being told so again [s]: a few renewals may be late, a finger never is."""


class JogLease:
    """What a jog lives on, for any thread. Once it has run out or was ended, nothing brings it back."""

    def __init__(self, axis: int) -> None:
        self.axis = axis
        self._lock = threading.Lock()
        self._until_s = monotonic() + LEASE_S

    @property
    def holds(self) -> bool:
        """Whether it has neither run out nor been ended."""
        with self._lock:
            return monotonic() < self._until_s

    def renew(self) -> bool:
        """Let it last a while longer; return whether it still held."""
        with self._lock:
            held = monotonic() < self._until_s
            if held:
                self._until_s = monotonic() + LEASE_S
            return held

    def end(self) -> None:
        """Let it run out now."""
        with self._lock:
            self._until_s = 0.0
