"""A page of the real server in a real browser; what goes wrong unseen in it fails the test."""

import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, Route, expect, sync_playwright

from browser.server import CHROMIUM, CHROMIUM_ARGUMENTS, Server
from browser.stepramp_page import StepRampPage
from tools import require

DESKTOP = (1440, 900)
# A machine that is busy is slow, not wrong.
PATIENCE_MS = 60_000
expect.set_options(timeout=PATIENCE_MS)


class Watch:
    """What must not happen in a page: errors, and requests to anywhere but the server."""

    def __init__(self, base_url: str) -> None:
        self.base_url = base_url
        self.expected: list[str] = []
        self.errors: list[str] = []
        self.elsewhere: list[str] = []

    def follow(self, page: Page) -> None:
        """Take note of what happens in a page."""
        page.on("pageerror", lambda error: self.errors.append(f"page error: {error}"))
        page.on("console", self._console)
        page.on("request", lambda request: self._request(request.url))

    def _console(self, message: ConsoleMessage) -> None:
        url = message.location["url"]
        # A device was let go of while it was on its way, or what moved it again came before its trace was read.
        is_late = (url.endswith("/preview") and "404" in message.text) or (
            url.endswith(("/trace", "/backups")) and "409" in message.text
        )
        if message.type == "error" and not is_late:
            self.errors.append(f"{message.text} {url}")

    def _request(self, url: str) -> None:
        if not url.startswith((self.base_url, "data:", "blob:")):
            self.elsewhere.append(url)

    def check(self) -> None:
        """Fail for everything that was not expected."""
        unexpected = [text for text in self.errors if not any(re.search(one, text) for one in self.expected)]
        assert unexpected == []
        assert self.elsewhere == []


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    require(*([] if CHROMIUM.exists() else [str(CHROMIUM)]))
    with sync_playwright() as playwright:
        arguments = [*CHROMIUM_ARGUMENTS, "--process-per-site"]
        launched = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield launched
        launched.close()


@pytest.fixture(scope="session")
def shared_server(browser: Browser) -> Iterator[Server]:
    """Start one server for all tests that don't end it; only where there is a browser to use it."""
    del browser
    with Server() as server:
        yield server


@pytest.fixture
def server(shared_server: Server) -> Iterator[Server]:
    """Return the server; whatever a test left connected is stopped and let go of."""
    yield shared_server
    StepRampPage.release_devices(shared_server.url)


@pytest.fixture
def watch(server: Server) -> Iterator[Watch]:
    watched = Watch(server.url)
    yield watched
    watched.check()


@pytest.fixture(scope="session")
def context(browser: Browser, shared_server: Server) -> Iterator[BrowserContext]:
    """Return one browser profile for all pages, and one process, so that Plotly is compiled once."""
    made = browser.new_context(base_url=shared_server.url)
    # The process lives for as long as one of its pages does; what the browser keeps is cleared from this one.
    made.new_page().goto(f"{shared_server.url}favicon.svg")
    yield made
    made.close()


@pytest.fixture
def open_page(context: BrowserContext, server: Server, watch: Watch) -> Iterator[Callable[..., StepRampPage]]:
    """Return a function that opens the page as if the browser had never seen it.

    prepare: what is done with the empty tab before, such as routes that answer for the server.
    """

    pages: list[Page] = []

    def opened(
        size: tuple[int, int] = DESKTOP, theme: str = "dark", prepare: Callable[[Page], None] = lambda _: None
    ) -> StepRampPage:
        page = new_page(context, watch, size, theme)
        pages.append(page)
        prepare(page)
        return StepRampPage(page, server.url).open()

    yield opened
    for page in pages:
        page.close()


def finding(port: str, name: str) -> Callable[[Page], None]:
    """Return what lets a page find a port of any family, and the virtual one."""

    def told(route: Route) -> None:
        answer = route.fetch(max_retries=2)  # a connection that was kept may just have been closed
        known = answer.json()
        others = [family["name"] for family in known["families"]]
        known["ports"].insert(0, {"port": port, "name": name, "virtual": False, "families": others})
        route.fulfill(response=answer, json=known)

    return lambda page: page.route("**/api/v1/ports", told)


@pytest.fixture(scope="module")
def module_watch(shared_server: Server) -> Iterator[Watch]:
    watched = Watch(shared_server.url)
    yield watched
    watched.check()


@pytest.fixture(scope="module")
def module_page(context: BrowserContext, shared_server: Server, module_watch: Watch) -> Iterator[StepRampPage]:
    """Return one page for all tests of a module that start over instead of loading it again."""
    page = new_page(context, module_watch)
    yield StepRampPage(page, shared_server.url).open()
    page.close()


def new_page(context: BrowserContext, watch: Watch, size: tuple[int, int] = DESKTOP, theme: str = "dark") -> Page:
    """Return an empty tab of a browser that has kept nothing."""
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.emulate_media(color_scheme=theme)
    context.pages[0].evaluate("localStorage.clear()")
    # Never a dialog of the system: it is asked for here, before anything can open one.
    page.on("filechooser", lambda _: None)
    watch.follow(page)
    return page


@pytest.fixture
def stepramp(open_page: Callable[..., StepRampPage]) -> StepRampPage:
    return open_page()
