"""The ten methods and the roundings: shown, hidden, chosen, kept."""

import json
import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Request, expect

from browser.stepramp_page import StepRampPage, until

SHOWN_AT_FIRST = {"exact", "first_order", "second_order", "compromise", "newton", "table"}


def chip(stepramp: StepRampPage, method: str) -> Locator:
    return stepramp.page.locator(f'.chip[data-method="{method}"]')


def drawn(stepramp: StepRampPage) -> set[str]:
    return {curve.removesuffix("-velocity") for curve in stepramp.curves() if curve.endswith("-velocity")}


def methods_of_the_server(stepramp: StepRampPage) -> list[str]:
    schema = stepramp.ask(stepramp.url, "GET", "openapi.json")["components"]["schemas"]["Method"]
    names: list[str] = schema["properties"]["name"]["enum"]
    return names


def test_every_method_of_the_server_can_be_shown_and_hidden(stepramp: StepRampPage) -> None:
    methods = methods_of_the_server(stepramp)
    chips = stepramp.page.locator(".chip[data-method]")
    assert [one.get_attribute("data-method") for one in chips.all()] == methods
    until(lambda: drawn(stepramp) == SHOWN_AT_FIRST)
    for method in methods:
        if method not in SHOWN_AT_FIRST:
            chip(stepramp, method).click()
    until(lambda: drawn(stepramp) == set(methods))
    for method in methods[1:]:
        expect(chip(stepramp, method)).to_contain_text("%")
    for number, method in enumerate(methods, start=1):
        chip(stepramp, method).click()
        expect(chip(stepramp, method)).to_have_attribute("aria-pressed", "false")
        until(lambda rest=set(methods[number:]): drawn(stepramp) == rest)


def test_every_method_of_the_server_can_be_chosen_and_is_explained(stepramp: StepRampPage) -> None:
    for method in reversed(methods_of_the_server(stepramp)):
        stepramp.page.locator("#method").select_option(method)
        until(lambda name=method: list(stepramp.curves())[-1] == f"{name}-error")
        label = stepramp.page.locator("#method option:checked").inner_text()
        until(lambda words=label: words in stepramp.figure_text("method"))
        expect(chip(stepramp, method)).to_have_attribute("data-active", "true")
        expect(chip(stepramp, method)).to_have_attribute("aria-pressed", "true")
        stepramp.page.locator("#method").blur()
        stepramp.page.locator("#method").focus()
        expect(stepramp.page.locator("#parameter-info")).to_contain_text(label)


def test_only_what_is_shown_is_asked_for(stepramp: StepRampPage) -> None:
    asked: list[str] = []

    def note(request: Request) -> None:
        if request.url.endswith("/curves"):
            asked.extend(json.loads(request.post_data or "")["methods"])

    until(lambda: drawn(stepramp) == SHOWN_AT_FIRST)
    stepramp.page.on("request", note)
    chip(stepramp, "austin").click()
    until(lambda: drawn(stepramp) == SHOWN_AT_FIRST | {"austin"})
    assert set(asked) == SHOWN_AT_FIRST | {"austin"}
    chip(stepramp, "austin").click()
    until(lambda: drawn(stepramp) == SHOWN_AT_FIRST)
    asked.clear()
    stepramp.edit_and_wait("ramp.slew_speed_steps_per_s", "1,100")
    assert set(asked) == SHOWN_AT_FIRST


def test_the_rounding_changes_what_is_plotted(stepramp: StepRampPage) -> None:
    page = stepramp.page
    delays = {}
    for rounding in ("floor", "carry", "nearest"):
        before = stepramp.curves()["exact-delay"]
        page.locator(f'#rounding [data-value="{rounding}"]').click()
        expect(page.locator('#rounding [aria-pressed="true"]')).to_have_text(rounding)
        until(lambda old=before: stepramp.curves()["exact-delay"] != old)
        delays[rounding] = stepramp.curves()["exact-delay"]
    assert all(down <= near for down, near in zip(delays["floor"], delays["nearest"], strict=True))
    page.locator("#rounding").hover()
    expect(page.locator("#parameter-info")).to_contain_text("Rounding")


def test_a_reload_keeps_the_methods_shown_and_the_rounding(stepramp: StepRampPage) -> None:
    for method in ("tuned", "table", "exact"):
        chip(stepramp, method).click()
    stepramp.page.locator("#method").select_option("midpoint")
    stepramp.page.locator('#rounding [data-value="carry"]').click()
    kept = {"midpoint", "first_order", "second_order", "compromise", "tuned", "newton"}
    until(lambda: drawn(stepramp) == kept)
    stepramp.reload()
    until(lambda: drawn(stepramp) == kept)
    pressed = stepramp.page.locator('.chip[aria-pressed="true"]').all()
    assert {one.get_attribute("data-method") for one in pressed} == kept
    expect(stepramp.page.locator('#rounding [aria-pressed="true"]')).to_have_text("carry")


def test_a_method_that_can_t_says_so_where_it_stands(stepramp: StepRampPage) -> None:
    # In float32, Newton's method goes to infinity over 1.5 million steps.
    stepramp.edit_and_wait("ramp.acceleration_steps_per_s2", "0.333")
    expect(chip(stepramp, "newton")).to_contain_text("fails")
    why = re.compile(r"^Arithmetic is 'float32'; allowed: float64 for this ramp: over 1,501,501 steps")
    expect(chip(stepramp, "newton")).to_have_attribute("title", why)
    until(lambda: drawn(stepramp) == SHOWN_AT_FIRST - {"newton"})
    # Chosen, it is refused where its arithmetic is chosen, and there it is mended.
    stepramp.page.locator("#method").select_option("newton")
    stepramp.page.locator('#arithmetic [data-value="float32"]').click()
    message = stepramp.page.locator(".choice:has(#arithmetic) .message")
    expect(message).to_contain_text("allowed: float64 for this ramp")
    stepramp.page.locator('#arithmetic [data-value="float64"]').click()
    expect(message).to_have_count(0)
    until(lambda: "newton" in drawn(stepramp))


def test_kept_names_that_mean_nothing_are_left_out(stepramp: StepRampPage) -> None:
    stepramp.keep(shown=["newton", "third_order", "exact"])
    stepramp.reload()
    until(lambda: drawn(stepramp) == {"exact", "newton"})


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_no_two_lines_look_alike(open_page: Callable[..., StepRampPage], theme: str) -> None:
    script = """() => document.querySelector('.figure').data.filter((trace) => trace.meta === 'velocity')
        .map((trace) => [trace.name, trace.line.color, trace.line.dash])"""
    lines = open_page(theme=theme).page.evaluate(script)
    assert len({colour for _, colour, _ in lines}) == len(lines) == 10
    # The reference is solid, and a table's staircase needs no dash.
    assert {name for name, _, dash in lines if dash == "solid"} == {"exact", "table"}
    dashes = {name: dash for name, _, dash in lines if dash != "solid"}
    assert len(set(dashes.values())) == len(dashes)


@pytest.mark.parametrize("size", [(1440, 900), (1024, 768), (768, 1024), (390, 844)])
def test_the_legend_and_the_reading_of_all_methods_fit(
    open_page: Callable[..., StepRampPage], size: tuple[int, int]
) -> None:
    stepramp = open_page(size)
    methods = methods_of_the_server(stepramp)
    for method in methods:
        if method not in SHOWN_AT_FIRST:
            chip(stepramp, method).click()
    until(lambda: all("%" in chip(stepramp, method).inner_text() for method in methods[1:]))
    stepramp.page.locator("#method").select_option("compromise")  # the longest name
    boxes = [one.bounding_box() for one in stepramp.page.locator(".chip").all()]
    rows = {box["y"] for box in boxes if box}
    too_full = """() => [...document.querySelectorAll('.chip, .chip span')]
        .filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.textContent)"""
    assert stepramp.page.evaluate(too_full) == []
    legend = "() => { const it = document.querySelector('.legend'); return it.scrollWidth > it.clientWidth; }"
    scrolls = stepramp.page.evaluate(legend)
    assert scrolls == (size[0] < 700), "a phone scrolls it sideways"
    assert len(rows) == (1 if scrolls else 2 if size[0] > 1000 else 4)
    stepramp.page.locator(".scope").hover()
    tooltip = stepramp.page.locator(".tooltip").bounding_box()
    assert tooltip
    assert 0 <= tooltip["x"] < tooltip["x"] + tooltip["width"] <= size[0]
