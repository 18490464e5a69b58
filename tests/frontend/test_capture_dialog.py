"""The dialog of a captured file, without a browser."""

from frontend.dialogs import run
from frontend.modules import Modules

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
