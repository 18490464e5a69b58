"""A page of the real server in a real browser; what goes wrong unseen in it fails the test."""

import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, Request, expect, sync_playwright

from browser.server import CHROMIUM, CHROMIUM_ARGUMENTS, Server
from browser.stepramp_page import GUIDE_CLOSED, StepRampPage
from tools import require

DESKTOP = (1440, 900)
OUTSIDE = (-9, -9)
"""Where a pointer is over nothing of a page."""
# A route of Playwright's would answer as well, but with one the browser keeps nothing: it fetches all anew.
PORT_FOUND = """const found = location.protocol.startsWith('http') && JSON.parse(sessionStorage.getItem('tests.found'));
if (found) {
    const { fetch } = globalThis;
    globalThis.fetch = async (address, options) => {
        const answer = await fetch(address, options);
        if (!answer.ok || !String(address).endsWith('/api/v1/ports')) return answer;
        const known = await answer.json();
        known.ports.unshift({ ...found, families: known.families.map(({ name }) => name) });
        return Response.json(known);
    };
}"""
"""Adds the port that a tab was told of to those that the server finds."""
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
        self._heard = {"pageerror": self._page_error, "console": self._console, "request": self._request}

    def follow(self, page: Page) -> None:
        """Take note of what happens in a page."""
        for event, heard in self._heard.items():
            page.on(event, heard)  # type: ignore[call-overload]

    def leave(self, page: Page) -> None:
        """Let a page do as it likes from here on."""
        for event, heard in self._heard.items():
            page.remove_listener(event, heard)

    def _page_error(self, error: object) -> None:
        self.errors.append(f"page error: {error}")

    def _console(self, message: ConsoleMessage) -> None:
        url = message.location["url"]
        # A device was let go of while it was on its way, or what moved it again came before its trace was read.
        is_late = (url.endswith(("/preview", "/trace", "/backups")) and "404" in message.text) or (
            url.endswith(("/trace", "/backups")) and "409" in message.text
        )
        if message.type == "error" and not is_late:
            self.errors.append(f"{message.text} {url}")

    def _request(self, request: Request) -> None:
        url = request.url
        if not url.startswith((self.base_url, "data:", "blob:")):
            self.elsewhere.append(url)

    def check(self) -> None:
        """Fail for everything that was not expected."""
        unexpected = [text for text in self.errors if not any(re.search(one, text) for one in self.expected)]
        assert unexpected == []
        assert self.elsewhere == []

    def forget(self) -> None:
        """Begin anew, for the next test of the same page."""
        for noted in (self.expected, self.errors, self.elsewhere):
            noted.clear()


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


class Tabs:
    """Tabs of one browser that has kept nothing: a page comes twice as quickly into one that had a page before.

    One at most is kept for that, and none beside one in use: what is behind another tab goes slowly.
    """

    def __init__(self, context: BrowserContext, url: str) -> None:
        self._context, self._url = context, url
        self._free: Page | None = None
        self._used: list[Page] = []

    def take(self, watch: Watch, size: tuple[int, int] = DESKTOP, theme: str = "dark") -> Page:
        """Return an empty tab at the server's address, in which the guide is closed."""
        page, self._free = self._free, None
        if page is None:
            page = new_page(self._context, watch, size, theme)
            page.add_init_script(GUIDE_CLOSED)
            page.add_init_script(PORT_FOUND)
            page.goto(f"{self._url}favicon.svg")
        else:
            make_ready(page, watch, size, theme)
            page.bring_to_front()
        self._used.append(page)
        return page

    def give_back(self, page: Page, watch: Watch) -> None:
        """Empty a tab of its page and of all that was set for it; one that was closed meanwhile is gone."""
        watch.leave(page)
        self._used = [one for one in self._used if one is not page and not one.is_closed()]
        if self._used:
            page.close()
            self._used[-1].bring_to_front()
        elif not page.is_closed():
            page.unroute_all()
            page.mouse.up()
            page.goto(f"{self._url}favicon.svg")
            page.evaluate("sessionStorage.clear()")
            page.mouse.move(*OUTSIDE)
            page.emulate_media(media="null", color_scheme="null", forced_colors="null", reduced_motion="null")
            self._free = page


@pytest.fixture(scope="session")
def tabs(context: BrowserContext, shared_server: Server) -> Tabs:
    return Tabs(context, shared_server.url)


@pytest.fixture
def open_page(tabs: Tabs, server: Server, watch: Watch) -> Iterator[Callable[..., StepRampPage]]:
    """Return a function that opens the page as if the browser had never seen it.

    prepare: what is done with the empty tab before, such as routes that answer for the server.
    """

    pages: list[Page] = []

    def opened(
        size: tuple[int, int] = DESKTOP, theme: str = "dark", prepare: Callable[[Page], None] = lambda _: None
    ) -> StepRampPage:
        page = tabs.take(watch, size, theme)
        pages.append(page)
        prepare(page)
        return StepRampPage(page, server.url).load()

    yield opened
    for page in pages:
        tabs.give_back(page, watch)


def finding(port: str, name: str) -> Callable[[Page], None]:
    """Return what lets a page find a port of any family, and the virtual one."""
    found = {"port": port, "name": name, "virtual": False}
    return lambda page: page.evaluate("(found) => sessionStorage.setItem('tests.found', JSON.stringify(found))", found)


@pytest.fixture(scope="module")
def module_watch(shared_server: Server) -> Iterator[Watch]:
    watched = Watch(shared_server.url)
    yield watched
    watched.check()


@pytest.fixture(scope="module")
def module_page(tabs: Tabs, shared_server: Server, module_watch: Watch) -> Iterator[StepRampPage]:
    """Return one page for all tests of a module that start over instead of loading it again."""
    page = tabs.take(module_watch)
    yield StepRampPage(page, shared_server.url).load()
    tabs.give_back(page, module_watch)


@pytest.fixture
def shared_watch(module_watch: Watch, server: Server) -> Iterator[Watch]:
    """Watch the module's page, and any other, for one test: it alone expects what it expects."""
    del server  # it lets go of devices after each test
    yield module_watch
    try:
        module_watch.check()
    finally:
        module_watch.forget()


@pytest.fixture
def shared_page(module_page: StepRampPage, shared_watch: Watch) -> Iterator[StepRampPage]:
    """Return the module's page as it was at first.

    It starts over at a test's end: what is refused late is still that test's own, which expects it.
    """
    del shared_watch
    yield module_page
    module_page.start_over()


def new_page(context: BrowserContext, watch: Watch, size: tuple[int, int] = DESKTOP, theme: str = "dark") -> Page:
    """Return an empty tab of a browser that has kept nothing."""
    page = context.new_page()
    # Never a dialog of the system: it is asked for here, before anything can open one.
    page.on("filechooser", lambda _: None)
    page.set_default_timeout(PATIENCE_MS)
    make_ready(page, watch, size, theme)
    return page


def make_ready(page: Page, watch: Watch, size: tuple[int, int], theme: str) -> None:
    """Let an empty tab look as it is wanted, and the browser have kept nothing."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.emulate_media(color_scheme=theme)
    page.context.pages[0].evaluate("localStorage.clear()")
    watch.follow(page)


@pytest.fixture
def stepramp(open_page: Callable[..., StepRampPage]) -> StepRampPage:
    return open_page()
