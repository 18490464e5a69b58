"""The parameters: numbers, sliders, keys and wheel, units, presets, and what each field says of itself."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until
from stepramp.design import AxisScale, Method, Move, RampParameters, RampShape, Timer
from stepramp.drive_train import Drive, Load, Motor, StallPoint
from stepramp.mechanism import Mechanism

BASE_SPEED = "ramp.base_speed_steps_per_s"
DECELERATION = "ramp.deceleration_steps_per_s2"
DISTANCE = "move.steps"
MICROSTEPS = "axis.microsteps"


@pytest.fixture
def stepramp(module_page: StepRampPage, server: Server) -> StepRampPage:
    del server  # it lets go of devices after each test
    units(module_page, "steps", "s")
    module_page.start_over()
    return module_page


def units(stepramp: StepRampPage, length: str, time: str = "s") -> None:
    stepramp.page.locator(f'#length-unit [data-value="{length}"]').click()
    stepramp.page.locator(f'#time-unit [data-value="{time}"]').click()


def kept(stepramp: StepRampPage, path: str) -> Any:
    part, name = path.split(".")
    return stepramp.design()[part][name]


def unit_of(stepramp: StepRampPage, path: str) -> Locator:
    return stepramp.page.locator(f'.parameter[data-path="{path}"] .unit')


def note(stepramp: StepRampPage, path: str) -> Locator:
    return stepramp.page.locator(f'.parameter[data-path="{path}"] .note')


def wheel(page: Page, turn: Locator, notches: int) -> None:
    """Turn the wheel over a control; it works when the pointer has rested there."""
    turn.hover()
    page.wait_for_timeout(300)
    page.mouse.wheel(0, -100 * notches)


# ---- keys and wheel ----


def test_arrow_keys_step_in_the_field_and_on_the_slider(stepramp: StepRampPage) -> None:
    press = stepramp.page.keyboard.press
    for control in (stepramp.field(SLEW_SPEED), stepramp.slider(SLEW_SPEED)):
        stepramp.start_over()
        control.focus()
        for key, value in [
            ("ArrowUp", 1010),
            ("ArrowDown", 1000),
            ("Shift+ArrowUp", 1100),
            ("PageDown", 1000),
            ("Alt+ArrowUp", 1001),
            ("Alt+ArrowDown", 1000),
            ("PageUp", 1100),
        ]:
            press(key)
            assert kept(stepramp, SLEW_SPEED) == value
            expect(stepramp.field(SLEW_SPEED)).to_have_value(f"{value:,}")
        expect(control).to_be_focused()


def test_a_slider_goes_sideways_and_to_its_ends_and_the_field_keeps_its_caret_keys(stepramp: StepRampPage) -> None:
    press = stepramp.page.keyboard.press
    stepramp.slider(SLEW_SPEED).focus()
    for key, value in [("ArrowRight", 1010), ("ArrowLeft", 1000), ("Home", 50), ("End", 50_000)]:
        press(key)
        assert kept(stepramp, SLEW_SPEED) == value
    stepramp.field(SLEW_SPEED).focus()
    for key in ("Home", "ArrowRight", "End", "ArrowLeft"):
        press(key)
        assert kept(stepramp, SLEW_SPEED) == 50_000


def test_a_backward_move_keeps_its_direction_on_the_slider(stepramp: StepRampPage) -> None:
    stepramp.field(DISTANCE).fill("-500")
    stepramp.slider(DISTANCE).focus()
    stepramp.page.keyboard.press("ArrowRight")
    assert kept(stepramp, DISTANCE) == -505
    stepramp.page.keyboard.press("Home")
    stepramp.page.keyboard.press("ArrowLeft")
    assert kept(stepramp, DISTANCE) == -1
    stepramp.field(DISTANCE).focus()
    stepramp.page.keyboard.press("ArrowUp")
    assert kept(stepramp, DISTANCE) == 1


def test_microsteps_double(stepramp: StepRampPage) -> None:
    stepramp.field(MICROSTEPS).focus()
    stepramp.page.keyboard.press("ArrowUp")
    assert kept(stepramp, MICROSTEPS) == 4


def test_text_that_is_no_number_is_not_stepped_away(stepramp: StepRampPage, module_watch: Watch) -> None:
    module_watch.expected.append(REFUSED_VALUE)
    stepramp.field(SLEW_SPEED).fill("12o0")
    stepramp.page.keyboard.press("ArrowUp")
    assert kept(stepramp, SLEW_SPEED) == "12o0"
    expect(stepramp.field(SLEW_SPEED)).to_have_value("12o0")


def test_the_wheel_steps_what_the_pointer_rests_on(stepramp: StepRampPage) -> None:
    page = stepramp.page
    wheel(page, stepramp.field(SLEW_SPEED), 1)
    until(lambda: kept(stepramp, SLEW_SPEED) == 1010)
    wheel(page, stepramp.slider(SLEW_SPEED), -1)
    until(lambda: kept(stepramp, SLEW_SPEED) == 1000)
    page.keyboard.down("Shift")
    wheel(page, stepramp.slider(SLEW_SPEED), 1)
    page.keyboard.up("Shift")
    until(lambda: kept(stepramp, SLEW_SPEED) == 1100)


def test_a_panel_that_scrolls_keeps_its_wheel(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page((1024, 500))
    page = stepramp.page
    scrolled = "() => document.querySelector('.groups').scrollTop"
    wheel(page, stepramp.field(MICROSTEPS), -1)
    until(lambda: page.evaluate(scrolled) > 0)
    assert kept(stepramp, MICROSTEPS) == 2
    # With the focus it is meant for the field.
    stepramp.field(SLEW_SPEED).click()
    before = page.evaluate(scrolled)
    wheel(page, stepramp.field(SLEW_SPEED), 1)
    until(lambda: kept(stepramp, SLEW_SPEED) == 1010)
    assert page.evaluate(scrolled) == before


# ---- units ----


def test_all_quantities_are_shown_in_the_unit_chosen_and_the_design_stays(stepramp: StepRampPage) -> None:
    before = stepramp.design()
    # 400 steps are a turn of 8 mm: 1,000 steps/s, 5,000 steps/s², 500 steps.
    for length, time, values in [
        ("mm", "s", ("20", "mm/s", "100", "mm/s²", "10", "mm")),
        ("mm", "min", ("1,200", "mm/min", "360,000", "mm/min²", "10", "mm")),
        ("rev", "s", ("2.5", "rev/s", "12.5", "rev/s²", "1.25", "rev")),
        ("rev", "min", ("150", "rev/min", "45,000", "rev/min²", "1.25", "rev")),
        ("deg", "s", ("900", "°/s", "4,500", "°/s²", "450", "°")),
        ("steps", "min", ("60,000", "steps/min", "18,000,000", "steps/min²", "500", "steps")),
        ("steps", "s", ("1,000", "steps/s", "5,000", "steps/s²", "500", "steps")),
    ]:
        units(stepramp, length, time)
        shown = []
        for path in (SLEW_SPEED, ACCELERATION, DISTANCE):
            shown += [stepramp.field(path).input_value(), unit_of(stepramp, path).inner_text()]
        assert tuple(shown) == values
        expect(stepramp.field(DECELERATION)).to_have_attribute("placeholder", values[2])
        expect(stepramp.slider(SLEW_SPEED)).to_have_attribute("aria-valuetext", f"{values[0]} {values[1]}")
        assert stepramp.design() == before


def test_what_is_typed_in_another_unit_is_kept_and_shown_as_typed(stepramp: StepRampPage) -> None:
    units(stepramp, "mm")
    stepramp.edit_and_wait(SLEW_SPEED, "10")
    assert kept(stepramp, SLEW_SPEED) == 500
    for text, stored in (("0.3", 15), ("33.333333333", 1666.66666665), ("1234.5678", 61728.39)):
        stepramp.field(SLEW_SPEED).fill(text)
        stepramp.field(SLEW_SPEED).blur()
        assert kept(stepramp, SLEW_SPEED) == pytest.approx(stored, rel=1e-11)
        expect(stepramp.field(SLEW_SPEED)).to_have_value(f"{float(text):,.9f}".rstrip("0"))
        stored_before = kept(stepramp, SLEW_SPEED)
        for length, time in (("rev", "min"), ("deg", "s"), ("steps", "min"), ("mm", "s")):
            units(stepramp, length, time)
        expect(stepramp.field(SLEW_SPEED)).to_have_value(f"{float(text):,.9f}".rstrip("0"))
        assert kept(stepramp, SLEW_SPEED) == stored_before


def test_a_length_that_is_no_whole_number_of_steps_is_rounded_and_told(stepramp: StepRampPage) -> None:
    units(stepramp, "mm")
    field = stepramp.field(DISTANCE)
    field.fill("10.01")
    expect(note(stepramp, DISTANCE)).to_have_text("10.01 mm would be 500.5 steps: it is 501, 10.02 mm.")
    assert kept(stepramp, DISTANCE) == 501
    expect(field).to_have_value("10.01")
    field.blur()
    expect(field).to_have_value("10.02")
    expect(note(stepramp, DISTANCE)).not_to_be_empty()
    field.fill("10")
    expect(note(stepramp, DISTANCE)).to_be_empty()
    assert kept(stepramp, DISTANCE) == 500


def test_a_length_below_a_step_is_refused_as_it_was_typed(stepramp: StepRampPage, module_watch: Watch) -> None:
    module_watch.expected.append(REFUSED_VALUE)
    units(stepramp, "mm")
    message = stepramp.message(DISTANCE)
    for typed in ("0.001", "-0.001", "1e-9"):
        stepramp.field(DISTANCE).fill(typed)
        expect(message).to_have_text(f"{typed} mm is less than half a step; the least is 0.02 mm.")
    stepramp.field(DISTANCE).fill("0")
    expect(message).to_have_text(re.compile("^Distance is 0 mm .*but not 0"))
    stepramp.field(DISTANCE).fill("-0.01")
    expect(stepramp.field(DISTANCE)).to_have_attribute("aria-invalid", "false")
    assert kept(stepramp, DISTANCE) == -1, "half a step is one, whichever way"


def test_steps_of_keys_are_round_in_the_unit_shown(stepramp: StepRampPage) -> None:
    units(stepramp, "mm")
    stepramp.field(SLEW_SPEED).focus()
    stepramp.page.keyboard.press("ArrowUp")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("20.2")
    assert kept(stepramp, SLEW_SPEED) == 1010


def test_what_is_refused_is_told_in_the_unit_shown(stepramp: StepRampPage, module_watch: Watch) -> None:
    module_watch.expected.append(REFUSED_VALUE)
    units(stepramp, "mm")
    stepramp.field(SLEW_SPEED).fill("40000")
    message = stepramp.message(SLEW_SPEED)
    expect(message).to_have_text(
        "Slew speed is 40,000 mm/s (2,000,000 steps/s); allowed: a number from 0.00002 to 20,000 mm/s."
    )
    units(stepramp, "steps")
    expect(message).to_have_text("Slew speed is 2,000,000; allowed: a number from 0.001 to 1,000,000 steps/s.")
    stepramp.field(SLEW_SPEED).fill("1000")
    units(stepramp, "mm")
    stepramp.field(BASE_SPEED).fill("40")
    expect(stepramp.message(BASE_SPEED)).to_contain_text("allowed: a number from 0 to 20 mm/s, the slew speed.")


def test_the_units_outlive_a_reload_and_millimetres_need_an_axis_that_has_them(stepramp: StepRampPage) -> None:
    units(stepramp, "mm", "min")
    stepramp.reload()
    expect(unit_of(stepramp, SLEW_SPEED)).to_have_text("mm/min")
    stepramp.choose_example("Gauge")
    expect(unit_of(stepramp, SLEW_SPEED)).to_have_text("steps/min")
    expect(stepramp.page.locator('#length-unit [data-value="mm"]')).to_be_hidden()
    stepramp.choose_example("Lead-screw stage")
    expect(unit_of(stepramp, SLEW_SPEED)).to_have_text("mm/min")
    stepramp.page.keyboard.press("Control+z")
    expect(unit_of(stepramp, SLEW_SPEED)).to_have_text("steps/min")


# ---- presets ----


def test_a_preset_sets_its_fields_and_says_so_and_undo_takes_it_back(stepramp: StepRampPage) -> None:
    page = stepramp.page
    before = stepramp.design()
    presets, info = page.locator("#axis-presets"), page.locator("#parameter-info")
    expect(presets).to_have_value("NEMA 17 · T8 screw, 8 mm")
    presets.select_option("NEMA 17 · GT2 belt, 20 teeth")
    expect(stepramp.field("axis.travel_per_rev")).to_have_value("40")
    expect(info).to_contain_text("Set: steps a turn 200 full steps, travel a turn 40 mm.")
    expect(page.locator("#announcements")).to_have_text("NEMA 17 · GT2 belt, 20 teeth: set")
    after = stepramp.design()
    assert after["axis"] == before["axis"] | {"travel_per_rev": 40}
    assert {name for name in before if before[name] != after[name]} == {"axis"}
    page.keyboard.press("Control+z")
    assert stepramp.design() == before
    expect(presets).to_have_value("NEMA 17 · T8 screw, 8 mm")


def test_a_timer_preset_leaves_the_shortest_delay_alone(stepramp: StepRampPage) -> None:
    page = stepramp.page
    expect(page.locator("#timer-presets")).to_have_value("Uno, Nano, Mega · 2 MHz")
    page.locator("#timer-presets").select_option("Pico · PIO, 125 MHz")
    assert stepramp.design()["timer"] == {
        "frequency_hz": 125_000_000,
        "counter_bits": 32,
        "shortest_interval_us": 20,
    }
    stepramp.field("timer.counter_bits").fill("24")
    expect(page.locator("#timer-presets")).to_have_value("")
    expect(page.locator("#timer-presets option:checked")).to_have_text("Presets")


# ---- the method ----


def test_what_the_method_is_tuned_for_can_be_chosen_where_it_matters(stepramp: StepRampPage) -> None:
    page = stepramp.page
    choice = page.locator("#tuned-for")
    expect(choice).to_be_hidden()
    page.locator("#method").select_option("tuned")
    expect(choice.locator('[data-value="largest_error"]')).to_have_attribute("aria-pressed", "true")
    until(lambda: "tuned-error" in stepramp.curves())
    before = stepramp.curves()["tuned-error"]
    choice.locator('[data-value="time"]').click()
    until(lambda: stepramp.curves()["tuned-error"] != before)
    assert kept(stepramp, "method.tuned_for") == "time"


def test_every_field_of_a_design_can_be_edited(stepramp: StepRampPage) -> None:
    """Each has a control on the page: a number, a choice, the name, or the table with its unit."""
    parts = {"axis": AxisScale, "timer": Timer, "ramp": RampParameters, "method": Method, "move": Move}
    parts |= {"motor": Motor, "drive": Drive, "load": Load}
    parts |= {"motor.stalled": StallPoint, "load.mechanism": Mechanism, "motor.measured_with": Drive}
    paths = {f"{part}.{name}" for part, model in parts.items() for name in model.model_fields}
    shape = RampShape.model_fields.keys() - {"name"}
    paths |= {f"ramp.shape.{name}" for name in shape}
    numbers = stepramp.page.evaluate(
        "() => [...document.querySelectorAll('.parameter')].map((one) => one.dataset.path)"
    )
    choices = {"method.name": "#method", "method.arithmetic": "#arithmetic", "method.rounding": "#rounding"}
    choices |= {"ramp.shape": "#shape", "ramp.shape.points": "#drawn-points", "move.plan": "#short-moves"}
    choices |= {"method.tuned_for": "#tuned-for", "axis.travel_unit": '[aria-label="Travel unit"]'}
    choices |= {"drive.current_is": "#current-is", "motor.kind": "#kind", "motor.torque_curve": "#torque-curve"}
    choices |= {"motor.measured_with": "#stall-point", "motor.measured_with.current_is": "#current-then-is"}
    choices |= {"motor.stalled": "#stall-point", "load.mechanism": "#mechanism", "load.mechanism.name": "#mechanism"}
    assert paths == set(numbers) | set(choices)
    for selector in choices.values():
        expect(stepramp.page.locator(selector)).to_have_count(1)


# ---- what a field says of itself ----


def test_every_field_explains_itself(stepramp: StepRampPage, module_watch: Watch) -> None:
    # Numbers of which nobody has said yet what they are: they explain themselves, too.
    module_watch.expected.append(REFUSED_VALUE)
    page = stepramp.page
    info = page.locator("#parameter-info")
    page.locator("#method").select_option("tuned")
    explained = ".parameter, .choice, .units, .group-head:has(select), .drawn-points"
    said = dict[str, str]()
    page.locator("#motor-presets").select_option("NEMA 17 · 17HS4401")
    stepramp.field("drive.current_a").fill("1.5")
    for summary in page.locator(".motor-section summary").all():
        summary.click()
    for shape, mechanism in (("drawn", "screw"), ("s_curve", "belt"), ("torque", "pointer")):
        page.locator("#shape").select_option(shape)
        page.locator("#mechanism").select_option(mechanism)
        if shape == "torque":
            page.locator("#stall-point").click()
        for row in page.locator(explained).filter(visible=True).all():
            row.hover()
            said[row.evaluate("(row) => row.dataset.path ?? row.textContent")] = info.inner_text()
    assert len(set(said.values())) == page.locator(explained).count()
    for text in said.values():
        assert len(text.split()) > 8, text
    for field in page.locator(".parameter input.number").all():
        assert field.get_attribute("aria-description")


def test_a_tap_on_a_name_explains_on_a_phone(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page((390, 844))
    page = stepramp.page
    info = page.locator("#parameter-info")
    expect(info).to_be_hidden()
    page.locator('.parameter[data-path="axis.microsteps"] label').click()
    expect(info).to_be_visible()
    expect(info).to_contain_text("Driver pulses for one full step")
    expect(stepramp.field(MICROSTEPS)).not_to_be_focused()
    info.get_by_role("button", name="Close").click()
    expect(info).to_be_hidden()


def test_parameters_by_keyboard_alone(open_page: Callable[..., StepRampPage]) -> None:
    """From the top of the page to a new slew speed in millimetres, and the preset of another timer."""
    stepramp = open_page()
    page = stepramp.page

    def tab_to(selector: str) -> None:
        for _ in range(120):
            page.keyboard.press("Tab")
            if page.evaluate("(selector) => document.activeElement.matches(selector)", selector):
                return
        raise AssertionError(f"{selector} is not reached")

    tab_to('#length-unit [data-value="mm"]')
    page.keyboard.press("Enter")
    tab_to("#timer-presets")
    page.keyboard.press("ArrowDown")
    tab_to(f'.parameter[data-path="{SLEW_SPEED}"] input.number')
    page.keyboard.press("Control+a")
    page.keyboard.type("15")
    page.keyboard.press("Tab")
    page.keyboard.press("ArrowRight")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("15.2")
    assert kept(stepramp, SLEW_SPEED) == 760
    assert kept(stepramp, "timer.frequency_hz") == 16_000_000
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert kept(stepramp, SLEW_SPEED) == 1000
