"""The lookup table: its rows in the grid and in the plot are one thing."""

import math
import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from browser.conftest import DESKTOP, Watch
from browser.server import Server
from browser.stepramp_page import StepRampPage, call, until

ROWS = [[3, 8284], [7, 4783], [15, 3131], [31, 2139], [63, 1488], [101, 1115]]
"""Of the lead-screw stage: last ramp index, delay in µs. The row to index 15 ends with step 14."""
US_PER_S = 1e6
TRAVEL_MM_PER_STEP = 8 / 400

# Where Plotly itself puts values, and which values it finds at a pixel of the page.
PLOTLY_PIXELS = """([x, y]) => { const gd = document.querySelector('.figure'), full = gd._fullLayout,
    box = gd.getBoundingClientRect();
    return [box.x + full.xaxis._offset + full.xaxis.d2p(x), box.y + full.yaxis2._offset + full.yaxis2.d2p(y)]; }"""
PLOTLY_VALUES = """([x, y]) => { const gd = document.querySelector('.figure'), full = gd._fullLayout,
    box = gd.getBoundingClientRect();
    return [full.xaxis.p2d(x - box.x - full.xaxis._offset), full.yaxis2.p2d(y - box.y - full.yaxis2._offset)]; }"""


@pytest.fixture
def start(module_page: StepRampPage) -> StepRampPage:
    """The lead-screw stage at its start, where every row is apart: a logarithmic step axis."""
    module_page.start_over()
    view(module_page, "start")
    return module_page


@pytest.fixture(scope="module")
def modules(browser: Browser, shared_server: Server) -> Iterator[Page]:
    opened = browser.new_page()
    StepRampPage(opened, shared_server.url).open()
    yield opened
    opened.close()


def view(stepramp: StepRampPage, name: str) -> None:
    stepramp.page.locator(f'#view-choice [data-value="{name}"]').click()
    until(lambda: (stepramp.x_axis()["type"] == "log") == (name == "start"))


def handle(stepramp: StepRampPage, row: int) -> Locator:
    """Return the point of a row, counted from 0."""
    return stepramp.page.locator(f'.point[data-row="{row}"]')


def centre(stepramp: StepRampPage, row: int) -> tuple[float, float]:
    box = handle(stepramp, row).locator(".dot").bounding_box()
    assert box
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def plotted(stepramp: StepRampPage, x: float, delay_us: float) -> tuple[float, float]:
    return tuple(stepramp.page.evaluate(PLOTLY_PIXELS, [x, delay_us]))


def values_at(stepramp: StepRampPage, pixel: tuple[float, float]) -> tuple[float, float]:
    return tuple(stepramp.page.evaluate(PLOTLY_VALUES, list(pixel)))


def rows_of(stepramp: StepRampPage) -> list[list[int]]:
    return [[int(cell.replace(",", "")) for cell in row] for row in stepramp.table_rows()]


def press(stepramp: StepRampPage, row: int) -> tuple[float, float]:
    x, y = centre(stepramp, row)
    stepramp.page.mouse.move(x + 1, y - 1)
    stepramp.page.mouse.down()
    return x, y


def drag(stepramp: StepRampPage, row: int, by: tuple[float, float]) -> tuple[float, float]:
    """Drag a row's point and let go; return where its centre should be."""
    x, y = press(stepramp, row)
    stepramp.page.mouse.move(x + 1 + by[0], y - 1 + by[1], steps=6)
    stepramp.page.mouse.up()
    return x + by[0], y + by[1]


def assert_on_data(stepramp: StepRampPage, row: int, x: float, delay_us: float) -> None:
    """A point is where Plotly puts the corner of the staircase, to half a pixel."""
    until(lambda: math.dist(centre(stepramp, row), plotted(stepramp, x, delay_us)) < 0.5)


# ---- in the plot ----


def test_points_lie_on_the_corners_of_the_staircase(start: StepRampPage) -> None:
    data = start.page.evaluate("""() => { const trace = document.querySelector('.figure').data
        .find(({uid}) => uid === 'table-delay'); return [...trace.x].map((x, at) => [x, trace.y[at]]); }""")
    for row, (index, delay) in enumerate(ROWS):
        assert [index - 1, delay] in data
        assert_on_data(start, row, index - 1, delay)


def test_points_stay_on_their_data_when_zoomed_and_when_the_window_changes(start: StepRampPage) -> None:
    x, y = centre(start, 3)
    start.page.mouse.move(x + 9, y + 9)
    start.page.mouse.wheel(0, -300)
    until(lambda: start.x_axis()["range"][0] > 0)
    assert_on_data(start, 3, 30, 2139)
    start.page.set_viewport_size({"width": 1100, "height": 700})
    assert_on_data(start, 3, 30, 2139)
    start.page.set_viewport_size({"width": DESKTOP[0], "height": DESKTOP[1]})
    view(start, "up")
    for row, (index, delay) in enumerate(ROWS):
        assert_on_data(start, row, index - 1, delay)
    (left, top), (right, _) = plotted(start, 20, 4000), plotted(start, 70, 4000)
    start.page.mouse.move(left, top)
    start.page.mouse.down()
    start.page.mouse.move(right, top + 2, steps=5)
    start.page.mouse.up()
    until(lambda: start.x_axis()["range"][0] > 15)
    assert_on_data(start, 4, 62, 1488)
    expect(handle(start, 0)).to_be_hidden()


def test_points_have_their_place_over_time_and_position(start: StepRampPage) -> None:
    start.page.locator('#axis-choice [data-value="position"]').click()
    view(start, "up")
    assert_on_data(start, 4, 62 * TRAVEL_MM_PER_STEP, 1488)
    start.page.locator('#axis-choice [data-value="time"]').click()
    # Pulse 1 is at 0. Two steps wait 8,284 µs, four 4,783 and eight 3,131, of which step 14 is the last.
    until(lambda: "time" in start.x_axis()["title"])
    assert_on_data(start, 2, (2 * 8284 + 4 * 4783 + 7 * 3131) / 1000, 3131)
    by = drag(start, 2, (0, -15))
    until(lambda: rows_of(start)[2][1] > 3131)
    assert centre(start, 2)[1] == pytest.approx(by[1], abs=1)


@pytest.mark.parametrize("name", ["start", "up"])
def test_a_dragged_point_follows_the_pointer_and_is_undone_at_once(start: StepRampPage, name: str) -> None:
    view(start, name)
    x, y = press(start, 3)
    for part in range(1, 9):
        start.page.mouse.move(x + 1 + 5 * part, y - 1 - 3 * part)
    wanted = (x + 40, y - 24)
    step, delay = values_at(start, wanted)
    until(lambda: rows_of(start)[3] == [round(step) + 1, round(delay)])
    # While still held: the point is under the pointer, but for whole steps, and on the newest curve.
    assert abs(centre(start, 3)[1] - wanted[1]) < 0.5
    assert_on_data(start, 3, round(step), round(delay))
    until(lambda: round(delay) in [round(value) for value in start.curves()["table-delay"]])
    start.page.mouse.up()
    assert rows_of(start)[:3] + rows_of(start)[4:] == ROWS[:3] + ROWS[4:]
    start.page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS
    until(lambda: 2139 in start.curves()["table-delay"])


def test_a_point_stops_at_its_neighbours(start: StepRampPage) -> None:
    drag(start, 1, (900, 0))
    assert rows_of(start)[1] == [14, 4783]
    drag(start, 1, (-900, 0))
    assert rows_of(start)[1] == [4, 4783]


def test_a_mere_click_changes_nothing(start: StepRampPage) -> None:
    drag(start, 2, (0, 0))
    assert rows_of(start) == ROWS


def test_with_shift_what_is_moved_less_stays(start: StepRampPage) -> None:
    start.page.keyboard.down("Shift")
    drag(start, 3, (6, -30))
    up = rows_of(start)[3]
    drag(start, 4, (-40, 9))
    start.page.keyboard.up("Shift")
    assert up[0] == 31
    assert up[1] > 2139
    assert rows_of(start)[4][0] < 63
    assert rows_of(start)[4][1] == 1488


def test_escape_in_mid_drag_restores_the_row_and_stops(start: StepRampPage) -> None:
    x, y = press(start, 2)
    start.page.mouse.move(x + 20, y - 30, steps=4)
    until(lambda: rows_of(start)[2] != ROWS[2])
    with start.page.expect_request("**/api/v1/devices/stop"):
        start.page.keyboard.press("Escape")
    assert rows_of(start) == ROWS
    start.page.mouse.move(x + 60, y - 60, steps=3)
    start.page.mouse.up()
    assert rows_of(start) == ROWS
    assert_on_data(start, 2, 14, 3131)


def test_a_cancelled_pointer_restores_the_row(start: StepRampPage) -> None:
    x, y = press(start, 2)
    start.page.mouse.move(x + 20, y - 30, steps=4)
    until(lambda: rows_of(start)[2] != ROWS[2])
    handle(start, 2).dispatch_event("pointercancel")
    assert rows_of(start) == ROWS
    start.page.mouse.up()


def test_a_double_click_adds_a_row_and_leaves_the_zoom(start: StepRampPage) -> None:
    before = start.x_axis()["range"]
    x, y = plotted(start, 20, 6000)
    start.page.mouse.dblclick(x, y)
    expect(start.page.locator("#table-rows tr.row")).to_have_count(7)
    step, delay = values_at(start, (x, y))
    assert rows_of(start)[3] == [round(step) + 1, round(delay)]
    assert rows_of(start)[3][0] == pytest.approx(21, abs=1)
    expect(handle(start, 3)).to_be_focused()
    assert start.x_axis()["range"] == pytest.approx(before)
    start.page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS
    x, y = plotted(start, 20, 6000)
    start.page.mouse.dblclick(x, y - 200)  # in the plot above it shows all, as everywhere
    assert rows_of(start) == ROWS


def test_tab_goes_on_and_keys_nudge(start: StepRampPage) -> None:
    page = start.page
    handle(start, 3).focus()
    page.keyboard.press("Tab")
    expect(handle(start, 4)).to_be_focused()
    for key, row in {
        "ArrowUp": [63, 1503],
        "Alt+ArrowUp": [63, 1504],
        "Shift+ArrowUp": [63, 1654],
        "PageDown": [63, 1489],
        "ArrowRight": [64, 1489],
        "Shift+ArrowRight": [70, 1489],
        "Alt+ArrowLeft": [69, 1489],
        "Shift+ArrowLeft": [62, 1489],
    }.items():
        page.keyboard.press(key)
        assert rows_of(start)[4] == row
    expect(handle(start, 4)).to_have_attribute("role", "slider")
    expect(handle(start, 4)).to_have_attribute("aria-valuetext", "to index 62 (step 61), 1,489 µs")
    expect(handle(start, 4)).to_have_attribute("aria-valuenow", "1489")
    page.keyboard.press("Control+z")
    assert rows_of(start) == ROWS, "one run of keys is one step"


@pytest.mark.parametrize("key", ["Delete", "Backspace"])
def test_delete_removes_and_the_next_has_the_focus(start: StepRampPage, key: str) -> None:
    handle(start, 2).focus()
    start.page.keyboard.press(key)
    assert rows_of(start) == ROWS[:2] + ROWS[3:]
    expect(handle(start, 2)).to_be_focused()
    for _ in range(3):
        start.page.keyboard.press(key)
    assert rows_of(start) == ROWS[:2]
    expect(handle(start, 1)).to_be_focused()
    start.page.keyboard.press(key)
    start.page.keyboard.press(key)
    expect(start.page.locator(".point")).to_have_count(0)
    expect(start.page.locator(".scope")).to_be_focused()


def test_grid_and_plot_have_one_selection(start: StepRampPage) -> None:
    start.page.locator("#table-4-0").click()
    expect(handle(start, 4)).to_have_attribute("aria-current", "true")
    drag(start, 1, (0, 0))
    expect(start.page.locator("#table-rows tr.row").nth(1)).to_have_class("row selected")
    expect(handle(start, 4)).to_have_attribute("aria-current", "false")


def test_points_are_there_while_the_table_is(start: StepRampPage) -> None:
    expect(handle(start, 0)).to_be_visible()
    start.page.locator('.chip[data-method="table"]').click()
    expect(handle(start, 0)).to_be_hidden()
    start.page.locator('.chip[data-method="table"]').click()
    expect(handle(start, 0)).to_be_visible()


def test_a_table_in_ticks_is_dragged_in_ticks(start: StepRampPage) -> None:
    start.page.locator("#interval-unit").select_option("ticks")
    assert rows_of(start)[2] == [15, 6262]
    assert_on_data(start, 2, 14, 3131)
    wanted = drag(start, 2, (0, -30))
    _, delay_us = values_at(start, wanted)
    assert rows_of(start)[2] == [15, round(2 * delay_us)]
    start.page.locator("#interval-unit").select_option("us")


def test_a_point_can_be_hit(open_page: Callable[..., StepRampPage]) -> None:
    for size, target in {DESKTOP: 24, (390, 844): 40}.items():
        stepramp = open_page(size)
        stepramp.show_panel("table")  # on the phone: with the plot of the rows, in the view that shows them apart
        expect(handle(stepramp, 5)).to_be_visible()
        box = handle(stepramp, 5).locator(".hit").bounding_box()
        assert box
        assert min(box["width"], box["height"]) >= target


def test_a_finger_drags_and_adds(browser: Browser, server: Server, watch: Watch) -> None:
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    page = context.new_page()
    watch.follow(page)
    stepramp = StepRampPage(page, server.url).open()
    stepramp.show_panel("table")
    expect(handle(stepramp, 5)).to_be_visible()
    touch = context.new_cdp_session(page)

    def send(kind: str, *points: tuple[float, float]) -> None:
        at = [{"x": x, "y": y} for x, y in points]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": at})

    x, y = centre(stepramp, 5)
    send("touchStart", (x + 8, y + 6))
    for part in range(1, 6):
        send("touchMove", (x + 8, y + 6 - 4 * part))
    until(lambda: rows_of(stepramp)[5][1] > 1115)
    send("touchEnd")
    _, delay = values_at(stepramp, (x, y - 20))
    assert rows_of(stepramp)[5][1] == pytest.approx(delay, abs=30)
    dragged = rows_of(stepramp)
    x, y = plotted(stepramp, 50, 5000)
    for _ in range(2):
        send("touchStart", (x, y))
        send("touchEnd")
    until(lambda: len(rows_of(stepramp)) == len(dragged) + 1)
    context.close()


# ---- in the grid ----


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


# ---- fitting, pasting, copying ----


def open_fit(page: Page, wish: str = "8") -> Locator:
    """Open the dialog with a number of rows; it remembers what was wished for the last time."""
    page.locator("#fit-table").click()
    dialog = page.locator("#fit-dialog")
    dialog.locator('[data-value="constant"]').click()
    dialog.locator('[data-value="rows"]').click()
    dialog.locator("#fit-wish").fill(wish)
    rows = "1 row" if wish == "1" else f"{wish} rows"
    expect(dialog.locator(".fit-chart")).to_have_attribute("aria-valuetext", re.compile(f"^{rows}, .* %"))
    return dialog


def test_a_table_is_fitted_shown_and_only_then_used(start: StepRampPage) -> None:
    page = start.page
    dialog = open_fit(page, "1")
    expect(dialog.locator(".fit-chart .dot")).to_have_count(32)
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
    expect(dialog.locator(".fit-chart .floor")).to_have_count(1)
    dialog.locator('[data-value="largest_relative_error"]').click()
    dialog.locator("#fit-wish").fill("20")
    expect(dialog.locator("#fit-result")).to_contain_text("20 % is refused: as a fraction, an error is at least 0.268")
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
    chart = open_fit(page).locator(".fit-chart")
    box = chart.locator(".dot").nth(11).bounding_box()
    assert box
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
    expect(page.locator("#fit-result")).to_contain_text("rows is 0")
    expect(page.locator("#fit-wish")).to_have_attribute("aria-invalid", "true")
    page.locator('#fit-dialog [data-value="largest_relative_error"]').click()
    page.locator("#fit-wish").fill("0.001")
    expect(page.locator("#fit-result")).to_contain_text("0.001 % is refused")
    page.locator("#fit-wish").fill("much")
    expect(page.locator("#fit-result")).to_contain_text("“much” is not a number")
    expect(page.get_by_role("button", name="Use the rows")).to_be_disabled()


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


def test_a_target_is_changed_in_flight_without_moving_anything(start: StepRampPage) -> None:
    start.choose_example("Gauge")
    start.page.locator(".table-foot").get_by_role("button", name="Play").click()
    start.page.locator("#play-first").fill("800")
    start.page.locator("#play-after").fill("300")
    start.page.locator("#play-second").fill("100")
    result = start.page.locator("#play-result")
    # After 300 ms it is past step 300, at top speed, and needs the 300 steps of its ramp to stop before it turns.
    expect(result).to_contain_text(re.compile(r"It turns at step 6\d\d\. At rest at step 100 after [\d,.]+ ms"))
    start.page.locator("#play-second").fill("2.5")
    expect(result).to_contain_text("“2.5” is not a whole number")
    expect(start.page.locator("#play-second")).to_have_attribute("aria-invalid", "true")
    start.page.keyboard.press("Escape")
    expect(start.page.locator("#play-dialog")).to_be_hidden()


# ---- pure modules ----


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


def test_places_and_indices_are_each_other_s_inverse(modules: Page) -> None:
    design = {
        "table": {"rows": ROWS, "interval_unit": "us"},
        "timer": {"frequency_hz": 2e6},
        "method": {"rounding": "nearest"},
    }
    for axis, factor in (("step", 1), ("position", -0.02), ("time", 1000)):
        scale = {"axis": axis, "factor": factor}
        for row, (index, delay) in enumerate(ROWS):
            x = call(modules, "table_rows.js", "rowX", design, ROWS, row, scale)
            assert call(modules, "table_rows.js", "indexAtX", design, ROWS, row, delay, scale, x) == pytest.approx(
                index
            )


def test_a_row_is_moved_within_its_neighbours_and_what_the_server_takes(modules: Page) -> None:
    rows = [[3, 8284], ["x", 5], [7, 4783]]

    def moved(row: int, index: float, delay: float) -> list[int]:
        return call(modules, "table_rows.js", "movedRow", rows, row, {"index": index, "delay": delay})[row]

    assert moved(0, 99, 0.2) == [6, 1]
    assert moved(0, -5, 8000.4) == [0, 8000]
    assert moved(2, 1, 1e12) == [4, 2**32 - 1]
    assert moved(2, 1e9, 5) == [10_000_000, 5]
    added = call(modules, "table_rows.js", "withRowAt", rows, {"index": 5.2, "delay": 6000})
    assert (added["rows"], added["row"]) == ([[3, 8284], ["x", 5], [5, 6000], [7, 4783]], 2)
    same = call(modules, "table_rows.js", "withRowAt", rows, {"index": 7, "delay": 6000})
    assert (same["rows"], same["row"]) == (rows, 2)
