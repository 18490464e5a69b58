"""Layouts, themes and reach by keyboard."""

import base64
import io
from collections.abc import Callable

import pytest
from playwright.sync_api import BrowserContext, Route, expect
from pypdf import PdfReader

from browser.conftest import Watch, new_page
from browser.server import Server
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

# Desktop, tablet, phone; phones on their side, and desktops of 1440 x 900 and 1920 x 1080 magnified to 200 %.
SIZES = [
    (1440, 900),
    (1024, 768),
    (390, 844),
    (844, 390),
    (720, 450),
    (960, 540),
    (667, 375),
    (640, 360),
    (320, 568),
]
LEAST_PLOT_PX = 60
# What a finger, a cable or a look is for: all of it within the window, and nothing of it under anything else.
CONTROLS = "#stop, #examples, #plot-choice, #axis-choice, .tabs button, #push, .keeping button, #connect, #fit-table"
MEASURE = """(controls) => {
    const seen = [...document.querySelectorAll(controls)].filter((one) => one.checkVisibility());
    const inSight = (box) => box.top >= 0 && box.bottom <= innerHeight;
    const centre = (box) => document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    const named = (one) => one.id || one.textContent;
    const frame = document.querySelector('.figure').layout;
    const heights = [frame.yaxis, frame.yaxis2, frame.yaxis3].map(({ domain }) => domain[1] - domain[0]);
    const inner = frame.height - frame.margin.t - frame.margin.b;
    return {
        page: [document.documentElement.scrollWidth, document.documentElement.scrollHeight],
        outside: seen.filter((one) => one.getBoundingClientRect().right > innerWidth + 0.5).map(named),
        covered: seen.filter((one) => inSight(one.getBoundingClientRect()))
            .filter((one) => !one.contains(centre(one.getBoundingClientRect()))).map(named),
        plots: heights.filter((height) => height > 0.01).map((height) => height * inner),
        stop: document.querySelector('#stop').getBoundingClientRect().right,
    };
}"""


def test_everything_is_in_reach_at_every_size(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page()
    page = stepramp.page
    fits = "() => document.querySelector('.groups').scrollHeight <= document.querySelector('.groups').clientHeight"
    assert page.evaluate(fits), "all parameters are in sight on a desktop"
    for size in SIZES:
        page.set_viewport_size({"width": size[0], "height": size[1]})
        until(lambda size=size: page.evaluate("() => document.querySelector('.figure').layout.width") <= size[0])
        for panel in ("parameters", "table", "device"):
            stepramp.show_panel(panel)
            expect(page.locator(f"#{panel}")).to_be_visible()
            until(lambda: min(page.evaluate(MEASURE, CONTROLS)["plots"]) > LEAST_PLOT_PX)
            found = page.evaluate(MEASURE, CONTROLS)
            assert found["page"] <= list(size), (size, panel)
            assert (found["outside"], found["covered"]) == ([], []), (size, panel)
            assert size[0] - 20 < found["stop"] <= size[0], "STOP is the last thing of the head"
            box = page.locator(f"#{panel}").bounding_box()
            assert box
            assert (box["height"] >= 150, box["x"] + box["width"] <= size[0]) == (True, True), (size, panel)


def test_a_phone_leaves_room_to_compare_with_what_is_pinned(open_page: Callable[..., StepRampPage]) -> None:
    page = open_page((390, 844)).page
    page.locator("#keep").click()
    expect(page.locator(".summary-messages, #summary")).to_contain_text(["Against the pinned design"])
    until(lambda: page.evaluate(MEASURE, CONTROLS)["plots"][0] > 2 * LEAST_PLOT_PX)


def test_a_phone_scrolls_nothing_sideways_while_there_are_no_curves_yet(
    context: BrowserContext, server: Server, watch: Watch
) -> None:
    page = new_page(context, watch, (390, 844))
    held: list[Route] = []
    page.route("**/api/v1/curves", lambda route: held.append(route))  # noqa: PLW0108  # Playwright wants a function
    page.goto(server.url)
    # A look at the page lets what it asks for come to be known here.
    until(lambda: [page.title(), *held][1:])
    assert page.evaluate("() => document.documentElement.scrollWidth") == 390
    for route in held:
        route.continue_()
    expect(page.locator(".plot-title:visible")).to_have_count(1)
    page.close()


def test_plots_that_are_long_in_coming_say_so(context: BrowserContext, server: Server, watch: Watch) -> None:
    page = new_page(context, watch)
    held: list[Route] = []
    page.route("**/api/v1/curves", lambda route: held.append(route))  # noqa: PLW0108  # Playwright wants a function
    page.goto(server.url)
    note = page.get_by_text("Computing…")
    expect(note).to_be_visible()
    for route in held:
        route.continue_()
    StepRampPage(page, server.url).wait_for_plots()
    expect(note).to_be_hidden()
    page.close()


def test_a_phone_goes_back_from_the_table_to_what_it_showed_before(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page((390, 844))
    page = stepramp.page
    titles = page.locator(".plot-title:visible b")
    stepramp.show_panel("table")
    expect(titles.first).to_have_text("Delay per step")
    stepramp.show_panel("device")
    expect(titles.first).to_have_text("Velocity")
    expect(page.locator('#plot-choice [data-value="velocity"]')).to_have_attribute("aria-pressed", "true")
    until(lambda: stepramp.x_axis()["type"] == "linear")


def test_a_phone_shows_one_plot_at_a_time(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page((390, 844))
    for name in ("delay", "error", "velocity"):
        stepramp.page.locator(f'#plot-choice [data-value="{name}"]').click()
        until(lambda one=name: {key.split("-")[1] for key in stepramp.curves()} == {one})
        expect(stepramp.page.locator(".plot-title:visible")).to_have_count(1)


def test_figures_are_whole_with_their_units(open_page: Callable[..., StepRampPage]) -> None:
    """Where they scroll, a number that is cut is not to be read at all."""
    cut = """() => [...document.querySelectorAll('.figures .stat .value, .legend .chip em')].filter((one) => {
        if (!one.checkVisibility() || getComputedStyle(one).opacity === '0' || one.textContent === '') return false;
        const {left, right} = one.getBoundingClientRect();
        const strip = one.closest('.figures, .legend').getBoundingClientRect();
        if (right <= strip.left || left >= strip.right) return false;
        // Where it goes on it fades over 32 px.
        const [before, after] = ['before', 'after'].map((side) =>
            one.closest('.figures, .legend').hasAttribute(`data-more-${side}`) ? 32 : -1);
        return one.scrollWidth > one.clientWidth || left < strip.left + before || right > strip.right - after;
    }).map((one) => one.closest('.stat, .chip').textContent)"""
    stepramp = open_page((1024, 768))
    page = stepramp.page
    for path, value in ((ACCELERATION, "1234567"), (SLEW_SPEED, "40000"), ("move.steps", "56789")):
        stepramp.field(path).fill(value)
    expect(page.locator('[data-figure="peak"] .value')).to_contain_text("40,000")
    for width, height in ((1024, 768), (720, 450), (390, 844), (320, 568)):
        page.set_viewport_size({"width": width, "height": height})
        until(lambda: page.evaluate(cut) == [])
        for scrolled_px in range(0, 400, 12):
            for strip in page.locator(".figures:not(.of-axes), .legend").all():
                strip.evaluate("(one, px) => one.scrollTo(px, 0)", scrolled_px)
            until(lambda: page.evaluate(cut) == [])


# How many light stretches there are from above to below, in each column of a picture.
LIGHT_RUNS = """async (picture) => {
    const bytes = Uint8Array.from(atob(picture), (one) => one.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const {width, height} = bitmap;
    const drawing = new OffscreenCanvas(width, height).getContext('2d');
    drawing.drawImage(bitmap, 0, 0);
    const {data} = drawing.getImageData(0, 0, width, height);
    const isLight = (x, y) => y >= 0 && Math.max(...data.slice(4 * (y * width + x), 4 * (y * width + x) + 3)) > 96;
    return Array.from({length: width}, (_, x) =>
        Array.from({length: height}, (_, y) => isLight(x, y) && !isLight(x, y - 1)).filter(Boolean).length);
}"""


def test_in_forced_colours_no_slider_touches_the_box_of_a_number(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page((844, 390))
    page = stepramp.page
    page.emulate_media(forced_colors="active")
    field = ".parameter[data-path='timer.{}'] .field"
    above = page.locator(field.format("frequency_hz")).bounding_box()
    below = page.locator(field.format("counter_bits")).bounding_box()
    assert above
    assert below
    top = above["y"] + above["height"] - 2
    # The edges of the boxes within their corners, and all that is between them: 2 MHz is under the box.
    clip = {"x": above["x"] + 8, "y": top, "width": above["width"] - 16, "height": below["y"] + 2 - top}
    picture = page.screenshot(clip=clip)
    runs = page.evaluate(LIGHT_RUNS, base64.b64encode(picture).decode())
    assert min(runs) >= 3, "the edge of a box, the slider, the edge of the next box"


@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_printed_plots_are_as_wide_as_the_paper(open_page: Callable[..., StepRampPage], size: tuple[int, int]) -> None:
    page = open_page(size).page
    layout = "(({width, yaxis3}) => [width, yaxis3.domain[1] - yaxis3.domain[0]])"
    drawn = f"{layout}(document.querySelector('.figure').layout)"
    page.evaluate(f"() => addEventListener('beforeprint', () => {{ window.printed = {drawn}; }})")
    _, error_plot_before = page.evaluate(f"() => {drawn}")
    printed = PdfReader(io.BytesIO(page.pdf(prefer_css_page_size=True)))
    margins_pt = 2 * 12 / 25.4 * 72
    paper_px = (float(printed.pages[0].mediabox.width) - margins_pt) * 96 / 72
    figure_px, error_plot = page.evaluate("() => window.printed")
    assert 0.98 < figure_px / paper_px <= 1
    assert error_plot > 0.1, "there is room for all three plots, whatever the window has"
    # What came in meanwhile may have made the window's place for the plots another by some lines.
    fills = """() => { const {layout, parentElement} = document.querySelector('.figure');
        return layout.width === parentElement.clientWidth && layout.height === parentElement.clientHeight; }"""
    until(lambda: page.evaluate(fills))
    assert page.evaluate(f"() => {drawn}")[1] == pytest.approx(error_plot_before, abs=0.05)


def test_the_theme_follows_the_system_until_it_is_switched(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page(theme="light")
    root = stepramp.page.locator("html")
    expect(root).to_have_attribute("data-theme", "light")
    stepramp.page.emulate_media(color_scheme="dark")
    expect(root).to_have_attribute("data-theme", "dark")
    stepramp.page.get_by_role("button", name="Switch between light and dark").click()
    expect(root).to_have_attribute("data-theme", "light")
    background = "() => document.querySelector('.figure').layout.plot_bgcolor"
    until(lambda: stepramp.page.evaluate(background) == "#f8f9fb")
    stepramp.reload()
    expect(root).to_have_attribute("data-theme", "light")


def test_the_device_is_a_few_keys_away(open_page: Callable[..., StepRampPage]) -> None:
    page = open_page((1024, 768)).page
    for _ in range(4):
        page.keyboard.press("Tab")
    expect(page.locator(":focus")).to_have_text("Skip to the device")
    page.keyboard.press("Enter")
    expect(page.locator("#device")).to_be_focused()
    assert "#" not in page.url, "the address is that of a design"
    page.keyboard.press("Tab")
    assert page.evaluate("() => document.activeElement.closest('#device') !== null")


def test_a_number_is_replaced_by_what_is_typed_unless_the_caret_is_set(stepramp: StepRampPage) -> None:
    field = stepramp.field(SLEW_SPEED)
    field.click()
    stepramp.page.keyboard.type("1500")
    expect(field).to_have_value("1500")
    # The second press at it sets the caret: at the end of what stands at the right.
    field.click(position={"x": field.bounding_box()["width"] - 5, "y": 5})  # type: ignore[index]
    stepramp.page.keyboard.type("0")
    expect(field).to_have_value("15000")


def test_figures_explain_themselves(stepramp: StepRampPage) -> None:
    figure, explained = stepramp.page.locator('[data-figure="landing"]'), stepramp.page.locator("#figure-help")
    expect(figure).to_contain_text("Last-step speed")
    for point in (figure.focus, figure.hover):
        stepramp.page.locator('[data-figure="peak"]').focus()
        point()
        expect(explained).to_contain_text("stop from it at once")
        box, whole = explained.bounding_box(), stepramp.page.locator("#summary").bounding_box()
        assert box
        assert whole
        assert whole["x"] <= box["x"] < box["x"] + box["width"] <= whole["x"] + whole["width"]
        stepramp.page.emulate_media(media="print")
        expect(explained).to_be_hidden()
        stepramp.page.emulate_media(media="screen")
        expect(explained).to_be_visible()
        stepramp.page.keyboard.press("Escape")
        expect(explained).to_be_hidden()


def test_a_page_that_opens_with_a_wrong_value_says_so_where_the_plots_would_be(
    stepramp: StepRampPage, watch: Watch
) -> None:
    watch.expected.append(REFUSED_VALUE)
    stepramp.field(SLEW_SPEED).fill("fast")
    expect(stepramp.message(SLEW_SPEED)).to_be_visible()
    stepramp.page.reload()
    expect(stepramp.page.locator(".stale-note")).to_have_text("No curves yet: correct what is marked")
    expect(stepramp.message(SLEW_SPEED)).to_contain_text("a number from 0.001 to 1,000,000 steps/s")
    # Of no number there is nothing to show: neither knob nor track stand where one might be.
    slider = stepramp.slider(SLEW_SPEED)
    assert slider.input_value() == "0"
    assert " 0%" in slider.evaluate("(one) => getComputedStyle(one, '::-webkit-slider-runnable-track').background")
    stepramp.field(SLEW_SPEED).fill("900")
    stepramp.wait_for_plots()
    expect(stepramp.page.locator(".stale-note")).to_be_hidden()


def test_the_head_of_a_push_report_stays_on_one_line(stepramp: StepRampPage) -> None:
    stepramp.edit_and_wait(SLEW_SPEED, "3000")
    stepramp.connect()
    stepramp.push()
    size = stepramp.page.locator("#push-report .push-head span")
    expect(size).to_contain_text("bytes")
    lines = "(one) => { const all = new Range(); all.selectNodeContents(one); return all.getClientRects().length; }"
    until(lambda: size.evaluate(lines) == 1)  # one that was drawn anew meanwhile has no lines


def test_the_info_view_explains_the_field_in_focus(stepramp: StepRampPage) -> None:
    stepramp.field("ramp.slew_speed_steps_per_s").focus()
    expect(stepramp.page.locator("#parameter-info")).to_contain_text("Slew speed")
    expect(stepramp.page.locator("#parameter-info")).to_contain_text("formula (18)")


@pytest.mark.parametrize(("width", "height"), [(320, 640), (390, 844), (844, 390), (1440, 900)])
def test_what_was_done_is_not_told_over_the_head_of_a_dialog(stepramp: StepRampPage, width: int, height: int) -> None:
    page = stepramp.page
    page.set_viewport_size({"width": width, "height": height})
    notice = page.locator("#notice")
    page.keyboard.press("Control+s")
    expect(notice).to_contain_text("Saved as")
    stepramp.show_panel("parameters")
    page.locator("#open-flight").click()
    head = page.locator("#flight-dialog .dialog-head").bounding_box()
    told = notice.bounding_box()
    assert head
    assert told, "it is still told"
    assert told["y"] >= head["y"] + head["height"] or told["y"] + told["height"] <= head["y"]
    assert told["y"] + told["height"] <= height


def test_every_control_has_a_name(stepramp: StepRampPage) -> None:
    script = """() => [...document.querySelectorAll('button, input, select, textarea')]
        .filter((one) => !one.labels?.length && !one.getAttribute('aria-label') && !one.textContent.trim())
        .map((one) => one.outerHTML)"""
    assert stepramp.page.evaluate(script) == []


def test_the_heads_of_the_table_are_whole(stepramp: StepRampPage) -> None:
    page = stepramp.page
    cut = """() => [...document.querySelectorAll('#table-rows th')]
        .filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.innerText)"""
    for width, height in ((1440, 900), (1024, 768), (844, 390), (390, 844), (320, 640)):
        page.set_viewport_size({"width": width, "height": height})
        stepramp.show_panel("table")
        expect(page.locator("#table-rows th").nth(3)).to_contain_text("speed, steps/s")
        assert page.evaluate(cut) == [], (width, height)
