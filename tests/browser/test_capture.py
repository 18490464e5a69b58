"""Measured steps: files of logic analysers laid over the plots and tried again; traces saved in the same form."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, StepRampPage, drop_file, until
from capture.writers import pulses, saleae_csv, sampled, written_by_sigrok
from stepramp.design import Design
from stepramp.ramp.profile import profile_of

NAMES = ("Step", "Dir")
BEGIN_US = 2000


@pytest.fixture
def stepramp(module_page: StepRampPage, server: Server) -> StepRampPage:
    del server  # it lets go of devices after each test
    module_page.start_over()
    return module_page


def planned_us(stepramp: StepRampPage) -> list[int]:
    """Return when the steps of the page's example are to be made."""
    examples = stepramp.ask(stepramp.url, "GET", "examples")["examples"]
    [design] = [one["design"] for one in examples if one["title"] == "Lead-screw stage"]
    return [BEGIN_US + round(time_s * 1e6) for time_s in profile_of(Design.checked(design)).time_s]


def choose(page: Page, button: str, path: Path) -> None:
    with page.expect_file_chooser() as chooser:
        page.locator(button).click()
    chooser.value.set_files(path)


def figure(page: Page, name: str) -> Locator:
    """Return what the dialog says of the captured move."""
    return page.locator(f"#capture-figures dt:has-text('{name}') + dd")


def both_edges_are_twice_the_steps(page: Page) -> None:
    page.locator('#capture-edge [data-value="both"]').click()
    expect(figure(page, "Steps")).to_have_text("1,000; planned 500")
    page.locator('#capture-edge [data-value="rising"]').click()
    expect(figure(page, "Steps")).to_have_text("500; planned 500")


def the_kept_capture_is_shown(stepramp: StepRampPage) -> None:
    """Kept with its design, which is saved for it, it is found and shown there later."""
    page = stepramp.page
    page.locator("#capture-chip").click()
    page.locator("#capture-keep").click()
    expect(page.locator("#notice")).to_contain_text("Capture kept in the library with “Lead-screw stage”, revision 1")
    page.keyboard.press("Escape")
    page.locator("#examples").click()
    page.get_by_role("button", name="Library …").click()
    page.locator(".library-design b", has_text="Lead-screw stage").click()
    page.get_by_role("button", name="Show the capture of revision 1").click()
    expect(page.locator("#library-note")).to_have_text("The capture lies over the plots now.")
    page.keyboard.press("Escape")
    until(lambda: "measured-deviation" in stepramp.curves())
    shown = stepramp.curves()["measured-deviation"]
    assert max(abs(each) for each in shown) == pytest.approx(0, abs=1)
    assert len(shown) == 499


def test_a_dropped_capture_is_laid_over_the_plots_and_follows_the_design(
    stepramp: StepRampPage, module_watch: Watch
) -> None:
    module_watch.expected = [REFUSED_VALUE]
    page = stepramp.page
    planned = planned_us(stepramp)
    # Step 101 is missing, and 0.4 ms after step 250 there is a pulse too many. Two pulses are of 1 µs.
    made = [one for one in planned if one != planned[100]]
    long = [one for one in made if one not in (planned[40], planned[41])]
    changes = [*pulses([*long, planned[249] + 400], 5), *pulses([planned[40], planned[41]], 1), (1000, 1, 1)]
    drop_file(page, "try 1.csv", saleae_csv(changes, NAMES))
    expect(figure(page, "Steps")).to_have_text("500; planned 500")
    expect(figure(page, "Missing")).to_have_text("1: planned step 101")
    expect(figure(page, "Extra")).to_have_text("1: measured step 250")
    expect(figure(page, "From first to last")).to_have_text(re.compile(r"^([\d.]+ s); planned \1$"))
    expect(page.locator("#capture-step")).to_have_value("Step")
    expect(page.locator("#capture-direction")).to_have_value("Dir")

    shortest = page.locator("#capture-shortest")
    shortest.fill("2")
    shortest.press("Enter")
    expect(figure(page, "Too short")).to_have_text("2: measured steps 41, 42")
    shortest.fill("short")
    shortest.press("Enter")
    expect(page.locator("#capture-shortest-message")).to_contain_text("Shortest pulse is 'short'; allowed: ")
    expect(figure(page, "Too short")).to_have_text("2: measured steps 41, 42")
    shortest.fill("")
    shortest.press("Enter")
    expect(figure(page, "Too short")).to_have_count(0)
    both_edges_are_twice_the_steps(page)
    page.keyboard.press("Escape")
    chip = page.locator("#capture-chip")
    expect(chip).to_contain_text("× 1")
    expect(chip).to_have_attribute(
        "title", "What a logic analyser measured: 1 missing (planned step 101), 1 extra (measured step 250)"
    )
    page.locator('#third-choice [data-value="deviation"]').click()
    until(lambda: "capture-deviation" in stepramp.curves())
    curves = stepramp.curves()
    assert len(curves["capture-missing-velocity"]) == len(curves["capture-extra-delay"]) == 1
    assert max(abs(each) for each in curves["capture-deviation"]) == pytest.approx(0, abs=1)
    page.locator(".scope").hover()
    expect(page.locator(".tooltip .measured")).to_have_text(re.compile(r"Capture.*µs$"))
    page.mouse.move(5, 5)

    the_kept_capture_is_shown(stepramp)
    page.mouse.move(5, 5)

    # Another design: the same file is held against it, and nobody has to open it again.
    stepramp.field("move.steps").fill("600")
    expect(chip).to_have_attribute("title", re.compile(r": 10\d missing"))
    stepramp.field("move.steps").fill("500")
    expect(chip).to_contain_text("× 1  + 1")
    chip.click()
    page.locator("#capture-remove").click()
    expect(page.locator("#capture-figures")).to_be_hidden()
    page.keyboard.press("Escape")
    expect(chip).to_be_hidden()
    until(lambda: not any(name.startswith("capture") for name in stepramp.curves()))


def test_a_capture_is_read_while_the_design_is_refused(stepramp: StepRampPage, module_watch: Watch) -> None:
    module_watch.expected = [REFUSED_VALUE]
    page = stepramp.page
    made = planned_us(stepramp)
    stepramp.field(ACCELERATION).fill("-5")
    expect(stepramp.field(ACCELERATION)).to_have_attribute("aria-invalid", "true")
    drop_file(page, "try.csv", saleae_csv(pulses(made, 5), NAMES[:1]))
    expect(figure(page, "Steps")).to_have_text("500")
    expect(page.locator("#capture-note")).to_contain_text("The design can’t be computed now. Correct what is marked")
    page.keyboard.press("Escape")
    stepramp.field(ACCELERATION).fill("5000")
    page.locator("#capture-chip").click()
    expect(figure(page, "Steps")).to_have_text("500; planned 500")
    page.locator("#capture-remove").click()
    page.keyboard.press("Escape")


def test_what_the_server_fails_at_is_told_and_not_asked_again(
    open_page: Callable[..., StepRampPage], watch: Watch
) -> None:
    asked = []

    def fail(route: Route) -> None:
        asked.append(route.request.url)
        route.fulfill(
            status=500, json={"errors": [{"field": None, "value": None, "allowed": None, "message": "It failed."}]}
        )

    watch.expected.append(r"status of 500")
    page = open_page().page
    page.route("**/api/v1/capture?**", fail)
    drop_file(page, "try.csv", saleae_csv(pulses([100, 200], 5), NAMES[:1]))
    expect(page.locator("#capture-problems")).to_contain_text("It failed.")
    page.wait_for_timeout(2_500)
    assert len(asked) == 1


def test_files_are_taken_for_what_they_are(stepramp: StepRampPage, module_watch: Watch, tmp_path: Path) -> None:
    module_watch.expected = [REFUSED_VALUE]
    page = stepramp.page
    drop_file(page, "notes.txt", "Buy a stepper.")
    expect(page.locator("#notice")).to_contain_text(
        "It is nothing that StepRamp reads. A design ends in .stepramp.json"
    )
    drop_file(page, "rows.csv", "step,delay\n10,5000\n30,1500\n")
    expect(page.locator("#paste-dialog")).to_be_visible()
    page.keyboard.press("Escape")
    drop_file(page, "broken.csv", "Time [s],Step\n0.1,0\n0.05,1\n0.2,0\n")
    expect(page.locator("#capture-problems")).to_contain_text(
        "Line 3 of the file has the time '0.05'; allowed: at least"
    )
    expect(page.locator("#capture-close")).to_have_text("Close")
    # As PulseView saves it: written by sigrok-cli itself, opened by the button that opens designs.
    made = pulses([each // 10 for each in planned_us(stepramp)], 2)
    session = tmp_path / "measured.sr"
    session.write_bytes(written_by_sigrok(sampled(made, 80_000), 100_000, "srzip", NAMES))
    page.keyboard.press("Escape")
    choose(page, "#head-open", session)
    expect(page.locator("#capture-file")).to_contain_text("session of sigrok")
    expect(figure(page, "Steps")).to_have_text("500; planned 500")
    expect(figure(page, "Missing")).to_have_text("none")
    page.locator("#capture-remove").click()
    page.keyboard.press("Escape")


def test_a_trace_is_saved_and_opened_as_a_capture(stepramp: StepRampPage, tmp_path: Path) -> None:
    page = stepramp.page
    stepramp.connect()
    stepramp.push()
    stepramp.move("500")
    until(lambda: stepramp.devices()[0]["position_steps"] == 500 and stepramp.devices()[0]["state"] == "ready")
    stepramp.device_section("trace")
    with page.expect_download() as download:
        page.locator("#trace-save").click()
    saved = tmp_path / download.value.suggested_filename
    assert saved.name == "trace.csv"
    download.value.save_as(saved)
    page.locator("#open-capture").click()
    choose(page, "#capture-open", saved)
    expect(figure(page, "Steps")).to_have_text("500; planned 500")
    expect(figure(page, "Largest deviation")).to_contain_text("0 µs")
    expect(figure(page, "Missing")).to_have_text("none")
