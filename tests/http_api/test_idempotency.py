"""Requests that are asked again with the same key: done once, and answered the same."""

from __future__ import annotations

import asyncio
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from starlette.responses import JSONResponse
from starlette.testclient import TestClient
from starlette.types import Message, Receive, Scope, Send

from designs import document
from event_loop import run
from stepramp.http_api import client_limits, door
from stepramp.http_api.access import CLIENT, Access, Client, Role
from stepramp.http_api.app import create_app
from stepramp.http_api.idempotency import (
    KEPT_S,
    MOST_ANSWER_BYTES,
    MOST_KEPT,
    MOST_LEFT,
    MOST_TOGETHER_BYTES,
    Idempotent,
)
from stepramp.http_api.key_ages import KeyAges
from stepramp.http_api.request_numbers import RequestNumbering, number_of
from waiting import until

MOVE = "/api/v1/devices/1/move"


class Mistake(Exception):
    pass


class Served:
    """An application that counts what it does, and waits before it answers where it is told to."""

    def __init__(self) -> None:
        self.done: list[bytes] = []
        self.status = 200
        self.now_s = 0.0
        self.may_end: asyncio.Event | None = None
        self.begun = asyncio.Event()
        self.fails = False
        self.numbers = count(1)
        self.asked_at: list[int] = []
        self.idempotent = Idempotent(self._serve, lambda: self.now_s)
        self.ages = KeyAges(self.idempotent, lambda: self.now_s)
        self.app = RequestNumbering(self.ages, lambda: next(self.numbers))
        self.more: dict[str, str] = {}

    async def _serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        body, more = b"", True
        while more:
            message = await receive()
            if message["type"] == "http.disconnect":
                return
            body += message["body"]
            more = message.get("more_body", False)
        self.done.append(body)
        self.asked_at.append(number_of(scope))
        self.begun.set()
        if self.may_end is not None:
            await self.may_end.wait()
        if self.fails:
            raise Mistake
        await JSONResponse({"number": len(self.done)} | self.more, self.status)(scope, receive, send)

    async def ask(
        self,
        key: str | None = "k",
        body: bytes = b"{}",
        path: str = MOVE,
        method: str = "POST",
        client: Client | None = None,
    ) -> tuple[int, bytes, dict[str, str]]:
        headers = [] if key is None else [(b"idempotency-key", key.encode())]
        scope = {"type": "http", "method": method, "path": path, "raw_path": path.encode(), "query_string": b""}
        scope[CLIENT] = client
        chunks = iter([body])
        sent: list[Message] = []

        async def receive() -> Message:
            chunk = next(chunks, None)
            if chunk is None:
                await asyncio.Event().wait()
            return {"type": "http.request", "body": chunk, "more_body": False}

        async def send(message: Message) -> None:
            sent.append(message)

        await self.app(scope | {"headers": headers}, receive, send)
        told = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
        return sent[0]["status"], b"".join(each["body"] for each in sent[1:]), told


def test_asked_again_it_is_answered_the_same_and_done_once() -> None:
    async def work() -> None:
        served = Served()
        first, again, other, without = (
            await served.ask(),
            await served.ask(),
            await served.ask("other"),
            await served.ask(None),
        )
        assert first[:2] == again[:2] == (200, b'{"number":1}')
        assert "idempotent-replayed" not in first[2]
        assert again[2]["idempotent-replayed"] == "true"
        assert (other[1], without[1]) == (b'{"number":2}', b'{"number":3}')

    run(work())


def test_what_is_asked_again_meanwhile_waits_for_the_first() -> None:
    async def work() -> None:
        served = Served()
        served.may_end = asyncio.Event()
        asking = [asyncio.ensure_future(served.ask()) for _ in range(3)]
        await served.begun.wait()
        await asyncio.sleep(0)
        assert not any(each.done() for each in asking)
        served.may_end.set()
        assert {(await each)[1] for each in asking} == {b'{"number":1}'}
        assert len(served.done) == 1

    run(work())


def test_it_is_done_though_its_client_leaves_and_told_to_who_asks_again() -> None:
    async def work() -> None:
        served = Served()
        served.may_end = asyncio.Event()
        leaving = asyncio.ensure_future(served.ask())
        await served.begun.wait()
        leaving.cancel()
        with pytest.raises(asyncio.CancelledError):
            await leaving
        again = asyncio.ensure_future(served.ask())
        served.may_end.set()
        assert (await again)[1] == b'{"number":1}'
        assert len(served.done) == 1

    run(work())


def test_of_those_whose_clients_have_gone_so_many_go_on_at_most() -> None:
    async def work() -> None:
        served = Served()
        served.may_end = asyncio.Event()
        leaving = [asyncio.ensure_future(served.ask(f"k{at}")) for at in range(MOST_LEFT)]
        while len(served.done) < MOST_LEFT:
            await asyncio.sleep(0)
        for each in leaving:
            each.cancel()
        await asyncio.wait(leaving)
        status, body, _ = await served.ask("other")
        assert (status, b"whose clients have gone" in body) == (503, True)
        again = asyncio.ensure_future(served.ask("k0"))
        served.may_end.set()
        assert (await again)[0] == 200
        assert (await served.ask("other"))[0] == 200

    run(work())


def test_a_client_that_leaves_in_the_midst_of_its_body_keeps_no_key() -> None:
    async def work() -> None:
        served = Served()

        async def never() -> Message:
            return await asyncio.Event().wait()  # type: ignore[func-returns-value]

        scope = {"type": "http", "method": "POST", "path": MOVE, "raw_path": b"/", "query_string": b""}
        headers = [(b"idempotency-key", b"k")]
        leaving = asyncio.ensure_future(served.app(scope | {"headers": headers}, never, never))  # type: ignore[arg-type]
        await asyncio.sleep(0.01)
        leaving.cancel()
        await asyncio.wait([leaving])
        assert served.done == []
        # The next one isn't kept waiting; that nothing was done isn't known, so it is said so.
        assert (await asyncio.wait_for(served.ask("other"), 10))[0] == 200

    run(work())


@pytest.mark.parametrize("status", [400, 409, 422, 429, 503])
def test_what_was_refused_may_be_asked_again(status: int) -> None:
    async def work() -> None:
        served = Served()
        served.status = status
        assert (await served.ask())[0] == status
        served.status = 200
        assert (await served.ask())[:2] == (200, b'{"number":2}')
        assert (await served.ask())[:2] == (200, b'{"number":2}')

    run(work())


def test_what_came_of_it_isn_t_known_after_a_mistake_and_is_told_of_a_lost_device() -> None:
    async def work() -> None:
        served = Served()
        served.fails = True
        with pytest.raises(Mistake):
            await served.ask()
        served.fails, served.status = False, 502
        status, body, _ = await served.ask()
        assert (status, len(served.done)) == (409, 1)
        assert b"what came of it can't be told again" in body
        assert (await served.ask("lost"))[0] == (await served.ask("lost"))[0] == 502
        assert len(served.done) == 2

    run(work())


@pytest.mark.parametrize(
    ("change", "done"), [({"body": b'{"by_steps":2}'}, 1), ({"path": f"{MOVE}x"}, 1), ({"method": "PUT"}, 1)]
)
def test_a_key_stands_for_one_request(change: dict[str, Any], done: int) -> None:
    async def work() -> None:
        served = Served()
        await served.ask()
        status, body, _ = await served.ask(**change)
        assert (status, len(served.done)) == (422, done)
        assert b"Idempotency-Key" in body
        assert b"a key of its own for each request" in body

    run(work())


@pytest.mark.parametrize("key", ["", "two words", "x" * 201, "\u00e9"])
def test_odd_keys_are_refused(key: str) -> None:
    async def work() -> None:
        served = Served()
        status, body, _ = await served.ask(key)
        assert (status, served.done) == (422, [])
        assert b"1 to 200 visible ASCII characters" in body

    run(work())


@pytest.mark.parametrize("path", ["/api/v1/devices/1/stop", "/api/v1/devices/stop", "/api/v1/devices/1/halt"])
def test_each_stop_is_a_stop(path: str) -> None:
    async def work() -> None:
        served = Served()
        for _ in range(2):
            assert (await served.ask(path=path))[0] == 200
        assert len(served.done) == 2

    run(work())


def test_the_newest_answers_are_kept_for_a_day() -> None:
    async def work() -> None:
        served = Served()
        for number in range(MOST_KEPT + 1):
            await served.ask(f"{number}")
        await served.ask("1")
        assert len(served.done) == MOST_KEPT + 1
        await served.ask("0")
        assert len(served.done) == MOST_KEPT + 2
        served.now_s = KEPT_S + 1
        await served.ask("0")
        assert len(served.done) == MOST_KEPT + 3

    run(work())


def test_a_client_with_many_keys_pushes_out_only_its_own() -> None:
    async def work() -> None:
        served = Served()
        me, other = Client("here", Role.OPERATE), Client("there", Role.OPERATE)
        await served.ask("mine", client=me)
        for number in range(MOST_KEPT + 1):
            await served.ask(f"{number}", client=other)
        await served.ask("mine", client=me)
        assert len(served.done) == MOST_KEPT + 2
        assert sum(map(len, served.ages._given.values())) == MOST_KEPT + 1
        served.now_s = KEPT_S + 1
        await served.ask("mine", client=me)
        assert sum(map(len, served.ages._given.values())) == 1

    run(work())


def test_a_key_is_of_who_has_the_same_token_or_session_wherever_they_are() -> None:
    async def work() -> None:
        served = Served()
        for place in ("here", "there"):
            for session in ("", "one", "two"):
                await served.ask(client=Client(place, Role.OPERATE, session))
        assert len(served.done) == 3
        await served.ask()
        assert len(served.done) == 4

    run(work())


def test_what_is_under_way_keeps_no_others_from_being_forgotten() -> None:
    async def work() -> None:
        served = Served()
        served.may_end = asyncio.Event()
        under_way = asyncio.ensure_future(served.ask("long"))
        await served.begun.wait()
        may_end, served.may_end = served.may_end, None
        for number in range(MOST_KEPT + 10):
            await served.ask(f"{number}")
        assert sum(map(len, served.idempotent._asked.values())) == MOST_KEPT + 1
        again = asyncio.ensure_future(served.ask("long"))
        may_end.set()
        assert (await again)[1] == (await under_way)[1]
        assert len(served.done) == MOST_KEPT + 11

    run(work())


def test_of_answers_that_are_too_long_together_the_oldest_are_lost_but_not_that_they_were_done() -> None:
    async def work() -> None:
        served = Served()
        served.more = {"more": "x" * (MOST_ANSWER_BYTES - 100)}
        most = MOST_TOGETHER_BYTES // MOST_ANSWER_BYTES
        for number in range(most + 2):
            await served.ask(f"{number}")
        status, body, _ = await served.ask("0")
        assert (status, b"asked for before with the same key, and done" in body) == (409, True)
        assert (await served.ask(f"{most + 1}"))[0] == 200
        assert len(served.done) == most + 2
        assert served.idempotent._answers_bytes <= MOST_TOGETHER_BYTES
        served.now_s = KEPT_S + 1
        served.more = {}
        await served.ask("0")
        assert served.idempotent._answers_bytes < 100

    run(work())


@pytest.mark.parametrize("status", [409, 422, 503])
def test_what_was_refused_is_as_old_as_it_was_at_first_when_it_is_asked_again(status: int) -> None:
    async def work() -> None:
        served = Served()
        served.status = status
        await served.ask()
        await served.ask("other")
        await served.ask()
        served.status = 200
        assert (await served.ask())[0] == 200
        assert served.asked_at == [1, 2, 1, 1]

    run(work())


@pytest.mark.parametrize(
    ("limits", "most", "status"), [(client_limits, "MOST_AT_ONCE", 429), (door, "MOST_SERVED", 503)]
)
def test_refused_before_it_was_looked_at_it_is_as_old_when_it_is_asked_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, limits: ModuleType, most: str, status: int
) -> None:
    access = Access({Role.VIEW: "v" * 20, Role.OPERATE: "o" * 20})
    headers = {"authorization": f"Bearer {'o' * 20}"}
    with TestClient(create_app(data=tmp_path, access=access), base_url="http://bench:8000", headers=headers) as client:
        path = f"/api/v1/devices/{client.post('/api/v1/devices', json={'port': 'sim://'}).json()['id']}"
        assert client.post(f"{path}/push", json={"design": document()}).status_code == 200

        def move() -> int:
            return client.post(f"{path}/move", json={"by_steps": 10}, headers={"Idempotency-Key": "k"}).status_code

        monkeypatch.setattr(limits, most, 0)
        assert move() == status
        monkeypatch.undo()
        assert client.post(f"{path}/stop").status_code == 200
        told: list[int] = []
        until(lambda: told.append(move()) or told[-1] != status)
        assert told[-1] == 409
        [device] = client.app.state.devices.views()
        assert device.axes[0].position_steps == 0


def test_asked_again_after_a_stop_nothing_moves(client: TestClient) -> None:
    path = f"/api/v1/devices/{client.post('/api/v1/devices', json={'port': 'sim://'}).json()['id']}"
    stops = str(client.get(path).json()["stops"])
    assert client.post(f"{path}/push", json={"design": document()}).status_code == 200
    assert client.post(f"{path}/stop").status_code == 200
    headers = {"Idempotency-Key": "k", "X-StepRamp-Stops": stops}
    refused = client.post(f"{path}/move", json={"by_steps": 100}, headers=headers)
    for again in ({"Idempotency-Key": "k"}, headers | {"X-StepRamp-Stops": str(client.get(path).json()["stops"])}):
        told = client.post(f"{path}/move", json={"by_steps": 100}, headers=again)
        assert (told.status_code, told.json()) == (refused.status_code, refused.json())
    assert "A stop came first" in refused.json()["errors"][0]["message"]
    # Refused for another reason before the stop, it was asked before it all the same.
    early = {"Idempotency-Key": "early"}
    assert client.post(f"{path}/move", json={"by_steps": 100, "axis": 7}, headers=early).status_code == 422
    assert client.post(f"{path}/stop").status_code == 200
    assert client.post(f"{path}/move", json={"by_steps": 100}, headers=early).status_code == 409
    assert client.get(path).json()["position_steps"] == 0


def test_a_move_is_made_once(client: TestClient) -> None:
    device = client.post("/api/v1/devices", json={"port": "sim://"}).json()["id"]
    path, ramp = f"/api/v1/devices/{device}", document(ramp__slew_speed_steps_per_s=2000)
    keys = map(str, count())
    pushed = client.post(f"{path}/push", json={"design": ramp}, headers={"Idempotency-Key": next(keys)})
    assert pushed.status_code == 200, pushed.text
    key = {"Idempotency-Key": next(keys)}
    for _ in range(3):
        assert client.post(f"{path}/move", json={"by_steps": 100}, headers=key).status_code == 200
    until(lambda: client.get(path).json()["state"] == "ready")
    assert client.get(path).json()["position_steps"] == 100
    refused = client.post(f"{path}/move", json={"by_steps": 101}, headers=key)
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "Idempotency-Key")
