"""STOP over HTTP: obeyed whatever its body, final for what was asked before."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from event_loop import run
from http_api.two_axes import DEVICES, LOCAL, error_of, port_of
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, StopRequest
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.http_api.app import create_app
from waiting import until

STOPS = "X-StepRamp-Stops"
MOTIONS: list[tuple[str, dict[str, object]]] = [
    ("move", {"by_steps": 10}),
    ("run", {"speed_steps_per_s": 100}),
    ("line", {"axes": [{"axis": 0, "by_steps": 10}]}),
    ("there_and_back", {"by_steps": 10}),
    ("zero", {"steps": 10}),
    ("home", {"axes": [{"axis": 0, "fast_steps_per_s": -100}], "slow_steps_per_s": 50}),
]


def test_what_knows_of_fewer_stops_moves_nothing(client: TestClient, route: str) -> None:
    known = {STOPS: str(client.get(route).json()["stops"])}
    assert client.post(f"{route}/move", json={"by_steps": 1}, headers=known).status_code == 200
    stopped = client.post(f"{route}/stop").json()["stops"]
    assert stopped > int(known[STOPS])
    for what, body in MOTIONS:
        late = client.post(f"{route}/{what}", json=body, headers=known)
        assert "A stop came first" in error_of(late, 409)["message"], what
    until(lambda: client.get(route).json()["state"] == "ready")
    newest = {STOPS: str(client.get(route).json()["stops"])}
    assert client.post(f"{route}/move", json={"by_steps": 1}, headers=newest).status_code == 200


@pytest.mark.parametrize("header", [STOPS, "X-StepRamp-Page"])
def test_a_header_that_is_given_twice_moves_nothing(client: TestClient, route: str, header: str) -> None:
    """Which of them is meant, nobody knows."""
    told = str(client.get(route).json()["stops"])
    for what, body in MOTIONS:
        twice = client.post(f"{route}/{what}", json=body, headers=[(header, told), (header, told)])
        error = error_of(twice, 422)
        assert (error["field"], error["allowed"]) == (header, "one value, given once"), what
        assert error["value"] == [told, told]
    assert client.get(route).json()["state"] == "ready"


def test_what_an_earlier_server_told_moves_nothing(client: TestClient, route: str) -> None:
    """Nor what no server told: it would outlive every stop."""
    told = client.get(route).json()["stops"]
    earlier = 100_000_000_000_000  # Microseconds since 1970 in 1973: before any server was started.
    assert earlier < told < 2**53
    late = client.post(f"{route}/move", json={"by_steps": 10}, headers={STOPS: str(earlier)})
    assert "A stop came first" in error_of(late, 409)["message"]
    with TestClient(create_app(), base_url="http://127.0.0.1:8000") as later:
        port = port_of(VirtualController())
        later_route = f"{DEVICES}/{later.post(DEVICES, json={'port': port}).json()['id']}"
        later.post(f"{later_route}/push", json={"design": document()})
        late = later.post(f"{later_route}/move", json={"by_steps": 10}, headers={STOPS: str(told)})
        assert "A stop came first" in error_of(late, 409)["message"]
        assert later.get(later_route).json()["position_steps"] == 0
    # Requests are numbered, too: their numbers are none that anybody was told.
    for untold in (told + 1, told + 2, told + 3_600_000_000, 10**17):
        refused = client.post(f"{route}/move", json={"by_steps": 10}, headers={STOPS: str(untold)})
        error = error_of(refused, 422)
        assert (error["field"], error["value"]) == (STOPS, untold)
        with client.websocket_connect(f"{route}/jog", headers=LOCAL) as socket:
            socket.send_json({"do": "run", "speed_steps_per_s": 400, "stops": min(untold, 2**53)})
            [error] = socket.receive_json()["errors"]
            assert error["field"] == "stops"
    assert client.get(route).json()["position_steps"] == 0


def test_every_stop_counts(client: TestClient, route: str) -> None:
    counts = [client.get(route).json()["stops"]]
    for stop in (f"{route}/stop", f"{route}/halt", f"{DEVICES}/stop"):
        client.post(stop)
        counts.append(client.get(route).json()["stops"])
    assert sorted(set(counts)) == counts


BODIES: list[tuple[bytes, str | None]] = [
    (b"", None),
    (b"{", "application/json"),
    (b'{"axes": [7]}', "application/json"),
    (b'{"axes": "all"}', "application/json"),
    (b'{"axis": 1}', "application/json"),
    (b"[]", "application/json"),
    (b"now!", "text/plain"),
    (b'{"axes": [0]}', None),
    (b"\xff\xfe\x00", "application/octet-stream"),
    (b"[" * 900, "application/json"),
    (b'{"axes": [0], "why": "' + b"x" * 100_000 + b'"}', "application/json"),
]


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_stop_is_obeyed_whatever_its_body(client: TestClient, route: str, stop: str) -> None:
    for body, kind in BODIES:
        assert client.post(f"{route}/move", json={"by_steps": 100_000}).json()["state"] == "moving"
        headers = {} if kind is None else {"content-type": kind}
        stopped = client.post(f"{route}/{stop}", content=body, headers=headers)
        assert stopped.status_code == 200, body[:50]
        assert stopped.json()["axes"][0]["state"] in ("stopping", "ready")
        until(lambda: client.get(route).json()["state"] == "ready")


def test_a_stop_names_axes(client: TestClient, route: str) -> None:
    moves = {"axes": [{"axis": 0, "by_steps": 50_000}, {"axis": 1, "by_steps": 50_000}]}
    client.post(f"{route}/move", json=moves)
    states = [axis["state"] for axis in client.post(f"{route}/stop", json={"axes": [1]}).json()["axes"]]
    assert states[0] == "moving"
    assert states[1] in ("stopping", "ready")
    client.post(f"{route}/halt")


class Asgi:
    """Requests straight to the application, whose bodies come when they are told to."""

    def __init__(self) -> None:
        self.app = create_app()

    async def ask(
        self,
        method: str,
        path: str,
        body: object = None,
        held: asyncio.Event | None = None,
        *,
        gone: bool = False,
        page: str | None = None,
    ) -> Any:
        """Return status and content of an answer; held: the body comes only after that; gone: it never comes."""
        sent: list[dict[str, Any]] = []
        data = b"" if body is None else json.dumps(body).encode()

        async def receive() -> dict[str, Any]:
            if held is not None:
                await held.wait()
            if gone:
                return {"type": "http.disconnect"}
            return {"type": "http.request", "body": data, "more_body": False}

        async def send(message: Any) -> None:
            sent.append(message)

        headers = [(b"host", b"127.0.0.1:8000"), (b"content-type", b"application/json")]
        headers += [] if page is None else [(b"x-stepramp-page", page.encode())]
        scope = {"type": "http", "method": method, "path": path, "raw_path": path.encode(), "query_string": b""}
        scope |= {"headers": headers, "http_version": "1.1", "scheme": "http", "root_path": "", "asgi": {}}
        await self.app(scope, receive, send)
        content = b"".join(message.get("body", b"") for message in sent)
        return sent[0]["status"], json.loads(content)


def in_an_app(script: Callable[[Asgi], Any]) -> None:
    async def work() -> None:
        asgi = Asgi()
        async with asgi.app.router.lifespan_context(asgi.app):
            await script(asgi)

    run(work())


@pytest.mark.parametrize("stop", ["/stop", "/halt", None], ids=str)
def test_a_move_whose_body_comes_after_a_stop_does_not_begin(stop: str | None) -> None:
    async def script(asgi: Asgi) -> None:
        route = await connected(asgi)
        held = asyncio.Event()
        moving = asyncio.create_task(asgi.ask("POST", f"{route}/move", {"by_steps": 500}, held))
        await asyncio.sleep(0)  # It has arrived, and waits for its body.
        status, _ = await asgi.ask("POST", f"{DEVICES}/stop" if stop is None else route + stop)
        assert status == 200
        held.set()
        status, answer = await moving
        assert (status, answer["errors"][0]["message"][:18]) == (409, "A stop came first:")
        assert (await asgi.ask("GET", route))[1]["position_steps"] == 0
        assert (await asgi.ask("POST", f"{route}/move", {"by_steps": 5}))[0] == 200

    in_an_app(script)


def test_a_stop_waits_for_its_body_only_so_long() -> None:
    async def script(asgi: Asgi) -> None:
        route = await connected(asgi)
        await asgi.ask("POST", f"{route}/move", {"by_steps": 50_000})
        never = asyncio.Event()
        status, stopped = await asgi.ask("POST", f"{route}/stop", {"axes": [1]}, never)
        assert (status, stopped["axes"][0]["state"] != "moving") == (200, True)

    in_an_app(script)


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_stop_whose_client_goes_in_the_midst_of_its_body_is_obeyed(stop: str) -> None:
    async def script(asgi: Asgi) -> None:
        route = await connected(asgi)
        await asgi.ask("POST", f"{route}/run", {"speed_steps_per_s": 300, "for_s": 60})
        await asgi.ask("POST", f"{route}/{stop}", gone=True)
        assert (await asgi.ask("GET", route))[1]["axes"][0]["state"] != "moving"

    in_an_app(script)


def test_a_page_that_is_gone_before_its_run_has_come_in_runs_nothing() -> None:
    async def script(asgi: Asgi) -> None:
        route = await connected(asgi)
        status, answer = await asgi.ask(
            "POST", f"{route}/run", {"speed_steps_per_s": 300, "for_s": 3600}, page="it has closed"
        )
        assert (status, "its page is gone" in answer["errors"][0]["message"]) == (409, True)
        assert (await asgi.ask("GET", route))[1]["state"] == "ready"

    in_an_app(script)


async def connected(asgi: Asgi) -> str:
    port = port_of(VirtualController())
    _, device = await asgi.ask("POST", DEVICES, {"port": port})
    route = f"{DEVICES}/{device['id']}"
    status, _ = await asgi.ask("POST", f"{route}/push", {"axes": [document(), document()]})
    assert status == 200
    return route


class Recording(VirtualController):
    """Remembers what it was asked."""

    def __init__(self) -> None:
        super().__init__()
        self.kinds: list[int] = []

    def _answer(self, request: Any) -> Any:
        self.kinds.append(request.kind)
        return super()._answer(request)


def test_a_move_asked_for_while_a_stop_is_being_answered_does_not_begin(client: TestClient) -> None:
    port = port_of(board := Recording())
    route = f"{DEVICES}/{client.post(DEVICES, json={'port': port}).json()['id']}"
    client.post(f"{route}/push", json={"design": document()})
    device = client.app.state.devices.get(route.rsplit("/", 1)[1])
    with device.being_stopped():
        late = client.post(f"{route}/move", json={"by_steps": 10})
        assert "A stop came first" in error_of(late, 409)["message"]
    assert MoveByRequest.KIND not in board.kinds
    assert client.post(f"{route}/move", json={"by_steps": 10}).status_code == 200


def test_an_axis_that_is_not_there_is_named_in_its_field(client: TestClient, route: str) -> None:
    for what, body, field in [
        ("there_and_back", {"axis": 3, "by_steps": 10}, "axis"),
        ("run", {"axes": [{"axis": 3, "speed_steps_per_s": 10}]}, "axes.0.axis"),
        ("zero", {"axes": [3], "steps": 10}, "axes"),
        ("line", {"axes": [{"axis": 0, "by_steps": 5}], "ramp_axis": 3}, "ramp_axis"),
        ("position", {"axes": [{"axis": 3, "position_steps": 1}]}, "axes.0.axis"),
    ]:
        error = error_of(client.post(f"{route}/{what}", json=body), 422)
        assert (error["field"], error["value"]) == (field, 3), what
    error = error_of(client.put(f"{route}/trace", json={"traced_axis": 3}), 422)
    assert (error["field"], error["value"]) == ("traced_axis", 3)
    with client.websocket_connect(f"{route}/jog", headers=LOCAL) as socket:
        socket.send_json({"do": "run", "axis": 3, "speed_steps_per_s": 100})
        assert socket.receive_json()["errors"][0]["field"] == "axis"


def test_what_was_asked_before_there_was_the_device_does_not_move_it(client: TestClient) -> None:
    early = client.app.state.devices.order.next()
    client.post(f"{DEVICES}/stop")
    port = port_of(VirtualController())
    later = f"{DEVICES}/{client.post(DEVICES, json={'port': port}).json()['id']}"
    client.post(f"{later}/push", json={"design": document()})
    late = client.post(f"{later}/move", json={"by_steps": 5}, headers={STOPS: str(early)})
    assert "A stop came first" in error_of(late, 409)["message"]


def test_a_stop_is_not_asked_of_the_controller_twice(client: TestClient) -> None:
    port = port_of(board := Recording())
    route = f"{DEVICES}/{client.post(DEVICES, json={'port': port}).json()['id']}"
    client.post(f"{route}/stop")
    assert board.kinds.count(StopRequest.KIND) == 1


@pytest.mark.parametrize("stops", ["-1", "+5", "1_000", "many", "1.0", "", "9" * 30])
def test_a_number_of_stops_that_is_none(client: TestClient, route: str, stops: str) -> None:
    error = error_of(client.post(f"{route}/move", json={"by_steps": 1}, headers={STOPS: stops}), 422)
    assert (error["field"], error["value"]) == (STOPS, stops)
    assert error["allowed"] == "a whole number: the `stops` that the device last told"


def test_a_stop_ends_a_jog_s_socket_for_good(client: TestClient, route: str) -> None:
    with client.websocket_connect(f"{route}/jog", headers=LOCAL) as socket:
        client.post(f"{route}/stop")
        socket.send_json({"do": "run", "speed_steps_per_s": 400})
        assert "A stop came first" in socket.receive_json()["errors"][0]["message"]
    with client.websocket_connect(f"{route}/jog", headers=LOCAL) as socket:
        socket.send_json({"do": "run", "speed_steps_per_s": 400})
        until(lambda: client.get(route).json()["axes"][0]["position_steps"] > 0)


def test_a_page_that_was_taken_over_jogs_no_more(client: TestClient, route: str) -> None:
    pages = [client.websocket_connect(f"{DEVICES}/events?page={page}", headers=LOCAL) for page in ("one", "two")]
    with pages[0] as one, pages[1] as two, client.websocket_connect(f"{route}/jog?page=one", headers=LOCAL) as socket:
        one.receive_json(), two.receive_json()
        assert client.post(f"{route}/control", headers={"X-StepRamp-Page": "two"}).status_code == 200
        socket.send_json({"do": "run", "speed_steps_per_s": 400})
        assert "Another page is in control" in socket.receive_json()["errors"][0]["message"]
