"""Rows that are copied and pasted, as C and as sheets."""

import pytest
from playwright.sync_api import Page, expect

from browser.stepramp_page import StepRampPage, call
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


@pytest.mark.parametrize(
    ("text", "rows", "unit"),
    [
        ("last step;delay (µs)\r\n3;8284\r\n7;4783,5", [[3, 8284], [7, 4783.5]], "us"),
        ("#\tto index\tdelay, ticks\tsteps/s\n1\t3\t16,568\t120.7\n2\t7\t9,566\t209", [[3, 16568], [7, 9566]], "ticks"),
        ('"3","8,284"\n"7","4,783"', [[3, 8284], [7, 4783]], None),
        ("sep=;\n3;1.234.567", [[3, 1234567]], None),
        ("\ufeffdelay_us,index\n5000,10\n", [[10, 5000]], "us"),
        ("step delay\n10 5000", [[10, 5000]], None),
        ("/* delay in ticks */ {10, 5000}", [[10, 5000]], "ticks"),
        ("bus, status\n10, 5000", [[10, 5000]], None),
    ],
)
def test_sheets_are_understood(modules: Page, text: str, rows: list[list[float]], unit: str | None) -> None:
    reading = call(modules, "c_table.js", "parseTable", text)
    assert (reading["rows"], reading["problem"], reading.get("unit")) == (rows, None, unit)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a,b,c\n1,2,3", "none that are called “step” and “delay”"),
        ("index;delay\n;5", "Row 1: a number is missing"),
        ("index;delay\n3;fast", "Row 1: “fast” is not a number"),
        ("10,5000,,", "Row 1 has 4 values"),
    ],
)
def test_sheets_that_are_not_understood_are_explained(modules: Page, text: str, words: str) -> None:
    reading = call(modules, "c_table.js", "parseTable", text)
    assert reading["rows"] is None
    assert words in reading["problem"]


def test_what_is_written_is_read_back(modules: Page) -> None:
    for unit in ("us", "ticks"):
        for written in ("tableAsC", "tableAsCsv"):
            text = call(modules, "c_table.js", written, [[3, 8284], [70000, 90000]], unit)
            reading = call(modules, "c_table.js", "parseTable", text)
            assert (reading["rows"], reading["unit"]) == ([[3, 8284], [70000, 90000]], unit)
    assert "uint32_t" in call(modules, "c_table.js", "tableAsC", [[3, 70000]], "us")
