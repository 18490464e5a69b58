"""The rows of the lookup table as points in the plot."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Browser, expect

from browser.conftest import DESKTOP, Watch
from browser.server import Server
from browser.stepramp_page import StepRampPage, until
from browser.table.points import ROWS, assert_on_data, centre, drag, handle, plotted, press, rows_of, values_at, view

TRAVEL_MM_PER_STEP = 8 / 400


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
    expect(handle(start, 4)).to_have_attribute("aria-valuetext", "last index 62 (step 61), 1,489 µs")
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
