"""Where rows of tables come from, and those that others took the place of; without a page."""

from designs import document
from frontend.dialogs import run
from frontend.modules import Modules


def test_rows_that_came_with_a_design_are_of_its_ramp_until_they_can_not_come_back(modules: Modules) -> None:
    script = """async ([design, other]) => {
        const {createOrigins} = await import('/panels/table/origins.js');
        const origins = createOrigins();
        const isKnown = () => origins.staleWish(other) !== null;
        const seen = [isKnown()];
        origins.shown(design, 7);
        seen.push(isKnown());
        origins.prune([null, design.table], new Set([7]));
        seen.push(isKnown());
        origins.prune([null], new Set([7]));
        return [...seen, isKnown()]; }"""
    changed = document(ramp__acceleration_steps_per_s2=1234)
    assert modules.evaluate(script, [document(), changed]) == [False, True, True, False]


def test_where_rows_come_from_is_forgotten_with_them(modules: Modules) -> None:
    script = """async (design) => { const {createOrigins} = await import('/panels/table/origins.js');
        const {tablesOf} = await import('/model/workbench.js');
        const table = (delay) => ({rows: [[1, delay]], interval_unit: 'us'});
        const origins = createOrigins();
        const tables = [1, 2, 3].map(table);
        for (const [axis, one] of tables.entries()) origins.shown({...design, table: one}, axis);
        const machine = (one) => ({axes: [{...design, table: one}, {...design, table: null}]});
        const history = {past: [machine(tables[0])], present: machine(tables[1]), future: [], dropped: []};
        origins.prune(tablesOf(history), new Set([0, 1, 2]));
        const steeper = {...design, ramp: {...design.ramp, acceleration_steps_per_s2: 77}};
        const typed = {...steeper, ramp: {...steeper.ramp, slew_speed_steps_per_s: 'fast'}, table: tables[0]};
        return [...tables.map((one) => origins.staleWish({...steeper, table: one})), origins.staleWish(typed)]
            .map((wish) => wish !== null); }"""
    assert modules.evaluate(script, document()) == [True, True, False, False]


def test_rows_that_came_with_a_wrong_value_are_not_told_to_be_of_it(modules: Modules) -> None:
    """The page was left with a wrong slew speed: put right, it is no other ramp than that of the rows."""
    script = """async ([wrong, right]) => {
        const {createOrigins} = await import('/panels/table/origins.js');
        const origins = createOrigins();
        for (const one of [wrong, right]) origins.shown(one, 7);
        return origins.staleWish(right); }"""
    assert modules.evaluate(script, [document(ramp__slew_speed_steps_per_s="abc"), document()]) is None


def test_rows_that_a_person_gave_an_axis_later_are_of_no_ramp(modules: Modules) -> None:
    script = """async ([first, typed, other]) => {
        const {createOrigins} = await import('/panels/table/origins.js');
        const origins = createOrigins();
        const isKnown = () => origins.staleWish(other) !== null;
        origins.shown(first, 7);
        origins.shown(typed, 7);
        const seen = [isKnown()];
        // The axis was removed for good: what comes with another of its id came with a design.
        origins.prune([], new Set());
        origins.shown(typed, 7);
        return [...seen, isKnown()]; }"""
    typed = document(table__rows=[[20, 3000]])
    changed = document(table__rows=[[20, 3000]], ramp__acceleration_steps_per_s2=1234)
    assert modules.evaluate(script, [document(), typed, changed]) == [False, True]


def test_a_fit_anew_is_wished_for_as_the_one_before(modules: Modules) -> None:
    script = """async ([design, other, wish]) => {
        const {createOrigins} = await import('/panels/table/origins.js');
        const origins = createOrigins();
        origins.fitted(design.table, design, wish);
        return [origins.staleWish(design), origins.staleWish(other)]; }"""
    wish = {"rows": 9, "row_kind": "linear", "fit_to": "ramp", "interval_unit": "us"}
    changed = document(ramp__acceleration_steps_per_s2=1234)
    assert modules.evaluate(script, [document(), changed, wish]) == [None, {"wish": wish, "isFit": True}]


def test_rows_that_others_took_the_place_of_can_be_put_back_once(modules: Modules) -> None:
    script = """async ([before]) => {
        const {createReplaced} = await import('/panels/table/replaced.js');
        const replaced = createReplaced();
        replaced.keep(3, before);
        const counts = [replaced.count(3), replaced.count(4)];
        replaced.shown(3, {rows: [[1, 1]], unit: 'us'});
        counts.push(replaced.count(3));
        const taken = replaced.take(3);
        return [counts, taken, replaced.count(3), replaced.take(3) ?? null]; }"""
    before = {"rows": [[10, 5000], [20, 4000]], "unit": "us"}
    assert modules.evaluate(script, [before]) == [[2, 0, 2], before, 0, None]


def test_nothing_is_put_back_once_it_is_back_or_its_axis_is_gone(modules: Modules) -> None:
    script = """async ([before]) => {
        const {createReplaced} = await import('/panels/table/replaced.js');
        const replaced = createReplaced();
        for (const axis of [1, 2, 3]) replaced.keep(axis, before);
        // Undone on axis 1; the same rows in another unit on axis 2 are others; axis 3 can't come back.
        replaced.shown(1, {...before});
        replaced.shown(2, {...before, unit: 'ticks'});
        replaced.prune(new Set([1, 2]));
        return [1, 2, 3].map(replaced.count); }"""
    before = {"rows": [[10, 5000]], "unit": "us"}
    assert modules.evaluate(script, [before]) == [0, 1, 0]


# The panel with rows that a fit made: `press(text)` presses a button, `edit(rows)` puts other rows in their place.
TABLE = """
    const {createTable} = await import('/panels/table/table.js');
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {Refusal} = await import('/server/api.js');
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const root = made('section'), ask = {checkTable: () => new Promise(() => {})};
    const table = createTable(root, store.dispatch, ask);
    store.subscribe(table.show);
    const fitted = {...design, table: {rows: [[5, 900], [9, 700]], interval_unit: 'us'}};
    store.dispatch(COMMANDS.work.begin, {axes: [fitted], together: 'independent', ids: [5], active: 0, kept: null});
    const press = (text) => find(root, (one) => one.tag === 'button' && textOf(one).trim() === text).onclick();
    const edit = (rows) => store.dispatch(COMMANDS.work.setTable, rows, 'us', undefined, 5);
"""


def test_copied_is_said_of_the_rows_that_were(modules: Modules) -> None:
    script = """const before = Object.getOwnPropertyDescriptor(globalThis, 'navigator');
        let done;
        globalThis.ClipboardItem = class {};
        Object.defineProperty(globalThis, 'navigator', {configurable: true, value: {clipboard: {
            write: () => new Promise((resolve) => { done = resolve; })}}});
        const isTold = () => textOf(root).includes('copied as C');
        const seen = [];
        for (const rows of [null, [[5, 900], [9, 600]]]) {
            press('C'); await settled();
            if (rows) edit(rows);
            done(); await settled();
            seen.push(isTold());
        }
        if (before) Object.defineProperty(globalThis, 'navigator', before);
        delete globalThis.ClipboardItem;
        return seen;"""
    assert run(modules, TABLE + script) == [True, False]


def test_what_refuses_a_fit_is_said_in_the_words_of_the_page(modules: Modules) -> None:
    script = """const refused = {field: 'design.ramp.slew_speed_steps_per_s', value: 0, allowed: 'more than 0',
            message: 'its own words'};
        ask.fitTable = async () => { throw new Refusal(422, [refused]); };
        store.dispatch(COMMANDS.work.setValue, 'ramp.acceleration_steps_per_s2', 77, '', 1);
        press('Refit'); await settled();
        return textOf(root);"""
    told = run(modules, TABLE + script)
    assert "The rows were not fitted. Slew speed is 0; allowed: more than 0." in told
    assert "its own words" not in told
