"""From an empty browser to a motor that has moved."""

import re

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

GAUGE_TABLE = """unsigned short accelTable[][2] = {
  {   10, 5000},  // slow
  {   30, 1500},
  {  100, 1000},
  {  150,  800},
  {  300,  600}
};
"""
GAUGE_ROWS = [["10", "5,000"], ["30", "1,500"], ["100", "1,000"], ["150", "800"], ["300", "600"]]


def test_from_opening_the_page_to_the_final_position(stepramp: StepRampPage) -> None:
    page = stepramp.page
    expect(page.locator(".design-name")).to_have_value("Lead-screw stage")
    before = stepramp.curves()
    stepramp.edit_and_wait(SLEW_SPEED, "1,500")
    after = stepramp.curves()
    for curve in ("exact-velocity", "exact-delay", "first_order-error", "table-error"):
        assert after[curve] != before[curve]
    assert max(after["exact-velocity"]) == 2_000_000 / 1333, "in whole ticks of 2 MHz"

    page.locator("#paste-table").click()
    page.locator("#paste-text").fill(GAUGE_TABLE)
    expect(page.locator("#paste-preview tbody tr")).to_have_count(5)
    page.get_by_role("button", name="Use 5 rows").click()
    assert stepramp.table_rows() == GAUGE_ROWS
    until(lambda: max(stepramp.curves()["table-delay"]) == 5000)

    stepramp.connect()
    stepramp.push()
    expect(page.locator(".push-details tbody tr")).not_to_have_count(0)
    expect(page.locator(".push-details td.differs")).to_have_count(0)
    assert stepramp.devices()[0]["ramp"]["sequence"] >= 1

    stepramp.move("4000")
    expect(stepramp.state).to_have_text("moving")
    expect(stepramp.position).to_have_text("4,000")
    expect(stepramp.state).to_have_text("ready")
    stepramp.move("-1,100", kind="to")
    expect(stepramp.position).to_have_text("−1,100")
    assert stepramp.devices()[0]["position_steps"] == -1100


def test_changing_the_design_after_a_push_is_told(stepramp: StepRampPage) -> None:
    stepramp.connect()
    stepramp.push()
    expect(stepramp.page.get_by_text("The design has changed since this push.")).to_have_count(0)
    stepramp.edit_and_wait(SLEW_SPEED, "900")
    expect(stepramp.page.get_by_text("The design has changed since this push.")).to_be_visible()
    expect(stepramp.page.locator("#push")).to_have_text(re.compile("^Push \u2018.*\u2019 by Exact$"))
    report = stepramp.page.locator("#push-report .push-details")
    rows = "(box) => [getComputedStyle(box).overflowY, getComputedStyle(box).maxHeight]"
    assert report.locator(".push-rows").evaluate(rows) == ["auto", "172px"], "more of them are scrolled to"
    stepramp.page.get_by_label("Close the report").click()
    expect(report).to_be_hidden()
    stepramp.push()
    expect(report).to_be_visible()


def test_each_example_can_be_shown_and_the_design_it_replaced_had_back(stepramp: StepRampPage) -> None:
    examples = stepramp.ask(stepramp.url, "GET", "examples")["examples"]
    assert len(examples) == 3
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    for example in examples:
        stepramp.choose_example(example["title"])
        design = example["design"]
        expect(stepramp.page.locator(".design-name")).to_have_value(design["name"])
        expect(stepramp.page.locator("#method")).to_have_value(design["method"]["name"])
        steps = design["move"]["steps"]
        until(lambda count=steps: f"{count:,} steps" in stepramp.figure_text("duration"))
        expect(stepramp.page.locator(".message:not(.warning)")).to_have_count(0)
    stepramp.choose_example("Back to")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")


def test_the_table_can_be_edited_row_by_row(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)  # on the way to 500, after a row up to 101, stands a 5
    page = stepramp.page
    count = len(stepramp.table_rows())
    page.locator("#add-row").click()
    expect(page.locator("#table-rows tr.row")).to_have_count(count + 1)
    page.keyboard.type("500")
    assert stepramp.table_rows()[-1][0] == "500"
    page.locator("#table-0-1").fill("9000")
    until(lambda: max(stepramp.curves()["table-delay"]) == 9000)
    page.get_by_role("button", name="Delete row 1", exact=True).click()
    expect(page.locator("#table-rows tr.row")).to_have_count(count)
    page.locator("#interval-unit").select_option("ticks")
    assert stepramp.table_rows()[0][1] == "9,566", "4,783 µs at 2 MHz"
    for number in range(count, 0, -1):
        page.get_by_role("button", name=f"Delete row {number}", exact=True).click()
    expect(page.locator('.chip[data-method="table"]')).to_contain_text("no rows")
    expect(page.locator(".message:not(.warning)")).to_have_count(0)
    page.locator("#method").select_option("table")
    expect(page.locator(".panel.table .message")).to_contain_text("Lookup table is missing")
    expect(page.locator(".stale-note")).to_be_visible()
    page.locator("#add-row").click()
    expect(page.locator(".stale-note")).to_be_hidden()


def test_a_table_pasted_into_the_grid_replaces_the_rows_and_can_be_undone(stepramp: StepRampPage) -> None:
    before = stepramp.table_rows()
    stepramp.paste_into_table("{ 10, 5000 }, { 30, 1500 }")
    assert stepramp.table_rows() == GAUGE_ROWS[:2]
    stepramp.page.get_by_role("button", name=re.compile("before back")).click()
    assert stepramp.table_rows() == before


def test_text_that_is_no_table_is_explained(stepramp: StepRampPage) -> None:
    before = stepramp.table_rows()
    stepramp.paste_into_table("{ 10, 5000 }, { 30, fast }")
    expect(stepramp.page.locator("#paste-preview")).to_contain_text("Row 2: “fast” is not a number.")
    expect(stepramp.page.get_by_role("button", name="Use the rows")).to_be_disabled()
    stepramp.page.get_by_role("button", name="Cancel").click()
    assert stepramp.table_rows() == before


def test_a_push_that_is_too_long_is_mended_by_a_button(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(r"status of 422.*push/preview")
    page = stepramp.page
    stepramp.connect()
    page.get_by_role("button", name="Add an axis").click()
    stepramp.edit_and_wait(SLEW_SPEED, "15000")
    stepramp.edit_and_wait(ACCELERATION, "3000")
    refused = page.locator("#push-problem")
    expect(refused).to_contain_text("Too long for this controller")
    page.get_by_role("tab", name="0").click()
    expect(page.locator(".axis-tab.refused .axis-number")).to_have_text("1")
    refused.get_by_role("button", name="Raise the acceleration").click()
    expect(page.locator("#push-preview")).to_contain_text("A push would change")
    expect(refused).to_be_empty()
    expect(page.locator(".axis-tab[aria-selected=true] .axis-number")).to_have_text("1")
    expect(page.locator(".axis-tab.refused")).to_have_count(0)
    page.keyboard.press("Control+z")
    expect(refused).to_contain_text("Too long for this controller")
