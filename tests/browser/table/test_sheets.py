"""Rows that are copied and pasted, as C and as sheets."""

from playwright.sync_api import expect

from browser.stepramp_page import StepRampPage
from browser.table.points import ROWS, rows_of


def test_the_rows_are_copied_as_c_and_as_csv_and_read_back(start: StepRampPage) -> None:
    page = start.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    for name, words in {
        "C": "const uint16_t ramp_table[6][2] = {\n  {3, 8284},\n",
        "CSV": "last_index,delay_us\r\n3,8284",
    }.items():
        page.get_by_role("button", name=f"Copy the rows as {name}", exact=True).click()
        expect(page.locator(".table-foot")).to_contain_text(f"copied as {name}")
        copied = page.evaluate("() => navigator.clipboard.readText()")
        assert words.replace("\r\n", "\n") in copied.replace("\r\n", "\n")
        start.paste_into_table(copied)
        assert rows_of(start) == ROWS


def test_a_sheet_that_names_its_unit_changes_the_unit(start: StepRampPage) -> None:
    start.paste_into_table("to index\tdelay, ticks\n10\t10,000\n30\t3,000\n")
    assert rows_of(start) == [[10, 10000], [30, 3000]]
    expect(start.page.locator("#interval-unit")).to_have_value("ticks")


def test_what_is_said_of_the_rows_goes_with_them(start: StepRampPage) -> None:
    foot = start.page.locator(".table-foot")
    start.paste_into_table("{ 10, 5000 }, { 30, 1500 }")
    expect(foot).to_contain_text("2 rows pasted")
    expect(foot.get_by_role("button", name="Put the 6 before back")).to_be_visible()
    start.page.locator("#table-1-1").fill("1400")
    expect(foot).not_to_contain_text("pasted")
    start.page.keyboard.press("Control+z")
    start.page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS
    expect(foot.get_by_role("button", name="before back")).to_have_count(0)


def test_fractions_pasted_into_the_table_that_is_played_are_shown_first(start: StepRampPage) -> None:
    page = start.page
    page.locator("#method").select_option("table")
    start.paste_into_table("3;8284,5\n100;1115,25")
    dialog = page.locator("#paste-dialog")
    expect(dialog.locator("#paste-preview .message")).to_have_count(2)
    expect(dialog.get_by_role("button", name="Use 2 rows")).to_be_disabled()
    assert rows_of(start) == ROWS
    dialog.get_by_label("Round 2 delays to whole µs").check()
    dialog.get_by_role("button", name="Use 2 rows").click()
    assert rows_of(start) == [[3, 8285], [100, 1115]]
    expect(page.locator(".table-foot")).to_contain_text("2 rows pasted, 2 delays rounded to whole µs")
