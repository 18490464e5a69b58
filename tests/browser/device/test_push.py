"""Pushing: what differs first, how far it has come, tried and kept or rolled back."""

from __future__ import annotations

import re

from playwright.sync_api import expect

from browser.device.devices import device_of
from browser.stepramp_page import SLEW_SPEED, StepRampPage, until


def changes(page: StepRampPage) -> dict[str, tuple[str, str]]:
    rows = page.page.locator("#push-preview tbody tr").all()
    cells = [[cell.inner_text() for cell in row.locator("th, td").all()] for row in rows]
    return {name: (there, here) for name, there, here in cells}


def test_what_differs_is_shown_before_it_is_pushed(pushed: StepRampPage) -> None:
    page = pushed.page
    stored = device_of(pushed)["ramp"]["sequence"]
    expect(page.locator("#push-preview")).to_contain_text("The device has this ramp")
    pushed.edit_and_wait(SLEW_SPEED, "500")
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    differing = changes(pushed)
    # With 5,000 steps/s² 1,000 steps/s are reached in 100 steps, 500 in 25.
    assert differing["Up ramp steps"] == ("100", "25")
    assert differing["Slew interval µs"] == ("1,000.0", "2,000.0")
    assert "First interval µs" not in differing
    assert device_of(pushed)["ramp"]["sequence"] == stored, "nothing is sent by looking"
    pushed.push()
    expect(page.locator("#push-preview")).to_contain_text("The device has this ramp")
    assert device_of(pushed)["ramp"]["sequence"] == stored + 1


def test_a_push_shows_how_far_it_has_come(stepramp: StepRampPage) -> None:
    stepramp.connect()
    script = """() => { window.seen = []; const box = document.querySelector('#push-progress');
        new MutationObserver(() => box.hidden || window.seen.push(box.innerText))
            .observe(box, {subtree: true, childList: true, attributes: true, characterData: true}); }"""
    stepramp.page.evaluate(script)
    seen: list[str] = []
    # A page on a busy machine may draw nothing of one that is over after 0.2 s.
    for _ in range(20):
        stepramp.push()
        seen = stepramp.page.evaluate("() => window.seen")
        if seen:
            break
    told = re.compile(r"^(Working out|Sending|Checking|Storing|Reading back)")
    assert seen
    assert all(told.match(text) for text in seen), seen
    expect(stepramp.page.locator("#push-progress")).to_be_hidden()


def test_try_then_keep_or_roll_back_and_restore(pushed: StepRampPage) -> None:
    page = pushed.page
    stored = device_of(pushed)["ramp"]["sequence"]
    pushed.edit_and_wait(SLEW_SPEED, "500")
    page.locator("#try").click()
    expect(page.locator("#keep-ramp")).to_be_visible()
    until(lambda: device_of(pushed)["on_trial"])
    page.locator("#roll-back").click()
    expect(page.locator("#keep-ramp")).to_be_hidden()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    # The report is of what was pushed, and says that it is there no more; the focus has gone on to what is there.
    expect(page.locator("#push-report")).to_contain_text("The device has another ramp since this push.")
    expect(page.locator("#push")).to_be_focused()
    page.locator("#try").click()
    page.locator("#keep-ramp").click()
    expect(page.locator("#keep-ramp")).to_be_hidden()
    expect(page.locator("#push-report")).not_to_contain_text("another ramp")
    assert (device_of(pushed)["on_trial"], device_of(pushed)["ramp"]["sequence"]) == (False, stored + 1)
    page.locator("#restore").click()
    until(lambda: device_of(pushed)["ramp"]["sequence"] == stored + 2)
    expect(page.locator("#restore")).to_be_focused()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    assert changes(pushed)["Slew interval µs"] == ("1,000.0", "2,000.0")
