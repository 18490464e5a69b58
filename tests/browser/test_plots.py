"""What the plots show and how they are looked at."""

from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import WebSocket, expect

from browser.stepramp_page import ACCELERATION, SLEW_SPEED, StepRampPage, until


@pytest.fixture
def stepramp(module_page: StepRampPage) -> StepRampPage:
    module_page.start_over()
    return module_page


def view(stepramp: StepRampPage, name: str) -> None:
    stepramp.page.locator(f'#view-choice [data-value="{name}"]').click()


def test_the_slider_changes_the_number_and_the_plots_at_once(stepramp: StepRampPage) -> None:
    before = stepramp.curves()
    slider = stepramp.slider(ACCELERATION)
    slider.focus()
    for _ in range(3):
        stepramp.page.keyboard.press("ArrowRight")
    assert stepramp.field(ACCELERATION).input_value() != "5,000"
    until(lambda: stepramp.curves()["exact-velocity"] != before["exact-velocity"])
    box = slider.bounding_box()
    assert box
    stepramp.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    stepramp.page.mouse.down()
    stepramp.page.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + box["height"] / 2, steps=10)
    stepramp.page.mouse.up()
    number = float(stepramp.field(ACCELERATION).input_value().replace(",", ""))
    assert 90_000 < number < 120_000, "three quarters of the way from 100 to 1,000,000 on a logarithmic slider"
    until(lambda: "1,000" in stepramp.figure_text("peak"))


def test_requests_do_not_pile_up_while_a_slider_is_dragged(open_page: Callable[..., StepRampPage]) -> None:
    # Questions over the socket and requests, each on its own: the browser reports the two out of step.
    under_way, most, total = Counter[str](), Counter[str](), Counter[str]()

    def begun(way: str) -> None:
        under_way[way] += 1
        total[way] += 1
        most[way] = max(most[way], under_way[way])

    def ended(way: str) -> None:
        under_way[way] -= 1

    def opened(socket: WebSocket) -> None:
        if "/curves/" in socket.url:
            socket.on("framesent", lambda _: begun("socket"))
            socket.on("framereceived", lambda _: ended("socket"))

    stepramp = open_page()  # whose socket nobody has opened yet
    page = stepramp.page
    page.on("request", lambda request: request.url.endswith("/curves") and begun("request"))
    page.on("requestfinished", lambda request: request.url.endswith("/curves") and ended("request"))
    page.on("websocket", opened)
    box = stepramp.slider(SLEW_SPEED).bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] * 0.3, box["y"] + 7)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.6, box["y"] + 7, steps=40)
    page.mouse.up()
    value = float(stepramp.field(SLEW_SPEED).input_value().replace(",", ""))
    until(lambda: f"of {value:,.0f} asked for" in stepramp.figure_text("peak"))
    assert most == {"socket": 1, "request": 1}
    assert total["socket"] > 5


def test_a_slider_on_its_way_over_where_it_was_taken_up_asks_for_every_point_when_it_is_let_go(
    stepramp: StepRampPage,
) -> None:
    stepramp.field("move.steps").fill("5000")
    until(lambda: "5,000 steps" in stepramp.figure_text("duration"))
    page, box = stepramp.page, stepramp.slider(SLEW_SPEED).bounding_box()
    assert box
    begin, away, y = box["x"] + box["width"] * 0.5, box["x"] + box["width"] * 0.55, box["y"] + box["height"] / 2
    page.mouse.click(begin, y)
    first = stepramp.field(SLEW_SPEED).input_value()
    until(lambda: f"of {first} asked for" in stepramp.figure_text("peak"))
    page.wait_for_timeout(300)
    asked: list[str] = []
    page.on("request", lambda request: request.url.endswith("/curves") and asked.append(request.url))
    page.mouse.move(begin, y)
    page.mouse.down()
    for _ in range(2):
        page.mouse.move(away, y, steps=4)
        expect(stepramp.field(SLEW_SPEED)).not_to_have_value(first)
        page.mouse.move(begin, y, steps=4)
        expect(stepramp.field(SLEW_SPEED)).to_have_value(first)
        page.wait_for_timeout(100)
    assert asked == [], "a slider that is held asks over its socket, for fewer points"
    with page.expect_request("**/api/v1/curves"):
        page.mouse.up()


def test_the_views_show_their_part_of_the_move(stepramp: StepRampPage) -> None:
    view(stepramp, "start")
    until(lambda: stepramp.x_axis()["type"] == "log")
    view(stepramp, "up")
    until(lambda: stepramp.x_axis()["type"] == "linear" and 100 < stepramp.x_axis()["range"][1] < 130)
    view(stepramp, "down")
    until(lambda: 370 < stepramp.x_axis()["range"][0] < 401)
    view(stepramp, "whole")
    until(lambda: stepramp.x_axis()["range"][0] < 1 and stepramp.x_axis()["range"][1] > 500)


def test_the_plots_can_be_drawn_against_time_and_position(stepramp: StepRampPage) -> None:
    stepramp.page.locator('#axis-choice [data-value="time"]').click()
    until(lambda: stepramp.x_axis()["title"] == "time, ms")
    ends = "() => document.querySelector('.figure').data.filter((one) => one.visible).map((one) => one.x.at(-1))"
    last = max(stepramp.page.evaluate(ends))
    assert last < stepramp.x_axis()["range"][1] < 1.01 * last, "the slowest method still fits"
    stepramp.page.locator('#axis-choice [data-value="position"]').click()
    until(lambda: stepramp.x_axis()["title"] == "position, mm")
    assert 10 < stepramp.x_axis()["range"][1] < 10.1, "500 of 400 steps a turn at 8 mm"
    stepramp.field("move.steps").fill("-500")
    until(lambda: -10.1 < stepramp.x_axis()["range"][0] < -10)


def test_wheel_and_drag_zoom_and_a_double_click_shows_all(stepramp: StepRampPage) -> None:
    page = stepramp.page
    box = page.locator(".scope").bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + 150
    whole = stepramp.x_axis()["range"]
    page.mouse.move(x, y)
    page.mouse.wheel(0, -400)
    until(lambda: stepramp.x_axis()["range"][1] < whole[1])
    page.mouse.dblclick(x, y)
    until(lambda: stepramp.x_axis()["range"] == whole)
    page.mouse.move(x - 200, y)
    page.mouse.down()
    page.mouse.move(x + 100, y, steps=5)
    page.mouse.up()
    until(lambda: stepramp.x_axis()["range"][0] > whole[0] and stepramp.x_axis()["range"][1] < whole[1])
    page.locator(".scope").focus()
    page.keyboard.press("0")
    until(lambda: stepramp.x_axis()["range"] == whole)


def test_the_cursor_reads_every_method(stepramp: StepRampPage) -> None:
    page = stepramp.page
    box = page.locator(".scope").bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 200)
    expect(page.locator(".tooltip")).to_be_visible()
    for words in ("Step ", "Exact", "1st order", "Table", "2,000"):
        expect(page.locator(".tooltip")).to_contain_text(words)
    expect(page.locator(".status .reading")).to_contain_text("2,000 ticks = 1,000.0 µs")
    page.mouse.move(5, 5)
    expect(page.locator(".tooltip")).to_be_hidden()
    page.locator(".scope").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    expect(page.locator(".status .reading")).to_contain_text("Step 2")


def test_the_legend_switches_methods_and_the_chosen_one_is_drawn_last(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator('.chip[data-method="table"]').click()
    until(lambda: "table-velocity" not in stepramp.curves())
    page.locator('.chip[data-method="table"]').click()
    until(lambda: "table-velocity" in stepramp.curves())
    page.locator("#method").select_option("first_order")
    until(lambda: list(stepramp.curves())[-1] == "first_order-error")
    expect(page.locator('#arithmetic [aria-pressed="true"]')).to_have_text("float32")
    page.locator('#arithmetic [data-value="float64"]').click()
    until(lambda: "float64" in stepramp.figure_text("method"))
    page.locator('#arithmetic [data-value="fixed"]').click()
    until(lambda: "fixed" in stepramp.figure_text("method"))
    page.locator("#method").select_option("austin")
    expect(page.locator('#arithmetic [data-value="fixed"]')).to_be_hidden()
    until(lambda: "float32" in stepramp.figure_text("method"))


def test_the_phases_are_labelled(stepramp: StepRampPage) -> None:
    for name, words in (("accelerate", "100 steps"), ("slew", "300 steps"), ("decelerate", "100 steps")):
        expect(stepramp.page.locator(f'[data-phase="{name}"]')).to_contain_text(words)
    stepramp.field("move.steps").fill("100")
    expect(stepramp.page.locator('[data-phase="slew"]')).to_have_count(0)


def design_of(stepramp: StepRampPage, **changes: dict[str, object]) -> dict[str, Any]:
    """Return the lead-screw stage with other values, as the server has it."""
    examples = stepramp.ask(stepramp.url, "GET", "examples")["examples"]
    design = next(one["design"] for one in examples if one["title"] == "Lead-screw stage")
    return {**design, **{part: {**design[part], **values} for part, values in changes.items()}}


def trace(stepramp: StepRampPage, uid: str) -> dict[str, Any]:
    script = """(uid) => { const one = document.querySelector('.figure').data.find((trace) => trace.uid === uid);
        return one && {x: Array.from(one.x), y: Array.from(one.y), visible: one.visible, shape: one.line.shape}; }"""
    return stepramp.page.evaluate(script, uid)


def test_zoomed_in_every_step_is_there_and_drawn_as_a_step(stepramp: StepRampPage) -> None:
    stepramp.field("move.steps").fill("200000")
    stepramp.field(ACCELERATION).fill("10")
    until(lambda: stepramp.x_axis()["range"][1] > 200_000)
    whole = stepramp.ask(stepramp.url, "POST", "profile", {"design": design_of(
        stepramp, move={"steps": 200_000}, ramp={"acceleration_steps_per_s2": 10})})  # fmt: skip
    assert len(trace(stepramp, "exact-delay")["x"]) < 5_000
    box = stepramp.page.locator(".scope").bounding_box()
    assert box
    stepramp.page.mouse.move(box["x"] + 120, box["y"] + 150)
    for _ in range(13):
        stepramp.page.mouse.wheel(0, -500)

    def in_view() -> dict[int, float]:
        low, high = stepramp.x_axis()["range"]
        drawn = trace(stepramp, "exact-delay")
        return {step: delay for step, delay in zip(drawn["x"], drawn["y"], strict=True) if low <= step <= high}

    def is_whole() -> bool:
        low, high = stepramp.x_axis()["range"]
        return high - low < 400 and len(in_view()) >= int(high) - int(low) - 1

    until(is_whole)
    for step, delay in in_view().items():
        assert delay == pytest.approx(whole["intervals_ticks"][step - 1] / 2)
    until(lambda: trace(stepramp, "exact-delay")["shape"] == "hvh")
    stepramp.page.keyboard.press("Escape")


def test_the_implied_acceleration_is_drawn_when_wanted(stepramp: StepRampPage) -> None:
    switch = stepramp.page.locator("#show-acceleration")
    assert trace(stepramp, "implied-acceleration") is None
    switch.click()
    until(lambda: (trace(stepramp, "implied-acceleration") or {}).get("visible"))
    drawn = trace(stepramp, "implied-acceleration")
    body = {"design": design_of(stepramp), "methods": ["exact"], "curves": ["implied_acceleration_steps_per_s2"]}
    [errors] = stepramp.ask(stepramp.url, "POST", "errors", body)["methods"]
    expected = [errors["implied_acceleration_steps_per_s2"][step - 1] for step in drawn["x"]]
    assert drawn["y"] == pytest.approx(expected, rel=1e-5)
    switch.click()
    until(lambda: trace(stepramp, "implied-acceleration") is None)


def test_the_error_is_split_into_its_parts(stepramp: StepRampPage) -> None:
    stepramp.page.locator("#method").select_option("second_order")
    stepramp.page.locator('#third-choice [data-value="parts"]').click()
    until(lambda: (trace(stepramp, "part-method") or {}).get("visible"))
    until(lambda: not trace(stepramp, "newton-error")["visible"])
    method = {"name": "second_order", "arithmetic": "float32"}
    names = [f"{part}_error_ticks" for part in ("method", "arithmetic", "rounding", "compression")]
    body = {"design": design_of(stepramp, method=method), "methods": ["second_order"], "segment_bound_ticks": 1,
            "curves": [*names, "tick_error", "relative_error"]}  # fmt: skip
    [errors] = stepramp.ask(stepramp.url, "POST", "errors", body)["methods"]
    # By (17) and (5), the intervals that the parts are measured by.
    reference = [2e6 / (2 * 5000 * step) ** 0.5 for step in range(1, 101)]
    for part in ("method", "arithmetic", "rounding", "compression"):
        drawn = trace(stepramp, f"part-{part}")
        shares = dict(zip(drawn["x"], drawn["y"], strict=True))
        for step in (1, 2, 3, 50, 100):
            expected = errors[f"{part}_error_ticks"][step - 1] / reference[step - 1] * 100
            assert shares[step] == pytest.approx(expected, rel=1e-3, abs=1e-4), part
    stepramp.page.locator('#third-choice [data-value="error"]').click()
    until(lambda: trace(stepramp, "newton-error")["visible"])


SLIDE = """async ([path, count]) => {
    const slider = document.querySelector(`.parameter[data-path="${path}"] .slider`);
    for (let i = 0; i < count; i += 1) {
        slider.value = String(Number(slider.max) * (0.5 + 0.02 * (i % 5)));
        slider.dispatchEvent(new Event('input', {bubbles: true}));
        await new Promise((done) => requestAnimationFrame(done));
    }
}"""


def test_while_a_slider_moves_only_paths_are_rewritten_and_then_all_is_drawn_with_care(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.evaluate(SLIDE, [ACCELERATION, 5])
    watch = """async ([path]) => {
        const figure = document.querySelector('.figure');
        const drawn = figure.data, paths = new Set();
        const line = figure.querySelector('.traceexact-velocity path.js-line');
        const slider = document.querySelector(`.parameter[data-path="${path}"] .slider`);
        for (let i = 0; i < 40; i += 1) {
            slider.value = String(Number(slider.max) * (0.55 + 0.0002 * i));
            slider.dispatchEvent(new Event('input', {bubbles: true}));
            await new Promise((done) => setTimeout(done, 15));
            paths.add(line.getAttribute('d'));
        }
        return [paths.size, line.isConnected];
    }"""
    rewritten, is_same = page.evaluate(watch, [ACCELERATION])
    assert rewritten > 3
    assert is_same
    page.locator(f'.parameter[data-path="{ACCELERATION}"] .slider').dispatch_event("change")
    value = float(stepramp.field(ACCELERATION).input_value().replace(",", ""))
    first = (2 * value) ** 0.5
    until(lambda: trace(stepramp, "exact-velocity")["y"][0] == pytest.approx(first, rel=1e-3))


def test_hundreds_of_edits_leave_nothing_behind(stepramp: StepRampPage) -> None:
    page = stepramp.page
    session = page.context.new_cdp_session(page)

    def left() -> tuple[float, float, float]:
        page.wait_for_timeout(600)
        session.send("HeapProfiler.collectGarbage")
        heap, dom = session.send("Runtime.getHeapUsage"), session.send("Memory.getDOMCounters")
        return heap["usedSize"] / 2**20, dom["nodes"], dom["jsEventListeners"]

    page.evaluate(SLIDE, [ACCELERATION, 100])
    before = left()
    page.evaluate(SLIDE, [ACCELERATION, 200])
    most = [number + more for number, more in zip(before, (3, 150, 15), strict=True)]
    # The last curves may still be on their way; what is left behind stays.
    until(lambda: all(now < allowed for now, allowed in zip(left(), most, strict=True)))


def test_fingers_zoom_pan_and_show_all(stepramp: StepRampPage) -> None:
    touch = """([kind, id, x]) => { const scope = document.querySelector('.scope');
        const box = scope.getBoundingClientRect();
        scope.dispatchEvent(new PointerEvent(kind, {pointerId: id, pointerType: 'touch', bubbles: true,
            clientX: box.left + x, clientY: box.top + 120})); }"""

    def do(kind: str, finger: int, x: float) -> None:
        stepramp.page.evaluate(touch, [kind, finger, x])

    whole = stepramp.x_axis()["range"]
    do("pointerdown", 1, 300)
    do("pointerdown", 2, 500)
    do("pointermove", 2, 700)
    for finger in (1, 2):
        do("pointerup", finger, 500)
    until(lambda: stepramp.x_axis()["range"][1] - stepramp.x_axis()["range"][0] < 0.6 * (whole[1] - whole[0]))
    low = stepramp.x_axis()["range"][0]
    do("pointerdown", 3, 400)
    do("pointermove", 3, 440)
    do("pointerup", 3, 440)
    until(lambda: whole[0] <= stepramp.x_axis()["range"][0] < low)
    stepramp.page.wait_for_timeout(400)
    for finger in (4, 5):
        do("pointerdown", finger, 600)
        do("pointerup", finger, 600)
    until(lambda: stepramp.x_axis()["range"] == whole)
