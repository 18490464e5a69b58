"""What was asked for before a STOP moves nothing afterwards, wherever on its way the STOP finds it."""

from __future__ import annotations

import os
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from playwright.sync_api import APIResponse, BrowserContext, Page, Request, Route, expect

from browser.conftest import Watch, new_page
from browser.stepramp_page import FOLDER, StepRampPage, until

FAR = "1000000"
MOTIONS = ("move", "run", "line", "there_and_back", "zero")
EXPECTED = r"status of 409|ERR_FAILED"
LISTEN = """() => { const told = document.querySelector('#announcements'); window.heard = [];
    window.listening?.disconnect();
    window.listening = new MutationObserver(() => window.heard.push(told.textContent));
    window.listening.observe(told, {childList: true}); }"""
"""Keeps all that is announced from now on: the next announcement takes the place of the last."""
CONNECTIONS = 6
"""That a browser has to one server, for all its tabs together."""


def ask_to_move(page: StepRampPage, kind: str) -> None:
    page.device_section("move")
    page.page.locator(f'.panel.device .segmented [data-value="{kind}"]').click()
    for field in page.page.locator("#move-steps:visible, .line-axis:visible input").all():
        field.fill(FAR)
    page.page.locator("#move").click()


def jog_section(page: StepRampPage, button: str) -> None:
    page.device_section("jog")
    page.page.locator(button).click()


CHAINS: dict[str, tuple[str, Callable[[StepRampPage], None]]] = {
    "move": ("#move", lambda page: ask_to_move(page, "by")),
    "run": ("#run-ahead", lambda page: jog_section(page, "#run-ahead")),
    "line": ("#move", lambda page: ask_to_move(page, "line")),
    "there_and_back": ("#move", lambda page: ask_to_move(page, "back")),
    "zero": ("#zero", lambda page: jog_section(page, "#zero")),
}
"""What is pressed to ask for each, and how."""


class Line:
    """The way from the page to the server, on which requests are held: before they arrive, or their answers."""

    def __init__(self, page: StepRampPage) -> None:
        self.page = page
        self.motions: list[str] = []
        self.held: list[tuple[Route, APIResponse | None]] = []
        page.page.on("request", self._sent)

    def _sent(self, request: Request) -> None:
        what = request.url.rpartition("/")[2]
        if request.method == "POST" and what in MOTIONS:
            self.motions.append(what)

    @contextmanager
    def holding(self, what: str, *, is_answered: bool) -> Iterator[None]:
        """Hold what is asked first on a route of the device, or the answer to it."""

        def hold(route: Route) -> None:
            if route.request.method == "GET" or self.held:
                route.continue_()
            else:
                self.held.append((route, route.fetch() if is_answered else None))

        self.page.page.route(f"**/api/v1/devices/*/{what}", hold)
        yield
        self.page.page.unroute(f"**/api/v1/devices/*/{what}", hold)

    def wait(self) -> None:
        """Wait until something is held."""
        # A look at the page lets what it sends come to be known here.
        until(lambda: [self.page.page.title(), *self.held][1:])

    def release(self) -> int:
        """Let what is held go on, and return the status that it is answered with."""
        [(route, answered)] = self.held
        answer = answered or route.fetch()
        route.fulfill(response=answer)
        return answer.status

    def close(self) -> None:
        self.page.page.remove_listener("request", self._sent)


@pytest.fixture(scope="module")
def pushed(module_page: StepRampPage, module_watch: Watch) -> Iterator[StepRampPage]:
    """Return the page in control of a device of two axes, which turn: only such are zeroed as gauges."""
    module_watch.expected.append(EXPECTED)
    module_page.page.get_by_label("Travel unit").select_option("deg")
    module_page.page.get_by_role("button", name="Add an axis").click()
    module_page.connect()
    module_page.push()
    yield module_page
    module_page.release_devices(module_page.url)


@pytest.fixture
def line(pushed: StepRampPage) -> Iterator[Line]:
    made = Line(pushed)
    yield made
    made.close()
    pushed.page.unroute_all()
    stop_and_wait(pushed.page, pushed)


def device_of(page: StepRampPage) -> Any:
    return next(device for device in page.devices() if device["port"] == "sim://")


def stop_and_wait(page: Page, pushed: StepRampPage) -> None:
    """Press Escape, and wait until the stop is answered and nothing moves.

    That the server has granted it isn't enough: what is asked for until the page knows of it is refused, rightly.
    """
    before = device_of(pushed)["stops"]
    page.evaluate(LISTEN)
    page.keyboard.press("Escape")
    until(lambda: device_of(pushed)["stops"] > before and device_of(pushed)["state"] == "ready")
    until(lambda: page.evaluate("heard.some((text) => /Nothing moves|Stopping|Halted/.test(text))"))


def check_at_rest(page: StepRampPage, button: str) -> None:
    """Nothing is under way, on the page or at the device, and nothing is said to be wrong."""
    expect(page.page.locator(button)).to_be_enabled()
    device = device_of(page)
    assert (device["state"], device["shuttle"]) == ("ready", None)
    assert all(axis["position_steps"] == axis["target_steps"] for axis in device["axes"])
    assert [text for text in page.page.locator("#device .problem").all_inner_texts() if text] == []


@pytest.mark.parametrize("place", ["before the trace", "after the trace", "before the motion", "after the motion"])
@pytest.mark.parametrize("chain", CHAINS)
def test_a_stop_ends_what_is_on_its_way(pushed: StepRampPage, line: Line, chain: str, place: str) -> None:
    button, press = CHAINS[chain]
    is_trace, is_answered = place.endswith("trace"), place.startswith("after")
    before = [axis["position_steps"] for axis in device_of(pushed)["axes"]]
    with line.holding("trace" if is_trace else chain, is_answered=is_answered):
        press(pushed)
        line.wait()
        assert line.motions == ([] if is_trace else [chain])
        stop_and_wait(pushed.page, pushed)
        line.motions.clear()
        status = line.release()
        check_at_rest(pushed, button)
        assert line.motions == []
    if place == "before the motion":
        assert status == 409, "it carries what its gesture knew"
    if place != "after the motion":
        assert [axis["position_steps"] for axis in device_of(pushed)["axes"]] == before


def test_new_gestures_work_as_soon_as_a_stop_is_answered(pushed: StepRampPage, line: Line) -> None:
    with line.holding("trace", is_answered=True):
        ask_to_move(pushed, "by")
        line.wait()
        stop_and_wait(pushed.page, pushed)
        start = device_of(pushed)["position_steps"]
        pushed.move("5")
        # Looks at the page let go on what it sends on the route where the first is held.
        until(lambda: [pushed.page.title(), device_of(pushed)["position_steps"]][1] == start + 5)
        line.release()
        check_at_rest(pushed, "#move")
    assert device_of(pushed)["position_steps"] == start + 5


def test_a_stop_in_one_tab_ends_what_another_has_on_its_way(
    context: BrowserContext, pushed: StepRampPage, line: Line, module_watch: Watch
) -> None:
    other = StepRampPage(new_page(context, module_watch), pushed.url).open()
    before = device_of(pushed)["position_steps"]
    with line.holding("trace", is_answered=True):
        ask_to_move(pushed, "by")
        line.wait()
        stop_and_wait(other.page, pushed)
        line.release()
        expect(pushed.page.locator("#device .problem").first).to_contain_text("A stop came first")
    assert (device_of(pushed)["state"], device_of(pushed)["position_steps"]) == ("ready", before)
    other.page.close()
    pushed.move("5")
    until(lambda: device_of(pushed)["position_steps"] == before + 5)


def test_a_look_at_the_trace_that_a_stop_refuses_is_taken_again(pushed: StepRampPage, line: Line) -> None:
    del line
    refusals: list[Route] = []

    def refuse_once(route: Route) -> None:
        if route.request.method == "GET" and not refusals:
            refusals.append(route)
            sentence = {"field": None, "value": None, "allowed": None, "message": "A stop came first."}
            route.fulfill(status=409, json={"errors": [sentence]})
        else:
            route.continue_()

    pushed.page.route("**/api/v1/devices/*/trace", refuse_once)
    pushed.move("123")
    pushed.device_section("trace")
    expect(pushed.page.locator("#trace-figures")).to_contain_text("123, every one")
    assert refusals
    check_at_rest(pushed, "#connect")


MUTE = """() => { const send = WebSocket.prototype.send; window.unmute = () => { WebSocket.prototype.send = send; };
    WebSocket.prototype.send = function (text) { if (!/"do":"(stop|halt)"/.test(text)) send.call(this, text); }; }"""
"""Lets no stop out over WebSockets, and doesn't say so."""
BREAK = MUTE.replace("send.call(this, text); }", "send.call(this, text); else throw new Error('broken'); }")
"""Has every stop over WebSockets fail at once."""


def test_a_stop_that_fails_revives_nothing(pushed: StepRampPage, line: Line) -> None:
    page = pushed.page
    before = device_of(pushed)["position_steps"]
    page.evaluate(BREAK)
    page.route("**/api/v1/devices/stop", lambda route: route.abort())
    with line.holding("trace", is_answered=True):
        ask_to_move(pushed, "by")
        line.wait()
        page.keyboard.press("Escape")
        expect(page.locator("#stop-failure")).to_contain_text("Not delivered")
        line.release()
        check_at_rest(pushed, "#move")
    assert line.motions == []
    assert device_of(pushed)["position_steps"] == before
    page.evaluate("() => window.unmute()")
    page.keyboard.press("Escape")
    expect(page.locator(".summary-messages")).to_be_hidden()


HOLD_JOGS = """() => { const Real = WebSocket; window.opened = []; window.said = [];
    window.letJogs = () => { window.WebSocket = Real; };
    window.WebSocket = class extends Real {
        set onopen(act) { super.onopen = () => this.url.includes('/jog') ? window.opened.push(act) : act(); }
        send(text) { if (this.url.includes('/jog')) window.said.push(JSON.parse(text)); super.send(text); }
    }; }"""
"""Lets the page learn only when the test says so that the socket of a jog is open."""


@contextmanager
def opening_a_jog(page: Page) -> Iterator[None]:
    page.evaluate(HOLD_JOGS)
    page.locator('#device-sections [data-value="jog"]').click()
    page.locator("#jog-right").hover()
    page.mouse.down()
    until(lambda: page.evaluate("() => window.opened.length"))
    yield
    page.mouse.up()
    page.evaluate("() => window.letJogs()")


@pytest.mark.parametrize("way", ["Escape", "button"])
def test_a_jog_that_is_being_opened_does_not_begin_after_a_stop(pushed: StepRampPage, line: Line, way: str) -> None:
    del line
    page, before = pushed.page, device_of(pushed)["position_steps"]
    with opening_a_jog(page):
        # A second finger presses the button: no pointer leaves the one that is held.
        page.evaluate("() => document.querySelector('#stop').click()") if way == "button" else page.keyboard.press(way)
        page.evaluate("() => window.opened[0]()")
        assert page.evaluate("() => window.said.map((one) => one.do)") in ([], ["end"])
    assert (device_of(pushed)["state"], device_of(pushed)["position_steps"]) == ("ready", before)


def test_a_stop_elsewhere_ends_a_jog_that_is_being_opened(pushed: StepRampPage, line: Line) -> None:
    del line
    page, before = pushed.page, device_of(pushed)["position_steps"]
    with opening_a_jog(page):
        pushed.ask(pushed.url, "POST", "devices/stop")
        page.evaluate("() => window.opened[0]()")
        expect(page.locator("#device .problem").first).to_contain_text("A stop came first")
    assert (device_of(pushed)["state"], device_of(pushed)["position_steps"]) == ("ready", before)


class Silence:
    """A port where nobody answers: to connect to it takes seconds, until the cable is pulled."""

    def __init__(self) -> None:
        self._far_end, near_end = os.openpty()
        tty.setraw(near_end)
        self.port = os.ttyname(near_end)
        os.close(near_end)

    def pull(self) -> None:
        os.close(self._far_end)


@contextmanager
def requests_under_way(pages: list[Page], ask: str, times: int) -> Iterator[None]:
    """Have each page ask so many times for what takes seconds; it is still under way at the end."""
    silence = Silence()
    script = f"""([port, times]) => {{ window.answered = 0; const ask = {ask};
        for (let time = 0; time < times; time += 1) ask(port).finally(() => {{ window.answered += 1; }}); }}"""
    for page in pages:
        page.evaluate(script, [silence.port, times])
    yield
    assert [page.evaluate("() => window.answered") for page in pages] == [0] * len(pages)
    silence.pull()
    until(lambda: all(page.evaluate("() => window.answered") == times for page in pages))


def begin_far(pushed: StepRampPage) -> None:
    pushed.move(FAR)
    until(lambda: device_of(pushed)["state"] == "moving")
    expect(pushed.state).to_have_text("moving")


def test_a_stop_waits_for_no_request_of_other_tabs(
    context: BrowserContext, pushed: StepRampPage, line: Line, module_watch: Watch
) -> None:
    del line
    # The tab of a mere picture looks for an icon.
    module_watch.expected.append(r"status of (404|502)")
    begin_far(pushed)
    tabs = [new_page(context, module_watch) for _ in range(3)]
    for tab in tabs:
        tab.goto(f"{pushed.url}favicon.svg")
    connect = """(port) => fetch('/api/v1/devices', {method: 'POST', headers: {'Content-Type': 'application/json'},
        body: JSON.stringify({port})})"""
    with requests_under_way(tabs, connect, CONNECTIONS // len(tabs)):
        until(lambda: len(pushed.devices()) == 2)
        stop_and_wait(pushed.page, pushed)
    for tab in tabs:
        tab.close()


def test_a_stop_as_a_request_waits_for_no_other_of_its_page(
    pushed: StepRampPage, line: Line, module_watch: Watch
) -> None:
    del line
    module_watch.expected.append(r"status of 502")
    page = pushed.page
    begin_far(pushed)
    page.evaluate(MUTE)
    connect = f"(port) => import({FOLDER} + 'server/api.js').then(({{api}}) => api.connect(port)).catch(() => null)"
    with requests_under_way([page], connect, 2 * CONNECTIONS):
        until(lambda: len(pushed.devices()) == 2)
        stop_and_wait(page, pushed)
    page.evaluate("() => window.unmute()")
