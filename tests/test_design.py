import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design, document
from stepramp.design import Design
from stepramp.errors import Limits, Rejected
from stepramp.examples import all_examples

NUMBERS_ABOVE_ZERO = (
    "timer__frequency_hz",
    "timer__shortest_interval_us",
    "axis__travel_per_rev",
    "ramp__slew_speed_steps_per_s",
    "ramp__acceleration_steps_per_s2",
    "ramp__deceleration_steps_per_s2",
)
WHOLE_NUMBERS = ("axis__full_steps_per_rev", "axis__microsteps", "timer__counter_bits", "move__steps")
NONSENSE = (0, 1e-300, -1, math.nan, math.inf, -math.inf, "12", "", True, [1], {}, 1e300, 10**400)


def refused(changed: object) -> list[tuple[str, object, str]]:
    with pytest.raises(Rejected) as caught:
        Design.checked(changed)
    for rejection in caught.value.rejections:
        assert rejection.field in rejection.message
        assert rejection.allowed in rejection.message
    return [(each.field, each.value, each.allowed) for each in caught.value.rejections]


def same(a: object, b: object) -> bool:
    return a is b or a == b


@pytest.mark.parametrize("path", NUMBERS_ABOVE_ZERO + WHOLE_NUMBERS)
@pytest.mark.parametrize("value", NONSENSE, ids=repr)
def test_nonsense_is_refused_by_field_value_and_range(path: str, value: object) -> None:
    if path == "move__steps" and value == -1 and value is not True:
        assert design(move__steps=-1).move.steps == -1
        return
    [(field, given_value, allowed)] = refused(document(**{path: value}))
    assert field == path.replace("__", ".")
    assert same(given_value, value)
    assert any(digit.isdigit() for digit in allowed)


@pytest.mark.parametrize("value", [-1, math.nan, math.inf, "0", True, 1_000_001], ids=repr)
def test_a_base_speed_below_zero_or_not_a_number_is_refused(value: object) -> None:
    [(field, _, allowed)] = refused(document(ramp__base_speed_steps_per_s=value))
    assert (field, allowed) == ("ramp.base_speed_steps_per_s", "a number from 0 to 1,000,000 steps/s")


def test_a_base_speed_above_the_slew_speed_is_refused() -> None:
    [(field, value, allowed)] = refused(document(ramp__base_speed_steps_per_s=1001))
    assert (field, value) == ("ramp.base_speed_steps_per_s", 1001)
    assert allowed == "a number from 0 to 1,000 steps/s, the slew speed"


def test_a_base_speed_equal_to_the_slew_speed_is_allowed() -> None:
    assert design(ramp__base_speed_steps_per_s=1000).ramp.base_speed_steps_per_s == 1000


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (Limits(2000, 2000, "steps", is_whole=True), "only 2,000 steps"),
        (Limits(0.5, 0.5, "mm", note=", or 0"), "only 0.5 mm, or 0"),
        (Limits(2000, 2001, "steps", is_whole=True), "a whole number from 2,000 to 2,001 steps"),
    ],
)
def test_a_range_of_one_value_is_told_as_that_value(limits: Limits, words: str) -> None:
    assert limits.words == words


@pytest.mark.parametrize("value", [10**12, 10_000_001, -10_000_001, 1.5, 0])
def test_moves_beyond_the_limits_are_refused(value: float) -> None:
    [(field, given_value, allowed)] = refused(document(move__steps=value))
    assert (field, given_value) == ("move.steps", value)
    assert allowed == "a whole number from -10,000,000 to 10,000,000 steps, but not 0"


@pytest.mark.parametrize("speed", [5e-324, 2e-311, 1e-222, 0.00099])
def test_a_base_speed_is_none_or_not_slower_than_the_slowest(speed: float) -> None:
    [(field, value, allowed)] = refused(document(ramp__base_speed_steps_per_s=speed))
    assert (field, value) == ("ramp.base_speed_steps_per_s", speed)
    assert allowed == "a number from 0.001 to 1,000 steps/s, the slew speed, or 0"
    for possible in (0, 0.001):
        assert design(ramp__base_speed_steps_per_s=possible).ramp.base_speed_steps_per_s == possible


def test_a_whole_number_may_be_written_with_an_exponent() -> None:
    assert design(move__steps=2e6).move.steps == 2_000_000


AFTER = ": more than the ramp index of the row before"


@pytest.mark.parametrize(
    ("rows", "field", "allowed"),
    [
        ([], "table.rows", "a list of 1 to 1,000 rows of two whole numbers"),
        ([[1, 1]] * 1001, "table.rows", "a list of 1 to 1,000 rows of two whole numbers"),
        ([[10, 500], [10, 400]], "table.rows.1.0", f"a whole number from 11 to 10,000,000 steps{AFTER}"),
        ([[10, 500], [5, 400]], "table.rows.1.0", f"a whole number from 11 to 10,000,000 steps{AFTER}"),
        ([[10, 500], [20, 0]], "table.rows.1.1", "a whole number from 1 to 4,294,967,295 µs"),
        ([[10, 500.5]], "table.rows.0.1", "a whole number from 1 to 4,294,967,295 µs"),
        ([[-1, 500]], "table.rows.0.0", "a whole number from 0 to 10,000,000 steps"),
        ([[10]], "table.rows.0", "a list of two whole numbers, the last ramp index [steps] and the delay"),
        ([[10, 500, 1]], "table.rows.0", "a list of two whole numbers, the last ramp index [steps] and the delay"),
        ([5], "table.rows.0", "a list of two whole numbers, the last ramp index [steps] and the delay"),
        ("{10, 500}", "table.rows", "a list of 1 to 1,000 rows of two whole numbers"),
    ],
)
def test_a_table_is_refused_by_row(rows: object, field: str, allowed: str) -> None:
    assert [(each[0], each[2]) for each in refused(document(table__rows=rows))] == [(field, allowed)]


@pytest.mark.parametrize(
    ("changed", "field", "allowed"),
    [
        ({"table": {"rows": [[10, 0]], "interval_unit": "ticks"}}, "table.rows.0.1", "from 1 to 4,294,967,295 ticks"),
        ({"table": {"rows": [[10, 0]]}}, "table.rows.0.1", "from 1 to 4,294,967,295 µs"),
        ({"axis__travel_per_rev": 0}, "axis.travel_per_rev", "from 0.001 to 1,000,000 mm"),
        ({"axis": {"travel_per_rev": 0}}, "axis.travel_per_rev", "from 0.001 to 1,000,000 degrees"),
    ],
)
def test_a_number_is_refused_in_the_unit_that_the_document_names(
    changed: dict[str, object], field: str, allowed: str
) -> None:
    with pytest.raises(Rejected) as caught:
        design(**changed)
    [rejection] = caught.value.rejections
    assert rejection.field == field
    assert rejection.allowed.endswith(f" number {allowed}")
    assert rejection.limits
    assert rejection.limits.unit == allowed.rsplit(maxsplit=1)[-1]


def test_where_no_unit_can_be_told_all_that_it_may_be_are() -> None:
    found = refused(document(table__rows=[[10, 0]], table__interval_unit="s"))
    assert found[0][2] == "a whole number from 1 to 4,294,967,295 µs or ticks"
    assert found[1][0] == "table.interval_unit"


def test_unknown_fields_are_refused_everywhere() -> None:
    changed = document(surprise=1)
    for part in ("axis", "timer", "ramp", "method", "table", "move"):
        changed[part]["surprise"] = 1
    assert {each[0] for each in refused(changed)} == {
        "surprise", *(f"{part}.surprise" for part in ("axis", "timer", "ramp", "method", "table", "move"))
    }  # fmt: skip


def test_missing_fields_are_refused() -> None:
    assert {each[0] for each in refused({})} == {"schema", "timer", "ramp", "move"}
    assert refused(document(timer={})) == [("timer.frequency_hz", None, "a value; this field is required")]


@pytest.mark.parametrize("value", [None, 5, "x", [], True])
def test_what_is_no_document_is_refused(value: object) -> None:
    assert refused(value) == [("document", value, "an object with named fields")]


@pytest.mark.parametrize(
    ("path", "value", "allowed"),
    [
        ("schema", "stepramp/3", "stepramp/1, stepramp/2"),
        (
            "method__name",
            "magic",
            "exact, ideal, midpoint, first_order, second_order, compromise, tuned, newton, austin, table",
        ),
        ("method__arithmetic", "decimal", "float64, float32, fixed"),
        ("method__rounding", "up", "nearest, floor, carry"),
        ("axis__travel_unit", "inch", "mm, deg"),
        ("table__interval_unit", "ms", "us, ticks"),
        ("name", 5, "a text of up to 100 characters"),
        ("name", "x" * 101, "a text of up to 100 characters"),
    ],
)
def test_words_are_refused_with_the_choice(path: str, value: object, allowed: str) -> None:
    assert refused(document(**{path: value})) == [(path.replace("__", "."), value, allowed)]


def test_every_wrong_value_is_named_at_once() -> None:
    fields = {each[0] for each in refused(document(timer__frequency_hz=0, move__steps=0, name=1))}
    assert fields == {"timer.frequency_hz", "move.steps", "name"}


def test_the_method_table_needs_a_table() -> None:
    [(field, value, _)] = refused(document(method__name="table", table=None))
    assert (field, value) == ("table", None)


def test_deceleration_is_the_acceleration_until_it_is_given() -> None:
    assert design().ramp.slowdown_steps_per_s2 == 5000
    assert design(ramp__deceleration_steps_per_s2=8000).ramp.slowdown_steps_per_s2 == 8000


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=5,
)


@given(st.sampled_from(["name", "axis", "timer", "ramp", "method", "table", "move", "schema"]), json_values)
def test_no_value_in_any_part_ends_in_anything_but_a_design_or_a_rejection(part: str, value: object) -> None:
    try:
        Design.checked(document(**{part: value}))
    except Rejected as error:
        assert error.rejections


def test_a_design_survives_json() -> None:
    original = design(name="Größe")
    assert Design.checked(json.loads(original.model_dump_json(by_alias=True))) == original


def test_examples_are_designs() -> None:
    titles = [example["title"] for example in all_examples()]
    assert titles == ["Lead-screw stage", "Laser-table axis", "Gauge"]
    for example in all_examples():
        assert set(example) == {"title", "description", "design"}
        Design.checked(example["design"])


def test_the_gauge_example_is_the_published_table() -> None:
    record = json.loads((Path(__file__).parent / "reference" / "gauge_table_moves.json").read_text())
    assert all_examples()[2]["design"]["table"] == {"rows": record["cases"][0]["table"], "interval_unit": "us"}


def test_a_last_ramp_index_with_a_row_behind_it_is_refused_itself() -> None:
    with pytest.raises(Rejected) as caught:
        design(table={"rows": [[10_000_000, 9], [10_000_000, 8]]})
    [rejection] = caught.value.rejections
    assert rejection.field == "table.rows.0.0"
    assert rejection.allowed == "a whole number from 0 to 9,999,999 steps, so that row 2 can lie behind it"
