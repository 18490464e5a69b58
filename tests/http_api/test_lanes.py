"""Lanes: who takes long keeps only its own kind waiting."""

import asyncio
import os
import threading
import tty
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import partial

import pytest
from starlette.testclient import TestClient, WebSocketTestSession

from designs import design, document
from event_loop import run
from motor.trains import whole
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.device import Device
from stepramp.errors import Overloaded
from stepramp.http_api import lanes
from stepramp.http_api.access import ASKING, Client, Role
from stepramp.http_api.curves_models import CurvesAnswer
from stepramp.http_api.lanes import (
    A_DEVICE,
    AT_ONCE,
    CONNECTING,
    CORES,
    LONG_PLANNING,
    PLANNING,
    Lane,
    planning_lane,
    profile_turns,
)
from stepramp.link import protocol_sim
from stepramp.ramp.drawing import Drawing

DEVICES = "/api/v1/devices"
SOCKET = "/api/v1/curves/socket"
LOCAL = {"host": "127.0.0.1:8000"}
PATIENCE_S = 10.0
MUTE = 9
ASKERS = 40


@pytest.fixture
def device(client: TestClient) -> str:
    """Return the route of a device with a ramp."""
    protocol_sim.register("sim://lanes", VirtualController())
    route = f"{DEVICES}/{client.post(DEVICES, json={'port': 'sim://lanes'}).json()['id']}"
    assert client.post(f"{route}/push", json={"design": document()}).status_code == 200
    return route


@contextmanager
def taken(lane: Lane, threads: int) -> Iterator[None]:
    """Take all threads of a lane with jobs that wait."""
    end, begun = threading.Event(), threading.Barrier(threads + 1)

    def wait() -> None:
        begun.wait(PATIENCE_S)
        end.wait(PATIENCE_S)

    with ThreadPoolExecutor(threads) as callers:
        waiting = [callers.submit(lane.wait_for, wait) for _ in range(threads)]
        begun.wait(PATIENCE_S)
        try:
            yield
        finally:
            end.set()
        assert [each.result() for each in waiting] == [None] * threads


@contextmanager
def mute_ports(count: int) -> Iterator[list[str]]:
    """Yield serial ports at which nobody answers."""
    with ExitStack() as open_ends:
        ports = []
        for _ in range(count):
            far_end, near_end = os.openpty()
            tty.setraw(near_end)
            open_ends.callback(os.close, far_end)
            open_ends.callback(os.close, near_end)
            ports.append(os.ttyname(near_end))
        yield ports


def test_a_move_a_connect_and_a_stop_need_no_planning_thread(client: TestClient, device: str) -> None:
    protocol_sim.register("sim://lanes-2", VirtualController())
    with taken(PLANNING, CORES), taken(LONG_PLANNING, CORES):
        assert client.post(f"{device}/move", json={"by_steps": 5000}).json()["state"] == "moving"
        assert client.post(DEVICES, json={"port": "sim://lanes-2"}).json()["state"] == "ready"
        assert client.post(f"{device}/stop").json()["state"] in ("stopping", "ready")


def test_long_plannings_keep_short_ones_not_waiting(client: TestClient) -> None:
    with taken(LONG_PLANNING, CORES):
        for route, more in (("profile", {}), ("curves", {"methods": ["exact"]}), ("errors", {"methods": ["exact"]})):
            assert client.post(f"/api/v1/{route}", json={"design": document(), **more}).status_code == 200


def test_long_plannings_over_sockets_keep_short_ones_not_waiting(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    long_steps, begun, end = 10_000_000, threading.Semaphore(0), threading.Event()

    def answer(drawing: Drawing) -> dict[str, object]:
        if abs(drawing.design.move.steps) == long_steps:
            begun.release()
            assert end.wait(PATIENCE_S)
        return {"steps": drawing.design.move.steps}

    def ask(socket: WebSocketTestSession, steps: int) -> None:
        socket.send_json({"design": document(move__steps=steps), "methods": ["exact"]})

    monkeypatch.setattr(CurvesAnswer, "of", answer)
    with ExitStack() as open_ends:
        sockets = [open_ends.enter_context(client.websocket_connect(SOCKET, headers=LOCAL)) for _ in range(CORES + 2)]
        *slow, quick = sockets
        for socket in slow:
            ask(socket, long_steps)
        for _ in range(CORES):
            assert begun.acquire(timeout=PATIENCE_S)
        ask(quick, 500)
        assert quick.receive_json() == {"steps": 500}
        end.set()
        assert [socket.receive_json() for socket in slow] == [{"steps": long_steps}] * len(slow)


def test_mute_ports_keep_no_move_and_no_stop_waiting(client: TestClient, device: str) -> None:
    with mute_ports(MUTE) as ports, ThreadPoolExecutor(MUTE) as callers:
        connects = [callers.submit(client.post, DEVICES, json={"port": port}) for port in ports]
        while len(client.get(DEVICES).json()["devices"]) < MUTE:  # One of them waits for its turn.
            assert not any(connect.done() for connect in connects)
        assert client.post(f"{device}/move", json={"by_steps": 5000}).json()["state"] == "moving"
        assert client.post(f"{device}/stop").json()["state"] in ("stopping", "ready")
        assert not any(connect.done() for connect in connects)
        assert [connect.result().status_code for connect in connects] == [502] * MUTE


def test_what_waits_too_long_for_its_turn_is_refused_with_the_reason(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten clients whose moves take seconds each keep the eleventh waiting for no more than 30 s."""
    monkeypatch.setattr(LONG_PLANNING, "_most_wait_s", 0.05)
    asked = {"design": whole()}
    with taken(LONG_PLANNING, CORES):
        refused = client.post("/api/v1/motor/simulate", json=asked)
        assert refused.status_code == 503
        [error] = refused.json()["errors"]
        assert error["message"] == "Others are computing: this has waited 0.05 s for its turn. Ask again later."
    monkeypatch.undo()
    assert client.post("/api/v1/motor/simulate", json=asked).status_code == 200


def test_what_has_begun_in_time_is_done_to_its_end_and_what_is_refused_is_never_begun() -> None:
    lane, begun, end = Lane("narrow", 1, most_wait_s=0.02), threading.Event(), threading.Event()
    done = list[str]()

    def slow() -> str:
        begun.set()
        assert end.wait(PATIENCE_S)
        return "slow"

    async def both() -> str:
        first = asyncio.ensure_future(lane.run(slow))
        await asyncio.to_thread(begun.wait, PATIENCE_S)
        with pytest.raises(Overloaded, match=r"has waited 0\.02 s for its turn"):
            await lane.run(lambda: done.append("late"))
        end.set()
        return await first

    assert run(both()) == "slow"
    assert run(lane.run(lambda: "next")) == "next"
    assert done == []


def test_what_is_cancelled_while_it_waits_is_never_begun() -> None:
    lane, done = Lane("test", 1), list[str]()

    async def work() -> None:
        waits = asyncio.create_task(lane.run(lambda: done.append("abandoned")))
        await asyncio.sleep(0)
        waits.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waits

    with taken(lane, 1):
        run(work())
    lane.wait_for(lambda: done.append("last"))
    assert done == ["last"]


@pytest.mark.parametrize("is_given_up", [False, True])
def test_who_asks_of_one_device_takes_only_some_of_the_threads(is_given_up: bool) -> None:
    """Also when nobody waits for its answers any more."""
    lane, answers, asked = Lane("test", A_DEVICE + 1), threading.Event(), list[int]()

    def ask(number: int) -> None:
        asked.append(number)
        answers.wait(PATIENCE_S)

    async def work() -> None:
        try:
            askers = [asyncio.create_task(lane.run(partial(ask, number), "mute")) for number in range(20)]
            while len(asked) < A_DEVICE:
                await asyncio.sleep(0)
            for asker in askers[:A_DEVICE] if is_given_up else []:
                asker.cancel()
            assert await lane.run(lambda: "answered", "other") == "answered"
            assert len(asked) == A_DEVICE
        finally:
            answers.set()
        await asyncio.gather(*askers, return_exceptions=True)
        assert sorted(asked) == list(range(20))

    run(work())


def test_who_leaves_and_asks_again_takes_no_second_thread() -> None:
    """What has begun for a client that left goes on: it is that client's turn until it is done."""
    lane, end, begun = Lane("test", 2, most_wait_s=PATIENCE_S), threading.Event(), list[str]()

    def long(who: str) -> None:
        begun.append(who)
        end.wait(PATIENCE_S)

    async def ask(place: str, job: Callable[[], object]) -> object:
        ASKING.set(Client(place, Role.VIEW))
        return await lane.run(job)

    async def work() -> None:
        leaving = [asyncio.create_task(ask("greedy", partial(long, "greedy"))) for _ in range(3)]
        try:
            for each in leaving:
                await until_begun()
                each.cancel()
                await asyncio.wait([each])
            assert await asyncio.wait_for(ask("other", lambda: "quick"), PATIENCE_S) == "quick"
            assert begun == ["greedy"]
        finally:
            end.set()
        assert await ask("greedy", lambda: "next") == "next"

    async def until_begun() -> None:
        while not begun:
            await asyncio.sleep(0)

    run(work())


def test_a_muted_device_keeps_no_other_one_waiting(
    client: TestClient, device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    protocol_sim.register("sim://lanes-mute", VirtualController())
    muted = f"{DEVICES}/{client.post(DEVICES, json={'port': 'sim://lanes-mute'}).json()['id']}"
    answers, asked = threading.Event(), threading.Semaphore(0)

    def settings(_: Device) -> StepRampSettings:
        asked.release()
        answers.wait(PATIENCE_S)
        return StepRampSettings()

    monkeypatch.setattr(Device, "settings", settings)
    with ThreadPoolExecutor(ASKERS) as callers:
        askers = [callers.submit(client.get, f"{muted}/settings") for _ in range(ASKERS)]
        for _ in range(A_DEVICE):
            assert asked.acquire(timeout=PATIENCE_S)
        assert client.post(f"{device}/move", json={"by_steps": 50}).json()["state"] == "moving"
        assert not any(asker.done() for asker in askers)
        answers.set()
        assert [asker.result().status_code for asker in askers] == [200] * ASKERS


def test_which_plannings_are_long() -> None:
    slow_ramp = design(ramp__acceleration_steps_per_s2=0.06)
    long_move = design(move__steps=10_000_000)
    assert planning_lane([design()]).lane is PLANNING
    assert planning_lane([design(move__steps=1_000_000)], 4, 2000).lane is PLANNING
    assert planning_lane([design(move__steps=1_000_000)]).lane is LONG_PLANNING
    for one in (slow_ramp, long_move):
        assert planning_lane([one], 1, 2000).lane is LONG_PLANNING
    assert planning_lane([design(move__steps=2_000_000)] * 4, 1, 2000).lane is LONG_PLANNING


def test_connecting_has_few_threads(client: TestClient) -> None:
    """A connect waits for its turn, and is answered then."""
    protocol_sim.register("sim://lanes-3", VirtualController())
    with ThreadPoolExecutor(1) as caller:
        with taken(CONNECTING, 8):
            connect = caller.submit(client.post, DEVICES, json={"port": "sim://lanes-3"})
            assert client.get(DEVICES).json() == {"devices": []}
            assert not connect.done()
        assert connect.result().json()["state"] == "ready"


def test_a_report_waits_with_what_takes_long_and_keeps_no_stop_waiting(client: TestClient, device: str) -> None:
    with ThreadPoolExecutor(1) as caller:
        with taken(LONG_PLANNING, CORES):
            report = caller.submit(client.post, "/api/v1/report?format=pdf", json={"design": document()})
            assert client.post(f"{device}/stop").status_code == 200
            assert not report.done()
        assert report.result().content.startswith(b"%PDF")


def test_a_small_profile_needs_no_thread_once_its_numerics_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanes, "COMPILED", threading.Event())
    small, long = design(move__steps=500), design(move__steps=20_000)
    assert profile_turns(small, None) is not AT_ONCE
    lanes.COMPILED.set()
    assert profile_turns(small, None) is AT_ONCE
    assert profile_turns(long, 500) is not AT_ONCE
    assert profile_turns(design(move__steps=5000), None) is not AT_ONCE


def test_a_small_profile_is_the_same_at_once_as_from_a_thread(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lanes, "COMPILED", threading.Event())
    too_fast = document(timer__frequency_hz=1000.0, ramp__slew_speed_steps_per_s=5000.0)

    def answers() -> list[tuple[int, str, str | None]]:
        asked = [(document(), "application/json"), (document(), "text/csv"), (too_fast, "application/json")]
        all_of_them = [
            client.post("/api/v1/profile", json={"design": one, "max_points": 400}, headers={"accept": accept})
            for one, accept in asked
        ]
        return [(each.status_code, each.text, each.headers.get("vary")) for each in all_of_them]

    in_threads = answers()
    lanes.COMPILED.set()
    with taken(PLANNING, CORES):
        assert answers() == in_threads
    assert [status for status, _, _ in in_threads] == [200, 200, 422]


def test_of_what_moves_nothing_is_missed_while_many_compute(client: TestClient, device: str) -> None:
    """Each status that is told is newer than the one before, and the last is where it came to rest."""
    over = threading.Event()

    def compute() -> int:
        answers = 0
        while not over.is_set():
            assert client.post("/api/v1/profile", json={"design": document()}).status_code == 200
            answers += 1
        return answers

    with ThreadPoolExecutor(8) as callers, client.websocket_connect(f"{DEVICES}/events", headers=LOCAL) as socket:
        computing = [callers.submit(compute) for _ in range(8)]
        try:
            assert client.post(f"{device}/move", json={"by_steps": 300}).json()["state"] == "moving"
            views = [socket.receive_json()["devices"][0]]
            while (views[-1]["state"], views[-1]["position_steps"]) != ("ready", 300):
                views.append(socket.receive_json()["devices"][0])
        finally:
            over.set()
        assert all(each.result() > 0 for each in computing)
    for name in ("heard_s", "position_steps"):
        assert [view[name] for view in views] == sorted(view[name] for view in views)
    assert len({view["position_steps"] for view in views}) > 3
