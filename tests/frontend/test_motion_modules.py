"""What guards motions in the page, without a page: gestures that a STOP ends, the gate, ages, soft limits, refusals."""

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
    assert modules.evaluate(script, happens) == [{}, {}, {"1": 3}, {"1": 6}, {}]
    assert modules.evaluate(script, [[5, told("lost", 60.2)], [6, None]]) == [{"1": 61}, {"1": 62}]
    assert modules.evaluate(script, [[5, told("connecting", None)], [99, None]]) == [{}, {}]
    # Of what is being written the server hears all the time, but not where its axes are; they rest.
    assert modules.evaluate(script, [[5, told("writing", 40)], [8, None]]) == [{}, {"1": 4}]


def test_what_moved_when_the_server_ended_is_told_until_it_says_itself_what_it_does(modules: Modules) -> None:
    script = """async (happens) => { const {createEnded} = await import('/devices/ended.js');
        const ended = createEnded(({port}) => port !== 'virtual');
        return happens.map(([way, devices]) => { ended[way](devices); return ended.words(); }); }"""
    here = {"position_steps": 7, "target_steps": 7}
    board = {"id": "1", "name": "Board", "port": "/dev/ttyACM0", "state": "moving", "axes": [here]}
    words = (
        "Board (/dev/ttyACM0) was moving when the server ended, and may still move: stop it once it is connected "
        "again, or cut the motor’s power."
    )
    connecting = [board | {"state": "connecting", "axes": []}]
    happens = [["leave", [board]], ["follow", []], ["follow", connecting], ["leave", connecting], ["follow", [board]]]
    assert modules.evaluate(script, happens) == [words, words, words, words, ""]
    # The simulated one ended with its server, and what was at rest stays there.
    others = [board | {"port": "virtual"}, board | {"state": "ready"}, board | {"state": "lost"}]
    assert modules.evaluate(script, [["leave", others]]) == [""]
    # What was lost on its way is no less on its way when the server ends too.
    on_its_way = board | {"state": "lost", "axes": [here, here | {"target_steps": 900}]}
    lost = words.replace("the server ended", "it was lost")
    assert modules.evaluate(script, [["leave", [on_its_way]], ["follow", [on_its_way | {"axes": []}]]]) == [lost, lost]


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


def test_soft_limits_are_remembered_with_the_steps_that_their_axis_then_made(modules: Modules) -> None:
    script = """async () => { const kept = {};
        globalThis.localStorage = {getItem: (key) => kept[key] ?? null, setItem: (key, text) => { kept[key] = text; }};
        const {memory} = await import('/documents/memory.js');
        const {FIRST_STATE, createStore} = await import('/app/state.js');
        const {createDeviceActions} = await import('/app/effects/device_actions.js');
        const {createGestures} = await import('/server/gestures.js');
        const {api} = await import('/server/api.js');
        const own = api.limit;
        const axis = (axis, steps_per_mm) => ({axis, steps_per_mm, microsteps: 16});
        api.limit = async () => ({axes: [axis(0, 80), axis(1, 125)]});
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const {limit} = createDeviceActions(store, createGestures(), new Map(), {outdate() {}});
        await limit({id: '1', port: 'C', axes: [axis(0, 80), axis(1, 250)]},
            [{axis: 1, lowest_steps: -1250, highest_steps: null}]);
        const seen = [memory.softLimits('C'), store.state().devices.softLimits.C];
        api.limit = own;
        delete globalThis.localStorage;
        return seen; }"""
    kept = {"axis": 1, "lowest_steps": -1250, "highest_steps": None, "steps_per_mm": 125, "microsteps": 16}
    assert modules.evaluate(script) == [[kept], [kept]]


OTHER = "so they may be at other places"


@pytest.mark.parametrize(
    ("before", "now", "text"),
    [
        ((250, None), (250, None), ""),
        ((250.0000001, 16), (250, 16), ""),
        ((None, None), (None, None), ""),
        ((250, None), (125, None), f"were set while it made 250 steps per mm, and by now it makes 125, {OTHER}"),
        ((80, 16), (80, 32), f"were set while it made 16 steps of a full step, and by now it makes 32, {OTHER}"),
        (
            (250, None),
            (None, None),
            f"were set while it made 250 steps per mm, and by now it doesn\u2019t tell how many, {OTHER}",
        ),
        (
            (None, None),
            (80.25, None),
            f"were set when it was not known how many steps per mm it makes, and by now it makes 80.25, {OTHER}",
        ),
    ],
)
def test_soft_limits_of_another_scale_would_be_at_other_places(
    modules: Modules, before: tuple[float | None, ...], now: tuple[float | None, ...], text: str
) -> None:
    kept, axis = (dict(zip(("steps_per_mm", "microsteps"), scale, strict=True)) for scale in (before, now))
    assert modules.call("devices/kept_limits.js", "otherPlacesText", kept, axis) == text
    if before == (None, None):  # As a page kept them that didn't ask yet.
        assert modules.call("devices/kept_limits.js", "otherPlacesText", {}, axis) == text


def test_soft_limits_in_words(modules: Modules) -> None:
    script = """async (spans) => { const {limitsText} = await import('/panels/device/limits.js');
        const design = {axis: {full_steps_per_rev: 200, microsteps: 2, travel_per_rev: 8, travel_unit: 'mm'}};
        return ['steps', 'mm'].map((length) => spans.map(([low, high]) =>
            limitsText({length, time: 's'}, design, {lowest_steps: low, highest_steps: high}))); }"""
    spans = [[-1000, 20000], [None, 500], [0, None], [None, None], [-500, -500]]
    in_steps, in_mm = modules.evaluate(script, spans)
    assert in_steps == ["\u22121,000 to 20,000 steps", "up to 500 steps", "from 0 steps", "", "only \u2212500 steps"]
    # 400 steps make one turn of 8 mm.
    assert in_mm == ["\u221220 to 400 mm", "up to 10 mm", "from 0 mm", "", "only \u221210 mm"]


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
            "Steps is 12 mm (600 steps); allowed: a number from -1 to 10 mm, the soft limits of axis 1.",
        ),
        (
            "length",
            5,
            limited(10, None, ", the lowest"),
            "Steps is 0.1 mm (5 steps); allowed: at least 0.2 mm, the lowest.",
        ),
        (
            "length",
            2.5,
            limited(-50, 500),
            "Steps is 0.05 mm (2.5 steps); allowed: a number from -1 to 10 mm, in steps of 0.02 mm.",
        ),
        # Of a single place its length isn't rounded inwards, where nothing would be left.
        ("length", 2.5, limited(2000, 2000), "Steps is 0.05 mm (2.5 steps); allowed: only 40 mm."),
        (
            "length",
            5,
            limited(12_345_678, 12_345_678, ", the end"),
            "Steps is 0.1 mm (5 steps); allowed: only 246,914 mm, the end.",
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
            "Steps is 'abc'; allowed: a number from -42949600 to 42949600 mm.",
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
    const {inShownUnit} = await import('/ui/refusal.js');
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
        const {inShownUnit} = await import('/ui/refusal.js');
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
    # What is beyond every ramp says nothing of this one's.
    beyond = fast | {"value": 1e7, "unit": "steps/s", "limits": limited(-1_000_000, 1_000_000, "", is_whole=False)}
    assert modules.evaluate(script, [beyond, "steps"]).replace(",", "") == (
        "Speed is 10000000; allowed: a number from 0 to 1000000 steps/s but not 0: the buttons say which way."
    )
    slow = fast | {"value": -0.01, "unit": "steps/s", "limits": limited(0.03, 1000, " either way", is_whole=False)}
    assert modules.evaluate(script, [slow, "mm"]) == (
        "Speed is 0.0002 mm/s (0.01 steps/s); allowed: a number from 0.0006 to 20 mm/s: the buttons say which way."
    )
    near = {"field": "speed_steps_per_s", "value": -300, "allowed": "a speed at which it can rest", "message": ""}
    assert modules.evaluate(script, [near, "steps"]) == "Speed is 300; allowed: a speed at which it can rest."
    told = [("150 steps/s", 150, "steps/s", "down"), ("400 steps", 400, "steps", "nearest")]
    names = ("text", "value", "unit", "rounding")
    limited_way = near | {
        "field": "axes.0.speed_steps_per_s",
        "allowed": "at most 150 steps/s that way, as axis 0 has to come to rest within its soft limits, 0 to 400 steps",
        "told": [dict(zip(names, each, strict=True)) | {"axis": None} for each in told],
    }
    assert modules.evaluate(script, [limited_way, "mm"]) == (
        "Speed is 6 mm/s (300 steps/s); allowed: at most 3 mm/s that way, as axis 0 has to come to rest within its "
        "soft limits, 0 to 8 mm."
    )
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
    let tick, again, isUnknown = false;
    globalThis.WebSocket = class { static OPEN = 1; readyState = 0; constructor() { sockets.push(this); } };
    globalThis.setInterval = (act) => { tick = act; };
    globalThis.setTimeout = (act) => { again = act; };
    createEvents(() => 'ws://', async () => isUnknown)
        .watch(() => {}, (link) => { if (seen.at(-1) !== link) seen.push(link); });
    const ways = {
        open: () => { sockets.at(-1).readyState = 1; sockets.at(-1).onopen(); },
        tell: () => sockets.at(-1).onmessage({data: '{"devices": []}'}),
        answer: () => sockets.at(-1).onmessage({data: '{"did": {"number": 1}, "devices": []}'}),
        close: () => { sockets.at(-1).readyState = 3; sockets.at(-1).onclose(); again(); },
        refuse: () => { isUnknown = true; ways.close(); },
        end: () => { isUnknown = false; ways.close(); },
        tick: () => tick(),
    };
    const told = [];
    for (const [way, times] of happens) {
        for (let time = 0; time < times; time += 1) ways[way]();
        for (let turn = 0; turn < 5; turn += 1) await null;
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


def test_a_server_that_refuses_the_page_is_there_and_one_that_ends_then_is_gone(modules: Modules) -> None:
    happens = [("open", 1), ("close", 1), ("end", 1), ("refuse", 1), ("tick", 20), ("refuse", 1), ("end", 1)]
    told = ["there", "gone", "gone", "unknown", "unknown", "unknown", "gone"]
    assert modules.evaluate(SILENCE, happens) == told
    assert modules.evaluate(SILENCE, [("refuse", 1), ("open", 1), ("close", 1)]) == ["unknown", "there", "gone"]


def test_what_pauses_at_an_end_of_its_way_is_not_ready(modules: Modules) -> None:
    script = """async (devices) => { const {shownState, shuttleText} = await import('/devices/state_words.js');
        return devices.map((device) => [shownState(device), shuttleText(device)]); }"""
    shuttle = {"axis": 0, "by_steps": 60, "times": 3, "times_done": 1, "pause_s": 8.5}
    rests, moves = {"state": "ready", "shuttle": None}, {"state": "moving", "shuttle": shuttle}
    assert modules.evaluate(script, [None, rests, moves, moves | {"state": "ready"}]) == [
        ["none", ""],
        ["ready", ""],
        ["moving", "There and back: 1 of 3 done. STOP ends it, also in a pause."],
        [
            "pausing",
            "There and back: 1 of 3 done. It sets out again by itself, 8.5 s after it came to rest. "
            "STOP ends it, also in a pause.",
        ],
    ]
