"""The export dialog without a browser: what it asks, asks again, and shows."""

import json

import pytest

from designs import design, document
from frontend.dialogs import LOST, NOBODY, OF_50_STEPS_PER_MM, REFUSED, run
from frontend.modules import Modules
from stepramp.errors import Rejected
from stepramp.exports.export import Options, sheet_of
from stepramp.exports.machines.sheet import LETTERS, AxisLetter


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


def test_of_each_machine_those_axes_are_offered_that_it_takes(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createExport} = await import('/panels/export/export.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {EXPORT_FORMATS} = await import('/documents/exports.js');
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const panel = createExport(store, {report: gone, exportDesign: gone, machine: gone});
        const select = find(body, (one) => one['aria-label'] === 'Axis of the machine');
        const seen = EXPORT_FORMATS.filter(({options}) => options.includes('axis_letter')).map(({name}) => {
            panel.open(name); return [name, select.children.map(({value}) => value)]; });
        const kept = [['grblhal', 'B'], ['fluidnc'], ['grbl'], ['grblhal', 'Y'], ['grbl']].map(([name, letter]) => {
            panel.open(name); select.value = letter ?? select.value; return select.value; });
        return [seen, kept];""",
    )
    offered, kept = seen
    assert {name for name, _ in offered} >= {"grbl", "grblhal", "fluidnc", "marlin", "klipper"}
    for name, letters in offered:
        assert letters == [each for each in LETTERS if _takes(name, each)], name
    assert kept == ["B", "B", "X", "Y", "Y"], "what was chosen stays where it is taken"


def _takes(machine: str, letter: AxisLetter) -> bool:
    try:
        sheet_of(design(), machine, Options(axis_letter=letter))
    except Rejected as refused:
        assert [each.field for each in refused.rejections] == ["axis_letter"]
        return False
    return True


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
