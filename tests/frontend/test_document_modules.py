"""Designs as text and as links: read whole or not at all, and then it is said why."""

import base64
import json
import zlib
from typing import Any, get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from designs import document
from frontend.modules import Modules
from stepramp import design as rules
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.json_text import parsed_json
from stepramp.methods import METHODS

LONGEST_LINK = 100_000
LONGEST_TEXT = 1_000_000


def designs() -> st.SearchStrategy[dict[str, Any]]:
    """Return designs of every shape: any text, any number, and text where numbers belong."""
    entries = st.one_of(
        st.floats(allow_nan=False, allow_infinity=False), st.integers(-(2**53) + 1, 2**53 - 1), st.text(max_size=5)
    )
    rows = st.lists(st.lists(entries, min_size=2, max_size=2), max_size=30)
    words = st.sampled_from
    shapes = st.one_of(
        st.sampled_from([{"name": "constant"}, {"name": "cosine"}]),
        st.fixed_dictionaries(
            {"name": st.just("s_curve"), "jerk_steps_per_s3": entries},
            optional={"deceleration_jerk_steps_per_s3": st.none() | entries},
        ),
        st.fixed_dictionaries({"name": st.just("drawn"), "points": rows}),
    )
    return st.fixed_dictionaries(
        {
            "schema": words(["stepramp/1", "stepramp/2"]),
            "name": st.text(max_size=100),
            "axis": st.fixed_dictionaries(
                {
                    **dict.fromkeys(("full_steps_per_rev", "microsteps", "travel_per_rev"), entries),
                    "travel_unit": words(["mm", "deg"]),
                }
            ),
            "timer": st.fixed_dictionaries(dict.fromkeys(rules.Timer.model_fields, entries)),
            "ramp": st.fixed_dictionaries(
                {
                    **dict.fromkeys(rules.RampParameters.model_fields.keys() - {"shape"}, entries),
                    "deceleration_steps_per_s2": st.none() | entries,
                },
                optional={"shape": shapes},
            ),
            "method": st.fixed_dictionaries(
                {
                    "name": words(list(METHODS)),
                    "arithmetic": words(get_args(rules.Arithmetic)),
                    "rounding": words(get_args(rules.Rounding)),
                    "tuned_for": words(get_args(rules.TunedFor)),
                }
            ),
            "table": st.none() | st.fixed_dictionaries({"rows": rows, "interval_unit": words(["us", "ticks"])}),
            "move": st.fixed_dictionaries({"steps": entries}, optional={"plan": words(["this_move", "any_move"])}),
        }
    )


def works() -> st.SearchStrategy[dict[str, Any]]:
    """Return what a person can have in hand: one axis, or up to four together."""
    one = st.tuples(st.lists(designs(), min_size=1, max_size=1), st.just("independent"))
    more = st.tuples(st.lists(designs(), min_size=2, max_size=4), st.sampled_from(["independent", "line"]))
    return (one | more).map(lambda both: {"axes": both[0], "together": both[1]})


def link(text: str) -> str:
    """Return the link that carries a text, made by other means than the page's."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    packed = packer.compress(text.encode()) + packer.flush()
    return "#d=" + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def problem(modules: Modules, text: str) -> str:
    reading = modules.call("documents/documents.js", "readDocument", text)
    assert reading["document"] is None
    return str(reading["problem"])


def link_problem(modules: Modules, fragment: str) -> str:
    reading = modules.call("documents/link.js", "decodeLink", fragment)
    assert reading["document"] is None
    return str(reading["problem"])


def test_any_document_comes_back_from_a_file_and_from_a_link(modules: Modules) -> None:
    script = """async (work) => {
        const {readDocument, writeDocument} = await import('/documents/documents.js');
        const {encodeLink, decodeLink} = await import('/documents/link.js');
        const read = [readDocument(writeDocument(work)), await decodeLink(await encodeLink(work))];
        return JSON.stringify(read); }"""

    @given(works())
    @settings(max_examples=100, deadline=None)
    def comes_back(work: dict[str, Any]) -> None:
        # JavaScript has one kind of numbers.
        read = json.loads(modules.evaluate(script, work), parse_int=float)
        assert read == [{"document": work, "problem": None}] * 2

    comes_back()


def test_links_and_files_are_what_other_programs_write_and_read(modules: Modules) -> None:
    one = document(name="Drehteller µ-Schritt, 軸 ½ 🛠")
    work = {"axes": [one], "together": "independent"}
    written = modules.call("documents/documents.js", "writeDocument", work)
    assert json.loads(written) == one
    assert written == json.dumps(one, indent=2, ensure_ascii=False).replace("8.0", "8")
    machine = {"schema": "stepramp-machine/1", "together": "line", "axes": [one, document(name="Y")]}
    for text, axes, together in [(written, [one], "independent"), (json.dumps(machine), machine["axes"], "line")]:
        reading = modules.call("documents/link.js", "decodeLink", link(text))
        assert reading["problem"] is None
        assert reading["document"]["together"] == together
        assert [Design.checked(axis) for axis in reading["document"]["axes"]] == [Design.checked(axis) for axis in axes]
    fragment = modules.call("documents/link.js", "encodeLink", {"axes": machine["axes"], "together": "line"})
    packed = fragment.removeprefix("#d=")
    text = zlib.decompress(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)), -zlib.MAX_WBITS)
    assert json.loads(text) == machine


def test_what_a_design_leaves_out_is_what_the_server_takes_for_it(modules: Modules) -> None:
    least = {
        "schema": "stepramp/1",
        "timer": {"frequency_hz": 1e6},
        "ramp": {"slew_speed_steps_per_s": 1000, "acceleration_steps_per_s2": 5000},
        "move": {"steps": 10},
    }
    reading = modules.call("documents/documents.js", "readDocument", "\ufeff" + json.dumps(least))
    assert reading["document"]["axes"] == [Design.checked(least).model_dump(mode="json", by_alias=True)]


@pytest.mark.parametrize("schema", ["stepramp/3", "stepramp/1.1", "stepramp/17-beta", "stepramp-machine/2"])
@pytest.mark.parametrize("rest", [{}, {"shape": {"kind": "s-curve"}}, {"axes": [document()]}])
def test_a_newer_format_is_told(modules: Modules, schema: str, rest: dict[str, Any]) -> None:
    text = json.dumps({"schema": schema, **rest})
    for said in (problem(modules, text), link_problem(modules, link(text))):
        assert "newer StepRamp" in said
        assert f'"{schema}"' in said
        assert "stepramp/1" in said


def test_a_newer_axis_of_a_machine_is_told(modules: Modules) -> None:
    axes = [document(), document(schema="stepramp/3")]
    said = problem(modules, json.dumps({"schema": "stepramp-machine/1", "together": "line", "axes": axes}))
    assert "newer StepRamp" in said


def machine_with(axes: object, together: object = "line", **others: object) -> dict[str, object]:
    return {"schema": "stepramp-machine/1", "together": together, "axes": axes, **others}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not JSON"),
        ("hello", "not JSON"),
        ('{"schema": "stepramp/1", "name": "cut o', "not JSON"),
        ("null", "not a StepRamp design"),
        ("[1, 2]", "not a StepRamp design"),
        ("17", "not a StepRamp design"),
        ("{}", "schema is missing"),
        ('{"schema": "other/1"}', 'schema is "other/1"; allowed: "stepramp/1", "stepramp/2"'),
        ('{"schema": 1}', "schema is 1;"),
        (" " * LONGEST_TEXT + "{}", "longer than 1,000,000 characters"),
        ("[" * 500_000, "not JSON"),
    ],
)
def test_nonsense_is_told(modules: Modules, text: str, words: str) -> None:
    assert words in problem(modules, text)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (document(extra=1), "no field extra"),
        (document(axis__extra=1), "no field axis.extra"),
        (document(name=5), "name is 5; allowed: a text"),
        (document(name="x" * 101), "allowed: a text of up to 100 characters"),
        (
            document(table__rows=[[n, 5] for n in range(1001)]),
            'table.rows is "1,001 rows"; allowed: at most 1,000 rows',
        ),
        (machine_with([document(), document(name="x" * 101)]), "axes.1.name is"),
        (document(move__steps="7" * 101), "move.steps is"),
        (document(ramp=[]), "ramp is []; allowed: an object"),
        (document(ramp={}), "ramp.slew_speed_steps_per_s is missing; allowed: a number"),
        (document(timer=None), "timer is missing"),
        (document(move__steps=None), "move.steps is null; allowed: a number"),
        (document(move__steps=True), "move.steps is true"),
        (document(ramp__deceleration_steps_per_s2={}), "ramp.deceleration_steps_per_s2 is {}"),
        (document(axis__travel_unit="inch"), 'axis.travel_unit is "inch"; allowed: deg, mm'),
        (document(method__name="__proto__"), 'method.name is "__proto__"; allowed: exact, ideal'),
        (document(method__arithmetic="float16"), 'method.arithmetic is "float16"'),
        (
            document(ramp__shape={"name": "sine"}),
            'ramp.shape is {"name":"sine"}; allowed: an object whose name is constant, ',
        ),
        (document(ramp__shape={"name": 5}), 'ramp.shape is {"name":5}; allowed: an object whose name is constant, '),
        (document(ramp__shape={}), "ramp.shape is {}; allowed: an object whose name is constant, s_curve, "),
        (document(ramp__shape=None), "ramp.shape is null; allowed: an object whose name is constant, "),
        (document(ramp__shape={"name": "drawn", "points": [[1, 2], [3]]}), "points, a list of up to 200 pairs of numb"),
        (
            document(ramp__shape={"name": "drawn", "points": [[1, 2]] * 201}),
            "points, a list of up to 200 pairs of numb",
        ),
        (document(ramp__shape={"name": "s_curve", "jerk_steps_per_s3": []}), "jerk_steps_per_s3, a number; decelerat"),
        (document(move__plan="none"), 'move.plan is "none"; allowed: this_move, any_move'),
        (document(ramp__shape={"name": "constant", "jerk": 1}), 'ramp.shape is {"name":"constant","jerk":1}; allowed'),
        (document(method__rounding="up"), 'method.rounding is "up"'),
        (document(method__tuned_for="fun"), 'method.tuned_for is "fun"'),
        (document(table=[]), "table is []"),
        (document(table__rows={}), "table.rows is {}"),
        (document(table__rows=[[1]]), "table.rows.0 is [1]; allowed: a row of two numbers"),
        (document(table__rows=[[1, 2], [3, None]]), "table.rows.1.1 is null; allowed: a number"),
        (document(table__interval_unit="s"), 'table.interval_unit is "s"; allowed: us, ticks'),
        (machine_with([]), "axes is []; allowed: from 1 to 4 designs"),
        (machine_with([document()] * 5), "allowed: from 1 to 4 designs"),
        (machine_with({"0": document()}), "allowed: from 1 to 4 designs"),
        (machine_with([document(), 3]), "not a StepRamp design at axes.1"),
        (machine_with([document(), document(move__steps=[])]), "axes.1.move.steps is []"),
        (machine_with([document()], together="apart"), 'together is "apart"; allowed: independent, line'),
        (machine_with([document()], speed=1), "no field speed"),
    ],
)
def test_what_the_page_could_not_show_is_told_with_its_field(modules: Modules, wrong: object, words: str) -> None:
    assert words in problem(modules, json.dumps(wrong))


def test_what_a_browser_kept_with_an_unknown_shape_is_not_shown_again(modules: Modules) -> None:
    shapes = [{"name": "constant"}, {"name": "sine"}, {}, None]
    kept = [modules.call("model/design.js", "isDesign", document(ramp__shape=shape)) for shape in shapes]
    assert kept == [True, False, False, False]
    assert modules.call("model/design.js", "isDesign", document())


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ('{"schema": "stepramp/1", "name": "a", "name": "b"}', "name"),
        ('{"schema": "stepramp/1", "move": {"steps": 5, "steps": 5}}', "move.steps"),
        ('{"axes": [{}, {"a": ["x", {"\\u0062" : 1, "b": 2}]}]}', "axes.1.a.1.b"),
        ('{"a": {"name": 1}, "b": [{"name": 2}, {"name": 3}], "n\\"{": [], "n\\"{": 1}', 'n"{'),
    ],
)
def test_a_field_that_is_given_twice_is_told(modules: Modules, text: str, field: str) -> None:
    """Which of its values is meant, nobody knows; the server says the same."""
    assert problem(modules, text) == f"The design can’t be read: {field} is given more than once; allowed: once."
    with pytest.raises(Rejected) as rejected:
        parsed_json(text)
    assert rejected.value.rejections[0].field == field


def test_a_field_is_looked_for_in_whole_texts_only(modules: Modules) -> None:
    """What looks like a field within a text is none, and texts may be long and full of escapes."""
    name = '"name": "name", {"name": [' * 3
    machine = machine_with([document(name=name), document(name=name)])
    assert modules.call("documents/documents.js", "readDocument", json.dumps(machine))["problem"] is None
    assert "name is" in problem(modules, json.dumps(document(name='"\n' * 200_000)))


def test_a_number_too_large_for_any_machine_is_told(modules: Modules) -> None:
    text = json.dumps(document(move__steps=123454321)).replace("123454321", "1e999")
    assert "move.steps is Infinity; allowed: a number" in problem(modules, text)


def test_damaged_links_are_told(modules: Modules) -> None:
    whole = link(json.dumps(document()))
    for cut in (4, 5, len(whole) // 2, len(whole) - 4, len(whole) - 1):
        assert "damaged" in link_problem(modules, whole[:cut])
    for fragment in ("", "#d=", "#d=%%%", "#d=hello", "#plots", "#d=" + "_" * 50, "#d", "#D=hello", "#design=hello"):
        assert "damaged" in link_problem(modules, fragment)
    assert "not JSON" in link_problem(modules, link("hello"))
    assert "not a StepRamp design" in link_problem(modules, link("[]"))


def test_what_is_meant_as_a_link_is_opened_and_then_told(modules: Modules) -> None:
    """A fragment is a place on the page only when it looks like one."""
    meant = ["#d=abc", "#d=", "#d", "#D=abc", "#x=1", "#plots", "#", ""]
    assert [modules.call("documents/link.js", "isLink", fragment) for fragment in meant] == [True] * 5 + [False] * 3


def test_the_limits_are_the_servers(modules: Modules) -> None:
    limits = modules.evaluate("async () => (({MOST_ROWS, LONGEST_NAME}) => [MOST_ROWS, LONGEST_NAME])"
                              "(await import('/model/design.js'))")  # fmt: skip
    assert limits[0] == rules.MOST_TABLE_ROWS
    for length in (limits[1], limits[1] + 1):
        # Two characters of UTF-16 each, which count as one to the server.
        one = document(name="🛠" * length)
        is_read = modules.call("documents/documents.js", "readDocument", json.dumps(one))["problem"] is None
        try:
            Design.checked(one)
        except Rejected:
            assert not is_read
        else:
            assert is_read


def test_a_short_link_to_a_long_table_is_refused_and_one_that_was_kept_is_not_shown_again(modules: Modules) -> None:
    long = document(table__rows=[[row, 5000] for row in range(10_000)])
    said = link_problem(modules, link(json.dumps(long)))
    assert 'table.rows is "10,000 rows"; allowed: at most 1,000 rows' in said
    assert not modules.call("model/design.js", "isDesign", long)
    script = """async (work) => (await import('/documents/link.js')).encodeLink(work).catch((error) => error.message)"""
    made = modules.evaluate(script, {"axes": [long], "together": "independent"})
    assert "No link was made" in made
    assert "at most 1,000 rows" in made


def test_a_link_that_unpacks_to_very_much_is_unpacked_no_further_than_is_read(modules: Modules) -> None:
    """As browsers do it: all that a piece of the link unpacks to is made at once. Here a byte becomes a thousand."""
    script = """async (fragment) => {
        let made = 0;
        const kept = globalThis.DecompressionStream;
        globalThis.DecompressionStream = function () {
          return new TransformStream({ transform(piece, controller) {
            made += 1000 * piece.length;
            controller.enqueue(new Uint8Array(1000 * piece.length).fill(32)); } });
        };
        try {
          const {problem} = await (await import('/documents/link.js')).decodeLink(fragment);
          return [problem, made];
        } finally { globalThis.DecompressionStream = kept; } }"""
    problem, made = modules.evaluate(script, "#d=" + "A" * 60_000)
    assert "longer than 1,000,000" in problem
    assert LONGEST_TEXT < made < 5 * LONGEST_TEXT


def test_a_huge_link_is_neither_made_nor_read(modules: Modules) -> None:
    assert "at most 100,000" in link_problem(modules, "#d=" + "A" * LONGEST_LINK)
    # A short link can stand for a text of any length.
    bomb = link(" " * 50_000_000)
    assert len(bomb) < LONGEST_LINK
    assert "longer than 1,000,000" in link_problem(modules, bomb)
    script = """async (work) => (await import('/documents/link.js')).encodeLink(work).catch((error) => error.message)"""
    noise = "".join(chr(0x4E00 + 40_503 * place % 20_000) for place in range(90_000))
    made = modules.evaluate(script, {"axes": [document(name=noise)], "together": "independent"})
    assert "at most 100,000" in made


def test_the_largest_machine_fits_into_a_link(modules: Modules) -> None:
    rows = [[10_007 * row - row % 997, 4_294_967_295 - 999_983 * row * (row % 7)] for row in range(1, 1000)]
    axes = [document(name="x" * 100, table={"rows": rows, "interval_unit": "us"}) for _ in range(4)]
    # No row like any other, so that nothing is gained by the axes being alike.
    for number, axis in enumerate(axes):
        axis["table"]["rows"] = [[step - number, abs(delay) % 2**32 + number] for step, delay in rows]
        axis["method"]["tuned_for"] = "time"
    fragment = modules.call("documents/link.js", "encodeLink", {"axes": axes, "together": "line"})
    assert len(fragment) < LONGEST_LINK
    assert modules.call("documents/link.js", "decodeLink", fragment)["document"]["axes"] == axes
