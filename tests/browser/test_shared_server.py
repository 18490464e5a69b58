"""A server that several people share: the way in, who looks on and who operates, and who is in control."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect

from browser.server import Server
from browser.stepramp_page import GUIDE_CLOSED, SLEW_SPEED, StepRampPage, until


@dataclass(frozen=True)
class SharedServer:
    url: str
    said: list[str]
    data: Path


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedServer]:
    data = tmp_path_factory.mktemp("data")
    with Server("--require-token", "--data-folder", str(data), lines=3) as server:
        yield SharedServer(server.url, server.said, data)


@pytest.fixture
def people(browser: Browser, shared: SharedServer) -> Iterator[list[BrowserContext]]:
    """Return the browsers of two people."""
    made = [browser.new_context(base_url=shared.url, viewport={"width": 1440, "height": 900}) for _ in range(2)]
    yield made
    for each in made:
        each.close()


def link_of(shared: SharedServer, what: str) -> str:
    [line] = [line for line in shared.said if what in line]
    found = re.search(r"http\S+token=\S+", line)
    assert found is not None
    return found[0]


def audit_log(shared: SharedServer) -> str:
    return "".join(file.read_text() for file in (shared.data / "audit").iterdir())


def opened(person: BrowserContext, address: str) -> StepRampPage:
    page = person.new_page()
    page.add_init_script(GUIDE_CLOSED)
    page.goto(address)
    stepramp = StepRampPage(page, page.url)
    stepramp.wait_for_plots()
    return stepramp


def errors_of(page: Page) -> list[str]:
    told: list[str] = []
    page.on("pageerror", lambda error: told.append(str(error)))
    page.on("console", lambda message: told.append(message.text) if message.type == "error" else None)
    return told


def test_one_operates_and_the_other_looks_on_and_stops(people: list[BrowserContext], shared: SharedServer) -> None:
    operator = opened(people[0], link_of(shared, "to operate"))
    assert operator.page.url == shared.url
    operator.connect()
    operator.push()
    operator.move("100000")
    expect(operator.state).to_have_text("moving")
    onlooker = opened(people[1], link_of(shared, "to look on"))
    told = errors_of(onlooker.page)
    onlooker.show_panel("device")
    expect(onlooker.state).to_have_text("moving")
    expect(onlooker.page.locator("#others")).to_contain_text("Another page, at 127.0.0.1, is in control of it.")
    expect(onlooker.page.locator("#take-over")).to_be_disabled()
    expect(onlooker.page.locator("#connect")).to_be_disabled()
    expect(onlooker.page.locator("#connect")).to_have_attribute("title", "You look on: your link allows no more")
    expect(onlooker.page.locator("#push")).to_be_disabled()
    # It computes all the same.
    onlooker.edit_and_wait("ramp.slew_speed_steps_per_s", "700")
    onlooker.page.locator("#stop").click()
    expect(onlooker.state).to_have_text("ready")
    expect(operator.state).to_have_text("ready")
    assert told == []
    operator.page.locator("#connect").click()
    expect(operator.state).to_have_text("not connected")
    until(lambda: "DELETE" in audit_log(shared))
    text = audit_log(shared)
    assert re.search(r'"role": "operate", .*"asked": "POST /api/v1/devices/1/move", .*"body": .*100000', text)
    assert re.search(r'"role": "view", .*"asked": "(POST|WebSocket) /api/v1/devices/', text)


def test_a_server_that_began_anew_says_that_its_link_is_another(browser: Browser, tmp_path: Path) -> None:
    with Server("--require-token", "--data-folder", str(tmp_path), lines=3) as server:
        context = browser.new_context(base_url=server.url, viewport={"width": 1440, "height": 900})
        there = opened(context, link_of(SharedServer(server.url, server.said, tmp_path), "to operate"))
        state = there.page.locator("#server-state")
        expect(state).to_have_text("server connected")
        server.stop()
        expect(state).to_have_text("Server gone: trying again…")
        server.start()
        expect(state).to_have_text("Server started anew: open the link that it printed")
        expect(there.page.locator("#move-reason")).to_contain_text(
            "knows this page no more, as after a new start: open the link"
        )
        before = there.curves()
        there.field(SLEW_SPEED).fill("777")
        expect(there.page.locator(".stale-note").first).to_be_visible()
        # Whichever page of the browser opens it, all of them are known by it, and what was asked for meanwhile comes.
        opened(context, link_of(SharedServer(server.url, server.said, tmp_path), "to operate"))
        expect(state).to_have_text("server connected")
        until(lambda: there.curves() != before)
        context.close()


def test_the_form_lets_in_who_types_the_token(people: list[BrowserContext], shared: SharedServer) -> None:
    page = people[0].new_page()
    page.add_init_script(GUIDE_CLOSED)
    page.goto(f"{shared.url}#nothing")
    expect(page.get_by_role("heading")).to_have_text("StepRamp")
    page.get_by_label("Token").fill("nonsense")
    page.get_by_role("button", name="Go on").click()
    expect(page.get_by_role("alert")).to_have_text("That is no token of this server, or of an earlier start of it.")
    page.get_by_label("Token").fill(link_of(shared, "to look on").partition("token=")[2])
    page.keyboard.press("Enter")
    expect(page.locator("#connect")).to_be_visible()
    # A link with a design in it opens that, too.
    assert page.url == f"{shared.url}#nothing"
