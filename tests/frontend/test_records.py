"""What each tab of a browser keeps, and which tab goes on with what: with a storage and locks as browsers have them."""

import copy
from typing import Any

import pytest

from designs import document
from frontend.modules import Modules

# Tabs of one browser share a storage and its locks; `goTo(tab)` is that tab's page, `closed(tab)` lets go of its locks.
BROWSER = """
    const texts = new Map(), locks = new Map(), sessions = new Map();
    let current = 'first', room = Infinity;
    const storage = (kept) => ({getItem: (key) => kept().get(key) ?? null, key: (index) => [...kept().keys()][index],
        get length() { return kept().size; }, removeItem: (key) => kept().delete(key),
        setItem: (key, text) => {
            if (text.length > room) throw new DOMException('full', 'QuotaExceededError');
            kept().set(key, text); }});
    const session = () => sessions.get(current) ?? sessions.set(current, new Map()).get(current);
    globalThis.localStorage = storage(() => texts);
    globalThis.sessionStorage = storage(session);
    const request = async (name, {ifAvailable, signal}, act) => {
        const waits = () => locks.has(name) && !signal?.aborted;
        while (!ifAvailable && waits()) await new Promise((done) => setTimeout(done, 5));
        if (signal?.aborted) throw new DOMException('given up', 'AbortError');
        if (locks.has(name)) return act(null);
        locks.set(name, current);
        const held = act({name});
        const ended = await Promise.race([held, new Promise((done) => setTimeout(() => done('open'), 5))]);
        if (ended !== 'open') locks.delete(name);
    };
    const query = async () => ({held: [...locks.keys()].map((name) => ({name})), pending: []});
    const known = {locks: {request, query}};
    Object.defineProperty(globalThis, 'navigator', {value: known, configurable: true});
    const goTo = (tab) => { current = tab; };
    const closed = (tab) => { for (const [name, by] of locks) if (by === tab) locks.delete(name); };
    const {records, beyondBounds, parseRecord} = await import('/documents/records.js');
    const {openTab, openTabs, forgetOldTabs} = await import('/documents/tab.js');
    const nameOf = (record) => record?.machine.axes[0].name ?? null;
    const open = async (tab) => { goTo(tab); const {id, record} = await openTab(); return [id, nameOf(record)]; };
    const machineOf = (name) => ({...RECORD.machine, axes: [{...RECORD.machine.axes[0], name}]});
    const keep = (id, name, at_ms, more = {}) =>
        records.write(id, {...RECORD, ...more, at_ms, machine: machineOf(name)});
"""

RECORD: dict[str, Any] = {
    "at_ms": 5,
    "isOwn": True,
    "isExample": False,
    "machine": {"axes": [document()], "ids": [3], "active": 0, "together": "independent", "kept": None},
    "replaced": None,
    "units": {"length": "mm", "time": "min"},
    "shown": ["exact", "newton"],
    "views": {
        "3": {
            "against": "time",
            "part": "up",
            "only": "delay",
            "third": "parts",
            "acceleration": True,
            "zoom": [2, 5],
            "range": None,
        }
    },
    "areAllShown": True,
    "allZoom": [0, 1.5],
    "guide": {"drive": "wheel", "player": "marlin"},
    "links": {"0": {"id": "a", "name": "Lift", "number": 2, "version": 5, "design": document()}},
    "inFlight": [{"atMs": 0, "kind": "target", "value": 500}, {"atMs": "soon", "kind": "speed", "value": -20}],
}


def run(modules: Modules, script: str) -> Any:
    """Return what a script sees that has a browser with several tabs."""
    return modules.evaluate(f"async (RECORD) => {{ {BROWSER} {script} }}", RECORD)


def test_a_reload_finds_the_tabs_own_record(modules: Modules) -> None:
    seen = run(
        modules,
        """const [a] = await open('a'); keep(a, 'Of a', 1);
        const [b, first] = await open('b'); keep(b, 'Of b', 2);
        closed('a');
        return [first, a === b, (await open('a'))[1], (await open('a'))[0] === a];""",
    )
    # The third time another page has the lock still: the tab was duplicated.
    assert seen == [None, False, "Of a", False]


def test_a_reload_waits_for_the_page_before_it_and_a_duplicate_gets_a_copy(modules: Modules) -> None:
    seen = run(
        modules,
        """const [a] = await open('a'); keep(a, 'Of a', 1);
        setTimeout(() => closed('a'), 100);
        const reloaded = await open('a');
        const copied = await open('a');
        keep(copied[0], 'Of the copy', 2);
        return [reloaded[0] === a, copied[0] === a, copied[1], nameOf(records.read(a))];""",
    )
    assert seen == [True, False, "Of a", "Of a"]


def test_a_new_tab_goes_on_with_the_newest_closed_one_and_never_with_an_open_one(modules: Modules) -> None:
    seen = run(
        modules,
        """const [a] = await open('a'); keep(a, 'Of a', 9);
        keep('older', 'Older', 1); keep('newer', 'Newer', 2); keep('example', 'An example', 8, {isOwn: false});
        return [(await open('b')), (await open('c')), (await open('d'))[1], [...await openTabs()].includes(a)];""",
    )
    assert seen == [["newer", "Newer"], ["older", "Older"], None, True]


def test_two_tabs_that_begin_at_once_share_nothing(modules: Modules) -> None:
    script = """keep('closed', 'Closed', 1);
        const begun = [open('a'), open('b')];
        return (await Promise.all(begun)).map(([, name]) => name).sort();"""
    assert run(modules, script) == ["Closed", None]


def test_what_can_not_be_shown_is_left_where_it_is(modules: Modules) -> None:
    seen = run(
        modules,
        """const [a] = await open('a'); closed('a');
        texts.set('stepramp.tab.' + a, '{not json');
        const [other, name] = await open('a');
        keep(other, 'Next', 1);
        return [other === a, name, texts.get('stepramp.tab.' + a)];""",
    )
    assert seen == [False, None, "{not json"]


def test_old_tabs_are_forgotten_beyond_twelve_and_open_ones_never(modules: Modules) -> None:
    seen = run(
        modules,
        """const [a] = await open('a'); keep(a, 'Of a', 0, {isOwn: false});
        for (let index = 1; index <= 14; index++) keep(`tab ${index}`, `Tab ${index}`, index);
        keep('example', 'An example', 99, {isOwn: false});
        await forgetOldTabs();
        return records.all().map(({record}) => nameOf(record));""",
    )
    assert seen == [*[f"Tab {index}" for index in range(14, 2, -1)], "Of a"]


def test_old_tabs_are_forgotten_when_they_are_too_long_together(modules: Modules) -> None:
    # Three of 900,000 characters: with the third there are more than two million.
    seen = run(
        modules,
        """const long = 'x'.repeat(900_000);
        for (const [index, id] of ['old', 'middle', 'new'].entries()) keep(id, long, index);
        return beyondBounds(['old', 'middle', 'new']);""",
    )
    assert seen == ["old"]


def test_a_full_browser_keeps_what_it_had_and_tells(modules: Modules) -> None:
    seen = run(
        modules,
        """keep('theirs', 'Theirs', 1); keep('mine', 'Before', 2);
        room = 10;
        const told = keep('mine', 'After', 3);
        const [mine, theirs] = ['mine', 'theirs'].map((id) => nameOf(records.read(id)));
        room = Infinity;
        localStorage.setItem = () => { throw new Error('forbidden'); };
        return [told, mine, theirs, keep('mine', 'After', 3)];""",
    )
    assert seen == ["full", "Before", "Theirs", "refused"]


# Elsewhere tabs ask each other: `there` are those that answer.
WITHOUT_LOCKS = """
    delete known.locks;
    const there = (globalThis.thereToo ??= new Set());
    there.clear();
    globalThis.BroadcastChannel = class { postMessage({here}) {
        const answer = (id) => setTimeout(() => this.onmessage({data: {here: id}}), 5);
        if (here === undefined) globalThis.thereToo.forEach(answer); } };
"""


def test_without_locks_tabs_ask_each_other_whose_record_is_whose(modules: Modules) -> None:
    """As where several people share a server, and the page is not served securely."""
    seen = run(
        modules,
        f"""{WITHOUT_LOCKS}
        const [a, first] = await open('a'); keep(a, 'Of a', 1);
        const reloaded = await open('a');
        there.add(a);
        const duplicate = await open('a');
        const another = await open('b');
        return [first, reloaded[0] === a, reloaded[1], duplicate[0] === a, duplicate[1], another[1],
            nameOf(records.read(a)), [...await openTabs()].includes(a)];""",
    )
    assert seen == [None, True, "Of a", False, "Of a", None, "Of a", True]


def test_without_locks_closed_tabs_are_forgotten_and_open_ones_are_not(modules: Modules) -> None:
    seen = run(
        modules,
        f"""{WITHOUT_LOCKS}
        for (let at = 0; at < 20; at += 1) keep(`tab${{at}}`, `Of ${{at}}`, at);
        there.add('tab0');
        await forgetOldTabs();
        return records.all().map(({{id}}) => id);""",
    )
    assert seen == [*(f"tab{at}" for at in range(19, 7, -1)), "tab0"]


def test_a_browser_that_refuses_storage_has_tabs_all_the_same(modules: Modules) -> None:
    seen = run(
        modules,
        """for (const name of ['localStorage', 'sessionStorage'])
            Object.defineProperty(globalThis, name, {configurable: true, get: () => { throw new Error('no'); }});
        const nowhere = await open('c');
        for (const name of ['localStorage', 'sessionStorage']) delete globalThis[name];
        return nowhere[1];""",
    )
    assert seen is None


def test_what_all_tabs_shared_before_is_gone_on_with(modules: Modules) -> None:
    seen = run(
        modules,
        """texts.set('stepramp.work', JSON.stringify(RECORD.machine));
        texts.set('stepramp.work.replaced', JSON.stringify(RECORD.machine));
        goTo('a'); const {id, record} = await openTab();
        return [nameOf(record), record.replaced.ids, texts.size, texts.has('stepramp.work')];""",
    )
    assert seen == [document()["name"], [3], 1, False]


def test_what_all_tabs_shared_stays_where_it_can_not_be_read(modules: Modules) -> None:
    seen = run(
        modules,
        """texts.set('stepramp.work.replaced', '{"schema": "stepramp/9"}');
        texts.set('stepramp.work', 'newer');
        goTo('a'); const first = (await openTab()).record;
        const kept = texts.size;
        texts.set('stepramp.work', JSON.stringify(RECORD.machine));
        sessions.clear(); locks.clear(); goTo('b'); const {record} = await openTab();
        return [first, kept, nameOf(record), record.replaced, texts.get('stepramp.work.replaced')];""",
    )
    assert seen == [None, 2, document()["name"], None, '{"schema": "stepramp/9"}']


def parsed(modules: Modules, record: object) -> Any:
    script = "async (record) => (await import('/documents/records.js')).parseRecord(JSON.stringify(record))"
    return modules.evaluate(script, record)


def test_a_record_is_read_as_it_was_written(modules: Modules) -> None:
    assert parsed(modules, RECORD) == RECORD


WRONG = [
    ("at_ms", None),
    ("machine", None),
    ("machine", {**RECORD["machine"], "axes": []}),
    ("machine", {**RECORD["machine"], "axes": [document()] * 5}),
    ("machine", {**RECORD["machine"], "active": 1}),
    ("machine", {**RECORD["machine"], "kept": {"schema": "stepramp/9"}}),
    ("machine", {**RECORD["machine"], "together": "apart"}),
]


@pytest.mark.parametrize(("name", "value"), WRONG)
def test_a_record_that_can_not_be_shown_is_none(modules: Modules, name: str, value: object) -> None:
    assert parsed(modules, {**RECORD, name: value}) is None


MENDED = [
    ("guide", {"drive": "rocket", "player": "toString"}, {"drive": None, "player": None}),
    ("guide", None, {"drive": None, "player": None}),
    ("replaced", {"axes": 1}, None),
    ("inFlight", [], None),
    ("inFlight", [{"atMs": 0, "kind": "jump", "value": 5}], None),
    ("inFlight", [{"atMs": None, "kind": "target", "value": 5}], None),
    ("units", {"length": "furlong", "time": "s"}, {"length": "steps", "time": "s"}),
    ("shown", ["newton", "third_order", "exact"], ["exact", "newton"]),
    ("views", {"3": {"against": "moon"}}, {}),
    ("views", 7, {}),
    ("allZoom", [3, 1], None),
    ("areAllShown", 1, False),
]


@pytest.mark.parametrize(("name", "value", "read"), MENDED)
def test_what_is_unknown_of_a_record_is_left_out(modules: Modules, name: str, value: object, read: object) -> None:
    assert parsed(modules, {**RECORD, name: value}) == {**RECORD, name: read}


def test_an_example_is_known_again_before_the_server_has_told_of_any(modules: Modules) -> None:
    script = """async (record) => { const {rememberedState} = await import('/app/effects/autosave.js');
        const {COMMANDS: {work}} = await import('/app/commands/commands.js');
        const {isOwnWork} = await import('/app/selectors.js');
        const own = (isExample) => {
            const begun = work.begin(rememberedState({id: 't', record: {...record, isExample}}, 9), record.machine);
            return [isOwnWork(begun), isOwnWork(work.setName(begun, 'Mine'))]; };
        return [own(true), own(false)]; }"""
    assert modules.evaluate(script, RECORD) == [[False, True], [True, True]]


def test_a_reload_remembers_what_makes_the_steps(modules: Modules) -> None:
    script = """async (record) => { const {recordOf, rememberedState} = await import('/app/effects/autosave.js');
        const {begin} = (await import('/app/commands/commands.js')).COMMANDS.work;
        const written = recordOf(begin(rememberedState({id: 't', record}, 9), record.machine));
        return rememberedState({id: 't', record: written}, 9).guide; }"""
    guide = modules.evaluate(script, RECORD)
    assert guide == {"isOpen": False, "step": "motor", "drive": "wheel", "player": "marlin"}


def test_axes_without_ids_get_some(modules: Modules) -> None:
    record = copy.deepcopy(RECORD)
    record["machine"]["axes"] *= 2
    assert parsed(modules, record)["machine"]["ids"] == [0, 1]
