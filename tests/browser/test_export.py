"""The export dialog: every format with its preview, copy, download, refusals; by keyboard alone."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Locator, Page, expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import FOLDER, REFUSED_VALUE, SLEW_SPEED, StepRampPage, call, until
from stepramp.exports.export import FORMAT_NAMES

PHONE = (390, 844)
PICTURES = ("svg", "png")
REPORTS = ("report_pdf", "report_html")
"""Made by a route of their own."""


class ExportDialog:
    """The dialog as a person uses it."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.element = page.locator("#export-dialog")
        self.preview = page.locator("#export-preview")
        self.note = page.locator(".export-note")
        self.copy = page.locator("#export-copy")
        self.download = page.locator("#export-download")

    def format(self, name: str) -> Locator:
        return self.element.locator(f'input[value="{name}"]')

    def choose(self, name: str) -> None:
        self.element.locator(f'label:has(input[value="{name}"])').click()
        self.wait_for(name)

    def wait_for(self, name: str) -> None:
        until(lambda: self.element.get_attribute("data-shown") == name)

    def save(self, folder: Path) -> Path:
        with self.page.expect_download() as download:
            self.download.click()
        saved = folder / download.value.suggested_filename
        download.value.save_as(saved)
        return saved


@pytest.fixture
def watch(shared_watch: Watch) -> Watch:
    return shared_watch


@pytest.fixture
def dialog(shared_page: StepRampPage) -> Iterator[ExportDialog]:
    """Open the dialog of the module's page at its first format."""
    shared_page.page.locator("#head-export").click()
    opened = ExportDialog(shared_page.page)
    opened.choose("c_segments")
    yield opened
    if opened.element.is_visible():
        shared_page.page.keyboard.press("Escape")
        expect(opened.element).to_be_hidden()


@pytest.fixture
def own_dialog(stepramp: StepRampPage) -> ExportDialog:
    """Open that of a page of the test's own: it is not as it was afterwards."""
    stepramp.page.locator("#head-export").click()
    opened = ExportDialog(stepramp.page)
    opened.wait_for("c_segments")
    return opened


def test_the_page_offers_every_format_of_the_server(module_page: StepRampPage) -> None:
    script = f"async () => (await import({FOLDER} + 'documents/exports.js')).EXPORT_FORMATS.map(({{name}}) => name)"
    assert sorted(module_page.page.evaluate(script)) == sorted((*FORMAT_NAMES, *REPORTS))


def test_a_long_text_is_shown_in_part(module_page: StepRampPage) -> None:
    page = module_page.page
    for text, lines in (("a\nb\nc\n", 3), ("a\nb\n", 2)):
        beginning = call(page, "documents/exports.js", "beginning", text, 2)
        assert beginning == {"shown": "a\nb", "lines": lines, "shownLines": 2}
    shown = [call(page, "documents/exports.js", "formatBytes", size) for size in (999, 1000, 1_234_567)]
    assert shown == ["999 bytes", "1.0 kB", "1.2 MB"]


def test_every_format_is_previewed_and_saved(dialog: ExportDialog, tmp_path: Path) -> None:
    for name in FORMAT_NAMES:
        dialog.choose(name)
        saved = dialog.save(tmp_path)
        expect(dialog.note).to_contain_text(saved.name)
        assert saved.stat().st_size > 300
        if name in PICTURES:
            width = dialog.preview.locator("img").evaluate("(image) => image.decode().then(() => image.naturalWidth)")
            assert width > 500
        elif name != "html":
            text = saved.read_text(encoding="utf-8")
            assert dialog.preview.inner_text().splitlines()[:100] == text.splitlines()[:100]
        expect(dialog.copy).to_be_enabled(enabled=name not in (*PICTURES, "html"))
    dialog.choose("csv")
    expect(dialog.preview.locator("pre")).to_contain_text("step,interval_ticks,interval_us")
    # The last of the list, too, moves nothing but the list.
    dialog.choose("png")
    assert dialog.element.evaluate("(one) => [one.scrollTop, one.scrollHeight - one.clientHeight]") == [0, 0]


def test_a_copy_goes_to_the_clipboard(dialog: ExportDialog, context: BrowserContext) -> None:
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    dialog.choose("json")
    dialog.copy.click()
    expect(dialog.note).to_contain_text("Copied")
    copied = json.loads(dialog.page.evaluate("navigator.clipboard.readText()"))
    assert copied["ramp"]["slew_speed_steps_per_s"] == 1000
    context.clear_permissions()


def test_options_change_the_file(own_dialog: ExportDialog) -> None:
    own_dialog.choose("c_newton")
    own_dialog.page.locator("#export-name").fill("x_axis")
    own_dialog.element.get_by_label("Computes in").select_option("fixed")
    expect(own_dialog.preview).to_contain_text("in fixed.")
    expect(own_dialog.preview).to_contain_text("static inline x_axis_ticks x_axis_next(")
    own_dialog.choose("c_segments")
    expect(own_dialog.element.get_by_label("Computes in")).to_be_hidden()
    own_dialog.page.locator("#export-bound").fill("9")
    expect(own_dialog.preview).to_contain_text("9 ticks from what is planned")


def test_what_a_machine_loses_is_shown_beside_what_it_is_given(own_dialog: ExportDialog, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    remarks = own_dialog.page.locator("#export-remarks")
    expect(remarks).to_be_hidden()
    own_dialog.choose("marlin")
    for lost in (
        "Base speed 0 steps/s is not kept: Marlin starts and ends at 120 steps/s.",
        "The method Exact is not kept: Marlin works its intervals out itself.",
    ):
        expect(remarks.locator("li").filter(has_text=lost)).to_have_count(1)
    own_dialog.element.get_by_label("Axis of the machine").select_option("Z")
    expect(own_dialog.preview).to_contain_text("M203 Z")
    own_dialog.choose("klipper")
    expect(own_dialog.preview).to_contain_text("max_z_velocity")
    own_dialog.choose("tic")
    expect(own_dialog.element.get_by_label("Axis of the machine")).to_be_hidden()
    own_dialog.choose("csv")
    expect(remarks).to_be_hidden()
    # What it can't take is called what the page calls it.
    own_dialog.choose("teensystep")
    set_to = "(field) => { field.value = '0.5'; field.dispatchEvent(new Event('input')); }"
    StepRampPage(own_dialog.page, own_dialog.page.url).field(SLEW_SPEED).evaluate(set_to)
    expect(own_dialog.preview.locator(".message")).to_contain_text(
        "Slew speed is 0.5; allowed: a number from 1 to 65,535"
    )
    expect(remarks).to_be_hidden()


def test_what_a_machine_loses_is_told_in_the_units_that_are_shown(shared_page: StepRampPage) -> None:
    lost = shared_page.page.locator("#export-remarks li", has_text="Base speed")
    text = "Base speed {start} is not kept: Marlin starts and ends at {own}."
    for unit, start, own in (("mm", "0 mm/s", "2.4 mm/s"), ("steps", "0 steps/s", "120 steps/s")):
        shared_page.page.locator(f'#length-unit [data-value="{unit}"]').click()
        shared_page.page.locator("#head-export").click()
        dialog = ExportDialog(shared_page.page)
        dialog.choose("marlin")
        expect(lost).to_have_text(text.format(start=start, own=own))
        expect(dialog.preview).to_contain_text("120 steps/s")
        shared_page.page.keyboard.press("Escape")
        expect(dialog.element).to_be_hidden()


def test_refusals_are_shown_and_what_is_right_again_is_exported(own_dialog: ExportDialog, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    own_dialog.choose("c_newton")
    own_dialog.page.locator("#export-name").fill("2 axes")
    expect(own_dialog.preview.locator(".message")).to_contain_text("name is '2 axes'; allowed: a letter, then letters")
    expect(own_dialog.download).to_be_disabled()
    expect(own_dialog.copy).to_be_disabled()
    own_dialog.page.locator("#export-name").fill("axis_2")
    expect(own_dialog.download).to_be_enabled()


def test_a_preview_that_is_not_shown_any_more_is_let_go_of(own_dialog: ExportDialog) -> None:
    """The browser keeps a picture for as long as it has an address."""
    kept = "() => [...globalThis.kept]"
    own_dialog.page.evaluate("""() => { const kept = globalThis.kept = new Set();
        const {createObjectURL, revokeObjectURL} = URL;
        URL.createObjectURL = (file) => { const url = createObjectURL.call(URL, file); kept.add(url); return url; };
        URL.revokeObjectURL = (url) => { kept.delete(url); revokeObjectURL.call(URL, url); }; }""")
    for name in PICTURES:
        own_dialog.choose(name)
        assert own_dialog.page.evaluate(kept) == [own_dialog.preview.locator("img").get_attribute("src")]
    own_dialog.choose("csv")
    assert own_dialog.page.evaluate(kept) == []
    own_dialog.choose("svg")
    own_dialog.page.keyboard.press("Escape")
    expect(own_dialog.element).to_be_hidden()
    until(lambda: own_dialog.page.evaluate(kept) == [])


def test_it_works_by_keyboard_alone(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#head-export").focus()
    page.keyboard.press("Enter")
    dialog = ExportDialog(page)
    expect(dialog.format("c_segments")).to_be_focused()
    page.keyboard.press("ArrowDown")
    dialog.wait_for("c_ramp_image")
    for _ in range(8):
        page.keyboard.press("Tab")
        if dialog.download.evaluate("(button) => button === document.activeElement"):
            break
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    assert download.value.suggested_filename.endswith("_ramp_image.h")
    page.keyboard.press("Escape")
    expect(dialog.element).to_be_hidden()
    expect(page.locator("#head-export")).to_be_focused()


def test_the_export_follows_the_design(dialog: ExportDialog, shared_page: StepRampPage) -> None:
    dialog.choose("json")
    shared_page.field(SLEW_SPEED).evaluate(
        "(field) => { field.value = '900'; field.dispatchEvent(new Event('input')); }"
    )
    expect(dialog.preview).to_contain_text('"slew_speed_steps_per_s": 900')


def test_a_server_that_is_gone_is_told(own_dialog: ExportDialog, watch: Watch) -> None:
    watch.expected.append("ERR_FAILED")
    own_dialog.page.route("**/api/v1/export/*", lambda route: route.abort())
    own_dialog.choose("csv")
    expect(own_dialog.preview.locator(".message")).to_contain_text("The server does not answer")
    expect(own_dialog.download).to_be_disabled()


def test_stop_stays_in_reach_and_the_dialog_fits_a_phone(open_page: Callable[..., StepRampPage]) -> None:
    page = open_page(PHONE).page
    page.locator("#examples").click()
    page.locator("#menu-list button b", has_text="Export").click()
    dialog = ExportDialog(page)
    dialog.wait_for("c_segments")
    page.locator("#stop").click(trial=True)
    for button in (dialog.download, dialog.copy, dialog.format("png")):
        button.scroll_into_view_if_needed()
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]


def test_escape_closes_it_after_a_stop_too(dialog: ExportDialog) -> None:
    dialog.page.locator("#stop").click()
    dialog.page.keyboard.press("Escape")
    expect(dialog.element).to_be_hidden()


def test_a_saved_page_of_plots_opens_without_a_server(
    dialog: ExportDialog, browser: Browser, server: Server, tmp_path: Path
) -> None:
    dialog.choose("html")
    saved = dialog.save(tmp_path)
    page = browser.new_page()
    watch = Watch(server.url)
    watch.follow(page)
    page.goto(saved.as_uri())
    page.locator("#plots .scatterlayer path.js-line").first.wait_for()
    assert page.locator("#plots .subplot").count() == 3
    expect(page.locator("h1")).to_have_text("Lead-screw stage")
    page.close()
    assert watch.errors == []
    assert [url for url in watch.elsewhere if url != saved.as_uri()] == []
