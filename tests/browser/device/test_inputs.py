"""Inputs: what stops a machine, and how that is acknowledged."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from browser.conftest import Watch
from browser.device.devices import REFUSED, at_rest, device_of
from browser.stepramp_page import StepRampPage, until


def test_what_stops_a_machine_is_shown_and_acknowledged(pushed: StepRampPage, watch: Watch) -> None:
    page, device = pushed.page, device_of(pushed)["id"]
    roles = [{"input": "A0", "role": "emergency_stop"}, {"input": "D9", "role": "limit", "axis": 0, "end": "low"}]

    def press(*, down: bool) -> None:
        pushed.ask(pushed.url, "PUT", f"devices/{device}/surroundings", {"emergency_stop": down})

    pushed.ask(pushed.url, "PUT", f"devices/{device}/settings", {"inputs": roles})
    expect(page.locator("#inputs summary")).to_have_text("Inputs: none is active")
    expect(page.locator("#stopped-by")).to_be_hidden()
    press(down=True)
    expect(page.locator("#stopped-by")).to_contain_text("Stopped by an emergency stop.")
    expect(page.locator("#inputs summary")).to_have_text("Inputs: A0 is active")
    page.locator("#inputs summary").click()
    expect(page.locator("#inputs li")).to_have_text(
        ["A0: emergency stop, active", "D9: limit switch at the low end of axis 0, inactive"]
    )
    expect(page.locator(".device-body > .problem")).to_contain_text("A0")
    watch.expected.append(REFUSED)
    pushed.device_section("move")
    page.locator("#acknowledge").click()
    expect(page.locator(".device-body > .problem")).to_contain_text("emergency stop")
    expect(page.locator("#stopped-by")).to_be_visible()
    press(down=False)
    expect(page.locator("#inputs summary")).to_have_text("Inputs: none is active")
    page.locator("#acknowledge").click()
    expect(page.locator("#stopped-by")).to_be_hidden()
    pushed.ask(pushed.url, "PUT", f"devices/{device}/settings", {"inputs": []})
    expect(page.locator("#inputs")).to_be_hidden()


def refuse_a_sign(page: Page) -> None:
    """A sign would turn a homing round: which way it goes the switch says."""
    page.locator("#home-0-fast").fill("-250")
    expect(page.locator("#home-moves")).to_be_empty()
    page.locator("#home-go").click()
    expect(page.locator("#home-dialog")).to_contain_text("a speed above 0: which way it goes the switch says")
    expect(page.locator("#home-0-fast")).to_be_focused()
    page.locator("#home-0-fast").fill("250")


def test_inputs_from_their_roles_to_an_emergency_stop_that_is_acknowledged(pushed: StepRampPage, watch: Watch) -> None:
    """All by the page alone, with the virtual controller's own switches."""
    page = pushed.page
    outcome, stopped, switch = page.locator("#home-outcome"), page.locator("#stopped-by"), page.locator("#press-D9")
    page.locator("#settings").click()
    page.locator("#input-A0-role").select_option("emergency_stop")
    page.locator("#input-D9-role").select_option("limit")
    expect(page.locator("#input-D9-end")).to_have_value("low")
    page.locator("#use-settings").click()
    expect(page.locator("#settings-dialog")).to_be_hidden()
    expect(page.locator("#inputs summary")).to_have_text("Inputs: none is active")
    page.locator("#surroundings summary").click()
    switch.click()
    expect(switch).to_have_text("Release the low switch of axis 0 (D9)")
    switch.click()
    expect(switch).to_have_text("Press the low switch of axis 0 (D9)")

    page.locator("#home").click()
    expect(page.locator("#home-moves")).to_contain_text("Axis 0: backwards at")
    refuse_a_sign(page)
    page.locator("#home-slow").fill("200")
    page.locator("#home-0-position").fill("-40")
    page.locator("#home-go").click()
    expect(page.locator("#home-dialog")).to_be_hidden()
    expect(outcome).to_contain_text("Axis 0 is homed: its switch is at \u221240 steps", timeout=20_000)
    expect(page.locator("#home-known")).to_have_text("It is known where its axes are.")
    until(lambda: -50 < at_rest(pushed) <= -40)

    pushed.move("-500")
    expect(switch).to_contain_text("Release")
    at_rest(pushed)
    watch.expected.append(REFUSED)
    pushed.move("-500")
    expect(page.locator(".device-body > .problem")).to_contain_text("is on the limit switch of its low end at D9")
    page.locator("#press-A0").click()
    expect(stopped).to_contain_text("Stopped by an emergency stop.")
    page.locator("#home").click()
    expect(page.locator("#home-reason")).to_contain_text("acknowledge it in the panel")
    expect(page.locator("#home-go")).to_be_disabled()
    page.locator("#home-dialog").get_by_label("Close").click()
    page.locator("#press-A0").click()
    expect(page.locator("#press-A0")).to_have_text("Press the emergency stop (A0)")
    page.locator("#acknowledge").click()
    expect(stopped).to_be_hidden()
    device = f"devices/{device_of(pushed)['id']}"
    axes = [{"axis": 0, "low_steps": None, "high_steps": None}]
    pushed.ask(pushed.url, "PUT", f"{device}/surroundings", {"axes": axes})
    pushed.ask(pushed.url, "PUT", f"{device}/settings", {"inputs": []})
    expect(page.locator("#inputs")).to_be_hidden()
