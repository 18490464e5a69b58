"""Of the device in hand, what the tests of its panel ask and do."""

from __future__ import annotations

from typing import Any

from playwright.sync_api import Page

from browser.stepramp_page import StepRampPage, until

REFUSED = r"status of 4(09|22)"
FAR = 1_000_000


def device_of(page: StepRampPage) -> dict[str, Any]:
    [device] = page.devices()
    return device


def press_and_hold(page: Page, name: str) -> None:
    page.locator(name).hover()
    page.mouse.down()


def at_rest(pushed: StepRampPage) -> int:
    until(lambda: device_of(pushed)["state"] == "ready")
    position: int = device_of(pushed)["position_steps"]
    return position
