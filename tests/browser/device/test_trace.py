"""The trace of a move."""

from __future__ import annotations

from playwright.sync_api import expect

from browser.device.devices import at_rest
from browser.stepramp_page import StepRampPage


def test_the_measured_trace(pushed: StepRampPage) -> None:
    pushed.move("500")
    at_rest(pushed)
    pushed.device_section("trace")
    figures = pushed.page.locator("#trace-figures")
    expect(figures).to_contain_text("500, every one")
    # The virtual controller is never late.
    expect(figures).to_contain_text("0.00 µs")
    chip, removal = pushed.page.locator(".legend .trace"), pushed.page.locator("#remove-trace")
    expect(chip).to_be_visible()
    # What was told while it ran doesn't come in the place of what was measured.
    removal.click()
    expect(chip).to_be_hidden()
    pushed.device_section("trace")
    pushed.page.locator("#trace").uncheck()
    pushed.move("10")
    at_rest(pushed)
    expect(chip).to_be_visible()
    removal.click()
    expect(chip).to_be_hidden()
    pushed.device_section("trace")
    expect(figures).to_contain_text("500, every one")
