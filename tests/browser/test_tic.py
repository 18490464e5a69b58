"""The page with a Pololu Tic behind a pseudo-terminal: connected as one, pushed to, moved, and what hinders that."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from browser.conftest import Watch, finding
from browser.stepramp_page import ACCELERATION, LOST, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until
from controllers.tic.emulator import TicOnACable

TRIES = 3
"""On a busy machine the emulator may come too late to be known as a Tic."""
NO_TIC = r"status of (409|502).*/api/v1/devices$"
SIZES = [(1440, 900), (1024, 768), (390, 844)]


@pytest.fixture
def cable(watch: Watch) -> Iterator[TicOnACable]:
    watch.expected += [LOST, NO_TIC]
    with TicOnACable() as made:
        yield made


@pytest.fixture
def attached(open_page: Callable[..., StepRampPage], cable: TicOnACable) -> StepRampPage:
    """Return a page that finds the Tic's port, and the virtual one."""
    stepramp = open_page(prepare=finding(cable.port, "A Tic"))
    stepramp.show_panel("device")
    return stepramp


@pytest.fixture
def connected(attached: StepRampPage, cable: TicOnACable) -> StepRampPage:
    connect(attached, cable)
    return attached


def connect(stepramp: StepRampPage, cable: TicOnACable) -> None:
    stepramp.page.locator("#port").select_option(cable.port)
    stepramp.page.locator("#family").select_option("tic")
    for _ in range(TRIES):
        stepramp.page.locator("#connect").click()
        until(lambda: stepramp.state.inner_text() == "ready" or is_refused(stepramp))
        if not is_refused(stepramp):
            break
    expect(stepramp.state).to_have_text("ready")


def is_refused(stepramp: StepRampPage) -> bool:
    button = stepramp.page.locator("#connect")
    return button.is_enabled() and button.inner_text() == "Connect"


def live_line(page: Page) -> dict[str, Any]:
    """Return how the samples of the last move are drawn, and how many dots are seen of them."""
    script = """() => { const figure = document.querySelector('.figure');
        const trace = figure.data.find((one) => one.uid === 'live-velocity');
        return trace && {mode: trace.mode, samples: trace.x.length,
            dots: figure.querySelectorAll('.tracelive-velocity .point').length,
            lines: figure.querySelectorAll('.tracelive-velocity .js-line').length}; }"""
    return page.evaluate(script) or {}


def cut_off(page: Page) -> list[str]:
    """Return what of the device panel is cut off at its right."""
    script = """() => [...document.querySelectorAll('#device :is(th, td, table, .push-head span, label)')]
        .filter((one) => one.offsetParent && (one.scrollWidth > one.clientWidth + 1 ||
            one.getBoundingClientRect().right > one.closest('#device').getBoundingClientRect().right))
        .map((one) => one.innerText)"""
    return page.evaluate(script)


def test_a_tic_at_the_page(connected: StepRampPage, cable: TicOnACable) -> None:
    page = connected.page
    for speed in (900, 800):
        connected.edit_and_wait(SLEW_SPEED, str(speed))
        expect(page.locator("#push-preview")).to_contain_text("A push would change")
        connected.push()
        expect(page.locator("#push-preview")).to_contain_text("The device has this ramp")
        assert cable.tic.ramp[1] == speed * 10_000
    expect(page.locator("#device").get_by_text("is not kept: a Tic works")).to_have_count(1)
    expect(page.locator("#push-report .push-head span")).to_have_text("24 bytes")
    connected.move("300")
    until(lambda: cable.tic.position == 300)
    expect(connected.state).to_have_text("ready")
    cable.tic.press("kill_switch")
    expect(page.locator("#device .problem").first).to_contain_text("The Tic can't move: its kill switch is active")
    cable.tic.press("kill_switch", False)
    connected.move("200")
    until(lambda: cable.tic.position == 500)
    expect(page.locator("#device .problem").first).to_be_empty()


def test_a_tic_is_offered_the_one_ramp_that_it_can_have(connected: StepRampPage, cable: TicOnACable) -> None:
    page = connected.page
    expect(page.locator("#push")).to_contain_text("Push \u2018")
    expect(page.locator("#device-axis")).to_be_hidden()
    connected.push()
    expect(page.locator("#device-axis")).to_be_hidden()
    page.get_by_role("button", name="Add an axis").click()
    connected.edit_and_wait(SLEW_SPEED, "600")
    expect(page.locator("#push")).to_contain_text("Push \u2018")
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    expect(page.locator("#push-problem")).to_be_empty()
    connected.push()
    assert cable.tic.ramp[1] == 600 * 10_000
    # The other one comes into view.
    page.locator("#axes").get_by_text("Lead-screw stage").first.click()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    connected.push()
    assert cable.tic.ramp[1] == 1000 * 10_000


def test_what_a_tic_cant_play_is_told_in_the_words_of_the_page(connected: StepRampPage, watch: Watch) -> None:
    page = connected.page
    watch.expected.append(REFUSED_VALUE)
    # By its guide a Tic counts accelerations from 1 step/s².
    connected.edit_and_wait(ACCELERATION, "0.5")
    expect(page.locator("#push-problem")).to_contain_text("Acceleration is 0.5; allowed: a number from 1 to")
    expect(page.locator("#push")).to_be_disabled()
    connected.edit_and_wait(ACCELERATION, "4000")
    expect(page.locator("#push-problem")).to_be_empty()
    connected.push()


def test_rolling_back_shows_the_changes_again(connected: StepRampPage) -> None:
    page = connected.page
    connected.push()
    page.locator("#roll-back").click()
    expect(page.locator("#roll-back")).to_be_hidden()
    expect(page.locator("#push-progress")).to_be_hidden()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")


def test_a_lost_tic_is_offered_no_more_than_before(connected: StepRampPage, cable: TicOnACable) -> None:
    page = connected.page
    connected.push()
    cable.unplug()
    expect(connected.state).to_have_text("lost")
    for button in ("#try", "#restore", "#keep-ramp"):
        expect(page.locator(button)).to_be_hidden()
    connected.device_section("trace")
    expect(page.locator("#trace-note")).to_have_text("This controller can’t tell when it made its steps.")


def test_the_family_is_remembered_with_the_port(attached: StepRampPage, cable: TicOnACable) -> None:
    page = attached.page
    family = page.get_by_label("Family of the controller", exact=True)
    connect(attached, cable)
    page.locator("#connect").click()
    expect(attached.state).to_have_text("not connected")
    page.locator("#port").select_option("sim://")
    expect(family).to_be_hidden()
    expect(page.locator("#only-family")).to_have_text("StepRamp")
    attached.reload()
    expect(page.locator("#port")).to_have_value("sim://")
    page.locator("#port").select_option(cable.port)
    expect(family).to_have_value("tic")


def test_a_port_its_family_and_connect_follow_each_other_by_keyboard(
    attached: StepRampPage, cable: TicOnACable
) -> None:
    page = attached.page
    focused = "() => document.activeElement.id"
    page.locator("#port").select_option(cable.port)
    page.locator("#family").select_option("tic")
    page.locator("#port").focus()
    order = []
    for _ in range(4):
        page.keyboard.press("Tab")
        order.append(page.evaluate(focused))
    assert order == ["refresh-ports", "family", "find-family", "connect"]
    for state in ("ready", "not connected"):
        page.keyboard.press("Enter")
        expect(attached.state).to_have_text(state)
        expect(page.locator("#connect")).to_be_focused()


def test_few_samples_of_a_move_are_dots_and_many_a_line(connected: StepRampPage, cable: TicOnACable) -> None:
    connected.push()
    connected.move("100")
    until(lambda: cable.tic.position == 100)
    expect(connected.state).to_have_text("ready")
    until(lambda: live_line(connected.page).get("dots", 0) >= 2)
    few = live_line(connected.page)
    assert (few["mode"], few["dots"], few["lines"]) == ("markers", few["samples"], 0)
    connected.move("2000")
    until(lambda: cable.tic.position == 2100)
    until(lambda: live_line(connected.page).get("lines") == 1)
    assert live_line(connected.page)["dots"] == 0


@pytest.mark.parametrize("size", SIZES)
def test_no_figure_of_a_push_is_cut_off(connected: StepRampPage, size: tuple[int, int]) -> None:
    page = connected.page
    page.set_viewport_size({"width": size[0], "height": size[1]})
    connected.show_panel("device")
    assert cut_off(page) == []
    connected.push()
    assert cut_off(page) == []
    page.locator("#connect").click()
    expect(connected.state).to_have_text("not connected")
    connected.connect()
    expect(page.locator("#push-preview")).to_be_visible()
    assert cut_off(page) == []
    connected.push()
    assert cut_off(page) == []
    expect(page.locator("#push-report tbody th").last).to_have_text("Ramp image CRC")
