"""Values that can't be used: told at their field, never lost, and the last good plots stay."""

import pytest
from playwright.sync_api import expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until


@pytest.fixture
def stepramp(module_page: StepRampPage, module_watch: Watch, server: Server) -> StepRampPage:
    del server  # it lets go of devices after each test
    module_watch.expected.append(REFUSED_VALUE)
    module_page.start_over()
    return module_page


TOLD = {"": "empty", "-5": "-5", "0": "0", "2000000": "2,000,000", "1e400": "1e400"}
NONSENSE = ["abc", "NaN", "1,5", "12 34", *TOLD]


def test_nonsense_is_told_at_its_field_and_stays_there(stepramp: StepRampPage) -> None:
    before = stepramp.curves()
    field, message = stepramp.field(SLEW_SPEED), stepramp.message(SLEW_SPEED)
    for text in NONSENSE:
        field.fill(text)
        expect(message).to_contain_text(f"Slew speed is {TOLD.get(text, repr(text))};")
        expect(message).to_contain_text("a number from 0.001 to 1,000,000 steps/s")
        expect(field).to_have_attribute("aria-invalid", "true")
        assert field.get_attribute("aria-describedby") == message.get_attribute("id")
        field.blur()
        assert field.input_value().replace(",", "") == text.replace(",", "")
        assert stepramp.curves() == before
        expect(stepramp.page.locator(".stale-note")).to_be_visible()


def test_a_value_put_right_takes_the_message_away(stepramp: StepRampPage) -> None:
    field = stepramp.field(SLEW_SPEED)
    field.fill("abc")
    expect(field).to_have_attribute("aria-invalid", "true")
    field.fill("800")
    expect(stepramp.message(SLEW_SPEED)).to_have_count(0)
    expect(field).to_have_attribute("aria-invalid", "false")
    expect(stepramp.page.locator(".stale-note")).to_be_hidden()
    until(lambda: max(stepramp.curves()["exact-velocity"]) == 800)


def test_several_wrong_values_are_told_at_once_each_at_its_place(stepramp: StepRampPage) -> None:
    stepramp.field("timer.counter_bits").fill("2.5")
    stepramp.field("move.steps").fill("0")
    stepramp.page.locator("#table-1-1").fill("x")
    expect(stepramp.message("timer.counter_bits")).to_contain_text("Counter is 2.5")
    expect(stepramp.message("move.steps")).to_contain_text("Distance is 0")
    expect(stepramp.page.locator("#table-1-message")).to_contain_text("Row 2, delay, is 'x'")
    expect(stepramp.page.locator("#table-1-1")).to_have_attribute("aria-describedby", "table-1-message")
    stepramp.page.locator("#table-1-1").fill("4000")
    stepramp.page.locator("#table-2-0").fill("1")
    expect(stepramp.page.locator("#table-2-message")).to_contain_text("Row 3, last index, is 1")
    expect(stepramp.page.locator("#table-1-message")).to_have_count(0)


def test_a_number_outside_the_slider_is_taken_as_it_is(stepramp: StepRampPage) -> None:
    stepramp.edit_and_wait(SLEW_SPEED, "5,000")  # below it, so steep a ramp has no steps and that is warned of
    stepramp.edit_and_wait(ACCELERATION, "2,500,000")
    expect(stepramp.field(ACCELERATION)).to_have_value("2,500,000")
    expect(stepramp.message(ACCELERATION)).to_have_count(0)
    stepramp.field(ACCELERATION).blur()
    expect(stepramp.field(ACCELERATION)).to_have_value("2,500,000")


def test_the_deceleration_follows_the_acceleration_until_it_is_set(stepramp: StepRampPage) -> None:
    field = stepramp.field("ramp.deceleration_steps_per_s2")
    stepramp.edit_and_wait(ACCELERATION, "2000")
    expect(field).to_have_value("")
    expect(field).to_have_attribute("placeholder", "2,000")
    before = stepramp.curves()["exact-velocity"]
    field.fill("800")
    until(lambda: stepramp.curves()["exact-velocity"] != before)
    field.fill("")
    until(lambda: stepramp.curves()["exact-velocity"] == before)


def test_a_warning_stands_at_its_field_and_the_plots_go_on(stepramp: StepRampPage) -> None:
    stepramp.field("timer.shortest_interval_us").fill("5000")
    message = stepramp.message("timer.shortest_interval_us")
    expect(message).to_have_class("message warning")
    expect(stepramp.page.locator(".stale-note")).to_be_hidden()


def test_a_wrong_design_is_not_pushed_and_a_wrong_move_not_made(stepramp: StepRampPage) -> None:
    stepramp.connect()
    stepramp.push()
    for text in ("abc", "1.5", "1e12"):
        stepramp.move(text)
        expect(stepramp.page.locator("#move-steps")).to_have_attribute("aria-invalid", "true")
        expect(stepramp.page.locator("#move-steps-message")).to_contain_text("a whole number")
    assert stepramp.devices()[0]["position_steps"] == 0
    stepramp.field(SLEW_SPEED).fill("fast")
    expect(stepramp.page.locator("#push-reason")).to_have_text("Correct the design first.")
    expect(stepramp.page.locator("#push")).to_be_disabled()
