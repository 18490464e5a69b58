"""What the browser keeps."""

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage


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


def test_a_stored_document_that_makes_no_sense_is_set_aside(stepramp: StepRampPage) -> None:
    for text in ("{not json", '{"schema": "stepramp/9"}'):
        stepramp.page.evaluate("(text) => localStorage.setItem('stepramp.work', text)", text)
        stepramp.reload()
        expect(stepramp.page.locator(".design-name")).to_have_value("Lead-screw stage")
        assert stepramp.page.evaluate("localStorage.getItem('stepramp.work.unreadable')") == text


def test_a_stored_document_with_unknown_parts_is_told_and_can_be_left(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    script = """() => { const state = JSON.parse(localStorage.getItem('stepramp.work')); state.axes[0].extra = 1;
        localStorage.setItem('stepramp.work', JSON.stringify(state)); }"""
    stepramp.page.evaluate(script)
    stepramp.page.reload()
    expect(stepramp.page.locator(".summary-messages")).to_contain_text("extra")
    stepramp.choose_example("Gauge")
    stepramp.wait_for_plots()
    expect(stepramp.page.locator(".summary-messages")).to_be_hidden()
