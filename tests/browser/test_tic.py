"""The page with a Pololu Tic behind a pseudo-terminal: connected as one, pushed to, moved, and what hinders that."""

from __future__ import annotations

from playwright.sync_api import Route, expect

from browser.stepramp_page import SLEW_SPEED, StepRampPage, until
from controllers.tic.emulator import TicOnACable


def test_a_tic_at_the_page(stepramp: StepRampPage) -> None:
    with TicOnACable() as cable:

        def told(route: Route) -> None:
            answer = route.fetch()
            known = answer.json()
            known["ports"].insert(0, {"port": cable.port, "name": "A Tic", "virtual": False})
            route.fulfill(response=answer, json=known)

        page = stepramp.page
        page.route("**/api/v1/ports", told)
        stepramp.reload()
        stepramp.show_panel("device")
        page.locator("#port").select_option(cable.port)
        page.locator("#family").select_option("tic")
        page.locator("#connect").click()
        expect(stepramp.state).to_have_text("ready")
        for speed in (900, 800):
            stepramp.edit_and_wait(SLEW_SPEED, str(speed))
            expect(page.locator("#push-preview")).to_contain_text("A push would change")
            stepramp.push()
            expect(page.locator("#push-preview")).to_contain_text("The device has this ramp")
            assert cable.tic.ramp[1] == speed * 10_000
        expect(page.locator("#push-report")).to_contain_text("A Tic computes its own ramp")
        stepramp.move("300")
        until(lambda: cable.tic.position == 300)
        expect(stepramp.state).to_have_text("ready")
        cable.tic.press("kill_switch")
        expect(page.locator("#device .problem").first).to_contain_text("The Tic can't move: its kill switch is active")
        cable.tic.press("kill_switch", False)
        stepramp.move("200")
        until(lambda: cable.tic.position == 500)
        expect(page.locator("#device .problem").first).to_be_empty()
        stepramp.release_devices(stepramp.url)
