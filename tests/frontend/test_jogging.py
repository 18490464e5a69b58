"""A jog: how it ends, and what is said of that."""

from typing import Any

import pytest

from frontend.modules import Modules

JOG = """async (event) => {
    const own = {WebSocket: globalThis.WebSocket, addEventListener: globalThis.addEventListener,
        document: globalThis.document};
    const made = [];
    globalThis.WebSocket = class { static OPEN = 1; readyState = 0; sent = []; constructor() { made.push(this); }
        send(text) { this.sent.push(text); } close() { this.closed = true; } };
    globalThis.addEventListener = () => {};
    globalThis.document = {baseURI: 'http://127.0.0.1/', hidden: false, addEventListener() {}};
    const {createJog} = await import('/devices/jogging.js');
    const heard = [];
    const jog = createJog({begin: () => ({stops: 3})}, (told) => heard.push(told.map(({message}) => message)));
    jog.begin({id: '1'}, 0, 5);
    const [socket] = made;
    if (event.ends) jog.end();
    if (event.told) socket.onmessage({data: JSON.stringify({errors: [{message: event.told}]})});
    socket.onclose({code: event.code, reason: event.reason ?? ''});
    Object.assign(globalThis, own);
    return [heard, jog.isHeld()]; }"""


@pytest.mark.parametrize(
    ("event", "told"),
    [
        ({"code": 1006}, ["The jog has ended: the connection was closed."]),
        ({"code": 1011, "reason": "a mistake"}, ["The jog has ended: the connection was closed (a mistake)."]),
        ({"code": 1000}, None),
        ({"code": 1006, "ends": True}, None),
        ({"code": 1011, "told": "Axis 0 is at its limit."}, ["Axis 0 is at its limit."]),
    ],
)
def test_a_jog_that_ends_by_itself_says_why(modules: Modules, event: dict[str, Any], told: list[str] | None) -> None:
    heard, is_held = modules.evaluate(JOG, event)
    assert heard == ([[]] if told is None else [[], told])
    assert not is_held
