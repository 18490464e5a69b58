"""What hands and keys leave behind: history, readout, focus, and strips that scroll."""

from playwright.sync_api import expect

from browser.conftest import DESKTOP, Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

NOTHING_READ = "Point at a plot to read it"


def test_a_value_that_was_finished_with_enter_is_undone_at_once(module_page: StepRampPage) -> None:
    """The text was typed, but what is taken back is what was set, with the focus still in its field."""
    page = module_page.page
    module_page.start_over()
    field = module_page.field(SLEW_SPEED)
    field.focus()
    page.keyboard.type("640")
    page.keyboard.press("Enter")
    until(lambda: module_page.design()["ramp"]["slew_speed_steps_per_s"] == 640)
    page.keyboard.press("Control+z")
    expect(field).to_have_value("1,000")
    assert module_page.design()["ramp"]["slew_speed_steps_per_s"] == 1000
    page.keyboard.press("Control+Shift+z")
    expect(field).to_have_value("640")


def test_the_readout_ends_where_the_hand_or_the_focus_goes_elsewhere(module_page: StepRampPage) -> None:
    page, reading = module_page.page, module_page.page.locator("#status .reading")
    module_page.start_over()
    plots = page.locator("#figure .scope")
    plots.focus()
    page.keyboard.press("ArrowRight")
    expect(reading).to_contain_text("Step")
    # A finger is put down elsewhere: it takes no focus away and leaves no plot.
    page.locator("#status").dispatch_event("pointerdown", {"pointerType": "touch", "bubbles": True})
    expect(reading).to_have_text(NOTHING_READ)
    page.keyboard.press("ArrowRight")
    expect(reading).to_contain_text("Step")
    plots.dispatch_event("pointerdown", {"pointerType": "touch", "pointerId": 7, "clientX": 600, "bubbles": True})
    expect(reading).to_contain_text("Step")
    page.keyboard.press("Tab")
    expect(reading).to_have_text(NOTHING_READ)


def test_the_focus_stays_near_what_was_removed(module_page: StepRampPage) -> None:
    page = module_page.page
    module_page.start_over()
    page.locator("#keep").click()
    # What isn't drawn yet takes no focus: the key would go to the button pressed before.
    expect(page.locator("#forget")).to_be_visible()
    page.locator("#forget").press("Enter")
    expect(page.locator("#forget")).to_be_hidden()
    expect(page.locator("#keep")).to_be_focused()
    # Held, the key repeats itself, where the focus is now: that pins nothing again.
    page.locator("#keep").press("Enter")
    page.locator("#forget").focus()
    for _ in range(3):
        page.keyboard.down("Enter")
    page.keyboard.up("Enter")
    expect(page.locator("#keep")).to_be_focused()
    expect(page.locator("#forget")).to_be_hidden()
    page.locator("#add-axis").click()
    expect(page.locator(".axis-tab")).to_have_count(2)
    page.locator(".axes .remove").last.press("Enter")
    expect(page.locator(".axis-tab")).to_have_count(1)
    expect(page.locator(".axis-tab[aria-selected=true]")).to_be_focused()
    page.get_by_role("button", name="In flight").click()
    dialog = page.locator("#flight-dialog")
    expect(dialog.get_by_label("Remove command 2")).to_be_visible()
    dialog.get_by_label("Remove command 2").press("Enter")
    expect(dialog.get_by_label("Time of command 1")).to_be_focused()
    dialog.get_by_role("button", name="Close").last.click()


def test_a_length_that_rounds_to_nothing_is_one_fault(module_page: StepRampPage, module_watch: Watch) -> None:
    module_watch.expected.append(REFUSED_VALUE)
    page = module_page.page
    module_page.start_over()
    page.locator('.units [data-value="mm"]').click()
    row = page.locator('.parameter[data-path="move.steps"]')
    module_page.field("move.steps").fill("10.01")
    expect(row.locator(".note")).to_contain_text("10.01 mm would be 500.5 steps")
    module_page.field("move.steps").fill("0.0001")
    expect(row.locator(".message")).to_contain_text("0.0001 mm is less than half a step")
    expect(row.locator(".note")).to_be_hidden()
    module_page.field("move.steps").fill("10")
    expect(row.locator(".message")).to_have_count(0)
    page.locator('.units [data-value="steps"]').click()


def test_nothing_of_the_summary_is_cut_and_strips_fade_where_they_go_on(module_page: StepRampPage) -> None:
    page = module_page.page
    module_page.start_over()
    page.locator('.units [data-value="mm"]').click()
    module_page.field("move.steps").fill("1200")
    until(lambda: "60,000 steps = 1,200 mm" in module_page.figure_text("duration"))
    page.set_viewport_size({"width": 1024, "height": 768})
    cut = """() => [...document.querySelectorAll('#summary .stat dd')]
        .filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.textContent)"""
    assert page.evaluate(cut) == []
    page.set_viewport_size({"width": 390, "height": 844})
    arrows = "(one) => ['::before', '::after'].map((side) => getComputedStyle(one, side).content[1] ?? '')"
    for strip in (page.locator(".legend"), page.locator("#summary .figures:visible")):
        until(lambda one=strip: one.get_attribute("data-more-after") is not None)
        assert strip.get_attribute("data-more-before") is None
        assert strip.evaluate(arrows) == ["o", "›"], "none, and one"
        width = strip.evaluate("(one) => one.scrollWidth")
        strip.evaluate("(one) => { one.scrollLeft = 100; }")
        until(lambda one=strip: one.evaluate(arrows) == ["‹", "›"])
        assert strip.evaluate("(one) => one.scrollWidth") == width, "they take no room"
        strip.evaluate("(one) => { one.scrollLeft = one.scrollWidth; }")
        until(lambda one=strip: one.get_attribute("data-more-after") is None)
        assert strip.get_attribute("data-more-before") is not None
        assert strip.evaluate(arrows) == ["‹", "o"]
    page.set_viewport_size({"width": DESKTOP[0], "height": DESKTOP[1]})
    page.locator('.units [data-value="steps"]').click()
