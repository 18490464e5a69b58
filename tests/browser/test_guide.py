"""The guide of a first visit: it makes a design like any other, can be left at any time, and doesn't come again."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.conftest import DESKTOP, Watch, new_page
from browser.server import Server
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until
from browser.test_accessibility import Inspection


@pytest.fixture
def first_visit(context: BrowserContext, server: Server, watch: Watch) -> Iterator[StepRampPage]:
    page = new_page(context, watch, DESKTOP)
    page.emulate_media(color_scheme="dark", reduced_motion="reduce")
    page.goto(server.url)
    stepramp = StepRampPage(page, server.url)
    stepramp.wait_for_plots()
    yield stepramp
    page.close()


def test_from_the_motor_to_the_settings_of_grbl(first_visit: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page, guide = first_visit.page, first_visit.page.locator("#guide")
    heading, following = guide.locator("h2"), guide.locator("#guide-next")
    seen = Inspection(first_visit)
    page.set_viewport_size({"width": 1440, "height": 900})
    expect(heading).to_have_text("1 of 4: Your motor")
    expect(page.locator("#device")).to_be_hidden()
    guide.locator("#guide-motors").select_option("NEMA 17 · GT2 belt, 20 teeth")
    # 1,000 steps/s at 2 microsteps are 128,000 at 256: more than one each 20 us.
    # 50,000 steps/s at 200 · 256 / 40 = 1280 steps/mm are 39.0625 mm/s.
    guide.get_by_label("Microsteps").fill("256")
    expect(guide.locator("#guide-refused")).to_contain_text("use a slew speed of at most 39.0625 mm/s")
    guide.get_by_label("Microsteps").fill("16")
    expect(guide.locator("#guide-refused")).to_be_empty()
    seen.inspect("motor", "#guide")
    following.click()
    expect(heading).to_be_focused()
    # 200 · 16 / 40 = 80 steps/mm: 6,000 mm/min are 100 mm/s and 8,000 steps/s, 500 mm/s² are 40,000 steps/s².
    guide.get_by_role("button", name="per minute").click()
    guide.get_by_label("Slew speed").fill("6000")
    guide.get_by_role("button", name="per second").click()
    expect(guide.get_by_label("Slew speed")).to_have_value("100")
    guide.get_by_label("Acceleration").fill("fast")
    expect(guide.locator(".guide-number .message")).to_contain_text("Acceleration is 'fast'; allowed: a number from")
    seen.inspect("refused", "#guide")
    guide.get_by_role("button", name="4 Use").click()
    expect(guide.locator(".guide-problem")).to_contain_text("Step 2, Limits: Acceleration is 'fast'; allowed: a number")
    expect(guide.locator("#guide-sketch")).to_be_disabled()
    # Who has not said what makes the steps finds the way to the settings of grbl.
    guide.locator("#guide-choose").click()
    following.click()
    guide.locator("#guide-back").click()
    guide.locator("#guide-back").click()
    guide.get_by_label("Acceleration").fill("500")
    following.click()
    guide.get_by_label("Distance").fill("5")
    # The mean of 0 and the peak v over a way of 2.5 mm: v = sqrt(2 · 500 · 2.5) = 50 mm/s; 100 mm/s take 2 · 10 mm.
    expect(guide.locator("#guide-outcome")).to_contain_text(
        "Too short: it reaches 50 mm/s of 100 mm/s, and needs about 20 mm"
    )
    guide.get_by_text("grbl", exact=True).click()
    seen.inspect("ramp", "#guide")
    guide.locator("#guide-lengthen").click()
    expect(guide.locator("#guide-outcome")).to_contain_text("It reaches 100 mm/s")
    following.click()
    expect(guide.locator("#guide-settings")).to_have_text(re.compile(r"^\$100=80\s\$110=6000.000\s\$120=500.000$"))
    seen.inspect("use", "#guide")
    page.set_viewport_size({"width": 1440, "height": 900})
    following.click()
    expect(guide).to_be_hidden()
    expect(page.locator("#device")).to_be_visible()
    expect(first_visit.field(SLEW_SPEED)).to_have_value("100")
    expect(first_visit.field(ACCELERATION)).to_have_value("500")
    # Each visit of a step is undone as one: the way and the method, the limits twice, the motor.
    for _ in range(4):
        page.keyboard.press("Control+z")
    expect(page.get_by_label("Design name")).to_have_value("Lead-screw stage")
    until(lambda: page.locator("#head-undo").is_disabled())
    assert not seen.findings, "\n".join(seen.findings)


def test_what_is_refused_is_marked_and_told_in_the_steps_after_it(first_visit: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page, guide = first_visit.page, first_visit.page.locator("#guide")
    marked, told = guide.locator(".segmented .refused"), guide.locator(".guide-problem")
    guide.get_by_label("Way of one turn").fill("abc")
    page.keyboard.press("Enter")
    expect(marked).to_have_text([re.compile("^1 Motor")])
    expect(told).to_be_empty()
    guide.locator("#guide-next").click()
    expect(told).to_contain_text("Step 1, Motor: Way of one turn is 'abc'; allowed: a number from")
    expect(guide.locator(".guide-result:not(:empty)")).to_have_count(0)
    # The steps a turn are known all the same, and this speed is 2,500 times the highest that the timer allows.
    guide.get_by_label("Slew speed").fill("1e9")
    expect(guide.locator("#guide-ramp-slew_speed_steps_per_s-message")).to_contain_text("Slew speed is 1,000,000,000")
    expect(guide.locator(".guide-result:not(:empty)")).to_have_count(0)
    expect(marked).to_have_count(2)
    for _ in range(2):
        guide.locator("#guide-next").click()
    expect(told).to_contain_text("Step 2, Limits: Slew speed is 1,000,000,000")
    expect(told.locator("button")).to_have_count(2)
    told.get_by_role("button", name="Go to “Way of one turn”").click()
    expect(guide.locator("h2")).to_have_text("1 of 4: Your motor")
    expect(guide.get_by_label("Way of one turn")).to_be_focused()
    guide.get_by_label("Way of one turn").fill("8")
    expect(marked).to_have_text([re.compile("^2 Limits")])
    guide.locator("#guide-next").click()
    expect(guide.locator(".guide-result:not(:empty)")).to_have_count(0)
    guide.get_by_label("Slew speed").fill("20")
    expect(guide.locator(".guide-result")).to_contain_text(["The motor turns 150 times a minute."])
    expect(marked).to_have_count(0)
    guide.get_by_role("button", name="4 Use").click()
    expect(guide.locator("#guide-sketch")).to_be_enabled()
    expect(told).to_be_empty()
    guide.get_by_role("button", name="3 Ramp").click()
    guide.get_by_label("Distance").fill("0.001")
    expect(guide.locator("#guide-move-steps-message")).to_have_text(
        "0.001 mm is less than half a step; the least is 0.02 mm."
    )
    guide.get_by_label("Distance").fill("10")
    expect(marked).to_have_count(0)
    guide.get_by_role("button", name="4 Use").click()
    # What the guide doesn't ask for is corrected outside of it.
    first_visit.field("timer.frequency_hz").fill("0")
    expect(told).to_contain_text("Frequency is 0; allowed")
    told.get_by_role("button", name="Close the guide to correct it").click()
    expect(guide).to_be_hidden()


def test_it_is_shown_once_and_opened_from_the_menu(first_visit: StepRampPage, tmp_path: Path) -> None:
    page, guide = first_visit.page, first_visit.page.locator("#guide")
    page.set_viewport_size({"width": 320, "height": 568})
    expect(guide.locator("#guide-motors")).to_be_in_viewport(ratio=1)
    until(lambda: page.evaluate("() => document.querySelector('.figure').layout.height") > 120)
    page.set_viewport_size({"width": 320, "height": 640})
    guide.locator("#guide-skip").click()
    page.reload()
    first_visit.wait_for_plots()
    expect(guide.locator("h2")).to_have_text("1 of 4: Your motor")
    assert page.evaluate("() => document.documentElement.scrollWidth") == 320
    expect(page.locator("#stop")).to_be_in_viewport()
    guide.get_by_label("Close the guide").click()
    first_visit.reload()
    expect(guide).to_be_hidden()
    page.locator("#examples").click()
    page.locator("#menu-list button", has_text="Guide").click()
    expect(guide).to_be_focused()
    for _ in range(3):
        guide.locator("#guide-skip").click()
    expect(page.get_by_label("Design name")).to_have_value("Lead-screw stage")
    # Who said nothing of what plays the ramp is shown the ways.
    guide.locator("#guide-sketch").click()
    expect(page.locator("#export-dialog")).to_have_attribute("data-shown", "arduino")
    expect(page.locator("#export-preview")).to_contain_text("void loop()")
    page.locator("#export-dialog").get_by_label("Close").click()
    guide.locator("#guide-report").click()
    expect(page.locator("#export-dialog")).to_have_attribute("data-shown", "report_pdf")
    with page.expect_download() as download:
        page.locator("#export-download").click()
    assert download.value.suggested_filename == "lead_screw_stage_report.pdf"
    download.value.save_as(tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF-")
    page.locator("#export-dialog").get_by_label("Close").click()
    guide.locator("#guide-controller").click()
    expect(guide).to_be_hidden()
    expect(page.locator("#device")).to_be_focused()
