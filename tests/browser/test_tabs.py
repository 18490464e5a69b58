"""Two tabs of one browser: each keeps its own work, the other's is offered and never taken."""

from collections.abc import Callable

from playwright.sync_api import BrowserContext, Page, expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until


def opened(context: BrowserContext, stepramp: StepRampPage, watch: Watch, *, duplicate: bool = False) -> StepRampPage:
    """Open another tab of the same browser: a new one, or one that begins with what the other has in hand."""
    if duplicate:  # As browsers do: what the session keeps goes along.
        with context.expect_page() as page:
            stepramp.page.evaluate("() => { open(location.href); }")
        made = page.value
    else:
        made = context.new_page()
        made.goto(stepramp.url)
    made.set_default_timeout(20_000)
    watch.follow(made)
    other = StepRampPage(made, stepramp.url)
    other.wait_for_plots()
    return other


def menu(page: Page) -> str:
    page.locator("#examples").click()
    text = page.locator("#menu-list").inner_text()
    page.keyboard.press("Escape")
    return text


def test_a_second_tab_leaves_the_first_ones_work_alone_and_a_closed_ones_is_found(
    open_page: Callable[..., StepRampPage], context: BrowserContext, watch: Watch
) -> None:
    first = open_page()
    first.edit_and_wait(SLEW_SPEED, "777")
    first.page.locator(".design-name").fill("Mine")
    first.kept()
    second = opened(context, first, watch)
    expect(second.field(SLEW_SPEED)).to_have_value("1,000")
    second.edit_and_wait(SLEW_SPEED, "1234")
    second.page.locator(".design-name").fill("Theirs")
    second.kept()
    expect(first.page.locator("#offer")).to_be_hidden()
    first.reload()
    expect(first.field(SLEW_SPEED)).to_have_value("777")
    # What is open there can be had here, what was closed is gone on with.
    until(lambda: "“Theirs”\nIn another tab, which keeps it" in menu(first.page))
    second.page.close()
    third = opened(context, first, watch)
    expect(third.page.locator(".design-name")).to_have_value("Theirs")
    third.choose_example("“Mine”")
    expect(third.field(SLEW_SPEED)).to_have_value("777")
    third.page.keyboard.press("Control+z")
    expect(third.page.locator(".design-name")).to_have_value("Theirs")
    third.page.close()


def test_where_a_browser_has_no_locks_a_duplicate_keeps_its_own_work(
    open_page: Callable[..., StepRampPage], context: BrowserContext, watch: Watch
) -> None:
    """As where several people share a server without TLS: the tabs then ask each other."""
    context.add_init_script("Object.defineProperty(Navigator.prototype, 'locks', {value: undefined})")
    first = open_page()
    first.edit_and_wait(SLEW_SPEED, "1111")
    first.kept()
    second = opened(context, first, watch, duplicate=True)
    expect(second.field(SLEW_SPEED)).to_have_value("1,111")
    second.edit_and_wait(SLEW_SPEED, "2222")
    second.kept()
    expect(first.page.locator("#offer")).to_contain_text("Another tab has changed this design.")
    second.page.close()
    first.reload()
    expect(first.field(SLEW_SPEED)).to_have_value("1,111")


def test_what_a_duplicate_changes_is_offered_and_taken_back(
    open_page: Callable[..., StepRampPage], context: BrowserContext, watch: Watch
) -> None:
    first = open_page()
    offer = first.page.locator("#offer")
    first.edit_and_wait(SLEW_SPEED, "777")
    first.kept()
    second = opened(context, first, watch, duplicate=True)
    expect(second.field(SLEW_SPEED)).to_have_value("777")
    expect(offer).to_be_hidden()
    second.edit_and_wait(SLEW_SPEED, "888")
    expect(offer).to_contain_text("Another tab has changed this design.")
    expect(first.field(SLEW_SPEED)).to_have_value("777")
    offer.get_by_role("button", name="Open it here").click()
    expect(first.field(SLEW_SPEED)).to_have_value("888")
    expect(offer).to_be_hidden()
    first.page.locator("#head-undo").click()
    expect(first.field(SLEW_SPEED)).to_have_value("777")
    expect(second.field(SLEW_SPEED)).to_have_value("888")
    expect(offer).to_be_visible()
    offer.get_by_role("button", name="Keep mine").click()
    second.edit_and_wait(SLEW_SPEED, "999")
    until(lambda: second.kept()["machine"]["axes"][0]["ramp"]["slew_speed_steps_per_s"] == 999)
    expect(offer).to_be_hidden()
    second.page.close()


def test_a_full_browser_says_so_and_what_was_kept_stays(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page()
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    stepramp.kept()
    fill = """() => { for (let length = 1 << 22; length >= 1; length /= 2) for (let index = 0; ; index++)
        try { localStorage.setItem(`fill ${length} ${index}`, 'x'.repeat(length)); } catch { break; } }"""
    stepramp.page.evaluate(fill)
    stepramp.page.locator(".design-name").fill("A longer name than it was")
    expect(stepramp.page.locator(".summary-messages")).to_contain_text("no room left to keep your design")
    expect(stepramp.page.locator(".status .kept")).to_contain_text("not saved")
    assert stepramp.kept()["machine"]["axes"][0]["ramp"]["slew_speed_steps_per_s"] == 777
    empty = "() => Object.keys(localStorage).forEach((key) => key.startsWith('fill') && localStorage.removeItem(key))"
    stepramp.page.evaluate(empty)
    stepramp.page.locator(".design-name").fill("Named again")
    expect(stepramp.page.locator(".summary-messages")).to_be_hidden()
    expect(stepramp.page.locator(".status .kept")).to_have_text("saved in this browser")


def test_new_and_duplicate_and_a_name_that_is_too_long(open_page: Callable[..., StepRampPage], watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    stepramp = open_page()
    page, name = stepramp.page, stepramp.page.locator(".design-name")
    stepramp.edit_and_wait(SLEW_SPEED, "777")
    stepramp.choose_example("Duplicate")
    expect(name).to_have_value("Lead-screw stage copy")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    assert "Back to your “Lead-screw stage”" in menu(page)
    stepramp.choose_example("New")
    expect(name).to_have_value("")
    expect(stepramp.field(SLEW_SPEED)).to_have_value("1,000")
    assert stepramp.table_rows() == []
    page.locator("#axis-presets").select_option("NEMA 17 · direct drive")
    expect(name).to_have_value("NEMA 17 · direct drive")
    name.fill("n" * 101)
    problem = page.locator("#design-name-problem")
    expect(problem).to_have_text("The name has 101 characters; allowed: at most 100.")
    expect(name).to_have_attribute("aria-invalid", "true")
    name.fill("n" * 100)
    expect(problem).to_be_hidden()
    expect(name).to_have_attribute("aria-invalid", "false")
    for _ in range(3):
        page.locator("#head-undo").click()
    expect(name).to_have_value("Lead-screw stage copy")
