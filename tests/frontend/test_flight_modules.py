"""Targets and speeds that change in flight: what the page asks, and what it makes of the answer."""

import itertools
from typing import Any

import pytest

from designs import document
from frontend.modules import Modules

TOLD = [{"atMs": 0, "kind": "target", "value": 5}, {"atMs": 30, "kind": "target", "value": 2}]
# At 1,000 Hz: four steps out, at once back to 2, which it has passed; a rest, and later on to 3.
ANSWER = {
    "timer_hz": 1000,
    "at_ticks": [0, 10, 20, 32, 52, 70, 200],
    "interval_ticks": [10, 10, 12, 20, 18, 20, 30],
    "position_steps": [1, 2, 3, 4, 3, 2, 3],
    "direction": [1, 1, 1, 1, -1, -1, 1],
    "rests": [{"at_s": 0.09, "position_steps": 2}, {"at_s": 0.23, "position_steps": 3}],
    "told_position_steps": [0, 3, 2],
}
AGAIN = {"atMs": 200, "kind": "target", "value": 3}


def flight(modules: Modules, told: list[Any], **answer: Any) -> Any:
    return modules.call("model/flight.js", "flightOf", {**ANSWER, **answer}, told)


def text(modules: Modules, told: list[Any], length: str = "steps", **answer: Any) -> str:
    units = {"length": length, "time": "s"}
    return modules.call("model/flight.js", "flightText", flight(modules, told, **answer), units, document())


def test_what_is_typed_is_asked_in_seconds_and_text_as_it_is(modules: Modules) -> None:
    told = [{"atMs": 336.1, "kind": "target", "value": 5}, {"atMs": "soon", "kind": "speed", "value": -20}]
    assert modules.call("model/flight.js", "commandsOf", told) == [
        {"at_s": 0.3361, "target_steps": 5},
        {"at_s": "soon", "speed_steps_per_s": -20},
    ]


def test_the_way_stands_still_from_a_rest_to_the_next_step(modules: Modules) -> None:
    found = flight(modules, [*TOLD, AGAIN])
    assert found["steps"]["at_s"] == [0, 0, 0.01, 0.02, 0.032, 0.052, 0.07, 0.09, 0.2, 0.23]
    assert found["steps"]["position"] == [0, 1, 2, 3, 4, 3, 2, 2, 3, 3]
    assert found["steps"]["speed"] == pytest.approx([0, 100, 100, 1000 / 12, 50, -1000 / 18, -50, 0, 1000 / 30, 0])
    assert found["end_s"] == 0.23
    assert flight(modules, [*TOLD, {**AGAIN, "atMs": 400}])["end_s"] == 0.4


def test_what_is_passed_and_what_is_only_turned_from(modules: Modules) -> None:
    rests = "At rest at 2 steps after 90.0 ms, then at 3 steps after 230.0 ms. Fastest: 100 steps/s, after 0.0 ms."
    # Behind it when it was told: nothing is passed. To go on after a rest is no turn.
    assert text(modules, [*TOLD, AGAIN]) == f"It turns at 4 steps after 32.0 ms. {rests}"
    before = {"told_position_steps": [0, 2, 2]}
    passing = text(modules, [*TOLD, AGAIN], **before)
    assert passing == f"It passes 2 steps, turns at 4 steps after 32.0 ms and comes back. {rests}"
    # 8 mm a turn of 400 steps.
    assert "passes 0.04000 mm, turns at 0.08000 mm after 32.0 ms" in text(modules, [*TOLD, AGAIN], "mm", **before)


def test_many_turns_and_rests_are_counted(modules: Modules) -> None:
    steps = 12
    there_and_back = {
        "at_ticks": list(range(steps)),
        "interval_ticks": [1] * steps,
        "position_steps": [1, 0] * 6,
        "direction": [1, -1] * 6,
        "rests": [{"at_s": (steps + n) / 1000, "position_steps": 0} for n in range(6)],
        "told_position_steps": [0],
    }
    told = text(modules, TOLD[:1], **there_and_back)
    assert told.count("It turns") == 4
    assert "And 7 turns more." in told
    assert "And 2 rests more." in told


def test_no_step_is_said(modules: Modules) -> None:
    nothing: dict[str, Any] = {name: [] for name in ANSWER if name != "timer_hz"}
    assert text(modules, [{**TOLD[0], "value": 0}], **nothing) == "It has nowhere to go."


@pytest.mark.parametrize(
    ("span", "texts"),
    [
        ((0, 400, 4), ["0", "100", "200", "300", "400"]),
        ((0, 1.1, 6), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0", "1.2"]),
        ((-3, 7, 4), ["−5", "0", "5", "10"]),
        ((0, 0.003, 4), ["0.000", "0.001", "0.002", "0.003"]),
        ((0, 999_999, 4), ["0", "500,000", "1,000,000"]),
    ],
)
def test_round_values_for_an_axis(modules: Modules, span: tuple[float, float, int], texts: list[str]) -> None:
    assert [one["text"] for one in modules.call("model/numbers.js", "roundParts", *span)] == texts


def test_stairs_have_gaps_where_nothing_is_wanted(modules: Modules) -> None:
    script = """async () => { const made = (tag) => ({tag, children: [], attributes: {},
            setAttribute(name, value) { this.attributes[name] = value; },
            append(...more) { this.children.push(...more); }, replaceChildren() { this.children = []; }});
        const own = globalThis.document;
        globalThis.document = {createElementNS: (_, tag) => made(tag)};
        try {
            const {createTimeChart} = await import('/ui/time_chart.js');
            const chart = createTimeChart(136);
            chart.show({end: 364, low: 0, high: 98, times: [], levels: [], dots: [],
                wanted: {x: [0, 100, 200, 364], y: [10, NaN, 20, 20]}, way: {x: [0, 50], y: [0, 98]}}, 'Way');
            return [chart.element.attributes['aria-label'], ...chart.element.children.map((one) => one.attributes.d)];
        } finally { globalThis.document = own; } }"""
    assert modules.evaluate(script) == ["Way", "M44 100H144M244 90H408V90", "M44 110H94V12"]


def chart_texts(modules: Modules, script: str) -> Any:
    """Return what a script makes of chart elements that plain objects stand in for."""
    elements = """const made = (tag) => ({tag, children: [], append(...more) { this.children.push(...more); },
        replaceChildren(...more) { this.children = more; }, setAttribute(name, value) { this[name] = value; }});
        const own = globalThis.document;
        globalThis.document = {createElementNS: (_, tag) => made(tag)};"""
    return modules.evaluate(f"async () => {{ {elements} try {{ {script} }} finally {{ globalThis.document = own; }} }}")


def test_numbers_of_many_commands_never_lie_over_each_other(modules: Modules) -> None:
    """42 commands in 364 px: a line each, and the numbers that have room, 5.8 px a digit, 3 px apart."""
    marks = chart_texts(
        modules,
        """const {createTimeChart} = await import('/ui/time_chart.js');
        const chart = createTimeChart(136);
        const none = {x: [0, 41], y: [0, 0]};
        chart.show({end: 41, low: 0, high: 1, times: [], levels: [], wanted: none, way: none, dots: [],
            marks: Array.from({length: 42}, (_, at) => ({at, text: String(at + 1)}))});
        const texts = chart.element.children.filter(({tag}) => tag === 'text');
        return [chart.element.children.filter((one) => one.class === 'mark').length,
            texts.map(({x, textContent}) => [x, textContent])];""",
    )
    lines, numbers = marks
    assert lines == 42
    assert numbers[0][1] == "1"
    for (left, text), (right, other) in itertools.pairwise(numbers):
        assert float(right) - float(left) >= 5.8 * (len(text) + len(other)) / 2 + 3
    assert len(numbers) > 20


def test_a_label_that_is_wider_than_its_room_is_squeezed_into_it(modules: Modules) -> None:
    """Left of 44 px there are 34 for it: six digits of 5.8 px are too wide, five are not."""
    labels = chart_texts(
        modules,
        """const {gridLine} = await import('/ui/chart.js');
        return ['10000', '100000', '\u2212500,000'].map((text) => {
            const [, label] = gridLine(text, 44, 400, 20);
            return [label.textContent, label.textLength ?? null, label.lengthAdjust ?? null]; });""",
    )
    assert labels == [
        ["10000", None, None],
        ["100000", "34", "spacingAndGlyphs"],
        ["\u2212500,000", "34", "spacingAndGlyphs"],
    ]
