"""The page's modules that know no page: numbers, figures, curves."""

import json
import math

import pytest

from designs import document
from frontend.modules import Modules


@pytest.mark.parametrize(
    ("text", "entry"),
    [
        ("1,000,000", 1_000_000),
        ("1 000", 1000),
        ("1’000.5", 1000.5),
        ("-5", -5),
        ("−5", -5),
        (" 2e6 ", 2_000_000),
        (".5", 0.5),
        ("1,5", "1,5"),
        ("1,0000", "1,0000"),
        ("0,500", "0,500"),
        ("-0,500,000", "-0,500,000"),
        ("100,500", 100_500),
        ("12 34", "12 34"),
        ("1e400", "1e400"),
        ("NaN", "NaN"),
        ("Infinity", "Infinity"),
        ("0x10", "0x10"),
        ("", ""),
        ("abc", "abc"),
    ],
)
def test_entries_are_numbers_or_stay_as_typed(modules: Modules, text: str, entry: float | str) -> None:
    assert modules.call("model/numbers.js", "parseEntry", text) == entry


@pytest.mark.parametrize(
    ("text", "hint"),
    [("0,500", "0.500"), (" 1,5 ", "1.5"), ("−0,25", "-0.25"), ("1,5,", ""), ("1.5", ""), ("fast", "")],
)
def test_a_decimal_comma_is_refused_with_words_that_a_point_is_expected(modules: Modules, text: str, hint: str) -> None:
    rejection = {"field": "ramp.slew_speed_steps_per_s", "value": text, "allowed": "a number", "message": "Wrong."}
    script = """async (rejection) => (await import('/model/messages.js')).sortMessages([rejection], [])
        .fields.get(rejection.field).text"""
    told = modules.evaluate(script, rejection)
    # What is a number as it stands is told as one.
    refused = f"Slew speed is {text if text == '1.5' else repr(text)}; allowed: a number."
    assert told == (refused if hint == "" else f"{refused} A point is expected for the comma: {hint}.")


@pytest.mark.parametrize(
    ("unit", "frequency", "words"),
    [
        ("ticks", "0,500", "stay in µs: the timer’s frequency is “0,500”"),
        ("ticks", "", "frequency is “”"),
        ("us", -5, "stay in ticks: the timer’s frequency is -5;"),
        ("us", 0, "frequency is 0;"),
        ("ticks", 50, "at 50 Hz that of row 2 would be 0 ticks"),
        ("ticks", 1000, ""),
        ("us", 1000, ""),
    ],
)
def test_delays_are_not_converted_where_they_would_be_lost(
    modules: Modules, unit: str, frequency: object, words: str
) -> None:
    rows = [[10, "fast"], [20, 5000], [30, 15000]]
    told = modules.call("model/design.js", "conversionProblem", rows, unit, frequency)
    assert (told == "") == (words == "")
    assert words in told


def test_a_formatted_entry_reads_back_as_the_same_number(modules: Modules) -> None:
    for value in (0, 1, 999, 1000, 1234567, -1234.5, 0.001, 1e21, 16_000_000.25):
        assert (
            modules.call("model/numbers.js", "parseEntry", modules.call("model/numbers.js", "formatEntry", value))
            == value
        )


SCENE = """async (change) => {
    const {figureOf, layoutOf, tracesOf} = await import('/plotting/figure.js');
    const {curveOf} = await import('/plotting/curves.js');
    const profile = {step: [1, 2, 3, 4], intervals_ticks: [20000, 4000, 4000, 20000], time_s: [0, .01, .012, .014],
        position_steps: [1, 2, 3, 4], speed_steps_per_s: [100, 500, 500, 100],
        phases: [{name: 'accelerate', first_step: 1, last_step: 2}, {name: 'decelerate', first_step: 3, last_step: 4}],
        summary: {steps: 4, duration_s: .024, peak_speed_steps_per_s: 500, accelerate_steps: 2, slew_steps: 0,
            decelerate_steps: 2}, warnings: []};
    const answer = {design: {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'},
        timer: {frequency_hz: 2e6}, method: {name: change.method ?? 'first_order'}},
        profiles: {exact: profile, first_order: profile, table: profile}, failures: {},
        errors: {exact: {step: profile.step, relative_error: [0, 0, 0, 0]},
            first_order: {step: profile.step, relative_error: [0, 0, 0, -.25]},
            table: {step: profile.step, relative_error: [0, 0, 0, .1]}}};
    const scene = {answer, against: 'step', view: 'whole', only: 'velocity', zoom: null, compact: false,
        shown: new Set(['exact', 'first_order', 'table']), size: {width: 800, height: 600}, colours: {}, dashes: {},
        font: 'serif', ...change};
    scene.shown = new Set(scene.shown);
    scene.curves = Object.fromEntries(['exact', 'first_order', 'table']
        .map((name) => [name, curveOf(answer, name, scene.against)]));
    const {lines, frame} = figureOf(scene);
    return {traces: tracesOf(lines), layout: layoutOf(scene, frame)};
}"""


def test_traces_come_in_three_a_method_the_chosen_one_last_and_widest(modules: Modules) -> None:
    all_traces = modules.evaluate(SCENE, {"method": "first_order", "dashes": {"table": "5px, 3px"}})["traces"]
    traces = [trace for trace in all_traces if trace["visible"]]
    assert [trace["uid"] for trace in traces] == [
        f"{method}-{plot}" for method in ("exact", "table", "first_order") for plot in ("velocity", "delay", "error")
    ]
    assert max(trace["line"]["width"] for trace in traces) == traces[-1]["line"]["width"]
    assert [trace["yaxis"] for trace in traces[:3]] == ["y", "y2", "y3"]
    assert traces[0]["y"] == [100, 500, 500, 100]
    assert traces[1]["y"] == [10000, 2000, 2000, 10000], "in µs"
    assert [trace["line"].get("dash") for trace in traces[2:5]] == [None, "5px, 3px", "5px, 3px"]
    assert traces[8]["y"] == [0, 0, 0, -25], "in per cent"


@pytest.mark.parametrize(
    ("change", "ends", "fastest"),
    [
        ({}, (0, 4), 500),
        ({"live": {"x": [1, 9], "velocity": [0, 700]}}, (0, 9), 700),
        ({"reach": {"x": 12, "velocity": 600}}, (0, 12), 600),
        ({"reach": {"x": -12, "velocity": 600}}, (-12, 4), 600),
        ({"reach": {"x": 12, "velocity": 600}, "view": "up"}, (1, 3), 600),
    ],
)
def test_a_move_that_goes_beyond_the_plotted_one_has_room(
    modules: Modules, change: dict[str, object], ends: tuple[int, int], fastest: float
) -> None:
    layout = modules.evaluate(SCENE, change)["layout"]
    assert layout["xaxis"]["range"] == pytest.approx(ends, abs=0.4)
    assert layout["yaxis"]["range"][1] == pytest.approx(1.12 * fastest)


def test_a_move_that_runs_has_room_to_its_end_or_ever_further(modules: Modules) -> None:
    script = """async ([samples, speeds, times]) => { const {reachOver} = await import('/plotting/curves.js');
        const answer = {design: {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'},
            move: {steps: -500}, method: {name: 'exact'}},
            profiles: {exact: {summary: {duration_s: 2, peak_speed_steps_per_s: 800}}}};
        return [['step', 'position'].map((against) => reachOver(answer, against, samples).x),
            times.map((time_s) => reachOver(answer, 'time', {...samples, time_s}).x),
            speeds.map((speed) => reachOver(answer, 'step', {...samples, speed}).velocity),
            ['step', 'time'].map((against) =>
                reachOver(answer, against, {...samples, time_s: [], earlier: {seconds: 3, speed: 1001}}))]; }"""
    samples = {"time_s": [3], "speed": [7], "length": 4000}
    told = modules.evaluate(script, [samples, [[], [800, 9], [-801], [1001]], [[], [1.9], [2.1, 3]]])
    assert told[:3] == [[4000, -80], [2000, 2000, 3125], [800, 800, 1000, 1250]]
    # The second half of there and back keeps the room of the first.
    assert told[3] == [{"x": 4000, "velocity": 1250}, {"x": 3125, "velocity": 1250}]


def test_few_steps_are_drawn_as_steps_and_a_table_always_is(modules: Modules) -> None:
    def shapes(**change: object) -> dict[str, str]:
        return {trace["uid"]: trace["line"]["shape"] for trace in modules.evaluate(SCENE, change)["traces"]}

    assert {shapes()[f"first_order-{plot}"] for plot in ("velocity", "delay", "error")} == {"hvh"}
    assert shapes(against="time")["first_order-delay"] == "hv", "an interval follows its pulse"
    narrow = shapes(size={"width": 80, "height": 600})
    assert (narrow["first_order-velocity"], narrow["table-velocity"], narrow["table-error"]) == (
        "linear",
        "vh",
        "linear",
    )


def test_ranges_stay_while_a_slider_moves_as_long_as_all_fits(modules: Modules) -> None:
    script = """async (peaks) => { const {frameOf} = await import('/plotting/frame.js');
        const sceneOf = (peak) => ({answer: {design: {axis: {}, method: {name: 'exact'}},
            profiles: {exact: {phases: [{name: 'accelerate', first_step: 1, last_step: 2}]}}},
            shown: new Set(['exact']),
            curves: {exact: {step: [1, 2], x: [1, 2], shownSpeed: [0, peak], delay_us: [9, 1],
                error: {x: [1, 2], percent: [0, 1]}}}, against: 'step', view: 'whole', zoom: null,
            size: {width: 800, height: 600}, compact: false, only: 'velocity'});
        let held = null;
        return peaks.map((peak) => {
            held = frameOf({...sceneOf(peak), held, hold: 'while it fits'});
            return held.plots[0].range.high;
        }); }"""
    tight, same, grown, still, shrunk = modules.evaluate(script, [100, 90, 150, 160, 20])
    assert tight == pytest.approx(112)
    assert same == tight
    assert grown == still > 168, "with room for more"
    assert 20 < shrunk < 60


def test_a_table_far_off_does_not_flatten_the_errors_of_the_others(modules: Modules) -> None:
    script = """async ([method, shown, worst, of]) => { const {frameOf} = await import('/plotting/frame.js');
        const curve = (percent) => ({step: [1, 2], x: [1, 2], shownSpeed: [0, 9], delay_us: [9, 1],
            error: {x: [1, 2], percent: [0, percent]}});
        const {plots} = frameOf({answer: {design: {axis: {}, method: {name: method}},
            profiles: {[method]: {phases: [{name: 'accelerate', first_step: 1, last_step: 2}]}}},
            shown: new Set(shown), curves: {exact: curve(0), newton: curve(of), table: curve(worst)},
            against: 'step', view: 'whole', zoom: null, size: {width: 800, height: 600}, compact: false});
        return plots.find(({name}) => name === 'error').range.high; }"""

    def top(method: str, shown: list[str], worst: float, of_others: float = 40) -> float:
        return float(modules.evaluate(script, [method, shown, worst, of_others]))

    everything = ["exact", "newton", "table"]
    assert 120 < top("exact", everything, 7000) < 140, "three times the largest of the others"
    assert 100 < top("exact", everything, 7000, 2) < 120, "but no less than 100 %"
    assert 90 < top("exact", everything, 90, 2) < 100, "what isn't far off is all there"
    assert top("table", everything, 7000) > 7000, "chosen, it is what is looked at"
    assert top("exact", ["exact", "table"], 7000) > 7000, "nothing is flattened"


def test_hidden_methods_and_a_phone_s_other_plots_are_invisible(modules: Modules) -> None:
    traces = modules.evaluate(SCENE, {"shown": ["exact", "first_order"], "compact": True, "only": "delay"})["traces"]
    assert [trace["uid"] for trace in traces if trace["visible"]] == ["exact-delay", "first_order-delay"]


def test_axes_show_all_curves_and_stack_without_overlap(modules: Modules) -> None:
    layout = modules.evaluate(SCENE, {})["layout"]
    domains = [layout[name]["domain"] for name in ("yaxis3", "yaxis2", "yaxis")]
    assert domains[0][0] == pytest.approx(0, abs=1e-9)
    assert domains[0][1] < domains[1][0] < domains[1][1] < domains[2][0]
    assert domains[2][1] == pytest.approx(1)
    assert layout["yaxis"]["range"][1] > 500
    assert layout["yaxis2"]["type"] == "log"
    assert layout["yaxis3"]["range"][0] < -25
    assert layout["yaxis3"]["range"][1] > 10
    assert len(layout["shapes"]) == 6, "two ramps in three plots"


def test_the_start_is_logarithmic_over_steps_and_near_over_time(modules: Modules) -> None:
    assert modules.evaluate(SCENE, {"view": "start"})["layout"]["xaxis"]["type"] == "log"
    over_time = modules.evaluate(SCENE, {"view": "start", "against": "time"})["layout"]["xaxis"]
    assert over_time["type"] == "linear"
    assert over_time["range"][1] < 10


def test_a_move_longer_than_a_plan_without_a_middle_is_placed_at_its_ends_only(modules: Modules) -> None:
    summary = {"steps": 500, "accelerate_steps": 250, "slew_steps": 0, "decelerate_steps": 250}
    asked = [(0, 20_000), (250, 19_750), (251, 19_749), (19_749, 251), (19_750, 250), (20_000, 0), (300, 200)]
    steps = [modules.call("plotting/curves.js", "plottedStep", {"summary": summary}, *each) for each in asked]
    assert [None if math.isnan(step) else step for step in steps] == [0, 250, None, None, 250, 500, 300]


def test_a_line_of_such_a_move_is_broken_where_the_plan_has_no_place(modules: Modules) -> None:
    script = """async (samples) => {
        const { liveOver } = await import('/plotting/curves.js');
        const summary = {steps: 500, accelerate_steps: 250, slew_steps: 0, decelerate_steps: 250};
        const design = DESIGN;
        const answer = {design, profiles: {exact: {summary}}, errors: {}, failures: {}};
        return liveOver(answer, 'step', samples); }""".replace("DESIGN", json.dumps(document(move__steps=500)))
    samples = {"time_s": [0, 1, 2, 3], "position": [0, 100, 10_000, 19_900], "speed": [1, 2, 3, 4], "length": 20_000}
    live = modules.evaluate(script, samples)
    assert live["x"] == [0, 100, 100, 400]
    assert [None if math.isnan(each) else each for each in live["velocity"]] == [1, 2, None, 4]


def test_a_move_of_another_length_is_placed_by_its_ramps(modules: Modules) -> None:
    summary = {"steps": 500, "accelerate_steps": 100, "slew_steps": 300, "decelerate_steps": 100}
    places = {(0, 2000): 0, (50, 1950): 50, (1000, 1000): 250, (1950, 50): 450, (2000, 0): 500, (250, 250): 250}
    for (done, remaining), step in places.items():
        assert modules.call("plotting/curves.js", "plottedStep", {"summary": summary}, done, remaining) == step


def path_of(modules: Modules, x: list[float], y: list[float], shape: str = "linear", *, log: bool = False) -> str:
    scale = {"at": 0, "per": 10, "isLog": False}
    up = {"at": 100, "per": -10, "isLog": log}
    return modules.call("plotting/thinning.js", "pathOf", {"x": x, "y": y, "shape": shape}, scale, up, 100)


def test_paths_go_through_their_points_in_each_shape(modules: Modules) -> None:
    assert path_of(modules, [0, 1, 2], [1, 2, 2]) == "M0,90L10,80L20,80"
    assert path_of(modules, [0, 1], [1, 2], "hv") == "M0,90H10V80"
    assert path_of(modules, [0, 1], [1, 2], "vh") == "M0,90V80H10"
    assert path_of(modules, [0, 1], [1, 2], "hvh") == "M0,90H5V80H10"
    assert path_of(modules, [2, 1, 0], [1, 2, 3]) == "M20,90L10,80L0,70", "a move backward"
    assert path_of(modules, [0, 1, 2, 3], [1, 0, 1, 1], log=True) == "M0,100M20,100L30,100", "0 has no logarithm"


def test_paths_keep_the_extremes_of_each_column_of_pixels_and_leave_out_what_is_not_seen(modules: Modules) -> None:
    x = [i / 1000 for i in range(10_000)]
    y = [5 + 4 * (-1) ** i if 4000 < i < 4010 else 5 for i in range(10_000)]
    path = path_of(modules, x, y)
    assert path.count("L") < 300
    places = [tuple(map(float, place.split(","))) for place in path[1:].split("L")]
    assert {down for right, down in places if 39 <= right <= 41} == {10, 50, 90}
    assert path_of(modules, [-50, -40, 1, 2, 40, 50], [1, 1, 2, 2, 3, 3]) == "M-400,90L10,80L20,80L400,70"


def test_a_range_is_kept_within_the_move(modules: Modules) -> None:
    cases = [([5, 90], 100, [5, 90]), ([-3, 90], 100, [1, 90]), ([5, 190], 100, [5, 100]), ([1, 100], 100, None),
             ([100, 200], 100, None), (None, 100, None), ([5, 90], None, None)]  # fmt: skip
    for wanted, steps, expected in cases:
        assert modules.call("server/calculation.js", "rangeWithin", wanted, steps) == expected


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1000, "µs", "1,000.0"),
        (14_142.1356, "µs", "14,142.1356"),
        (62.5, "µs", "62.5"),
        (2_000_000, "Hz", "2,000,000"),
        (312.5, "steps/s", "312.5"),
        (1200, "steps", "1,200"),
        (2, "", "2"),
        (0x0A3F, "CRC-16", "0x0A3F"),
    ],
)
def test_the_figures_of_a_push_are_written_in_their_units(modules: Modules, value: float, unit: str, text: str) -> None:
    assert modules.call("panels/device/figures.js", "formatFigure", value, unit) == text


# 250 steps/mm: 1000 steps/s are 4 mm/s, or 240 mm/min, and 5 turns in 2 seconds. A count of steps stays one.
@pytest.mark.parametrize(
    ("unit", "value", "units", "shown"),
    [
        ("steps/s", 1000, {"length": "mm", "time": "s"}, ["mm/s", "4"]),
        ("steps/s", 1000, {"length": "mm", "time": "min"}, ["mm/min", "240"]),
        ("steps/s", 2083.3333, {"length": "mm", "time": "s"}, ["mm/s", "8.333333"]),
        ("steps/s", 1000, {"length": "rev", "time": "s"}, ["rev/s", "2.5"]),
        ("steps/s²", 2500, {"length": "mm", "time": "s"}, ["mm/s²", "10"]),
        ("steps/s", 1000, {"length": "steps", "time": "s"}, ["steps/s", "1,000"]),
        ("steps", 1200, {"length": "mm", "time": "s"}, ["steps", "1,200"]),
        ("Hz", 2_000_000, {"length": "mm", "time": "s"}, ["Hz", "2,000,000"]),
    ],
)
def test_the_figures_of_a_push_are_shown_in_the_units_chosen(
    modules: Modules, unit: str, value: float, units: dict[str, str], shown: list[str]
) -> None:
    design = {"axis": {"full_steps_per_rev": 200, "microsteps": 2, "travel_per_rev": 1.6, "travel_unit": "mm"}}
    script = """async ([unit, value, units, designs]) => {
        const { figuresOf } = await import('/panels/device/figures.js');
        const figures = figuresOf({ unit, axis: 1 }, units, designs);
        return [figures.unit, figures.write(value)]; }"""
    assert modules.evaluate(script, [unit, value, units, [design]]) == shown
    # Of several designs each axis has its own.
    other = {"axis": {**design["axis"], "travel_per_rev": 3.2}}
    assert modules.evaluate(script, [unit, value, units, [other, design]]) == shown


@pytest.mark.parametrize(
    ("axis", "on_device", "is_another"),
    # What was read back of axis 0 is 400.08 mm/min; nothing is known of an axis that isn't asked about.
    [(0, 400.08, False), (0, 500, True), (0, None, False), (1, 500, False)],
)
def test_a_controller_that_was_restored_has_another_ramp_than_was_pushed(
    modules: Modules, axis: int, on_device: float | None, *, is_another: bool
) -> None:
    own = {"term": "$110", "unit": "mm/min", "sent": 400.08, "on_device": 400.08}
    device = {"pushed": {"items": [{"name": "Full speed", "unit": "steps/s", "axis": 0, "own": own}]}, "ramp": None}
    preview = {"items": [{"axis": axis, "own": {**own, "on_device": on_device}}]}
    told = modules.call("panels/device/push_report.js", "hasAnotherRamp", device, preview)
    assert told == is_another
    assert modules.call("panels/device/push_report.js", "hasAnotherRamp", device, None) is False
