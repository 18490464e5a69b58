"""Undo and redo of everything, and the axes of a machine."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from browser.conftest import Watch
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until


@pytest.fixture
def watch(shared_watch: Watch) -> Watch:
    return shared_watch


@pytest.fixture
def stepramp(shared_page: StepRampPage) -> StepRampPage:
    return shared_page


def undo(stepramp: StepRampPage) -> None:
    stepramp.page.keyboard.press("Control+z")


def redo(stepramp: StepRampPage) -> None:
    stepramp.page.keyboard.press("Control+Shift+Z")


def tabs(stepramp: StepRampPage) -> Locator:
    return stepramp.page.locator("#axes [role=tab]")


def choice(stepramp: StepRampPage, name: str, value: str) -> Locator:
    return stepramp.page.locator(f'#{name}-choice [data-value="{value}"]')


def test_everything_is_undone_and_done_again(stepramp: StepRampPage) -> None:
    page = stepramp.page
    rows = stepramp.table_rows()
    before = [stepramp.field(SLEW_SPEED).input_value(), stepramp.field(ACCELERATION).input_value()]
    stepramp.edit_and_wait(SLEW_SPEED, "1234")
    stepramp.edit_and_wait(ACCELERATION, "4321")
    page.locator("#method").select_option("compromise")
    stepramp.paste_into_table("{10, 5000}, {30, 1500}")
    expect(page.locator("#table-rows tr.row")).to_have_count(2)
    page.locator(".design-name").fill("Mine")
    stepramp.choose_example("Gauge")

    undo(stepramp)
    expect(page.locator(".design-name")).to_have_value("Mine")
    undo(stepramp)
    expect(page.locator(".design-name")).to_have_value("Lead-screw stage")
    undo(stepramp)
    expect(page.locator("#table-rows tr.row")).to_have_count(len(rows))
    assert stepramp.table_rows() == rows
    undo(stepramp)
    expect(page.locator("#method")).not_to_have_value("compromise")
    undo(stepramp)
    undo(stepramp)
    expect(stepramp.field(SLEW_SPEED)).to_have_value(before[0])
    expect(stepramp.field(ACCELERATION)).to_have_value(before[1])
    for _ in range(6):
        redo(stepramp)
    expect(page.locator(".design-name")).to_have_value("Gauge")
    undo(stepramp)
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,234")
    assert stepramp.table_rows() == [["10", "5,000"], ["30", "1,500"]]


def test_a_drag_of_a_slider_is_one_step_back(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page()
    field, slider = stepramp.field(SLEW_SPEED), stepramp.slider(SLEW_SPEED)
    before, box = field.input_value(), slider.bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    for places in ((0.5, 0.6, 0.7), (0.7, 0.5, 0.3)):
        stepramp.page.mouse.move(box["x"] + box["width"] * places[0], y)
        stepramp.page.mouse.down()
        for place in places[1:]:
            stepramp.page.mouse.move(box["x"] + box["width"] * place, y, steps=4)
        stepramp.page.mouse.up()
    after = field.input_value()
    undo(stepramp)
    middle = field.input_value()
    undo(stepramp)
    assert before == field.input_value() != middle != after
    redo(stepramp)
    redo(stepramp)
    expect(field).to_have_value(after)


def test_a_new_edit_ends_what_could_be_done_again(stepramp: StepRampPage) -> None:
    stepramp.edit_and_wait(SLEW_SPEED, "1234")
    undo(stepramp)
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    redo(stepramp)
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")


def test_axes_each_with_its_design(stepramp: StepRampPage) -> None:
    page = stepramp.page
    expect(tabs(stepramp)).to_have_count(1)
    expect(page.locator("#together-choice")).to_be_hidden()
    for count in (2, 3, 4):
        page.locator("#add-axis").click()
        expect(tabs(stepramp)).to_have_count(count)
    expect(page.locator("#add-axis")).to_be_disabled()
    page.locator(".design-name").fill("Fourth")
    stepramp.edit_and_wait(SLEW_SPEED, "444")
    tabs(stepramp).nth(0).click()
    expect(page.locator(".design-name")).to_have_value("Lead-screw stage")
    expect(stepramp.field(SLEW_SPEED)).not_to_have_value("444")
    choice(stepramp, "together", "line").click()

    stepramp.reload()
    expect(tabs(stepramp)).to_have_text(["0Lead-screw stage", "1Lead-screw stage", "2Lead-screw stage", "3Fourth"])
    expect(choice(stepramp, "together", "line")).to_have_attribute("aria-pressed", "true")
    tabs(stepramp).nth(0).focus()
    page.keyboard.press("ArrowLeft")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("444")
    expect(tabs(stepramp).nth(3)).to_be_focused()


def test_a_removed_axis_comes_back_by_undo(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#add-axis").click()
    page.locator(".design-name").fill("Second")
    page.get_by_role("button", name="Remove axis 0").click()
    expect(tabs(stepramp)).to_have_text(["0Second"])
    undo(stepramp)
    expect(tabs(stepramp)).to_have_text(["0Lead-screw stage", "1Second"])


@pytest.mark.parametrize("size", [(1024, 768), (390, 844)])
def test_axes_in_narrow_windows(open_page: Callable[..., StepRampPage], size: tuple[int, int]) -> None:
    stepramp = open_page(size)
    for _ in range(3):
        stepramp.page.locator("#add-axis").click()
    tabs(stepramp).nth(0).click()
    expect(tabs(stepramp).nth(0)).to_have_attribute("aria-selected", "true")
    choice(stepramp, "together", "line").click()
    script = "() => document.documentElement.scrollWidth <= innerWidth"
    until(lambda: stepramp.page.evaluate(script))


@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_with_all_axes_the_pressed_buttons_say_what_is_drawn(
    open_page: Callable[..., StepRampPage], size: tuple[int, int]
) -> None:
    stepramp = open_page(size)
    page = stepramp.page
    is_phone = size[0] < 500
    for name, value in (("plot", "error"),) if is_phone else (("axis", "position"), ("view", "up")):
        choice(stepramp, name, value).click()
    page.locator("#add-axis").click()
    choice(stepramp, "axes", "all").click()
    until(lambda: stepramp.x_axis()["title"].startswith("time"))
    if is_phone:
        expect(page.get_by_label("Horizontal axis").locator("visible=true")).to_have_value("time")
        expect(page.locator(".plot-title:visible b").first).to_have_text("Velocity")
        expect(choice(stepramp, "plot", "velocity")).to_have_attribute("aria-pressed", "true")
        expect(choice(stepramp, "plot", "error")).to_be_disabled()
    else:
        expect(choice(stepramp, "axis", "time")).to_have_attribute("aria-pressed", "true")
        expect(choice(stepramp, "axis", "position")).to_have_attribute("aria-pressed", "false")
        expect(choice(stepramp, "view", "whole")).to_have_attribute("aria-pressed", "true")
    choice(stepramp, "axes", "one").click()
    pressed = ("plot", "error") if is_phone else ("axis", "position")
    expect(choice(stepramp, *pressed)).to_have_attribute("aria-pressed", "true")


def test_all_axes_say_what_is_wrong_with_one_and_what_slows_a_line(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page = stepramp.page
    messages = page.locator(".summary-messages")
    page.locator("#add-axis").click()
    stepramp.field(SLEW_SPEED).fill("0")
    tabs(stepramp).nth(0).click()
    choice(stepramp, "axes", "all").click()
    expect(messages).to_contain_text("Axis 1: Slew speed is 0; allowed: a number from 0.001 to")

    tabs(stepramp).nth(1).click()
    stepramp.edit_and_wait(SLEW_SPEED, "100")
    tabs(stepramp).nth(0).click()
    expect(messages).not_to_contain_text("xis 1")
    choice(stepramp, "together", "line").click()
    expect(messages).to_contain_text("(axis 1) allows a slew speed of 100 steps/s")
    choice(stepramp, "axes", "one").click()
    expect(messages).not_to_contain_text("xis 1")
