"""The module that moves rows and finds their places in the plot."""

import pytest
from playwright.sync_api import Page

from browser.stepramp_page import call
from browser.table.points import ROWS


def test_places_and_indices_are_each_other_s_inverse(modules: Page) -> None:
    design = {
        "table": {"rows": ROWS, "interval_unit": "us"},
        "timer": {"frequency_hz": 2e6},
        "method": {"rounding": "nearest"},
    }
    for against, factor in (("step", 1), ("position", -0.02), ("time", 1000)):
        scale = {"against": against, "factor": factor}
        for row, (index, delay) in enumerate(ROWS):
            x = call(modules, "plotting/table_rows.js", "rowX", design, ROWS, row, scale)
            assert call(
                modules, "plotting/table_rows.js", "indexAtX", design, ROWS, row, delay, scale, x
            ) == pytest.approx(index)


def test_a_row_is_moved_within_its_neighbours_and_what_the_server_takes(modules: Page) -> None:
    rows = [[3, 8284], ["x", 5], [7, 4783]]

    def moved(row: int, index: float, delay: float) -> list[int]:
        return call(modules, "plotting/table_rows.js", "movedRow", rows, row, {"index": index, "delay": delay})[row]

    assert moved(0, 99, 0.2) == [6, 1]
    assert moved(0, -5, 8000.4) == [0, 8000]
    assert moved(2, 1, 1e12) == [4, 2**32 - 1]
    assert moved(2, 1e9, 5) == [10_000_000, 5]
    added = call(modules, "plotting/table_rows.js", "withRowAt", rows, {"index": 5.2, "delay": 6000})
    assert (added["rows"], added["row"]) == ([[3, 8284], ["x", 5], [5, 6000], [7, 4783]], 2)
    same = call(modules, "plotting/table_rows.js", "withRowAt", rows, {"index": 7, "delay": 6000})
    assert (same["rows"], same["row"]) == (rows, 2)
