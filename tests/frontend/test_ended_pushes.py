"""What becomes known of a push on whose way a STOP came."""

import pytest

from frontend.modules import Modules
from frontend.state import DEVICE

# A page whose push of a device is ended by a STOP is told of the device at some moments [ms], and waits a second after
# the last. Returns the notices after each of them.
FOLLOWED = """async ([before, told]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {watchEndedPushes} = await import('/app/effects/ended_pushes.js');
    const real = {setTimeout: globalThis.setTimeout, performance: globalThis.performance};
    let now = 0;
    const waiting = [];
    globalThis.setTimeout = (act, ms) => waiting.push([now + ms, act]);
    Object.defineProperty(globalThis, 'performance', {value: {now: () => now}, configurable: true, writable: true});
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    store.dispatch(COMMANDS.device.heard, [before], {});
    const pushes = watchEndedPushes(store);
    pushes.await(before);
    const notices = [];
    const note = () => { const text = store.state().told.notice?.text ?? null;
        if (notices.at(-1) !== text) notices.push(text); };
    for (const [at, device] of [...told, [null, null]]) {
        const until = at ?? now + 1000;
        for (const [due, act] of waiting.splice(0)) {
            if (due <= until) { now = due; act(); note(); } else waiting.push([due, act]);
        }
        now = until;
        if (device) store.dispatch(COMMANDS.device.heard, [device], {});
        note();
    }
    for (const name of Object.keys(real))
        Object.defineProperty(globalThis, name, {value: real[name], configurable: true, writable: true});
    return notices; }"""
BEFORE = {**DEVICE, "pushed": None, "progress": None, "ramp": None}
STOPPED = {**BEFORE, "stops": 1}
WRITING = {**STOPPED, "state": "writing"}
RAMP = {"sequence": 3, "crc": 9}
REPORT = {"items": [], "verified": True, "bytes": 25}
DONE = "STOP came too late for the push, which went on to its end: all is written, and read back as sent."
DIFFERS = "STOP came too late for the push, which went on to its end: what was read back is not what was sent."
NONE = "STOP ended the push before anything was written: the controller has what it had."
OPEN = (
    "STOP ended the push while it was being written, before it was read back: what a push would change shows what the "
    "controller has."
)


@pytest.mark.parametrize(
    ("before", "told", "notices"),
    [
        # Its report comes a moment after it rests, or long after the STOP.
        (BEFORE, [(10, WRITING), (5000, STOPPED), (5100, {**STOPPED, "pushed": REPORT})], [None, DONE]),
        (BEFORE, [(10, WRITING), (20, {**STOPPED, "pushed": {**REPORT, "verified": False}})], [None, DIFFERS]),
        # That of an earlier push is none of this one.
        ({**BEFORE, "pushed": REPORT}, [(10, {**STOPPED, "pushed": REPORT})], [None, NONE]),
        (BEFORE, [(10, STOPPED)], [None, NONE]),
        # It was about to be written when the STOP came, and has the ramp that it had.
        (
            {**BEFORE, "ramp": RAMP},
            [(10, {**WRITING, "ramp": RAMP}), (20, {**STOPPED, "ramp": RAMP})],
            [None, NONE],
        ),
        # What it has was written in part, maybe.
        (BEFORE, [(10, WRITING), (20, STOPPED)], [None, OPEN]),
        # Nobody has heard of the STOP yet, or the push is planned still.
        (BEFORE, [(10, {**BEFORE, "heard_s": 2}), (3000, {**BEFORE, "heard_s": 3})], [None]),
        (BEFORE, [(10, {**STOPPED, "progress": {"stage": "planning"}})], [None]),
        # A loss has words of its own.
        (BEFORE, [(10, WRITING), (20, {**STOPPED, "state": "lost"}), (30, STOPPED)], [None]),
    ],
)
def test_what_became_of_a_push_that_a_stop_ended_is_told_once_it_is_known(
    modules: Modules, before: dict[str, object], told: list[tuple[int, dict[str, object]]], notices: list[str | None]
) -> None:
    assert modules.evaluate(FOLLOWED, [before, told]) == notices
