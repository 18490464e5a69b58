"""The page with FluidNC, Marlin, a TMCL module and Klipper: a ramp is tried, a move stopped, a cable comes out.

The whole path, from what a controller can't do to its backups, is shown with grbl.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass

import pytest
from playwright.sync_api import Browser, Page, expect

from browser.conftest import Watch, finding
from browser.server import Server
from browser.stepramp_page import GUIDE_CLOSED, LOST, SLEW_SPEED, StepRampPage, until
from browser.test_tic import cut_off
from controllers.fluidnc.emulator import FluidNcOnACable
from controllers.klipper.server import MoonrakerServer
from controllers.marlin.emulator import MarlinOnACable
from controllers.tmcl.emulator import ModuleOnACable, TmclEmulator

SIZES = [(1440, 900), (1024, 768), (720, 450), (390, 844)]


@dataclass(frozen=True)
class Plugged:
    """A controller on a cable. term: what it calls its speed; settings: those in use; position: of its axis 0."""

    family: str
    port: str
    term: str
    settings: Callable[[], object]
    position: Callable[[], int]
    unplug: Callable[[], None]


def fluidnc(plug_in: ExitStack) -> Plugged:
    cable = plug_in.enter_context(FluidNcOnACable())
    one = cable.fluidnc
    return Plugged(
        "fluidnc", cable.port, "max_rate_mm_per_min", lambda: dict(one.settings), lambda: one.position[0], cable.unplug
    )


def marlin(plug_in: ExitStack) -> Plugged:
    cable = plug_in.enter_context(MarlinOnACable())
    one = cable.marlin
    return Plugged("marlin", cable.port, "M203 X", lambda: repr(one.settings), lambda: one.position[0], cable.unplug)


def tmcl(plug_in: ExitStack) -> Plugged:
    module = TmclEmulator()
    module.has_been_up(60)
    cable = plug_in.enter_context(ModuleOnACable(module))
    chip = module.chip
    return Plugged("tmcl", cable.port, "VMAX", lambda: None, lambda: chip.position, cable.unplug)


@pytest.fixture(params=[fluidnc, marlin, tmcl], ids=lambda make: make.__name__)
def plugged(request: pytest.FixtureRequest, watch: Watch) -> Iterator[Plugged]:
    watch.expected.append(LOST)
    with ExitStack() as plug_in:
        yield request.param(plug_in)


@pytest.fixture
def connected(open_page: Callable[..., StepRampPage], plugged: Plugged) -> StepRampPage:
    stepramp = open_page(prepare=finding(plugged.port, "A controller"))
    connect(stepramp, plugged.port, plugged.family)
    return stepramp


def connect(stepramp: StepRampPage, port: str, family: str) -> None:
    stepramp.show_panel("device")
    stepramp.page.locator("#port").select_option(port)
    if stepramp.page.locator("#family").is_visible():
        stepramp.page.locator("#family").select_option(family)
    stepramp.page.locator("#connect").click()
    expect(stepramp.state).to_have_text("ready")


def try_it(page: Page) -> None:
    """Use the ramp without storing it: where nothing can be stored, that is what a push does."""
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    page.locator("#try" if page.locator("#try").is_visible() else "#push").click()
    expect(page.locator("#push-report")).to_contain_text("Read back as sent")


def test_a_ramp_is_tried_and_rolled_back_and_its_terms_fit(connected: StepRampPage, plugged: Plugged) -> None:
    page, before = connected.page, plugged.settings()
    connected.edit_and_wait(SLEW_SPEED, "900")
    expect(page.locator("#push-preview")).to_contain_text(plugged.term)
    try_it(page)
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        connected.show_panel("device")
        assert cut_off(page) == [], (width, height)
    page.set_viewport_size({"width": 1440, "height": 900})
    page.locator("#roll-back").click()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    until(lambda: plugged.settings() == before)


def test_it_is_stopped_in_flight_and_lost_with_its_cable(connected: StepRampPage, plugged: Plugged) -> None:
    page = connected.page
    try_it(page)
    begin = plugged.position()
    connected.move("20000")
    until(lambda: plugged.position() > begin + 200)
    page.locator("#stop").click()
    expect(connected.state).to_have_text("ready")
    stopped = plugged.position()
    assert begin + 200 < stopped < begin + 20_000
    connected.move("20000")
    until(lambda: plugged.position() > stopped + 200)
    plugged.unplug()
    expect(connected.state).to_have_text("lost")
    expect(page.locator("#device .problem").first).to_contain_text("Axis 0 was moving, last heard of at")


def test_a_klipper_is_tuned_and_stopped_over_its_server(browser: Browser) -> None:
    with MoonrakerServer() as moonraker, Server("--allow-remote-port", moonraker.host) as server:
        page = browser.new_page(base_url=server.url, viewport={"width": 1440, "height": 900})
        page.add_init_script(GUIDE_CLOSED)
        page.goto(server.url)
        stepramp = StepRampPage(page, server.url)
        stepramp.wait_for_plots()
        connect(stepramp, moonraker.address, "klipper")
        stepramp.edit_and_wait(SLEW_SPEED, "900")
        expect(page.locator("#push-preview")).to_contain_text("max_velocity")
        try_it(page)
        printer = moonraker.printer
        # 900 steps/s of 80 steps/mm.
        assert printer.velocity == pytest.approx(11.25)
        begin = printer.position[0]
        stepramp.move("8000")
        until(lambda: printer.position[0] > begin + 1)
        page.locator("#stop").click()
        expect(stepramp.state).to_have_text("ready")
        told = len(printer.scripts)
        assert begin + 1 < printer.position[0] < begin + 99
        stepramp.device_section("push")
        page.locator("#roll-back").click()
        until(lambda: printer.velocity == 300)
        assert not any("G1" in script for script in printer.scripts[told:])
        assert moonraker.moonraker.wrong == []
        page.close()
