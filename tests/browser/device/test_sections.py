"""The sections of the device panel: they stay in place, come into sight, and nothing moves by looking at them."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from browser.device.devices import device_of
from browser.stepramp_page import SLEW_SPEED, StepRampPage, until


@pytest.mark.parametrize("height", [900, 720])
def test_the_tabs_stay_under_the_pointer(stepramp: StepRampPage, height: int) -> None:
    page = stepramp.page
    page.set_viewport_size({"width": 1440, "height": height})
    stepramp.connect()
    tabs, places = page.locator("#device-sections"), []

    def look(name: str) -> None:
        stepramp.device_section(name)
        box = tabs.bounding_box()
        places.append((name, box and box["y"]))

    for name in ("push", "move", "jog", "trace"):
        look(name)
    stepramp.push()
    for name in ("push", "jog", "push", "move", "trace"):
        look(name)
    stepramp.move("20")
    look("push")
    assert {place for _, place in places} == {places[0][1]}, places


@pytest.mark.parametrize("height", [640, 568, 540])
def test_a_section_that_opens_out_of_sight_comes_into_it(pushed_alone: StepRampPage, height: int) -> None:
    page = pushed_alone.page
    page.set_viewport_size({"width": 320, "height": height})
    pushed_alone.show_panel("device")
    firsts = {"move": ".panel.device [data-value='by']", "jog": "#jog-speed", "trace": "#trace", "push": "#push"}
    for name, first in firsts.items():
        page.locator("#device").evaluate("(one) => { one.scrollTop = 0; scrollTo(0, 0); }")
        pushed_alone.device_section(name)
        expect(page.locator(first)).to_be_in_viewport(ratio=1)
        expect(page.locator(f"#device-sections [data-value={name}]")).to_be_in_viewport(ratio=1)
        at_centre = """(one) => { const {x, y, width, height} = one.getBoundingClientRect();
            return one.contains(document.elementFromPoint(x + width / 2, y + height / 2)); }"""
        assert page.locator(first).evaluate(at_centre), "nothing lies over it"
        assert page.locator(f"#device-sections [data-value={name}]").evaluate(at_centre)
    assert page.evaluate("[scrollX, document.body.scrollTop]") == [0, 0]


def test_nothing_moves_by_undo_or_by_taking_a_look(pushed: StepRampPage) -> None:
    pushed.edit_and_wait(SLEW_SPEED, "500")
    sent: list[str] = []
    pushed.page.on("request", lambda request: sent.append(f"{request.method} {request.url}"))
    for section in ("move", "jog", "trace", "push"):
        pushed.device_section(section)
    pushed.page.keyboard.press("Control+z")
    pushed.page.keyboard.press("Control+Shift+z")
    pushed.page.wait_for_timeout(600)
    asked = [one for one in sent if "/devices/" in one and not one.endswith("/push/preview")]
    assert asked == []
    assert device_of(pushed)["position_steps"] == 0


def test_by_keyboard_only(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#port").focus()
    until(lambda: page.locator("#connect").is_enabled())
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(stepramp.state).to_have_text("ready")
    page.locator("#push").focus()
    page.keyboard.press("Enter")
    expect(page.locator(".push-head .verified")).to_be_visible(timeout=20_000)
    page.locator('#device-sections [data-value="push"]').focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.locator("#move-steps").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("25")
    page.keyboard.press("Enter")
    until(lambda: device_of(stepramp)["position_steps"] == 25)
