"""What guards motions in the page, without a page: gestures that a STOP ends, and the gate that keeps its way free."""

import pytest

from frontend.modules import Modules

DEVICE = "const told = (stops) => ({id: '1', stops});"


def test_a_stop_ends_all_gestures_before_it_and_none_after_it(modules: Modules) -> None:
    script = f"""async () => {{ const {{createGestures}} = await import('/gestures.js'); {DEVICE}
        const gestures = createGestures();
        const before = [gestures.begin(told(3)), gestures.begin(told(3))];
        gestures.end();
        return [...before, gestures.begin(told(3))].map((one) => one.ended.aborted); }}"""
    assert modules.evaluate(script) == [True, True, False]


def test_a_gesture_knows_the_stops_of_its_moment(modules: Modules) -> None:
    """What is told late, as an event after the answer of a stop may be, takes nothing back."""
    script = f"""async () => {{ const {{createGestures}} = await import('/gestures.js'); {DEVICE}
        const gestures = createGestures();
        const known = [gestures.begin(told(3)).stops];
        gestures.hear([told(3)]);
        const early = gestures.begin(told(3));
        for (const stops of [7, 5]) gestures.hear([told(stops)]);
        known.push(early.stops, gestures.begin(told(5)).stops);
        gestures.forget();
        gestures.hear([told(1)]);
        return [...known, gestures.begin(told(1)).stops]; }}"""
    assert modules.evaluate(script) == [3, 3, 7, 1]


def test_only_so_many_pass_a_gate_and_all_get_their_turn(modules: Modules) -> None:
    script = """async () => { const {createGate} = await import('/gate.js');
        const gate = createGate(2), begun = [], ends = [];
        const job = (name) => gate(() => { begun.push(name);
            return new Promise((resolve, reject) => ends.push(name === 'b' ? reject : resolve)); });
        const jobs = Promise.allSettled(['a', 'b', 'c', 'd'].map(job)), seen = [];
        const settled = () => new Promise((resolve) => setTimeout(resolve));
        for (let turn = 0; turn < 4; turn += 1) { await settled(); seen.push(begun.join('')); ends[turn]('x'); }
        const outcomes = (await jobs).map((one) => one.status);
        await gate(async () => seen.push('free'));
        return [seen, outcomes]; }"""
    seen, outcomes = modules.evaluate(script)
    assert seen == ["ab", "abc", "abcd", "abcd", "free"]
    assert outcomes == ["fulfilled", "rejected", "fulfilled", "fulfilled"]


STOP = """async (presses) => { const {api} = await import('/api.js'), {createStop} = await import('/stopping.js');
    const own = {...api}, asked = [], said = [];
    let told = [];
    const fleet = {devices: () => told, endMotions: () => asked.push('end'), hearStops: () => asked.push('hear')};
    const stop = createStop(fleet, (text, hasFailed) => said.push([text, hasFailed]));
    for (const {known, answered, refused = []} of presses) {
        const answer = {devices: answered};
        told = known;
        stop.follow(told);
        api.stopAll = async () => { asked.push('stop'); if (answered) return answer; throw new Error('nobody'); };
        api.halt = async (id) => { asked.push(`halt ${id}`);
            if (refused.includes(id)) throw new Error('no'); return answer; };
        if (answered !== undefined) await stop.press();
        else asked.push(stop.isHaltNext() ? 'HALT' : 'STOP');
    }
    Object.assign(api, own);
    return [asked, said]; }"""


OUT_OF_REACH = "Out of reach, stopped as soon as it answers"


def devices(*states: str, stops: int = 7) -> list[dict[str, object]]:
    """Return devices as the server tells of them; each STOP lets it count more stops."""
    return [
        {"id": str(number), "name": f"board {number}", "state": state, "stops": stops, "axes": []}
        for number, state in enumerate(states)
    ]


@pytest.mark.parametrize(
    ("known", "answered", "words"),
    [
        (devices("ready"), devices("ready"), "Nothing moves"),
        # The page has not heard yet of what has only just set out.
        (devices("ready", "ready"), devices("ready", "stopping"), "Stopping"),
        (devices("moving", "lost"), devices("stopping", "lost"), f"Stopping. {OUT_OF_REACH}: board 1"),
        (devices("moving", "lost"), devices("ready", "lost"), f"What answers is at rest. {OUT_OF_REACH}: board 1"),
        # Nobody knows whether it moves: a board with a supply of its own may go on.
        (devices("connecting"), devices("connecting"), f"{OUT_OF_REACH}: board 0"),
    ],
)
def test_a_press_stops_everything_and_says_what_came_of_it(
    modules: Modules, known: object, answered: object, words: str
) -> None:
    asked, said = modules.evaluate(STOP, [{"known": known, "answered": answered}])
    assert (asked, said) == (["end", "stop", "hear"], [[words, False]])


def after_a_press(*states: str) -> list[dict[str, object]]:
    """Return presses: one that is answered, and what is told afterwards."""
    return [{"known": devices("moving", *states[1:]), "answered": devices(*states, stops=9)}]


def test_a_second_press_halts_what_slows_down_since_the_first(modules: Modules) -> None:
    known = devices("stopping", "ready", "lost", stops=9)
    asked, said = modules.evaluate(
        STOP, [*after_a_press("stopping", "ready", "lost"), {"known": known, "answered": known, "refused": ["2"]}]
    )
    assert asked[:4] == ["end", "stop", "hear", "end"], "before anything is waited for"
    assert asked[4:] == ["halt 0", "halt 1", "halt 2", "hear", "hear"], "the lost one is owed it, too"
    assert said[1:] == [[f"Halted. {OUT_OF_REACH}: board 2", False]]


def test_a_halt_that_is_refused_by_what_is_in_reach_is_no_halt(modules: Modules) -> None:
    known = devices("stopping", "ready", stops=9)
    _, said = modules.evaluate(
        STOP, [*after_a_press("stopping", "ready"), {"known": known, "answered": known, "refused": ["1"]}]
    )
    assert said[1:] == [["STOP did not get through: no", True]]


@pytest.mark.parametrize(
    "known",
    [
        # A jog that was let go slows down, whatever else moves or may move.
        devices("stopping"),
        devices("stopping", "moving"),
        devices("stopping", "lost"),
        devices("stopping", "connecting"),
    ],
)
def test_a_press_never_halts_while_anything_was_not_stopped(modules: Modules, known: object) -> None:
    asked, _ = modules.evaluate(STOP, [{"known": known}, {"known": known, "answered": devices("stopping", stops=9)}])
    assert asked == ["STOP", "end", "stop", "hear"]


def stopped_then(*told: list[dict[str, object]]) -> list[dict[str, object]]:
    return [*after_a_press("stopping", "ready"), *({"known": known} for known in told)]


@pytest.mark.parametrize(
    ("told", "button"),
    [
        ([devices("stopping", "ready", stops=9)], "HALT"),
        ([devices("stopping", "lost", stops=9)], "HALT"),
        # It is told late that the other one moves, too: it moves in spite of the stop, or has been set out since.
        ([devices("stopping", "moving", stops=9)], "STOP"),
        # At rest since, it moves anew and slows down by itself.
        ([devices("ready", "ready", stops=9), devices("stopping", "ready", stops=9)], "STOP"),
        # What is told was told before the press.
        ([devices("ready", "ready"), devices("stopping", "ready", stops=9)], "HALT"),
        # Another server counts anew.
        ([[], devices("stopping", stops=12)], "STOP"),
    ],
)
def test_what_the_next_press_does(modules: Modules, told: list[list[dict[str, object]]], button: str) -> None:
    asked, _ = modules.evaluate(STOP, stopped_then(*told))
    assert asked[-1] == button


def test_what_is_pressed_for_again_before_it_is_known_to_be_stopped_is_stopped_again(modules: Modules) -> None:
    script = STOP.replace("await stop.press()", "await Promise.all([stop.press(), stop.press()])")
    lost = devices("lost")
    asked, said = modules.evaluate(script, [{"known": lost, "answered": lost}])
    assert asked == ["end", "stop", "end", "stop", "hear", "hear"]
    assert said == [[f"{OUT_OF_REACH}: board 0", False]] * 2, "nobody knows that it was halted"


UNANSWERED = """async (known) => { const {api} = await import('/api.js'), {createStop} = await import('/stopping.js');
    const own = {...api}, real = {setTimeout, clearTimeout}, said = [], timers = new Map();
    let answer;
    api.stopAll = () => new Promise((resolve) => { answer = resolve; });
    globalThis.setTimeout = (act, ms) => { timers.set(1, [act, ms]); return 1; };
    globalThis.clearTimeout = (timer) => timers.delete(timer);
    const fleet = {devices: () => known, endMotions: () => {}, hearStops: () => {}};
    const stop = createStop(fleet, (text, hasFailed) => said.push([text, hasFailed]));
    const pressed = stop.press();
    const [act, ms] = timers.get(1);
    act();
    said.push(stop.isHaltNext());
    answer({devices: [{...known[0], state: 'stopping'}]});
    await pressed;
    Object.assign(globalThis, real);
    Object.assign(api, own);
    return [ms, said, timers.size]; }"""


def test_a_stop_that_is_not_answered_within_a_second_says_so_until_it_is(modules: Modules) -> None:
    within_ms, said, left = modules.evaluate(UNANSWERED, devices("moving"))
    unanswered = ["STOP is not answered yet: nobody knows whether anything stops.", True]
    assert (within_ms, left) == (1000, 0)
    assert said == [unanswered, False, ["Stopping", False]]


def test_a_stop_that_fails_has_ended_the_gestures_all_the_same(modules: Modules) -> None:
    asked, said = modules.evaluate(STOP, [{"known": devices("moving"), "answered": None}])
    assert (asked, said) == (["end", "stop"], [["STOP did not get through: nobody", True]])


OUT = """async ([steps, isStopped]) => { const {createOutOfReach} = await import('/out_of_reach.js');
    const out = createOutOfReach();
    return steps.map((devices) => { out.follow(devices); return out.words(devices, () => isStopped); }); }"""
MAY_MOVE = "board 0 is out of reach since it moved, and may still move. STOP stops it as soon as it answers."
IS_OWED = "board 0 is out of reach: it is stopped as soon as it answers."


def test_what_was_lost_in_mid_move_is_told_until_it_is_back(modules: Modules) -> None:
    states = ["ready", "lost", "connecting", "ready", "moving", "lost", "connecting", "ready", "lost"]
    steps = [devices(state) for state in states]
    words = modules.evaluate(OUT, [steps, False])
    assert words == ["", "", "", "", "", MAY_MOVE, MAY_MOVE, "", ""]
    # As long as the stop is owed, that is told, also of one that did not move when it was heard of.
    words = modules.evaluate(OUT, [steps, True])
    assert words == ["", IS_OWED, IS_OWED, "", "", IS_OWED, IS_OWED, "", IS_OWED]


def test_a_page_that_comes_later_sees_that_a_lost_one_had_not_arrived(modules: Modules) -> None:
    [lost] = devices("lost")
    on_the_way = [lost | {"axes": [{"position_steps": 40, "target_steps": 900}]}]
    arrived = [lost | {"axes": [{"position_steps": 900, "target_steps": 900}]}]
    assert modules.evaluate(OUT, [[on_the_way], False]) == [MAY_MOVE]
    assert modules.evaluate(OUT, [[arrived], False]) == [""]
    assert modules.evaluate(OUT, [[on_the_way, []], False]) == [MAY_MOVE, ""]


def test_soft_limits_are_remembered_by_port_and_axis(modules: Modules) -> None:
    script = """async () => { const kept = {};
        globalThis.localStorage = {getItem: (key) => kept[key] ?? null, setItem: (key, text) => { kept[key] = text; }};
        const {memory} = await import('/memory.js');
        const limits = (axis, lowest, highest) => ({axis, lowest_steps: lowest, highest_steps: highest});
        const seen = [memory.softLimits('A')];
        memory.keepSoftLimits('A', [limits(0, -1000, 20000), limits(1, null, null)]);
        memory.keepSoftLimits('A', [limits(2, null, 5)]);
        memory.keepSoftLimits('B', [limits(0, null, 7)]);
        seen.push(memory.softLimits('A'));
        memory.keepSoftLimits('A', [limits(0, null, null)]);
        seen.push(memory.softLimits('A'), memory.softLimits('B'));
        for (const text of ['{', 'null', '[]', '{"B": 3}', '{"B": [{"axis": 0, "lowest_steps": "x"}]}']) {
            kept['stepramp.soft_limits'] = text;
            seen.push(memory.softLimits('B'));
        }
        delete globalThis.localStorage;
        return seen; }"""
    ahead = {"axis": 2, "lowest_steps": None, "highest_steps": 5}
    first = {"axis": 0, "lowest_steps": -1000, "highest_steps": 20000}
    other = {"axis": 0, "lowest_steps": None, "highest_steps": 7}
    assert modules.evaluate(script) == [[], [first, ahead], [ahead], [other], [], [], [], [], []]


def test_soft_limits_in_words(modules: Modules) -> None:
    script = """async (spans) => { const {limitsText} = await import('/panels/device/limits.js');
        const design = {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'}};
        return ['steps', 'mm'].map((length) => spans.map(([low, high]) =>
            limitsText({length, time: 's'}, design, {lowest_steps: low, highest_steps: high}))); }"""
    spans = [[-1000, 20000], [None, 500], [0, None], [None, None]]
    in_steps, in_mm = modules.evaluate(script, spans)
    assert in_steps == ["\u22121,000 to 20,000 steps", "up to 500 steps", "from 0 steps", ""]
    # 400 steps make one turn of 8 mm.
    assert in_mm == ["\u221220 to 400 mm", "up to 10 mm", "from 0 mm", ""]


@pytest.mark.parametrize(
    ("quantity", "value", "allowed", "text"),
    [
        # 400 steps make one turn of 8 mm: a step is 0.02 mm, and 5,000 steps/s are 100 mm/s.
        (
            "length",
            600,
            "what stays within the soft limits of axis 1, -50 to 500 steps, and this leads to 600",
            "Steps is 12 mm; allowed: what stays within the soft limits of axis 1, -1 to 10 mm, and this leads to 12.",
        ),
        (
            "length",
            5,
            "at least lowest_steps, 10 steps",
            "Steps is 0.1 mm; allowed: at least lowest_steps, 0.2 mm.",
        ),
        (
            "speed",
            -5000,
            "a speed at which axis 2 can still come to rest within its soft limits, from -50 steps",
            "Steps is -100 mm/s; allowed: a speed at which axis 2 can still come to rest within its soft limits, from "
            "-1 mm.",
        ),
        (
            "speed",
            1050.0,
            "from -1,000 to 1,000 steps/s, the slew speed of the axis' ramp, and 0 or at least 0.25 either way",
            "Steps is 21 mm/s; allowed: from -20 to 20 mm/s, the slew speed of the axis' ramp, and 0 or at least 0.005 "
            "either way.",
        ),
        *(
            (
                quantity,
                value,
                "axis 0 at most 46,242 steps/s, or with a pulse width of at most 2 µs (now 10 µs); this takes 217 % of "
                "the controller's time",
                f"Steps is {shown}; allowed: axis 0 at most 924.84 mm/s, or with a pulse width of at most 2 µs (now "
                "10 µs); this takes 217 % of the controller's time.",
            )
            for quantity, value, shown in (("length", 5, "0.1 mm"), ("speed", 40_000.0, "800 mm/s"))
        ),
        (
            "length",
            5,
            # Axes have units of their own.
            "axis 0 at most 30,018 steps/s, axis 1 at most 8 steps/s when they move at the same time, or fewer axes",
            "Steps is 5; allowed: axis 0 at most 30,018 steps/s, axis 1 at most 8 steps/s when they move at the same "
            "time, or fewer axes.",
        ),
        (
            "length",
            "abc",
            "a whole number from -2,147,483,648 to 2,147,483,647 steps",
            # A limit is rounded to the side that is allowed.
            "Steps is 'abc'; allowed: whole steps from -42,949,670 to 42,949,670 mm.",
        ),
    ],
)
def test_a_refusal_of_a_device_in_the_unit_that_is_shown(
    modules: Modules, quantity: str, value: object, allowed: str, text: str
) -> None:
    script = """async ([rejection, quantity, length]) => {
        const {inShownUnit} = await import('/panels/device/refusal.js');
        const design = {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'}};
        return inShownUnit(rejection, 'Steps', quantity, {length, time: 's'}, design); }"""
    message = f"axes.0.x is {value}; allowed: {allowed}."
    rejection = {"field": "axes.0.x", "value": value, "allowed": allowed, "message": message}
    assert modules.evaluate(script, [rejection, quantity, "mm"]) == text
    assert modules.evaluate(script, [rejection, quantity, "steps"]) == f"Steps is {value}; allowed: {allowed}."


SILENCE = """async (happens) => { const {createEvents} = await import('/events.js');
    const own = {WebSocket: globalThis.WebSocket, setInterval, setTimeout}, sockets = [], seen = [];
    let tick, again;
    globalThis.WebSocket = class { static OPEN = 1; readyState = 0; constructor() { sockets.push(this); } };
    globalThis.setInterval = (act) => { tick = act; };
    globalThis.setTimeout = (act) => { again = act; };
    createEvents(() => 'ws://').watch(() => {}, (link) => { if (seen.at(-1) !== link) seen.push(link); });
    const ways = {
        open: () => { sockets.at(-1).readyState = 1; sockets.at(-1).onopen(); },
        tell: () => sockets.at(-1).onmessage({data: '{"devices": []}'}),
        answer: () => sockets.at(-1).onmessage({data: '{"did": {"number": 1}, "devices": []}'}),
        close: () => { sockets.at(-1).readyState = 3; sockets.at(-1).onclose(); again(); },
        tick: () => tick(),
    };
    const told = [];
    for (const [way, times] of happens) {
        for (let time = 0; time < times; time += 1) ways[way]();
        told.push(seen.at(-1) ?? null);
    }
    Object.assign(globalThis, own);
    return told; }"""


def test_a_server_of_which_nothing_is_heard_for_eight_ticks_is_silent_until_it_tells_of_devices(
    modules: Modules,
) -> None:
    happens = [("open", 1), ("tick", 7), ("tell", 1), ("tick", 7), ("tick", 1), ("answer", 1), ("tell", 1), ("tick", 9)]
    told = ["there", "there", "there", "there", "silent", "silent", "there", "silent"]
    assert modules.evaluate(SILENCE, happens) == told


def test_a_server_that_is_gone_is_not_called_silent(modules: Modules) -> None:
    happens = [("open", 1), ("close", 1), ("tick", 20), ("open", 1), ("tick", 7), ("tick", 1), ("close", 1)]
    assert modules.evaluate(SILENCE, happens) == ["there", "gone", "gone", "there", "there", "silent", "gone"]
