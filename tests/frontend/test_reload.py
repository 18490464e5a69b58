"""The controller and the axis in view, over a reload of the page."""

import pytest

from frontend.modules import Modules
from frontend.state import DEVICE

# A page with some devices, on which a port and an axis are chosen, is loaded anew, twice: at the second time others are
# told. Returns the device, port and axis in view, and the notice.
RELOADED = """async ([before, after]) => {
    const {rememberedState, saveByItself} = await import('/app/effects/autosave.js');
    const {createStore} = await import('/app/state.js');
    const {COMMANDS: {device}} = await import('/app/commands/commands.js');
    const {deviceOf, deviceAxisOf, portOf} = await import('/app/devices.js');
    const kept = new Map(), leaving = [];
    const ports = [{port: 'a', name: 'A'}, {port: 'b', name: 'B'}];
    const storage = {getItem: (key) => kept.get(key) ?? null, setItem: (key, text) => kept.set(key, text),
        removeItem: (key) => kept.delete(key), key: () => null, length: 0};
    for (const name of ['localStorage', 'sessionStorage'])
        Object.defineProperty(globalThis, name, {value: storage, configurable: true, writable: true});
    globalThis.addEventListener = (what, act) => leaving.push(act);
    globalThis.document = {addEventListener() {}};
    const page = () => { const begun = rememberedState({id: 't', record: null}, 9);
        const store = createStore(begun, (error) => { throw error; });
        saveByItself(store, 't');
        return store; };
    const seen = (state) => [deviceOf(state)?.id ?? null, portOf(state), deviceAxisOf(state),
        state.told.notice?.text ?? null];
    const [list, port, axis] = before;
    const first = page();
    first.dispatch(device.heard, list, {});
    if (port !== null) first.dispatch(device.choosePort, port);
    first.dispatch(device.chooseAxis, axis);
    leaving.forEach((leave) => leave());
    const second = page();
    // Left again before anything was told.
    second.dispatch(device.portsCame, {ports, families: []});
    leaving.forEach((leave) => leave());
    const third = page();
    third.dispatch(device.heard, after, {});
    third.dispatch(device.portsCame, {ports, families: []});
    const told = seen(third.state());
    leaving.forEach((leave) => leave());
    for (const name of ['localStorage', 'sessionStorage', 'addEventListener', 'document']) delete globalThis[name];
    return told; }"""
A = {**DEVICE, "id": "1", "port": "a", "name": "A", "axes": [{"state": "ready"}] * 3}
B = {**A, "id": "2", "port": "b", "name": "B"}
B_GONE = "The controller that was in view, at b, is not connected any more: A, axis 0, is in view now."


@pytest.mark.parametrize(
    ("before", "after_it", "seen"),
    [
        (([A, B], "b", 2), [A, B], ["2", "b", 2, None]),
        (([A], None, 2), [A], ["1", "a", 2, None]),
        # Another was connected meanwhile, and is told first.
        (([A], None, 2), [B, A], ["1", "a", 2, None]),
        # It was connected anew.
        (([A, B], "b", 2), [A, {**B, "id": "7"}], ["7", "b", 2, None]),
        # It is gone, and another is in view, or none.
        (([A, B], "b", 2), [A], ["1", "a", 0, B_GONE]),
        (([A, B], "b", 2), [A, {**B, "port": "c"}], ["1", "a", 0, B_GONE]),
        (([A, B], "b", 2), [], [None, "b", 0, None]),
        # None was connected at the port that was chosen.
        (([A], "b", 0), [A], [None, "b", 0, None]),
        (([], None, 0), [A], ["1", "a", 0, None]),
    ],
)
def test_the_controller_and_the_axis_in_view_stay_so_over_a_reload(
    modules: Modules, before: tuple[list[object], str | None, int], after_it: list[object], seen: list[object]
) -> None:
    assert modules.evaluate(RELOADED, [before, after_it]) == seen
