from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from browser.server import Server
from browser.stepramp_page import StepRampPage
from browser.table.points import view


@pytest.fixture
def start(module_page: StepRampPage) -> StepRampPage:
    """The lead-screw stage at its start, where every row is apart: a logarithmic step axis."""
    module_page.start_over()
    view(module_page, "start")
    return module_page


@pytest.fixture(scope="module")
def modules(browser: Browser, shared_server: Server) -> Iterator[Page]:
    opened = browser.new_page()
    StepRampPage(opened, shared_server.url).open()
    yield opened
    opened.close()
