"""What holds for all tests."""

import tempfile
from collections.abc import Iterator

import pytest
from hypothesis import settings

from stepramp.data_folder import FOLDER_VARIABLE, RUNTIME_VARIABLE

# The first example of a test may compile what it tests; and no test judges by the clock.
settings.register_profile("stepramp", deadline=None)
settings.load_profile("stepramp")


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("a real controller")
    group.addoption("--device-port", metavar="PORT", help="test the controller at this serial port, as /dev/ttyACM0")
    group.addoption("--allow-moves", action="store_true", help="its motors may move: a few hundred steps and back")


@pytest.fixture(autouse=True, scope="session")
def _data_of_nobody() -> Iterator[None]:
    """Keep what outlasts the program, also of servers that tests start, out of anybody's home."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setenv(FOLDER_VARIABLE, folder)
        patch.setenv(RUNTIME_VARIABLE, folder)
        yield
