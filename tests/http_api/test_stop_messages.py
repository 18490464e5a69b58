"""STOP over the WebSocket of events, and jogs that a stop has overtaken."""

from __future__ import annotations

import asyncio
import itertools
import json
import time
import weakref
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient
from starlette.types import Message, Receive, Scope

from designs import document
from event_loop import run, with_lifespan
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.registry import Devices
from stepramp.http_api.app import create_app
from stepramp.http_api.stop_messages import MOST_AT_A_TIME, PendingAnswer, answered
from stepramp.link import protocol_sim

DEVICES = "/api/v1/devices"
LOCAL = {"host": "127.0.0.1:8000"}
SCOPE: Scope = {
    "type": "websocket", "path": f"{DEVICES}/events", "raw_path": b"", "query_string": b"", "scheme": "ws",
    "headers": [(b"host", b"127.0.0.1:8000")], "root_path": "", "server": None, "subprotocols": [], "state": {},
}  # fmt: skip
PATIENCE_S = 15.0
FAR = 1_000_000
_numbers = itertools.count()


def until(condition: Callable[[], Any]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def connected(client: TestClient) -> str:
    """Return the id of a device that takes a second to slow down."""
    port = f"sim://stop-messages-{next(_numbers)}"
    protocol_sim.register(port, VirtualController())
    device_id: str = client.post(DEVICES, json={"port": port}).json()["id"]
    design = document(ramp__acceleration_steps_per_s2=1000)
    assert client.post(f"{DEVICES}/{device_id}/push", json={"design": design}).status_code == 200
    return device_id


@pytest.fixture
def device_id(client: TestClient) -> str:
    return connected(client)


@pytest.fixture
def events(client: TestClient) -> Iterator[Any]:
    with client.websocket_connect(f"{DEVICES}/events?page=one", headers=LOCAL) as socket:
        yield socket


def answer(events: Any) -> Any:
    """Return the next message that is an answer, no event."""
    while "did" not in (told := events.receive_json()) and "errors" not in told:
        pass
    return told


def device_of(client: TestClient, device_id: str) -> Any:
    return client.get(f"{DEVICES}/{device_id}").json()


def moving_fast(client: TestClient, *ids: str) -> None:
    for each in ids:
        assert client.post(f"{DEVICES}/{each}/move", json={"by_steps": FAR}).status_code == 200
    until(lambda: all(device_of(client, each)["speed_steps_per_s"] > 600 for each in ids))


@pytest.mark.parametrize("message", ['{"do": "stop"}', '{"do": "halt", "device": "%s"}'])
@pytest.mark.parametrize("end", [PendingAnswer.made, PendingAnswer.give_up])
def test_nothing_moves_between_a_stop_and_the_writing_of_its_answer(
    client: TestClient, device_id: str, message: str, end: Callable[[PendingAnswer], object]
) -> None:
    """Nor for ever: an answer that nobody reads is given up."""
    devices: Devices = client.app.state.devices
    answer = run(answered(message.replace("%s", device_id), devices))
    move = {"by_steps": 3}
    assert client.post(f"{DEVICES}/{device_id}/move", json=move).status_code == 409
    end(answer)
    assert client.post(f"{DEVICES}/{device_id}/move", json=move).status_code == 200


def test_a_stop_is_for_all_devices_and_answered_with_what_they_do(
    client: TestClient, device_id: str, events: Any
) -> None:
    ids = [device_id, connected(client)]
    moving_fast(client, *ids)
    before = {each: device_of(client, each)["stops"] for each in ids}
    events.send_json({"do": "stop", "number": 7})
    told = answer(events)
    assert told["did"] == {"do": "stop", "device": None, "number": 7}
    assert {each["id"]: each["state"] for each in told["devices"]} == dict.fromkeys(ids, "stopping")
    assert all(each["stops"] > before[each["id"]] for each in told["devices"])
    for each in ids:
        until(lambda each=each: device_of(client, each)["state"] == "ready")
        assert 0 < device_of(client, each)["position_steps"] < FAR


def test_a_stop_is_final(client: TestClient, device_id: str, events: Any) -> None:
    known = device_of(client, device_id)["stops"]
    events.send_json({"do": "stop"})
    newer = answer(events)["devices"][0]["stops"]
    move = {"by_steps": 10}
    late = client.post(f"{DEVICES}/{device_id}/move", json=move, headers={"X-StepRamp-Stops": str(known)})
    assert late.status_code == 409
    assert "A stop came first" in late.json()["errors"][0]["message"]
    anew = client.post(f"{DEVICES}/{device_id}/move", json=move, headers={"X-StepRamp-Stops": str(newer)})
    assert anew.status_code == 200


def test_a_halt_is_for_one_device(client: TestClient, device_id: str, events: Any) -> None:
    other = connected(client)
    moving_fast(client, device_id, other)
    events.send_json({"do": "halt", "device": device_id})
    told = answer(events)
    assert told["did"] == {"do": "halt", "device": device_id, "number": None}
    states = {each["id"]: each["state"] for each in told["devices"]}
    assert states == {device_id: "ready", other: "moving"}
    client.post(f"{DEVICES}/stop")


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ("stop", "a JSON object such as"),
        ('{"do": "fly"}', "stop, halt"),
        ('{"do": "halt", "device": "99"}', "There is no device '99'."),
        ('[["do", "stop"]]', "an object with named fields"),
        ('{"say": {"do": "stop"}}', "there is no such field"),
    ],
)
def test_what_is_no_stop_is_refused_and_the_socket_goes_on(
    client: TestClient, device_id: str, events: Any, message: str, words: str
) -> None:
    events.send_text(message)
    assert words in answer(events)["errors"][0]["message"]
    moving_fast(client, device_id)
    events.send_json({"do": "stop"})
    assert answer(events)["devices"][0]["state"] == "stopping"


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ('{"do": "stop", "device": "1"}', "a stop over this WebSocket is for all devices"),
        ('{"do": "stop", "device": 1}', "device is 1; allowed: a text"),
        ('{"do": "stop", "x": 1, "number": "7"}', "there is no such field"),
        ('{"do": "stop", "do": "halt"}', "one value, given once"),
        ('{"do": "halt", "device": "1", "do": "stop"}', "one value, given once"),
        ('{"do": "halt"}', "the id of the device that is to halt"),
        ('{"do": "halt", "device": 7}', "device is 7; allowed: a text"),
    ],
)
def test_a_stop_is_obeyed_whatever_else_its_message_says(
    client: TestClient, device_id: str, events: Any, message: str, words: str
) -> None:
    """What can't be used of it is told with what was done."""
    moving_fast(client, device_id)
    events.send_text(message)
    told = answer(events)
    assert told["did"] == {"do": "stop", "device": None, "number": None}
    assert any(words in each["message"] for each in told["errors"])
    assert [each["state"] for each in told["devices"]] == ["stopping"]


def test_a_halt_is_obeyed_whatever_else_its_message_says(client: TestClient, device_id: str, events: Any) -> None:
    other = connected(client)
    moving_fast(client, device_id, other)
    events.send_json({"do": "halt", "device": device_id, "x": 1})
    told = answer(events)
    assert told["did"] == {"do": "halt", "device": device_id, "number": None}
    assert "there is no such field" in told["errors"][0]["message"]
    assert {each["id"]: each["state"] for each in told["devices"]} == {device_id: "ready", other: "moving"}
    client.post(f"{DEVICES}/stop")


def test_a_jog_that_was_decided_before_a_stop_does_not_begin(client: TestClient, device_id: str) -> None:
    known = device_of(client, device_id)["stops"]
    newer = client.post(f"{DEVICES}/stop").json()["devices"][0]["stops"]
    with client.websocket_connect(f"{DEVICES}/{device_id}/jog", headers=LOCAL) as socket:
        socket.send_json({"do": "run", "speed_steps_per_s": 400, "stops": known})
        assert "A stop came first" in socket.receive_json()["errors"][0]["message"]
        assert device_of(client, device_id)["state"] == "ready"
        socket.send_json({"do": "run", "speed_steps_per_s": 400, "stops": newer})
        until(lambda: device_of(client, device_id)["position_steps"] > 0)


class Text(str):
    """A text of which can be told whether it is still kept."""

    __slots__ = ("__weakref__",)


def saying(texts: Iterable[str], last: Message | None = None) -> Receive:
    """Return what receives texts over a WebSocket, and then the end or nothing more."""
    messages: Iterator[Message] = iter([{"type": "websocket.connect"}])
    said = itertools.chain(messages, ({"type": "websocket.receive", "text": text} for text in texts), [last])

    async def receive() -> Message:
        return next(said) or await asyncio.Event().wait()  # type: ignore[return-value]

    return receive


async def stopped(devices: Devices, since: int) -> None:
    async with asyncio.timeout(PATIENCE_S):
        while devices.views()[0].stops == since:
            await asyncio.sleep(0.01)


async def connected_in(devices: Devices) -> int:
    """Connect a device, and return of which of its stops is known."""
    port = f"sim://stop-messages-{next(_numbers)}"
    protocol_sim.register(port, VirtualController())
    return (await asyncio.to_thread(devices.connect, port)).view.stops


def test_a_stop_is_obeyed_whose_client_goes_at_once() -> None:
    """Also before the socket's messages are looked at."""

    async def send(message: Message) -> None:
        if message["type"] != "websocket.accept":
            raise OSError("Nobody is there any more.")

    async def work() -> None:
        before = await connected_in(app.state.devices)
        gone: Message = {"type": "websocket.disconnect", "code": 1006}
        await app(SCOPE, saying([json.dumps({"do": "stop"})], gone), send)
        await stopped(app.state.devices, before)

    app = create_app()
    run(with_lifespan(app, work))


def test_a_client_that_reads_no_answers_is_heard_and_piles_up_nothing() -> None:
    """Of each thousand odd messages no more are kept than are seen to at a time, nor answers to them."""
    kept: weakref.WeakSet[Text] = weakref.WeakSet()
    most = 0

    def odd() -> Iterator[str]:
        nonlocal most
        for number in range(1000):
            most = max(most, len(kept))
            kept.add(text := Text(f"odd {number}"))
            yield text
        yield json.dumps({"do": "stop"})

    async def send(message: Message) -> None:
        if message["type"] != "websocket.accept":
            await asyncio.Event().wait()

    async def work() -> None:
        before = await connected_in(app.state.devices)
        socket = asyncio.create_task(app(SCOPE, saying(odd()), send))
        await stopped(app.state.devices, before)
        socket.cancel()
        assert most <= 3 * MOST_AT_A_TIME

    app = create_app()
    run(with_lifespan(app, work))
