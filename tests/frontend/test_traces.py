"""Moves as they were made: what is followed of devices, and the traces that are read."""

import pytest

from designs import document
from frontend.modules import Modules
from frontend.state import DEVICE, MACHINE, after

READ = """async ([answers, overAt]) => {
    const {untilComplete} = await import('/devices/traces.js');
    const real = globalThis.setTimeout;
    globalThis.setTimeout = (act) => { queueMicrotask(act); return 0; };
    const taken = [];
    let looks = 0;
    const look = async () => answers[Math.min(looks++, answers.length - 1)];
    const last = await untilComplete(look, ({name}) => taken.push(name), () => looks >= overAt);
    globalThis.setTimeout = real;
    return [taken, last?.name ?? null, looks]; }"""
PART, WHOLE = {"name": "part", "complete": False}, {"name": "whole", "complete": True}
NEVER = 100


@pytest.mark.parametrize(
    ("answers", "over_at", "taken", "last", "looks"),
    [
        ([WHOLE], NEVER, ["whole"], "whole", 1),
        ([PART, None, WHOLE], NEVER, ["part", "whole"], "whole", 3),
        ([PART], NEVER, ["part"] * 10, "part", 10),
        ([None], NEVER, [], None, 10),
        # What is seen after the next move was asked for may be that one's.
        ([PART, WHOLE], 2, ["part"], None, 2),
        ([WHOLE], 1, [], None, 1),
    ],
)
def test_a_trace_is_read_until_it_is_whole_or_of_another_move(
    modules: Modules, answers: list[object], over_at: int, taken: list[str], last: str | None, looks: int
) -> None:
    assert modules.evaluate(READ, [answers, over_at]) == [taken, last, looks]


def test_moves_of_devices_that_are_not_told_any_more_are_forgotten(modules: Modules) -> None:
    script = """async () => {
        const follower = (await import('/devices/traces.js')).createFollower();
        const axis = {axis: 0, state: 'ready', position_steps: 5, target_steps: 5, speed_steps_per_s: 0};
        const device = (id) => ({id, heard_s: 1, axes: [axis]});
        const tell = (list) => { follower.forgetOthers(list); list.forEach(follower.follow);
            return Object.keys(follower.runs()).sort(); };
        return [tell([device('1'), device('12')]), tell([device('12')]), tell([])]; }"""
    assert modules.evaluate(script) == [["1 0", "12 0"], ["12 0"], []]


def test_what_an_axis_made_is_forgotten_once_another_sets_out_without_it(modules: Modules) -> None:
    script = """async () => {
        const follower = (await import('/devices/traces.js')).createFollower();
        const tell = (heard_s, ...told) => {
            const axes = told.map(([state, position_steps], axis) =>
                ({axis, state, position_steps, target_steps: 90, speed_steps_per_s: 9}));
            follower.follow({id: '1', heard_s, axes});
            return ['1 0', '1 1'].map((key) => follower.runs()[key].samples?.position.length ?? null); };
        // A line of both, of which one is told to rest first; then one of the second axis only, and one of the first.
        return [tell(0, ['ready', 0], ['ready', 0]), tell(1, ['moving', 10], ['moving', 5]),
            tell(2, ['moving', 20], ['ready', 9]), tell(3, ['ready', 30], ['ready', 9]),
            tell(4, ['ready', 30], ['moving', 12]), tell(5, ['ready', 30], ['ready', 20]),
            tell(6, ['moving', 31], ['ready', 20])]; }"""
    assert modules.evaluate(script) == [[None, None], [1, 1], [2, 2], [3, 2], [None, 1], [None, 2], [1, None]]


@pytest.mark.parametrize(("is_pushed", "length"), [(True, 1000), (False, None)])
def test_a_move_of_another_ramp_than_the_plotted_one_lies_at_the_steps_that_it_made(
    modules: Modules, is_pushed: bool, length: int | None
) -> None:
    pushed = {"designs": [document()], "ids": [5], "toAxis": 0, "crc": None}
    told = [["work.begin", {**MACHINE, "ids": [5]}], ["device.heard", [{**DEVICE, "axes": [axis_at(0)]}], {}]]
    look = """async (state) => { const {asMade} = await import('/panels/plots/layers.js');
        return asMade(state, {position: [0, 900], length: 1000}).length; }"""
    assert after(modules, [*told, *([["device.pushed", "1", pushed]] if is_pushed else [])], look) == length


def test_what_ran_without_an_end_has_none_when_it_was_slowed_down_either(modules: Modules) -> None:
    script = """async () => {
        const follower = (await import('/devices/traces.js')).createFollower();
        const tell = (heard_s, state, position_steps, target_steps) => {
            const axis = {axis: 0, state, position_steps, target_steps, speed_steps_per_s: 9};
            follower.follow({id: '1', heard_s, axes: [axis]});
            return follower.runs()['1 0'].samples?.length; };
        const jog = [tell(0, 'ready', 0, 0), tell(1, 'moving', 5, 5), tell(2, 'stopping', 9, 20),
            tell(3, 'ready', 20, 20)];
        const move = [tell(4, 'moving', 30, 70), tell(5, 'ready', 70, 70)];
        return [jog, move].map((lengths) => lengths.map((length) => length ?? null)); }"""
    assert modules.evaluate(script) == [[None] * 4, [50, 50]]


def test_a_move_that_is_still_told_to_move_at_its_target_keeps_its_end(modules: Modules) -> None:
    script = """async () => {
        const follower = (await import('/devices/traces.js')).createFollower();
        const tell = (heard_s, state, position_steps, target_steps) => {
            const axis = {axis: 0, state, position_steps, target_steps, speed_steps_per_s: 9};
            follower.follow({id: '1', heard_s, axes: [axis]});
            return follower.runs()['1 0'].samples?.length ?? null; };
        const move = [tell(0, 'ready', 0, 0), tell(1, 'moving', -5, -70), tell(2, 'moving', -70, -70),
            tell(3, 'moving', -70, -70), tell(4, 'ready', -70, -70)];
        // A run that takes the place of a move has no end, though that had one.
        const run = [tell(5, 'moving', 0, 200), tell(6, 'moving', 210, 210), tell(7, 'moving', 230, 230)];
        return [move, run]; }"""
    assert modules.evaluate(script) == [[None, 70, 70, 70, 70], [270, None, None]]


def test_a_half_of_there_and_back_knows_how_long_and_fast_those_before_it_were(modules: Modules) -> None:
    script = """async () => {
        const follower = (await import('/devices/traces.js')).createFollower();
        const tell = (heard_s, state, position_steps, speed_steps_per_s, isShuttle = true) => {
            const axis = {axis: 0, state, position_steps, target_steps: 90, speed_steps_per_s};
            follower.follow({id: '1', heard_s, axes: [axis], shuttle: isShuttle ? {axis: 0} : null});
            return follower.runs()['1 0'].samples?.earlier ?? null; };
        return [tell(0, 'ready', 0, 0, false), tell(1, 'moving', 5, 5, false), tell(4, 'moving', 50, -800),
            tell(5, 'ready', 90, 0), tell(6, 'moving', 80, 5), tell(8, 'moving', 10, 900), tell(9, 'ready', 0, 0),
            tell(10, 'moving', 5, 5), tell(11, 'ready', 90, 0), tell(12, 'ready', 90, 0, false),
            tell(13, 'moving', 80, 5)]; }"""
    first, both = {"seconds": 4, "speed": 800}, {"seconds": 4, "speed": 900}
    assert modules.evaluate(script) == [*[None] * 4, first, first, first, both, both, both, None]


# A page that traces moves of a device with what it may know of one: the move is answered as the test says, after
# what happens meanwhile.
MOVED = """async ([answer, meanwhile]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDeviceActions} = await import('/app/effects/device_actions.js');
    const {api, Ended, Refusal, ServerGone} = await import('/server/api.js');
    const {createGestures} = await import('/server/gestures.js');
    const real = {...api};
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    store.dispatch(COMMANDS.device.setTracing, true);
    const [traced, newer] = [new Map(), {of: {axis: 9, design: null}, first: 4, last: 4}];
    const failures = {refused: new Refusal(409, [{message: 'no'}]), ended: new Ended('no'), gone: new ServerGone('no')};
    api.traceMoves = async () => ({next_number: 3});
    api.move = async () => {
        if (meanwhile) traced.set('1', newer);
        if (answer !== 'done') throw failures[answer];
    };
    const device = {id: '1', state: 'ready', stops: 0, capabilities: ['trace']};
    await createDeviceActions(store, createGestures(), traced, {outdate: () => {}}).go(device, 0, 'move', {});
    Object.assign(api, real);
    return traced.has('1') && (traced.get('1') === newer ? 'newer' : 'this'); }"""


@pytest.mark.parametrize(
    ("answer", "meanwhile", "awaited"),
    [
        ("done", False, "this"),
        ("refused", False, False),
        ("ended", False, False),
        ("gone", False, False),
        ("refused", True, "newer"),
    ],
)
def test_a_move_that_was_not_begun_is_not_awaited_as_a_traced_one(
    modules: Modules, answer: str, meanwhile: bool, awaited: object
) -> None:
    assert modules.evaluate(MOVED, [answer, meanwhile]) == awaited


# A page that hears of a device whose motions `first` to `last` it has traced: it is told of its states, and looks at
# traces with these numbers, one after the other. Returns whose trace it has shown, and of how many steps.
HEARD = """async ([first, last, states, numbers]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {createDeviceNews} = await import('/app/effects/device_news.js');
    const {createGestures} = await import('/server/gestures.js');
    const {api} = await import('/server/api.js');
    const real = {WebSocket: globalThis.WebSocket, setTimeout, setInterval, document: globalThis.document};
    globalThis.setInterval = () => {};
    globalThis.document = {baseURI: 'http://127.0.0.1/', addEventListener() {}};
    let socket, looks = 0;
    globalThis.WebSocket = class { static OPEN = 1; readyState = 1; constructor() { socket = this; } };
    const own = api.trace;
    api.trace = async () => { const number = numbers[Math.min(looks++, numbers.length - 1)];
        return {number, timer_hz: 1e6, step: [1, number], measured_ticks: [0, 9], deviation_us: [0, 0],
            complete: looks >= numbers.length, changed: false}; };
    globalThis.setTimeout = (act) => { queueMicrotask(act); return 0; };
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const of = {axis: 7, design: null};
    const traced = new Map();
    createDeviceNews(store, createGestures(), traced, {endJog() {}, endMotions() {}}).watch();
    const tell = (state) => socket.onmessage({data: JSON.stringify({devices: [
        {id: '1', port: 'p', name: 'b', state, stops: 5, heard_s: 1, age_s: 0, position_steps: 0, target_steps: 0,
         capabilities: ['trace'], axes: [], shuttle: null, ramp: null}]})});
    tell('ready');
    traced.set('1', {of, first, last});
    for (const state of states) tell(state);
    for (let turn = 0; turn < 200; turn += 1) await null;
    api.trace = own;
    Object.assign(globalThis, real);
    const {measured} = store.state().devices;
    return measured && [measured.of.axis, measured.move.step[1]]; }"""


@pytest.mark.parametrize(
    ("motions", "states", "numbers", "shown"),
    [
        ((3, 3), ["moving", "ready"], [3], [7, 3]),
        # So short that nobody saw it: what is seen is the jog after it.
        ((3, 3), ["ready", "moving", "ready"], [4], None),
        # The trace before is still there, then its own comes.
        ((3, 3), ["moving", "ready"], [2, 3], [7, 3]),
        # Before all of it has come something else moves.
        ((3, 3), ["moving", "ready"], [3, 4], None),
        # One leg of there and back, and not half of the next.
        ((3, 6), ["moving", "ready"], [5], [7, 5]),
        ((3, 6), ["moving", "ready"], [5, 6], None),
    ],
)
def test_only_the_trace_of_the_move_that_was_asked_for_is_shown_as_its_own(
    modules: Modules, motions: tuple[int, int], states: list[str], numbers: list[int], shown: list[int] | None
) -> None:
    assert modules.evaluate(HEARD, [*motions, states, numbers]) == shown


ANNOUNCED = (
    HEARD.partition("const of =")[0].replace("async ([first, last, states, numbers])", "async ([design, told, axis])")
    + """
    const {COMMANDS} = await import('/app/commands/commands.js');
    store.dispatch(COMMANDS.work.begin, {axes: [design], together: 'independent', ids: [5], active: 0, kept: null});
    store.dispatch(COMMANDS.device.chooseAxis, axis);
    createDeviceNews(store, createGestures(), new Map(), {endJog() {}, endMotions() {}}).watch();
    const words = told.map(([unit, device]) => {
        store.dispatch(COMMANDS.view.setUnits, {length: unit, time: 's'});
        socket.onmessage({data: JSON.stringify({devices: [{id: '1', port: 'p', name: 'Grbl', stops: 5, heard_s: 1,
            age_s: 0, shuttle: null, ramp: null, unknown_positions: [], ...device}]})});
        return store.state().told.announced.text; });
    api.trace = own;
    Object.assign(globalThis, real);
    return words; }"""
)


def axis_at(position_steps: int, **own: object) -> dict[str, object]:
    fixed = {
        "axis": 0,
        "state": "ready",
        "position_told": True,
        "target_steps": position_steps,
        "speed_steps_per_s": 0,
        "microsteps": None,
    }
    return fixed | {"position_steps": position_steps, "steps_per_mm": None} | own


@pytest.mark.parametrize(
    ("unit", "axis", "axes", "place"),
    [
        # The design has 50 steps/mm.
        ("steps", 0, [axis_at(-1500)], " at \u22121,500 steps"),
        ("mm", 0, [axis_at(1500)], " at 30.0000 mm"),
        ("deg", 0, [axis_at(100)], " at 90.0000 °"),
        ("mm", 0, [axis_at(1500, steps_per_mm=250)], " at 6.00000 mm"),
        # The axis that the panel shows.
        ("mm", 1, [axis_at(0), axis_at(-500, steps_per_mm=250)], ", axis 1 at \u22122.00000 mm"),
        ("mm", 0, [], ""),
        ("mm", 0, [axis_at(0, position_told=False)], ""),
    ],
)
def test_a_device_is_announced_where_its_panel_shows_it(
    modules: Modules, unit: str, axis: int, axes: list[dict[str, object]], place: str
) -> None:
    moved_by_mm = document(axis__travel_per_rev=8, axis__travel_unit="mm")
    states = [[unit, {"axes": axes, "state": state}] for state in ("ready", "moving", "lost", "connecting")]
    told = [f"Grbl: ready{place}", f"Grbl: moving{place}", "Grbl: lost", "Grbl: connecting"]
    assert modules.evaluate(ANNOUNCED, [moved_by_mm, states, axis]) == told


def test_of_there_and_back_each_leg_has_a_number(modules: Modules) -> None:
    script = MOVED.replace("'move', {}", "what, {times: 4}").replace("[answer, meanwhile]", "[answer, meanwhile, what]")
    script = script.replace("return traced.has", "return [traced.get('1').first, traced.get('1').last]; traced.has")
    assert modules.evaluate(script, ["done", False, "there_and_back"]) == [3, 10]
    assert modules.evaluate(script, ["done", False, "move"]) == [3, 3]


def test_what_set_out_before_the_page_began_to_listen_has_no_line(modules: Modules) -> None:
    script = """async () => {
        const follower = (await import('/devices/traces.js')).createFollower();
        const tell = (heard_s, state, position_steps) => {
            const axis = {axis: 0, state, position_steps, target_steps: 900, speed_steps_per_s: 9};
            follower.follow({id: '1', heard_s, axes: [axis]});
            return follower.runs()['1 0']?.samples?.position ?? null; };
        return [tell(0, 'moving', 500), tell(1, 'moving', 510), tell(2, 'ready', 900), tell(3, 'moving', 910)]; }"""
    assert modules.evaluate(script) == [None, None, None, [10]]
