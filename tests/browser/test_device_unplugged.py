"""A board that is unplugged in the middle of things and plugged in again; a server that ends and comes back."""

from __future__ import annotations

import json
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import ACCELERATION, LOST, SLEW_SPEED, StepRampPage, until
from controllers.board_process import BoardProcess
from stepramp.controllers.stepramp.messages.ramps import DataRequest

GONE = r"ERR_CONNECTION|WebSocket connection|ERR_INCOMPLETE"
FAR = 1_000_000


@pytest.fixture
def cable(tmp_path: Path, watch: Watch) -> Iterator[BoardProcess]:
    watch.expected.append(LOST)
    made = BoardProcess(tmp_path / "ttyACM7")
    made.plug_in()
    yield made
    made.end()


@pytest.fixture
def plugged(stepramp: StepRampPage, cable: BoardProcess) -> StepRampPage:
    """Return the page with the board connected by a program: a pseudo-terminal is in no list of ports."""
    body = json.dumps({"port": str(cable.port)}).encode()
    request = urllib.request.Request(
        f"{stepramp.url}api/v1/devices", body, {"Content-Type": "application/json"}, method="POST"
    )
    with urllib.request.urlopen(request, timeout=60):
        pass
    expect(stepramp.state).to_have_text("ready")
    expect(stepramp.page.locator("#port option:checked")).to_contain_text("ttyACM7")
    return stepramp


def device_of(page: StepRampPage) -> dict[str, Any]:
    [device] = page.devices()
    return device


def jog_until(page: StepRampPage, device: str, speed_steps_per_s: float) -> None:
    """Hold the button until a device jogs so fast; where a busy machine lets a jog run out, hold it again."""
    button = page.page.locator("#jog-right")

    def state() -> dict[str, Any]:
        return next(one for one in page.devices() if one["id"] == device)

    def is_over() -> bool:
        return state()["state"] == "stopping" or state()["speed_steps_per_s"] > speed_steps_per_s

    for _ in range(10):
        expect(button).to_be_enabled()
        button.hover()
        page.page.mouse.down()
        with suppress(AssertionError):
            until(is_over)
        if state()["speed_steps_per_s"] > speed_steps_per_s and state()["state"] == "moving":
            return
        page.page.mouse.up()
        until(lambda: state()["state"] == "ready")
    raise AssertionError(f"no jog came to {speed_steps_per_s} steps/s")


def test_unplugged_in_the_middle_of_a_push(plugged: StepRampPage, cable: BoardProcess) -> None:
    page = plugged.page
    plugged.push()
    plugged.edit_and_wait(SLEW_SPEED, "500")
    cable.unplug_at(DataRequest.KIND, after=2)
    page.locator("#push").click()
    expect(plugged.state).to_have_text("lost")
    expect(page.locator(".device .problem").first).to_contain_text(
        "the old ones or the new ones whole, never a mixture"
    )
    expect(page.locator("#push")).to_be_disabled()
    assert plugged.field(SLEW_SPEED).input_value() == "500"
    cable.unplug()
    cable.plug_in()
    expect(plugged.state).to_have_text("ready")
    assert device_of(plugged)["ramp"]["sequence"] == 1, "the ramp that it had"
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    plugged.push()
    assert device_of(plugged)["ramp"]["sequence"] == 2


def test_what_has_soft_limits_moves_again_once_its_position_is_set(
    plugged: StepRampPage, cable: BoardProcess, watch: Watch
) -> None:
    watch.expected.append(r"status of 409")
    page = plugged.page
    plugged.push()
    route = f"devices/{device_of(plugged)['id']}"
    # A board without a serial number may be taken for the one that another test lost where this one is now.
    plugged.ask(plugged.url, "POST", f"{route}/position", {"position_steps": 0})
    plugged.ask(plugged.url, "PUT", f"{route}/soft_limits", {"axes": [{"axis": 0, "highest_steps": 1000}]})
    expect(page.locator("#live-limits")).to_have_text("Soft limits: up to 1,000 steps")
    cable.unplug()
    expect(plugged.state).to_have_text("lost")
    cable.plug_in()
    expect(plugged.state).to_have_text("ready")
    expect(page.locator("#live-limits")).to_have_text(
        "Soft limits: up to 1,000 steps. It moves once its position is set"
    )
    plugged.move("5")
    expect(page.locator(".device")).to_contain_text("Axis 0 may be elsewhere than counted")
    plugged.ask(plugged.url, "POST", f"{route}/position", {"position_steps": 900})
    expect(page.locator("#live-limits")).to_have_text("Soft limits: up to 1,000 steps")
    plugged.move("5")
    until(lambda: device_of(plugged)["position_steps"] == 905)
    # They are of whatever is plugged in there, also in the next test.
    plugged.ask(plugged.url, "PUT", f"{route}/soft_limits", {"axes": [{"axis": 0}]})


def test_unplugged_in_the_middle_of_a_move(plugged: StepRampPage, cable: BoardProcess) -> None:
    page = plugged.page
    plugged.push()
    plugged.move(str(FAR))
    until(lambda: device_of(plugged)["position_steps"] > 100)
    cable.unplug()
    expect(plugged.state).to_have_text("lost")
    expect(page.locator(".device .problem").first).to_contain_text("Axis 0 was moving, last heard of at")
    expect(page.locator("#move-reason")).to_have_text("Connect a device first.")
    cable.plug_in()
    expect(plugged.state).to_have_text("ready")
    expect(page.locator("#unknown-position")).to_be_visible()
    expect(plugged.position).to_have_text("0")
    page.wait_for_timeout(500)
    assert device_of(plugged)["position_steps"] == 0, "it doesn't go on by itself"
    plugged.device_section("jog")
    page.locator("#set-position").fill("1234")
    page.locator("#set-position-button").click()
    expect(page.locator("#unknown-position")).to_be_hidden()
    expect(plugged.position).to_have_text("1,234")


def test_unplugged_while_jogging_and_plugged_in_while_still_held(plugged: StepRampPage, cable: BoardProcess) -> None:
    plugged.push()
    plugged.device_section("jog")
    plugged.page.locator("#jog-right").hover()
    plugged.page.mouse.down()
    until(lambda: device_of(plugged)["state"] == "moving")
    cable.unplug()
    expect(plugged.state).to_have_text("lost")
    cable.plug_in()
    expect(plugged.state).to_have_text("ready")
    plugged.page.wait_for_timeout(500)
    assert device_of(plugged)["position_steps"] == 0
    plugged.page.mouse.up()


def test_a_stop_owes_the_lost_one_while_another_slows_down(plugged: StepRampPage, cable: BoardProcess) -> None:
    """Whatever slows down by itself, a press stops all, and what is out of reach is told whichever device is chosen."""
    page = plugged.page
    board = device_of(plugged)["id"]

    def state_of(device: str) -> str:
        return next(one["state"] for one in plugged.devices() if one["id"] == device)

    plugged.push()
    plugged.move(str(FAR))
    until(lambda: state_of(board) == "moving")
    plugged.edit_and_wait(ACCELERATION, "100")
    plugged.connect()
    plugged.push()
    jogged = next(one["id"] for one in plugged.devices() if one["id"] != board)
    plugged.device_section("jog")
    page.locator("#jog-speed").fill("900")
    jog_until(plugged, jogged, 800)
    cable.unplug()
    notice = page.locator(".summary-messages")
    expect(notice).to_contain_text("is out of reach since it moved, and may still move.")
    page.mouse.up()
    until(lambda: state_of(jogged) == "stopping")
    expect(plugged.state).to_have_text("stopping")
    expect(page.locator("#stop")).to_contain_text("STOP")
    before = {one["id"]: one["stops"] for one in plugged.devices()}
    page.keyboard.press("Escape")
    until(lambda: all(one["stops"] > before[one["id"]] for one in plugged.devices()))
    expect(notice).to_contain_text("is out of reach: it is stopped as soon as it answers.")
    expect(page.locator("#stop")).to_contain_text("HALT")
    assert state_of(jogged) == "stopping", "a first press halts nothing"
    page.keyboard.press("Escape")
    until(lambda: state_of(jogged) == "ready")
    expect(notice).to_contain_text("is out of reach: it is stopped as soon as it answers.")
    cable.plug_in()
    until(lambda: state_of(board) == "ready")
    expect(notice).to_be_hidden()


def on_own_server(browser: Browser, act: Callable[[StepRampPage, Server], None]) -> None:
    with Server() as server:
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        page = context.new_page()
        watch = Watch(server.url)
        watch.expected.append(GONE)
        watch.follow(page)
        act(StepRampPage(page, server.url).open(), server)
        context.close()
        watch.check()


def test_the_server_ends_in_the_middle_of_a_move_and_comes_back(browser: Browser) -> None:
    def act(stepramp: StepRampPage, server: Server) -> None:
        page = stepramp.page
        stepramp.edit_and_wait(ACCELERATION, "2000")
        stepramp.connect()
        stepramp.push()
        stepramp.move(str(FAR))
        expect(stepramp.state).to_have_text("moving")
        server.stop()
        expect(page.locator("#server-state")).to_contain_text("Server gone")
        expect(page.locator("#move-reason")).to_have_text("The server is gone.")
        server.start()
        expect(page.locator("#server-state")).to_have_text("server connected")
        expect(stepramp.state).to_have_text("not connected")
        stepramp.connect()
        page.wait_for_timeout(500)
        assert (device_of(stepramp)["state"], device_of(stepramp)["position_steps"]) == ("ready", 0)
        assert stepramp.field(ACCELERATION).input_value() == "2,000"

    on_own_server(browser, act)
