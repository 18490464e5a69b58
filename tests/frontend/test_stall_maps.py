"""Stall maps: jobs of the server that are asked about until they end, one at a time, and kept over a reload."""

from typing import Any

from designs import document
from frontend.modules import Modules

RESULT = {
    "over_values": [1, 2],
    "over_spacing": "ratios",
    "accelerations_steps_per_s2": [1, 2],
    "verdicts": [[0, 0], [0, 2]],
}
MAPS = """async ([design, kept, steps, keptOf]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {begin} = await import('/app/commands/work.js');
    const {createStallMaps} = await import('/app/effects/stall_maps.js');
    const {keptMaps} = await import('/documents/stall_maps.js');
    const {Refusal, ServerGone, Ended} = await import('/server/api.js');
    const store = new Map(kept ? [['stepramp.stall_maps', JSON.stringify({tab: 't', maps: kept, ...keptOf})]] : []);
    const [getItem, setItem] = [(key) => store.get(key) ?? null, (key, text) => store.set(key, text)];
    globalThis.sessionStorage = {getItem, setItem};
    const [asked, waiting, seen] = [[], [], []];
    const real = globalThis.setTimeout;
    const settle = () => new Promise((done) => real(done, 0));
    globalThis.setTimeout = (act, ms) => { seen.push(ms); act(); };
    const answer = (what) => (...args) => {
        const ended = args.find((one) => one instanceof AbortSignal);
        asked.push([what, ...args.filter((one) => typeof one === 'string')]);
        return new Promise((resolve, reject) => {
            waiting.push({resolve, reject});
            ended?.addEventListener('abort', () => reject(new Ended('ended')));
        });
    };
    const first = {...FIRST_STATE, firstId: 7, stallMaps: keptMaps('t')};
    const page = createStore(first, (error) => seen.push(String(error)));
    page.dispatch(begin, {axes: [design], together: 'independent'});
    const {computeMap, cancelMap} = createStallMaps(page, 't',
        {beginMap: answer('begin'), job: answer('job'), cancelJob: answer('cancel')});
    await settle();
    for (const [what, ...values] of steps) {
        if (what === 'compute') computeMap(values[0]);
        if (what === 'cancel') cancelMap(7, values[0]);
        if (what === 'answer') waiting.at(-1).resolve(values[0]);
        if (what === 'gone') waiting.at(-1).reject(new ServerGone('gone'));
        if (what === 'refuse') waiting.at(-1).reject(new Refusal(values[0] ?? 422, [{message: 'No.'}]));
        await settle(); await settle();
    }
    globalThis.setTimeout = real;
    const {stallMaps} = page.state();
    return {asked, seen, maps: stallMaps, kept: JSON.parse(store.get('stepramp.stall_maps') ?? 'null')?.maps}; }"""


def played(modules: Modules, *steps: list[object], kept: object = None, tab: str = "t") -> dict[str, Any]:
    found: dict[str, Any] = modules.evaluate(MAPS, [document(), kept, list(steps), {"tab": tab}])
    return found


def job(state: str, progress: float, result: object = None) -> dict[str, object]:
    return {"id": "j1", "kind": "motor_map", "state": state, "progress": progress, "result": result}


def test_a_map_is_asked_about_until_it_is_done_and_is_kept(modules: Modules) -> None:
    found = played(
        modules, ["compute", "load"], ["answer", {"id": "j1"}], ["answer", job("waiting", 0)],
        ["answer", job("running", 0.5, RESULT)], ["gone"], ["answer", job("done", 1, RESULT)],
    )  # fmt: skip
    assert found["asked"] == [["begin", "load"], *[["job", "j1"]] * 4]
    assert found["seen"] == [250, 250, 2000]
    shown = found["maps"]["7 load"]
    assert (shown["stage"], shown["progress"]) == ("done", 1)
    assert [picture["result"] for picture in shown["pictures"]] == [RESULT]
    assert found["kept"] == found["maps"]
    # Over a reload it is there, and nothing is asked; what is no map is not.
    again = played(modules, kept={**found["kept"], "8 load": {"key": 1}})
    assert (again["asked"], again["maps"]) == ([], found["maps"])


def test_what_ran_when_the_page_was_left_goes_on(modules: Modules) -> None:
    running = {
        "key": "k", "over": "load", "id": "j1", "stage": "running", "progress": 0.2, "pictures": [], "rejections": [],
    }  # fmt: skip
    found = played(modules, ["answer", job("done", 1, RESULT)], kept={"7 load": running})
    assert found["asked"] == [["job", "j1"]]
    assert found["maps"]["7 load"]["stage"] == "done"
    assert found["maps"]["7 load"]["pictures"] == [{"key": "k", "result": RESULT}]
    # Of one whose job was never told nothing more comes.
    found = played(modules, kept={"7 load": {**running, "id": None}})
    assert (found["asked"], found["maps"]["7 load"]["stage"]) == ([], "cancelled")
    # That of the tab which this one is a duplicate of is left to it.
    found = played(modules, kept={"7 load": running}, tab="other")
    assert (found["asked"], found["maps"]["7 load"]["stage"]) == ([], "cancelled")


def test_a_cancelled_map_ends_its_job_and_keeps_what_is_known(modules: Modules) -> None:
    begun = ["compute", "load"], ["answer", {"id": "j1"}], ["answer", job("running", 0.5, RESULT)]
    found = played(modules, *begun, ["cancel", "load"])
    assert found["asked"][-1] == ["cancel", "j1"]
    assert found["maps"]["7 load"]["stage"] == "cancelled"
    assert [picture["result"] for picture in found["maps"]["7 load"]["pictures"]] == [RESULT]
    # One at a time: the next one ends the last.
    found = played(modules, *begun, ["compute", "slew_speed"])
    assert ["cancel", "j1"] in found["asked"]
    assert {key: one["stage"] for key, one in found["maps"].items()} == {
        "7 load": "cancelled",
        "7 slew_speed": "running",
    }


def test_a_refused_map_says_why(modules: Modules) -> None:
    found = played(modules, ["compute", "load"], ["refuse"])
    assert found["maps"]["7 load"]["stage"] == "failed"
    assert [one["message"] for one in found["maps"]["7 load"]["rejections"]] == ["No."]


def test_a_map_that_the_server_can_not_begin_just_now_says_so_and_is_asked_for_again(modules: Modules) -> None:
    begun = ["compute", "load"], ["refuse", 503]
    found = played(modules, *begun)
    assert found["asked"] == [["begin", "load"]] * 2
    waits = found["maps"]["7 load"]
    assert (waits["stage"], waits["waitsFor"]) == ("running", "No. The page asks again by itself.")
    assert played(modules, *begun, ["answer", {"id": "j1"}])["maps"]["7 load"]["waitsFor"] == ""
    gone = played(modules, ["compute", "load"], ["gone"])["maps"]["7 load"]
    assert gone["waitsFor"] == "The server does not answer. It is asked again until it does."


INTERLEAVED = """async (documents) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {begin} = await import('/app/commands/work.js');
    const {createStallMaps} = await import('/app/effects/stall_maps.js');
    const {mapKey, pictureOf} = await import('/model/stall_map.js');
    const {designOf} = await import('/app/selectors.js');
    const {ServerGone, Ended} = await import('/server/api.js');
    globalThis.sessionStorage = {getItem: () => null, setItem: () => {}};
    const [a, b] = documents;
    const real = globalThis.setTimeout;
    let timers = [];
    globalThis.setTimeout = (act) => { timers.push(act); };
    const settle = async () => { for (let turn = 0; turn < 12; turn += 1) await null; };
    const faults = [];
    const values = {over_values: [1, 2], over_spacing: 'ratios', accelerations_steps_per_s2: [1, 2]};
    const tag = (of) => ({...values, verdicts: [[0, 0], [0, 2]], of});

    async function play(steps) {
        let [jobs, waiting] = [[], []];
        timers = [];
        const page = createStore({...FIRST_STATE, firstId: 7}, (error) => faults.push([steps, String(error)]));
        const hear = (what, give, ended) => new Promise((resolve, reject) => {
            const call = {what, answer: () => resolve(give()), gone: () => reject(new ServerGone('gone'))};
            waiting.push(call);
            ended?.addEventListener('abort', () => {
                waiting = waiting.filter((one) => one !== call);
                reject(new Ended('ended'));
            });
        });
        const ask = {
            beginMap(design, over, ended) {
                const job = {id: String(jobs.length), of: design.name, state: 'running'};
                jobs.push(job);
                return hear(job, () => ({id: job.id}), ended);
            },
            job: (id, ended) => hear('job', () => ({...jobs[id], progress: .5, result: tag(jobs[id].of)}), ended),
            cancelJob(id) {
                if (jobs[id].state === 'running') jobs[id].state = 'cancelled';
                return hear('cancel', () => jobs[id]);
            },
        };
        const take = (design) => page.dispatch(begin, {axes: [design], together: 'independent'});
        take(a);
        const {computeMap, cancelMap} = createStallMaps(page, 't', ask);
        const acts = {
            a: () => { take(a); computeMap('load'); },
            b: () => { take(b); computeMap('load'); },
            undo: () => take(designOf(page.state()).name === a.name ? b : a),
            other: () => computeMap('slew_speed'),
            cancel: () => cancelMap(7, 'load'),
            answer: () => waiting.shift()?.answer(),
            gone: () => {
                const call = waiting.shift();
                // A job that nobody was told of ends by itself.
                if (call?.what.id !== undefined) call.what.state = 'forgotten';
                call?.gone();
            },
            done: () => { for (const job of jobs) if (job.state === 'running') job.state = 'done'; },
        };
        async function step(act) {
            act();
            await settle();
            const now = page.state();
            for (const map of Object.values(now.stallMaps)) {
                const design = designOf(now);
                const {result, isOld} = pictureOf(map, mapKey(design, map.over));
                if (result && !isOld && result.of !== design.name) faults.push([steps, 'shown as of another design']);
                const of = map.id === null ? null : documents.find(({name}) => name === jobs[map.id].of);
                if (of && mapKey(of, map.over) !== map.key) faults.push([steps, 'the job of another design']);
            }
        }
        for (const name of steps) await step(acts[name]);
        for (let turn = 0; turn < 12; turn += 1) {
            await step(acts.answer);
            for (const act of timers.splice(0)) act();
        }
        await settle();
        const wanted = Object.values(page.state().stallMaps).filter(({stage}) => stage === 'running').map(({id}) => id);
        const running = jobs.filter(({state}) => state === 'running').map(({id}) => id);
        if (running.join() !== wanted.join()) faults.push([steps, running, wanted]);
        return Object.keys(acts);
    }
    const names = await play([]);
    const longer = (before) => names.map((name) => [...before, name]);
    const sequences = (length) => (length === 0 ? [[]] : sequences(length - 1).flatMap(longer));
    let count = 0;
    for (const steps of sequences(4)) {
        // Begun at once, or after an answer: what follows comes at every moment of a job's life.
        for (const first of [['a'], ['a', 'answer', 'answer']]) {
            await play([...first, ...steps]);
            count += 1;
        }
    }
    globalThis.setTimeout = real;
    return {count, faults: faults.slice(0, 5)}; }"""


def test_however_it_goes_no_job_runs_unwanted_and_no_map_is_shown_as_of_another_design(modules: Modules) -> None:
    """Every sequence of four of: asked, asked for another design, undone, cancelled, answered, lost, done."""
    found = modules.evaluate(INTERLEAVED, [document(name="a"), document(name="b", move__steps=77)])
    assert found["faults"] == []
    assert found["count"] == 2 * 8**4


def test_what_is_undone_has_its_own_map_back(modules: Modules) -> None:
    script = """async (result) => {
        const {FIRST_STATE} = await import('/app/state.js');
        const {stallMapCame} = await import('/app/commands/answers.js');
        const {pictureOf} = await import('/model/stall_map.js');
        let state = FIRST_STATE;
        for (const key of ['a', 'b', 'b', 'c', 'd', 'e']) {
            const begun = {key, over: 'load', id: null, stage: 'running', progress: 0, rejections: []};
            state = stallMapCame(state, 7, 'load', begun);
            state = stallMapCame(state, 7, 'load', {stage: 'done', result: {...result, key}});
        }
        const map = state.stallMaps['7 load'];
        const shown = ['a', 'b', 'e'].map((key) => pictureOf(map, key));
        return shown.map(({result, isOld}) => [result.key, isOld]);
    }"""
    # The first was forgotten: the newest is shown, as of another design.
    assert modules.evaluate(script, RESULT) == [["e", True], ["b", False], ["e", False]]
