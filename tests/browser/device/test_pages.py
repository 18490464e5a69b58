"""Two pages at one device."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.device.devices import FAR, REFUSED, at_rest, device_of
from browser.stepramp_page import ACCELERATION, StepRampPage, until


def test_two_tabs(open_page: Callable[..., StepRampPage], watch: Watch) -> None:
    watch.expected.append(REFUSED)
    first, second = open_page(), open_page()
    first.connect()
    first.push()
    expect(second.state).to_have_text("ready")
    expect(second.page.locator("#others")).to_be_visible()
    expect(first.page.locator("#others")).to_be_hidden()
    expect(second.page.locator("#push")).to_be_disabled()
    first.edit_and_wait(ACCELERATION, "1000")
    first.push()
    first.move(str(FAR))
    expect(second.state).to_have_text("moving")
    second.page.keyboard.press("Escape")
    until(lambda: device_of(first)["state"] == "ready")
    second.page.locator("#take-over").click()
    expect(second.page.locator("#others")).to_be_hidden()
    expect(first.page.locator("#others")).to_be_visible()
    second.move("10")
    at_rest(second)
    second.page.close()
    expect(first.page.locator("#others")).to_be_hidden()
