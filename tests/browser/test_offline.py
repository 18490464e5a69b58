"""Beside a machine there is often no network: everything works with all requests but those to the server refused."""

import re

from playwright.sync_api import Browser, Route, expect

from browser.server import Server
from browser.stepramp_page import SLEW_SPEED, StepRampPage, until


def test_everything_works_with_all_requests_elsewhere_refused(browser: Browser, server: Server) -> None:
    refused: list[str] = []

    def refuse(route: Route) -> None:
        refused.append(route.request.url)
        route.abort("internetdisconnected")

    context = browser.new_context()
    context.route(re.compile(rf"^(?!{re.escape(server.url)}|data:|blob:)"), refuse)
    page = context.new_page()
    stepramp = StepRampPage(page, server.url).open()
    stepramp.edit_and_wait(SLEW_SPEED, "900")
    page.get_by_role("button", name="Export", exact=True).click()
    for kind in ("html", "svg", "c_newton"):
        page.locator(f"#export-dialog label:has(input[value={kind}])").click()
        expect(page.locator("#export-dialog")).to_have_attribute("data-shown", kind)
        expect(page.locator("#export-download")).to_be_enabled()
    page.keyboard.press("Escape")
    stepramp.connect()
    stepramp.push()
    stepramp.move("100")
    until(lambda: stepramp.devices()[0]["position_steps"] == 100)
    page.goto(f"{server.url}docs")
    expect(page.locator(".opblock").first).to_be_visible(timeout=20_000)
    context.close()
    assert refused == []
