"""Large answers: in pieces, byte for byte what they are in one."""

import asyncio
import json
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.testclient import TestClient
from starlette.types import Message

from designs import document
from event_loop import run
from stepramp.errors import Rejected, Rejection
from stepramp.http_api import planned
from stepramp.http_api.formats import Format
from stepramp.http_api.json_response import SLICE, json_pieces
from stepramp.http_api.lanes import Lane
from stepramp.http_api.planned import MOST_AHEAD, Planned

PATIENCE_S = 10.0
LONGEST_PIECE_BYTES = 300_000
SIZES = st.sampled_from([0, 1, SLICE - 1, SLICE, SLICE + 1, 2 * SLICE, 5 * SLICE + 7])


def array(size: int) -> np.ndarray:
    values = np.random.default_rng(size).normal(size=size) * 1e6
    values[::1000] = np.nan
    return values


ARRAYS = SIZES.map(array) | SIZES.map(np.arange) | SIZES.map(lambda size: array(size).astype("f4"))
CONTENTS = st.recursive(
    ARRAYS | st.none() | st.integers(-5, 5) | st.text(max_size=5) | SIZES.map(lambda size: list(range(size))),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=6,
)


@given(CONTENTS)
def test_pieces_are_the_whole(content: Any) -> None:
    pieces = list(json_pieces(content))
    assert b"".join(pieces) == orjson.dumps(content, option=orjson.OPT_SERIALIZE_NUMPY)
    assert max(map(len, pieces)) < LONGEST_PIECE_BYTES


def test_a_long_profile_is_every_step(client: TestClient) -> None:
    steps = 300_000
    answer = client.post("/api/v1/profile", json={"design": document(move__steps=steps)})
    assert "content-length" not in answer.headers
    profile = answer.json()
    ramp = np.floor(2e6 / np.sqrt(2 * 5000 * np.arange(1, 101)) + 0.5).astype(int)
    intervals = np.concatenate((ramp, np.full(steps - 200, 2000), ramp[::-1]))
    assert profile["intervals_ticks"] == intervals.tolist()
    assert profile["step"] == profile["position_steps"] == list(range(1, steps + 1))
    assert profile["summary"]["steps"] == steps


def test_a_short_answer_says_its_length(client: TestClient) -> None:
    answer = client.post("/api/v1/profile", json={"design": document()})
    assert answer.headers["content-length"] == str(len(answer.content))


def test_a_socket_refuses_what_is_too_long_for_one_message(client: TestClient) -> None:
    long = document(move__steps=2_000_000, ramp__acceleration_steps_per_s2=0.5)
    body = {"design": long, "methods": ["exact", "newton"], "max_points": 100_000}
    with client.websocket_connect("/api/v1/curves/socket", headers={"host": "127.0.0.1:8000"}) as socket:
        socket.send_text(json.dumps(body))
        [error] = socket.receive_json()["errors"]
        assert (error["field"], error["value"]) == ("max_points", 100_000)
        assert "POST /curves" in error["allowed"]
        socket.send_text(json.dumps(body | {"max_points": 400}))
        assert "methods" in socket.receive_json()


async def sent(answer: Planned, send: Any = None) -> list[Message]:
    messages: list[Message] = []

    async def keep(message: Message) -> None:
        messages.append(message)

    async def receive() -> Message:
        raise AssertionError("nothing is read")

    await answer({"headers": []}, receive, send or keep)
    return messages


@pytest.mark.parametrize("after", [0, 20])
def test_what_goes_wrong_is_raised(after: int) -> None:
    """Before the first piece, so that it can be answered; and later, so that the answer doesn't seem complete."""

    def job() -> object:
        if after:
            return {"first": np.arange(after * SLICE), "then": object()}
        raise Rejected([Rejection("field", 1, "2")])

    with pytest.raises(TypeError if after else Rejected):
        run(sent(Planned(Lane("test", 1), job)))


def test_no_more_is_written_than_is_taken_and_a_little() -> None:
    """The rest is never written when the client goes, and only then is it the next one's turn."""
    lane, written, is_ahead = Lane("test", 1), list[int](), threading.Event()

    def counting(_: object) -> Iterator[bytes]:
        for number in range(1000):
            written.append(number)
            if number == MOST_AHEAD:
                is_ahead.set()
            yield b"piece"

    async def never(message: Message) -> None:
        if message["type"] == "http.response.body":
            await asyncio.Event().wait()

    async def work() -> None:
        answer = asyncio.create_task(sent(Planned(lane, dict, Format("text/plain", counting)), never))
        assert await asyncio.to_thread(is_ahead.wait, PATIENCE_S)
        turn = asyncio.create_task(lane.run(lambda: len(written)))
        answer.cancel()
        with pytest.raises(asyncio.CancelledError):
            await answer
        assert MOST_AHEAD < await turn <= MOST_AHEAD + 4

    run(work())


def test_a_client_that_takes_nothing_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    async def never(message: Message) -> None:
        if message["type"] == "http.response.body":
            await asyncio.Event().wait()

    monkeypatch.setattr(planned, "STALLED_S", 0.0)
    with pytest.raises(TimeoutError):
        run(sent(Planned(Lane("test", 1), lambda: np.arange(100 * SLICE)), never))
