"""The choice of a ramp's shape on the page: its own parameters, what is drawn, short moves, what is refused."""

from playwright.sync_api import expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

JERK = "ramp.shape.jerk_steps_per_s3"
JERK_DOWN = "ramp.shape.deceleration_jerk_steps_per_s3"


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
