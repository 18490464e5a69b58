"""Targets and speeds that change in flight, in the page: against what POST /retarget says of the same commands."""

import re
from itertools import pairwise
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from browser.conftest import Watch
from browser.stepramp_page import REFUSED_VALUE, SLEW_SPEED, StepRampPage, until

LEFT, RIGHT_MARGIN, TOP, BOTTOM = 44, 12, 12, 136 - 26
"""The plane of a chart, in its own units."""


def opened(stepramp: StepRampPage) -> Locator:
    stepramp.page.locator("#open-flight").click()
    expect(stepramp.page.locator("#flight-result")).to_contain_text("At rest")
    return stepramp.page.locator("#flight-dialog")


def entry(dialog: Locator, what: str, place: int) -> Locator:
    return dialog.get_by_label(f"{what} of command {place}", exact=True)


def tell(dialog: Locator, place: int, at_ms: str, target: str) -> None:
    entry(dialog, "Time", place).fill(at_ms)
    entry(dialog, "Target", place).fill(target)


def retargeted(stepramp: StepRampPage, *commands: dict[str, Any]) -> dict[str, Any]:
    return stepramp.ask(
        stepramp.url, "POST", "retarget", {"design": stepramp.design(), "commands": commands, "max_points": None}
    )


def turns_of(played: dict[str, Any]) -> list[tuple[float, int]]:
    """Return when and where the motor turned: no position is farther than those around it by chance."""
    places = played["position_steps"]
    turned = [
        at for at in range(1, len(places) - 1) if (places[at] - places[at - 1]) * (places[at + 1] - places[at]) < 0
    ]
    return [(played["at_ticks"][at] / played["timer_hz"], places[at]) for at in turned]


def corners(chart: Locator) -> list[tuple[float, float]]:
    """Return the corners of a chart's line."""
    path = chart.locator(".line").get_attribute("d") or ""
    x = y = 0.0
    points = []
    for kind, number in re.findall(r"([MHV ])(-?[\d.]+)", path):
        x, y = (float(number), y) if kind in "MH" else (x, float(number))
        if kind != "M":
            points.append((x, y))
    return points


def test_an_s_curve_that_is_told_to_turn_round(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#shape").select_option("s_curve")
    until(lambda: "shape" in stepramp.design()["ramp"])
    dialog = opened(stepramp)
    # As it is proposed: out as far as the move goes, and back at half of its time.
    expect(entry(dialog, "Time", 1)).to_have_value("0")
    expect(entry(dialog, "Target", 1)).to_have_value("500")
    expect(entry(dialog, "Target", 2)).to_have_value("0")
    tell(dialog, 1, "0", "400")
    tell(dialog, 2, "300", "230")
    played = retargeted(stepramp, {"at_s": 0, "target_steps": 400}, {"at_s": 0.3, "target_steps": 230})
    [(turned_s, turned)] = turns_of(played)
    [rest] = played["rests"]
    told = dialog.locator("#flight-result")
    expect(told).to_contain_text(
        f"It passes 230 steps, turns at {turned} steps after {turned_s * 1000:,.1f} ms and comes back. "
        f"At rest at 230 steps after {rest['at_s'] * 1000:,.1f} ms."
    )
    assert turned > 230
    way, speed = dialog.locator("svg.small-chart").all()
    fastest = played["timer_hz"] / min(b - a for a, b in pairwise(played["at_ticks"]))
    expect(told).to_contain_text(f"Fastest: {fastest:,.0f} steps/s")
    for chart in (way, speed):
        expect(chart.locator(".mark")).to_have_count(2)
        expect(chart.locator(".dot")).to_have_count(1)
    # The line of positions: from 0 at the bottom over the turn, which is its top, to the dot at rest.
    drawn = corners(way)
    # As wide as it is shown.
    width = float((way.get_attribute("viewBox") or "").split()[2])
    x_of_s = (width - RIGHT_MARGIN - LEFT) / rest["at_s"]
    highest = min(drawn, key=lambda corner: corner[1])
    assert highest[0] == pytest.approx(LEFT + turned_s * x_of_s, abs=0.02)
    per_step = (BOTTOM - highest[1]) / turned
    for at, place in list(zip(played["at_ticks"], played["position_steps"], strict=True))[::40]:
        point = (LEFT + at / played["timer_hz"] * x_of_s, BOTTOM - place * per_step)
        assert min(max(abs(point[0] - x), abs(point[1] - y)) for x, y in drawn) < 0.02
    assert float(way.locator(".dot").get_attribute("cy") or 0) == pytest.approx(BOTTOM - 230 * per_step, abs=0.02)


def test_speeds_one_after_another_until_the_motor_rests(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    dialog = opened(stepramp)
    for place, speed in ((1, "800"), (2, "-400")):
        dialog.get_by_label(f"What command {place} is").select_option("speed")
        entry(dialog, "Speed", place).fill(speed)
    expect(dialog.locator(".problem", has_text="Speed")).to_contain_text("0 in the last command, or a target")
    expect(dialog.locator("svg.small-chart").first).to_be_hidden()
    dialog.locator("#flight-add").click()
    dialog.get_by_label("What command 3 is").select_option("speed")
    entry(dialog, "Time", 3).fill("1000")
    expect(dialog.locator("#flight-result")).to_contain_text("At rest at ")
    time = float(entry(dialog, "Time", 2).input_value()) / 1000
    speeds = [{"at_s": at_s, "speed_steps_per_s": speed} for at_s, speed in ((0, 800), (time, -400), (1, 0))]
    played = retargeted(stepramp, *speeds)
    [(turned_s, turned)] = turns_of(played)
    [rest] = played["rests"]
    assert rest["position_steps"] < turned
    expect(dialog.locator("#flight-result")).to_contain_text(
        f"It turns at {turned} steps after {turned_s * 1000:.1f} ms. "
        f"At rest at {rest['position_steps']} steps after {rest['at_s'] * 1000:,.1f} ms. Fastest: 800 steps/s"
    )
    dialog.get_by_label("Remove command 2").click()
    expect(dialog.locator("#flight-result")).not_to_contain_text("turns")
    expect(dialog.locator(".flight-row")).to_have_count(2)


def test_what_is_refused_is_told_at_its_row_in_the_units_that_are_shown(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page = stepramp.page
    page.locator(".units [data-value=mm]").click()
    dialog = opened(stepramp)
    # 8 mm a turn of 400 steps.
    expect(entry(dialog, "Target", 1)).to_have_value("10")
    expect(dialog.locator("h3").first).to_have_text("Position over time, mm")
    expect(dialog.locator("#flight-result")).to_contain_text("At rest at 0 mm")
    entry(dialog, "Time", 1).fill("500")
    rows = dialog.locator(".flight-row")
    expect(rows.nth(1).locator(".problem").first).to_contain_text(
        "Time is 336 ms (0.336 s); allowed: at least 500 ms, when the command before it comes"
    )
    expect(entry(dialog, "Time", 2)).to_have_attribute("aria-invalid", "true")
    entry(dialog, "Time", 1).fill("soon")
    expect(rows.nth(0).locator(".problem").first).to_contain_text(
        "Time is 'soon'; allowed: a number from 0 to 1,000,000,000 ms"
    )
    entry(dialog, "Time", 1).fill("0")
    entry(dialog, "Target", 1).fill("1e7")
    expect(rows.nth(0).locator(".problem").last).to_contain_text(
        "Target is 10,000,000 mm (500,000,000 steps); allowed: a number from -200,000 to 200,000 mm"
    )
    entry(dialog, "Target", 1).fill("10")
    expect(dialog.locator("#flight-result")).to_contain_text("At rest")
    dialog.get_by_label("What command 1 is").select_option("speed")
    entry(dialog, "Speed", 1).fill("30")
    expect(rows.nth(0).locator(".problem").last).to_contain_text(
        "Speed is 30 mm/s (1,500 steps/s); allowed: a number from -20 to 20 mm/s, the slew speed of the ramp"
    )


def test_commands_are_kept_and_undone_and_follow_the_design(stepramp: StepRampPage) -> None:
    page = stepramp.page
    dialog = opened(stepramp)
    before = stepramp.design()
    target = entry(dialog, "Target", 1)
    target.focus()
    page.keyboard.type("320")
    expect(target).to_have_value("320")
    page.keyboard.press("Control+z")
    expect(target).not_to_have_value("320")
    assert stepramp.design() == before
    target.fill("450")
    told = dialog.locator("#flight-result")
    was = told.inner_text()
    dialog.get_by_role("button", name="Close").last.click()
    expect(dialog).to_be_hidden()
    stepramp.edit_and_wait(SLEW_SPEED, "700")
    stepramp.kept()
    stepramp.reload()
    opened(stepramp)
    expect(target).to_have_value("450")
    expect(told).to_contain_text("Fastest: 700 steps/s")
    # As the design changes behind the dialog.
    page.evaluate(
        "document.querySelector('.parameter[data-path=\"ramp.slew_speed_steps_per_s\"] input.number').value = '600'"
    )
    stepramp.field(SLEW_SPEED).dispatch_event("input")
    expect(told).to_contain_text("Fastest: 600 steps/s")
    assert told.inner_text() != was


def test_a_long_play_is_drawn_of_no_more_points_than_can_be_seen(stepramp: StepRampPage) -> None:
    dialog = opened(stepramp)
    tell(dialog, 1, "0", "1,000,000")
    tell(dialog, 2, "500,000", "-500,000")
    expect(dialog.locator("#flight-result")).to_contain_text("At rest at −500,000 steps")
    path = dialog.locator("svg.small-chart .line").first.get_attribute("d") or ""
    assert path.count("H") < 10_000
