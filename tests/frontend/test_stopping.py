"""STOP in the page, without a page: what a press does, what becomes of it, and what is out of its reach."""

import pytest

from frontend.modules import Modules

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
        # Another server knows of other stops.
        ([[], devices("stopping", stops=12)], "STOP"),
    ],
)
def test_what_the_next_press_does(modules: Modules, told: list[list[dict[str, object]]], button: str) -> None:
    asked, _ = modules.evaluate(STOP, stopped_then(*told))
    assert asked[-1] == button


def test_what_another_server_tells_of_was_stopped_by_nobody(modules: Modules) -> None:
    """Its numbers are greater, and what it tells of may have the same id at the same port."""
    script = """async ([known, answered, later]) => { const {api} = await import('/server/api.js');
        const {createStop} = await import('/devices/stopping.js');
        const own = {...api};
        Object.assign(api, {stopAll: async () => ({devices: answered})});
        let present = known;
        const stop = createStop({devices: () => present, endMotions() {}, hearStops() {}}, () => {});
        await stop.press();
        present = answered; stop.follow(present);
        const seen = [stop.isStopped(present[0])];
        stop.leave();
        present = later; stop.follow(present);
        seen.push(stop.isStopped(present[0]), stop.isHaltNext());
        Object.assign(api, own);
        return seen; }"""
    told = [devices("moving"), devices("lost", stops=9), devices("stopping", stops=5_000_000)]
    assert modules.evaluate(script, told) == [True, False, False]


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
    # At an end of its way there and back: it sets out again by itself.
    "pausing": [{"id": "1", "port": "A", "name": "board", "state": "ready", "stops": 7, "axes": [], "shuttle": {}}],
    # Of another server, which gives its first device the same id.
    "elsewhere": [{"id": "1", "port": "B", "name": "other", "state": "ready", "stops": 9, "axes": []}],
    "recounting": [{"id": "2", "port": "A", "name": "other", "state": "ready", "stops": 3, "axes": []}],
}


def fate_by_the_rules(first: str, happened: list[str]) -> str:
    """Return what has become of STOP, by what is written of it.

    An answer holds for its press and those before it. What is late, hopeless or fails is told, until all that the press
    was meant for says after that that it rests: what is at the same port, where there was one. What goes there and back
    rests only once that is over.
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
                if was["port"] == now["port"] and now["state"] == "ready" and "shuttle" not in now:
                    is_settled, fate = True, "answered"
        worst = max(worst, fate, key=["answered", "waiting", "undelivered"].index)
    return worst


@pytest.mark.parametrize("first", ["none", "moving"])
@pytest.mark.parametrize("ends", [("grant", "grant"), ("grant", "fail"), ("fail", "grant"), ("fail", "fail")])
@pytest.mark.parametrize("told", [["none", "moving"], ["resting", "none"], ["pausing"], ["elsewhere"], ["recounting"]])
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


def test_another_servers_device_of_the_same_id_is_not_the_lost_one(modules: Modules) -> None:
    script = """async (happens) => { const {createOutOfReach} = await import('/devices/out_of_reach.js');
        const out = createOutOfReach();
        return happens.map(([way, devices]) => { out[way](devices);
            return [out.words(devices, () => false), out.isUndelivered(devices, () => true)]; }); }"""
    [moving], [lost], [connecting] = devices("moving"), devices("lost"), devices("connecting")
    other = connecting | {"port": "port 9"}
    tells, nothing = [MAY_MOVE, True], ["", False]
    # One server knows it by its id wherever it is found again.
    assert modules.evaluate(script, [["follow", [moving]], ["follow", [other]]]) == [nothing, tells]
    # After the end of a server a device of its id may be any: only at the same port it is taken for the same.
    for last in (moving, lost):
        before = [["follow", [moving]], ["follow", [last]], ["leave", [last]]]
        assert modules.evaluate(script, [*before, ["follow", [other]]])[-1] == nothing
        assert modules.evaluate(script, [*before, ["follow", [connecting]], ["follow", [other]]])[-2:] == [tells, tells]


def test_a_page_that_comes_later_sees_that_a_lost_one_had_not_arrived(modules: Modules) -> None:
    [lost] = devices("lost")
    on_the_way = [lost | {"axes": [{"position_steps": 40, "target_steps": 900}]}]
    arrived = [lost | {"axes": [{"position_steps": 900, "target_steps": 900}]}]
    assert modules.evaluate(OUT, [[on_the_way], False]) == [MAY_MOVE]
    assert modules.evaluate(OUT, [[arrived], False]) == [""]
    assert modules.evaluate(OUT, [[on_the_way, []], False]) == [MAY_MOVE, ""]


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
    socket.onopen();
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
        # Whoever asks isn't known any more, but the socket is open.
        ([["answer", 401], ["tell"]], ["open", "granted"], 1),
        ([["answer", 401], ["refuse"]], ["open", "failed"], 1),
    ],
)
def test_a_stop_is_granted_whichever_way_and_however_late_and_fails_once_no_way_is_left(
    modules: Modules, happens: list[object], seen: list[str], times_said: int
) -> None:
    told, asked = modules.evaluate(STOPPING, happens)
    assert told == seen
    assert asked == ["requested", *["said"] * times_said]
