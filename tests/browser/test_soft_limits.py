"""Soft limits, and runs that end: what is set, shown, refused and offered again."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import StepRampPage, until

REFUSED = r"status of 422"


@pytest.fixture(scope="module")
def module_pushed(module_page: StepRampPage, module_watch: Watch) -> Iterator[StepRampPage]:
    module_watch.expected.append(REFUSED)
    module_page.connect()
    module_page.push()
    yield module_page
    module_page.release_devices(module_page.url)


@pytest.fixture
def pushed(module_pushed: StepRampPage) -> Iterator[StepRampPage]:
    """Return the page with a device that rests at 0 and has no soft limits, nor has its port ever had any."""
    device = f"devices/{device_of(module_pushed)['id']}"
    module_pushed.ask(module_pushed.url, "POST", f"{device}/position", {"position_steps": 0})
    yield module_pushed
    module_pushed.page.evaluate("() => localStorage.removeItem('stepramp.soft_limits')")
    device = f"devices/{device_of(module_pushed)['id']}"
    module_pushed.ask(module_pushed.url, "POST", f"{device}/halt")
    until(lambda: device_of(module_pushed)["state"] == "ready")
    module_pushed.ask(module_pushed.url, "PUT", f"{device}/soft_limits", {"axes": [{"axis": 0}]})
    expect(module_pushed.page.locator("#live-limits")).to_be_hidden()


def device_of(page: StepRampPage) -> dict[str, Any]:
    [device] = page.devices()
    return device


def limits_of(page: StepRampPage) -> tuple[int | None, int | None]:
    axis = device_of(page)["axes"][0]
    return axis["lowest_steps"], axis["highest_steps"]


def set_limits(page: StepRampPage, lowest: str, highest: str) -> None:
    page.page.locator("#settings").click()
    page.page.locator("#limit-0-lowest").fill(lowest)
    page.page.locator("#limit-0-highest").fill(highest)
    page.page.locator("#use-settings").click()


def test_soft_limits_are_set_shown_and_kept_to(pushed: StepRampPage) -> None:
    page = pushed.page
    set_limits(pushed, "-1,000", "20000")
    expect(page.locator("#settings-dialog")).to_be_hidden()
    assert limits_of(pushed) == (-1000, 20000)
    assert not device_of(pushed)["on_trial"], "what was not changed is not sent"
    expect(page.locator("#live-limits")).to_have_text("Soft limits: \u22121,000 to 20,000 steps")
    pushed.move("20001")
    expect(page.locator("#move-steps-message")).to_contain_text("the soft limits of axis 0, -1,000 to 20,000 steps")
    assert device_of(pushed)["target_steps"] == 0
    set_limits(pushed, "", "20000")
    until(lambda: limits_of(pushed) == (None, 20000))
    expect(page.locator("#live-limits")).to_have_text("Soft limits: up to 20,000 steps")


def test_limits_that_leave_out_the_present_position_say_what_that_means(pushed: StepRampPage) -> None:
    beyond = pushed.page.locator("#beyond-limits")
    expect(beyond).to_be_hidden()
    set_limits(pushed, "100", "2000")
    expect(beyond).to_contain_text("beyond its soft limits: only moves that end within them")
    pushed.move("150")
    expect(beyond).to_be_hidden()
    assert device_of(pushed)["target_steps"] == 150


def test_soft_limits_in_the_units_of_the_page(pushed: StepRampPage) -> None:
    page = pushed.page
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    # 400 steps make one turn of 8 mm.
    set_limits(pushed, "-2.5", "100")
    until(lambda: limits_of(pushed) == (-125, 5000))
    expect(page.locator("#live-limits")).to_have_text("Soft limits: \u22122.5 to 100 mm")
    page.locator("#settings").click()
    expect(page.locator("#limit-0-lowest")).to_have_value("-2.5")
    page.locator("#settings-dialog").get_by_label("Close").click()
    page.locator('[aria-label="Unit of length"] [data-value="steps"]').click()
    expect(page.locator("#live-limits")).to_have_text("Soft limits: \u2212125 to 5,000 steps")


@pytest.mark.parametrize(
    ("lowest", "highest", "in_steps"),
    [
        pytest.param("-2.515", "100.015", (-125, 5000), id="-125.75 and 5000.75 steps"),
        pytest.param("0.14", "0.58", (7, 29), id="whole steps that the conversion misses by its last digit"),
    ],
)
def test_soft_limits_in_force_are_never_beyond_those_typed(
    pushed: StepRampPage, lowest: str, highest: str, in_steps: tuple[int, int]
) -> None:
    page = pushed.page
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    set_limits(pushed, lowest, highest)
    expect(page.locator("#settings-dialog")).to_be_hidden()
    page.locator('[aria-label="Unit of length"] [data-value="steps"]').click()
    assert limits_of(pushed) == in_steps


def test_what_is_too_large_for_its_unit_is_refused_and_takes_no_limit_away(pushed: StepRampPage) -> None:
    page = pushed.page
    set_limits(pushed, "-100", "100")
    expect(page.locator("#settings-dialog")).to_be_hidden()
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    set_limits(pushed, "-2", "1e308")
    expect(page.locator("#limit-0-highest-message")).to_contain_text("Highest is 1e308; allowed: a number from")
    page.locator("#settings-dialog").get_by_label("Close").click()
    pushed.move("1e308")
    expect(page.locator("#move-steps-message")).to_contain_text("Distance is 1e308; allowed: a number from")
    page.locator('.panel.device [data-value="to"]').click()
    expect(page.locator("#move-steps-message")).to_have_count(0)
    expect(page.locator("#move-steps")).to_have_attribute("aria-invalid", "false")
    page.locator('[aria-label="Unit of length"] [data-value="steps"]').click()
    page.locator("#move-steps").fill("0")
    assert limits_of(pushed) == (-100, 100)
    assert device_of(pushed)["target_steps"] == 0


def test_the_line_with_the_soft_limits_has_room_above_it(pushed: StepRampPage) -> None:
    page = pushed.page
    set_limits(pushed, "-100", "100")
    expect(page.locator("#live-limits")).to_be_visible()
    boxes, line = page.locator(".live").bounding_box(), page.locator("#live-limits").bounding_box()
    assert boxes
    assert line
    assert line["y"] - (boxes["y"] + boxes["height"]) >= 5


@pytest.mark.parametrize(
    ("lowest", "highest", "field", "words"),
    [
        ("10", "5", "highest", "Highest is 5; allowed: at least 10 steps, the lowest."),
        ("low", "5", "lowest", "Lowest is 'low'; allowed: a whole number from"),
        ("1.5", "", "lowest", "Lowest is 1.5; allowed: a whole number from"),
    ],
)
def test_soft_limits_that_cant_be(pushed: StepRampPage, lowest: str, highest: str, field: str, words: str) -> None:
    page = pushed.page
    set_limits(pushed, lowest, highest)
    expect(page.locator(f"#limit-0-{field}-message")).to_contain_text(words)
    expect(page.locator(f"#limit-0-{field}")).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#settings-dialog .message:not(.warning)")).to_have_count(1)
    page.locator("#settings-dialog").get_by_label("Close").click()
    assert limits_of(pushed) == (None, None)
    page.locator("#settings").click()
    expect(page.locator("#settings-dialog .message:not(.warning)")).to_have_count(0)
    expect(page.locator("#limit-0-lowest")).to_have_value("")
    page.locator("#settings-dialog").get_by_label("Close").click()


def test_soft_limits_that_the_server_forgot_are_offered_and_never_set_unasked(pushed: StepRampPage) -> None:
    page = pushed.page
    set_limits(pushed, "-1000", "20000")
    expect(page.locator("#live-limits")).to_be_visible()
    expect(page.locator("#limits-offer")).to_be_hidden()
    # To a server that was started anew it has none.
    device = f"devices/{device_of(pushed)['id']}"
    pushed.ask(pushed.url, "PUT", f"{device}/soft_limits", {"axes": [{"axis": 0}]})
    # Which axis it is is said where there are several: the virtual controller may have been given more by other tests.
    offer = re.compile("Soft limits of this port, (axis 0 )?\u22121,000 to 20,000 steps, are not in force.")
    expect(page.locator("#limits-offer")).to_contain_text(offer)
    page.reload()
    expect(page.locator("#limits-offer")).to_contain_text(offer)
    assert limits_of(pushed) == (None, None)
    page.locator("#set-limits").click()
    expect(page.locator("#limits-offer")).to_be_hidden()
    assert limits_of(pushed) == (-1000, 20000)
    set_limits(pushed, "", "")
    expect(page.locator("#live-limits")).to_be_hidden()
    expect(page.locator("#limits-offer")).to_be_hidden()


def test_a_run_ends_after_the_time_asked_for(pushed: StepRampPage) -> None:
    page = pushed.page
    pushed.device_section("jog")
    expect(page.locator("#run-for")).to_have_value("10")
    page.locator("#run-for").fill("0.01")
    page.locator("#run-ahead").click()
    expect(page.locator("#run-for-message")).to_contain_text(
        "The time is 0.01; allowed: a number from 0.05 to 86,400 s"
    )
    page.locator("#run-for").fill("0.3")
    page.locator("#run-ahead").click()
    expect(page.locator("#run-for-message")).to_have_count(0)
    until(lambda: device_of(pushed)["position_steps"] > 0)
    until(lambda: device_of(pushed)["state"] == "ready")
    page.reload()
    pushed.device_section("jog")
    expect(page.locator("#run-for")).to_have_value("0.3")
    page.locator("#run-for").fill("10")
    page.locator("#run-for").press("Tab")


def test_a_run_asked_for_again_lasts_as_was_asked_last(pushed: StepRampPage) -> None:
    page = pushed.page
    pushed.device_section("jog")
    asked: list[Any] = []
    page.on("request", lambda request: asked.append(request.post_data_json) if request.url.endswith("/run") else None)
    page.locator("#run-for").fill("60")
    page.locator("#run-ahead").click()
    until(lambda: device_of(pushed)["state"] == "moving")
    page.locator("#run-for").fill("0.5")
    expect(page.locator("#run-ahead")).to_be_enabled()
    page.locator("#run-ahead").click()
    until(lambda: device_of(pushed)["state"] == "ready")
    assert [one["for_s"] for one in asked] == [60, 0.5]
    expect(page.locator("#run-explained")).to_contain_text("slows down after that, or when this page is closed")
