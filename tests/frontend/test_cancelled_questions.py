"""What nobody waits for any more, of every dialog that asks something."""

import pytest

from frontend.dialogs import run
from frontend.modules import Modules

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
