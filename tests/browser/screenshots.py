"""Pictures of the page for the documentation and for looking at.  usage: python tests/browser/screenshots.py FOLDER.

Each size in both themes and in forced colours: at rest, with wrong values, and while a move runs. Those named
screenshot are in docs/.
"""

import sys
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

# As a script it finds only its own folder; the tests find it beside theirs.
sys.path.insert(0, str(Path(__file__).parents[1]))

from browser.server import CHROMIUM, CHROMIUM_ARGUMENTS, Server
from browser.stepramp_page import SLEW_SPEED, StepRampPage

SIZES = {
    "wide": (1440, 900),
    "tablet": (1024, 768),
    "phone": (390, 844),
    "phone-on-its-side": (844, 390),
    "magnified": (720, 450),
    "magnified-more": (640, 360),
    "narrow": (320, 568),
}
THEMES = ("dark", "light", "forced")
SETTLE_MS = 300


def main(folder: Path) -> None:
    """Take all pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    with Server() as server, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGUMENTS)
        for theme in THEMES:
            for size in SIZES:
                take_all(opened(browser, server, size, theme), folder, f"{size}-{theme}")
                StepRampPage.release_devices(server.url)
        take_device(opened(browser, server, "wide", "dark"), folder)
        StepRampPage.release_devices(server.url)
        take_comparison(opened(browser, server, "wide", "light"), folder)
        browser.close()


def opened(browser: Browser, server: Server, size: str, theme: str) -> StepRampPage:
    """Open the page in a fresh browser."""
    width, height = SIZES[size]
    scale = 2 if size == "phone" else 1
    context = browser.new_context(
        viewport={"width": width, "height": height},
        color_scheme="light" if theme == "light" else "dark",
        forced_colors="active" if theme == "forced" else "none",
        device_scale_factor=scale,
    )
    return StepRampPage(context.new_page(), server.url).open()


def shoot(page: Page, folder: Path, name: str) -> None:
    """Take one picture once all is drawn."""
    page.wait_for_timeout(SETTLE_MS)
    page.screenshot(path=folder / f"{name}.png")
    print(folder / f"{name}.png")


def take_all(stepramp: StepRampPage, folder: Path, name: str) -> None:
    """Take every state of the page at one size in one theme."""
    page = stepramp.page
    for panel in ("parameters", "table", "device"):
        stepramp.show_panel(panel)
        shoot(page, folder, f"{name}-{panel}")
    stepramp.connect()
    stepramp.push()
    stepramp.move("1600")
    page.wait_for_timeout(600)
    shoot(page, folder, f"{name}-moving")
    page.keyboard.press("Escape")
    stepramp.show_panel("table")
    page.locator("#table-1-0").fill("2")
    shoot(page, folder, f"{name}-wrong-row")
    stepramp.show_panel("parameters")
    stepramp.field(SLEW_SPEED).fill("fast")
    stepramp.field("timer.counter_bits").fill("2.5")
    shoot(page, folder, f"{name}-wrong-values")
    page.locator("#examples").click()
    shoot(page, folder, f"{name}-examples")


def take_device(stepramp: StepRampPage, folder: Path) -> None:
    """Take the first picture of the docs: the lead-screw stage with its motor, pushed to the virtual controller."""
    stepramp.choose_example("Lead-screw stage")
    stepramp.page.locator("#motor-presets").select_option("NEMA 17 · 17HS4401")
    stepramp.page.locator("#mechanism").select_option("screw")
    stepramp.connect()
    stepramp.push()
    stepramp.field(SLEW_SPEED).focus()
    # The ramp, and beneath it the verdict.
    stepramp.page.locator('.group[aria-label="Ramp"]').evaluate("(group) => group.scrollIntoView()")
    stepramp.page.locator(".scope").hover(position={"x": 460, "y": 300})
    shoot(stepramp.page, folder, "screenshot")


def take_comparison(stepramp: StepRampPage, folder: Path) -> None:
    """Take the second: a formula's start, where its error comes from, the design before, and the trace of a move."""
    page = stepramp.page
    stepramp.choose_example("Lead-screw stage")
    page.locator("#method").select_option("first_order")
    stepramp.connect()
    stepramp.push()
    stepramp.move("500")
    stepramp.device_section("trace")
    page.locator("#trace-figures dd").first.wait_for()
    page.locator("#keep").click()
    stepramp.field("ramp.acceleration_steps_per_s2").fill("8000")
    page.locator('#view-choice [data-value="start"]').click()
    page.get_by_role("button", name="Parts").click()
    page.locator(".scope").hover(position={"x": 300, "y": 300})
    shoot(page, folder, "screenshot-light")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
