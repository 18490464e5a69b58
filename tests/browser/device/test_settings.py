"""Settings: explained, refused at their field, and on trial."""

from __future__ import annotations

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.device.devices import REFUSED, device_of
from browser.stepramp_page import StepRampPage, until


def test_settings_are_explained_and_on_trial(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    page.locator("#settings").click()
    expect(page.locator("#setting-direction_setup_us")).to_have_value("30")
    expect(page.locator("#setting-pulse_width_us-hint")).to_contain_text("Least width")
    page.locator("#setting-pulse_width_us").fill("900")
    page.locator("#use-settings").click()
    message = page.locator("#setting-pulse_width_us-message")
    expect(message).to_have_text("Pulse width is 900; allowed: a whole number from 0 to 100 µs.")
    expect(page.locator("#setting-pulse_width_us")).to_be_focused()
    page.locator("#setting-pulse_width_us").fill("8")
    page.get_by_label("Direction inverted: axis 0").check()
    page.locator("#use-settings").click()
    expect(page.locator("#settings-dialog")).to_be_hidden()
    settings = pushed.ask(pushed.url, "GET", f"devices/{device_of(pushed)['id']}/settings")
    assert (settings["pulse_width_us"], settings["direction_inverted"]) == (8, [0])
    expect(page.locator("#keep-ramp")).to_be_visible()
    page.locator("#roll-back").click()
    until(lambda: not device_of(pushed)["on_trial"])
