"""Questions that ask themselves, answers that find them, and those who hear of a state."""

import pytest

from designs import document
from frontend.modules import Modules

QUESTION = """async (steps) => {
    const {createQuestion} = await import('/app/effects/question.js');
    const {Refusal, ServerGone} = await import('/server/api.js');
    const [asked, heard, waiting] = [[], [], []];
    const [real, realClear] = [globalThis.setTimeout, globalThis.clearTimeout];
    globalThis.setTimeout = (act, ms) => { waiting.push({act, ms}); return waiting.length; };
    globalThis.clearTimeout = (index) => { if (waiting[index - 1]) waiting[index - 1].act = null; };
    const answers = [];
    const question = createQuestion({
        ask: (one) => { asked.push(one); return new Promise((resolve, reject) => answers.push({resolve, reject})); },
        take: (found, one) => heard.push(['took', found, one]), refuse: (_, one) => heard.push(['refused', one]),
        miss: (one) => heard.push(['missed', one])});
    for (const [what, value, more] of steps) {
        if (what === 'want') question.want(value);
        if (what === 'cancel') question.cancel();
        if (what === 'again') question.again();
        if (what === 'wait') { const {act, ms} = waiting.at(-1); heard.push(['after', ms]); act?.(); }
        if (what === 'answer') answers[value].resolve(more);
        if (what === 'gone') answers[value].reject(new ServerGone('gone'));
        if (what === 'refuse') answers[value].reject(new Refusal(more ?? 422, []));
        await new Promise((done) => real(done, 0));
    }
    [globalThis.setTimeout, globalThis.clearTimeout] = [real, realClear];
    return {asked, heard}; }"""


@pytest.mark.parametrize(
    ("steps", "asked", "heard"),
    [
        ([["want", "a"], ["answer", 0, 1]], ["a"], [["took", 1, "a"]]),
        # Of those that wait only the newest is asked.
        (
            [["want", "a"], ["want", "b"], ["want", "c"], ["answer", 0, 1], ["answer", 1, 2]],
            ["a", "c"],
            [["took", 1, "a"], ["took", 2, "c"]],
        ),
        # What is cancelled is not heard of, and does not keep the next one waiting.
        (
            [["want", "a"], ["cancel"], ["want", "b"], ["answer", 0, 1], ["answer", 1, 2]],
            ["a", "b"],
            [["took", 2, "b"]],
        ),
        ([["want", "a"], ["cancel"], ["gone", 0]], ["a"], []),
        ([["want", "a"], ["refuse", 0]], ["a"], [["refused", "a"]]),
        # Nobody answers: again after a second, two, … and at once when the server is back.
        (
            [["want", "a"], ["gone", 0], ["wait"], ["gone", 1], ["wait"], ["answer", 2, 3]],
            ["a", "a", "a"],
            [["missed", "a"], ["after", 1000], ["missed", "a"], ["after", 2000], ["took", 3, "a"]],
        ),
        # So is what the server could not answer just then; what it fails at it would fail at again.
        (
            [["want", "a"], ["refuse", 0, 503], ["wait"], ["answer", 1, 3]],
            ["a", "a"],
            [["missed", "a"], ["after", 1000], ["took", 3, "a"]],
        ),
        *(([["want", "a"], ["refuse", 0, status]], ["a"], [["refused", "a"]]) for status in (404, 409, 500, 502)),
        # The pause grows no longer once there was an answer, whichever, or something else is asked.
        (
            [
                ["want", "a"],
                ["gone", 0],
                ["wait"],
                ["gone", 1],
                ["wait"],
                ["refuse", 2],
                ["want", "b"],
                ["gone", 3],
                ["wait"],
                ["answer", 4, 5],
            ],
            ["a", "a", "a", "b", "b"],
            [
                ["missed", "a"],
                ["after", 1000],
                ["missed", "a"],
                ["after", 2000],
                ["refused", "a"],
                ["missed", "b"],
                ["after", 1000],
                ["took", 5, "b"],
            ],
        ),
        (
            [["want", "a"], ["gone", 0], ["cancel"], ["want", "b"], ["gone", 1], ["wait"], ["answer", 2, 5]],
            ["a", "b", "b"],
            [["missed", "a"], ["missed", "b"], ["after", 1000], ["took", 5, "b"]],
        ),
        ([["want", "a"], ["gone", 0], ["again"], ["answer", 1, 3]], ["a", "a"], [["missed", "a"], ["took", 3, "a"]]),
        ([["want", "a"], ["answer", 0, 1], ["again"]], ["a"], [["took", 1, "a"]]),
    ],
)
def test_questions_are_cancelled_and_asked_again(
    modules: Modules, steps: list[list[object]], asked: list[str], heard: list[list[object]]
) -> None:
    assert modules.evaluate(QUESTION, steps) == {"asked": asked, "heard": heard}


def test_what_the_server_can_not_just_now_is_said_until_it_is_asked_again(modules: Modules) -> None:
    script = """async (message) => { const {laterText, whyLater} = await import('/app/effects/question.js');
        const {Refusal, ServerGone} = await import('/server/api.js');
        return [new Refusal(503, [{message}]), new ServerGone('no')].map((one) => [laterText(one), whyLater(one)]); }"""
    overloaded = "Too many large bodies are sent or planned at the same time. Ask again later."
    assert modules.evaluate(script, overloaded) == [
        [f"{overloaded} The page asks again by itself.", [{"message": overloaded}]],
        ["The server does not answer. It is asked again until it does.", []],
    ]


def test_rows_are_checked_again_when_nobody_answered_and_remarks_are_of_one_axis(modules: Modules) -> None:
    script = """async (design) => { const {createChecks} = await import('/panels/table/checks.js');
        const {ServerGone} = await import('/server/api.js');
        const seen = [];
        let calls = 0, hear = () => {};
        const checks = createChecks(async () => {
            if ((calls += 1) === 1) throw new ServerGone('gone');
            return {findings: [{row: 0, reason: 'too slow', wrong: true}]};
        }, () => { seen.push([...checks.found()].map(([row, {text}]) => [row, text])); hear(); });
        const tabled = (rows) => ({...design, table: {rows, interval_unit: 'us'}});
        checks.check(tabled([[5, 900]]), 5);
        await new Promise((done) => { hear = () => seen.at(-1).length > 0 && done(); });
        checks.check(tabled([[5, 900]]), 7);
        checks.check(tabled([[7, 800]]), 8);
        const remarked = seen.find((rows) => rows.length > 0), last = seen.at(-1);
        checks.check({...design, table: null}, 8);
        return [calls, remarked, last]; }"""
    assert modules.evaluate(script, document()) == [2, [[0, "Too slow"]], []]


@pytest.mark.parametrize(
    ("then", "remarked"),
    [
        ([[5, 900], [9, 20], [20, 300]], [1]),
        # A row was deleted, typed over or put in before.
        ([[9, 20], [20, 300]], []),
        ([[5, 900], [9, 30], [20, 300]], []),
        ([[2, 990], [5, 900], [9, 20], [20, 300]], []),
        ([[5, 900], [9, 20], [30, 300]], [1]),
    ],
)
@pytest.mark.parametrize("is_answered", [False, True])
def test_a_remark_is_of_the_rows_that_were_asked_about(
    modules: Modules, then: list[list[int]], remarked: list[int], is_answered: bool
) -> None:
    script = """async ([design, then, isAnswered]) => {
        const {createChecks} = await import('/panels/table/checks.js');
        const real = {setTimeout, clearTimeout}, seen = [];
        let answer, ask;
        globalThis.setTimeout = (act) => { ask = act; return 0; };
        globalThis.clearTimeout = () => {};
        const settled = async () => { for (let turn = 0; turn < 20; turn += 1) await null; };
        const checks = createChecks(() => new Promise((resolve) => { answer ??= resolve; }),
            () => seen.push([...checks.found().keys()]));
        const check = (rows) => checks.check({...design, table: {rows, interval_unit: 'us'}}, 5);
        const findings = [{row: 1, reason: 'too quick', wrong: true}];
        const heard = async () => { answer({findings}); await settled(); };
        check([[5, 900], [9, 20], [20, 300]]); ask();
        if (isAnswered) await heard();
        check(then);
        if (!isAnswered) await heard();
        Object.assign(globalThis, real);
        return seen.at(-1); }"""
    assert modules.evaluate(script, [document(), then, is_answered]) == remarked


def test_remarks_go_while_nobody_answers(modules: Modules) -> None:
    script = """async (design) => { const {createChecks} = await import('/panels/table/checks.js');
        const {ServerGone} = await import('/server/api.js');
        const real = {setTimeout, clearTimeout};
        let ask, calls = 0;
        globalThis.setTimeout = (act) => { ask = act; return 0; };
        globalThis.clearTimeout = () => {};
        const settled = async () => { for (let turn = 0; turn < 20; turn += 1) await null; };
        const checks = createChecks(async () => { if ((calls += 1) === 2) throw new ServerGone('gone');
            return {findings: [{row: 0, reason: 'too quick', wrong: true}]}; }, () => {});
        const check = (delay) => checks.check({...design, table: {rows: [[5, 900], [9, delay]],
            interval_unit: 'us'}}, 5);
        const seen = [];
        for (const delay of [20, 30]) { check(delay); ask(); await settled(); seen.push(checks.found().size); }
        Object.assign(globalThis, real);
        return seen; }"""
    assert modules.evaluate(script, document()) == [1, 0]


def test_an_answer_is_not_heard_while_a_newer_question_waits(modules: Modules) -> None:
    script = """async () => { const {createQuestion} = await import('/app/effects/question.js');
        const {Refusal, ServerGone} = await import('/server/api.js');
        const [ends, heard] = [[], []];
        const question = createQuestion({ask: () => new Promise((done, fail) => ends.push({done, fail})),
            take: (_, one) => heard.push(one), refuse: (_, one) => heard.push(one), miss: (one) => heard.push(one),
            isOnlyNewest: true});
        const settled = () => new Promise((done) => setTimeout(done, 0));
        question.want('a'); question.want('b'); ends[0].done(); await settled();
        question.want('c'); ends[1].fail(new Refusal(422, [])); await settled();
        question.want('d'); ends[2].fail(new ServerGone('gone')); await settled();
        ends[3].done(); await settled();
        return heard; }"""
    assert modules.evaluate(script) == ["d"]


def test_what_waits_stands_its_time_also_behind_another(modules: Modules) -> None:
    """A design that is still being changed is not asked about, however soon the one before is answered."""
    script = """async () => { const {createQuestion} = await import('/app/effects/question.js');
        const [real, timers, asked, ends] = [globalThis.setTimeout, [], [], []];
        globalThis.setTimeout = (act) => timers.push(act);
        const question = createQuestion({
            ask: (one) => { asked.push(one); return new Promise((done) => ends.push(done)); },
            take: () => {}, refuse: () => {}, afterMs: 250});
        const settled = () => new Promise((done) => real(done, 0));
        question.want('a'); timers[0](); await settled();
        question.want('b'); ends[0](); await settled();
        const before = [...asked];
        timers[1](); await settled();
        globalThis.setTimeout = real;
        return [before, asked]; }"""
    assert modules.evaluate(script) == [["a"], ["a", "b"]]


def test_an_answer_that_can_not_be_taken_keeps_no_other_waiting(modules: Modules) -> None:
    script = """async () => { const {createQuestion} = await import('/app/effects/question.js');
        const [asked, failed, ends] = [[], [], []];
        const hear = (error) => failed.push(error.message);
        const usual = process.listeners('unhandledRejection');
        process.removeAllListeners('unhandledRejection').on('unhandledRejection', hear);
        const question = createQuestion({
            ask: (one) => { asked.push(one); return new Promise((done) => ends.push(done)); },
            take: () => { throw new Error('broken'); }, refuse: () => {}});
        const settled = () => new Promise((done) => setTimeout(done, 0));
        question.want('a'); question.want('b'); ends[0](); await settled();
        process.off('unhandledRejection', hear);
        for (const one of usual) process.on('unhandledRejection', one);
        return [asked, failed]; }"""
    assert modules.evaluate(script) == [["a", "b"], ["broken"]]


def test_a_cancelled_question_leaves_its_place_to_the_next(modules: Modules) -> None:
    """Only four requests go at a time: what nobody wants an answer to any more must not keep a device's waiting."""
    script = """async () => { const {createQuestion} = await import('/app/effects/question.js');
        const {api} = await import('/server/api.js');
        const {calculate, NO_DETAILS} = await import('/server/calculation.js');
        const own = [globalThis.fetch, globalThis.document], asked = [], ended = [];
        globalThis.document = {baseURI: 'http://127.0.0.1/'};
        globalThis.fetch = (url, {signal}) => { asked.push(url.pathname.split('/').at(-1));
            return new Promise((resolve, reject) => { if (String(url).endsWith('/ports'))
                resolve({ok: true, json: async () => 'ports'});
            const end = () => { ended.push(asked.length); reject(new Error('aborted')); };
            if (signal.aborted) end(); else signal.addEventListener('abort', end); }); };
        const design = {move: {steps: 9}, method: {name: 'exact'}};
        const ways = [(_, on) => calculate(design, ['exact'], NO_DETAILS, on), (_, on) => api.schedule([], '', 9, on),
            (_, end) => api.preview('1', {}, end)];
        const heard = [];
        for (const ask of ways) {
            const question = createQuestion({ask, take: () => heard.push('took'), refuse: () => heard.push('refused'),
                miss: () => heard.push('missed')});
            for (let one = 0; one < 3; one += 1) { question.want(one); question.cancel(); }
        }
        const ports = await Promise.race([api.ports(), new Promise((done) => setTimeout(() => done('in line'), 500))]);
        [globalThis.fetch, globalThis.document] = own;
        return [ports, heard, ended.length === asked.length - 1]; }"""
    assert modules.evaluate(script) == ["ports", [], True]


def test_one_listener_that_fails_keeps_no_other_from_hearing(modules: Modules) -> None:
    script = """async () => { const {createStore, FIRST_STATE, whenChanged} = await import('/app/state.js');
        const {setTheme, selectRow} = await import('/app/commands/view.js');
        const [failed, heard] = [[], []];
        const {dispatch, subscribe} = createStore(FIRST_STATE, (error) => failed.push(error.message));
        subscribe(() => { throw new Error('broken'); });
        subscribe(whenChanged(({theme}) => [theme], (theme) => { if (theme === 'light') dispatch(selectRow, 4); }));
        subscribe(({theme, row}) => heard.push([theme, row]));
        dispatch(setTheme, 'light'); dispatch(setTheme, 'light');
        return [failed, heard.at(-1), heard.length]; }"""
    failed, last, count = modules.evaluate(script)
    assert failed == ["broken"]
    assert (last, count) == (["light", 4], 2)


def test_a_listener_that_fails_at_every_state_is_told_of_once_a_change(modules: Modules) -> None:
    script = """async () => { const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {tell} = await import('/app/commands/told.js');
        const {selectRow} = await import('/app/commands/view.js');
        let failures = 0;
        const store = createStore(FIRST_STATE, ({message}) => {
            if ((failures += 1) > 100) throw new Error('without end');
            store.dispatch(tell, message, true); });
        store.subscribe(() => { throw new Error('broken'); });
        const rows = [];
        store.subscribe(({row}) => rows.push(row));
        store.dispatch(selectRow, 4); store.dispatch(selectRow, 5);
        return [failures, rows, store.state().told.notice.text]; }"""
    assert modules.evaluate(script) == [2, [4, 4, 5, 5], "broken"]


SOCKET = """async () => { const sent = [];
    globalThis.WebSocket = class { static OPEN = 1; readyState = 1; constructor() { globalThis.made = this; }
        send(text) { sent.push(JSON.parse(text)); } close() { this.onclose(); } };
    const {createConversation} = await import('/server/conversation.js');
    const {ask} = createConversation(() => new URL('ws://127.0.0.1/'), 60000);
    const answers = ['a', 'b', 'c'].map((name) => ask({name}));
    const tell = (told) => globalThis.made.onmessage({data: JSON.stringify(told)});
    tell({id: 2, is: 'b'}); tell({id: 9, is: 'nobody’s'}); tell({id: 1, is: 'a'});
    globalThis.made.close();
    const heard = await Promise.all(answers);
    delete globalThis.WebSocket;
    return {sent, heard}; }"""


def test_answers_over_a_socket_find_their_questions_by_id(modules: Modules) -> None:
    assert modules.evaluate(SOCKET) == {
        "sent": [{"name": "a", "id": 1}, {"name": "b", "id": 2}, {"name": "c", "id": 3}],
        "heard": [{"id": 1, "is": "a"}, {"id": 2, "is": "b"}, None],
    }
