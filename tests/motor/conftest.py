"""What all tests of motors have."""

import pytest

from motor.clock import Clock
from stepramp.motor import patience


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """Return the clock that searches look at; it stands still."""
    made = Clock()
    monkeypatch.setattr(patience, "time", made)
    return made
