"""axe-core on the page: nothing at all in any state, at any size, in any theme."""

import re
from collections.abc import Callable

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, drop_file, until
from capture.writers import pulses, saleae_csv

SIZES = {"wide": (1440, 900), "tablet": (1024, 768), "phone": (390, 844), "on its side": (844, 390)}
"""The tablet has all tabs and all buttons: from there each state is reached."""
THEMES = {"dark": ("wide", "phone"), "light": ("tablet",), "forced": ("tablet",)}
"""At which sizes each is looked at in every state. All but the colours is the same in all: the first shows it."""
ABOUT_COLOURS = ("color-contrast", "link-in-text-block")
RUN = """async ([part, only]) => {
    const rules = {'label-content-name-mismatch': {enabled: true}};
    const options = {resultTypes: ['violations'], ...(only.length ? {runOnly: only} : {rules})};
    const found = await axe.run(part, options);
    return found.violations.flatMap(({id, nodes}) =>
        nodes.map(({target, failureSummary}) => `${id} at ${target.join(' ')}: ${failureSummary}`));
}"""
"""One rule beyond those that axe-core runs by itself: who says what is written on a button is understood."""
WHOLE = "html"
DIALOGS = {"fit-table": "fit-dialog", "paste-table": "paste-dialog"}
"""Dialogs of the table by the button that opens them."""


class Inspection:
    """What axe-core finds in each state of a page, gathered over all of them."""

    def __init__(self, stepramp: StepRampPage, theme: str) -> None:
        self.page = stepramp.page
        self.sizes = THEMES[theme]
        self._only = () if theme == "dark" else ABOUT_COLOURS
        self._present = "tablet"
        self.findings: list[str] = []
        self.page.evaluate(Axe().axe_script)

    def inspect(self, state: str, part: str = WHOLE, *, is_everywhere: bool = False) -> None:
        """Take note of what is found at the theme's sizes or everywhere; a finding of several states is kept once.

        part: what the state shows that those before did not. The rest of the page is looked at with it once.
        """
        for size in SIZES if is_everywhere else self.sizes:
            self._resize(size)
            is_first = size == self.sizes[0] and not self._only
            for text in self.page.evaluate(RUN, [WHOLE if is_first else part, list(self._only)]):
                if not any(finding.endswith(text) for finding in self.findings):
                    self.findings.append(f"{state}, {size}: {text}")
        self._resize("tablet")

    def _resize(self, size: str) -> None:
        if size == self._present:
            return
        self._present = size
        self.page.set_viewport_size({"width": SIZES[size][0], "height": SIZES[size][1]})


@pytest.mark.parametrize("theme", THEMES)
def test_axe_finds_nothing(open_page: Callable[..., StepRampPage], watch: Watch, theme: str) -> None:
    watch.expected.append(REFUSED_VALUE)
    stepramp = open_page(SIZES["tablet"])
    page, seen = stepramp.page, Inspection(stepramp, theme)
    # Colours are judged as they come to be, not on their way.
    scheme = "light" if theme == "light" else "dark"
    forced = "active" if theme == "forced" else "none"
    page.emulate_media(color_scheme=scheme, forced_colors=forced, reduced_motion="reduce")
    for panel in ("parameters", "table", "device"):
        stepramp.show_panel(panel)
        part = WHOLE if panel == "parameters" else f"#{panel}"
        seen.inspect(f"idle, {panel}", part, is_everywhere=theme == "dark")
    inspect_export(stepramp, seen)
    inspect_capture(stepramp, seen)
    stepramp.show_panel("table")
    for button, dialog in DIALOGS.items():
        page.locator(f"#{button}").click()
        expect(page.locator(f"#{dialog}")).to_be_visible()
        seen.inspect(dialog, f"#{dialog}")
        page.locator(f"#{dialog}").get_by_label("Close").click()
    stepramp.connect()
    stepramp.push()
    seen.inspect("pushed", "#device")
    for section in ("move", "jog", "trace"):
        stepramp.device_section(section)
        seen.inspect(section, "#device")
    page.locator("#settings").click()
    expect(page.locator("#settings-dialog")).to_be_visible()
    page.locator("#input-D9-role").select_option("limit")
    seen.inspect("settings", "#settings-dialog")
    page.locator("#use-settings").click()
    page.locator("#surroundings summary").click()
    page.locator("#home").click()
    expect(page.locator("#home-0")).to_be_visible()
    seen.inspect("home", "#home-dialog")
    page.locator("#home-dialog").get_by_label("Close").click()
    seen.inspect("virtual switches", "#device")
    [device] = stepramp.devices()
    stepramp.ask(stepramp.url, "PUT", f"devices/{device['id']}/settings", {"inputs": []})
    stepramp.show_panel("parameters")
    inspect_motor(stepramp, seen)
    page.locator("body").press("?")
    expect(page.locator("#shortcuts")).to_be_visible()
    seen.inspect("shortcuts", "#shortcuts")
    page.keyboard.press("Escape")
    inspect_wrong_values(stepramp, seen)
    assert not seen.findings, "\n".join(seen.findings)


def inspect_motor(stepramp: StepRampPage, seen: Inspection) -> None:
    """Look at the motor's verdict and all of its numbers, and at the dialogs about it."""
    page = stepramp.page
    page.locator("#motor-presets").select_option("NEMA 17 · 17HS4401")
    page.locator("#mechanism").select_option("screw")
    expect(page.locator("#motor-verdict")).to_have_attribute("data-verdict", re.compile("safe|marginal|stalls"))
    for summary in page.locator(".motor-section summary").all():
        summary.click()
    page.locator("#stall-point").click()
    page.locator("#torque-curve").fill("a;b;c")
    expect(page.locator(".motor-curve .message")).to_be_visible()
    seen.inspect("motor, wrong numbers", "#parameters")
    page.locator("#torque-curve").fill("")
    page.locator("#stall-point").click()
    expect(page.locator(".motor-found")).to_have_class("motor-found")
    for name, shown in (("rotor", ".rotor-runs"), ("fastest", ".fastest-card"), ("map", ".stall-map .fill.safe")):
        page.locator(f"#open-{name}").click()
        dialog = page.locator(f"#{name}-dialog")
        expect(dialog.locator(shown).first).to_be_visible(timeout=60_000)
        seen.inspect(f"motor, {name}", f"#{name}-dialog")
        dialog.get_by_role("button", name="Close").last.click()
    page.locator("#motor-presets").select_option("")


def inspect_export(stepramp: StepRampPage, seen: Inspection) -> None:
    """Look at the menu and at the dialog that exports, with a text, a picture and a refusal."""
    page = stepramp.page
    page.locator("#examples").click()
    seen.inspect("menu", "#menu-list")
    page.keyboard.press("Escape")
    button = page.locator("#head-export")
    if button.is_visible():
        button.click()
    else:
        page.locator("#examples").click()
        page.locator("#menu-list button b", has_text="Export").click()
    dialog = page.locator("#export-dialog")
    for name in ("c_newton", "klipper", "png"):
        dialog.locator(f'label:has(input[value="{name}"])').click()
        until(lambda name=name: dialog.get_attribute("data-shown") == name, within_s=60)
        seen.inspect(f"export of {name}", "#export-dialog")
    dialog.locator('label:has(input[value="c_newton"])').click()
    page.locator("#export-name").fill("2 axes")
    expect(dialog.locator(".message")).to_be_visible()
    seen.inspect("export refused", "#export-dialog")
    dialog.get_by_label("Close").click()


def inspect_capture(stepramp: StepRampPage, seen: Inspection) -> None:
    """Look at the dialog of measured steps, with all that it can mark."""
    page = stepramp.page
    drop_file(page, "digital.csv", saleae_csv(pulses([100, 20_000, 20_001, 20_002], 1), ["Step", "Dir"]))
    page.locator("#capture-shortest").fill("2")
    page.locator("#capture-shortest").press("Enter")
    expect(page.locator("#capture-figures .short")).to_be_visible()
    seen.inspect("capture", "#capture-dialog")
    page.keyboard.press("Escape")


def inspect_wrong_values(stepramp: StepRampPage, seen: Inspection) -> None:
    """Look at the messages of a wrong row and of a wrong parameter."""
    stepramp.show_panel("table")
    stepramp.page.locator("#table-1-0").fill("2")
    seen.inspect("wrong row", "#table")
    stepramp.show_panel("parameters")
    stepramp.field(SLEW_SPEED).fill("fast")
    expect(stepramp.message(SLEW_SPEED)).to_be_visible()
    seen.inspect("wrong value", "#parameters")
