"""The device panel where there are several families: one is chosen, and only what a device can do is offered."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Page, Route, WebSocketRoute, expect

from browser.conftest import Watch
from browser.stepramp_page import StepRampPage
from stepramp.controllers.families import FAMILIES

REFUSED = r"status of 422"


@pytest.fixture
def several(open_page: Callable[..., StepRampPage]) -> Iterator[StepRampPage]:
    """Return a page that hears of one more family than there is, and of devices that can do no more than all can."""

    def told(route: Route) -> None:
        answer = route.fetch()
        known = answer.json()
        known["families"].append({"name": "plain", "title": "Plain", "capabilities": []})
        for port in known["ports"]:
            port["families"] = [family["name"] for family in known["families"]]
        route.fulfill(response=answer, json=known)

    def heard(socket: WebSocketRoute) -> None:
        def pass_on(message: str | bytes) -> None:
            news = json.loads(message)
            for device in news.get("devices", []):
                device["capabilities"] = []
            socket.send(json.dumps(news))

        socket.connect_to_server().on_message(pass_on)

    def prepare(page: Page) -> None:
        page.route("**/api/v1/ports", told)
        page.route_web_socket(re.compile(r"/devices/events"), heard)

    stepramp = open_page(prepare=prepare)
    yield stepramp
    stepramp.page.close()  # No other page may hear this.


def test_the_family_of_a_controller_is_chosen_where_there_are_several(several: StepRampPage, watch: Watch) -> None:
    several.show_panel("device")
    family = several.page.locator("#family")
    expect(family.locator("option")).to_have_text([*(each.title for each in FAMILIES.values()), "Plain"])
    watch.expected.append(REFUSED)
    family.select_option("plain")
    several.page.locator("#connect").click()
    expect(several.page.locator("#device .problem").first).to_contain_text("family is 'plain'; allowed: stepramp")
    assert several.devices() == []
    family.select_option("stepramp")
    several.connect()
    expect(family).to_be_disabled()
    expect(family).to_have_value("stepramp")


def test_a_port_of_another_machine_is_chosen_from_the_list_and_refused_once_it_is_not_named_any_more(
    open_page: Callable[..., StepRampPage], watch: Watch
) -> None:
    """The list is from before the server was started anew without it."""

    def told(route: Route) -> None:
        answer = route.fetch()
        known = answer.json()
        families = [family["name"] for family in known["families"]]
        far_away = {"port": "rfc2217://shop.local:2217", "name": "shop.local:2217 on the network, RFC 2217"}
        known["ports"].insert(0, far_away | {"virtual": False, "families": families})
        route.fulfill(response=answer, json=known)

    stepramp = open_page(prepare=lambda page: page.route("**/api/v1/ports", told))
    stepramp.show_panel("device")
    watch.expected.append(REFUSED)
    stepramp.page.locator("#port").select_option(label="shop.local:2217 on the network, RFC 2217")
    stepramp.page.locator("#connect").click()
    problem = stepramp.page.locator("#device .problem").first
    expect(problem).to_contain_text("port is 'rfc2217://shop.local:2217'; allowed:")
    expect(problem).to_contain_text("only hosts named at start by --allow-remote-port: none was named")
    assert stepramp.devices() == []


def test_one_family_needs_no_choice(open_page: Callable[..., StepRampPage]) -> None:
    def told(route: Route) -> None:
        answer = route.fetch()
        known = answer.json()
        del known["families"][1:]
        route.fulfill(response=answer, json=known)

    stepramp = open_page(prepare=lambda page: page.route("**/api/v1/ports", told))
    stepramp.show_panel("device")
    expect(stepramp.page.locator("#port")).to_be_visible()
    expect(stepramp.page.locator("#family")).to_be_hidden()


def test_what_a_device_cant_do_is_not_offered(several: StepRampPage) -> None:
    page = several.page
    several.connect()
    for button in ("#try", "#restore", "#keep-ramp", "#roll-back"):
        expect(page.locator(button)).to_be_hidden()
    several.device_section("jog")
    expect(page.locator("#run-ahead")).to_be_visible()
    expect(page.locator("#zero")).to_be_hidden()
    several.device_section("trace")
    expect(page.locator("#trace")).to_be_disabled()
    expect(page.locator("#trace-note")).to_have_text("This controller can’t tell when it made its steps.")
    page.locator("#settings").click()
    expect(page.locator("#settings-dialog")).to_be_visible()
    expect(page.locator("#pin-settings")).to_be_hidden()
