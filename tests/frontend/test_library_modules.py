"""The library in words, and what opens, saves and keeps, without a browser and without a server."""

from __future__ import annotations

from typing import Any

import pytest

from designs import document
from frontend.modules import Modules
from frontend.state import STATE

MODULE = "model/library.js"
SAVED_AT = "2026-11-28T07:10:47.923574Z"
LINK = {"id": "a", "name": "Lift", "number": 2, "version": 5, "design": document()}
KEPT = {"id": "a", "name": "Lift", "notes": "", "tags": [], "version": 7, "revisions": 3, "saved_at": SAVED_AT}


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ([0, 0, True], "No design has all these words and tags."),
        ([0, 0, False], "Nothing is in the library yet: save this design as its first."),
        ([1, 1, False], "1 design"),
        ([2, 2, True], "2 designs found"),
        ([1300, 100, False], "1,300 designs; the 100 that were saved last are listed: more words find the others."),
    ],
)
def test_what_is_found_is_told(modules: Modules, found: list[object], words: str) -> None:
    assert modules.call(MODULE, "foundText", *found) == words


def test_tags_are_told_apart_by_commas_and_those_of_most_designs_come_first(modules: Modules) -> None:
    assert modules.call(MODULE, "tagsOf", " x axis,quiet, ,x axis ") == ["x axis", "quiet"]
    designs = [{"tags": ["b", "quiet"]}, {"tags": ["quiet", "a"]}, {"tags": []}]
    assert modules.call(MODULE, "tagsOfAll", designs) == ["quiet", "a", "b"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (("Lift",), None),
        (("", "Own"), None),
        (("",), "The name is empty; allowed: a name that can be read."),
        (("   ", " "), "The name is only spaces; allowed: a name that can be read."),
        (
            ("   ", "Own"),
            "The name is only spaces; allowed: a name that can be read, or none at all for the design’s own.",
        ),
        (("x" * 10_000,), "The name has 10,000 characters; at most 100 are allowed."),
    ],
)
def test_a_name_that_is_not_kept_as_it_is_typed_is_told(
    modules: Modules, name: tuple[str, ...], words: str | None
) -> None:
    assert modules.call(MODULE, "nameProblem", *name) == words


def test_a_name_turns_none_of_the_page_s_own_words(modules: Modules) -> None:
    assert modules.call("model/quoted.js", "quoted", "Lift") == "“Lift”"
    assert modules.call("model/quoted.js", "quoted", "a\u202eb\u2069c") == "“\u2068a\u202ebc\u2069”"
    for adlam_or_hanifi in ("\U0001e900", "\U00010d00"):
        assert modules.call("model/quoted.js", "quoted", adlam_or_hanifi) == f"“\u2068{adlam_or_hanifi}\u2069”"
    assert modules.call(MODULE, "inHandText", "\u202eb", None, False) == (
        "In hand: “\u2068\u202eb\u2069”, not in the library"
    )


@pytest.mark.parametrize(
    ("difference", "row"),
    [
        (("ramp.slew_speed_steps_per_s", 1000, 1200), ("Slew speed", "20 mm/s", "48 mm/s")),
        (("ramp.deceleration_steps_per_s2", None, 5000), ("Deceleration", "–", "200 mm/s²")),
        (("method.name", "exact", "first_order"), ("Method", "Exact", "1st order")),
        (("method.rounding", "nearest", "floor"), ("Rounding", "nearest", "floor")),
        (("table.rows", [[1, 2]], [[1, 2], [3, 4]]), ("Lookup table", "1 row", "2 rows")),
        (("table", None, {"interval_unit": "us", "rows": [[1, 2]]}), ("Lookup table", "–", "1 row")),
        (("name", "", "Lift"), ("Name", "–", "Lift")),
    ],
)
def test_a_difference_is_in_the_units_shown_each_by_its_own_scale(
    modules: Modules, difference: tuple[str, object, object], row: tuple[str, str, str]
) -> None:
    field, before, after = difference
    screw: dict[str, Any] = {"full_steps_per_rev": 200, "microsteps": 2, "travel_per_rev": 8, "travel_unit": "mm"}
    one = {**document(), "axis": screw}
    other = {**document(), "axis": {**screw, "microsteps": 1}}
    found = modules.call(
        MODULE,
        "differenceRow",
        {"field": field, "before": before, "after": after},
        {"length": "mm", "time": "s"},
        one,
        other,
    )
    assert tuple(found.values()) == row


@pytest.mark.parametrize(
    ("push", "outcome"),
    [
        ({"trouble": None, "verified": True, "mode": "keep"}, ("Read back as sent, to be kept", False)),
        ({"trouble": None, "verified": True, "mode": "try"}, ("Read back as sent, to be tried", False)),
        ({"trouble": None, "verified": False, "mode": "keep"}, ("Not read back as sent, to be kept", True)),
        ({"trouble": "The cable.", "verified": None, "mode": "keep"}, ("Failed: The cable.", True)),
    ],
)
def test_what_became_of_a_push_is_told(modules: Modules, push: object, outcome: tuple[str, bool]) -> None:
    assert tuple(modules.call(MODULE, "pushOutcome", push).values()) == outcome


def test_what_was_pushed_is_told_by_the_revision_that_is_the_same(modules: Modules) -> None:
    same = {"design_id": "a", "name": "Lift", "number": 3}
    one = {"axis": 0, "name": "lift", "revisions": [same]}
    assert modules.call(MODULE, "pushedText", [one]) == "“Lift”, revision 3"
    axes = [one, {"axis": 1, "name": "", "revisions": []}]
    assert modules.call(MODULE, "pushedText", axes) == "axis 0: “Lift”, revision 3; axis 1: “unnamed”, in no revision"


def test_what_a_file_has_added_is_told(modules: Modules) -> None:
    none = {"designs": 0, "revisions": 0, "devices": 0, "pushes": 0, "records": 0}
    none |= {"there_already": 12, "described": 0, "copies": []}
    assert modules.call(MODULE, "importedText", none) == "Nothing was added. There already: 12."
    said = {**none, "described": 2}
    more = "More is said of 2 designs that the library had."
    assert modules.call(MODULE, "importedText", said) == f"{more} There already: 12."
    some = {**none, "designs": 1, "revisions": 3, "pushes": 1, "there_already": 0, "copies": ["Lift"]}
    assert modules.call(MODULE, "importedText", some) == (
        "Added: 1 design, 3 revisions, 1 push. Beside what the library has under the same name, as it differs: “Lift”."
    )


@pytest.mark.parametrize(
    ("name", "link", "is_same", "words"),
    [
        ("Lift", None, False, "In hand: “Lift”, not in the library"),
        ("Lift", LINK, True, "In hand: “Lift”, revision 2"),
        ("", LINK, False, "In hand: “unnamed”, changed since revision 2 of “Lift”"),
    ],
)
def test_what_is_in_hand_is_told(modules: Modules, name: str, link: object, is_same: bool, words: str) -> None:
    assert modules.call(MODULE, "inHandText", name, link, is_same) == words


def test_who_was_quicker_is_told(modules: Modules) -> None:
    newest = {"number": 3, "note": "softer", "saved_at": SAVED_AT}
    words = modules.call(MODULE, "conflictText", {**KEPT, "history": [newest]}, LINK)
    assert words.startswith("Somebody else has saved revision 3 of “Lift” meanwhile, on 28 Nov 2026")
    assert words.endswith("“softer”. Yours began with what was there before it. Nothing was overwritten.")
    described = modules.call(MODULE, "conflictText", {**KEPT, "revisions": 2, "history": [newest]}, LINK)
    assert described.startswith("Somebody else has given “Lift” another name, notes or tags")


# A page with axes 5 and 7 and a library that answers; `asked` is what it was asked for.
DESK = f"""{STATE}
    const {{createStore}} = await import('/app/state.js');
    const {{createLibrary}} = await import('/app/effects/library.js');
    const {{Refusal}} = await import('/server/api.js');
    const work = await import('/app/commands/work.js');
    const {{link}} = await import('/app/commands/library.js');
    const store = createStore({{...state, library: {{links: {{}}, beside: []}}}}, (error) => {{ throw error; }});
    const asked = [];
    const kept = {{id: 'a', name: 'Lift', notes: '', tags: [], version: 7, revisions: 3, saved_at: ''}};
    const answers = {{
        add: async () => ({{...kept, version: 1, revisions: 1}}), save: async () => kept,
        design: async () => ({{...kept, history: [{{number: 3, note: '', saved_at: ''}}]}}),
        revision: async (id, number) => ({{number, design: {{...design, name: `of ${{number}}`}}}}),
        keepRecord: async () => ({{}}),
        push: async () => ({{device: 'Bench', pushed_at: '', designs: [{{axis: 0, design}}, {{axis: 1, design}}],
            axes: [{{axis: 0, revisions: [{{design_id: 'a', name: 'Lift', number: 2}}]}},
                {{axis: 1, revisions: []}}]}}),
    }};
    const heard = Object.fromEntries(Object.entries(answers).map(([name, answer]) =>
        [name, (...given) => {{ asked.push([name, ...given]); return answers[name](...given); }}]));
    const documents = {{openWork: (opened) => store.dispatch(work.open, opened), replacing: (act) => act()}};
    const actions = createLibrary(store, documents, heard, async () => ({{}}));
    const inHand = () => store.state().history.present;
    const links = () => store.state().library.links;
    const quicker = () => Promise.reject(new Refusal(412, [{{message: 'quicker'}}]));
"""


def desk(modules: Modules, script: str) -> Any:
    return modules.evaluate(f"async ([design]) => {{ {DESK} {script} }}", [document()])


def test_a_revision_is_opened_where_it_is_wanted_and_the_axis_is_known_by_it(modules: Modules) -> None:
    seen = desk(
        modules,
        """const look = () => [inHand().axes.map(({name}) => name), inHand().active,
            links()[inHand().ids[inHand().active]]?.number];
        await actions.openRevision(kept, 2, 'axis'); const seen = [look()];
        store.dispatch(work.undo); seen.push(look());
        await actions.openRevision(kept, 1, 'beside'); seen.push(look());
        await actions.openRevision(kept, 3, 'all'); return [...seen, look(), Object.keys(links()).length];""",
    )
    assert seen[:4] == [
        [["of 2", "B"], 0, 2],
        [["A", "B"], 0, None],
        [["A", "B", "of 1"], 2, 1],
        [["of 3"], 0, 3],
    ]
    assert seen[4] == 2  # what was undone before can't come back


def test_what_gives_way_to_a_fifth_pinned_revision_is_told(modules: Modules) -> None:
    gone = desk(
        modules,
        "const gone = []; for (const one of [1, 2, 3, 4, 5, 5]) gone.push(await actions.pin(kept, one)); return gone;",
    )
    assert gone == [None, None, None, None, "Lift, revision 1", None]
    drawn = "Drawn into the plots, beside the design in hand: revision 5 of “Lift”"
    assert modules.call(MODULE, "pinnedText", "Lift", [5], []) == f"{drawn}."
    assert modules.call(MODULE, "pinnedText", "Lift", [5], ["Lift, revision 1"]) == (
        f"{drawn}, in the place of “Lift, revision 1”: more could not be told from each other."
    )


def test_a_save_says_which_version_it_is_of_and_who_was_quicker_is_heard(modules: Modules) -> None:
    seen = desk(
        modules,
        """const save = (...more) => actions.saveRevision(actions.inHand(), ...more);
        const first = await save('one'); const seen = [asked.at(-1)[0], links()[5].version];
        const second = await save('two');
        seen.push(asked.at(-1).slice(0, 3), links()[5].number, links()[5].version);
        answers.save = quicker;
        const third = await save('three'); seen.push(Object.keys(third), links()[5].version);
        answers.save = async () => kept;
        await save('three', {...kept, version: 9}); return [...seen, asked.at(-1)[2]];""",
    )
    assert seen == ["add", 1, ["save", "a", 1], 3, 7, ["conflict"], 7, 9]


def test_one_s_own_save_whose_answer_was_lost_is_no_conflict(modules: Modules) -> None:
    kept, conflict = desk(
        modules,
        """store.dispatch(link, 5, {...kept, number: 2, version: 4, design}); answers.save = quicker;
        answers.revision = async (id, number) => ({number, design: inHand().axes[0]});
        const first = await actions.saveRevision(actions.inHand(), 'mine');
        const now = links()[5];
        answers.revision = async (id, number) => ({number, design: {...design, name: 'theirs'}});
        const second = await actions.saveRevision(actions.inHand(), 'mine');
        return [[Object.keys(first), now.number, now.version], Object.keys(second)];""",
    )
    assert kept == [["kept"], 3, 7]
    assert conflict == ["conflict"]


def test_what_is_as_the_library_has_it_takes_the_place_of_nothing_set_aside(modules: Modules) -> None:
    seen = desk(
        modules,
        """const {isAllKept} = await import('/app/library.js');
        const seen = [isAllKept(store.state())];
        await actions.openRevision(kept, 2, 'all'); seen.push(isAllKept(store.state()));
        store.dispatch(work.setName, 'Changed'); return [...seen, isAllKept(store.state())];""",
    )
    assert seen == [False, True, False]


# Mine is looked at, and another axis is in hand when it is saved: beside it, or in its place.
@pytest.mark.parametrize(
    ("happens", "name", "linked"),
    [
        ("", "A", [5]),
        ("store.dispatch(work.setName, 'Renamed');", "Renamed", [5]),
        ("store.dispatch(work.choose, 7);", "A", [5]),
        ("await actions.openRevision(kept, 2, 'beside');", "A", [5, "new"]),
        ("await actions.openRevision(kept, 2, 'axis');", "A", [5, "new"]),
        ("await actions.openRevision(kept, 2, 'all');", "A", [5, "new"]),
    ],
)
@pytest.mark.parametrize("how", ["saveRevision(mine, 'note', {...kept, version: 9})", "saveNew(mine, {})"])
def test_what_was_to_be_saved_is_saved_whatever_is_in_hand_by_then(
    modules: Modules, happens: str, name: str, linked: list[object], how: str
) -> None:
    saved, known = desk(
        modules,
        f"""store.dispatch(link, 5, {{...kept, number: 2, version: 4, design}});
        const mine = actions.inHand();
        {happens}
        await actions.{how};
        const given = asked.at(-1);
        return [given.find((one) => one?.move).name,
            Object.entries(links()).map(([axis, {{version}}]) => [Number(axis), version])];""",
    )
    assert saved == name
    ids = [axis if axis in (5, 7) else "new" for axis, _ in known]
    assert ids == linked


@pytest.mark.parametrize(
    ("before", "asked", "words"),
    [
        ("", ["add", "keepRecord"], "Trace kept in the library with “Lift”, revision 1, which was saved for it."),
        (
            "store.dispatch(link, 5, {...kept, number: 2, design: inHand().axes[0]});",
            ["keepRecord"],
            "Trace kept in the library with “Lift”, revision 2.",
        ),
        (
            "store.dispatch(link, 5, {...kept, number: 2, design});",
            ["save", "keepRecord"],
            "Trace kept in the library with “Lift”, revision 3, which was saved for it.",
        ),
        (
            "store.dispatch(link, 5, {...kept, number: 2, design}); answers.save = quicker;",
            ["save"],
            "Trace not kept in the library: Somebody else has changed its design in the library meanwhile: "
            "save yours in the library first.",
        ),
        (
            "answers.add = () => Promise.reject(new Refusal(503, [{message: 'The disk is full.'}]));",
            ["add"],
            "Trace not kept in the library: The disk is full.",
        ),
    ],
)
def test_what_was_measured_is_kept_with_the_revision_that_it_is_of(
    modules: Modules, before: str, asked: list[str], words: str
) -> None:
    seen = desk(
        modules,
        f"""{before} await actions.keepRecord('trace', {{step: [1]}}, {{axis: null, design: null}});
        return [asked.map(([name]) => name), store.state().told.notice.text];""",
    )
    assert seen == [asked, words]


def test_of_a_long_trace_as_much_is_kept_as_a_record_has_and_that_is_told(modules: Modules) -> None:
    count, first, last, matches, rest, words = desk(
        modules,
        """const step = Array.from({length: 120000}, (_, at) => at + 1);
        const trace = {step, measured_ticks: step.map((one) => one * 1000.5), timer_hz: 2e6, none: []};
        await actions.keepRecord('trace', trace, {axis: null, design: null});
        const {document: thin} = asked.at(-1)[2];
        return [thin.step.length, thin.step[0], thin.step.at(-1),
            thin.measured_ticks.every((ticks, at) => ticks === thin.step[at] * 1000.5), [thin.timer_hz, thin.none],
            store.state().told.notice.text];""",
    )
    assert (count, first, last, matches, rest) == (5000, 1, 120_000, True, [2e6, []])
    assert words.endswith(" Of its 120,000 steps 5,000 are kept, evenly apart.")


def test_what_was_pushed_is_opened_with_the_revisions_that_it_is(modules: Modules) -> None:
    seen = desk(
        modules,
        """await actions.openPush('p');
        return [inHand().axes.length, inHand().ids.map((id) => links()[id]?.number ?? null)];""",
    )
    assert seen == [2, [2, None]]


def test_what_axes_began_with_outlasts_a_reload(modules: Modules) -> None:
    script = f"""async ([design, link]) => {{ {STATE}
        const {{recordOf}} = await import('/app/effects/autosave.js');
        const {{parseRecord}} = await import('/documents/records.js');
        const record = recordOf({{...state, library: {{links: {{5: link, 99: link}}, beside: []}}}});
        const parsed = (changed) => parseRecord(JSON.stringify({{...record, ...changed}})).links;
        return [parsed({{}}), parsed({{links: undefined}}), parsed({{links: {{5: {{...link, version: '5'}}}}}})]; }}"""
    assert modules.evaluate(script, [document(), LINK]) == [{"5": LINK}, {}, {}]


def test_of_revisions_laid_beside_the_oldest_gives_way(modules: Modules) -> None:
    seen = desk(
        modules,
        """const {layBeside, takeAway} = await import('/app/commands/library.js');
        for (const number of [1, 2, 2, 3, 4, 5]) store.dispatch(layBeside, {key: `a ${number}`, label: '', design});
        store.dispatch(takeAway, 'a 4');
        return store.state().library.beside.map(({key}) => key);""",
    )
    assert seen == ["a 2", "a 3", "a 5"]
