"""The lines that the guide has for a machine that ramps by itself, without a browser."""

from designs import document
from frontend.dialogs import LOST, OF_50_STEPS_PER_MM, REFUSED, run
from frontend.modules import Modules


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
