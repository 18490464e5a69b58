"""Several axes: each with its ramp and its soft limits, and moved in a line."""

from __future__ import annotations

import re

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.device.devices import REFUSED, device_of
from browser.stepramp_page import ACCELERATION, StepRampPage, until


def test_several_axes(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.get_by_role("button", name="Add an axis").click()
    stepramp.connect()
    stepramp.device_section("push")
    expect(page.locator("#push")).to_have_text(re.compile("^Push 2 ramps by "))
    stepramp.push()
    assert len(device_of(stepramp)["axes"]) == 2
    # The second of the tabs is in hand; whichever is, it is the panel that says which axis its buttons move.
    other = page.locator("#other-design")
    expect(other).to_have_text(
        "Axis 0 plays the design of tab 0, Lead-screw stage. The one in hand is tab 1, Lead-screw stage."
    )
    page.locator("#device-axis").select_option("1")
    expect(other).to_be_hidden()
    page.get_by_role("tablist", name="Axes").get_by_role("tab").nth(0).click()
    expect(other).to_contain_text("Axis 1 plays the design of tab 1")
    stepramp.edit_and_wait(ACCELERATION, "2000")
    stepramp.push()
    expect(other).to_contain_text("Axis 1 plays the design of tab 1")
    stepramp.move("30")
    until(lambda: device_of(stepramp)["axes"][1]["position_steps"] == 30)
    expect(stepramp.position).to_have_text("30")
    stepramp.device_section("move")
    page.locator('.panel.device [data-value="line"]').click()
    for axis in (0, 1):
        box = page.locator(f"#line-{axis}").bounding_box()
        assert box
        assert box["width"] > 150, "it is as wide as the panel"
    page.locator("#line-0").fill("100")
    page.locator("#line-1").fill("-50")
    expect(page.locator("#move")).to_be_enabled()
    page.locator("#move").click()
    until(lambda: [one["position_steps"] for one in device_of(stepramp)["axes"]] == [100, -20])


def spans_of(page: StepRampPage) -> list[tuple[int | None, int | None]]:
    return [(one["lowest_steps"], one["highest_steps"]) for one in device_of(page)["axes"]]


def test_soft_limits_of_each_of_several_axes(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = stepramp.page
    page.get_by_role("button", name="Add an axis").click()
    stepramp.connect()
    stepramp.push()

    def set_by_another_program(axis: int, lowest: int) -> None:
        limits = {"axes": [{"axis": axis, "lowest_steps": lowest}]}
        stepramp.ask(stepramp.url, "PUT", f"devices/{device_of(stepramp)['id']}/soft_limits", limits)

    def forget_limits() -> None:
        """To a server that was started anew the device has none."""
        StepRampPage.take_limits_away(stepramp.url, device_of(stepramp))

    def type_highest(axis: int, text: str) -> None:
        page.locator(f"#limit-{axis}-highest").fill(text)
        page.locator("#use-settings").click()

    page.locator("#settings").click()
    type_highest(0, "500")
    expect(page.locator("#settings-dialog")).to_be_hidden()
    # What is not touched in the dialog stays as another program set it meanwhile, and a refusal is at its own axis.
    page.locator("#settings").click()
    set_by_another_program(0, -7)
    type_highest(1, "0.5")
    expect(page.locator("#limit-1-highest-message")).to_contain_text("Highest is 0.5; allowed: a whole number")
    expect(page.locator("#settings-dialog .message:not(.warning)")).to_have_count(1)
    type_highest(1, "600")
    expect(page.locator("#settings-dialog")).to_be_hidden()
    assert spans_of(stepramp) == [(-7, None), (None, 600)]
    # Axis 0 has others than are remembered, axis 1 those: the first is offered, and only on asking set.
    expect(page.locator("#limits-offer")).to_contain_text("axis 0 up to 500 steps, are not in force.")
    forget_limits()
    expect(page.locator("#limits-offer")).to_contain_text(
        "axis 0 up to 500 steps, axis 1 up to 600 steps, are not in force."
    )
    set_by_another_program(1, -9)
    expect(page.locator("#limits-offer")).to_contain_text(
        "axis 0 up to 500 steps, axis 1 up to 600 steps, are not in force."
    )
    page.locator("#set-limits").click()
    expect(page.locator("#limits-offer")).to_be_hidden()
    assert spans_of(stepramp) == [(None, 500), (None, 600)]
    # Taken away on purpose, they are forgotten; those of the other axis are not.
    page.locator("#settings").click()
    type_highest(0, "")
    expect(page.locator("#settings-dialog")).to_be_hidden()
    forget_limits()
    expect(page.locator("#limits-offer")).to_contain_text(
        "Soft limits of this port, axis 1 up to 600 steps, are not in force."
    )


def test_a_line_that_is_refused_says_for_which_axis(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = stepramp.page
    page.get_by_role("button", name="Add an axis").click()
    stepramp.connect()
    stepramp.push()
    stepramp.device_section("move")
    page.locator('.panel.device [data-value="line"]').click()
    page.locator("#line-0").fill("100")
    page.locator("#line-1").fill("")
    page.locator("#move").click()
    expect(page.locator("#line-1-message")).to_contain_text("Distance of axis 1 is empty; allowed: ")
    expect(page.locator("#line-1")).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#device .problem .message")).to_have_count(1)
    page.locator('.panel.device [data-value="by"]').click()
    page.locator('.panel.device [data-value="line"]').click()
    expect(page.locator("#line-1-message")).to_have_count(0)
