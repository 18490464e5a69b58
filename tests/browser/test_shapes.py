"""The choice of a ramp's shape on the page: its own parameters, what is drawn, short moves, what is refused."""

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

JERK = "ramp.shape.jerk_steps_per_s3"
JERK_DOWN = "ramp.shape.deceleration_jerk_steps_per_s3"


@pytest.fixture
def watch(shared_watch: Watch) -> Watch:
    return shared_watch


@pytest.fixture
def stepramp(shared_page: StepRampPage) -> StepRampPage:
    return shared_page


def test_a_shape_is_chosen_and_its_parameters_change_the_ramp(stepramp: StepRampPage, watch: Watch) -> None:
    page = stepramp.page
    watch.expected.append(REFUSED_VALUE)
    expect(stepramp.field(JERK)).to_be_hidden()
    before = stepramp.curves()["exact-velocity"]
    page.locator("#shape").select_option("s_curve")
    expect(stepramp.field(JERK)).to_be_visible()
    until(lambda: stepramp.curves()["exact-velocity"] != before)
    # d follows a, and its jerk follows j, until they are set.
    expect(stepramp.field(JERK_DOWN)).to_have_value("")
    soft = stepramp.curves()["exact-velocity"]
    stepramp.field(JERK).fill("20000")
    until(lambda: stepramp.curves()["exact-velocity"] != soft)
    assert stepramp.design()["ramp"]["shape"] == {"name": "s_curve", "jerk_steps_per_s3": 20000}
    stepramp.field(JERK).fill("-1")
    expect(page.locator(f'[data-path="{JERK}"] .message')).to_contain_text("Jerk is -1; allowed: a number from 0.001")
    page.keyboard.press("Control+z")
    page.locator("#shape").select_option("constant")
    expect(stepramp.field(JERK)).to_be_hidden()
    until(lambda: stepramp.curves()["exact-velocity"] == before)
    assert "shape" not in stepramp.design()["ramp"]


def test_a_drawn_acceleration_is_pasted_and_refused_at_its_points(stepramp: StepRampPage, watch: Watch) -> None:
    page = stepramp.page
    watch.expected.append(REFUSED_VALUE)
    page.locator("#shape").select_option("drawn")
    points = page.locator("#drawn-points")
    expect(points).to_have_value("0  1\n500  1\n1000  0.5")
    points.fill("0,1\n400,0.8\n1000,0.2")
    until(lambda: stepramp.design()["ramp"]["shape"]["points"] == [[0, 1], [400, 0.8], [1000, 0.2]])
    expect(points).to_have_value("0,1\n400,0.8\n1000,0.2")
    points.fill("0 1\n400 0.8\n300 0.2")
    expect(page.locator(".drawn-points .message")).to_contain_text(
        "Point 3, speed, is 300; allowed: more than 400 steps/s"
    )
    page.get_by_role("button", name="Undo").click()
    expect(page.locator(".drawn-points .message")).to_have_count(0)


def test_more_points_than_a_design_may_have_are_refused_and_nothing_is_lost(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#shape").select_option("drawn")
    points, message = page.locator("#drawn-points"), page.locator(".drawn-points .message")
    pasted = "\n".join(f"{speed} 0.9" for speed in range(20_000))
    # As one event: typed by the browser, so many lines take half a minute.
    paste = "(box, text) => { box.value = text; box.dispatchEvent(new Event('input', {bubbles: true})); }"
    points.evaluate(paste, pasted)
    expect(message).to_contain_text("20,000 points; allowed: 2 to 200")
    stepramp.field(SLEW_SPEED).fill("777")
    until(lambda: stepramp.design()["ramp"]["slew_speed_steps_per_s"] == 777)
    expect(points).to_have_value(pasted)
    assert stepramp.design()["ramp"]["shape"]["points"] == [[0, 1], [500, 1], [1000, 0.5]]
    page.wait_for_timeout(1200)
    page.reload()
    expect(stepramp.field(SLEW_SPEED)).to_have_value("777")
    expect(points).to_have_value("0  1\n500  1\n1000  0.5")
    points.evaluate(paste, pasted)
    expect(message).to_have_count(1)
    points.fill("0 1\n900 0.5")
    expect(message).to_have_count(0)
    until(lambda: stepramp.design()["ramp"]["shape"]["points"] == [[0, 1], [900, 0.5]])


def test_an_acceleration_being_typed_leaves_the_drawing_without_numbers(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page = stepramp.page
    page.locator("#shape").select_option("drawn")
    labels = page.locator(".drawn-chart text")
    expect(labels.filter(has_text="5,000")).to_have_count(1)
    for typed in ("1.5e", "-", "abc"):
        stepramp.field("ramp.acceleration_steps_per_s2").fill(typed)
        expect(labels.filter(has_text="5,000")).to_have_count(0)
        expect(labels.filter(has_text="NaN")).to_have_count(0)
    stepramp.field("ramp.acceleration_steps_per_s2").fill("2000")
    expect(labels.filter(has_text="2,000")).to_have_count(1)


def test_a_short_move_is_planned_by_itself_or_cut_out_of_the_long_ramp(stepramp: StepRampPage) -> None:
    page = stepramp.page
    expect(page.locator("#short-moves")).to_be_hidden()
    page.locator("#shape").select_option("s_curve")
    stepramp.field("move.steps").fill("100")
    until(lambda: "too short" in page.locator('[data-path="move.steps"]').inner_text().lower())
    page.locator('#short-moves [data-value="any_move"]').click()
    expect(page.locator(".choice:has(#short-moves) .message")).to_contain_text("the acceleration jumps")
    assert stepramp.design()["move"] == {"steps": 100, "plan": "any_move"}
    page.locator('#short-moves [data-value="this_move"]').click()
    expect(page.locator(".choice:has(#short-moves) .message")).to_have_count(0)
    stepramp.field(SLEW_SPEED).fill("200")
    expect(page.locator('[data-path="move.steps"] .message')).to_have_count(0)


def test_methods_for_constant_acceleration_only_say_so_and_are_not_asked_for(stepramp: StepRampPage) -> None:
    page = stepramp.page
    chip = page.locator('.chip[data-method="first_order"]')
    until(lambda: "first_order-error" in stepramp.curves())
    page.locator("#shape").select_option("cosine")
    expect(chip).to_contain_text("constant a")
    expect(chip).to_have_attribute("title", "1st order is for constant acceleration only: this ramp’s shape is Cosine")
    until(lambda: "first_order-error" not in stepramp.curves())
    assert "newton-error" in stepramp.curves()
    page.locator("#shape").select_option("constant")
    until(lambda: "first_order-error" in stepramp.curves())


def test_acceleration_and_jerk_are_plotted_as_planned_over_every_axis(stepramp: StepRampPage) -> None:
    """In step with closed forms: to 1,000 steps/s at 5,000 steps/s² with 100,000 steps/s³ the onset takes 50 ms."""
    page = stepramp.page
    page.locator("#shape").select_option("s_curve")
    page.locator('#third-choice [data-value="jerk"]').click()
    until(lambda: "exact-jerk" in stepramp.curves())
    expect(page.locator(".plot-title", has_text="Planned jerk")).to_contain_text("steps/s³")
    for against in ("step", "time", "position"):
        page.locator(f'#axis-choice [data-value="{against}"]').click()
        page.wait_for_timeout(300)
        jerk = stepramp.curves()["exact-jerk"]
        assert min(jerk) == pytest.approx(-100_000, rel=0.01)
        assert sum(abs(each + 100_000) < 2000 for each in jerk) > 90, "the ramp's end and the begin of the other one"
    page.locator('#third-choice [data-value="acceleration"]').click()
    until(lambda: "exact-acceleration" in stepramp.curves())
    acceleration = stepramp.curves()["exact-acceleration"]
    assert (max(acceleration), min(acceleration)) == pytest.approx((5000, -5000), rel=1e-3)
    page.locator('.units [data-value="mm"]').click()
    until(lambda: max(stepramp.curves()["exact-acceleration"]) == pytest.approx(100, rel=1e-3))
    # What a table asks for at each of its rows would make a line of the curve that is looked at.
    assert stepramp.page.evaluate("() => document.querySelector('.figure').layout.yaxis3.range[1]") < 250


def test_ramps_of_different_shapes_are_compared_in_words(stepramp: StepRampPage) -> None:
    """Of T = Δ/a + a/j both ramps together take 2 (0.2 + 0.05) s, where constant acceleration takes 0.4 s."""
    page = stepramp.page
    page.locator("#keep").click()
    expect(page.locator(".comparison")).to_have_text(
        "Against the pinned design: same peak acceleration: as long, the same jerk."
    )
    page.locator("#shape").select_option("s_curve")
    expect(page.locator(".comparison")).to_contain_text("same peak acceleration: 2 % longer, 2.3 % of the jerk")
    page.locator("#forget").click()
    expect(page.locator(".comparison")).to_be_hidden()


def test_the_page_says_what_the_controller_makes_of_other_lengths(open_page: Callable[..., StepRampPage]) -> None:
    stepramp = open_page()
    page, note = stepramp.page, stepramp.page.locator(".choice:has(#short-moves) .choice-note")
    expect(note).to_be_hidden()
    page.locator("#shape").select_option("s_curve")
    # T = 0.25 s at 500 steps/s in the middle are 125 steps a side.
    expect(note).to_contain_text("the whole ramp of 250 steps. Shorter moves the controller cuts out of it")
    stepramp.field("move.steps").fill("100")
    # 50 = (v / a + a / j) v / 2 is v² + 250 v - 500,000 = 0.
    expect(note).to_contain_text("made for this move, up to 593 steps/s. Pushed, it is the ramp of every move")
    page.locator('#short-moves [data-value="any_move"]').click()
    expect(note).to_contain_text("cuts out of a ramp of 250 steps for this move")


POINTS = [[0, 1], [500, 1], [1000, 0.5]]


def test_drawn_points_are_dragged_nudged_added_and_removed_in_their_plot(
    open_page: Callable[..., StepRampPage], watch: Watch
) -> None:
    stepramp = open_page()
    page = stepramp.page
    watch.expected.append(REFUSED_VALUE)
    page.locator("#shape").select_option("drawn")
    chart, handles = page.locator(".drawn-chart"), page.locator(".drawn-chart .point")
    expect(handles).to_have_count(3)
    chart.scroll_into_view_if_needed()

    def points() -> list[list[float]]:
        found: list[list[float]] = stepramp.design()["ramp"]["shape"]["points"]
        return found

    def middle(index: int) -> tuple[float, float]:
        box = handles.nth(index).locator(".hit").bounding_box()
        assert box
        assert box["width"] >= 24, "a finger finds it"
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    (x0, _), (x1, y1), (x2, y2) = (middle(index) for index in range(3))
    per_step, per_part = (x2 - x0) / 1000, (y2 - y1) / 0.5
    page.mouse.move(x1 + 3, y1 + 2)
    page.mouse.down()
    page.mouse.move(x1 + 3 + 100 * per_step, y1 + 2 + 0.25 * per_part, steps=6)
    page.mouse.up()
    until(lambda: points()[1] == [pytest.approx(600, abs=3), pytest.approx(0.75, abs=0.01)])
    assert (points()[0], points()[2]) == (POINTS[0], POINTS[2])
    page.keyboard.press("Control+z")
    until(lambda: points() == POINTS)
    # Escape puts it back; no further than its neighbours and the least part it goes.
    page.mouse.move(x1, y1)
    page.mouse.down()
    page.mouse.move(x2 + 40, y2 + 400, steps=4)
    until(lambda: points()[1] == [pytest.approx(999), 0.001])
    page.keyboard.press("Escape")
    page.mouse.up()
    until(lambda: points() == POINTS)
    handles.nth(2).focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Shift+ArrowLeft")
    until(lambda: points()[2] == [900, 0.51])
    expect(page.locator("#drawn-points")).to_have_value("0  1\n500  1\n900  0.51")
    page.mouse.dblclick((x0 + x1) / 2, y1 + 0.4 * per_part)
    until(lambda: len(points()) == 4)
    assert points()[1] == [pytest.approx(250, abs=5), pytest.approx(0.6, abs=0.02)]
    page.keyboard.press("Delete")
    until(lambda: len(points()) == 3)
    page.keyboard.press("Delete")
    page.keyboard.press("Delete")
    until(lambda: len(points()) == 2)
    # A text that is refused has no plot, and is named as it was.
    stepramp.field(SLEW_SPEED).focus()
    page.locator("#drawn-points").fill("0 1\n400 0.8\nfast 0.2")
    expect(chart).to_be_hidden()
