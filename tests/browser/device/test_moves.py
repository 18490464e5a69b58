"""Moves of one axis."""

from __future__ import annotations

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.device.devices import FAR, REFUSED, device_of
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until


def test_a_move_says_when_it_is_made_with_another_ramp_than_the_design(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page = pushed.page
    pushed.device_section("move")
    told = page.locator("#move-ramp")
    expect(told).to_be_hidden()
    pushed.edit_and_wait(SLEW_SPEED, "400")
    expect(told).to_have_text(
        "The device has another ramp than the design, up to 1,000 steps/s: push first, or it moves with that one."
    )
    expect(page.locator("#move")).to_be_enabled()
    pushed.field(SLEW_SPEED).fill("abc")
    expect(told).to_have_text("The design can’t be computed: the device moves with the ramp that it has.")
    pushed.edit_and_wait(SLEW_SPEED, "1000")
    expect(told).to_be_hidden()


def test_there_and_back(pushed: StepRampPage) -> None:
    page = pushed.page
    pushed.device_section("move")
    page.locator('.panel.device [data-value="back"]').click()
    page.locator("#move-steps").fill("60")
    page.locator("#move-times").fill("2")
    # Long enough for its target to be seen on a busy machine, too.
    page.locator("#move-pause").fill("0.5")
    page.locator("#move").click()
    expect(page.locator("#live-shuttle")).to_contain_text("of 2 done")
    until(lambda: device_of(pushed)["target_steps"] == 60)
    until(lambda: device_of(pushed)["shuttle"] is None)
    expect(pushed.position).to_have_text("0")
    page.locator("#move-pause").fill("30")
    page.locator("#move").click()
    expect(pushed.position).to_have_text("60")
    # It moves again by itself: nothing on the page says that it is ready.
    for pill in (page.locator("#device-pill"), pushed.state):
        expect(pill).to_contain_text("pausing")
    for section in ("push", "jog", "trace"):
        pushed.device_section(section)
        expect(page.locator("#live-shuttle")).to_contain_text(
            "It sets out again by itself, 30 s after it came to rest."
        )
    page.keyboard.press("Escape")
    expect(page.locator("#live-shuttle")).to_be_hidden()
    expect(pushed.state).to_have_text("ready")
    assert device_of(pushed)["position_steps"] == 60, "a stop ends it in a pause, too"


def test_a_refused_move_leaves_the_measured_one_on_the_plots(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    deviation = page.locator('#third-choice [data-value="deviation"]')
    pushed.move("60")
    expect(deviation).to_be_visible()
    pushed.move("0.5")
    expect(page.locator("#move-steps-message")).to_contain_text("Distance is 0.5")
    expect(deviation).to_be_visible()
    pushed.move(str(FAR))
    expect(pushed.state).to_have_text("moving")
    expect(deviation).to_be_hidden()
