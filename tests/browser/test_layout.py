"""Layouts, themes and reach by keyboard."""

from collections.abc import Callable

import pytest
from playwright.sync_api import BrowserContext, Route, expect

from browser.conftest import Watch, new_page
from browser.server import Server
from browser.stepramp_page import StepRampPage, until

SIZES = [(1440, 900), (1024, 768), (390, 844)]


@pytest.mark.parametrize("size", SIZES)
def test_everything_is_in_reach_and_nothing_scrolls_sideways(
    open_page: Callable[..., StepRampPage], size: tuple[int, int]
) -> None:
    stepramp = open_page(size)
    page = stepramp.page
    for panel in ("parameters", "table", "device"):
        stepramp.show_panel(panel)
        expect(page.locator(f"#{panel}")).to_be_visible()
        wide = page.evaluate("() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight]")
        assert wide[0] <= size[0]
        assert wide[1] <= size[1]
        box = page.locator(f"#{panel}").bounding_box()
        assert box
        assert box["x"] + box["width"] <= size[0]
    stop = page.locator("#stop").bounding_box()
    assert stop
    assert size[0] - 20 < stop["x"] + stop["width"] <= size[0], "STOP is the last thing of the head"
    if size == (1440, 900):
        fits = "() => document.querySelector('.groups').scrollHeight <= document.querySelector('.groups').clientHeight"
        assert page.evaluate(fits), "all parameters are in sight"


def test_a_phone_scrolls_nothing_sideways_while_there_are_no_curves_yet(
    context: BrowserContext, server: Server, watch: Watch
) -> None:
    page = new_page(context, watch, (390, 844))
    held: list[Route] = []
    page.route("**/api/v1/curves", lambda route: held.append(route))  # noqa: PLW0108  # Playwright wants a function
    page.goto(server.url)
    # A look at the page lets what it asks for come to be known here.
    until(lambda: [page.title(), *held][1:])
    assert page.evaluate("() => document.documentElement.scrollWidth") == 390
    for route in held:
        route.continue_()
    expect(page.locator(".plot-title:visible")).to_have_count(1)
    page.close()


def test_a_phone_shows_one_plot_at_a_time(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page((390, 844))
    for name in ("delay", "error", "velocity"):
        stepramp.page.locator(f'#plot-choice [data-value="{name}"]').click()
        until(lambda one=name: {key.split("-")[1] for key in stepramp.curves()} == {one})
        expect(stepramp.page.locator(".plot-title:visible")).to_have_count(1)


def test_the_theme_follows_the_system_until_it_is_switched(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page(theme="light")
    root = stepramp.page.locator("html")
    expect(root).to_have_attribute("data-theme", "light")
    stepramp.page.emulate_media(color_scheme="dark")
    expect(root).to_have_attribute("data-theme", "dark")
    stepramp.page.get_by_role("button", name="Switch between light and dark").click()
    expect(root).to_have_attribute("data-theme", "light")
    background = "() => document.querySelector('.figure').layout.plot_bgcolor"
    until(lambda: stepramp.page.evaluate(background) == "#f8f9fb")
    stepramp.reload()
    expect(root).to_have_attribute("data-theme", "light")


def test_the_info_view_explains_the_field_in_focus(stepramp: StepRampPage) -> None:
    stepramp.field("ramp.slew_speed_steps_per_s").focus()
    expect(stepramp.page.locator("#parameter-info")).to_contain_text("Slew speed")
    expect(stepramp.page.locator("#parameter-info")).to_contain_text("formula (18)")


def test_every_control_has_a_name(stepramp: StepRampPage) -> None:
    script = """() => [...document.querySelectorAll('button, input, select, textarea')]
        .filter((one) => !one.labels?.length && !one.getAttribute('aria-label') && !one.textContent.trim())
        .map((one) => one.outerHTML)"""
    assert stepramp.page.evaluate(script) == []
