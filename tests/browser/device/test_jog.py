"""Jogging and running at a speed."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from browser.conftest import Watch
from browser.device.devices import REFUSED, at_rest, device_of, press_and_hold
from browser.stepramp_page import StepRampPage, until


def test_a_jog_lasts_as_long_as_the_button_is_held(pushed: StepRampPage) -> None:
    pushed.device_section("jog")

    def has_gone_far() -> bool:
        device = device_of(pushed)
        # On a busy machine a page may be kept from renewing a jog's lease, as if it hung: it is pressed anew then.
        if device["state"] == "ready" and device["position_steps"] >= -200:
            pushed.page.mouse.up()
            press_and_hold(pushed.page, "#jog-left")
            until(lambda: device_of(pushed)["state"] == "moving")
        return bool(device["position_steps"] < -200)

    until(has_gone_far)
    expect(pushed.state).to_have_text("moving")
    pushed.page.mouse.up()
    assert at_rest(pushed) < -200


def test_a_jog_by_key(pushed: StepRampPage) -> None:
    pushed.device_section("jog")
    page = pushed.page
    page.locator("#jog-speed").fill("400")
    page.locator("#jog-right").focus()
    page.keyboard.down("Space")
    until(lambda: device_of(pushed)["speed_steps_per_s"] > 390)
    page.keyboard.up("Space")
    assert at_rest(pushed) > 0


def hide(page: Page) -> None:
    script = """() => { Object.defineProperty(document, 'hidden', {value: true, configurable: true});
        document.dispatchEvent(new Event('visibilitychange')); }"""
    page.evaluate(script)


def fall_silent(page: Page) -> None:
    """Let nothing more be said over the socket, which stays open: as if the page hung."""
    page.evaluate("() => { WebSocket.prototype.send = () => {}; WebSocket.prototype.close = () => {}; }")


@pytest.mark.parametrize(
    "end",
    [
        pytest.param(lambda page: page.close(), id="tab closed"),
        pytest.param(lambda page: page.reload(), id="reloaded"),
        pytest.param(hide, id="hidden"),
        pytest.param(fall_silent, id="silent"),
        pytest.param(lambda page: page.keyboard.press("Escape"), id="escape"),
    ],
)
def test_a_jog_ends_with_what_holds_it(pushed_alone: StepRampPage, end: Callable[[Page], None]) -> None:
    pushed_alone.device_section("jog")
    press_and_hold(pushed_alone.page, "#jog-right")
    until(lambda: device_of(pushed_alone)["position_steps"] > 40)
    end(pushed_alone.page)
    place = at_rest(pushed_alone)
    time.sleep(0.5)
    assert device_of(pushed_alone)["position_steps"] == place


def test_running_at_a_speed_and_calling_the_place_something(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    pushed.device_section("jog")
    page.locator("#jog-speed").fill("99999")
    page.locator("#run-ahead").click()
    expect(page.locator("#jog-speed-message")).to_contain_text("Speed is 99,999")
    page.locator("#jog-speed").fill("300")
    page.locator("#run-back").click()
    until(lambda: device_of(pushed)["speed_steps_per_s"] > 290)
    expect(page.locator("#set-position-button")).to_be_disabled()
    page.locator("#stop").click()
    at_rest(pushed)
    page.locator("#set-position").fill("-50")
    page.locator("#set-position-button").click()
    expect(pushed.position).to_have_text("\u221250")


def test_a_jog_takes_away_what_was_refused_before(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    pushed.device_section("jog")
    page.locator("#jog-speed").fill("99999")
    page.locator("#run-ahead").click()
    refused = page.locator("#jog-speed-message", has_text="99,999")
    expect(refused).to_be_visible()
    page.locator("#jog-speed").fill("300")
    press_and_hold(page, "#jog-right")
    until(lambda: device_of(pushed)["state"] == "moving")
    expect(refused).to_have_count(0)
    page.mouse.up()
