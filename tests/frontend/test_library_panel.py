"""Parts of the library's dialog, with elements to stand in for a page's."""

from __future__ import annotations

from frontend.dialogs import run
from frontend.modules import Modules
from frontend.state import STATE

PUSH = """{id: 'p', device_id: 'd2', device: 'Bench', pushed_at: '2026-11-28T07:10:47Z', client: 'Ada', mode: 'keep',
    trouble: null, verified: true, backup: 'b', axes: [{axis: 0, name: 'Lift', revisions: []}]}"""


def test_pushes_to_the_device_in_view_come_first(modules: Modules) -> None:
    seen = run(
        modules,
        f"""const {{createPushes}} = await import('/panels/library/pushes.js');
        const asked = [], opened = [], found = {{count: 1, pushes: [{PUSH}]}};
        const pushes = createPushes({{
            devices: async () => ['d1', 'd2'].map((id) => ({{id, family: 'grbl', name: id, port: `/dev/${{id}}`}})),
            pushes: async (device) => {{ asked.push(device); return found; }},
            present: () => ({{family: 'grbl', port: '/dev/d2'}}),
            openPush: ({{id}}) => opened.push(id), openBackups: () => opened.push('backups')}});
        body.append(pushes.element);
        await pushes.open();
        const all = (one) => [one, ...one.children.flatMap((child) => typeof child === 'string' ? [] : all(child))];
        for (const button of all(byId('library-pushes')).filter(({{tag}}) => tag === 'button')) button.onclick();
        return [asked, opened, textOf(byId('library-pushes'))];""",
    )
    assert seen[:2] == [["d2"], ["backups", "p"]]
    for words in ("“Lift”, in no revision", "Read back as sent, to be kept", "by Ada"):
        assert words in seen[2]


def test_what_is_found_late_is_not_what_was_typed_since(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createList} = await import('/panels/library/list.js');
        const answers = {};
        const list = createList({search: (text) => new Promise((done) => { answers[text] = done; }), onChoose() {}});
        body.append(list.element);
        const found = (name) => ({count: 1, designs: [{id: name, name, tags: [], revisions: 1, saved_at: 0}]});
        const type = (text) => { list.words.value = text; list.words.oninput(); pass(); };
        type('li'); type('lift');
        answers.lift(found('Lift')); await settled();
        answers.li(found('Lid')); await settled();
        return [textOf(byId('library-list')).includes('Lift'), textOf(byId('library-list')).includes('Lid'),
            byId('library-count').textContent];""",
    )
    assert seen == [True, False, "1 design found"]


def test_tags_without_a_button_are_counted(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createList} = await import('/panels/library/list.js');
        const tags = Array.from({length: 15}, (_, index) => `tag ${index}`);
        const designs = [{id: 'a', name: 'A', tags, revisions: 1, saved_at: 0}];
        const list = createList({search: async () => ({count: 1, designs}), onChoose() {}});
        body.append(list.element);
        await list.find();
        const offered = byId('library-filter').children;
        return [offered.length, offered.at(-1).textContent];""",
    )
    assert seen == [13, "and 3 more tags: search for their words"]


def test_a_save_that_waits_is_shown_and_not_begun_twice(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createSaving} = await import('/panels/library/saving.js');
        const saved = []; let done = () => {};
        const saving = createSaving({saveRevision() {}, onCancel() {},
            saveNew: (_, {name}) => { saved.push(name); return new Promise((end) => { done = end; }); }});
        body.append(saving.element);
        const [form, button] = [byId('library-saving'), byId('library-save')];
        const look = () => [button.textContent, button.disabled, saved.length];
        const submit = () => form.onsubmit({preventDefault() {}});
        saving.begin({axis: 5, design: {name: 'Lift'}, linked: null}); submit(); submit();
        const seen = [look()];
        done(); await settled(); seen.push(look());
        byId('library-save-name').value = 'x'.repeat(101); submit(); seen.push(look(), textOf(form).includes('101'));
        return seen;""",
    )
    assert seen == [["saving …", True, 1], ["Save as new", False, 1], ["Save as new", False, 1], True]


def test_what_is_said_of_a_slow_save_is_of_the_form_that_is_there_by_then(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createSaving} = await import('/panels/library/saving.js');
        let done = () => {};
        const kept = {id: 'a', name: 'Lift', version: 1};
        const saving = createSaving({saveRevision() {}, onCancel() {},
            saveNew: () => new Promise((end) => { done = end; })});
        body.append(saving.element);
        const button = byId('library-save'), seen = [], look = () => seen.push([button.textContent, button.disabled]);
        saving.begin({axis: 5, design: {name: 'Lift'}, linked: null});
        byId('library-saving').onsubmit({preventDefault() {}});
        saving.begin({axis: 5, design: {name: 'Lift'}, linked: kept}); look();
        done(); await settled(); look();
        return seen;""",
    )
    assert seen == [["saving …", True], ["Save revision", False]]


def test_what_was_typed_is_there_again_for_the_same_design_until_it_is_saved(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createSaving} = await import('/panels/library/saving.js');
        const saved = [];
        const saving = createSaving({saveRevision: (_, note) => { saved.push(note); }, saveNew() {}, onCancel() {}});
        body.append(saving.element);
        const note = () => byId('library-save-note').value, seen = [];
        const lift = {axis: 5, design: {name: 'Lift'}, linked: {id: 'a', name: 'Lift', version: 1}};
        const begin = (mine) => { saving.begin(mine); seen.push(note()); };
        begin(lift); byId('library-save-note').value = 'typed'; begin(lift);
        begin({...lift, axis: 7}); byId('library-save-note').value = 'of 7'; begin({...lift, axis: 7});
        saving.end(); byId('library-saving').onsubmit({preventDefault() {}}); await settled();
        begin({...lift, axis: 7});
        return [seen, saved];""",
    )
    assert seen == [["", "typed", "", "of 7", ""], ["of 7"]]


# The dialog before a library that is slow to save: `answer[name]()` ends what it was asked for.
PANEL = (
    STATE
    + """
    const {createLibraryPanel} = await import('/panels/library/library.js');
    const {Refusal} = await import('/server/api.js');
    const kept = {id: 'a', name: 'Lift', notes: '', tags: [], version: 1, revisions: 1, saved_at: 0,
        history: [{number: 1, note: '', saved_at: 0}]};
    const answer = {}, slow = (name, value) => () => new Promise((done, fail) => {
        answer[name] = () => done(value); answer.refuse = fail; });
    const there = {...state, devices: {...state.devices, role: 'operate', link: 'there'}};
    const store = {state: () => there, dispatch() {}};
    const mine = {axis: 5, design: {name: 'Lift'}, linked: null};
    const act = {inHand: () => mine, saveNew: slow('saveNew', kept), saveRevision: slow('saveRevision', {kept}),
        described() {}};
    const server = {search: async () => ({count: 1, designs: [kept]}), design: async () => kept,
        records: async () => ({records: []}), pushes: async () => ({pushes: []}), describe: slow('describe', kept)};
    const panel = createLibraryPanel(store, act, server);
    await panel.open();
    const press = (text) => find(body, (one) => one.tag === 'button' && one.textContent === text).onclick();
    const submit = (id) => find(byId(id), (one) => one.tag === 'form').onsubmit({preventDefault() {}});
    const shown = () => byId('library-panes').dataset.pane;
"""
)


def test_what_was_saved_takes_no_form_that_was_begun_since(modules: Modules) -> None:
    seen = run(
        modules,
        PANEL
        + """const begin = () => press('Save this design …'), note = () => byId('library-note').textContent, seen = [];
        begin(); submit('library-saving'); answer.saveNew(); await settled(); seen.push(shown());
        begin(); submit('library-saving'); begin(); answer.saveNew(); await settled(); seen.push(shown(), note());
        panel.show(store.state()); byId('library-trouble').hidden = false;
        panel.show({...store.state(), devices: {...state.devices, link: 'lost'}});
        panel.show(store.state()); await settled(); return [...seen, shown()];""",
    )
    assert seen == ["one", "saving", "Saved as “Lift”, revision 1.", "saving"]


def test_who_edits_what_is_said_of_a_design_keeps_the_form_as_a_save_ends(modules: Modules) -> None:
    seen = run(
        modules,
        PANEL
        + """press('Save this design …'); submit('library-saving'); answer.saveNew(); await settled();
        press('Save this design …'); submit('library-saving'); press('Cancel');
        byId('library-edit').onclick(); byId('library-edit-name').value = 'Hoist';
        answer.saveNew(); await settled(); const seen = [byId('library-edit-name')?.value];
        submit('library-one'); answer.describe(); await settled();
        return [...seen, byId('library-edit-name'), byId('library-note').textContent];""",
    )
    assert seen == ["Hoist", None, "Saved."]


def test_a_trace_is_offered_to_be_kept_only_to_who_may(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createTraceSection} = await import('/panels/device/trace_section.js');
        const kept = [];
        const section = createTraceSection(() => {}, {saveTrace() {}, keepTrace: (trace) => kept.push(trace.step)});
        body.append(section.element);
        const trace = {step: [1], measured_ticks: [5], timer_hz: 1, deviation_us: [0], traced_axis: 0, every_steps: 1};
        const show = (given, mayAct) => { section.show({known: {capabilities: ['trace']},
            situation: {trace: given, mayAct, isBusy: false, isTracing: true}}); return byId('trace-keep').hidden; };
        const seen = [show(null, true), show(trace, false), show(trace, true)];
        byId('trace-keep').onclick();
        return [seen, kept];""",
    )
    assert seen == [[True, True, False], [[1]]]
