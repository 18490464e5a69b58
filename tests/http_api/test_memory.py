"""Memory for long plans: who doesn't fit waits, and what never would is refused with the reason."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from starlette.testclient import TestClient

from designs import document
from stepramp.errors import Rejected
from stepramp.http_api import lanes, memory
from stepramp.http_api.memory import BYTES_A_STEP, MOST_BYTES, SHARE, Memory, machine_bytes, most_for_plans

PATIENCE_S = 20.0


def test_so_much_is_taken_as_there_is_and_the_first_goes_first() -> None:
    room, order = Memory(100), list[str]()
    first_is_in, first_may_end = threading.Event(), threading.Event()

    def first() -> None:
        first_is_in.set()
        assert first_may_end.wait(PATIENCE_S)
        order.append("first")

    with ThreadPoolExecutor(3) as pool:
        begun = pool.submit(room.use, 60, first)
        assert first_is_in.wait(PATIENCE_S)
        large = pool.submit(room.use, 80, lambda: order.append("large"))
        while len(room._waiting) < 1:
            pass
        small = pool.submit(room.use, 10, lambda: order.append("small"))
        while len(room._waiting) < 2:
            pass
        assert not large.done()
        assert not small.done()
        first_may_end.set()
        for each in (begun, large, small):
            each.result(PATIENCE_S)
    assert order == ["first", "large", "small"]
    assert room.use(100, lambda: 7) == 7


def test_room_is_given_back_whatever_becomes_of_a_plan() -> None:
    room = Memory(100)
    for _ in range(3):
        with pytest.raises(ZeroDivisionError), room.held(100):
            _ = 1 / 0
    assert room.use(100, lambda: True)


def test_what_never_fits_is_refused_with_how_much_would() -> None:
    room = Memory(1_000_000 * BYTES_A_STEP)
    assert room.of(600_000, "design") == 600_000 * BYTES_A_STEP
    with pytest.raises(Rejected) as caught:
        room.of(1_200_000, "designs")
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("designs", "1,200,000 steps")
    assert rejection.message.startswith("designs is 1,200,000 steps; allowed: at most 1,000,000 steps, of all axes")


def test_it_is_refused_over_the_api_before_anything_is_computed(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lanes, "MEMORY", Memory(1_000_000 * BYTES_A_STEP))
    for route, body, field in (
        ("profile", {"design": document(move__steps=2_000_000)}, "design"),
        ("errors", {"design": document(move__steps=2_000_000), "methods": ["exact"]}, "design"),
        ("schedule", {"designs": [document(move__steps=600_000)] * 2, "mode": "independent"}, "designs"),
    ):
        refused = client.post(f"/api/v1/{route}", json=body)
        assert refused.status_code == 422, route
        [error] = refused.json()["errors"]
        assert (error["field"], "too little memory" in error["allowed"]) == (field, True)


def test_the_machine_says_how_much_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    known = machine_bytes()
    assert known is None or known > 2**28
    assert most_for_plans() <= MOST_BYTES
    monkeypatch.setattr(memory, "machine_bytes", lambda: 3 * 2**30)
    assert most_for_plans() == int(3 * 2**30 * SHARE)
