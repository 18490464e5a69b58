"""The dialog that fits a lookup table to the ramp."""

import re
from collections.abc import Callable

from playwright.sync_api import Locator, Page, expect

from browser.conftest import Watch
from browser.stepramp_page import StepRampPage, until
from browser.table.points import ROWS, rows_of


def open_fit(page: Page, wish: str = "8") -> Locator:
    """Open the dialog with a number of rows; it remembers what was wished for the last time."""
    page.locator("#fit-table").click()
    dialog = page.locator("#fit-dialog")
    dialog.locator('[data-value="constant"]').click()
    dialog.locator('[data-value="rows"]').click()
    dialog.locator("#fit-wish").fill(wish)
    rows = "1 row" if wish == "1" else f"{wish} rows"
    expect(dialog.locator(".small-chart")).to_have_attribute("aria-valuetext", re.compile(f"^{rows}, .* %"))
    return dialog


def test_a_table_is_fitted_shown_and_only_then_used(start: StepRampPage) -> None:
    page = start.page
    dialog = open_fit(page, "1")
    expect(dialog.locator(".small-chart .dot")).to_have_count(32)
    # One row for delays from 10,000 µs (1 / sqrt(2 a)) to 1,000: off by 9/11, at 2 · 10,000 · 1,000 / 11,000.
    expect(dialog.locator("#fit-result")).to_contain_text("1 row · 4 bytes · largest error ± 81.8 %")
    expect(dialog.locator(".preview td").nth(2)).to_have_text("1,818")
    assert rows_of(start) == ROWS
    dialog.locator('[data-value="bytes"]').click()
    dialog.locator("#fit-wish").fill("20")
    expect(dialog.locator("#fit-result")).to_contain_text("5 rows · 20 bytes")
    dialog.locator('[data-value="largest_relative_error"]').click()
    dialog.locator("#fit-wish").fill("30")
    expect(dialog.locator("#fit-result")).to_contain_text("bytes · largest error")
    until(lambda: float(dialog.locator("#fit-result b").nth(1).inner_text().strip("± %")) <= 30)
    dialog.get_by_role("button", name="Cancel").click()
    assert rows_of(start) == ROWS
    expect(page.locator("#fit-table")).to_be_focused()


def test_a_fit_is_to_what_is_played_and_tells_what_no_rows_can_mend(
    open_page: Callable[..., StepRampPage], watch: Watch
) -> None:
    watch.expected.append("status of 422")
    stepramp = open_page()
    page = stepramp.page
    dialog = open_fit(page, "16")
    # Index 2 plays the first interval up and the third from the end: (sqrt(3) - 1) / (sqrt(3) + 1) of them.
    expect(dialog.locator("#fit-result")).to_contain_text("16 rows · 64 bytes · largest error ± 26.8 %")
    expect(dialog.locator("#fit-result")).to_contain_text("No number of rows does better than ± 26.8 %: at index 2")
    expect(dialog.locator(".small-chart .floor")).to_have_count(1)
    dialog.locator('[data-value="largest_relative_error"]').click()
    dialog.locator("#fit-wish").fill("20")
    expect(dialog.locator("#fit-result")).to_contain_text("Error is 20 %; allowed: at least 26.8 %, the best")
    dialog.locator('[data-value="ramp_index"]').click()
    expect(dialog.locator("#fit-result")).to_contain_text("± 20")
    dialog.locator('[data-value="rows"]').click()
    expect(dialog.locator("#fit-result")).to_contain_text("16 rows · 64 bytes · largest error ± 5.58 %")
    expect(dialog.locator("#fit-result")).to_contain_text("the delay is rounded to whole µs")
    dialog.locator('[data-value="played"]').click()
    page.get_by_role("button", name="Use 16 rows").click()
    expect(page.locator("#table-rows tr.row")).to_have_count(16)
    # What the dialog promised is what the plots show.
    expect(page.locator('.chip[data-method="table"] em')).to_have_text(re.compile(r"^[+−]27 %$"))
    page.keyboard.press("Control+z")
    assert rows_of(stepramp) == ROWS


def test_a_size_is_chosen_on_the_curve(start: StepRampPage) -> None:
    page = start.page
    chart = open_fit(page).locator(".small-chart")
    # The chart is drawn anew with each answer: a dot taken away meanwhile has no place.
    box = until(lambda: chart.locator(".dot").nth(11).bounding_box())
    page.mouse.click(box["x"] + 2, box["y"] + 30)
    expect(page.locator("#fit-wish")).to_have_value("12")
    expect(page.locator("#fit-result")).to_contain_text("12 rows · 48 bytes")
    expect(chart).to_have_attribute("aria-valuenow", "12")
    chart.focus()
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#fit-result")).to_contain_text("11 rows")
    page.get_by_role("button", name="Use 11 rows").click()
    assert len(rows_of(start)) == 11
    page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS


def test_linear_rows_are_shown_and_copied(start: StepRampPage) -> None:
    page = start.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    open_fit(page, "3").locator('[data-value="linear"]').click()
    expect(page.locator("#fit-result")).to_contain_text("3 rows · 18 bytes")
    page.get_by_role("button", name="Copy as C").click()
    expect(page.get_by_role("button", name="Copied")).to_be_visible()
    copied = page.evaluate("() => navigator.clipboard.readText()")
    assert "int32_t ramp_table[3][3]" in copied
    assert rows_of(start) == ROWS
    page.get_by_role("button", name="Cancel").click()


def test_a_wish_that_can_t_be_kept_is_explained(open_page: Callable[..., StepRampPage], watch: Watch) -> None:
    watch.expected.append("status of 422")
    page = open_page().page
    page.locator("#fit-table").click()
    page.locator("#fit-wish").fill("0")
    expect(page.locator("#fit-result")).to_have_text("Rows is 0; allowed: a whole number from 1 to 1,000 rows.")
    expect(page.locator("#fit-wish")).to_have_attribute("aria-invalid", "true")
    page.locator('#fit-dialog [data-value="largest_relative_error"]').click()
    page.locator("#fit-wish").fill("0.001")
    expect(page.locator("#fit-result")).to_contain_text("Error is 0.001 %; allowed: at least ")
    page.locator("#fit-wish").fill("much")
    expect(page.locator("#fit-result")).to_have_text("Error is 'much'; allowed: a number from 0.0001 to 100 %.")
    expect(page.get_by_role("button", name="Use the rows")).to_be_disabled()
