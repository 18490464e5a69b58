"""Lengths in the chosen unit: what becomes of them, and what is refused in it."""

from __future__ import annotations

import re

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.device.devices import REFUSED, device_of
from browser.stepramp_page import StepRampPage, until


def test_lengths_in_the_chosen_unit(pushed: StepRampPage) -> None:
    page = pushed.page
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    # 400 steps make one turn of 8 mm.
    pushed.move("2.5")
    expect(page.locator("#move-in-steps")).to_have_text("125 steps")
    until(lambda: device_of(pushed)["position_steps"] == 125)
    expect(pushed.position).to_have_text(re.compile(r"^2\.50*$"))
    expect(page.locator(".live .target").first).to_contain_text("125 steps")


def test_a_position_between_two_steps_says_what_it_becomes(pushed: StepRampPage) -> None:
    page = pushed.page
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    pushed.device_section("jog")
    # 400 steps make one turn of 8 mm.
    field, note = page.locator("#set-position"), page.locator("#set-position-note")
    field.fill("0.001")
    expect(note).to_have_text("0.001 mm would be 0.05 steps: it is 0, 0 mm.")
    field.fill("3.333")
    expect(note).to_have_text("3.333 mm would be 166.65 steps: it is 167, 3.34 mm.")
    page.locator("#set-position-button").click()
    expect(pushed.position).to_have_text(re.compile(r"^3\.340*$"))
    expect(note).to_be_visible()
    field.fill("3.34")
    expect(note).to_be_hidden()
    field.fill("3.333")
    page.locator('[aria-label="Unit of length"] [data-value="steps"]').click()
    expect(field).to_have_value("167")
    expect(note).to_be_hidden()


def test_a_distance_below_a_step_is_refused_as_it_was_typed(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    pushed.device_section("move")
    message = page.locator("#move-steps-message")
    for kind in ("by", "back"):
        for typed in ("0.001", "-0.009"):
            pushed.move(typed, kind)
            expect(message).to_have_text(f"{typed} mm is less than half a step; the least is 0.02 mm.")
            expect(page.locator("#move-in-steps")).to_be_hidden()
    pushed.move("0")
    expect(message).to_have_text(
        "Distance is 0 mm (0 steps); allowed: a number from -200,000 to 200,000 mm, but not 0."
    )
    pushed.move("3.333")
    expect(page.locator("#move-in-steps")).to_have_text("3.333 mm would be 166.65 steps: it is 167, 3.34 mm.")
    until(lambda: device_of(pushed)["position_steps"] == 167)
    # Half a step is one, whichever way.
    pushed.move("-0.01")
    until(lambda: device_of(pushed)["position_steps"] == 166)


def test_what_is_refused_stands_at_its_field_in_its_unit(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    pushed.device_section("jog")

    def refused(field: str, text: str, button: str) -> str:
        page.locator(field).fill(text)
        page.locator(button).click()
        message = page.locator(f"{field}-message")
        expect(message).to_have_count(1)
        expect(page.locator("#device .problem .message")).to_have_count(1)
        return message.inner_text()

    # 400 steps make one turn of 8 mm, and the ramp goes up to 1,000 steps/s.
    speed = refused("#jog-speed", "21", "#run-ahead")
    assert speed.startswith("Speed is 21 mm/s (1,050 steps/s); allowed: a number from 0 to 20 mm/s, the slew speed")
    for text, told in (("0", "0"), ("-5", "-5"), ("abc", "'abc'")):
        assert refused("#jog-speed", text, "#run-back").startswith(f"Speed is {told}")
        expect(page.locator("#jog-speed-message")).to_contain_text(
            "from 0 to the slew speed of the axis’ ramp, but not 0"
        )
    assert "42,949,600 mm" in refused("#set-position", "x", "#set-position-button")
    # Only what turns is a gauge: here 8° a turn of 400 steps, of which 65,535 are the most.
    expect(page.locator("#zero")).to_be_hidden()
    page.get_by_label("Travel unit").select_option("deg")
    page.locator('#length-unit [data-value="deg"]').click()
    assert refused("#zero-steps", "-1", "#zero") == (
        "Range is -1 ° (-50 steps); allowed: a number from 0.02 to 1,310.7 °."
    )
    page.locator('#device-sections [data-value="move"]').click()
    page.locator('.panel.device [data-value="back"]').click()
    assert refused("#move-times", "0", "#move").startswith("Times is 0; allowed: a whole number from 1 to 10,000")
    page.locator("#move-times").fill("1")
    expect(page.locator("#move-times-message")).to_have_count(0)
    assert refused("#move-pause", "-1", "#move").startswith("The pause is -1; allowed: a number from 0 to 3,600 s")
    # It was said of what stood there, not of what stands there now, nor of what is typed elsewhere.
    page.locator("#move-times").fill("2")
    expect(page.locator("#move-pause")).to_have_attribute("aria-invalid", "true")
    page.locator("#move-pause").fill("1")
    expect(page.locator("#move-pause-message")).to_have_count(0)
    expect(page.locator("#move-pause")).to_have_attribute("aria-invalid", "false")
