"""axe-core on the page: nothing serious in any state, at any size, in either theme."""

from collections.abc import Callable

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

SIZES = {"wide": (1440, 900), "tablet": (1024, 768), "phone": (390, 844)}
SEVERE = ("serious", "critical")
DIALOGS = {"fit-table": "fit-dialog", "paste-table": "paste-dialog"}
"""Dialogs of the table by the button that opens them."""


class Inspection:
    """What axe-core finds in each state of a page, gathered over all of them."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.findings: list[str] = []

    def inspect(self, state: str) -> None:
        """Take note of what is serious or critical; a finding of several states is kept once."""
        for violation in Axe().run(self.page).response["violations"]:
            if violation["impact"] not in SEVERE:
                continue
            for node in violation["nodes"]:
                text = f"{violation['id']} at {' '.join(map(str, node['target']))}: {node['failureSummary']}"
                if not any(finding.endswith(text) for finding in self.findings):
                    self.findings.append(f"{state}: {text}")


@pytest.fixture(params=SIZES)
def size(request: pytest.FixtureRequest) -> tuple[int, int]:
    return SIZES[request.param]


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_axe_finds_nothing_serious(
    open_page: Callable[..., StepRampPage], watch: Watch, size: tuple[int, int], theme: str
) -> None:
    watch.expected.append(REFUSED_VALUE)
    stepramp = open_page(size, theme)
    page, seen = stepramp.page, Inspection(stepramp.page)
    # Colours are judged as they come to be, not on their way.
    page.emulate_media(color_scheme=theme, reduced_motion="reduce")
    for panel in ("parameters", "table", "device"):
        stepramp.show_panel(panel)
        seen.inspect(f"idle, {panel}")
    inspect_export(stepramp, seen)
    stepramp.show_panel("table")
    for button, dialog in DIALOGS.items():
        page.locator(f"#{button}").click()
        expect(page.locator(f"#{dialog}")).to_be_visible()
        seen.inspect(dialog)
        page.locator(f"#{dialog}").get_by_label("Close").click()
    stepramp.connect()
    seen.inspect("connected")
    page.locator("#settings").click()
    seen.inspect("settings")
    page.locator("#settings-dialog").get_by_label("Close").click()
    page.locator("body").press("?")
    expect(page.locator("#shortcuts")).to_be_visible()
    seen.inspect("shortcuts")
    page.keyboard.press("Escape")
    inspect_wrong_values(stepramp, seen)
    assert seen.findings == []


def inspect_export(stepramp: StepRampPage, seen: Inspection) -> None:
    """Look at the menu and at the dialog that exports, with a text, a picture and a refusal."""
    page = stepramp.page
    page.locator("#examples").click()
    seen.inspect("menu")
    page.keyboard.press("Escape")
    button = page.locator("#head-export")
    if button.is_visible():
        button.click()
    else:
        page.locator("#examples").click()
        page.locator("#menu-list button b", has_text="Export").click()
    dialog = page.locator("#export-dialog")
    for name in ("c_newton", "png"):
        dialog.locator(f'label:has(input[value="{name}"])').click()
        until(lambda name=name: dialog.get_attribute("data-shown") == name)
        seen.inspect(f"export of {name}")
    dialog.locator('label:has(input[value="c_newton"])').click()
    page.locator("#export-name").fill("2 axes")
    expect(dialog.locator(".message")).to_be_visible()
    seen.inspect("export refused")
    dialog.get_by_label("Close").click()


def inspect_wrong_values(stepramp: StepRampPage, seen: Inspection) -> None:
    """Look at the messages of a wrong row and of a wrong parameter."""
    stepramp.show_panel("table")
    stepramp.page.locator("#table-1-0").fill("2")
    seen.inspect("wrong row")
    stepramp.show_panel("parameters")
    stepramp.field(SLEW_SPEED).fill("fast")
    expect(stepramp.message(SLEW_SPEED)).to_be_visible()
    seen.inspect("wrong value")
