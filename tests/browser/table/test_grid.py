"""The rows of the lookup table in the grid."""

import re

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, StepRampPage
from browser.table.points import ROWS, assert_on_data, rows_of


def test_the_grid_is_worked_with_keys(start: StepRampPage) -> None:
    page = start.page
    page.locator("#table-1-1").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#table-2-1")).to_be_focused()
    page.keyboard.press("ArrowUp")
    expect(page.locator("#table-1-1")).to_be_focused()
    page.keyboard.press("Insert")
    assert rows_of(start)[2] == [11, 3957], "halfway between its neighbours"
    expect(page.locator("#table-2-0")).to_be_focused()
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="Delete row 3", exact=True)).to_be_focused()
    page.keyboard.press("Delete")
    assert rows_of(start) == ROWS
    page.keyboard.press("Control+z")
    assert len(rows_of(start)) == 7


def test_a_row_that_was_added_is_undone_while_it_has_the_focus(start: StepRampPage) -> None:
    page = start.page
    page.locator("#add-row").click()
    expect(page.locator("#table-6-0")).to_be_focused()
    page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS
    expect(page.locator("#table-rows tr.row")).to_have_count(len(ROWS))
    expect(page.locator("#table-5-0")).to_be_focused()
    expect(page.locator(".panel.table")).to_contain_text(f"{len(ROWS)} rows")


def test_what_is_typed_moves_the_point(start: StepRampPage) -> None:
    start.page.locator("#table-4-0").fill("50")
    start.page.locator("#table-4-1").fill("2000")
    assert_on_data(start, 4, 49, 2000)
    start.page.keyboard.press("Control+z")
    assert rows_of(start)[4] == [50, 1488]


def test_a_remark_is_marked_at_its_row_and_told_where_it_is_selected(start: StepRampPage) -> None:
    start.choose_example("Gauge")
    marked = start.page.locator("#table-rows tr.remarked")
    expect(marked).to_have_count(4)
    start.page.locator("#table-1-0").click()
    # Row 1 leads to 200 steps/s, row 2 to 666.7: (666.7² - 200²) / 2.
    expect(start.page.locator("#table-1-message")).to_contain_text("202,222 steps/s²")
    expect(start.page.locator("#table-2-message")).to_be_hidden()
    expect(start.page.locator("#table-1-0")).to_have_attribute("aria-invalid", "false")


def test_a_target_is_changed_in_flight_without_moving_anything(start: StepRampPage) -> None:
    start.choose_example("Gauge")
    start.page.locator(".table-foot").get_by_role("button", name="Simulate").click()
    start.page.locator("#play-first").fill("800")
    start.page.locator("#play-after").fill("300")
    start.page.locator("#play-second").fill("100")
    result = start.page.locator("#play-result")
    # After 300 ms it is past step 300, at top speed, and needs the 300 steps of its ramp to stop before it turns.
    expect(result).to_contain_text(re.compile(r"It turns at step 6\d\d\. At rest at step 100 after [\d,.]+ ms"))
    start.page.locator("#play-second").fill("2.5")
    expect(start.page.locator("#play-second-message")).to_have_text("“to” is 2.5; allowed: a whole number from 0 on.")
    expect(start.page.locator("#play-second")).to_have_attribute("aria-invalid", "true")
    expect(result).to_have_text("")
    start.page.keyboard.press("Escape")
    expect(start.page.locator("#play-dialog")).to_be_hidden()


def test_what_is_refused_of_a_simulation_is_told_at_its_field(start: StepRampPage, module_watch: Watch) -> None:
    module_watch.expected.append(REFUSED_VALUE)
    page = start.page
    start.choose_example("Gauge")
    page.locator(".table-foot").get_by_role("button", name="Simulate").click()
    steps = "a whole number from 0 to 9,999,999 steps"
    told = {
        "first": (f"“Go to” is 1,000,000,000,000; allowed: {steps}.", "1e12", "800"),
        "after": (
            "“and after” is 1,000,000,000,000; allowed: a whole number from 0 to 1,000,000,000 ms.",
            "1e12",
            "300",
        ),
        "second": (f"“to” is 10,000,000; allowed: {steps}.", "10000000", "100"),
    }
    for name, (_, _, right) in told.items():
        page.locator(f"#play-{name}").fill(right)
    for name, (text, wrong, right) in told.items():
        field = page.locator(f"#play-{name}")
        field.fill(wrong)
        expect(page.locator(f"#play-{name}-message")).to_have_text(text)
        expect(field).to_have_attribute("aria-invalid", "true")
        expect(field).to_have_attribute("aria-describedby", f"play-{name}-message play-result")
        expect(page.locator("#play-dialog [aria-invalid=true]")).to_have_count(1)
        expect(page.locator("#play-dialog svg.small-chart .line")).to_have_count(0)
        field.fill(right)
        expect(page.locator("#play-dialog [aria-invalid=true]")).to_have_count(0)
        expect(page.locator("#play-result")).to_contain_text("At rest at step 100")
    page.locator("#play-first").fill("9999999")
    page.locator("#play-second").fill("0")
    page.locator("#play-after").fill("1000000000")
    expect(page.locator("#play-result")).to_have_text(
        "Both moves together have too many steps; allowed: moves of at most 10,000,000 steps in all."
    )
    page.keyboard.press("Escape")
