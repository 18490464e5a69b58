"""The device panel: pushing with its differences first, every kind of move, jogging, two tabs, settings, units."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from browser.conftest import Watch
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

REFUSED = r"status of 4(09|22)"
FAR = 1_000_000


@pytest.fixture
def pushed(stepramp: StepRampPage) -> StepRampPage:
    stepramp.connect()
    stepramp.push()
    return stepramp


def device_of(page: StepRampPage) -> dict[str, Any]:
    [device] = page.devices()
    return device


def changes(page: StepRampPage) -> dict[str, tuple[str, str]]:
    rows = page.page.locator("#push-preview tbody tr").all()
    cells = [[cell.inner_text() for cell in row.locator("th, td").all()] for row in rows]
    return {name: (there, here) for name, there, here in cells}


def test_what_differs_is_shown_before_it_is_pushed(pushed: StepRampPage) -> None:
    page = pushed.page
    stored = device_of(pushed)["ramp"]["sequence"]
    expect(page.locator("#push-preview")).to_contain_text("The device has this ramp")
    pushed.edit_and_wait(SLEW_SPEED, "500")
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    differing = changes(pushed)
    # With 5,000 steps/s² 1,000 steps/s are reached in 100 steps, 500 in 25.
    assert differing["Up ramp steps"] == ("100", "25")
    assert differing["Slew interval µs"] == ("1,000.0", "2,000.0")
    assert "First interval µs" not in differing
    assert device_of(pushed)["ramp"]["sequence"] == stored, "nothing is sent by looking"
    pushed.push()
    expect(page.locator("#push-preview")).to_contain_text("The device has this ramp")
    assert device_of(pushed)["ramp"]["sequence"] == stored + 1


@pytest.mark.parametrize("height", [900, 720])
def test_the_tabs_stay_under_the_pointer(stepramp: StepRampPage, height: int) -> None:
    page = stepramp.page
    page.set_viewport_size({"width": 1440, "height": height})
    stepramp.connect()
    tabs, places = page.locator("#device-sections"), []

    def look(name: str) -> None:
        stepramp.device_section(name)
        box = tabs.bounding_box()
        places.append((name, box and box["y"]))

    for name in ("push", "move", "jog", "trace"):
        look(name)
    stepramp.push()
    for name in ("push", "jog", "push", "move", "trace"):
        look(name)
    stepramp.move("20")
    look("push")
    assert {place for _, place in places} == {places[0][1]}, places


@pytest.mark.parametrize("height", [640, 568, 540])
def test_a_section_that_opens_out_of_sight_comes_into_it(pushed: StepRampPage, height: int) -> None:
    page = pushed.page
    page.set_viewport_size({"width": 320, "height": height})
    pushed.show_panel("device")
    firsts = {"move": ".panel.device [data-value='by']", "jog": "#jog-speed", "trace": "#trace", "push": "#push"}
    for name, first in firsts.items():
        page.locator("#device").evaluate("(one) => { one.scrollTop = 0; scrollTo(0, 0); }")
        pushed.device_section(name)
        expect(page.locator(first)).to_be_in_viewport(ratio=1)
        expect(page.locator(f"#device-sections [data-value={name}]")).to_be_in_viewport(ratio=1)
        at_centre = """(one) => { const {x, y, width, height} = one.getBoundingClientRect();
            return one.contains(document.elementFromPoint(x + width / 2, y + height / 2)); }"""
        assert page.locator(first).evaluate(at_centre), "nothing lies over it"
        assert page.locator(f"#device-sections [data-value={name}]").evaluate(at_centre)
    assert page.evaluate("[scrollX, document.body.scrollTop]") == [0, 0]


def test_a_push_shows_how_far_it_has_come(stepramp: StepRampPage) -> None:
    stepramp.connect()
    script = """() => { window.seen = []; const box = document.querySelector('#push-progress');
        new MutationObserver(() => box.hidden || window.seen.push(box.innerText))
            .observe(box, {subtree: true, childList: true, attributes: true, characterData: true}); }"""
    stepramp.page.evaluate(script)
    stepramp.push()
    seen = stepramp.page.evaluate("() => window.seen")
    told = re.compile(r"^(Working out|Sending|Checking|Storing|Reading back)")
    assert seen
    assert all(told.match(text) for text in seen), seen
    expect(stepramp.page.locator("#push-progress")).to_be_hidden()


def test_try_then_keep_or_roll_back_and_restore(pushed: StepRampPage) -> None:
    page = pushed.page
    stored = device_of(pushed)["ramp"]["sequence"]
    pushed.edit_and_wait(SLEW_SPEED, "500")
    page.locator("#try").click()
    expect(page.locator("#keep-ramp")).to_be_visible()
    until(lambda: device_of(pushed)["on_trial"])
    page.locator("#roll-back").click()
    expect(page.locator("#keep-ramp")).to_be_hidden()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    # The report is of what was pushed, and says that it is there no more; the focus has gone on to what is there.
    expect(page.locator("#push-report")).to_contain_text("The device has another ramp since this push.")
    expect(page.locator("#push")).to_be_focused()
    page.locator("#try").click()
    page.locator("#keep-ramp").click()
    expect(page.locator("#keep-ramp")).to_be_hidden()
    expect(page.locator("#push-report")).not_to_contain_text("another ramp")
    assert (device_of(pushed)["on_trial"], device_of(pushed)["ramp"]["sequence"]) == (False, stored + 1)
    page.locator("#restore").click()
    until(lambda: device_of(pushed)["ramp"]["sequence"] == stored + 2)
    expect(page.locator("#restore")).to_be_focused()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    assert changes(pushed)["Slew interval µs"] == ("1,000.0", "2,000.0")


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


def press_and_hold(page: Page, name: str) -> None:
    page.locator(name).hover()
    page.mouse.down()


def at_rest(pushed: StepRampPage) -> int:
    until(lambda: device_of(pushed)["state"] == "ready")
    position: int = device_of(pushed)["position_steps"]
    return position


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


def test_a_jog_lasts_as_long_as_the_button_is_held(pushed: StepRampPage) -> None:
    pushed.device_section("jog")

    def has_gone_far() -> bool:
        device = device_of(pushed)
        # On a busy machine a page may be kept from renewing a jog's lease, as if it hung: it is pressed anew then.
        if device["state"] == "ready" and device["position_steps"] >= -200:
            pushed.page.mouse.up()
            press_and_hold(pushed.page, "#jog-left")
            until(lambda: device_of(pushed)["state"] == "moving")
        return bool(device["position_steps"] < -200)

    until(has_gone_far)
    expect(pushed.state).to_have_text("moving")
    pushed.page.mouse.up()
    assert at_rest(pushed) < -200


def test_a_jog_by_key(pushed: StepRampPage) -> None:
    pushed.device_section("jog")
    page = pushed.page
    page.locator("#jog-speed").fill("400")
    page.locator("#jog-right").focus()
    page.keyboard.down("Space")
    until(lambda: device_of(pushed)["speed_steps_per_s"] > 390)
    page.keyboard.up("Space")
    assert at_rest(pushed) > 0


def hide(page: Page) -> None:
    script = """() => { Object.defineProperty(document, 'hidden', {value: true, configurable: true});
        document.dispatchEvent(new Event('visibilitychange')); }"""
    page.evaluate(script)


def fall_silent(page: Page) -> None:
    """Let nothing more be said over the socket, which stays open: as if the page hung."""
    page.evaluate("() => { WebSocket.prototype.send = () => {}; WebSocket.prototype.close = () => {}; }")


@pytest.mark.parametrize(
    "end",
    [
        pytest.param(lambda page: page.close(), id="tab closed"),
        pytest.param(lambda page: page.reload(), id="reloaded"),
        pytest.param(hide, id="hidden"),
        pytest.param(fall_silent, id="silent"),
        pytest.param(lambda page: page.keyboard.press("Escape"), id="escape"),
    ],
)
def test_a_jog_ends_with_what_holds_it(pushed: StepRampPage, end: Callable[[Page], None]) -> None:
    pushed.device_section("jog")
    press_and_hold(pushed.page, "#jog-right")
    until(lambda: device_of(pushed)["position_steps"] > 40)
    end(pushed.page)
    place = at_rest(pushed)
    time.sleep(0.5)
    assert device_of(pushed)["position_steps"] == place


def test_running_at_a_speed_and_calling_the_place_something(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    pushed.device_section("jog")
    page.locator("#jog-speed").fill("99999")
    page.locator("#run-ahead").click()
    expect(page.locator("#jog-speed-message")).to_contain_text("Speed is 99,999")
    page.locator("#jog-speed").fill("300")
    page.locator("#run-back").click()
    until(lambda: device_of(pushed)["speed_steps_per_s"] > 290)
    expect(page.locator("#set-position-button")).to_be_disabled()
    page.locator("#stop").click()
    at_rest(pushed)
    page.locator("#set-position").fill("-50")
    page.locator("#set-position-button").click()
    expect(pushed.position).to_have_text("\u221250")


def test_the_measured_trace(pushed: StepRampPage) -> None:
    pushed.move("500")
    at_rest(pushed)
    pushed.device_section("trace")
    figures = pushed.page.locator("#trace-figures")
    expect(figures).to_contain_text("500, every one")
    # The virtual controller is never late.
    expect(figures).to_contain_text("0.00 µs")
    chip, removal = pushed.page.locator(".legend .trace"), pushed.page.locator("#remove-trace")
    expect(chip).to_be_visible()
    # What was told while it ran doesn't come in the place of what was measured.
    removal.click()
    expect(chip).to_be_hidden()
    pushed.device_section("trace")
    pushed.page.locator("#trace").uncheck()
    pushed.move("10")
    at_rest(pushed)
    expect(chip).to_be_visible()
    removal.click()
    expect(chip).to_be_hidden()
    pushed.device_section("trace")
    expect(figures).to_contain_text("500, every one")


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


def test_a_jog_takes_away_what_was_refused_before(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    pushed.device_section("jog")
    page.locator("#jog-speed").fill("99999")
    page.locator("#run-ahead").click()
    refused = page.locator("#jog-speed-message", has_text="99,999")
    expect(refused).to_be_visible()
    page.locator("#jog-speed").fill("300")
    press_and_hold(page, "#jog-right")
    until(lambda: device_of(pushed)["state"] == "moving")
    expect(refused).to_have_count(0)
    page.mouse.up()


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


def test_settings_are_explained_and_on_trial(pushed: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED)
    page = pushed.page
    page.locator("#settings").click()
    expect(page.locator("#setting-direction_setup_us")).to_have_value("30")
    expect(page.locator("#setting-pulse_width_us-hint")).to_contain_text("Least width")
    page.locator("#setting-pulse_width_us").fill("900")
    page.locator("#use-settings").click()
    message = page.locator("#setting-pulse_width_us-message")
    expect(message).to_have_text("Pulse width is 900; allowed: a whole number from 0 to 100 µs.")
    expect(page.locator("#setting-pulse_width_us")).to_be_focused()
    page.locator("#setting-pulse_width_us").fill("8")
    page.get_by_label("Direction inverted: axis 0").check()
    page.locator("#use-settings").click()
    expect(page.locator("#settings-dialog")).to_be_hidden()
    settings = pushed.ask(pushed.url, "GET", f"devices/{device_of(pushed)['id']}/settings")
    assert (settings["pulse_width_us"], settings["direction_inverted"]) == (8, [0])
    expect(page.locator("#keep-ramp")).to_be_visible()
    page.locator("#roll-back").click()
    until(lambda: not device_of(pushed)["on_trial"])


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


def test_two_tabs(open_page: Callable[..., StepRampPage], watch: Watch) -> None:
    watch.expected.append(REFUSED)
    first, second = open_page(), open_page()
    first.connect()
    first.push()
    expect(second.state).to_have_text("ready")
    expect(second.page.locator("#others")).to_be_visible()
    expect(first.page.locator("#others")).to_be_hidden()
    expect(second.page.locator("#push")).to_be_disabled()
    first.edit_and_wait(ACCELERATION, "1000")
    first.push()
    first.move(str(FAR))
    expect(second.state).to_have_text("moving")
    second.page.keyboard.press("Escape")
    until(lambda: device_of(first)["state"] == "ready")
    second.page.locator("#take-over").click()
    expect(second.page.locator("#others")).to_be_hidden()
    expect(first.page.locator("#others")).to_be_visible()
    second.move("10")
    at_rest(second)
    second.page.close()
    expect(first.page.locator("#others")).to_be_hidden()


def test_nothing_moves_by_undo_or_by_taking_a_look(pushed: StepRampPage) -> None:
    pushed.edit_and_wait(SLEW_SPEED, "500")
    sent: list[str] = []
    pushed.page.on("request", lambda request: sent.append(f"{request.method} {request.url}"))
    for section in ("move", "jog", "trace", "push"):
        pushed.device_section(section)
    pushed.page.keyboard.press("Control+z")
    pushed.page.keyboard.press("Control+Shift+z")
    pushed.page.wait_for_timeout(600)
    asked = [one for one in sent if "/devices/" in one and not one.endswith("/push/preview")]
    assert asked == []
    assert device_of(pushed)["position_steps"] == 0


def test_by_keyboard_only(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#port").focus()
    until(lambda: page.locator("#connect").is_enabled())
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(stepramp.state).to_have_text("ready")
    page.locator("#push").focus()
    page.keyboard.press("Enter")
    expect(page.locator(".push-head .verified")).to_be_visible(timeout=20_000)
    page.locator('#device-sections [data-value="push"]').focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.locator("#move-steps").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("25")
    page.keyboard.press("Enter")
    until(lambda: device_of(stepramp)["position_steps"] == 25)
