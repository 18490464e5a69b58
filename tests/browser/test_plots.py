"""What the plots show and how they are looked at."""

import pytest
from playwright.sync_api import expect

from browser.stepramp_page import ACCELERATION, SLEW_SPEED, StepRampPage, until


@pytest.fixture
def stepramp(module_page: StepRampPage) -> StepRampPage:
    module_page.start_over()
    return module_page


def view(stepramp: StepRampPage, name: str) -> None:
    stepramp.page.locator(f'#view-choice [data-value="{name}"]').click()


def test_the_slider_changes_the_number_and_the_plots_at_once(stepramp: StepRampPage) -> None:
    before = stepramp.curves()
    slider = stepramp.slider(ACCELERATION)
    slider.focus()
    for _ in range(3):
        stepramp.page.keyboard.press("ArrowRight")
    assert stepramp.field(ACCELERATION).input_value() != "5,000"
    until(lambda: stepramp.curves()["exact-velocity"] != before["exact-velocity"])
    box = slider.bounding_box()
    assert box
    stepramp.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    stepramp.page.mouse.down()
    stepramp.page.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + box["height"] / 2, steps=10)
    stepramp.page.mouse.up()
    number = float(stepramp.field(ACCELERATION).input_value().replace(",", ""))
    assert 90_000 < number < 120_000, "three quarters of the way from 100 to 1,000,000 on a logarithmic slider"
    until(lambda: "1,000" in stepramp.figure_text("peak"))


def test_requests_do_not_pile_up_while_a_slider_is_dragged(stepramp: StepRampPage) -> None:
    under_way, most = 0, 0

    def asked(_: object) -> None:
        nonlocal under_way, most
        under_way += 1
        most = max(most, under_way)

    def answered(_: object) -> None:
        nonlocal under_way
        under_way -= 1

    page = stepramp.page
    page.on("request", asked)
    page.on("requestfinished", answered)
    box = stepramp.slider(SLEW_SPEED).bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] * 0.3, box["y"] + 7)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.6, box["y"] + 7, steps=40)
    page.mouse.up()
    value = float(stepramp.field(SLEW_SPEED).input_value().replace(",", ""))
    until(lambda: f"of {value:,.0f} asked for" in stepramp.figure_text("peak"))
    assert most <= 7, "six profiles and their errors: one round"


def test_the_views_show_their_part_of_the_move(stepramp: StepRampPage) -> None:
    view(stepramp, "start")
    until(lambda: stepramp.x_axis()["type"] == "log")
    view(stepramp, "up")
    until(lambda: stepramp.x_axis()["type"] == "linear" and 100 < stepramp.x_axis()["range"][1] < 130)
    view(stepramp, "down")
    until(lambda: 370 < stepramp.x_axis()["range"][0] < 401)
    view(stepramp, "whole")
    until(lambda: stepramp.x_axis()["range"][0] < 1 and stepramp.x_axis()["range"][1] > 500)


def test_the_plots_can_be_drawn_against_time_and_position(stepramp: StepRampPage) -> None:
    stepramp.page.locator('#axis-choice [data-value="time"]').click()
    until(lambda: stepramp.x_axis()["title"] == "time, ms")
    ends = "() => document.querySelector('.figure').data.filter((one) => one.visible).map((one) => one.x.at(-1))"
    last = max(stepramp.page.evaluate(ends))
    assert last < stepramp.x_axis()["range"][1] < 1.01 * last, "the slowest method still fits"
    stepramp.page.locator('#axis-choice [data-value="position"]').click()
    until(lambda: stepramp.x_axis()["title"] == "position, mm")
    assert 10 < stepramp.x_axis()["range"][1] < 10.1, "500 of 400 steps a turn at 8 mm"
    stepramp.field("move.steps").fill("-500")
    until(lambda: -10.1 < stepramp.x_axis()["range"][0] < -10)


def test_wheel_and_drag_zoom_and_a_double_click_shows_all(stepramp: StepRampPage) -> None:
    page = stepramp.page
    box = page.locator(".scope").bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + 150
    whole = stepramp.x_axis()["range"]
    page.mouse.move(x, y)
    page.mouse.wheel(0, -400)
    until(lambda: stepramp.x_axis()["range"][1] < whole[1])
    page.mouse.dblclick(x, y)
    until(lambda: stepramp.x_axis()["range"] == whole)
    page.mouse.move(x - 200, y)
    page.mouse.down()
    page.mouse.move(x + 100, y, steps=5)
    page.mouse.up()
    until(lambda: stepramp.x_axis()["range"][0] > whole[0] and stepramp.x_axis()["range"][1] < whole[1])
    page.locator(".scope").focus()
    page.keyboard.press("0")
    until(lambda: stepramp.x_axis()["range"] == whole)


def test_the_cursor_reads_every_method(stepramp: StepRampPage) -> None:
    page = stepramp.page
    box = page.locator(".scope").bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 200)
    expect(page.locator(".tooltip")).to_be_visible()
    for words in ("Step ", "Exact", "1st order", "Table", "2,000"):
        expect(page.locator(".tooltip")).to_contain_text(words)
    expect(page.locator(".status .reading")).to_contain_text("2,000 ticks = 1,000.0 µs")
    page.mouse.move(5, 5)
    expect(page.locator(".tooltip")).to_be_hidden()
    page.locator(".scope").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    expect(page.locator(".status .reading")).to_contain_text("Step 2")


def test_the_legend_switches_methods_and_the_chosen_one_is_drawn_last(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator('.chip[data-method="table"]').click()
    until(lambda: "table-velocity" not in stepramp.curves())
    page.locator('.chip[data-method="table"]').click()
    until(lambda: "table-velocity" in stepramp.curves())
    page.locator("#method").select_option("first_order")
    until(lambda: list(stepramp.curves())[-1] == "first_order-error")
    expect(page.locator('#arithmetic [aria-pressed="true"]')).to_have_text("float32")
    page.locator('#arithmetic [data-value="float64"]').click()
    until(lambda: "float64" in stepramp.figure_text("method"))
    page.locator('#arithmetic [data-value="fixed"]').click()
    until(lambda: "fixed" in stepramp.figure_text("method"))
    page.locator("#method").select_option("austin")
    expect(page.locator('#arithmetic [data-value="fixed"]')).to_be_hidden()
    until(lambda: "float32" in stepramp.figure_text("method"))


def test_the_phases_are_labelled(stepramp: StepRampPage) -> None:
    for name, words in (("accelerate", "100 steps"), ("slew", "300 steps"), ("decelerate", "100 steps")):
        expect(stepramp.page.locator(f'[data-phase="{name}"]')).to_contain_text(words)
    stepramp.field("move.steps").fill("100")
    expect(stepramp.page.locator('[data-phase="slew"]')).to_have_count(0)
