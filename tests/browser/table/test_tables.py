"""Whole tables: from files, for the axis they were asked for, as the method, and fitted again."""

import re

from playwright.sync_api import Locator, expect

from browser.conftest import Watch
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, drop_file
from browser.table.points import ROWS, rows_of

SOURCE = """#include "tables.h"
#define COLUMNS 2
const uint16_t slow[][COLUMNS] PROGMEM = { {10, 5000}, {30, 1500} };
const uint16_t fast[][2] = { {5, 4000UL}, {20, (uint16_t)0x3E8}, {99, 800}, };
const uint8_t pins[] = { 4, 5, 6 };
int main() { return 0; }
"""


def undo_text(field: Locator, before: str) -> None:
    """Press Ctrl+Z until a field is as it was: how much text that is at once, browsers decide."""
    for _ in range(10):
        if field.input_value() != before:
            field.press("Control+z")
    expect(field).to_have_value(before)


def test_a_dropped_source_lets_choose_a_table_that_becomes_the_method_in_one_step(
    start: StepRampPage,
) -> None:
    page = start.page
    drop_file(page, "Gauge.CPP", SOURCE)
    dialog = page.locator("#paste-dialog")
    tables = dialog.get_by_role("radio")
    expect(tables).to_have_count(2)
    expect(dialog.locator(".table-choice label").nth(1)).to_have_text(
        re.compile(r"^fast\s*line 4: 3 rows, from {5, 4,000} to {99, 800}$")
    )
    expect(dialog.locator("#paste-preview tbody tr")).to_have_count(2)
    tables.nth(1).check()
    expect(dialog.get_by_label("Use this table as the method")).to_be_checked()
    dialog.get_by_role("button", name="Use 3 rows").click()
    assert rows_of(start) == [[5, 4000], [20, 1000], [99, 800]]
    expect(page.locator("#method")).to_have_value("table")
    expect(page.locator(".table-foot")).to_contain_text("3 rows pasted · the method")
    page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS
    expect(page.locator("#method")).to_have_value("exact")

    # From a button as well; a file without a table changes nothing, and says so.
    page.locator("#paste-table").click()
    files = {"empty.h": b"int pins[3] = {1, 2, 3};", "old.c": SOURCE.encode().replace(b"slow", b"\xb5s")}
    for name, content in files.items():
        with page.expect_file_chooser() as chooser:
            dialog.get_by_role("button", name="Open a file").click()
        chooser.value.set_files({"name": name, "mimeType": "text/plain", "buffer": content})
        words = "No array here has rows of two numbers" if name == "empty.h" else "last index"
        expect(dialog.locator("#paste-preview")).to_contain_text(words)
    dialog.get_by_role("button", name="Cancel").click()
    assert rows_of(start) == ROWS


def test_a_fit_and_what_it_took_the_place_of_stay_with_their_axis(start: StepRampPage) -> None:
    page = start.page
    page.locator("#add-axis").click()
    tabs = page.locator("#axes [role=tab]")
    expect(tabs).to_have_count(2)
    page.locator("#fit-table").click()
    fit = page.locator("#fit-dialog")
    fit.locator('[data-value="constant"]').click()
    fit.locator('[data-value="rows"]').click()
    fit.locator("#fit-wish").fill("4")
    expect(fit.get_by_role("button", name="Use 4 rows")).to_be_enabled()
    fit.get_by_label("Use this table as the method").uncheck()
    tabs.nth(0).click()
    expect(fit).to_contain_text("the axis that this was opened for, not to the one in hand")
    fit.get_by_role("button", name="Use 4 rows").click()
    back = page.get_by_role("button", name="Put the 6 before back")
    assert rows_of(start) == ROWS
    expect(back).to_be_hidden()
    tabs.nth(1).click()
    assert len(rows_of(start)) == 4
    back.click()
    assert rows_of(start) == ROWS
    expect(page.locator("#method")).to_have_value("exact")


def test_a_table_of_another_ramp_is_fitted_again_and_text_is_undone_as_text(
    start: StepRampPage, module_watch: Watch
) -> None:
    module_watch.expected.append(REFUSED_VALUE)
    page, foot = start.page, start.page.locator(".table-foot")
    refit = foot.get_by_role("button", name="Refit")
    expect(refit).to_be_hidden()
    start.edit_and_wait(SLEW_SPEED, "2000")
    expect(foot).to_contain_text("the ramp has changed since")
    refit.click()
    expect(foot).to_contain_text("6 rows fitted")
    expect(refit).to_be_hidden()
    assert len(rows_of(start)) == 6
    assert rows_of(start)[-1][1] < 700, "the last delay suits 2,000 steps/s, not 1,000"

    # One line each, however narrow the panel is.
    for width in (1440, 1024, 320):
        page.set_viewport_size({"width": width, "height": 900})
        start.show_panel("table")
        heights = foot.locator(".foot-line").evaluate_all("(lines) => lines.map((line) => line.clientHeight)")
        assert max(heights) <= 40, (width, heights)
        assert foot.evaluate("(foot) => foot.scrollWidth <= foot.clientWidth")
    page.set_viewport_size({"width": 1440, "height": 900})

    # A frequency that is none converts nothing.
    before = rows_of(start)
    frequency = start.field("timer.frequency_hz")
    frequency.fill("0,500")
    expect(start.message("timer.frequency_hz")).to_contain_text("A point is expected for the comma: 0.500.")
    page.locator("#interval-unit").select_option("ticks")
    expect(page.locator(".panel.table > .messages .message")).to_contain_text("the timer’s frequency is “0,500”")
    expect(page.locator("#interval-unit")).to_have_value("us")
    assert rows_of(start) == before

    # In a text field the keys are the text's, until nothing of it is left to undo.
    acceleration = start.field(ACCELERATION)
    text = acceleration.input_value()
    acceleration.focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("1234")
    undo_text(acceleration, text)
    page.locator("#paste-table").click()
    page.locator("#paste-text").press_sequentially("{1, 2}")
    undo_text(page.locator("#paste-text"), "")
    page.keyboard.press("Control+z")
    page.get_by_role("button", name="Cancel").click()
    assert rows_of(start) == before
    expect(frequency).to_have_value("0,500")
