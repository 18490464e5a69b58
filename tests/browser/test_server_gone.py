"""The server ends and comes back."""

import re

from playwright.sync_api import Browser, expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import SLEW_SPEED, StepRampPage, until

GONE = r"ERR_CONNECTION|WebSocket connection|ERR_INCOMPLETE"


def test_the_page_says_so_and_goes_on_when_it_is_back(browser: Browser) -> None:
    with Server() as server:
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        page = context.new_page()
        watch = Watch(server.url)
        watch.expected.append(GONE)
        watch.follow(page)
        stepramp = StepRampPage(page, server.url).open()
        expect(page.locator("#server-state")).to_have_text("server connected")
        server.stop()
        expect(page.locator("#server-state")).to_contain_text("Server gone")
        expect(page.locator("#connect")).to_be_disabled()
        stepramp.field(SLEW_SPEED).fill("700")
        page.locator("#stop").click()
        expect(page.locator("#stop-failure")).to_contain_text("Not delivered")
        server.start()
        expect(page.locator("#server-state")).to_have_text("server connected")
        until(lambda: "of 700 asked for" in stepramp.figure_text("peak"))
        # The server that is back knows of no device: only the answer to a STOP says that one got through.
        expect(page.locator("#stop-failure")).to_contain_text("Not delivered")
        page.locator("#stop").click()
        expect(page.locator("#stop-failure")).to_be_hidden()
        # A server just started has a virtual controller that was never given a ramp.
        stepramp.connect()
        expect(page.locator("#move-reason")).to_have_text("Push a ramp first.")
        expect(page.locator("#move")).to_be_disabled()
        context.close()
        watch.check()


def test_a_server_that_hangs_is_silent_and_what_it_told_is_old(browser: Browser) -> None:
    with Server() as server:
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        page = context.new_page()
        watch = Watch(server.url)
        watch.follow(page)
        stepramp = StepRampPage(page, server.url).open()
        stepramp.connect()
        stepramp.push()
        stepramp.move("1000000")
        expect(page.locator("#device-pill")).to_contain_text("moving")
        expect(page.locator("#old-state")).to_be_hidden()
        with server.hung():
            expect(page.locator("#server-state")).to_have_text("Server silent: what is shown is old")
            expect(page.locator("#device-pill")).to_contain_text("was moving")
            expect(page.locator("#old-state")).to_be_visible()
            expect(page.locator("#move-reason")).to_have_text("The server is silent.")
            expect(page.locator("#stop")).to_be_enabled()
            page.locator("#stop").click()
            expect(page.locator("#stop-failure")).to_contain_text("Not answered yet")
            expect(page.locator("#old-state")).to_have_text(re.compile(r"this is how it was \d+ s ago"))
            expect(page.locator("#stop")).to_contain_text("STOP")
        expect(page.locator("#server-state")).to_have_text("server connected")
        expect(page.locator("#device-pill")).to_contain_text("ready")
        expect(page.locator("#device-pill")).not_to_contain_text("was")
        expect(page.locator("#old-state")).to_be_hidden()
        expect(page.locator("#stop-failure")).to_be_hidden()
        assert 0 < stepramp.devices()[0]["position_steps"] < 1_000_000
        context.close()
        watch.check()
