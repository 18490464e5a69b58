"""The page with a FluidNC at a pseudo-terminal: its long names, a ramp that is tried, and the cable that comes out."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Route, expect

from browser.conftest import Watch
from browser.stepramp_page import LOST, SLEW_SPEED, StepRampPage, until
from browser.test_tic import cut_off
from controllers.fluidnc.emulator import FluidNcOnACable

SIZES = [(1440, 900), (1024, 768), (720, 450), (390, 844)]


@pytest.fixture
def cable(watch: Watch) -> Iterator[FluidNcOnACable]:
    watch.expected.append(LOST)
    with FluidNcOnACable() as made:
        yield made


@pytest.fixture
def connected(stepramp: StepRampPage, cable: FluidNcOnACable) -> StepRampPage:
    def told(route: Route) -> None:
        answer = route.fetch(max_retries=2)
        known = answer.json()
        others = [family["name"] for family in known["families"]]
        known["ports"].insert(0, {"port": cable.port, "name": "A FluidNC", "virtual": False, "families": others})
        route.fulfill(response=answer, json=known)

    page = stepramp.page
    page.route("**/api/v1/ports", told)
    stepramp.reload()
    stepramp.show_panel("device")
    page.locator("#port").select_option(cable.port)
    page.locator("#family").select_option("fluidnc")
    page.locator("#connect").click()
    expect(stepramp.state).to_have_text("ready")
    return stepramp


def test_a_ramp_is_tried_and_rolled_back_and_its_long_names_fit(
    connected: StepRampPage, cable: FluidNcOnACable
) -> None:
    page, before = connected.page, dict(cable.fluidnc.settings)
    connected.edit_and_wait(SLEW_SPEED, "900")
    expect(page.locator("#push-preview")).to_contain_text("max_rate_mm_per_min")
    connected.push()
    expect(page.locator("#push-report")).to_contain_text("Read back as sent")
    expect(page.locator("#push-report tbody tr").first).to_contain_text("216")
    assert cable.fluidnc.settings != before
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        connected.show_panel("device")
        assert cut_off(page) == [], (width, height)
    page.set_viewport_size({"width": 1440, "height": 900})
    page.locator("#roll-back").click()
    until(lambda: cable.fluidnc.settings == before)


def test_it_is_stopped_in_flight_and_lost_with_its_cable(connected: StepRampPage, cable: FluidNcOnACable) -> None:
    page, fluidnc = connected.page, cable.fluidnc
    connected.move("20000")
    until(lambda: fluidnc.position[0] > 200)
    page.locator("#stop").click()
    expect(connected.state).to_have_text("ready")
    steps = fluidnc.steps
    assert (fluidnc.is_moving, 200 < steps < 20_000) == (False, True)
    connected.move("20000")
    until(lambda: fluidnc.steps > steps + 200)
    cable.unplug()
    expect(connected.state).to_have_text("lost")
    expect(page.locator("#device .problem").first).to_contain_text("Axis 0 was moving, last heard of at")
