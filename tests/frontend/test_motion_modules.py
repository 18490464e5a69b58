"""What guards motions in the page, without a page: gestures that a STOP ends, and the gate that keeps its way free."""

import pytest

from frontend.modules import Modules

DEVICE = "const told = (stops) => ({id: '1', stops});"


def test_a_stop_ends_all_gestures_before_it_and_none_after_it(modules: Modules) -> None:
    script = f"""async () => {{ const {{createGestures}} = await import('/server/gestures.js'); {DEVICE}
        const gestures = createGestures();
        const before = [gestures.begin(told(3)), gestures.begin(told(3))];
        gestures.end();
        return [...before, gestures.begin(told(3))].map((one) => one.ended.aborted); }}"""
    assert modules.evaluate(script) == [True, True, False]


def test_a_gesture_knows_the_stops_of_its_moment(modules: Modules) -> None:
    """What is told late, as an event after the answer of a stop may be, takes nothing back."""
    script = f"""async () => {{ const {{createGestures}} = await import('/server/gestures.js'); {DEVICE}
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
    script = """async () => { const {createGate} = await import('/server/gate.js');
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


STOP = """async (presses) => { const {api} = await import('/server/api.js');
    const {createStop} = await import('/devices/stopping.js');
    const own = {...api}, asked = [], said = [];
    let told = [];
    const fleet = {devices: () => told, endMotions: () => asked.push('end'), hearStops: () => asked.push('hear')};
    const stop = createStop(fleet, (text) => said.push([text, stop.fate() !== 'answered']));
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
        {
            "id": str(number),
            "port": f"port {number}",
            "name": f"board {number}",
            "state": state,
            "stops": stops,
            "axes": [],
        }
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
    assert said[1:] == [["STOP did not get through: no. Cut the motor’s power.", True]]


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


UNANSWERED = """async (known) => { const {api} = await import('/server/api.js');
    const {createStop} = await import('/devices/stopping.js');
    const own = {...api}, real = {setTimeout, clearTimeout}, said = [], timers = new Map();
    let answer;
    api.stopAll = () => new Promise((resolve) => { answer = resolve; });
    globalThis.setTimeout = (act, ms) => { timers.set(ms, act); return ms; };
    globalThis.clearTimeout = (timer) => timers.delete(timer);
    const fleet = {devices: () => known, endMotions: () => {}, hearStops: () => {}};
    const stop = createStop(fleet, (text) => said.push([text, stop.fate()]));
    const pressed = stop.press();
    const within = [...timers.keys()];
    for (const ms of within) { timers.get(ms)(); said.push(stop.isHaltNext()); }
    answer({devices: [{...known[0], state: 'stopping'}]});
    await pressed;
    Object.assign(globalThis, real);
    Object.assign(api, own);
    return [within, said, timers.size]; }"""


def test_a_stop_that_is_not_answered_within_a_second_says_so_until_it_is(modules: Modules) -> None:
    within_ms, said, left = modules.evaluate(UNANSWERED, devices("moving"))
    assert (within_ms, left) == ([1000, 3000], 0)
    assert said == [
        ["STOP is not answered yet: nobody knows whether anything stops.", "waiting"],
        False,
        ["STOP is not answered: nobody knows whether anything stops. Cut the motor’s power.", "undelivered"],
        False,
        ["Stopping", "answered"],
    ]


def test_a_stop_that_fails_has_ended_the_gestures_all_the_same(modules: Modules) -> None:
    asked, said = modules.evaluate(STOP, [{"known": devices("moving"), "answered": None}])
    assert (asked, said) == (["end", "stop"], [["STOP did not get through: nobody. Cut the motor’s power.", True]])


FATES = """async (steps) => { const {api} = await import('/server/api.js');
    const {createStop} = await import('/devices/stopping.js');
    const own = api.stopAll, seen = [];
    let told = [];
    const fleet = {devices: () => told, endMotions() {}, hearStops() {}};
    const stop = createStop(fleet, () => {});
    for (const [known, does] of steps) {
        told = known;
        stop.follow(told);
        api.stopAll = async () => { if (does === 'fail') throw new Error('nobody'); return {devices: known}; };
        if (does !== 'hear') await stop.press();
        seen.push(stop.fate());
    }
    api.stopAll = own;
    return seen; }"""


def test_a_stop_that_was_not_delivered_is_told_until_one_is_answered_or_all_it_was_for_rests(modules: Modules) -> None:
    moving, resting, other = devices("moving", "ready"), devices("ready", "ready"), devices("ready")
    lost = devices("lost", "ready")
    steps = [[moving, "fail"], [moving, "hear"], [lost, "hear"], [resting, "hear"]]
    assert modules.evaluate(FATES, steps) == [*["undelivered"] * 3, "answered"]
    assert modules.evaluate(FATES, [[moving, "fail"], [moving, "press"]]) == ["undelivered", "answered"]
    # Another server knows one of them only, or none: of the others nothing is heard.
    assert modules.evaluate(FATES, [[moving, "fail"], [other, "hear"], [[], "hear"]]) == ["undelivered"] * 3


IN_ANY_ORDER = """async ([lists, first, happens]) => { const {api} = await import('/server/api.js');
    const {createStop} = await import('/devices/stopping.js');
    const own = {...api}, real = {setTimeout, clearTimeout};
    const orders = (left, isNext) => left.length === 0 ? [[]] : left.flatMap((one) => isNext(one, left)
        ? orders(left.filter((other) => other !== one), isNext).map((rest) => [one, ...rest]) : []);
    /** What comes of a press comes after it, and that it is hopeless after that it is late. */
    const isNext = (one, left) => !left.some((other) => other !== one && other.split(' ')[1] === one.split(' ')[1]
        && (other.startsWith('press') || (other.startsWith('late') && one.startsWith('hopeless')))
        && one.includes(' '))
        && !(one === 'press 2' && left.includes('press 1'));
    const seen = [];
    for (const order of orders(happens, isNext)) {
        const answers = [], timers = [], said = [];
        let told = lists[first];
        api.stopAll = () => new Promise((resolve, reject) => answers.push({resolve, reject}));
        api.halt = api.stopAll;
        globalThis.setTimeout = (act) => timers.push(act);
        globalThis.clearTimeout = (timer) => { timers[timer - 1] = () => {}; };
        const stop = createStop({devices: () => told, endMotions() {}, hearStops() {}}, (text) => said.push(text));
        const fates = [];
        for (const one of order) {
            const [what, number] = one.split(' ');
            if (what === 'press') stop.press();
            else if (what === 'late') timers[2 * number - 2]();
            else if (what === 'hopeless') timers[2 * number - 1]();
            else if (what === 'grant') answers[number - 1].resolve({devices: told});
            else if (what === 'fail') answers[number - 1].reject(new Error('gone'));
            else { told = lists[what]; stop.follow(told); }
            for (let turn = 0; turn < 12; turn += 1) await null;
            fates.push(stop.fate());
        }
        seen.push([order, fates, said.at(-1) ?? '']);
    }
    Object.assign(globalThis, real);
    Object.assign(api, own);
    return seen; }"""
LISTS = {
    "none": [],
    "moving": [{"id": "1", "port": "A", "name": "board", "state": "moving", "stops": 7, "axes": []}],
    "resting": [{"id": "1", "port": "A", "name": "board", "state": "ready", "stops": 7, "axes": []}],
    # Of another server, which gives its first device the same id.
    "elsewhere": [{"id": "1", "port": "B", "name": "other", "state": "ready", "stops": 9, "axes": []}],
    "recounting": [{"id": "2", "port": "A", "name": "other", "state": "ready", "stops": 3, "axes": []}],
}


def fate_by_the_rules(first: str, happened: list[str]) -> str:
    """Return what has become of STOP, by what is written of it.

    An answer holds for its press and those before it. What is late, hopeless or fails is told, until all that the press
    was meant for says after that that it rests: what is at the same port, where there was one.
    """
    worst = "answered"
    for number in ("1", "2"):
        if f"press {number}" not in happened:
            continue
        if any(f"grant {later}" in happened for later in ("1", "2") if later >= number):
            continue
        known, fate = first, "answered"
        is_pressed = is_settled = False
        for one in happened:
            what, _, which = one.partition(" ")
            if what in ("late", "hopeless", "fail") and which == number and not is_settled:
                fate = "waiting" if what == "late" and fate == "answered" else "undelivered"
            elif one == f"press {number}":
                is_pressed = True
            elif one in LISTS and not is_pressed:
                known = one
            elif one in LISTS and fate != "answered" and LISTS[known] and LISTS[one]:
                [was], [now] = LISTS[known], LISTS[one]
                if was["port"] == now["port"] and now["state"] == "ready":
                    is_settled, fate = True, "answered"
        worst = max(worst, fate, key=["answered", "waiting", "undelivered"].index)
    return worst


@pytest.mark.parametrize("first", ["none", "moving"])
@pytest.mark.parametrize("ends", [("grant", "grant"), ("grant", "fail"), ("fail", "grant"), ("fail", "fail")])
@pytest.mark.parametrize("told", [["none", "moving"], ["resting", "none"], ["elsewhere"], ["recounting"]])
def test_what_has_become_of_stop_in_any_order_of_what_happens(
    modules: Modules, first: str, ends: tuple[str, str], told: list[str]
) -> None:
    """Two presses with their answers or failures, which may be late, and what is told of devices around them."""
    happens = ["press 1", "late 1", "hopeless 1", f"{ends[0]} 1", "press 2", f"{ends[1]} 2", *told]
    seen = modules.evaluate(IN_ANY_ORDER, [LISTS, first, happens])
    assert len(seen) > 100
    for order, fates, said in seen:
        # What was answered or has failed is late no more.
        over = [order.index(f"{ends[0]} 1") < order.index(f"{late} 1") for late in ("late", "hopeless")]
        counting = [one for one in order if (one != "late 1" or not over[0]) and (one != "hopeless 1" or not over[1])]
        for at, fate in enumerate(fates):
            happened = [one for one in order[: at + 1] if one in counting]
            assert fate == fate_by_the_rules(first, happened), order[: at + 1]
        if fates[-1] != "answered":
            assert said.startswith("STOP"), "nothing sounds as if it were over"


def test_a_stop_that_a_lost_device_did_not_get_is_not_delivered(modules: Modules) -> None:
    """The server has answered it; whether it gets to the motor is what a person wants to know."""
    script = """async ([steps, isStopped]) => { const {createOutOfReach} = await import('/devices/out_of_reach.js');
        const out = createOutOfReach();
        return steps.map((one) => { out.follow(one); return out.isUndelivered(one, () => isStopped); }); }"""
    steps = [devices(state) for state in ("ready", "lost", "ready", "moving", "lost", "connecting", "ready")]
    assert modules.evaluate(script, [steps, True]) == [False, False, False, False, True, True, False]
    assert modules.evaluate(script, [steps, False]) == [False] * 7


def test_what_is_known_of_a_device_has_an_age_by_the_servers_clock(modules: Modules) -> None:
    script = """async (happens) => { const {createAges} = await import('/devices/ages.js');
        const ages = createAges();
        return happens.map(([now, devices]) => { if (devices) ages.hear(devices, now); return ages.old(now); }); }"""

    def told(state: str, age_s: float | None) -> list[dict[str, object]]:
        return [{"id": "1", "state": state, "age_s": age_s}]

    # The page's clock may be any: only what passes by it counts.
    happens = [
        [1000, told("moving", 0.5)],
        [1001.4, None],
        [1001.5, None],
        [1004.4, None],
        [1004.5, told("moving", 0.1)],
    ]
    assert modules.evaluate(script, happens) == [{}, {}, {"1": 2}, {"1": 4}, {}]
    assert modules.evaluate(script, [[5, told("lost", 60.2)], [6, None]]) == [{"1": 60}, {"1": 61}]
    assert modules.evaluate(script, [[5, told("connecting", None)], [99, None]]) == [{}, {}]
    # Of what is being written the server hears all the time, but not where its axes are; they rest.
    assert modules.evaluate(script, [[5, told("writing", 40)], [8, None]]) == [{}, {"1": 3}]


def test_what_moved_when_the_server_ended_is_told_until_it_says_itself_what_it_does(modules: Modules) -> None:
    script = """async (happens) => { const {createEnded} = await import('/devices/ended.js');
        const ended = createEnded(({port}) => port !== 'virtual');
        return happens.map(([way, devices]) => { ended[way](devices); return ended.words(); }); }"""
    board = {"id": "1", "name": "Board", "port": "/dev/ttyACM0", "state": "moving", "axes": [{}]}
    words = (
        "Board (/dev/ttyACM0) was moving when the server ended, and may still move: stop it once it is connected "
        "again, or cut the motor’s power."
    )
    connecting = [board | {"state": "connecting", "axes": []}]
    happens = [["leave", [board]], ["follow", []], ["follow", connecting], ["leave", connecting], ["follow", [board]]]
    assert modules.evaluate(script, happens) == [words, words, words, words, ""]
    # The simulated one ended with its server, and what was at rest stays there.
    others = [board | {"port": "virtual"}, board | {"state": "ready"}]
    assert modules.evaluate(script, [["leave", others]]) == [""]


OUT = """async ([steps, isStopped]) => { const {createOutOfReach} = await import('/devices/out_of_reach.js');
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
        const {memory} = await import('/documents/memory.js');
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


def limited(lowest: float | None, highest: float | None, note: str = "", *, is_whole: bool = True) -> dict[str, object]:
    return {"lowest": lowest, "highest": highest, "is_whole": is_whole, "note": note}


@pytest.mark.parametrize(
    ("quantity", "value", "limits", "text"),
    [
        # 400 steps make one turn of 8 mm: a step is 0.02 mm, and 5,000 steps/s are 100 mm/s.
        (
            "length",
            600,
            limited(-50, 500, ", the soft limits of axis 1"),
            "Steps is 12 mm (600 steps); allowed: whole steps from -1 to 10 mm, the soft limits of axis 1.",
        ),
        (
            "length",
            5,
            limited(10, None, ", the lowest"),
            "Steps is 0.1 mm (5 steps); allowed: at least 0.2 mm, the lowest.",
        ),
        (
            "speed",
            1050.0,
            limited(-1000, 1000, ", the slew speed of the axis' ramp", is_whole=False),
            "Steps is 21 mm/s (1050 steps/s); allowed: a number from -20 to 20 mm/s, the slew speed of the axis' ramp.",
        ),
        (
            "length",
            "abc",
            limited(-(2**31), 2**31 - 1),
            # A limit is rounded to the side that is allowed.
            "Steps is 'abc'; allowed: whole steps from -42949600 to 42949600 mm.",
        ),
    ],
)
def test_a_refusal_of_a_device_in_the_unit_that_is_shown(
    modules: Modules, quantity: str, value: object, limits: dict[str, object], text: str
) -> None:
    unit = "steps" if quantity == "length" else "steps/s"
    rejection = {"field": "axes.0.x", "value": value, "allowed": "what it said", "limits": limits, "unit": unit}
    told = modules.evaluate(REFUSAL, [rejection | {"message": ""}, quantity, "mm"])
    assert told.replace(",", "") == text.replace(",", "")
    in_steps = modules.evaluate(REFUSAL, [rejection | {"message": ""}, quantity, "steps"])
    assert in_steps.endswith("; allowed: what it said.")


REFUSAL = """async ([rejection, quantity, length]) => {
    const {inShownUnit} = await import('/panels/device/refusal.js');
    const design = {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'}};
    return inShownUnit(rejection, 'Steps', quantity, {length, time: 's'}, design); }"""


@pytest.mark.parametrize("limits", [None, limited(0, 46_242, is_whole=False)])
def test_what_a_device_refuses_in_words_or_in_another_unit_is_told_in_the_servers_words(
    modules: Modules, limits: object
) -> None:
    allowed = "axis 0 at most 46,242 steps/s, or with a pulse width of at most 2 µs (now 10 µs)"
    rejection = {"field": "by_steps", "value": 50, "allowed": allowed, "message": ""}
    if limits:
        rejection |= {"limits": limits, "unit": "steps/s"}
    assert modules.evaluate(REFUSAL, [rejection, "length", "mm"]) == f"Steps is 1 mm (50 steps); allowed: {allowed}."


def test_a_speed_has_no_sign_where_buttons_say_which_way(modules: Modules) -> None:
    script = """async (speeds) => { const {directedSpeed} = await import('/devices/directed_speed.js');
        return speeds.map(([speed, direction]) => directedSpeed(speed, direction)); }"""
    ahead, back, *refused = modules.evaluate(script, [[500, 1], [500, -1], [0, 1], ["fast", -1], ["", 1], [-500, -1]])
    assert (ahead, back) == ({"speed": 500, "rejections": []}, {"speed": -500, "rejections": []})
    for one, value in zip(refused, (0, "fast", "", -500), strict=True):
        [rejection] = one["rejections"]
        assert (rejection["field"], rejection["value"]) == ("speed_steps_per_s", value)
        assert rejection["allowed"] == (
            "a number from 0 to the slew speed of the axis’ ramp, but not 0: the buttons say which way"
        )


def test_what_the_server_says_of_a_speed_with_its_sign_is_told_of_the_speed_without(modules: Modules) -> None:
    script = """async ([rejection, length]) => {
        const {ofUndirected} = await import('/devices/directed_speed.js');
        const {inShownUnit} = await import('/panels/device/refusal.js');
        const design = {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'}};
        return inShownUnit(ofUndirected(rejection), 'Speed', 'speed', {length, time: 's'}, design); }"""
    limits = limited(-1000, 1000, ", the slew speed, and 0 or at least 0.03 steps/s either way", is_whole=False)
    fast = {"field": "speed_steps_per_s", "value": -1050, "allowed": "-1,000 to 1,000", "message": "", "limits": limits}
    assert modules.evaluate(script, [fast | {"unit": "steps/s"}, "mm"]) == (
        "Speed is 21 mm/s (1,050 steps/s); allowed: a number from 0 to 20 mm/s, the slew speed of the axis’ ramp, "
        "but not 0: the buttons say which way."
    )
    assert modules.evaluate(script, [fast | {"unit": "steps/s"}, "steps"]).replace(",", "") == (
        "Speed is 1050; allowed: a number from 0 to 1000 steps/s the slew speed of the axis’ ramp but not 0: "
        "the buttons say which way."
    )
    near = {"field": "speed_steps_per_s", "value": -300, "allowed": "a speed at which it can rest", "message": ""}
    assert modules.evaluate(script, [near, "steps"]) == "Speed is 300; allowed: a speed at which it can rest."
    directed = """async () => (await import('/devices/directed_speed.js')).directedSpeed(-300, -1).rejections[0]"""
    assert modules.evaluate(script, [modules.evaluate(directed), "steps"]).startswith("Speed is -300; ")


def test_why_a_push_is_refused_and_of_which_design(modules: Modules) -> None:
    script = """async (errors) => (await import('/model/messages.js')).pushRefusals(errors)"""
    remedy = {"text": "slower", "changes": [{"field": "axes.1.ramp.slew_speed_steps_per_s", "value": 700}]}
    reason = "Too long: 280 of 250 segments; slower."
    errors = [
        {"field": "axes.1.ramp.acceleration_steps_per_s2", "value": 1, "allowed": "a", "message": reason,
         "reason": reason, "remedies": [remedy]},
        {"field": "design.ramp.slew_speed_steps_per_s", "value": 9, "allowed": "at most 5 steps/s", "message": "m"},
        {"field": "to_axis", "value": 9, "allowed": "0", "message": "to_axis is 9; allowed: 0."},
        {"field": None, "value": None, "allowed": None, "message": "Not now."},
    ]  # fmt: skip
    mended = {"text": "slower", "changes": [{"field": "ramp.slew_speed_steps_per_s", "value": 700}]}
    assert modules.evaluate(script, errors) == [
        {"text": f"Axis 1: {reason}", "axis": 1, "remedies": [mended]},
        {"text": "Slew speed is 9; allowed: at most 5 steps/s.", "axis": 0, "remedies": []},
        {"text": "to_axis is 9; allowed: 0.", "axis": None, "remedies": []},
        {"text": "Not now.", "axis": None, "remedies": []},
    ]


SILENCE = """async (happens) => { const {createEvents} = await import('/server/events.js');
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


STOPPING = """async (happens) => {
    const own = {WebSocket: globalThis.WebSocket, fetch: globalThis.fetch, document: globalThis.document,
        setInterval, setTimeout, clearTimeout};
    const sockets = [], timers = [], asked = [];
    let answer;
    globalThis.document = {baseURI: 'http://127.0.0.1/'};
    globalThis.WebSocket = class { static OPEN = 1; readyState = 1; constructor() { sockets.push(this); }
        send(text) { asked.push('said'); this.number = JSON.parse(text).number; } };
    globalThis.setInterval = () => {};
    globalThis.setTimeout = (act, ms) => timers.push({act, ms});
    globalThis.clearTimeout = (timer) => { if (timers[timer - 1]) timers[timer - 1].act = () => {}; };
    globalThis.fetch = (_, {signal}) => new Promise((resolve, reject) => {
        asked.push('requested');
        answer = (status, told) => resolve({ok: status < 400, status, json: async () => told});
        signal.addEventListener('abort', () => reject(signal.reason));
        answer.fail = () => reject(new Error('no connection'));
    });
    const {api, watchDevices} = await import('/server/api.js');
    watchDevices(() => {}, () => {});
    const socket = sockets.at(-1), seen = [];
    const hear = (told) => socket.onmessage({data: JSON.stringify({did: {number: socket.number}, ...told})});
    let now = 'open';
    api.stopAll().then(() => { now = 'granted'; }, () => { now = 'failed'; });
    const ways = {
        wait: (ms) => timers.filter((one) => one.ms <= ms).forEach((one) => one.act()),
        answer: (status) => answer(status, status < 400 ? {devices: []} : {errors: [{message: 'no'}]}),
        fail: () => answer.fail(),
        tell: () => hear({devices: []}),
        refuse: () => hear({errors: [{message: 'no'}]}),
        close: () => { socket.readyState = 3; socket.onclose(); },
    };
    for (const [way, value] of happens) {
        ways[way](value);
        for (let turn = 0; turn < 40; turn += 1) await null;
        seen.push(now);
    }
    socket.onclose();
    Object.assign(globalThis, own);
    return [seen, asked]; }"""


@pytest.mark.parametrize(
    ("happens", "seen", "times_said"),
    [
        ([["answer", 200], ["wait", 100]], ["granted", "granted"], 0),
        ([["wait", 100], ["answer", 200], ["tell"]], ["open", "granted", "granted"], 1),
        ([["wait", 100], ["tell"]], ["open", "granted"], 1),
        # However late: after the second in which it is told, and after the request was given up.
        ([["wait", 1000], ["tell"]], ["open", "granted"], 1),
        ([["wait", 1000], ["answer", 200]], ["open", "granted"], 1),
        ([["wait", 100], ["wait", 15000], ["tell"]], ["open", "open", "granted"], 1),
        ([["fail"], ["tell"]], ["open", "granted"], 1),
        ([["answer", 500], ["tell"]], ["open", "granted"], 1),
        # One way that ends leaves the other; once both have, it has failed.
        ([["wait", 100], ["close"], ["answer", 200]], ["open", "open", "granted"], 1),
        ([["wait", 100], ["close"], ["wait", 15000]], ["open", "open", "failed"], 1),
        ([["wait", 100], ["wait", 15000], ["close"]], ["open", "open", "failed"], 1),
        ([["fail"], ["refuse"]], ["open", "failed"], 1),
        ([["close"], ["wait", 100], ["fail"]], ["open", "open", "failed"], 0),
        # The server's own no counts at once: it is the same over the other way, where nobody may answer.
        ([["answer", 409]], ["failed"], 0),
        ([["wait", 100], ["answer", 409]], ["open", "failed"], 1),
    ],
)
def test_a_stop_is_granted_whichever_way_and_however_late_and_fails_once_no_way_is_left(
    modules: Modules, happens: list[object], seen: list[str], times_said: int
) -> None:
    told, asked = modules.evaluate(STOPPING, happens)
    assert told == seen
    assert asked == ["requested", *["said"] * times_said]
