"""Designs side by side: one pinned to compare with, and the axes of one machine over one time."""

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import expect

from browser.stepramp_page import ACCELERATION, SLEW_SPEED, StepRampPage, call, until


def traces(stepramp: StepRampPage, start: str) -> dict[str, dict[str, Any]]:
    """Return the visible traces whose names begin so."""
    script = """(start) => Object.fromEntries(document.querySelector('.figure').data
        .filter((one) => one.visible && one.uid.startsWith(start)).map((one) => [one.uid,
            {x: Array.from(one.x), y: Array.from(one.y), dash: one.line.dash, colour: one.line.color}]))"""
    return stepramp.page.evaluate(script, start)


def kept_figure(stepramp: StepRampPage, name: str) -> str:
    return stepramp.page.locator(f'[data-figure="{name}"] .pinned').inner_text()


def test_the_pinned_design_stays_as_a_ghost_beneath_and_in_the_summary(stepramp: StepRampPage) -> None:
    page = stepramp.page
    before = stepramp.curves()
    expect(page.locator("#forget")).to_be_hidden()
    page.locator("#keep").click()
    until(lambda: len(traces(stepramp, "pinned-")) == 3)
    stepramp.edit_and_wait(ACCELERATION, "20000")
    ghost = traces(stepramp, "pinned-")
    # The exact ramp of 5,000 steps/s², closed form (17), and the reference of all errors.
    for step, speed in zip(ghost["pinned-velocity"]["x"][:100], ghost["pinned-velocity"]["y"][:100], strict=True):
        assert speed == pytest.approx((2 * 5000 * step) ** 0.5, rel=1e-3)
    # What is compared keeps every point of the motion, too.
    assert set(before["exact-delay"]) <= set(ghost["pinned-delay"]["y"])
    assert ghost["pinned-velocity"]["dash"] == "4px, 3px"
    order = page.evaluate("() => document.querySelector('.figure').data.filter((one) => one.visible)[0].uid")
    assert order == "pinned-velocity", "beneath the others"
    until(lambda: kept_figure(stepramp, "duration").replace("\u202f", " ").startswith("671.8 ms"))
    assert "671.8" not in page.locator('[data-figure="duration"] .value').inner_text()
    assert kept_figure(stepramp, "peak").startswith("1,000")
    page.reload()
    stepramp.wait_for_plots()
    until(lambda: len(traces(stepramp, "pinned-")) == 3)
    page.locator("#forget").click()
    until(lambda: traces(stepramp, "pinned-") == {})
    expect(page.locator('[data-figure="duration"] .pinned')).to_be_hidden()


def test_the_summary_holds_the_servers_figures_and_marks_more_than_a_motor_bears(stepramp: StepRampPage) -> None:
    page = stepramp.page
    value = page.locator('[data-figure="acceleration"] .value')
    expect(value).not_to_have_class("value high")
    page.locator("#method").select_option("first_order")
    examples = stepramp.ask(stepramp.url, "GET", "examples")["examples"]
    design = next(one["design"] for one in examples if one["title"] == "Lead-screw stage")
    design["method"] = {**design["method"], "name": "first_order", "arithmetic": "float32"}
    [errors] = stepramp.ask(stepramp.url, "POST", "errors", {"design": design, "methods": ["first_order"]})["methods"]
    implied = errors["peak_acceleration_steps_per_s2"]
    assert abs(implied["value"]) > 1.25 * 5000, "for this test"
    until(lambda: f"step {implied['step']:,}" in page.locator('[data-figure="acceleration"]').inner_text())
    shown = float(value.inner_text().split()[0].replace(",", "").replace("−", "-"))
    assert shown == pytest.approx(implied["value"], abs=0.51)
    expect(value).to_have_class("value high")
    landing = page.locator('[data-figure="landing"] .value').inner_text().split()[0].replace(",", "")
    assert float(landing.replace("−", "-")) == pytest.approx(errors["landing_error_steps_per_s"], abs=0.51)


def test_all_axes_are_drawn_over_one_time(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#add-axis").click()
    until(lambda: "500 of" not in page.locator("#axes").inner_text())
    stepramp.field(SLEW_SPEED).fill("500")
    page.locator('#axes-choice [data-value="all"]').click()
    until(lambda: len(traces(stepramp, "axis-")) == 4)
    drawn = traces(stepramp, "axis-")
    assert traces(stepramp, "exact") == {}
    assert drawn["axis-0-velocity"]["colour"] != drawn["axis-1-velocity"]["colour"]
    until(lambda: max(traces(stepramp, "axis-1-velocity")["axis-1-velocity"]["y"]) == pytest.approx(500))
    assert max(drawn["axis-0-velocity"]["y"]) == pytest.approx(1000)
    until(lambda: stepramp.x_axis()["title"] == "time since the start, s")
    # The slower one, by (5) and (7): 25 steps up and down by 5,000 steps/s² and 450 at 500 steps/s.
    # The last pulse comes before the last delay.
    ramp = [1 / (2 * 5000 * step) ** 0.5 for step in range(1, 26)]
    last = 2 * sum(ramp) + 450 / 500 - ramp[0]
    assert traces(stepramp, "axis-1")["axis-1-delay"]["x"][-1] == pytest.approx(last, rel=1e-3)
    box = page.locator(".scope").bounding_box()
    assert box
    page.mouse.move(box["x"] + 200, box["y"] + 150)
    expect(page.locator(".tooltip")).to_contain_text("1 Lead-screw stage")
    page.locator('#axes-choice [data-value="one"]').click()
    until(lambda: traces(stepramp, "axis-") == {} and len(traces(stepramp, "exact")) == 3)


ANSWER = {
    "design": {
        "axis": {"full_steps_per_rev": 200, "microsteps": 2, "travel_per_rev": 8, "travel_unit": "mm"},
        "timer": {"frequency_hz": 2e6},
        "method": {"name": "exact"},
        "move": {"steps": -500},
    },
    "units": {"length": "mm", "time": "s"},
    "profiles": {
        "exact": {"summary": {"duration_s": 2, "steps": 500, "accelerate_steps": 100, "decelerate_steps": 100}}
    },
    "errors": {},
}


@pytest.mark.parametrize(
    ("axis", "x"), [("step", [1, 100]), ("time", [0, 500]), ("position", [-0.02, -2])]
)  # 400 steps a turn of 8 mm; ms below ten seconds
def test_what_was_measured_lies_over_its_plan(
    open_page: Callable[..., StepRampPage], axis: str, x: list[float]
) -> None:
    page = open_page().page
    move = {"step": [1, 100], "time_s": [0, 0.5], "speed_steps_per_s": [100, 800], "delay_us": [10_000, 1_250],
            "deviation_us": [0, 3], "length": 100}  # fmt: skip
    measured = call(page, "plotting/curves.js", "measuredOver", ANSWER, axis, move)
    assert measured == {"x": pytest.approx(x), "velocity": pytest.approx([2, 16]), "delay": [10_000, 1_250],
                        "deviation": [0, 3]}  # fmt: skip
    samples = {"time_s": [0, 0.5], "position": [-1, -100], "speed": [-100, -800], "length": 100}
    live = call(page, "plotting/curves.js", "liveOver", ANSWER, axis, samples)
    assert live == {"x": pytest.approx(x), "velocity": pytest.approx([2, 16])}


def test_a_move_of_another_length_lies_over_the_ramps_of_the_plan(open_page: Callable[..., StepRampPage]) -> None:
    """A plan of 500 steps, 100 of them up and 100 down; a move of 300 slews for 100 steps instead of 300."""
    page = open_page().page
    steps, places = [50, 100, 150, 200, 250, 300], [50, 100, 250, 400, 450, 500]
    same = {"time_s": [0.1] * 6, "speed": [1] * 6, "position": steps}
    assert call(page, "plotting/curves.js", "liveOver", ANSWER, "step", {**same, "length": 300})["x"] == places
    assert call(page, "plotting/curves.js", "liveOver", ANSWER, "step", {**same, "length": None})["x"] == steps
    move = {
        "step": steps,
        "time_s": [0.1] * 6,
        "speed_steps_per_s": [1] * 6,
        "delay_us": [1] * 6,
        "deviation_us": [0] * 6,
    }
    assert call(page, "plotting/curves.js", "measuredOver", ANSWER, "step", {**move, "length": 300})["x"] == places
    assert call(page, "plotting/curves.js", "measuredOver", ANSWER, "step", {**move, "length": None})["x"] == steps
