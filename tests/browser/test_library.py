"""The library's dialog, the whole way on one page: saved, found, compared, pinned, opened, and two editors."""

import json
import re
import urllib.request
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, Route, expect

from browser.conftest import Watch
from browser.stepramp_page import SLEW_SPEED, StepRampPage, until

AXE = """async (part) => (await axe.run(part, {resultTypes: ['violations']})).violations
    .flatMap(({id, nodes}) => nodes.map(({target, failureSummary}) => `${id} at ${target}: ${failureSummary}`))"""


class Library:
    """The dialog, on one page for all tests of this module."""

    def __init__(self, stepramp: StepRampPage) -> None:
        self.stepramp = stepramp
        self.page: Page = stepramp.page
        self.note = self.page.locator("#library-note")

    def open(self) -> None:
        self.page.locator("#examples").click()
        self.page.get_by_role("button", name="Library …").click()

    def close(self) -> None:
        self.page.locator("#library-dialog [aria-label=Close]").click()

    def begin_saving(self, **fields: str) -> None:
        self.page.locator("#library-save-design").click()
        for name, text in fields.items():
            self.page.locator(f"#library-save-{name}").fill(text)

    def save(self, **fields: str) -> None:
        self.begin_saving(**fields)
        self.page.locator("#library-save").click()

    def design(self, name: str) -> dict[str, Any]:
        [found] = self.stepramp.ask(self.stepramp.url, "POST", "library/search", {"text": name})["designs"]
        return dict(found)

    def newest(self, name: str) -> dict[str, Any]:
        """Return the design of the newest revision."""
        kept = self.design(name)
        route = f"library/designs/{kept['id']}/revisions/{kept['revisions']}"
        return dict(self.stepramp.ask(self.stepramp.url, "GET", route)["design"])

    def save_elsewhere(self, name: str, note: str) -> None:
        """Save a longer move as somebody else does."""
        kept = self.design(name)
        route = f"{self.stepramp.url}api/v1/library/designs/{kept['id']}/revisions"
        longer = self.newest(name)
        longer["move"]["steps"] += 1
        content = json.dumps({"design": longer, "note": note}).encode()
        headers = {"Content-Type": "application/json", "If-Match": f'"{kept["version"]}"'}
        urllib.request.urlopen(urllib.request.Request(route, content, headers, method="POST"), timeout=60).close()

    def inspect(self) -> None:
        """Have axe look at the dialog, dark and light."""
        if not self.page.evaluate("'axe' in window"):
            self.page.evaluate(Axe().axe_script)
        for theme in ("light", "dark"):
            self.page.emulate_media(color_scheme=theme, reduced_motion="reduce")
            assert self.page.evaluate(AXE, "#library-dialog") == []


@pytest.fixture(scope="module")
def library(module_page: StepRampPage) -> Library:
    made = Library(module_page)
    module_page.page.evaluate("localStorage.removeItem('stepramp.theme')")
    return made


def test_a_design_is_saved_found_compared_pinned_and_opened_again(library: Library) -> None:
    page, stepramp = library.page, library.stepramp
    library.open()
    expect(page.locator("#library-search")).to_be_focused()
    library.begin_saving(name="Panel stage", tags="panel, quiet", notes="As built.", note="first")
    library.inspect()
    page.locator("#library-save").click()
    expect(library.note).to_have_text("Saved as “Panel stage”, revision 1.")
    first = stepramp.field(SLEW_SPEED).input_value()
    library.close()
    stepramp.edit_and_wait(SLEW_SPEED, "1234")
    library.open()
    expect(page.locator("#library-present")).to_contain_text("changed since revision 1 of “Panel stage”")
    library.save(note="faster")
    expect(library.note).to_have_text("Saved as revision 2 of “Panel stage”.")
    expect(page.locator("#library-differences tbody tr")).to_have_text([f"Slew speed{first} steps/s1,234 steps/s"])
    library.inspect()

    page.get_by_role("button", name="Pin both").click()
    page.locator("#library-search").fill("panel quiet nothing")
    expect(page.locator("#library-count")).to_have_text("No design has all these words and tags.")
    page.locator("#library-search").fill("PANEL quiet")
    expect(page.locator(".library-design b")).to_have_text(["Panel stage"])
    page.get_by_role("button", name="Open revision 1").click()
    expect(library.note).to_contain_text("revision 1, is in hand now")
    assert stepramp.field(SLEW_SPEED).input_value() == first
    library.close()
    until(lambda: {"beside-0-velocity", "beside-1-velocity"} <= stepramp.curves().keys())
    chips = page.locator(".chip.beside")
    expect(chips).to_have_count(2)
    chips.first.get_by_role("button").click()
    expect(chips).to_have_text(["Panel stage, revision 2"])
    chips.first.get_by_role("button").click()
    page.locator("#head-undo").click()
    assert stepramp.field(SLEW_SPEED).input_value() == "1,234"
    library.open()
    expect(page.locator("#library-present")).to_contain_text("revision 2")
    library.close()


def test_two_editors_are_told_of_each_other_and_nothing_is_overwritten(library: Library, module_watch: Watch) -> None:
    module_watch.expected.append("412")
    page, stepramp = library.page, library.stepramp
    library.save_elsewhere("Panel stage", "from the bench")
    library.open()
    library.save(note="mine")
    conflict = page.locator("#library-conflict")
    expect(conflict).to_contain_text("Somebody else has saved revision 3 of “Panel stage” meanwhile")
    expect(conflict).to_contain_text("from the bench")
    library.inspect()
    conflict.get_by_role("button", name="Open theirs beside mine").click()
    expect(library.note).to_contain_text("Theirs is another axis now")
    until(lambda: len(stepramp.kept()["machine"]["axes"]) == 2)
    mine, theirs = (axis["move"]["steps"] for axis in stepramp.kept()["machine"]["axes"])
    assert theirs == mine + 1
    conflict.get_by_role("button", name="Save mine as revision 4").click()
    expect(library.note).to_have_text("Saved as revision 4 of “Panel stage”.")
    assert library.newest("Panel stage")["move"]["steps"] == mine
    page.locator("#head-undo").click()
    expect(page.locator(".library-rows").first.locator("li .library-said")).to_have_text(
        ["mine", "from the bench", "faster", "first"]
    )
    # What is typed stays while something else is looked at.
    page.locator("#library-edit").click()
    page.locator("#library-edit-notes").fill("typed, not saved")
    page.locator("#library-save-design").click()
    page.locator("#library-save-note").fill("not saved yet")
    page.locator(".library-list button", has_text="Panel stage").first.click()
    expect(page.locator("#library-edit-notes")).to_have_value("typed, not saved")
    page.locator("#library-save-design").click()
    expect(page.locator("#library-save-note")).to_have_value("not saved yet")
    page.locator(".library-list button", has_text="Panel stage").first.click()
    # Another name, beside what somebody else writes meanwhile.
    library.save_elsewhere("Panel stage", "again")
    page.locator("#library-edit-name").fill("Panel stage 2")
    page.locator("#library-describe").click()
    expect(page.locator(".library-form .message")).to_contain_text("Somebody else has changed it meanwhile")
    page.locator("#library-describe").click()
    expect(page.locator("#library-name")).to_have_text("Panel stage 2")
    page.get_by_role("button", name="Duplicate").last.click()
    expect(page.locator("#library-name")).to_have_text("Panel stage 2 copy")
    library.close()


def test_a_save_whose_answer_was_lost_is_no_other_s(library: Library, module_watch: Watch) -> None:
    module_watch.expected += ["412", "Failed to load resource"]
    page, stepramp = library.page, library.stepramp
    library.open()
    library.begin_saving()
    page.locator('#library-saving [data-value="new"]').click()
    page.locator("#library-save-name").fill("Lost answer")
    page.locator("#library-save").click()
    expect(library.note).to_have_text("Saved as “Lost answer”, revision 1.")
    library.close()
    stepramp.edit_and_wait(SLEW_SPEED, "876")
    library.open()

    def lose(route: Route) -> None:
        route.fetch()
        route.abort()

    page.route("**/revisions", lose, times=1)
    library.save(note="once")
    expect(page.locator("#library-trouble")).to_be_visible()
    page.locator("#library-save").click()
    expect(library.note).to_have_text("Saved as revision 2 of “Lost answer”.")
    library.close()


def test_all_goes_out_as_a_file_and_a_file_comes_back(library: Library) -> None:
    page = library.page
    library.open()
    with page.expect_download() as saved:
        page.locator("#library-export").click()
    with page.expect_file_chooser() as chooser:
        page.locator("#library-import").click()
    content = saved.value.path().read_bytes()
    chooser.value.set_files({"name": "library.jsonl", "mimeType": "application/jsonl", "buffer": content})
    expect(library.note).to_contain_text("Nothing was added. There already:")
    page.locator('#library-dialog [data-value="pushes"]').click()
    expect(page.locator("#library-pushes")).to_contain_text(re.compile("Nothing was pushed yet|Pushes"))
    library.inspect()
    page.locator('#library-dialog [data-value="designs"]').click()
    library.close()


def test_without_the_library_the_page_goes_on(library: Library, module_watch: Watch) -> None:
    module_watch.expected.append("503")
    page, stepramp = library.page, library.stepramp
    reason = "The library can’t be used: the disk is full."

    def refuse(route: Route) -> None:
        route.fulfill(status=503, json={"errors": [{"field": None, "value": None, "allowed": None, "message": reason}]})

    page.route("**/api/v1/library/**", refuse)
    library.open()
    expect(page.locator("#library-trouble")).to_contain_text(f"{reason} The page goes on without the library")
    library.inspect()
    stepramp.edit_and_wait(SLEW_SPEED, "1111")
    page.unroute("**/api/v1/library/**")
    page.locator("#library-again").click()
    expect(page.locator("#library-trouble")).to_be_hidden()
    library.close()


def test_who_looks_on_searches_and_opens_but_is_offered_nothing_else(library: Library) -> None:
    page = library.page

    def look_on(route: Route) -> None:
        route.fulfill(json={"role": "view", "is_shared": True, "place": "192.0.2.7"})

    page.route("**/api/v1/access", look_on)
    library.stepramp.reload()
    library.open()
    page.locator("#library-search").fill("panel")
    page.locator(".library-design").first.click()
    expect(page.locator("#library-one")).to_contain_text("You look on")
    for button in ("library-save-design", "library-import", "library-edit"):
        expect(page.locator(f"#{button}")).to_be_hidden()
    expect(page.locator("#library-open")).to_be_visible()
    page.unroute("**/api/v1/access")


TRACE = {
    "step": [1, 2, 3], "measured_ticks": [0, 900, 1500], "timer_hz": 1000, "deviation_us": [0, 5, -5],
    "traced_axis": 0, "every_steps": 1, "complete": True, "changed": False,
}  # fmt: skip
PUSH = {
    "id": "p", "device_id": "d", "device": "Bench", "pushed_at": "2026-11-28T07:10:47Z", "client": "Ada",
    "mode": "keep", "trouble": "Nothing was read back.", "verified": None, "backup": "b",
    "axes": [{"axis": 0, "name": "Panel stage", "content_hash": "", "revisions": []}],
}  # fmt: skip


def test_what_was_measured_and_pushed_is_shown_with_its_design(library: Library) -> None:
    page, stepramp = library.page, library.stepramp
    kept = library.design("Panel stage 2 copy")
    record = {"revision": 1, "kind": "trace", "note": "Axis 0", "document": TRACE}
    for each in (record, {**record, "kind": "capture", "document": {}}):
        stepramp.ask(stepramp.url, "POST", f"library/designs/{kept['id']}/records", each)
    page.route("**/library/pushes/search", lambda route: route.fulfill(json={"count": 1, "pushes": [PUSH]}))
    stepramp.reload()
    library.open()
    page.locator("#library-search").fill("copy")
    page.locator(".library-design b", has_text="Panel stage 2 copy").click()
    row = page.locator(".library-rows li", has_text="Trace, revision 1")
    expect(page.locator(".library-outcome")).to_have_text("Failed: Nothing was read back.")
    library.inspect()
    with page.expect_download() as saved:
        row.get_by_role("button", name="Download the trace of revision 1").click()
    assert json.loads(saved.value.path().read_text()) == TRACE
    # Another program may keep whatever it likes.
    page.get_by_role("button", name="Show the capture of revision 1").click()
    expect(library.note).to_contain_text("It can be downloaded, but not shown")
    row.get_by_role("button", name="Show").click()
    expect(library.note).to_have_text("The trace lies over the plots now.")
    page.unroute("**/library/pushes/search")
    library.close()
    chip = page.locator(".chip.trace")
    expect(chip).to_have_attribute("title", re.compile("^Trace of “Panel stage 2 copy”, revision 1, from the library"))
    page.locator("#remove-trace").click()
    expect(chip).to_be_hidden()
