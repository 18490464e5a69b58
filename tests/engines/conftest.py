"""One browser of each kind, and one server, for all that is tried in them."""

from collections.abc import Iterator

import pytest

from browser.server import Server
from browser.stepramp_page import StepRampPage
from engines import firefox, webkit
from engines.engine import Engine, missing
from engines.page import EnginePage
from tools import require


@pytest.fixture(scope="session", params=["firefox", "webkit"])
def engine(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    if request.param == "firefox":
        require(*missing(*firefox.PROGRAMS))
        with firefox.firefox(tmp_path_factory.mktemp("profile")) as started:
            yield started
    else:
        require(*missing(*webkit.PROGRAMS))
        with webkit.webkit() as started:
            yield started


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    with Server() as started:
        yield started


@pytest.fixture
def expected_errors() -> list[str]:
    """Return the list for what a test makes the page report."""
    return []


@pytest.fixture
def page(engine: Engine, server: Server, expected_errors: list[str]) -> Iterator[EnginePage]:
    """Open the page as new; what it reports fails the test, and what was left connected is let go of."""
    opened = EnginePage(engine, server.url)
    opened.open()
    yield opened
    StepRampPage.release_devices(server.url)
    assert [text for text in engine.errors() if not any(one in text for one in expected_errors)] == []
