"""axe-core on the page: nothing at all in any state, at any size, in any theme."""

import re
from collections.abc import Callable
from typing import Literal

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, drop_file, until
from capture.writers import pulses, saleae_csv

SIZES = {"wide": (1440, 900), "tablet": (1024, 768), "phone": (390, 844), "on its side": (844, 390)}
"""The tablet has all tabs and all buttons: from there each state is reached."""
THEMES: dict[str, tuple[Literal["light", "dark"], Literal["active", "none"]]] = {
    "dark": ("dark", "none"),
    "light": ("light", "none"),
    "forced": ("light", "active"),
}
"""Colour scheme and forced colours. All but the colours is the same in all of them, and colours know no sizes."""
ABOUT_COLOURS = ("color-contrast", "link-in-text-block")
PANELS = ("#parameters", "#table", "#device")
RUN = """async ([part, only, without]) => {
    const off = Object.fromEntries(without.map((rule) => [rule, {enabled: false}]));
    const rules = {'label-content-name-mismatch': {enabled: true}, ...off};
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

    def __init__(self, stepramp: StepRampPage) -> None:
        self.page = stepramp.page
        self._size, self._theme = "tablet", "dark"
        self.findings: list[str] = []
        self.page.evaluate(Axe().axe_script)
        # Colours are judged as they come to be, not on their way.
        self.page.emulate_media(color_scheme="dark", forced_colors="none", reduced_motion="reduce")

    def inspect(self, state: str, part: str = WHOLE, *, is_everywhere: bool = False) -> None:
        """Take note of what is found on a desktop and a phone, or at each size, and in each theme.

        part: what the state shows that those before did not. The rest of the page is looked at with it once; its
        colours too, unless the part lies over it and leaves it as it was.
        """
        self._look("wide", "dark")
        if part in (WHOLE, *PANELS):
            self._note(f"{state}, wide", WHOLE)
        else:
            self._note(f"{state}, wide", WHOLE, without=ABOUT_COLOURS)
            self._note(f"{state}, wide", part, only=ABOUT_COLOURS)
        self._look("phone", "light")
        self._note(f"{state}, phone, light", part)
        if is_everywhere:
            self._look("on its side", "light")
            self._note(f"{state}, on its side", part)
            self._look("tablet", "light")
            self._note(f"{state}, tablet", part)
        self._look("tablet", "forced")
        self._note(f"{state}, forced colours", part, only=ABOUT_COLOURS)
        self._look("tablet", "dark")

    def _note(self, where: str, part: str, only: tuple[str, ...] = (), without: tuple[str, ...] = ()) -> None:
        """Take note of what is found; a finding of several states is kept once."""
        for text in self.page.evaluate(RUN, [part, list(only), list(without)]):
            if not any(finding.endswith(text) for finding in self.findings):
                self.findings.append(f"{where}: {text}")

    def _look(self, size: str, theme: str) -> None:
        if size != self._size:
            self.page.set_viewport_size({"width": SIZES[size][0], "height": SIZES[size][1]})
        if theme != self._theme:
            scheme, forced = THEMES[theme]
            self.page.emulate_media(color_scheme=scheme, forced_colors=forced)
            expect(self.page.locator("html")).to_have_attribute("data-theme", scheme)
        self._size, self._theme = size, theme


def test_axe_finds_nothing(open_page: Callable[..., StepRampPage], watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    stepramp = open_page(SIZES["tablet"])
    page, seen = stepramp.page, Inspection(stepramp)
    for panel in ("parameters", "table", "device"):
        stepramp.show_panel(panel)
        seen.inspect(f"idle, {panel}", WHOLE if panel == "parameters" else f"#{panel}", is_everywhere=True)
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
