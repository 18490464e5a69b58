"""Parameters as text, in units, on sliders and in steps: the modules behind the fields."""

import json
import math
from copy import deepcopy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from designs import document
from frontend.modules import Modules
from motor.trains import AT_24_V, LOADED, NEMA_17
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.http_api.error_items import error_items
from stepramp.http_api.json_response import json_bytes
from stepramp.ramp.profile import profile_of

MOTOR_TURN_STEPS = 400
SCREW_MM = 8
STEP_MM = SCREW_MM / MOTOR_TURN_STEPS


def stepped(modules: Modules, path: str, *rest: object) -> Any:
    script = """async ([path, rest]) => { const {GROUPS} = await import('/model/fields.js');
        const {stepped} = await import('/panels/parameters/stepping.js');
        return stepped(GROUPS.flatMap((group) => group.fields).find((field) => field.path === path), ...rest); }"""
    return modules.evaluate(script, [path, list(rest)])


SLEW, STEPS, MICROSTEPS, BASE = (
    "ramp.slew_speed_steps_per_s",
    "move.steps",
    "axis.microsteps",
    "ramp.base_speed_steps_per_s",
)


@pytest.mark.parametrize(
    ("path", "value", "direction", "stride", "factor", "expected"),
    [
        # About 1 % of the value, a 1, 2 or 5 with zeros, to the next multiple of it.
        (SLEW, 1000, 1, "usual", 1, 1010),
        (SLEW, 1000, -1, "usual", 1, 990),
        (SLEW, 1234, 1, "usual", 1, 1240),
        (SLEW, 1234, -1, "usual", 1, 1230),
        (SLEW, 5000, 1, "usual", 1, 5050),
        (SLEW, 2000, 1, "usual", 1, 2020),
        (SLEW, 1000, 1, "coarse", 1, 1100),
        (SLEW, 1000, 1, "fine", 1, 1001),
        (SLEW, 0.001, -1, "usual", 1, 0.001),
        (SLEW, 1_000_000, 1, "usual", 1, 1_000_000),
        (SLEW, 2_000_000, -1, "usual", 1, 1_000_000),
        # In millimetres the steps are round in millimetres: 1,000 steps/s are 20 mm/s, the next is 20.2.
        (SLEW, 1000, 1, "usual", STEP_MM, 1010),
        (SLEW, 1000, 1, "coarse", STEP_MM, 1100),
        (SLEW, 617.28, 1, "usual", STEP_MM, 620),
        # A whole number goes on by at least one.
        (STEPS, 20, 1, "usual", 1, 21),
        (STEPS, 20, -1, "fine", 1, 19),
        (STEPS, 500, 1, "usual", 1, 505),
        (STEPS, 500, 1, "coarse", 1, 550),
        (STEPS, -500, 1, "usual", 1, -495),
        (STEPS, -500, -1, "usual", 1, -505),
        (STEPS, 2.5, 1, "usual", 1, 3),
        # There is no move of no steps.
        (STEPS, 1, -1, "usual", 1, -1),
        (STEPS, -1, 1, "usual", 1, 1),
        # Drivers know powers of two.
        (MICROSTEPS, 1, 1, "usual", 1, 2),
        (MICROSTEPS, 16, 1, "usual", 1, 32),
        (MICROSTEPS, 16, -1, "usual", 1, 8),
        (MICROSTEPS, 10, 1, "usual", 1, 16),
        (MICROSTEPS, 10, -1, "usual", 1, 8),
        (MICROSTEPS, 4, 1, "coarse", 1, 16),
        (MICROSTEPS, 10, 1, "fine", 1, 11),
        (MICROSTEPS, 1, -1, "usual", 1, 1),
        (MICROSTEPS, 1024, 1, "usual", 1, 1024),
        # A linear one has strides of its own.
        (BASE, 0, 1, "usual", 1, 10),
        (BASE, 0, 1, "fine", 1, 1),
        (BASE, 0, 1, "coarse", 1, 100),
        (BASE, 3, -1, "usual", 1, 0),
        (BASE, 0, -1, "usual", 1, 0),
        ("axis.full_steps_per_rev", 200, 1, "usual", 1, 201),
        ("axis.full_steps_per_rev", 200, 1, "coarse", 1, 210),
        ("timer.counter_bits", 16, 1, "coarse", 1, 24),
        ("timer.counter_bits", 64, 1, "usual", 1, 64),
        ("timer.frequency_hz", 2_000_000, 1, "usual", 1, 2_020_000),
    ],
)
def test_a_step_goes_to_the_next_round_value(
    modules: Modules, path: str, value: float, direction: int, stride: str, factor: float, expected: float
) -> None:
    assert stepped(modules, path, value, direction, stride, factor) == pytest.approx(expected, rel=1e-12)


def test_steps_up_and_down_always_move_and_stay_allowed(modules: Modules) -> None:
    script = """async (values) => { const {GROUPS} = await import('/model/fields.js');
        const {stepped} = await import('/panels/parameters/stepping.js');
        const wrong = [];
        for (const field of GROUPS.flatMap((group) => group.fields))
            for (const value of values.map((one) => field.isWhole ? Math.round(one) : one)) {
                const [least, most] = field.limits;
                if (value < least || value > most) continue;
                for (const stride of ['fine', 'usual', 'coarse']) for (const direction of [1, -1]) {
                    const next = stepped(field, value, direction, stride, 0.02);
                    const isThere = value === (direction > 0 ? most : least);
                    const hasMoved = Math.sign(next - value) === direction;
                    if ((!isThere && !hasMoved) || next < least || next > most)
                        wrong.push([field.path, value, stride, next]);
                } }
        return wrong; }"""

    @given(st.lists(st.floats(1e-3, 1e9) | st.floats(-1e7, 1e7), min_size=50, max_size=50))
    @settings(max_examples=10, deadline=None)
    def moves(values: list[float]) -> None:
        assert modules.evaluate(script, values) == []

    moves()


SCREW = {"name": "screw", "lead_mm": 8, "mass_kg": 1}
MECHANISMS = {
    "pulley_mm": {"name": "belt", "pulley_mm": 12.7, "mass_kg": 1},
    "inertia_g_cm2": {"name": "pointer", "inertia_g_cm2": 2},
}
MOTOR = {
    "motor": {**NEMA_17, "stalled": {"rpm": 600, "torque_nm": 0.3}, "measured_with": dict(AT_24_V)},
    "drive": dict(AT_24_V),
    "load": {**LOADED, "mechanism": SCREW},
}
S_CURVE = {"name": "s_curve", "jerk_steps_per_s3": 1000}


def test_the_limits_and_units_are_those_of_the_server(modules: Modules) -> None:
    """Both ends are taken, and what lies beyond them is refused in the same unit."""
    script = """async () => (await import('/model/fields.js')).GROUPS.flatMap((group) => group.fields)
        .map(({path, limits, isWhole, unit}) => [path, limits, isWhole, unit])"""
    fields = modules.evaluate(script)
    assert len(fields) == 38
    for path, (least, most), is_whole, unit in fields:
        for value, is_taken in ((least, True), (most, True), (least - 1, False), (most + 1, False)):
            rejections = rejections_of(path, int(value) if is_whole else float(value))
            assert [one.field for one in rejections] == ([] if is_taken else [path]), value
            # The unit of the travel, the design says itself.
            said = [one.limits and one.limits.unit for one in rejections]
            assert said == ([] if is_taken else ["mm" if path == "axis.travel_per_rev" else unit])
        assert bool(rejections_of(path, least + 0.5)) == is_whole


def rejections_of(path: str, value: float) -> list[Rejection]:
    """Return what the design document refuses when one of its fields has a value."""
    changes: dict[str, Any] = {"ramp__slew_speed_steps_per_s": 1_000_000, "schema": "stepramp/2", **deepcopy(MOTOR)}
    if path.startswith("ramp.shape"):
        changes["ramp__shape"] = {"name": "torque"} if path.endswith("margin") else dict(S_CURVE)
    *parts, name = path.split(".")
    if "mechanism" in parts:
        changes["load"]["mechanism"] = dict(MECHANISMS.get(name, SCREW))
    changed = document(**changes)
    place = changed
    for part in parts:
        place = place[part]
    place[name] = value
    try:
        Design.checked(changed)
    except Rejected as error:
        # Whether a measured point fits the model is another question than what it may be.
        return [one for one in error.rejections if "the model has" not in str(one.allowed)]
    return []


def test_a_refusal_is_told_in_the_units_of_the_design_that_was_refused(modules: Modules) -> None:
    """Not of the one in hand, of which nothing is answered yet."""
    script = """async ([refused, inHand, units]) => {
        const { sortMessages } = await import('/model/messages.js');
        const { inShownUnit } = await import('/model/rejection_text.js');
        const { GROUPS } = await import('/model/fields.js');
        const field = GROUPS.flatMap(({fields}) => fields).find(({path}) => path === 'ramp.slew_speed_steps_per_s');
        const limits = {lowest: 0.001, highest: 1000000, unit: 'steps/s'};
        const rejection = {field: field.path, value: 5000000, allowed: '', message: '', limits, unit: 'steps/s'};
        const message = sortMessages([rejection], [], refused).fields.get(field.path);
        return inShownUnit(message, units, inHand, field).text; }"""
    asked, units = document(axis__microsteps=4), {"length": "mm", "time": "s"}
    in_hand = document(axis__microsteps=1)
    told = modules.evaluate(script, [asked, in_hand, units])
    # 8 mm a turn of 200 full steps: 0.01 mm a step of the design that was refused, 0.04 of the one in hand.
    assert told.startswith(
        "Slew speed is 50,000 mm/s (5,000,000 steps/s); allowed: a number from 0.00001 to 10,000 mm/s"
    )


def test_what_the_guide_asks_otherwise_is_refused_with_both_units(modules: Modules) -> None:
    """A wheel of 0 mm across: what is asked for is its diameter, what is stored the way of a turn, pi times as long."""
    with pytest.raises(Rejected) as caught:
        Design.checked(document(axis__travel_per_rev=0))
    [rejection] = caught.value.rejections
    assert rejection.limits
    refused = {"field": rejection.field, "value": 0, "allowed": rejection.allowed, "message": rejection.message}
    refused |= {"limits": vars(rejection.limits), "unit": rejection.limits.unit}
    message = {"text": "", "isWarning": False, "refused": refused}
    told = modules.call("model/rejection_text.js", "inUnit", message, {"label": "Diameter"}, "mm", 1 / math.pi)
    # 0.001 / pi, rounded up, and 1,000,000 / pi, rounded down.
    assert told["text"] == "Diameter is 0 mm (0 mm); allowed: a number from 0.00031831 to 318,309 mm."


def test_a_slider_gives_back_what_it_shows(modules: Modules) -> None:
    script = """async () => { const {GROUPS} = await import('/model/fields.js');
        const {sliderPosition, sliderValue} = await import('/panels/parameters/stepping.js');
        return GROUPS.flatMap((group) => group.fields).flatMap((field) => [field.slider.from, field.slider.to]
            .filter((end) => sliderValue(field, sliderPosition(field.slider, end), 1) !== end)
            .map((end) => [field.path, end])); }"""
    assert modules.evaluate(script) == []


def test_a_slider_sets_round_values_in_the_unit_shown(modules: Modules) -> None:
    script = """async ([path, position, before, factor]) => { const {GROUPS} = await import('/model/fields.js');
        const {sliderValue} = await import('/panels/parameters/stepping.js');
        const field = GROUPS.flatMap((group) => group.fields).find((one) => one.path === path);
        return sliderValue(field, position, before, factor); }"""
    for position in range(0, 1001, 7):
        shown = modules.evaluate(script, [SLEW, position, 1, STEP_MM]) * STEP_MM
        assert shown == pytest.approx(float(f"{shown:.3g}"), rel=1e-12)
        assert float(modules.evaluate(script, [STEPS, position, -1, STEP_MM])).is_integer()
        assert modules.evaluate(script, [STEPS, position, -1, STEP_MM]) < 0


def test_what_is_typed_comes_back_in_every_unit(modules: Modules) -> None:
    script = """async ([texts, factor]) => { const {readEntry, shownEntry} =
        await import('/model/shown_entry.js');
        return texts.map((text) => shownEntry(readEntry({isWhole: false}, text, factor).entry, factor)); }"""
    texts = ["0", "1", "10", "7.5", "0.125", "0.3", "33.333333", "1,234.5678", "999,999", "0.0001", "12o0", "", "1,5"]
    for factor in (1, STEP_MM, 0.9, 1 / MOTOR_TURN_STEPS, STEP_MM * 60, 1 / 3):
        assert modules.evaluate(script, [texts, factor]) == texts


def test_no_digit_before_the_point_is_dropped(modules: Modules) -> None:
    @given(st.floats(1e-6, 1e12), st.floats(1e-6, 1e6))
    @settings(max_examples=100, deadline=None)
    def is_close(stored: float, factor: float) -> None:
        text = modules.call("model/shown_entry.js", "shownEntry", stored, factor)
        assert math.isclose(float(text.replace(",", "")), stored * factor, rel_tol=6e-8)

    is_close()


@pytest.mark.parametrize(
    ("text", "entry", "exact"),
    [("10", 500, None), ("10.02", 501, None), ("10.01", 501, 500.5), ("10.005", 500, 500.25), ("0.001", 0, 0.05)],
)
def test_a_length_becomes_whole_steps_and_it_is_said(
    modules: Modules, text: str, entry: int, exact: float | None
) -> None:
    reading = modules.call("model/shown_entry.js", "readEntry", {"isWhole": True}, text, STEP_MM)
    assert reading == {"entry": entry, "exact": exact}


@pytest.mark.parametrize("typed", ["1e307", "-1e307", "1.7e308"])
def test_what_is_beyond_all_numbers_in_steps_stays_as_it_was_typed(modules: Modules, typed: str) -> None:
    """0.02 mm a step: 1e307 mm are 5e308 steps, more than there are numbers for. In steps it is a number like any."""
    reading = modules.call("model/shown_entry.js", "readEntry", {"isWhole": False}, f" {typed} ", STEP_MM)
    assert reading == {"entry": typed, "exact": None}
    assert modules.call("model/shown_entry.js", "shownEntry", typed, STEP_MM) == typed
    in_steps = modules.call("model/shown_entry.js", "readEntry", {"isWhole": False}, typed, 1)
    assert in_steps == {"entry": float(typed), "exact": None}


def test_steps_are_never_rounded_when_typed_as_steps(modules: Modules) -> None:
    reading = modules.call("model/shown_entry.js", "readEntry", {"isWhole": True}, "2.5", 1)
    assert reading == {"entry": 2.5, "exact": None}


def told(modules: Modules, path: str, value: object, limits: Limits | None, length: str = "mm", time: str = "s") -> str:
    script = """async ([path, refused, units, design]) => { const {GROUPS} = await import('/model/fields.js');
        const {inShownUnit} = await import('/model/rejection_text.js');
        const field = GROUPS.flatMap((group) => group.fields).find((one) => one.path === path);
        const message = {text: 'as the server tells it', isWarning: false, refused};
        return inShownUnit(message, units, design, field).text; }"""
    units = {"length": length, "time": time}
    allowed = limits.words if limits else "something else"
    rejection = Rejection(f"design.{path}", value, allowed, limits)
    return str(modules.evaluate(script, [path, answered(rejection), units, document()]))


def answered(rejection: Rejection) -> dict[str, Any]:
    """Return a rejection as the server answers it."""
    [error] = error_items(Rejected([rejection]))
    return dict(json.loads(json_bytes(error)))


SPEEDS = Limits(0.001, 1_000_000, "steps/s")


@pytest.mark.parametrize(
    ("path", "value", "limits", "text"),
    [
        (
            SLEW,
            2_000_000,
            SPEEDS,
            "Slew speed is 40,000 mm/s (2,000,000 steps/s); allowed: a number from 0.00002 to 20,000 mm/s.",
        ),
        (
            BASE,
            2000,
            Limits(0, 1000, "steps/s", note=", the slew speed"),
            "Base speed is 40 mm/s (2,000 steps/s); allowed: a number from 0 to 20 mm/s, the slew speed.",
        ),
        (SLEW, "12o0", SPEEDS, "Slew speed is '12o0'; allowed: a number from 0.00002 to 20,000 mm/s."),
        (SLEW, None, SPEEDS, "Slew speed is missing; allowed: a number from 0.00002 to 20,000 mm/s."),
        (
            "ramp.acceleration_steps_per_s2",
            0.01,
            Limits(lowest=50_000.5, unit="steps/s²", note=" between these speeds, for a ramp of at most 500 steps"),
            "Acceleration is 0.0002 mm/s² (0.01 steps/s²); allowed: at least 1,000.01 mm/s² between these speeds, "
            "for a ramp of at most 500 steps.",
        ),
        (
            SLEW,
            900_000,
            Limits(highest=800_000, unit="steps/s", note=" with this timer: an interval is 1 tick or more"),
            "Slew speed is 18,000 mm/s (900,000 steps/s); allowed: at most 16,000 mm/s with this timer: "
            "an interval is 1 tick or more.",
        ),
        (
            STEPS,
            0,
            Limits(-10_000_000, 10_000_000, "steps", is_whole=True, note=", but not 0"),
            "Distance is 0 mm (0 steps); allowed: a number from -200,000 to 200,000 mm, but not 0.",
        ),
        # What isn't in the field's unit is nothing that could be converted.
        (SLEW, 5, Limits(1, 2, "Hz"), "as the server tells it"),
        (SLEW, 5, None, "as the server tells it"),
    ],
)
def test_what_is_refused_is_told_in_the_unit_shown(
    modules: Modules, path: str, value: object, limits: Limits | None, text: str
) -> None:
    assert told(modules, path, value, limits) == text


def test_limits_are_rounded_to_what_is_allowed(modules: Modules) -> None:
    """In turns a minute the limits have endless digits; what is told must not be refused."""
    text = told(modules, SLEW, 5, SPEEDS, "rev", "min")
    low, high = (
        float(word.replace(",", "")) for word in (text.split("from ")[1].split()[0], text.split("to ")[1].split()[0])
    )
    assert low * MOTOR_TURN_STEPS / 60 >= 0.001
    assert high * MOTOR_TURN_STEPS / 60 <= 1_000_000
    assert told(modules, SLEW, 5, Limits(1, 2, "steps/s"), "deg").endswith("from 0.9 to 1.8 °/s.")


def test_steps_and_seconds_are_left_to_the_server(modules: Modules) -> None:
    assert told(modules, SLEW, 5, SPEEDS, "steps") == "as the server tells it"


# Facts of data sheets: steps of one turn of the output, and what a turn moves.
AXES = {
    "NEMA 17 · T8 screw, 8 mm": (200, None, 4 * 2, "mm"),
    "NEMA 17 · T8 screw, 2 mm": (200, None, 1 * 2, "mm"),
    "NEMA 17 · GT2 belt, 20 teeth": (200, None, 20 * 2, "mm"),
    "NEMA 17 · direct drive": (200, None, 360, "deg"),
    "Gauge X25, X27 · ⅓°": (360 * 3, 1, 360, "deg"),
    "Gauge X25, X27 · ¹⁄₁₂°": (360 * 12 / 4, 4, 360, "deg"),
    "28BYJ-48 · full steps": (32 * 64, 1, 360, "deg"),
    "28BYJ-48 · half steps": (64 * 64 / 2, 2, 360, "deg"),
}
TIMERS = {
    "Uno, Nano, Mega · 2 MHz": (16_000_000 / 8, 16),
    "Uno, Nano, Mega · 16 MHz": (16_000_000, 16),
    "Teensy 4 · 24 MHz": (24_000_000, 32),
    "ESP32 · 40 MHz": (80_000_000 / 2, 64),
    "Pico · PIO, 125 MHz": (125_000_000, 32),
    "Pico · timer, 1 MHz": (1_000_000, 32),
}


def test_presets_are_the_facts_of_data_sheets_and_designs_the_server_takes(modules: Modules) -> None:
    presets = modules.evaluate("async () => (await import('/model/presets.js')).PRESETS")
    assert [preset["name"] for preset in presets["axis"]] == list(AXES)
    assert [preset["name"] for preset in presets["timer"]] == list(TIMERS)
    for preset in presets["axis"]:
        full_steps, microsteps, travel, unit = AXES[preset["name"]]
        facts = {"full_steps_per_rev": full_steps, "travel_per_rev": travel, "travel_unit": unit}
        assert preset["values"] == facts | ({} if microsteps is None else {"microsteps": microsteps})
    for preset in presets["timer"]:
        frequency, bits = TIMERS[preset["name"]]
        assert preset["values"] == {"frequency_hz": frequency, "counter_bits": bits}
    for part, ones in presets.items():
        for preset in ones:
            before = document()
            changed = modules.call("model/presets.js", "withPreset", before, part, preset)
            assert {name for name in before if changed[name] != before[name]} <= {part}
            # It gives its name to a design that has none, or one that another preset gave it.
            for unnamed in ("", " ", ones[0]["name"]):
                renamed = modules.call("model/presets.js", "withPreset", before | {"name": unnamed}, part, preset)
                assert renamed == changed | {"name": preset["name"]}
            Design.checked(changed)
            assert modules.call("model/presets.js", "presetOf", changed, part) == preset


def test_a_refused_push_is_told_in_the_words_of_the_page(modules: Modules) -> None:
    limits = Limits(highest=50_000, unit="steps/s", note=" with a Tic")

    def told(place: str) -> str:
        rejection = Rejection.outside(f"{place}.ramp.slew_speed_steps_per_s", 60000.0, limits)
        return str(modules.call("model/messages.js", "pushText", [answered(rejection)]))

    assert told("design") == "Slew speed is 60,000; allowed: at most 50,000 steps/s with a Tic."
    assert told("axes.2") == "Axis 2: Slew speed is 60,000; allowed: at most 50,000 steps/s with a Tic."
    other = {"field": "ramp", "value": None, "allowed": None, "message": "The controller is full."}
    assert modules.call("model/messages.js", "pushText", [other]) == "The controller is full."
    reason = "Too long for this controller: 280 of 250 segments."
    long = answered(Rejection("axes.1.ramp.acceleration_steps_per_s2", 5.0, "less", reason=reason))
    assert modules.call("model/messages.js", "pushText", [long]) == f"Axis 1: {reason}"


def test_a_name_that_is_too_long_is_told_where_it_is_typed(modules: Modules) -> None:
    with pytest.raises(Rejected) as caught:
        Design.checked(document(name="x" * 101))
    [rejection] = caught.value.rejections
    script = """async (errors) => { const {sortMessages} = await import('/model/messages.js');
        const {fields, others} = sortMessages(errors, []);
        return {fields: [...fields.keys()], others, text: fields.get('name').text}; }"""
    found = modules.evaluate(script, [answered(rejection.within("design."))])
    allowed = "allowed: a text of up to 100 characters."
    assert (found["fields"], found["others"]) == (["name"], [])
    assert found["text"].split("; ") == [f"Name is '{'x' * 78}…", allowed]


def test_names_that_are_allowed_are_told_as_the_page_calls_them(modules: Modules) -> None:
    """The API keeps its own: 'austin', ramp.shape.name 'cosine'."""
    with pytest.raises(Rejected) as caught:
        profile_of(Design.checked(document(schema="stepramp/2", ramp__shape={"name": "cosine"}, method__name="austin")))
    [rejection] = caught.value.rejections
    assert rejection.allowed.endswith("with ramp.shape.name 'cosine'")
    text = "Method is Austin; allowed: Exact, Ideal, Midpoint, Newton, Table with shape Cosine."
    for place, about in (("", ""), ("design.", ""), ("axes.1.", "Axis 1: ")):
        told = modules.call("model/messages.js", "pushText", [answered(rejection.within(place))])
        assert told == f"{about}{text}"
    with pytest.raises(Rejected) as caught:
        Design.checked(document(method={"name": "austin", "arithmetic": "fixed"}))
    told = modules.call("model/messages.js", "textOf", [answered(caught.value.rejections[0])])
    assert told == "Arithmetic is fixed; allowed: float32, float64 with method Austin."
    with pytest.raises(Rejected) as caught:
        Design.checked(document(method__name="table", table=None))
    assert caught.value.rejections[0].allowed == "a table, since method.name is 'table'"
    told = modules.call("model/messages.js", "textOf", [answered(caught.value.rejections[0])])
    assert told == "Lookup table is missing; allowed: a table, since the method is Table."


def test_a_drawn_speed_is_refused_in_the_unit_shown(modules: Modules) -> None:
    drawn = {"name": "drawn", "points": [[500, 1], [500, 0.5]]}
    with pytest.raises(Rejected) as caught:
        Design.checked(document(schema="stepramp/2", ramp__shape=drawn))
    script = """async ([rejection, design]) => { const {inShownUnits} = await import('/model/told.js');
        const {sortMessages} = await import('/model/messages.js');
        const said = inShownUnits({length: 'mm', time: 's'}, [design])(rejection);
        return sortMessages([said], []).fields.get('ramp.shape.points').text; }"""
    assert modules.evaluate(script, [answered(caught.value.rejections[0]), document()]) == (
        "Point 2, speed, is 10 mm/s (500 steps/s); allowed: more than 10 mm/s, the speed of the point before."
    )


def test_what_says_its_axis_itself_is_not_called_by_it_again(modules: Modules) -> None:
    limit = {"field": "designs.1.ramp.slew_speed_steps_per_s", "axis": 1, "message": "Y (axis 1) allows 5 steps/s."}
    warning = {"field": "designs.0.timer.counter_bits", "message": "The longest interval does not fit."}
    told = modules.call("model/messages.js", "axesMessages", [limit, warning], True)
    assert [each["text"] for each in told] == [limit["message"], f"Axis 0: {warning['message']}"]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"ramp__shape": {"name": "drawn", "points": []}}, "Drawn acceleration is empty; allowed: a list of 2 to 200"),
        ({"ramp__shape": {"name": "drawn", "points": [[0, 1]]}}, "Drawn acceleration is 1 item; allowed:"),
        ({"ramp__shape": {"name": "drawn", "points": "none"}}, "Drawn acceleration is 'none'; allowed:"),
        # Too large for a number, and none of the words that people type.
        ({"ramp__slew_speed_steps_per_s": "1e400"}, "Slew speed is 1e400; allowed: a number from 0.001"),
        ({"ramp__slew_speed_steps_per_s": "\u22121e400"}, "Slew speed is \u22121e400; allowed:"),
        ({"ramp__slew_speed_steps_per_s": "fast"}, "Slew speed is 'fast'; allowed:"),
    ],
)
def test_what_was_given_is_told_as_what_it_is(modules: Modules, changes: dict[str, Any], told: str) -> None:
    with pytest.raises(Rejected) as caught:
        Design.checked({**document(**changes), "schema": "stepramp/2"})
    assert modules.call("model/messages.js", "textOf", [answered(caught.value.rejections[0])]).startswith(told)
