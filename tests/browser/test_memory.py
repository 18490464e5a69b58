"""What the browser keeps."""

import pytest
from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until


def test_the_design_outlives_two_reloads(stepramp: StepRampPage) -> None:
    stepramp.edit_and_wait(SLEW_SPEED, "1234")
    stepramp.page.locator(".design-name").fill("Mine")
    stepramp.paste_into_table("{10, 5000}, {30, 1500}")
    for _ in range(2):
        stepramp.reload()
        expect(stepramp.field(SLEW_SPEED)).to_have_value("1,234")
        expect(stepramp.page.locator(".design-name")).to_have_value("Mine")
        assert stepramp.table_rows() == [["10", "5,000"], ["30", "1,500"]]


def test_a_wrong_value_is_kept_and_told_again(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    stepramp.field(SLEW_SPEED).fill("12o0")
    expect(stepramp.message(SLEW_SPEED)).to_contain_text("'12o0'")
    stepramp.page.reload()
    expect(stepramp.field(SLEW_SPEED)).to_have_value("12o0")
    expect(stepramp.message(SLEW_SPEED)).to_contain_text("'12o0'")
    stepramp.field(SLEW_SPEED).fill("1200")
    stepramp.wait_for_plots()


def test_a_stored_document_that_makes_no_sense_is_left_alone(stepramp: StepRampPage) -> None:
    stepramp.edit_and_wait(SLEW_SPEED, "1234")
    stepramp.keep(machine={"schema": "stepramp/9"})
    stepramp.reload()
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,000")
    assert "stepramp/9" in stepramp.page.evaluate("JSON.stringify(localStorage)")


def test_a_stored_document_with_unknown_parts_is_told_and_can_be_left(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    machine = stepramp.kept()["machine"]
    machine["axes"][0]["extra"] = 1
    stepramp.keep(machine=machine)
    stepramp.page.reload()
    expect(stepramp.page.locator(".summary-messages")).to_contain_text("extra")
    stepramp.choose_example("Gauge")
    stepramp.wait_for_plots()
    expect(stepramp.page.locator(".summary-messages")).to_be_hidden()


def test_how_the_plots_are_looked_at_outlives_a_reload(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator('#axis-choice [data-value="time"]').click()
    page.locator("#show-acceleration").click()
    page.locator(".figure").hover(position={"x": 300, "y": 200})
    page.mouse.wheel(0, -400)
    until(lambda: [view["zoom"] is not None for view in stepramp.kept()["views"].values()] == [True])
    [before] = [*stepramp.kept()["views"].values()]
    stepramp.reload()
    expect(page.locator('#axis-choice [data-value="time"]')).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#show-acceleration")).to_have_attribute("aria-pressed", "true")
    until(lambda: stepramp.x_axis()["range"] == pytest.approx(before["zoom"]))
    assert before["against"] == "time"
