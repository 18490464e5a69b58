"""Backups as the device's panel lists and restores them, without a browser."""

import json

import pytest

from frontend.dialogs import NOBODY, run
from frontend.modules import Modules


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
        const backups = [{name: '2026-01-01T00-00-00.000000Z'}];
        answer = async () => ({backups, unreadable: []}); pass(); await settled(); seen.push(look());
        answer = () => Promise.reject(new Refusal(500, [{message: 'StepRamp made a mistake.'}]));
        show('b'); await settled(); seen.push(look());
        answer = async () => ({backups, unreadable: ['One can’t.', 'Another can’t.']});
        show('d'); await settled(); seen.push(look());
        answer = () => Promise.reject(new Refusal(404, [{message: 'no'}])); show('c'); await settled();
        return [...seen, look(), waiting.size];""",
    )
    assert seen[0] == [True, f"Its backups can’t be listed: {NOBODY}"]
    assert seen[1] == [False, ""]
    assert seen[2] == [True, "StepRamp made a mistake."]
    assert seen[3] == [False, "One can’t. Another can’t."]
    assert seen[4:] == [[True, ""], 0]


def test_a_backup_is_kept_and_restored_only_as_it_is_in_view(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createBackups} = await import('/panels/backups/backups.js');
        const {FIRST_STATE} = await import('/app/state.js');
        const answers = {};
        const source = {name: 'grbl-a', family: 'grbl', plugged_in: 'a', backups: [{name: 'new'}, {name: 'old'}]};
        const dialog = createBackups({state: () => FIRST_STATE}, {restoreFrom() {}}, {
            archive: async () => ({sources: [source], unreadable: ['Nothing can be read there.']}),
            archived: (from, name) => new Promise((done) => { answers[name] = done; })});
        dialog.open(); await settled();
        await settled();
        const look = () => [byId('backup-text').textContent, byId('backup-download').disabled];
        const unreadable = [byId('backups-unreadable').hidden, byId('backups-unreadable').textContent];
        const seen = [look()];
        answers.new('of the new'); await settled(); seen.push(look());
        byId('backup-name').value = 'old'; byId('backup-name').onchange(); seen.push(look());
        answers.old('of the old'); await settled(); seen.push(look());
        return [unreadable, ...seen];""",
    )
    assert seen == [
        [False, "Nothing can be read there."], ["", True], ["of the new", False], ["", True], ["of the old", False],
    ]  # fmt: skip


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
                of('grbl-mine', '2026-b', '2026-a')], unreadable: []}}),
            backups: async () => ({{backups: {json.dumps([{"name": name} for name in saved])}, unreadable: []}}),
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
            listBackups: async () => ({backups: [{name: 'new'}, {name: 'first'}, {name: 'older'}], unreadable: []}),
        }, () => {});
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
        const backup = (name) => ({backups: [{name}], unreadable: []});
        const look = () => [byId('backups').hidden, byId('backup').value];
        show('1', 'old'); show('2', 'new');
        answers[1](backup('2026-01-01T00-00-00.000000Z')); await settled();
        const seen = [look()];
        answers[2](backup('2026-02-02T00-00-00.000000Z')); await settled();
        byId('restore-backup').onclick();
        return [...seen, look()[0], restored];""",
    )
    assert seen == [[True, ""], False, [["2", "2026-02-02T00-00-00.000000Z"]]]
