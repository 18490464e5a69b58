"""The history of pushes over the API: a controller on a cable, its library, and one that can't be used."""

from __future__ import annotations

import asyncio
import logging
import sqlite3
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import closing
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest
from starlette.testclient import TestClient
from starlette.types import Message

from controllers.grbl.emulator import GrblOnACable
from designs import design, document
from event_loop import run
from http_api.families import DEVICES, connected, error_of, ok
from stepramp.errors import DeviceLost
from stepramp.http_api import bodies, history_keeper, library_file
from stepramp.http_api.history_keeper import HistoryKeeper
from stepramp.http_api.lanes import LIBRARY as LIBRARY_LANE
from stepramp.http_api.lanes import LIBRARY_FILES
from stepramp.http_api.library_file import library_as_file
from stepramp.library import database
from stepramp.library.history import History
from stepramp.library.whole import Whole
from waiting import until

if TYPE_CHECKING:
    from stepramp.devices.device import Device

LIBRARY = "/api/v1/library"
TYPE = {"content-type": "application/octet-stream"}


@pytest.fixture
def cable() -> Iterator[GrblOnACable]:
    with GrblOnACable() as cable:
        yield cable


def pushes(client: TestClient, **wanted: Any) -> list[dict[str, Any]]:
    return list(ok(client.post(f"{LIBRARY}/pushes/search", json=wanted))["pushes"])


def test_a_push_is_found_with_its_device_its_revision_and_its_backup(client: TestClient, cable: GrblOnACable) -> None:
    kept = ok(client.post(f"{LIBRARY}/designs", json={"design": document(), "name": "Lift"}))
    route = connected(client, cable.port, "grbl")
    report = ok(client.post(f"{route}/push", json={"design": document()}))
    [device] = ok(client.get(f"{LIBRARY}/devices"))["devices"]
    assert (device["family"], device["identity"], device["port"], device["pushes"]) == ("grbl", *2 * (cable.port,), 1)
    [pushed] = pushes(client, device_id=device["id"], design_id=kept["id"])
    assert (pushed["device"], pushed["mode"], pushed["trouble"], pushed["client"], pushed["verified"]) == (
        device["name"], "keep", None, None, report["verified"],
    )  # fmt: skip
    assert pushed["backup"] == client.get(route).json()["backup"] is not None
    [axis] = pushed["axes"]
    assert (axis["axis"], axis["name"]) == (0, "Test")
    assert axis["revisions"] == [{"design_id": kept["id"], "name": "Lift", "number": 1}]
    whole = ok(client.get(f"{LIBRARY}/pushes/{pushed['id']}"))
    assert whole["report"] == report
    assert whole["designs"][0]["design"]["move"] == {"steps": 2000}
    assert pushes(client, device_id="none") == []
    error_of(client.get(f"{LIBRARY}/pushes/none"), 404)


def test_what_fails_is_in_it_and_what_was_rejected_is_not(client: TestClient, cable: GrblOnACable) -> None:
    route = connected(client, cable.port, "grbl")
    too_fast = {"design": document(ramp__slew_speed_steps_per_s=40_000_000)}
    assert client.post(f"{route}/push", json=too_fast).status_code == 422
    cable.unplug()
    words = error_of(client.post(f"{route}/push", json={"design": document(), "to_axis": 1}), 502)["message"]
    [pushed] = pushes(client)
    assert (pushed["trouble"], pushed["verified"], pushed["axes"][0]["axis"]) == (words, None, 1)
    assert ok(client.get(f"{LIBRARY}/pushes/{pushed['id']}"))["report"] is None


def test_the_virtual_controller_is_in_no_history(client: TestClient) -> None:
    route = f"{DEVICES}/{ok(client.post(DEVICES, json={'port': 'sim://'}))['id']}"
    ok(client.post(f"{route}/push", json={"design": document()}))
    assert pushes(client) == ok(client.get(f"{LIBRARY}/devices"))["devices"] == []


def test_a_push_waits_for_no_library_and_is_written_once_that_is_back(
    client: TestClient, cable: GrblOnACable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:  # fmt: skip
    monkeypatch.setattr(database, "LOCKED_S", 0.01)
    route = connected(client, cable.port, "grbl")
    assert pushes(client) == []
    with closing(sqlite3.connect(tmp_path / database.FILE_NAME, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        with caplog.at_level(logging.WARNING):
            ok(client.post(f"{route}/push", json={"design": document(), "mode": "keep"}))
            assert pushes(client) == []
        assert "waits for the library, 1 so far" in caplog.text
    assert [each["mode"] for each in pushes(client)] == ["keep"]


def test_nothing_else_waits_for_a_history_that_waits_for_its_database(client: TestClient) -> None:
    may_end = threading.Event()
    client.app.state.history_keeper._later(may_end.wait)  # type: ignore[attr-defined]
    with ThreadPoolExecutor(50) as askers:
        asking = [askers.submit(client.get, f"{LIBRARY}/devices") for _ in range(50)]
        try:
            until(lambda: LIBRARY_LANE._pool._work_queue.qsize() == 49)
            assert client.get("/").status_code == 200
            assert not any(each.done() for each in asking)
        finally:
            may_end.set()
        assert {each.result().status_code for each in asking} == {200}


def test_an_entry_that_can_never_be_written_keeps_no_other_waiting(
    client: TestClient, cable: GrblOnACable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:  # fmt: skip
    monkeypatch.setattr(database, "LOCKED_S", 0.01)
    route = connected(client, cable.port, "grbl")
    assert pushes(client) == []
    keeper = client.app.state.history_keeper  # type: ignore[attr-defined]
    with closing(sqlite3.connect(tmp_path / database.FILE_NAME, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        for odd in ("\ud800", None):
            device = SimpleNamespace(id="1" * 32, family=odd, identity="", name="", port="")
            keeper._later(partial(keeper._history.note_device, device))
        ok(client.post(f"{route}/push", json={"design": document()}))
    with caplog.at_level(logging.ERROR):
        assert len(pushes(client)) == 1
    assert caplog.text.count("An entry of the history of pushes is lost.") == 2
    assert "The library can't keep this" in caplog.text


@pytest.mark.parametrize(("ending_s", "noted", "told"), [(60.0, 1, ""), (0.0, 0, "that came since is lost")])
def test_a_push_that_fails_by_the_server_s_end_is_in_the_history_or_said_to_be_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture,
    ending_s: float, noted: int, told: str,
) -> None:  # fmt: skip
    monkeypatch.setattr(history_keeper, "ENDING_S", ending_s)
    view = SimpleNamespace(family="grbl", name="CH340", port="/dev/ttyUSB0", backup=None)
    device = cast("Device", SimpleNamespace(called="A1", view=view))
    history = History(database.Database(tmp_path))
    keeper = HistoryKeeper(history)
    begun, may_fail = threading.Event(), threading.Event()

    def push() -> None:
        with keeper.noting(device, [design()], None, "keep", None):
            begun.set()
            may_fail.wait(60)
            raise DeviceLost("The port was closed.")

    with ThreadPoolExecutor(2) as pool:
        pushing = pool.submit(push)
        begun.wait(60)
        ending = pool.submit(keeper.close)
        wait([ending], 0.2)
        may_fail.set()
        with pytest.raises(DeviceLost):
            pushing.result()
        ending.result()
    assert [each.trouble for each in history.pushes()[1]] == ["The port was closed."] * noted
    assert told in caplog.text


def test_records_are_kept_with_their_design(client: TestClient) -> None:
    kept = ok(client.post(f"{LIBRARY}/designs", json={"design": document()}))
    place = f"{LIBRARY}/designs/{kept['id']}/records"
    asked = {"revision": 1, "kind": "trace", "note": "at the mill", "document": {"ticks": [1, 2.5, None]}}
    made = ok(client.post(place, json=asked))
    assert ok(client.get(place)) == {"records": [made]}
    assert ok(client.get(f"{place}/{made['id']}")) == {"document": asked["document"]}
    error_of(client.post(place, json=asked | {"revision": 2}), 404)
    assert error_of(client.post(place, json=asked | {"kind": "song"}), 422)["field"] == "kind"
    error_of(client.get(f"{place}/none"), 404)


@pytest.mark.parametrize(
    ("content", "allowed"),
    [
        ('{"a": [NaN]}', "a document whose numbers are finite"),
        ('{"a": -Infinity}', "a document whose numbers are finite"),
        ('{"a": {"b": 1e999}}', "a document whose numbers are finite"),
        ('{"a": ' + "[" * 300 + "]" * 300 + "}", "a document of up to 32 levels"),
    ],
)
def test_a_record_that_could_not_be_told_back_is_refused(client: TestClient, content: str, allowed: str) -> None:
    kept = ok(client.post(f"{LIBRARY}/designs", json={"design": document()}))
    body = f'{{"revision": 1, "kind": "trace", "document": {content}}}'
    place = f"{LIBRARY}/designs/{kept['id']}/records"
    error = error_of(client.post(place, content=body, headers={"content-type": "application/json"}), 422)
    assert (error["field"], error["allowed"]) == ("document", allowed)
    assert ok(client.get(place)) == {"records": []}


def test_a_file_that_is_given_up_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    begun, may_go_on = threading.Event(), threading.Event()

    def lines() -> Iterator[bytes]:
        begun.set()
        may_go_on.wait(60)
        yield b"{}"

    async def work() -> None:
        state = SimpleNamespace(whole_library=SimpleNamespace(lines=lines))
        taken: list[int] = []
        scope = {"stepramp.take_room": taken.append}
        request: Any = SimpleNamespace(app=SimpleNamespace(state=state), scope=scope)
        asking = asyncio.ensure_future(library_as_file(request))
        await asyncio.to_thread(begun.wait, 60)
        asking.cancel()
        may_go_on.set()
        with pytest.raises(asyncio.CancelledError):
            await asking
        await LIBRARY_FILES.run(lambda: None)
        assert list(tmp_path.iterdir()) == []
        # What nobody has come to take is as good as given up.
        response = await library_as_file(request)
        assert taken == [2]
        with pytest.raises(OSError, match="gone"):
            await response({"type": "http", "method": "GET", "headers": []}, nothing_comes, nobody_takes)
        assert list(tmp_path.iterdir()) == []
        monkeypatch.setattr(library_file, "STALLED_S", 0.0)
        response = await library_as_file(request)
        with pytest.raises(TimeoutError):
            await response({"type": "http", "method": "GET", "headers": []}, nothing_comes, somebody_takes_nothing)
        assert list(tmp_path.iterdir()) == []

    run(work())


async def nothing_comes() -> Message:
    await asyncio.Event().wait()
    raise AssertionError


async def somebody_takes_nothing(_: Message) -> None:
    await asyncio.Event().wait()


async def nobody_takes(_: Message) -> None:
    raise OSError("gone")


def test_a_library_without_room_on_the_way_is_told(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = client.get(f"{LIBRARY}/file").content
    monkeypatch.setattr(tempfile, "tempdir", "/dev/full/folder")
    for answer in (client.get(f"{LIBRARY}/file"), client.post(f"{LIBRARY}/import", content=whole, headers=TYPE)):
        message = error_of(answer, 503)["message"]
        assert "can't keep the file while it is read or sent (Not a directory" in message
        assert "nothing was changed" in message


def test_files_on_their_way_have_as_much_room_as_there_is(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    for n in range(30):
        ok(client.post(f"{LIBRARY}/designs", json={"design": document(), "name": f"{n}"}))
    monkeypatch.setattr(bodies.LibraryFileRoute, "room", bodies.Room(20_000))
    assert "Ask again later" in error_of(client.get(f"{LIBRARY}/file"), 503)["message"]
    monkeypatch.setattr(bodies.LibraryFileRoute, "room", bodies.Room(2_000_000))
    for _ in range(100):
        assert client.get(f"{LIBRARY}/file").status_code == 200


def test_a_library_that_is_too_large_is_refused(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = client.get(f"{LIBRARY}/file").content
    monkeypatch.setattr(bodies, "MOST_LIBRARY_BYTES", len(whole))
    assert ok(client.post(f"{LIBRARY}/import", content=whole, headers=TYPE))["copies"] == []
    error = error_of(client.post(f"{LIBRARY}/import", content=whole + b"\n", headers=TYPE), 413)
    assert f"allowed: up to {len(whole)} bytes" in error["message"]


def test_the_library_is_asked_while_all_of_it_is_written(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, asked = threading.Event(), threading.Event()

    def slow(_: Whole) -> Iterator[bytes]:
        begun.set()
        assert asked.wait(60)
        yield b"all"

    monkeypatch.setattr(Whole, "lines", slow)
    with ThreadPoolExecutor(1) as pool:
        told = pool.submit(client.get, f"{LIBRARY}/file")
        assert begun.wait(60)
        assert ok(client.post(f"{LIBRARY}/search", json={}))["count"] == 0
        asked.set()
        assert told.result().content == b"all"


def test_the_library_as_a_file_and_back(
    client: TestClient, cable: GrblOnACable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    ok(client.post(f"{LIBRARY}/designs", json={"design": document(), "name": "Lift"}))
    ok(client.post(f"{connected(client, cable.port, 'grbl')}/push", json={"design": document()}))
    assert len(pushes(client)) == 1
    told = client.get(f"{LIBRARY}/file")
    assert int(told.headers["content-length"]) == len(told.content)
    assert list((tmp_path / "temporary").iterdir()) == []
    assert 'filename="stepramp-library.jsonl"' in told.headers["content-disposition"]
    assert ok(client.post(f"{LIBRARY}/import", content=told.content, headers=TYPE)) == {
        "designs": 0, "revisions": 0, "devices": 0, "pushes": 0, "records": 0,
        "there_already": 3, "described": 0, "copies": [],
    }  # fmt: skip
    half = client.post(f"{LIBRARY}/import", content=told.content[:-100], headers=TYPE)
    error = error_of(half, 422)
    assert (error["field"], error["allowed"][:13]) == ("file", "a whole file:")
    assert client.post(f"{LIBRARY}/import", json={}).status_code == 415
