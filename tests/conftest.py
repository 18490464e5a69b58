"""What holds for all tests."""

import pytest
from hypothesis import settings

# The first example of a test may compile what it tests; and no test judges by the clock.
settings.register_profile("stepramp", deadline=None)
settings.load_profile("stepramp")


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("a real controller")
    group.addoption("--device-port", metavar="PORT", help="test the controller at this serial port, as /dev/ttyACM0")
    group.addoption("--allow-moves", action="store_true", help="its motors may move: a few hundred steps and back")
