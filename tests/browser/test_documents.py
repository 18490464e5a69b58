"""Designs that leave the page and come back: files by button and by drop, links, the history, the head of the page."""

import base64
import json
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from browser.conftest import Watch
from browser.server import Server
from browser.stepramp_page import KEPT, SLEW_SPEED, StepRampPage, call, until
from designs import document
from stepramp.design import Design

NAME = "Drehteller µ ½ 軸"
SHARED = document(name=NAME, ramp__slew_speed_steps_per_s=1234)
MACHINE = {
    "schema": "stepramp-machine/1",
    "together": "line",
    "axes": [SHARED, document(name="Y"), document(name="Z"), document(name="A")],
}


@pytest.fixture
def stepramp(module_page: StepRampPage, server: Server) -> StepRampPage:
    del server  # it lets go of devices after each test
    module_page.start_over()
    return module_page


def link(text: str) -> str:
    """Return the fragment that carries a text, made by other means than the page's."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    packed = packer.compress(text.encode()) + packer.flush()
    return "#d=" + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def state(page: Page) -> dict[str, Any]:
    """Return what is in hand as the browser keeps it."""
    return page.evaluate(KEPT)["machine"]


def expect_shared(stepramp: StepRampPage) -> None:
    expect(stepramp.page.locator(".design-name")).to_have_value(NAME)
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,234")
    assert Design.checked(state(stepramp.page)["axes"][0]) == Design.checked(SHARED)


def choose_file(stepramp: StepRampPage, path: Path, button: str = "#head-open") -> None:
    with stepramp.page.expect_file_chooser() as chooser:
        stepramp.page.locator(button).click()
    chooser.value.set_files(path)


DRAG = """([kind, files]) => { const data = new DataTransfer();
    for (const [name, text] of files) data.items.add(new File([text], name));
    const at = kind === 'drop' ? document.querySelector('#table') : document.body;
    return at.dispatchEvent(new DragEvent(kind, {dataTransfer: data, bubbles: true, cancelable: true})); }"""


def drag(page: Page, kind: str, *files: tuple[str, str]) -> bool:
    """Return whether the browser would have done what it likes with what is dragged."""
    return bool(page.evaluate(DRAG, [kind, list(files)]))


# ---- files ----


def test_a_saved_file_opens_again(stepramp: StepRampPage, tmp_path: Path) -> None:
    page = stepramp.page
    page.locator(".design-name").fill(NAME)
    stepramp.edit_and_wait(SLEW_SPEED, "1234")
    saved = state(page)["axes"][0]
    with page.expect_download() as download:
        page.locator("#head-save").click()
    assert download.value.suggested_filename == f"{NAME}.stepramp.json"
    expect(page.locator("#notice")).to_contain_text(f"Saved as {NAME}.stepramp.json")
    file = tmp_path / download.value.suggested_filename
    download.value.save_as(file)
    text = file.read_text(encoding="utf-8")
    assert json.loads(text) == saved
    assert text == json.dumps(saved, indent=2, ensure_ascii=False) + "\n"
    Design.checked(json.loads(text))
    stepramp.choose_example("Gauge")
    choose_file(stepramp, file)
    expect(page.locator("#notice")).to_contain_text(f"Opened from “{file.name}”")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,234")
    assert [Design.checked(axis) for axis in state(page)["axes"]] == [Design.checked(saved)]


def test_what_a_file_took_the_place_of_comes_back(stepramp: StepRampPage, tmp_path: Path) -> None:
    page = stepramp.page
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    before = state(page)["axes"]
    (tmp_path / "one.json").write_text(json.dumps(SHARED), encoding="utf-8")
    choose_file(stepramp, tmp_path / "one.json")
    expect_shared(stepramp)
    page.keyboard.press("Control+z")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    assert state(page)["axes"] == before
    page.keyboard.press("Control+Shift+z")
    expect_shared(stepramp)


def test_a_machine_of_four_axes_comes_and_goes_as_one_file(stepramp: StepRampPage, tmp_path: Path) -> None:
    page = stepramp.page
    (tmp_path / "machine.json").write_text(json.dumps(MACHINE), encoding="utf-8")
    choose_file(stepramp, tmp_path / "machine.json")
    expect_shared(stepramp)
    assert state(page)["together"] == "line"
    assert [axis["name"] for axis in state(page)["axes"]] == [NAME, "Y", "Z", "A"]
    with page.expect_download() as download:
        page.keyboard.press("Control+s")
    assert download.value.suggested_filename == f"{NAME} + Y + Z + A.stepramp.json"
    saved = json.loads(Path(download.value.path()).read_text(encoding="utf-8"))
    assert saved["schema"] == "stepramp-machine/1"
    assert saved["together"] == "line"
    assert [Design.checked(axis) for axis in saved["axes"]] == [Design.checked(axis) for axis in MACHINE["axes"]]


WRONG_FILES = [
    (b'{"schema": "stepramp/3", "shape": "s-curve"}', "newer StepRamp"),
    (b"not a design at all", "it is not JSON"),
    (json.dumps(SHARED).encode()[:-20], "it is not JSON"),
    (b"\x89PNG\r\n\x1a\n\x00\xff", "This is no text"),
    (b"", "it is not JSON"),
    (b" " * 1_000_001, "The file has 1,000,001 bytes; a design has at most 1,000,000."),
    (json.dumps(SHARED | {"extra": 1}).encode(), "no field extra"),
    (json.dumps(MACHINE | {"axes": [SHARED] * 5}).encode(), "allowed: from 1 to 4 designs"),
]


def test_a_wrong_file_says_why_and_changes_nothing(stepramp: StepRampPage, tmp_path: Path) -> None:
    page = stepramp.page
    before = state(page)
    for number, (content, words) in enumerate(WRONG_FILES):
        file = tmp_path / f"wrong {number}.json"
        file.write_bytes(content)
        choose_file(stepramp, file)
        for place in ("#notice", ".summary-messages"):
            expect(page.locator(place)).to_contain_text(f"Nothing was opened from “{file.name}”.")
            expect(page.locator(place)).to_contain_text(words)
        assert state(page) == before
        assert drag(page, "drop", (file.name, "also wrong")) is False
        expect(page.locator("#notice")).to_contain_text("not JSON")
        assert state(page) == before
    assert page.evaluate("() => document.querySelector('#notice').classList.contains('failed')")
    stepramp.edit_and_wait(SLEW_SPEED, "900")
    expect(page.locator(".summary-messages")).to_be_hidden()


def test_a_file_dropped_on_the_page_is_opened_and_it_is_said_before(stepramp: StepRampPage) -> None:
    page = stepramp.page
    overlay = page.locator("#drop-overlay")
    assert drag(page, "dragover", ("design.json", "")) is False
    expect(overlay).to_be_visible()
    expect(overlay).to_contain_text("takes the place of “Lead-screw stage”; undo brings that back")
    page.evaluate("document.body.dispatchEvent(new DragEvent('dragleave', {bubbles: true}))")
    expect(overlay).to_be_hidden()
    drag(page, "dragover", ("design.json", ""))
    drag(page, "drop", ("design.json", json.dumps(SHARED)))
    expect(overlay).to_be_hidden()
    expect_shared(stepramp)


def test_two_files_at_once_are_one_too_many(stepramp: StepRampPage) -> None:
    before = state(stepramp.page)
    drag(stepramp.page, "drop", ("one.json", json.dumps(SHARED)), ("two.json", json.dumps(SHARED)))
    expect(stepramp.page.locator("#notice")).to_contain_text("2 files were dropped; drop one.")
    assert state(stepramp.page) == before


def test_text_that_is_dragged_is_left_alone(stepramp: StepRampPage) -> None:
    script = """() => { const data = new DataTransfer(); data.setData('text/plain', 'a word');
        return document.body.dispatchEvent(new DragEvent('dragover', {dataTransfer: data, cancelable: true})); }"""
    assert stepramp.page.evaluate(script) is True
    expect(stepramp.page.locator("#drop-overlay")).to_be_hidden()


@pytest.mark.parametrize(
    ("names", "file"),
    [
        (["Stage"], "Stage.stepramp.json"),
        (["X", "", "X", "Y"], "X + Y.stepramp.json"),
        ([""], "design.stepramp.json"),
        (["../../etc: a|b?"], "-..-etc- a-b-.stepramp.json"),
        (["\u202ecod.exe\n"], "-cod.exe-.stepramp.json"),
        (["..."], "design.stepramp.json"),
        (["軸" * 100], "軸" * 80 + ".stepramp.json"),
    ],
)
def test_a_files_name_comes_from_the_design(module_page: StepRampPage, names: list[str], file: str) -> None:
    assert call(module_page.page, "documents/files.js", "fileName", names) == file


# ---- links ----


@pytest.fixture
def clipboard(context: BrowserContext) -> Iterator[Callable[[Page], str]]:
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    yield lambda page: str(page.evaluate("navigator.clipboard.readText()"))
    context.clear_permissions()


def test_a_shared_link_opens_the_design_in_another_tab_and_the_server_never_sees_it(
    stepramp: StepRampPage,
    clipboard: Callable[[Page], str],
    open_page: Callable[..., StepRampPage],
    tmp_path: Path,
) -> None:
    page = stepramp.page
    (tmp_path / "machine.json").write_text(json.dumps(MACHINE), encoding="utf-8")
    choose_file(stepramp, tmp_path / "machine.json")
    expect_shared(stepramp)
    page.locator("#head-link").click()
    expect(page.locator("#notice")).to_contain_text("Link copied")
    shared = clipboard(page)
    assert shared.startswith(f"{stepramp.url}#d=")
    other = open_page()
    requests: list[str] = []
    other.page.on("request", lambda request: requests.append(f"{request.url} {request.headers}"))
    other.page.goto("about:blank")
    other.page.goto(shared)
    other.wait_for_plots()
    expect_shared(other)
    assert state(other.page)["together"] == "line"
    assert other.page.url == stepramp.url, "the address is clean again"
    assert len(requests) > 10
    assert [one for one in requests if "d=" in one.split()[0] or shared.split("#")[1] in one] == []


def test_a_link_opened_in_the_open_page_can_be_undone(stepramp: StepRampPage) -> None:
    page = stepramp.page
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    page.evaluate("(fragment) => { location.hash = fragment; }", link(json.dumps(SHARED)))
    expect_shared(stepramp)
    until(lambda: page.evaluate("location.hash") == "")
    page.keyboard.press("Control+z")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    page.locator("#examples").click()
    expect(page.locator("#menu-list")).to_contain_text("Back to your “Lead-screw stage”")
    page.keyboard.press("Escape")


@pytest.mark.parametrize(
    ("fragment", "words"),
    [
        (link('{"schema": "stepramp/3"}'), "newer StepRamp"),
        (link("nonsense"), "it is not JSON"),
        (link(json.dumps(SHARED))[:-30], "This link is damaged"),
        # Node takes what follows the end of the deflated part; browsers, whose users it matters to, don't.
        (link(json.dumps(SHARED)) + "AAAA", "This link is damaged"),
        ("#d=!!!", "This link is damaged"),
        ("#d=" + "A" * 100_001, "at most 100,000"),
    ],
)
def test_a_wrong_link_says_why_and_changes_nothing(stepramp: StepRampPage, fragment: str, words: str) -> None:
    page = stepramp.page
    before = state(page)
    page.evaluate("(fragment) => { location.hash = fragment; }", fragment)
    expect(page.locator(".summary-messages")).to_contain_text(words)
    expect(page.locator("#notice")).to_contain_text("Nothing was opened from the link.")
    assert state(page) == before
    until(lambda: page.evaluate("location.hash") == "")


def test_a_wrong_link_at_the_start_leaves_what_was_kept(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page()
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    stepramp.page.goto("about:blank")
    stepramp.page.goto(stepramp.url + link('{"schema": "stepramp/3"}'))
    stepramp.wait_for_plots()
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    expect(stepramp.page.locator(".summary-messages")).to_contain_text("newer StepRamp")


def test_where_the_page_may_not_copy_the_link_is_shown(stepramp: StepRampPage) -> None:
    page = stepramp.page
    script = """() => { navigator.clipboard.write = () => Promise.reject(new Error('no'));
        document.execCommand = () => false; }"""
    page.evaluate(script)
    page.locator("#head-link").click()
    field = page.locator("#share-link")
    expect(field).to_be_focused()
    assert field.input_value().startswith(f"{stepramp.url}#d=")
    assert page.evaluate("getSelection().toString() || document.activeElement.selectionEnd") != 0
    page.keyboard.press("Escape")
    expect(page.locator("#share-dialog")).to_be_hidden()
    expect(page.locator("#head-link")).to_be_focused()
    page.reload()
    stepramp.wait_for_plots()


# ---- the head of the page ----


def test_undo_and_redo_by_button(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page()
    undo, redo = stepramp.page.locator("#head-undo"), stepramp.page.locator("#head-redo")
    expect(undo).to_be_disabled()
    expect(redo).to_be_disabled()
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    expect(undo).to_be_enabled()
    undo.click()
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,000")
    expect(undo).to_be_disabled()
    expect(redo).to_be_focused()
    stepramp.page.keyboard.press("Enter")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    expect(redo).to_be_disabled()
    expect(undo).to_be_focused()


def test_the_list_of_keys_opens_by_question_mark_but_not_in_a_name(stepramp: StepRampPage) -> None:
    page = stepramp.page
    dialog = page.locator("#shortcuts")
    page.locator(".design-name").focus()
    page.keyboard.press("?")
    expect(dialog).to_be_hidden()
    page.keyboard.press("Backspace")
    page.locator("#head-keys").focus()
    page.keyboard.press("?")
    expect(dialog).to_be_visible()
    expect(dialog).to_contain_text("Stop every motor")
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
    expect(page.locator("#head-keys")).to_be_focused()


def test_documents_by_keyboard_alone(stepramp: StepRampPage, tmp_path: Path) -> None:
    page = stepramp.page
    (tmp_path / "one.json").write_text(json.dumps(SHARED), encoding="utf-8")
    stepramp.field(SLEW_SPEED).focus()
    with page.expect_file_chooser() as chooser:
        page.keyboard.press("Control+o")
    chooser.value.set_files(tmp_path / "one.json")
    expect_shared(stepramp)
    with page.expect_download() as download:
        page.keyboard.press("Control+s")
    assert json.loads(Path(download.value.path()).read_text(encoding="utf-8"))["name"] == NAME
    page.locator("#head-undo").focus()
    page.keyboard.press("Enter")
    expect(page.locator(".design-name")).to_have_value("Lead-screw stage")


def test_a_phone_reaches_everything_in_the_menu(open_page: Callable[..., StepRampPage], watch: Watch) -> None:
    stepramp = open_page((390, 844))
    page = stepramp.page
    stepramp.field(SLEW_SPEED).fill("777")
    page.locator("#head-undo").click()
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,000")

    def choose(item: str) -> None:
        page.get_by_role("button", name="Menu").click()
        page.locator("#menu-list").get_by_role("button", name=item).click()

    choose("Redo")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    with page.expect_download():
        choose("Save as a file")
    with page.expect_file_chooser():
        choose("Open a file")
    choose("Keyboard shortcuts")
    expect(page.locator("#shortcuts")).to_be_visible()
    page.keyboard.press("Escape")
    choose("Light or dark")
    expect(page.locator("html")).to_have_attribute("data-theme", "light")
    page.get_by_role("button", name="Menu").click()
    for item in ("Share a link", "Export", "Lead-screw stage", "Gauge"):
        # Behind the examples there may be designs of other tabs, of the same name.
        expect(page.locator("#menu-list").get_by_role("button", name=item).first).to_be_in_viewport()
    assert watch.errors == []
