"""What follows from the page's state of devices after some commands."""

import json
import math
from typing import Any

import pytest

from designs import document
from frontend.modules import Modules
from frontend.state import DEVICE, OTHER, STATE, after
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.http_api.error_items import error_items
from stepramp.http_api.json_response import json_bytes


def test_an_axis_that_is_refused_is_marked_while_another_is_in_hand(modules: Modules) -> None:
    refused = [{"field": "name", "value": 1, "allowed": "a text", "message": "no"}]
    script = """(state, {refusedAxesOf}) => refusedAxesOf(state)"""
    asked = f"""async ([design, refused]) => {{ {STATE}
        const {{curvesRefused, curvesCame}} = await import('/app/commands/answers.js');
        const {{choose, setName}} = await import('/app/commands/work.js');
        const see = {script};
        const selectors = await import('/app/devices.js');
        const wrong = curvesRefused(state, refused, state.history.present.axes[0], 5);
        const away = choose(wrong, 7);
        const mended = setName(choose(away, 5), 'Another');
        return [state, wrong, away, mended, curvesCame(away, {{}}, 5)].map((one) => see(one, selectors)); }}"""
    assert modules.evaluate(asked, [document(), refused]) == [[], [5], [5], [], []]


def test_what_a_person_chose_stays_while_less_can_be_chosen(modules: Modules) -> None:
    axis = {"state": "ready"}
    two = {**DEVICE, "axes": [axis, axis]}
    one = {**DEVICE, "axes": [axis], "most_axes": 1}
    look = "(state, {deviceAxisOf, portOf}) => [deviceAxisOf(state), state.devices.axis, portOf(state)]"
    chosen = [["device.heard", [two], {}], ["device.chooseAxis", 1]]
    assert after(modules, chosen, look) == [1, 1, "sim://"]
    assert after(modules, [*chosen, ["device.heard", [one], {}]], look) == [0, 1, "sim://"]
    assert after(modules, [*chosen, ["device.heard", [one], {}], ["device.heard", [two], {}]], look) == [1, 1, "sim://"]
    moved = {**two, "port": "/dev/other"}
    assert after(modules, [*chosen, ["device.heard", [moved], {}]], look) == [1, 1, "/dev/other"]


def test_the_head_of_the_page_tells_of_a_controller_that_is_connected_at_another_port(modules: Modules) -> None:
    look = "(state, {toldDeviceOf}) => toldDeviceOf(state)?.name ?? null"
    other = {**DEVICE, "id": "2", "port": "b", "name": "Other"}
    assert after(modules, [["device.heard", [DEVICE], {}], ["device.choosePort", "b"]], look) == "Simulated"
    assert after(modules, [["device.heard", [DEVICE, other], {}], ["device.choosePort", "b"]], look) == "Other"
    assert after(modules, [["device.heard", [], {}]], look) is None


def test_a_move_is_of_the_axis_that_was_pushed_there_last(modules: Modules) -> None:
    pushed = ["device.pushed", "1", {"designs": [document(), OTHER], "ids": [5, 7], "toAxis": 1, "crc": None}]
    look = "(state, {moveOf}) => [0, 1, 2].map((axis) => moveOf(state, '1', axis).axis)"
    assert after(modules, [pushed], look) == [None, 5, 7]
    assert after(modules, [pushed, ["device.pushed", "1", None]], look) == [None, None, None]


def test_of_a_device_that_is_not_told_any_more_nothing_is_known(modules: Modules) -> None:
    known = [
        ["device.heard", [DEVICE, {**DEVICE, "id": "2"}], {}],
        *(["device.pushed", name, {"designs": [document()], "ids": [5], "toAxis": 0, "crc": None}] for name in "12"),
        *(["device.traceCame", name, {"step": [1]}] for name in "12"),
        ["device.previewCame", {"question": {"id": "1", "axis": 0, "designs": []}, "preview": None, "rejections": []}],
    ]
    look = """({devices: {pushed, traces, preview}}) =>
        [Object.keys(pushed), Object.keys(traces), preview?.question.id ?? null]"""
    assert after(modules, known, look) == [["1", "2"], ["1", "2"], "1"]
    assert after(modules, [*known, ["device.heard", [{**DEVICE, "id": "2"}], {}]], look) == [["2"], ["2"], None]


def test_what_was_refused_by_a_device_that_was_lost_is_over_once_it_is_back(modules: Modules) -> None:
    refused = ["device.refused", [{"field": None, "value": None, "allowed": None, "message": "It does not answer."}]]
    look = "({devices: {rejections}}) => rejections.length"

    def left(*states: str) -> int:
        told = [["device.heard", [{**DEVICE, "state": state}], {}] for state in states]
        found: int = after(modules, [*told[:1], refused, *told[1:]], look)
        return found

    assert left("ready", "lost", "connecting", "lost") == 1
    assert left("ready", "lost", "connecting", "ready") == left("lost", "ready") == 0
    # What a device that is there refuses stays, whatever it does.
    assert left("ready", "writing", "ready") == 1
    beside = [["device.heard", [DEVICE, {**DEVICE, "id": "2", "state": state}], {}] for state in ("lost", "ready")]
    assert after(modules, [beside[0], refused, beside[1]], look) == 1, "of another device"


def had(crc: int | None, state: str = "ready", heard_s: float = 30) -> list[object]:
    ramp = None if crc is None else {"sequence": 3, "crc": crc}
    return ["device.heard", [{**DEVICE, "state": state, "ramp": ramp, "heard_s": heard_s}], {}]


PUSHED: list[object] = [
    "device.pushed",
    "1",
    {"designs": [document()], "ids": [5], "toAxis": 0, "crc": 17, "heard_s": 20},
]


BEFORE = had(9, heard_s=10)


@pytest.mark.parametrize(
    ("steps", "is_known"),
    [
        ([BEFORE, PUSHED], True),
        # What is told of the time before the push may come after its answer.
        ([BEFORE, PUSHED, BEFORE, had(9, "writing"), had(17)], True),
        # Another page has pushed before this page heard of its own push, or the board has lost it.
        ([BEFORE, PUSHED, BEFORE, had(9)], False),
        ([BEFORE, PUSHED, had(8)], False),
        ([BEFORE, PUSHED, had(None)], False),
        ([BEFORE, PUSHED, had(17), had(17)], True),
        ([had(17), PUSHED, had(17)], True),
        # Another page has pushed since.
        ([BEFORE, PUSHED, had(17), had(9)], False),
        ([BEFORE, had(17), PUSHED, had(8)], False),
        # The board was reset, and had no ramp stored, or another one.
        ([BEFORE, PUSHED, had(17), had(17, "lost"), had(None, "connecting"), had(17)], True),
        ([BEFORE, PUSHED, had(17), had(17, "lost"), had(None)], False),
        ([BEFORE, PUSHED, had(17), had(17, "lost"), had(9)], False),
        ([BEFORE, PUSHED, had(17), BEFORE, PUSHED], True),
    ],
)
def test_what_was_pushed_is_known_as_long_as_the_device_has_it(
    modules: Modules, steps: list[list[object]], is_known: bool
) -> None:
    look = """(state, {moveOf, situationOf}) =>
        [moveOf(state, '1', 0).design !== null, situationOf(state).lastPushed !== null]"""
    assert after(modules, steps, look) == [is_known, is_known]


RAMP = {"sequence": 3, "crc": 9}
CUT: dict[str, Any] = {"designs": [document()], "ids": [5], "toAxis": 0, "before": RAMP}
CUT_SHORT: list[object] = ["device.pushCutShort", "1", CUT]
CUT_SHORT_AFTER_17: list[object] = ["device.pushCutShort", "1", {**CUT, "before": {"sequence": 3, "crc": 17}}]
OF_OTHERS = ["device.heard", [{**DEVICE, "ramp": {"sequence": 4, "crc": 17}, "in_control": "another page"}], {}]


@pytest.mark.parametrize(
    ("steps", "is_known"),
    [
        # Nothing was written: the device has the ramp that it had.
        ([BEFORE, CUT_SHORT], False),
        ([BEFORE, CUT_SHORT, had(9, "writing"), had(9)], False),
        # All of it had been sent. What is told while it is written may be from before.
        ([BEFORE, CUT_SHORT, had(17, "writing")], False),
        ([BEFORE, CUT_SHORT, had(17, "writing"), had(17)], True),
        ([BEFORE, CUT_SHORT, had(9), had(9, "writing"), had(17)], True),
        ([BEFORE, had(17), CUT_SHORT], True),
        # What was pushed before is on the device no more, or still.
        ([BEFORE, PUSHED, had(17), CUT_SHORT_AFTER_17, had(17)], True),
        # Another page has pushed since, or may have.
        ([BEFORE, CUT_SHORT, had(17), had(8, heard_s=40)], False),
        ([BEFORE, CUT_SHORT, OF_OTHERS], False),
        ([BEFORE, CUT_SHORT, OF_OTHERS, had(17)], False),
        # What was rolled back is not what was pushed.
        ([BEFORE, CUT_SHORT, ["device.pushed", "1", None], had(8)], False),
    ],
)  # fmt: skip
def test_a_push_that_a_stop_ended_is_known_by_the_ramp_that_the_device_has_then(
    modules: Modules, steps: list[list[object]], is_known: bool
) -> None:
    look = """(state, {moveOf, situationOf}) =>
        [moveOf(state, '1', 0).design !== null, situationOf(state).lastPushed !== null]"""
    assert after(modules, steps, look) == [is_known, is_known]


def previewed(to_axis: int = 0, *, same: bool = True, of: str = "1") -> list[object]:
    question = {"id": of, "state": [RAMP, False, 2e6, None], "axis": to_axis, "designs": [document()], "ids": [5]}
    return ["device.previewCame", {"question": question, "preview": {"same": same}, "rejections": []}]


@pytest.mark.parametrize(
    ("steps", "axes"),
    [
        # The page was loaded anew: a push would change nothing, so the device has this design.
        ([BEFORE, previewed()], [5, None]),
        ([BEFORE, previewed(to_axis=1)], [None, 5]),
        ([BEFORE, previewed(same=False)], [None, None]),
        ([BEFORE, previewed(of="2")], [None, None]),
        # It has another ramp since, or is gone.
        ([BEFORE, previewed(), had(8)], [None, None]),
        ([BEFORE, previewed(), ["device.heard", [], {}]], [None, None]),
        # What was pushed from here is known better.
        (
            [
                BEFORE,
                ["device.pushed", "1", {"designs": [document()], "ids": [7], "toAxis": 0, "crc": None}],
                previewed(),
            ],
            [7, None],
        ),
    ],
)
def test_what_a_device_is_found_to_have_is_what_its_moves_are_of(
    modules: Modules, steps: list[list[object]], axes: list[int | None]
) -> None:
    look = "(state, {moveOf}) => [0, 1].map((axis) => moveOf(state, '1', axis).axis)"
    assert after(modules, steps, look) == axes
    design = "(state, {moveOf}) => [0, 1].map((axis) => moveOf(state, '1', axis).design !== null)"
    assert after(modules, steps, design) == [axis is not None for axis in axes]


PUSH_ENDED = """async ([design]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDeviceActions} = await import('/app/effects/device_actions.js');
    const {api, Ended} = await import('/server/api.js');
    const {createGestures} = await import('/server/gestures.js');
    const real = api.push;
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    store.dispatch(COMMANDS.work.begin, {axes: [design], together: 'independent', ids: [5], active: 0, kept: null});
    api.push = async () => { throw new Ended('stop'); };
    const actions = createDeviceActions(store, createGestures(), new Map(), {outdate: () => {}});
    await actions.push({id: '1', stops: 0, ramp: {sequence: 3, crc: 9}}, [design], 2, 'try');
    api.push = real;
    const {cutShort, rejections, asking} = store.state().devices;
    return [cutShort['1'], rejections, asking, store.state().told.notice !== null]; }"""


def test_a_push_that_a_stop_ended_is_remembered_with_the_ramp_before_it(modules: Modules) -> None:
    cut_short = {"designs": [document()], "ids": [5], "toAxis": 2, "before": RAMP}
    assert modules.evaluate(PUSH_ENDED, [document()]) == [cut_short, [], None, True]


PUSH = """async ([design, items]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDeviceActions} = await import('/app/effects/device_actions.js');
    const {api} = await import('/server/api.js');
    const {createGestures} = await import('/server/gestures.js');
    const real = api.push;
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    store.dispatch(COMMANDS.work.begin, {axes: [design], together: 'independent', ids: [5], active: 0, kept: null});
    api.push = async () => ({items, verified: true, heard_s: 20});
    const actions = createDeviceActions(store, createGestures(), new Map(), {outdate: () => {}});
    await actions.push({id: '1', stops: 0}, [design], 2, 'try');
    api.push = real;
    return store.state().devices.pushed['1']; }"""


@pytest.mark.parametrize("crc", [17, None])
def test_what_was_pushed_is_remembered_with_the_checksum_of_the_ramps(modules: Modules, crc: int | None) -> None:
    items = [{"name": "Slew speed", "unit": "steps/s", "sent": 4}]
    if crc is not None:
        items.append({"name": "Ramp image", "unit": "CRC-16", "sent": crc})
    known = {"designs": [document()], "ids": [5], "toAxis": 2, "crc": crc, "heard_s": 20}
    assert modules.evaluate(PUSH, [document(), items]) == known


def test_what_a_push_would_change_is_asked_anew_once_what_it_depends_on_is_another(modules: Modules) -> None:
    script = """async ([design, was, now]) => {
        const {FIRST_STATE, createStore} = await import('/app/state.js');
        const {COMMANDS} = await import('/app/commands/commands.js');
        const {areSameQuestions, previewQuestionOf} = await import('/app/devices.js');
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const heard = ({motors_on, ...axis}) => store.dispatch(COMMANDS.device.heard, [{id: '1', port: 'sim://',
            state: 'ready', axes: [axis], most_axes: 1, stops: 0, in_control: null, motors_on}], {});
        store.dispatch(COMMANDS.work.begin,
            {axes: [design], together: 'independent', ids: [5], active: 0, kept: null});
        store.dispatch(COMMANDS.device.linked, 'there');
        store.dispatch(COMMANDS.answers.curvesCame,
            {design, profiles: {[design.method.name]: {warnings: []}}, errors: {}, failures: {}}, 5);
        heard(was);
        const before = previewQuestionOf(store.state());
        heard(now);
        return areSameQuestions(before, previewQuestionOf(store.state())); }"""
    was = {"steps_per_mm": None, "microsteps": 8, "position_steps": 0, "motors_on": False}
    assert modules.evaluate(script, [document(), was, was | {"position_steps": 5}])
    assert not modules.evaluate(script, [document(), was, was | {"microsteps": 16}])
    assert not modules.evaluate(script, [document(), was, was | {"steps_per_mm": 80}])
    assert not modules.evaluate(script, [document(), was, was | {"motors_on": True}]), "some aren't restarted then"


REFUSED = """async ([design, rejections, meanwhile]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDeviceActions} = await import('/app/effects/device_actions.js');
    const {previewQuestionOf, situationOf} = await import('/app/devices.js');
    const {api, Refusal} = await import('/server/api.js');
    const {createGestures} = await import('/server/gestures.js');
    const real = api.push;
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const device = {id: '1', port: 'sim://', state: 'ready', axes: [{}], most_axes: 1, stops: 0, in_control: null};
    const sound = (of, axis) => store.dispatch(COMMANDS.answers.curvesCame,
        {design: of, profiles: {[of.method.name]: {warnings: []}}, errors: {}, failures: {}}, axis);
    const other = {...design, ramp: {...design.ramp, slew_speed_steps_per_s: 700}};
    store.dispatch(COMMANDS.work.begin,
        {axes: [design, other], together: 'independent', ids: [5, 7], active: 0, kept: null});
    store.dispatch(COMMANDS.device.heard, [device], {});
    store.dispatch(COMMANDS.device.linked, 'there');
    sound(design, 5);
    api.push = async () => {
        if (meanwhile === 'choose') {
            store.dispatch(COMMANDS.work.choose, 7);
            sound(other, 7);
            const known = {question: previewQuestionOf(store.state()), preview: {same: true}, rejections: []};
            store.dispatch(COMMANDS.device.previewCame, known);
        }
        throw new Refusal(422, rejections); };
    const actions = createDeviceActions(store, createGestures(), new Map(), {outdate: () => {}});
    await actions.push(device, [design], 0, 'try');
    api.push = real;
    const {refusals, preview} = situationOf(store.state());
    const {notice, announced} = store.state().told;
    return {blamed: refusals.map(({axis}) => axis), isPreviewed: preview !== null, notice: notice?.text ?? null,
        announced: announced.text, left: store.state().devices.rejections}; }"""


def test_a_push_that_is_refused_is_shown_at_what_was_pushed_and_nothing_else(modules: Modules) -> None:
    slew = "design.ramp.slew_speed_steps_per_s"
    refused = [{"field": slew, "value": 1000, "allowed": "less", "message": "It is too fast."}]
    still = modules.evaluate(REFUSED, [document(), refused, ""])
    assert (still["blamed"], still["notice"], still["left"]) == ([5], None, [])
    assert "Slew speed is 1,000; allowed: less." in still["announced"]
    # Another axis came in hand before the refusal: what is known of that one stays, and the refusal is told.
    gone = modules.evaluate(REFUSED, [document(), refused, "choose"])
    assert (gone["blamed"], gone["isPreviewed"], gone["left"]) == ([], True, [])
    assert "Slew speed is 1,000; allowed: less." in gone["notice"]


def test_a_ramp_without_a_checksum_is_taken_to_be_the_pushed_one(modules: Modules) -> None:
    pushed = ["device.pushed", "1", {"designs": [document()], "ids": [5], "toAxis": 0, "crc": None}]
    look = "(state, {moveOf}) => moveOf(state, '1', 0).axis"
    assert after(modules, [pushed, had(9), had(8)], look) == 5


def test_a_value_that_is_refused_is_no_change_since_the_push(modules: Modules) -> None:
    look = "(state, {situationOf}) => situationOf(state).isChanged"
    pushed = ["device.pushed", "1", {"designs": [document(), document()], "ids": [5, 7], "toAxis": 0, "crc": None}]
    known = [["device.heard", [DEVICE], {}], pushed]
    changed = [*known, ["work.setValue", "ramp.slew_speed_steps_per_s", 700, "", 1]]
    assert after(modules, changed, look)
    rejection = {"field": "ramp.slew_speed_steps_per_s", "value": 700, "allowed": "less", "message": "no"}
    assert not after(modules, [*changed, ["answers.curvesRefused", [rejection], document(), 5]], look)


def test_a_running_move_lies_over_the_plots_of_its_own_axis_and_a_jog_over_none(modules: Modules) -> None:
    look = (
        "(state, {samplesOf, runningMoveOf}) => [samplesOf(state)?.length ?? null, runningMoveOf(state)?.done ?? null]"
    )
    axis = {"axis": 0, "state": "moving", "position_steps": 30, "target_steps": 90, "speed_steps_per_s": 5}
    moving = [{**DEVICE, "state": "moving", "axes": [axis]}]

    def heard(length: int | None) -> list[object]:
        samples = {"time_s": [0, 1], "position": [0, 30], "speed": [0, 5], "length": length}
        return ["device.heard", moving, {"1 0": {"samples": samples, "restingPlace": 0}}]

    def pushed(axis_id: int) -> list[object]:
        return ["device.pushed", "1", {"designs": [document()], "ids": [axis_id], "toAxis": 0, "crc": None}]

    assert after(modules, [heard(90)], look) == [90, 30], "nobody knows which axis' it is"
    assert after(modules, [heard(90), pushed(5)], look) == [90, 30]
    assert after(modules, [heard(90), pushed(7)], look) == [None, None]
    assert after(modules, [heard(None), pushed(5)], look) == [None, 30]


def test_a_trace_that_was_taken_away_stays_away_whichever_it_is(modules: Modules) -> None:
    script = f"""async ([design, device, axes]) => {{ {STATE}
        const {{heard, removeTrace, showMeasured}} = await import('/app/commands/device.js');
        const {{samplesOf}} = await import('/app/devices.js');
        const {{measuredOf}} = await import('/app/selectors.js');
        const samples = (end) => ({{time_s: [0, 1], position: [0, end], speed: [0, 5], length: end}});
        const tell = (now, ...all) => heard(now, [{{...device, axes}}],
            Object.fromEntries(all.map((one, at) => [`1 ${{at}}`, {{samples: one, restingPlace: 0}}])));
        const [first, second, later] = [90, 40, 70].map(samples);
        const move = {{step: [1, 2]}};
        const look = (now) => [measuredOf(now) !== null, samplesOf(now)?.length ?? null, now.devices.removed.length];
        const told = tell(state, first, second), removed = removeTrace(told);
        const measured = showMeasured(told, {{of: {{axis: 5, design: null}}, move}});
        const others = showMeasured(told, {{of: {{axis: 7, design: null}}, move}});
        return [told, removed, tell(removed, first, second), tell(removed, later, second), removeTrace(measured),
            removeTrace(others)].map(look).concat([removeTrace(others).devices.measured !== null]); }}"""
    axis = {"axis": 0, "state": "ready", "position_steps": 90, "target_steps": 90, "speed_steps_per_s": 0}
    seen = modules.evaluate(script, [document(), DEVICE, [axis, {**axis, "axis": 1}]])
    assert seen == [
        [False, 90, 0],
        [False, None, 1],
        [False, None, 1],
        [False, 70, 0],
        [False, None, 1],
        [False, None, 1],
        True,
    ]


def test_what_lies_over_the_plots_is_of_the_device_in_view(modules: Modules) -> None:
    """Another one that moves meanwhile may have more axes, or fewer, and other ramps."""
    look = (
        "(state, {samplesOf, runningMoveOf}) => [samplesOf(state)?.length ?? null, runningMoveOf(state)?.done ?? null]"
    )
    axis = {"axis": 0, "position_steps": 30, "target_steps": 90, "speed_steps_per_s": 5}
    both = [
        {**DEVICE, "axes": [{**axis, "state": "ready"}]},
        {**DEVICE, "id": "2", "port": "other", "state": "moving", "axes": [{**axis, "state": "moving"}]},
    ]
    samples = {"time_s": [0, 1], "position": [0, 30], "speed": [0, 5], "length": 90}
    heard = ["device.heard", both, {"2 0": {"samples": samples, "restingPlace": 0}}]
    assert after(modules, [heard, ["device.choosePort", "sim://"]], look) == [None, None]
    assert after(modules, [heard, ["device.choosePort", "other"]], look) == [90, 30]


def test_there_and_back_goes_on_while_its_axis_rests_between_two_halves(modules: Modules) -> None:
    look = "(state, {isGoingOn}) => isGoingOn(state)"
    axis = {"axis": 0, "state": "ready", "position_steps": 90, "target_steps": 90, "speed_steps_per_s": 0}

    def told(state: str, shuttle: int | None) -> list[list[object]]:
        told = {"axes": [{**axis, "state": state}], "shuttle": None if shuttle is None else {"axis": shuttle}}
        return [["device.heard", [{**DEVICE, **told}], {}]]

    assert [after(modules, told("moving", None), look), after(modules, told("ready", 0), look)] == [True, True]
    assert [after(modules, told("ready", 1), look), after(modules, told("ready", None), look)] == [False, False]
    pushed = ["device.pushed", "1", {"designs": [document()], "ids": [7], "toAxis": 0, "crc": None}]
    assert not after(modules, [*told("ready", 0), pushed], look), "it is of another axis than the one in hand"


def test_what_is_told_to_move_at_its_target_is_at_its_end_unless_it_runs_without_one(modules: Modules) -> None:
    look = "(state, {runningMoveOf}) => runningMoveOf(state).remaining"
    axis = {"axis": 0, "state": "moving", "position_steps": 90, "target_steps": 90, "speed_steps_per_s": 5}
    moving = [{**DEVICE, "state": "moving", "axes": [axis]}]
    for length, remaining in [(90, 0), (None, math.inf)]:
        samples = {"time_s": [0, 1], "position": [0, 90], "speed": [0, 5], "length": length}
        heard: list[object] = ["device.heard", moving, {"1 0": {"samples": samples, "restingPlace": 0}}]
        assert after(modules, [heard], look) == remaining


@pytest.mark.parametrize(
    ("steps", "played"),
    [
        ([], 0),
        ([["device.chooseAxis", 1]], 1),
        # What was pushed there is known better: axis 1 of the device plays the design of the first tab.
        (
            [
                ["device.chooseAxis", 1],
                ["device.pushed", "1", {"designs": [OTHER], "ids": [5], "toAxis": 1, "crc": None}],
            ],
            0,
        ),
        ([["device.chooseAxis", 1], ["work.choose", 7], ["work.removeAxis", 7]], None),
        ([["device.pushed", "1", {"designs": [OTHER], "ids": [99], "toAxis": 0, "crc": None}]], None),
        ([["device.heard", [{**DEVICE, "state": "lost"}], {}]], None),
    ],
)
def test_which_design_the_chosen_axis_of_a_device_plays(
    modules: Modules, steps: list[list[object]], played: int | None
) -> None:
    two = {**DEVICE, "axes": [{"state": "ready"}, {"state": "ready"}]}
    known: list[list[object]] = [["device.heard", [two], {}], *steps]
    assert after(modules, known, "(state, {playedOf}) => playedOf(state)") == played


def test_a_push_tells_of_a_name_that_keeps_it_back(modules: Modules) -> None:
    with pytest.raises(Rejected) as caught:
        Design.checked(document(name="x" * 101))
    [refused] = [json.loads(json_bytes(each)) for each in error_items(caught.value)]
    other = {"field": "timer.counter_bits", "value": 7, "allowed": "8", "message": "no"}
    look = "(state, {situationOf}) => situationOf(state).nameProblem"
    assert after(modules, [], look) == ""
    for rejections, told in [
        ([refused], "The name has 500 characters; allowed: at most 100."),
        ([other, refused], "The name has 500 characters; allowed: at most 100."),
        ([other], ""),
    ]:
        named = ["work.setName", "x" * 500]
        steps: list[list[object]] = [named, ["answers.curvesRefused", rejections, document(), 5]]
        assert after(modules, steps, look) == told


def test_how_far_a_move_has_come_is_told_to_a_page_that_did_not_see_its_start(modules: Modules) -> None:
    axis = {"axis": 0, "state": "moving", "position_steps": 22_117, "target_steps": 50_000, "speed_steps_per_s": 1000}
    moving = [{**DEVICE, "state": "moving", "axes": [{**axis, "steps_made": 4117}]}]
    look = "(state, {runningMoveOf}) => [runningMoveOf(state).done, runningMoveOf(state).remaining]"
    assert after(modules, [["device.heard", moving, {}]], look) == [4117, 27_883]


def test_what_is_known_of_a_device_is_never_shown_as_younger_than_it_is(modules: Modules) -> None:
    told = modules.evaluate(
        """async () => { const {createAges, TOLD_EACH_S, agoText} = await import('/devices/ages.js');
        const ages = createAges(), wrong = [];
        ages.hear([{id: 'a', state: 'idle', age_s: 0.5}], 100);
        for (let real = 0.5; real < 20; real += 0.01) {
            const {a} = ages.old(100 + real - 0.5);
            // What is shown holds until it is told anew.
            const least = real + TOLD_EACH_S;
            if (real < 2 ? a !== undefined : a < least || a > least + 1) wrong.push([real, a]);
        }
        return [wrong, agoText(119), agoText(120), agoText(121)]; }""",
    )
    assert told == [[], "119 s ago", "2 min ago", "3 min ago"]
