"""Dialogs and notices without a browser: what they ask, ask again, and show.

Plain objects stand in for elements.
"""

import json
from typing import Any

import pytest

from designs import document
from frontend.modules import Modules
from stepramp.errors import Rejected
from stepramp.http_api.errors import error_items
from stepramp.http_api.json_response import json_bytes
from stepramp.http_api.tables_models import FitPayload

# `textOf(element)` is all its text; `find(element, wanted)` the first within it that `wanted` is true of.
# `pass()` ends what waits, as time does; `settled()` lets all promises go on.
ELEMENTS = """
    const own = {document: globalThis.document, HTMLInputElement: globalThis.HTMLInputElement,
        addEventListener: globalThis.addEventListener, setTimeout: globalThis.setTimeout,
        clearTimeout: globalThis.clearTimeout};
    const made = (tag) => { const heard = {};
        const plain = {tag, children: [], dataset: {}, style: {}, value: '', textContent: '',
            hidden: false, options: [], open: false, classList: {toggle() {}, add() {}, remove() {}},
            addEventListener(name, act) { heard[name] = act; }, emit(name, event) { heard[name]?.(event); },
            get lastElementChild() { return this.children.at(-1) ?? null; },
            append(...more) { this.children.push(...more); }, replaceChildren(...more) { this.children = more; },
            setAttribute(name, value) { this[name] = value; }, getAttribute(name) { return this[name] ?? null; },
            removeAttribute(name) { delete this[name]; }, toggleAttribute() {},
            querySelectorAll: () => [], querySelector: () => made('input'), focus() {}, select() {},
            show() { this.open = true; }, close() { this.open = false; heard.close?.(); }};
        return new Proxy(plain, {has: () => true}); };
    const body = made('body'), waiting = new Map();
    globalThis.document = {createElement: made, createElementNS: (_, tag) => made(tag), body, activeElement: null};
    globalThis.HTMLInputElement = class {};
    globalThis.addEventListener = () => {};
    globalThis.setTimeout = (act) => { const id = {}; waiting.set(id, act); return id; };
    globalThis.clearTimeout = (id) => waiting.delete(id);
    const pass = () => { const due = [...waiting.values()]; waiting.clear(); for (const act of due) act(); };
    const settled = () => new Promise((done) => own.setTimeout(done, 0));
    const textOf = (one) => typeof one === 'string' ? one : one.textContent + one.children.map(textOf).join(' ');
    const find = (one, wanted) => typeof one === 'string' ? null : wanted(one) ? one :
        one.children.map((child) => find(child, wanted)).find((found) => found) ?? null;
    const byId = (id) => find(body, (one) => one.id === id);
    const {ServerGone} = await import('/server/api.js');
    const gone = () => Promise.reject(new ServerGone('gone'));
"""


def run(modules: Modules, script: str) -> Any:
    """Return what a script makes of a design, with elements to stand in for a page's."""
    whole = f"async (design) => {{ {ELEMENTS} try {{ {script} }} finally {{ Object.assign(globalThis, own); }} }}"
    return modules.evaluate(whole, document())


NOBODY = "The server does not answer. It is asked again until it does."


@pytest.mark.parametrize("back", ["pass()", "dialog.again()"])
def test_a_fit_is_asked_for_again_until_the_server_answers(modules: Modules, back: str) -> None:
    seen = run(
        modules,
        f"""const {{createFitDialog}} = await import('/panels/table/fit_dialog.js');
        const asked = [];
        let answer = gone;
        const dialog = createFitDialog({{fitTable: (to) => {{ asked.push(to.name); return answer(); }},
            fitCurve: () => gone()}}, () => {{}});
        dialog.open(design, 3); await settled();
        const first = textOf(byId('fit-result'));
        answer = async () => ({{table: {{rows: [[1, 2]]}}, rows: 1, bytes: 4, largest_relative_error: 0.5,
            relative_errors: [0.5], floor: {{relative_error: 0.1, ramp_index: 2}}, linear_rows: null}});
        {back}; await settled();
        const then = textOf(byId('fit-result'));
        dialog.show({{...design, name: 'Steeper', ramp: {{...design.ramp, acceleration_steps_per_s2: 77}}}}, 3);
        await settled();
        answer = gone; dialog.show(design, 3); await settled();
        dialog.close(); pass(); await settled();
        return [first, then, asked, waiting.size];""",
    )
    first, then, asked, waiting = seen
    assert NOBODY in first
    assert "1 row" in then
    assert asked == [document()["name"]] * 2 + ["Steeper", document()["name"]], "closed, it asks no more"
    assert waiting == 0


def test_what_is_played_is_asked_for_again_and_follows_the_axis_that_it_was_opened_for(modules: Modules) -> None:
    first, then, asked = run(
        modules,
        """const {createPlayDialog} = await import('/panels/table/play_dialog.js');
        const asked = [];
        let answer = gone;
        const dialog = createPlayDialog((request) => { asked.push(request.table.rows[0][1]); return answer(); });
        const tabled = (delay) => ({...design, table: {rows: [[1, delay]], interval_unit: 'us'}});
        dialog.open(tabled(900), 3); await settled();
        const first = textOf(byId('play-result'));
        answer = async () => ({stops: [{at_us: 1000, position: 7}], steps: {position: [1], at_us: [1]}});
        dialog.again(); await settled();
        const then = textOf(byId('play-result'));
        dialog.show(tabled(800), 3); dialog.show(tabled(700), 4); await settled();
        const removed = {...design, table: null};
        dialog.show(removed, 3); await settled();
        return [first, then, [...asked, textOf(byId('play-result'))]];""",
    )
    assert NOBODY in first
    assert "At rest at step 7" in then
    assert asked[:3] == [900, 900, 800]
    assert "no table" in asked[3]
    assert len(asked) == 4, "another axis is not played"


def test_what_is_told_in_flight_is_asked_for_again_and_follows_the_design(modules: Modules) -> None:
    first, then, asked = run(
        modules,
        """const {createFlight} = await import('/panels/flight/flight.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work, device}} = await import('/app/commands/commands.js');
        const asked = [];
        let answer = gone;
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const panel = createFlight((play) => { asked.push([play.design.name, play.commands]); return answer(); });
        store.subscribe(panel.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        await settled();
        panel.open(); await settled();
        const first = textOf(byId('flight-result'));
        answer = async () => ({timer_hz: 1000, at_ticks: [0], interval_ticks: [100], position_steps: [1],
            direction: [1], rests: [{at_s: 0.1, position_steps: 1}], told_position_steps: [0, 1]});
        store.dispatch(device.linked, 'gone'); store.dispatch(device.linked, 'there'); await settled(); await settled();
        const then = textOf(byId('flight-result'));
        store.dispatch(work.setName, 'Other'); await settled();
        byId('flight-dialog').close(); store.dispatch(work.setName, 'Another'); await settled();
        return [first, then, asked];""",
    )
    assert NOBODY in first
    assert "At rest at 1 step after 100.0 ms" in then
    proposed = [{"at_s": 0, "target_steps": document()["move"]["steps"]}, {"at_s": 0.5, "target_steps": 0}]
    assert asked == [[name, proposed] for name in (document()["name"], document()["name"], "Other")]


def test_backups_that_can_not_be_listed_say_so_and_are_asked_for_again(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createMachine} = await import('/panels/device/machine.js');
        const {Refusal} = await import('/server/api.js');
        let answer = gone;
        const machine = createMachine({startFrom() {}, restoreBackup() {}, listBackups: () => answer()}, () => {});
        body.append(machine.element);
        const show = (backup) => machine.show({device: {id: '1', backup, axes: [], capabilities: ['backup']}, axis: 0,
            design, inTheWay: '', notAtRest: '', situation: {isBusy: false}});
        const look = () => [byId('backups').hidden, byId('backups-unlisted').textContent];
        show('a'); await settled(); const seen = [look()];
        answer = async () => [{name: '2026-01-01T00-00-00.000000Z'}]; pass(); await settled(); seen.push(look());
        answer = () => Promise.reject(new Refusal(500, [{message: 'StepRamp made a mistake.'}]));
        show('b'); await settled(); seen.push(look());
        answer = () => Promise.reject(new Refusal(404, [{message: 'no'}])); show('c'); await settled();
        return [...seen, look(), waiting.size];""",
    )
    assert seen[0] == [True, f"Its backups can’t be listed: {NOBODY}"]
    assert seen[1] == [False, ""]
    assert seen[2] == [True, "StepRamp made a mistake."]
    assert seen[3:] == [[True, ""], 0]


def test_a_backup_is_kept_and_restored_only_as_it_is_in_view(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createBackups} = await import('/panels/backups/backups.js');
        const {FIRST_STATE} = await import('/app/state.js');
        const answers = {};
        const source = {name: 'grbl-a', family: 'grbl', plugged_in: 'a', backups: [{name: 'new'}, {name: 'old'}]};
        const dialog = createBackups({state: () => FIRST_STATE}, {restoreFrom() {}}, {
            archive: async () => ({sources: [source]}),
            archived: (from, name) => new Promise((done) => { answers[name] = done; })});
        dialog.open(); await settled();
        const look = () => [byId('backup-text').textContent, byId('backup-download').disabled];
        const seen = [look()];
        answers.new('of the new'); await settled(); seen.push(look());
        byId('backup-name').value = 'old'; byId('backup-name').onchange(); seen.push(look());
        answers.old('of the old'); await settled(); seen.push(look());
        return seen;""",
    )
    assert seen == [["", True], ["of the new", False], ["", True], ["of the old", False]]


@pytest.mark.parametrize(
    ("device", "saved", "chosen"),
    [
        (None, [], "klipper-other 2026-d"),
        ({"family": "grbl"}, ["2026-b"], "grbl-mine 2026-b"),
        ({"family": "grbl", "lacks_backup": "2026-a"}, ["2026-b", "2026-a"], "grbl-mine 2026-a"),
        # Of that one nothing is saved yet: there may be backups of before it was plugged in elsewhere.
        ({"family": "grbl"}, [], "grbl-other 2026-c"),
        ({"family": "fluidnc"}, [], "grbl-other 2026-c"),
        ({"family": "tic"}, [], "klipper-other 2026-d"),
    ],
)
def test_backups_of_the_device_in_view_are_shown_first(
    modules: Modules, device: dict[str, object] | None, saved: list[str], chosen: str
) -> None:
    state = {"state": "ready", "id": "1", "port": "sim://", "capabilities": ["backup"]}
    told = json.dumps([] if device is None else [{**state, **device}])
    seen = run(
        modules,
        f"""const {{createBackups}} = await import('/panels/backups/backups.js');
        const {{FIRST_STATE}} = await import('/app/state.js');
        const families = Object.entries({{grbl: 'grbl', fluidnc: 'grbl', tic: 'tic'}})
            .map(([name, kind]) => ({{name, kind}}));
        const state = {{...FIRST_STATE, devices: {{...FIRST_STATE.devices, families, list: {told}}}}};
        const of = (name, ...backups) => ({{name, family: name.split('-')[0], plugged_in: '',
            backups: backups.map((one) => ({{name: one}}))}});
        const dialog = createBackups({{state: () => state}}, {{restoreFrom() {{}}}}, {{
            archive: async () => ({{sources: [of('klipper-other', '2026-d'), of('grbl-other', '2026-c'),
                of('grbl-mine', '2026-b', '2026-a')]}}),
            backups: async () => ({{backups: {json.dumps([{"name": name} for name in saved])}}}),
            archived: async (from, name) => `${{from}} ${{name}}`}});
        dialog.open(); await settled(); await settled();
        return [byId('backup-source').value, byId('backup-text').textContent];""",
    )
    assert seen == [chosen.split(maxsplit=1)[0], chosen]


def test_the_backup_that_is_lacking_is_offered_first(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createMachine} = await import('/panels/device/machine.js');
        const machine = createMachine({startFrom() {}, restoreBackup() {},
            listBackups: async () => [{name: 'new'}, {name: 'first'}, {name: 'older'}]}, () => {});
        body.append(machine.element);
        const seen = [];
        for (const lacks_backup of [null, 'first', 'gone', null]) {
            machine.show({device: {id: '1', backup: 'new', lacks_backup, axes: [], capabilities: ['backup']}, axis: 0,
                design, inTheWay: '', notAtRest: '', situation: {isBusy: false}});
            await settled();
            seen.push(byId('backup').value);
        }
        return seen;""",
    )
    assert seen == ["new", "first", "new", "new"]


def test_backups_that_come_late_are_not_those_of_the_device_in_view(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createMachine} = await import('/panels/device/machine.js');
        const answers = {}, restored = [];
        const machine = createMachine({startFrom() {}, restoreBackup: ({id}, name) => restored.push([id, name]),
            listBackups: ({id}) => new Promise((done) => { answers[id] = done; })}, () => {});
        body.append(machine.element);
        const show = (id, backup) => machine.show({
            device: {id, backup, axes: [], capabilities: ['backup']}, axis: 0, design,
            inTheWay: '', notAtRest: '', situation: {isBusy: false}});
        const backup = (name) => [{name}];
        const look = () => [byId('backups').hidden, byId('backup').value];
        show('1', 'old'); show('2', 'new');
        answers[1](backup('2026-01-01T00-00-00.000000Z')); await settled();
        const seen = [look()];
        answers[2](backup('2026-02-02T00-00-00.000000Z')); await settled();
        byId('restore-backup').onclick();
        return [...seen, look()[0], restored];""",
    )
    assert seen == [[True, ""], False, [["2", "2026-02-02T00-00-00.000000Z"]]]


@pytest.mark.parametrize(
    ("lets", "changed", "note"),
    [
        # A page that is not served securely has no clipboard: there the text is selected and copied as by hand.
        (True, False, "Copied a.h."),
        (False, False, "The browser does not let this page copy: use Download."),
        (True, True, "It is being made …"),
    ],
)
def test_an_export_is_copied_also_where_there_is_no_clipboard(
    modules: Modules, lets: bool, changed: bool, note: str
) -> None:
    seen = run(
        modules,
        f"""const {{createExport}} = await import('/panels/export/export.js');
        const {{createStore, FIRST_STATE}} = await import('/app/state.js');
        const {{COMMANDS: {{work}}}} = await import('/app/commands/commands.js');
        const copied = [], [lets, changed] = {json.dumps([lets, changed])};
        document.execCommand = (what) => {{ copied.push(what); return lets; }};
        const remove = Object.assign(made('textarea'), {{remove() {{}}}});
        document.createElement = (tag) => tag === 'textarea' ? remove : made(tag);
        const store = createStore(FIRST_STATE, (error) => {{ throw error; }});
        let answer = async () => ({{file: new Blob(['int a;']), name: 'a.h'}});
        const panel = createExport(store, {{report: gone, exportDesign: () => answer()}});
        store.subscribe(panel.show);
        store.dispatch(work.begin, {{axes: [design], together: 'independent'}});
        panel.open('c_table'); await settled(); await settled();
        byId('export-copy').onclick();
        answer = () => new Promise(() => {{}});
        if (changed) store.dispatch(work.setName, 'Other');
        await settled();
        return [copied, find(body, (one) => one.className === 'export-note muted').textContent, remove.value];""",
    )
    assert seen == [["copy"], note, "int a;"]


CANCELLED = {
    "fit": """const {createFitDialog} = await import('/panels/table/fit_dialog.js');
        const dialog = createFitDialog({fitTable: wait, fitCurve: wait}, () => {});
        dialog.open(design, 3); await settled();
        dialog.close();""",
    "play": """const {createPlayDialog} = await import('/panels/table/play_dialog.js');
        const dialog = createPlayDialog(wait);
        dialog.open({...design, table: {rows: [[1, 900]], interval_unit: 'us'}}, 3); await settled();
        dialog.close();""",
    "checks": """const {createChecks} = await import('/panels/table/checks.js');
        const checks = createChecks(wait, () => {});
        checks.check({...design, table: {rows: [[1, 900]], interval_unit: 'us'}}, 3); pass(); await settled();
        checks.check({...design, table: null}, 3);""",
    "guide": """const {createUseStep} = await import('/panels/guide/use.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work, guide, answers}} = await import('/app/commands/commands.js');
        const {axisOf} = await import('/app/selectors.js');
        const step = createUseStep({}, {machine: wait});
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        store.subscribe(step.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        store.dispatch(guide.setPlayer, 'grbl');
        store.dispatch(answers.curvesCame, {}, axisOf(store.state())); await settled();
        store.dispatch(guide.setPlayer, 'stepramp');""",
}
EXPORTED = """const {createExport} = await import('/panels/export/export.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work}} = await import('/app/commands/commands.js');
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const panel = createExport(store, {report: wait, exportDesign: wait, machine: wait}, wait);
        store.subscribe(panel.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});"""


@pytest.mark.parametrize(
    ("script", "count"),
    [
        (CANCELLED["fit"], 2),
        (CANCELLED["play"], 1),
        (CANCELLED["checks"], 1),
        (CANCELLED["guide"], 1),
        *(
            (f"{EXPORTED} panel.open('{name}'); await settled(); byId('export-dialog').close();", 1)
            for name in ("c_table", "report_pdf", "marlin")
        ),
        # Another one doesn't wait for that which nobody wants any more.
        (
            f"{EXPORTED} panel.open('c_table'); await settled(); panel.open('report_html'); await settled();"
            " byId('export-dialog').close();",
            2,
        ),
    ],
)
def test_what_nobody_waits_for_any_more_is_asked_for_no_longer(modules: Modules, script: str, count: int) -> None:
    """Only four requests go at a time: a report that takes a minute must not keep others waiting."""
    begin = """const signals = [];
        const wait = (...given) => { signals.push(given.find((one) => one instanceof AbortSignal));
            return new Promise(() => {}); };"""
    ended = run(modules, f"{begin} {script} await settled(); return signals.map((one) => one?.aborted ?? null);")
    assert ended == [True] * count


def test_an_export_is_asked_for_again_and_follows_the_design(modules: Modules) -> None:
    first, then, asked = run(
        modules,
        """const {createExport} = await import('/panels/export/export.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work, device}} = await import('/app/commands/commands.js');
        const asked = [];
        let answer = gone;
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const panel = createExport(store, {report: gone, exportDesign: (_, {design}) => {
            asked.push(design.name); return answer(); }});
        store.subscribe(panel.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        panel.open(); await settled();
        const first = textOf(byId('export-preview'));
        answer = async () => ({file: new Blob(['int a;']), name: 'a.h'});
        store.dispatch(device.linked, 'gone'); store.dispatch(device.linked, 'there'); await settled(); await settled();
        const then = textOf(byId('export-preview'));
        store.dispatch(work.setName, 'Other'); await settled();
        return [first, then, asked];""",
    )
    assert NOBODY in first
    assert "int a;" in then
    assert asked == [document()["name"], document()["name"], "Other"]


def test_what_a_machine_is_given_is_shown_with_what_it_loses(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createExport} = await import('/panels/export/export.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work}} = await import('/app/commands/commands.js');
        const {Refusal} = await import('/server/api.js');
        const asked = [];
        let answer = async () => ({file_name: 'a.gcode', text: 'M92 X80', settings: [], remarks: ['No base speed.'],
            remarks_told: [[]]});
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const panel = createExport(store, {report: gone, exportDesign: gone, machine: (name, wanted) => {
            asked.push([name, wanted.axis_letter]); return answer(); }});
        store.subscribe(panel.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        panel.open('marlin'); await settled();
        const seen = [textOf(byId('export-preview')), textOf(byId('export-remarks')), byId('export-remarks').hidden];
        const refuse = (field) => async () => {
            throw new Refusal(422, [{field, value: 'A', allowed: 'X', message: `${field} is wrong`}]); };
        answer = refuse('design.ramp.slew_speed_steps_per_s');
        store.dispatch(work.setName, 'Other'); await settled();
        seen.push(textOf(byId('export-preview')), byId('export-remarks').hidden);
        answer = refuse('axis_letter');
        store.dispatch(work.setName, 'Third'); await settled();
        return [...seen, textOf(byId('export-preview')), asked];""",
    )
    assert seen[:3] == ["M92 X80", "No base speed.", False]
    assert "Slew speed is 'A'; allowed: X" in seen[3]
    assert seen[4] is True
    assert "Axis is 'A'; allowed: X" in seen[5]
    assert seen[6] == [["marlin", "X"]] * 3


LOST = """{text: '$100=80', file_name: 'a.gcode', settings: [],
    remarks: ['Base speed 100 steps/s is not kept.', 'Another is.'],
    remarks_told: [[{text: '100 steps/s', value: 100, unit: 'steps/s', rounding: 'nearest', axis: null}], []]}"""
REFUSED = """new Refusal(422, [{field: 'design.ramp.slew_speed_steps_per_s', value: 0.5, allowed: 'a number',
    message: 'no', limits: {lowest: 1, highest: null, is_whole: false, note: ' with it'}, unit: 'steps/s'}])"""
OF_50_STEPS_PER_MM = ["Base speed 100 steps/s is not kept.", "Base speed 2 mm/s is not kept."]


def test_what_a_machine_loses_and_refuses_is_told_in_the_units_that_are_shown(modules: Modules) -> None:
    seen = run(
        modules,
        f"""const {{createExport}} = await import('/panels/export/export.js');
        const {{createStore, FIRST_STATE}} = await import('/app/state.js');
        const {{COMMANDS: {{work, view}}}} = await import('/app/commands/commands.js');
        const {{Refusal}} = await import('/server/api.js');
        let answer = async () => ({LOST});
        const store = createStore(FIRST_STATE, (error) => {{ throw error; }});
        const panel = createExport(store, {{report: gone, exportDesign: gone, machine: () => answer()}});
        store.subscribe(panel.show);
        store.dispatch(work.begin, {{axes: [design], together: 'independent'}});
        panel.open('grbl'); await settled();
        const lost = () => byId('export-remarks').children.map(textOf);
        const seen = [lost()];
        store.dispatch(view.setUnits, {{length: 'mm', time: 's'}}); await settled();
        seen.push(lost(), textOf(byId('export-preview')));
        answer = async () => {{ throw {REFUSED}; }};
        store.dispatch(work.setName, 'Other'); await settled();
        return [...seen, textOf(byId('export-preview')).trim()];""",
    )
    assert [lost[0] for lost in seen[:2]] == OF_50_STEPS_PER_MM
    assert seen[1][1] == "Another is."
    assert seen[2] == "$100=80", "the file is as it is"
    assert seen[3] == "Slew speed is 0.01 mm/s (0.5 steps/s); allowed: at least 0.02 mm/s with it."


def test_the_guide_tells_what_a_machine_loses_in_the_units_that_are_shown(modules: Modules) -> None:
    seen = run(
        modules,
        f"""const {{createUseStep}} = await import('/panels/guide/use.js');
        const {{createStore, FIRST_STATE}} = await import('/app/state.js');
        const {{COMMANDS: {{work, guide, answers, view}}}} = await import('/app/commands/commands.js');
        const {{axisOf}} = await import('/app/selectors.js');
        const {{Refusal}} = await import('/server/api.js');
        let answer = async () => ({LOST});
        const step = createUseStep({{}}, {{machine: () => answer()}});
        body.append(step.element);
        const store = createStore(FIRST_STATE, (error) => {{ throw error; }});
        store.subscribe(step.show);
        store.dispatch(work.begin, {{axes: [design], together: 'independent'}});
        store.dispatch(guide.setPlayer, 'grbl');
        store.dispatch(answers.curvesCame, {{}}, axisOf(store.state())); await settled();
        const seen = [textOf(body)];
        store.dispatch(view.setUnits, {{length: 'mm', time: 's'}}); await settled();
        seen.push(textOf(body));
        answer = async () => {{ throw {REFUSED}; }};
        store.dispatch(view.setUnits, {{length: 'mm', time: 'min'}}); await settled();
        return [...seen, textOf(body)];""",
    )
    assert [told in text for told, text in zip(OF_50_STEPS_PER_MM, seen, strict=False)] == [True, True]
    assert "allowed: at least 1.2 mm/min with it." in seen[2]


def test_what_a_library_really_plays_is_said_and_drawn_if_wanted(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createExport} = await import('/panels/export/export.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {ownPlayerOf} = await import('/app/devices.js');
        const {COMMANDS: {work}} = await import('/app/commands/commands.js');
        const asked = [];
        const press = (box) => { box.checked = !box.checked; box.onchange(); };
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const machine = async (name) => ({file_name: 'a.ino', text: 'void loop()', settings: [], remarks: [],
            remarks_told: [], unplayed: name === 'fastaccelstepper' ? 'Nobody knows.' : null});
        const ramp = async (route) => { asked.push(route);
            return {max_relative_error: -0.594, max_error_step: 1, duration_s: 2.1, planned_duration_s: 2.2}; };
        const panel = createExport(store, {report: gone, exportDesign: gone, machine}, ramp);
        store.subscribe(panel.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        panel.open('accelstepper'); await settled();
        const box = byId('export-draw');
        const seen = [textOf(byId('export-played')), box.checked, ownPlayerOf(store.state())];
        press(box);
        seen.push(ownPlayerOf(store.state()).route);
        panel.open('teensystep'); await settled();
        seen.push(box.checked);
        panel.open('fastaccelstepper'); await settled();
        seen.push(textOf(byId('export-played')), find(body, (one) => one.children?.includes(box)).hidden);
        panel.open('accelstepper'); await settled();
        seen.push(box.checked);
        press(box);
        return [...seen, ownPlayerOf(store.state()), asked];""",
    )
    text = (
        "AccelStepper really plays delays that differ by up to \u221259 %, at step 1; the move takes 100.0 ms less "
        "than planned."
    )
    assert seen[:3] == [text, False, None]
    assert seen[3:5] == ["machine/accelstepper", False]
    assert seen[5:9] == ["Nobody knows.", True, True, None]
    assert seen[9] == ["machine/accelstepper", "machine/teensystep", "machine/accelstepper"]


def test_the_guide_has_its_lines_from_the_server_and_keeps_none_that_are_old(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createUseStep} = await import('/panels/guide/use.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work, guide, answers}} = await import('/app/commands/commands.js');
        const {axisOf} = await import('/app/selectors.js');
        const asked = [];
        let answer = gone;
        const nothing = () => {};
        const act = {goToDevice: nothing, openExport: nothing, saveFile: nothing, choosePlayer: nothing};
        const step = createUseStep(act, {machine: (name, {design, axis_letter}) => {
            asked.push([name, axis_letter, design.name]); return answer(); }});
        body.append(step.element);
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        store.subscribe(step.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        store.dispatch(guide.setPlayer, 'grbl');
        store.dispatch(answers.curvesCame, {}, axisOf(store.state())); await settled();
        const shown = () => [textOf(byId('guide-settings')), byId('guide-copy').disabled];
        const seen = [textOf(body).includes('The server does not answer'), ...shown()];
        answer = async () => ({text: '; Mine.\\n$100=80\\n$110=6\\n', remarks: ['No base speed.'],
            remarks_told: [[]]});
        pass(); await settled();
        seen.push(...shown(), textOf(body).includes('No base speed.'));
        answer = () => new Promise(nothing);
        store.dispatch(work.setName, 'Other'); await settled();
        return [...seen, ...shown(), asked];""",
    )
    assert seen[:3] == [True, "", True]
    assert seen[3:6] == ["$100=80\n$110=6", False, True]
    assert seen[6:8] == ["", True], "lines of an earlier design are none to be copied"
    name = document()["name"]
    assert seen[8] == [["grbl", "X", name], ["grbl", "X", name], ["grbl", "X", "Other"]]


CAPTURE = """
    const {createCapture} = await import('/panels/capture/capture.js');
    const {createStore, FIRST_STATE} = await import('/app/state.js');
    const {COMMANDS: {work, capture}} = await import('/app/commands/commands.js');
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const panel = createCapture(store.dispatch, {openCaptureFile() {}, cancel() {}});
    store.subscribe(panel.show);
    store.dispatch(work.begin, {axes: [design], together: 'independent', ids: [0], active: 0, kept: null});
    const open = (name) => store.dispatch(capture.openCapture, {name, size: 10});
    const moves = [{move: 1, steps: 3, begin_s: 2, duration_s: 0.5, direction_level: 1},
        {move: 2, steps: 3, begin_s: 9, duration_s: 0.5, direction_level: 0},
        {move: 3, steps: 3, begin_s: 12, duration_s: 0.5, direction_level: null}];
    const deviation = {planned_steps: 4, planned_duration_s: 0.75, matched_steps: 2, planned_step: [], deviation_us: [],
        figures: {largest_us: 7, largest_at_step: 2, mean_us: 1, rms_us: 2, clock_ppm: 0, no_clock: ''},
        missing: {count: 1, step: [4], time_s: [0.7]}, extra: {count: 7, step: [1, 2, 3, 4, 5, 6, 7], time_s: []}};
    const answer = (changes) => ({format: 'vcd', channels: [{name: 'Step', edges: 6}], step_channel: 'Step',
        direction_channel: null, edge: 'rising', sample_rate_hz: null, duration_s: 20, longest_wait_us: 20000,
        remarks: [], move_count: 3, moves, move: {...moves[0], step: [], time_s: [], interval_us: [],
        speed_steps_per_s: [], short_pulses: {count: 2, step: [1, 3], time_s: []}, deviation, ...changes}});
    const figure = (name) => { const [list] = byId('capture-figures').children;
        return list.children[list.children.findIndex((one) => one.textContent.includes(name)) + 1].textContent; };
    const came = (changes) => store.dispatch(capture.captureCame, answer(changes), '');
"""


def test_a_capture_without_a_step_has_no_figures_and_no_empty_box_for_them(modules: Modules) -> None:
    seen = run(
        modules,
        f"""{CAPTURE} open('a.vcd'); came({{}});
        const some = byId('capture-figures').hidden;
        store.dispatch(capture.captureCame, {{...answer({{}}), move: null, moves: [], move_count: 0}}, '');
        const fields = find(body, ({{className}}) => className === 'capture-fields');
        return [some, byId('capture-figures').hidden, fields.hidden];""",
    )
    assert seen == [False, True, False]


def test_a_move_beyond_those_that_are_listed_is_chosen_by_its_number(modules: Modules) -> None:
    seen = run(
        modules,
        f"""{CAPTURE} open('a.vcd'); came({{}});
        const number = byId('capture-move-number'), field = find(body, (one) => one.children.includes(number));
        const look = () => [field.hidden, number.placeholder, number.value, byId('capture-move').value];
        const seen = [look()];
        const many = () => store.dispatch(capture.captureCame, {{...answer({{}}), move_count: 1500}}, '');
        many(); seen.push(look());
        number.value = '1200'; number.onchange();
        const {{wish}} = store.state().capture;
        many(); seen.push(look());
        return [seen, wish.move_number, byId('capture-move').children.at(-1).textContent];""",
    )
    (few, many, chosen), wished, option = seen
    assert few[0] is True
    assert many[:3] == [False, "or its number, up to 1,500", ""]
    assert wished == 1200
    assert (chosen[2], option) == ("1,200", "Move 1200")


def test_a_captured_move_is_told_in_what_can_be_compared_with_the_plan(modules: Modules) -> None:
    lasts, alone, numbered, moves, ones = run(
        modules,
        f"""{CAPTURE} open('a.vcd'); came({{}});
        const lasts = figure('From first to last');
        const numbered = ['Missing', 'Extra', 'Too short', 'Largest deviation'].map(figure);
        came({{deviation: null}});
        return [lasts, figure('From first to last'), numbered,
            byId('capture-move').children.map(({{textContent}}) => textContent).slice(1),
            (store.dispatch(capture.captureCame, {{...answer({{}}), moves: [{{...moves[0], steps: 1}}],
                channels: [{{name: 'Step', edges: 1}}]}}, ''),
                ['capture-move', 'capture-step'].map((id) => byId(id).children.at(-1).textContent))];""",
    )
    assert (lasts, alone) == ("0.50000 s; planned 0.75000 s", "0.50000 s")
    assert numbered == [
        "1: planned step 4",
        "7: measured steps 1, 2, 3, 4, 5 …",
        "2: measured steps 1, 3",
        "7.00 µs, at measured step 2",
    ]
    assert ones == ["1: 1 step at 2.000 s, direction high", "Step (1 edge)"]
    assert [each.split(", ")[1:] for each in moves] == [["direction high"], ["direction low"], []]


def test_the_capture_dialog_offers_the_plots_only_where_they_show_something(modules: Modules) -> None:
    refused = "Line 4 of the file has the time '1'; allowed: at least that of the row before."
    seen = run(
        modules,
        f"""{CAPTURE}
        const look = () => [byId('capture-close').textContent, byId('capture-kept').hidden,
            textOf(byId('capture-problems')).trim()];
        const refused = (field, message) => store.dispatch(capture.captureRefused,
            [{{field, value: 'what stood there', allowed: 'something else', message}}]);
        open('broken.csv'); const seen = [look()];
        refused('file', {refused!r}); seen.push(look());
        open('whole.csv'); came({{}}); seen.push(look());
        refused('edge', 'no'); seen.push(look());
        store.dispatch(capture.captureCame, {{...answer({{}}), move: null}}, ''); seen.push(look());
        open('broken.csv'); refused('file', 'no'); seen.push(look());
        return [seen, byId('capture-kept').textContent];""",
    )
    looks, kept = seen
    assert looks[0][:2] == ["Close", True]
    assert looks[1][:2] == ["Close", True]
    assert looks[1][2].endswith(refused)
    assert looks[2] == ["Show the plots", False, ""]
    assert looks[3][:2] == ["Show the plots", False], "what was found before stays"
    assert looks[4][:2] == ["Close", True], "no step"
    assert looks[5][:2] == ["Close", True]
    assert kept == "The page keeps no capture over a reload: open its file again then.", "true of any file"


def test_a_fault_of_the_page_stays_until_it_is_closed(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createNotice} = await import('/panels/header/notice.js');
        const {watchErrors} = await import('/app/effects/errors.js');
        const {createStore, FIRST_STATE, whenChanged} = await import('/app/state.js');
        const {tell, closeFault} = await import('/app/commands/told.js');
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const notice = createNotice(() => store.dispatch(closeFault));
        store.subscribe(whenChanged(({told}) => [told.notice],
            (told) => told && notice.show(told.text, told.hasFailed)));
        store.subscribe(whenChanged(({told}) => [told.fault], notice.showFault));
        const look = () => [notice.element.hidden ? '' : textOf(notice.element).trim(), notice.element['aria-hidden']];
        const seen = [];
        store.dispatch(tell, 'Saved', false); seen.push(look()); pass(); seen.push(look());
        const log = console.error; console.error = () => {};
        watchErrors(store).show(new Error('broken')); console.error = log;
        pass(); seen.push(look());
        store.dispatch(tell, 'Saved again', false); seen.push(look()); pass(); seen.push(look());
        find(notice.element, ({tag}) => tag === 'button').onclick(); seen.push(look());
        return seen;""",
    )
    fault = "Something went wrong in the page: broken. Your design is kept; reload the page if anything looks odd."
    assert seen[0] == ["Saved", "true"]
    assert seen[1][0] == ""
    assert seen[2] == [fault, "false"], "and it can be closed by those who don't see it"
    assert [text for text, _ in seen[3:]] == ["Saved again", fault, ""]


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ({"length": "steps", "time": "s"}, "Lower the slew speed to 12,000 steps/s and the jerk to 400,000 steps/s³"),
        # 200 · 16 steps/rev, 8 mm/rev: 12,000 / 3200 = 3.75 rev/s = 30 mm/s; 400,000 / 400 = 1,000 mm/s³.
        ({"length": "mm", "time": "s"}, "Lower the slew speed to 30 mm/s and the jerk to 1,000 mm/s³"),
        ({"length": "rev", "time": "min"}, "Lower the slew speed to 225 rev/min and the jerk to 27,000,000 rev/min³"),
    ],
)
def test_a_remedy_is_told_in_the_units_that_are_shown(modules: Modules, units: dict[str, str], words: str) -> None:
    axis = {"full_steps_per_rev": 200, "microsteps": 16, "travel_per_rev": 8, "travel_unit": "mm"}
    told = [
        {"text": "12,000 steps/s", "value": 12_000, "unit": "steps/s", "rounding": "down", "axis": None},
        {"text": "400,000 steps/s³", "value": 400_000, "unit": "steps/s³", "rounding": "down", "axis": None},
    ]
    text = "lower the slew speed to 12,000 steps/s and the jerk to 400,000 steps/s³"
    remedy = {"text": text, "changes": [], "told": told}
    assert modules.call("model/told.js", "remedyWords", units, document(axis=axis), remedy) == words


def test_a_remedy_about_something_else_is_told_as_it_is(modules: Modules) -> None:
    remedy = {"text": "raise the supply to 36 V", "changes": []}
    units = {"length": "mm", "time": "s"}
    assert modules.call("model/told.js", "remedyWords", units, document(), remedy) == "Raise the supply to 36 V"


@pytest.mark.parametrize(
    ("wish", "typed", "told"),
    [
        ("rows", "", "Rows is empty; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "x", "Rows is 'x'; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "1e400", "Rows is 1e400; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "-1", "Rows is -1; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "1e300", "Rows is 1e+300; allowed: a whole number from 1 to 1,000 rows."),
        ("bytes", "3", "Bytes is 3; allowed: a whole number from 4 to 6,000 bytes."),
        (
            "largest_relative_error",
            "2,5",
            "Error is '2,5'; allowed: a number from 0.0001 to 100 %. A point is expected for the comma: 2.5.",
        ),
        ("largest_relative_error", "101", "Error is 101 %; allowed: a number from 0.0001 to 100 %."),
    ],
)
def test_a_wish_is_refused_by_its_field_s_name_and_in_its_unit(
    modules: Modules, wish: str, typed: str, told: str
) -> None:
    dialog = """const {createFitDialog} = await import('/panels/table/fit_dialog.js');
        const {Refusal} = await import('/server/api.js');
        const asked = []; let answer = gone;
        const dialog = createFitDialog({fitTable: async (_, wish) => { asked.push(wish); return answer(); },
            fitCurve: () => gone()}, () => {});
        dialog.open(design, 3);
        find(byId('fit-dialog'), (one) => one['data-value'] === WISH || one.dataset?.value === WISH).onclick();
        const input = find(byId('fit-dialog'), ({id}) => id === 'fit-wish');
        const type = async (text) => { input.value = text; input.oninput(); await settled(); };
    """.replace("WISH", repr(wish))
    [asked] = run(modules, f"{dialog} await type({typed!r}); return asked.slice(-1);")
    with pytest.raises(Rejected) as caught:
        FitPayload.checked({"design": document(), **asked})
    errors = [json.loads(json_bytes(item)) for item in error_items(caught.value)]
    seen = run(
        modules,
        f"""{dialog} answer = () => {{ throw new Refusal(422, {json.dumps(errors)}); }};
        await type({typed!r}); return [textOf(byId('fit-result')).trim(), input['aria-invalid']];""",
    )
    assert seen == [told, "true"]


def test_what_refuses_a_fit_besides_its_wish_is_called_as_the_page_calls_it(modules: Modules) -> None:
    error = {"field": "design.move.steps", "value": 0, "allowed": "another one", "message": "design.move.steps is 0"}
    wish = {"name": "rows", "label": "Rows", "unit": "rows", "factor": 1}
    told = modules.call("panels/table/fits.js", "problemOf", {"rejections": [error]}, wish, 8)
    assert told == "Distance is 0; allowed: another one."
