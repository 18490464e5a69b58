"""Whether a grbl has stored what it was given: seen after its next start, or one that is asked for."""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from controllers.fluidnc.emulator import FluidNcEmulator
from controllers.grbl.emulator import GrblOnACable
from designs import document
from http_api.families import DEVICES, PATIENCE_S, connected, error_of, ok, wait_until
from stepramp.controllers.grbl.controller import GrblController
from stepramp.devices import attachment
from stepramp.http_api.app import create_app

LOCAL = {"host": "127.0.0.1:8000"}
GIVEN = ["$110", "$120"]
SINCE = r"on \d{4}-\d\d-\d\d \d\d:\d\d UTC"


@pytest.fixture
def cable(monkeypatch: pytest.MonkeyPatch) -> Iterator[GrblOnACable]:
    with GrblOnACable() as cable:
        # However busy the machine is, it notices that its port is closed before that is opened again.
        monkeypatch.setattr(attachment, "sleep", lambda _: cable.wait_until_closed())
        yield cable


@pytest.fixture
def route(client: TestClient, cable: GrblOnACable) -> str:
    """Return the route of a grbl that was given 240 mm/min and 20 mm/s²."""
    route = connected(client, cable.port, "grbl")
    pushed = ok(client.post(f"{route}/push", json={"design": document()}))
    assert pushed["verified"]
    return route


def again(client: TestClient, cable: GrblOnACable, route: str) -> dict[str, Any]:
    """Disconnect it and connect it again."""
    ok(client.delete(route))
    cable.wait_until_closed()
    return ok(client.get(connected(client, cable.port, "grbl")))


def unproven_file(data: Path) -> Any:
    [file] = data.rglob("unproven.json")
    return json.loads(file.read_text())


def test_it_is_proven_as_it_is_next_connected(
    client: TestClient, cable: GrblOnACable, route: str, tmp_path: Path
) -> None:
    device = ok(client.get(route))
    assert (device["unproven"], device["proof"], device["message"]) == (GIVEN, None, None)
    # It is said once, of the device, for as long as it holds.
    way_out = "What the controller has stored is proven at its next start: wait for that, or restart it now."
    words = f"$110, $120 are in use. {way_out}"
    assert device["unproven_words"] == words
    assert words not in device["pushed"]["warnings"]
    assert unproven_file(tmp_path)["$110"]["value"] == "240.000"
    device = again(client, cable, route)
    words = "Stored: after a start the controller had $110, $120 as written."
    assert (device["unproven"], device["unproven_words"], device["message"]) == ([], None, None)
    assert device["proof"] == {"proven": GIVEN, "not_kept": [], "others": [], "stored": words, "words": words}
    assert (device["pushed"], device["proving"]) == (None, False)
    assert unproven_file(tmp_path) == {}
    # Its backups are none the more by that.
    assert len(ok(client.get("/api/v1/backups"))["sources"]) == 1


@pytest.mark.parametrize("fault", ["is_broken", "is_worn"])
def test_what_was_not_kept_is_told_and_mended_by_a_restore(client: TestClient, cable: GrblOnACable, fault: str) -> None:
    route = connected(client, cable.port, "grbl")
    setattr(cable.grbl.eeprom, fault, True)
    ok(client.post(f"{route}/push", json={"design": document()}))
    ok(client.delete(route))
    route = connected(client, cable.port, "grbl")
    device = ok(client.get(route))
    assert device["unproven"] == device["proof"]["not_kept"] == GIVEN
    assert (device["unproven_words"], device["proof"]["stored"]) == (None, None)
    others = [(each["name"], each["written"], each["now"]) for each in device["proof"]["others"]]
    assert [(name, written) for name, written, _ in others] == [("$110", "240.000"), ("$120", "20.000")]
    assert all(f"{name}={now} where {written}" in device["message"] for name, written, now in others)
    assert device["message"] == device["proof"]["words"]
    speed, gain, mending = re.split(r", and |\. Either ", device["message"])
    assert re.fullmatch(rf"Since its start the controller has \$110=500\.000 where 240\.000 was written {SINCE}", speed)
    assert re.fullmatch(rf"\$120=10\.000 where 20\.000 was written {SINCE}", gain)
    assert mending == (
        "it hasn't kept them, or somebody has set them since, or another controller is there now. Restore a backup of "
        "this device, or push again."
    )
    # It says so again as long as nothing was done about it.
    device = again(client, cable, route)
    assert device["proof"]["not_kept"] == GIVEN
    route = f"{DEVICES}/{device['id']}"
    [saved] = ok(client.get(f"{route}/backups"))["backups"]
    ok(client.post(f"{route}/backups/{saved['name']}/restore"))
    device = ok(client.get(route))
    assert (device["unproven"], device["proof"], device["message"]) == ([], None, None)


def test_a_restore_that_writes_nothing_leaves_what_is_to_be_proven(
    client: TestClient, cable: GrblOnACable, route: str, tmp_path: Path
) -> None:
    """What was pushed is in use, and so wanted as it is: whether it was stored nobody knows yet."""
    [before] = ok(client.get(f"{route}/backups"))["backups"]
    cable.grbl.eeprom.settings[110] = 500.0
    ok(client.post(f"{route}/backups"))
    [pushed, _] = ok(client.get(f"{route}/backups"))["backups"]
    written = cable.grbl.eeprom.writes
    ok(client.post(f"{route}/backups/{pushed['name']}/restore"))
    assert cable.grbl.eeprom.writes == written
    assert ok(client.get(route))["unproven"] == list(unproven_file(tmp_path)) == GIVEN
    device = again(client, cable, route)
    assert device["proof"]["not_kept"] == ["$110"]
    assert "the controller has $110=500.000 where 240.000 was written" in device["message"]
    # What is wanted otherwise by now isn't to be proven any more, though it needn't be written.
    ok(client.post(f"{DEVICES}/{device['id']}/backups/{before['name']}/restore"))
    device = ok(client.get(f"{DEVICES}/{device['id']}"))
    assert (device["unproven"], device["message"]) == (["$120"], None)


def test_it_outlasts_the_program(cable: GrblOnACable, tmp_path: Path) -> None:
    for is_later in (False, True):
        with TestClient(create_app(data=tmp_path), base_url="http://127.0.0.1") as client:
            route = connected(client, cable.port, "grbl")
            if not is_later:
                ok(client.post(f"{route}/push", json={"design": document()}))
                cable.grbl.eeprom.settings[110] = 77.0
            device = ok(client.get(route))
    assert device["proof"]["proven"] == ["$120"]
    assert "the controller has $110=77.000 where 240.000 was written" in device["message"]
    assert "Either it hasn't kept it, or somebody has set it since" in device["message"]
    assert device["unproven"] == ["$110"]


def test_a_push_and_a_restore_say_that_what_is_to_be_proven_is_not_written_down(
    client: TestClient, cable: GrblOnACable, route: str, tmp_path: Path
) -> None:
    [file] = tmp_path.rglob("unproven.json")
    file.unlink()
    file.mkdir()
    words = rf"What is to be proven at its next start can't be written down in {file.parent} \(Is a directory\): it is "
    pushed = ok(client.post(f"{route}/push", json={"design": document(ramp__slew_speed_steps_per_s=500)}))
    *_, said, pending = pushed["warnings"]
    assert re.match(words, said)
    assert "are in use. What the controller has stored is proven at its next start" in pending
    device = ok(client.get(route))
    assert device["pushed"]["warnings"] == pushed["warnings"][:-1], "as long as it holds the device tells it"
    [saved] = ok(client.get(f"{route}/backups"))["backups"]
    cable.grbl.settings[110] = cable.grbl.eeprom.settings[110] = 77.0
    assert re.match(words, ok(client.post(f"{route}/backups/{saved['name']}/restore"))["remarks"][-1])
    # Once it can be written it is, also by what changes nothing.
    file.rmdir()
    ok(client.post(f"{route}/push", json={"design": document(), "to_axis": 1}))
    assert not any(re.match(words, said) for said in ok(client.get(route))["pushed"]["warnings"])
    assert "$111" in unproven_file(tmp_path)


def test_a_file_that_makes_no_sense_is_told_and_keeps_nothing_from_being_connected(
    client: TestClient, cable: GrblOnACable, route: str, tmp_path: Path
) -> None:
    [file] = tmp_path.rglob("unproven.json")
    for text in ("", "[1]", '{"$110": 1}', '{"$110": {"value": 1}}', "\udcff"):
        file.write_bytes(text.encode("utf-8", "surrogateescape"))
        device = again(client, cable, route)
        route = f"{DEVICES}/{device['id']}"
        assert (device["unproven"], device["proof"]) == ([], None)
        assert f"was noted in {file}, which can't be read (it is damaged)" in device["message"]
        # Nothing is claimed of what isn't known, and the controller isn't restarted for that.
        assert error_of(client.post(f"{route}/prove"), 409)["message"] == device["message"]
    assert device["message"].endswith("Compare the settings that it has with a backup of this device, or push again.")
    ok(client.post(f"{route}/push", json={"design": document()}))
    device = ok(client.get(route))
    assert (sorted(device["unproven"]), device["message"]) == (GIVEN, None)
    assert sorted(ok(client.post(f"{route}/prove"))["proof"]["proven"]) == GIVEN


@pytest.mark.parametrize("greets_after_s", [None, 0.2])
def test_nothing_is_concluded_of_one_that_goes_on(
    client: TestClient, cable: GrblOnACable, route: str, greets_after_s: float | None
) -> None:
    cable.grbl.starts_on_open, cable.grbl.greets_after_s = False, greets_after_s
    cable.grbl.eeprom.settings[110] = 77.0
    device = again(client, cable, route)
    assert (device["unproven"], device["proof"]) == (GIVEN, None)
    error = error_of(client.post(f"{DEVICES}/{device['id']}/prove"), 409)
    assert "doesn't restart as its port is opened, so nothing is proven yet. What the" in error["message"]
    device = ok(client.get(f"{DEVICES}/{device['id']}"))
    assert (device["state"], device["unproven"], device["proof"]) == ("ready", GIVEN, None)
    cable.grbl.starts_on_open = True
    assert again(client, cable, f"{DEVICES}/{device['id']}")["proof"]["not_kept"] == ["$110"]


def test_a_second_push_is_proven_by_what_it_has_written(client: TestClient, cable: GrblOnACable, route: str) -> None:
    slower = document(ramp__slew_speed_steps_per_s=500)
    ok(client.post(f"{route}/push", json={"design": slower}))
    ok(client.post(f"{route}/push", json={"design": document(), "to_axis": 1}))
    assert set(ok(client.get(route))["unproven"]) == {"$110", "$111", "$120", "$121"}
    assert again(client, cable, route)["proof"]["not_kept"] == []


# A start that is asked for.


def test_it_is_started_anew_and_proven(client: TestClient, cable: GrblOnACable, route: str) -> None:
    ok(client.post(f"{route}/move", json={"by_steps": 60}))
    wait_until(client, route, lambda device: device["position_steps"] == 60 and device["state"] == "ready")
    ok(client.post(f"{route}/position", json={"position_steps": 1000}))
    pushed = ok(client.get(route))["pushed"]
    device = ok(client.post(f"{route}/prove"))
    assert (device["state"], device["unproven"], device["proof"]["proven"]) == ("ready", [], GIVEN)
    # It is the same controller: what was pushed to it stays in view.
    assert (device["pushed"], device["proving"]) == (pushed, False)
    # It has forgotten where it is, and so has StepRamp.
    assert (device["position_steps"], device["unknown_positions"]) == (0, [0, 1, 2])
    assert f"{DEVICES}/{device['id']}" == route
    assert cable.grbl.steps == 60
    error = error_of(client.post(f"{route}/prove"), 409)
    assert error["message"].startswith("Nothing is left to be proven")
    ok(client.post(f"{route}/move", json={"by_steps": 5}))


def test_it_is_started_anew_and_not_proven(client: TestClient, cable: GrblOnACable) -> None:
    route = connected(client, cable.port, "grbl")
    cable.grbl.eeprom.is_worn = True
    ok(client.post(f"{route}/push", json={"design": document()}))
    device = ok(client.post(f"{route}/prove"))
    assert (device["state"], device["proof"]["not_kept"]) == ("ready", GIVEN)
    assert "$110=500.000 where 240.000 was written" in device["message"]


def test_it_is_refused_where_something_moves_or_may(client: TestClient, cable: GrblOnACable, route: str) -> None:
    ok(client.post(f"{route}/move", json={"by_steps": 20_000}))
    assert "moves, that of axis 0: stop it first" in error_of(client.post(f"{route}/prove"), 409)["message"]
    ok(client.post(f"{route}/stop"))
    wait_until(client, route, lambda device: device["state"] == "ready")
    cable.grbl.eeprom.startup[1] = "G1 X5 F100"
    assert "start-up lines ($N)" in error_of(client.post(f"{route}/prove"), 409)["message"]
    cable.grbl.eeprom.startup[1] = ""
    pages = {"X-StepRamp-Page": "a"}, {"X-StepRamp-Page": "b"}
    with client.websocket_connect(f"{DEVICES}/events?page=a", headers=LOCAL):
        ok(client.post(f"{route}/push", json={"design": document()}, headers=pages[0]))
        assert "Another page" in error_of(client.post(f"{route}/prove", headers=pages[1]), 409)["message"]
        assert ok(client.get(route))["unknown_positions"] == []
        assert ok(client.post(f"{route}/prove", headers=pages[0]))["in_control"] == "a"


def test_other_families_say_that_they_cant(client: TestClient) -> None:
    with GrblOnACable(FluidNcEmulator()) as cable:
        route = connected(client, cable.port, "fluidnc")
        error = error_of(client.post(f"{route}/prove"), 409)
    assert "can't be started anew to prove what it has stored: no controller of its family, FluidNC" in error["message"]


def test_one_that_does_not_come_back_is_lost_and_what_is_to_be_proven_stays(
    client: TestClient, cable: GrblOnACable, route: str
) -> None:
    opened = cable.grbl.opened
    cable.grbl.opened = lambda: setattr(cable.grbl, "is_on", False)  # type: ignore[method-assign]
    assert "Nothing answers at" in error_of(client.post(f"{route}/prove"), 502)["message"]
    device = ok(client.get(route))
    assert (device["state"], device["unknown_positions"], device["proving"]) == ("lost", [0, 1, 2], False)
    cable.grbl.opened = opened  # type: ignore[method-assign]
    cable.grbl.power_up()
    connected(client, cable.port, "grbl")
    assert ok(client.get(route))["proof"]["proven"] == GIVEN


def test_a_stop_while_it_is_away_is_owed_and_final(
    client: TestClient, cable: GrblOnACable, route: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It moves as it is there again, as by a pendant: the stop that came while it was away ends that."""
    closed, goes_on = threading.Event(), threading.Event()

    def away(_: float) -> None:
        closed.set()
        assert goes_on.wait(20)

    monkeypatch.setattr(attachment, "sleep", away)
    begun = cable.grbl.opened

    def opened() -> None:
        begun()
        cable.grbl.opened = begun  # type: ignore[method-assign]
        cable.grbl.run_program("G1 X50 F240")

    cable.grbl.opened = opened  # type: ignore[method-assign]
    with ThreadPoolExecutor(1) as pool:
        proven = pool.submit(client.post, f"{route}/prove")
        assert closed.wait(20)
        away = ok(client.get(route))
        assert (away["state"], away["proving"], away["unproven"]) == ("connecting", True, GIVEN)
        assert [axis["state"] for axis in away["axes"]] == ["connecting"] * 3
        assert "prove" in away["capabilities"]
        assert away["pushed"]["verified"]
        known = {"X-StepRamp-Stops": str(ok(client.get(route))["stops"])}
        said = error_of(client.post(f"{route}/stop"), 409)["message"]
        assert "is being restarted to prove what it has stored" in said
        assert said.endswith("It is stopped as soon as it answers.")
        goes_on.set()
        proven.result()
    wait_until(client, route, lambda device: device["state"] in ("ready", "lost"))
    deadline_s = time.monotonic() + PATIENCE_S
    while cable.grbl.is_moving:
        assert time.monotonic() < deadline_s
        time.sleep(0.02)
    steps = cable.grbl.steps
    assert steps < 50 * 250
    # What was asked before it moves nothing, also once it is connected again.
    wait_until(client, route, lambda device: device["state"] == "ready")
    error_of(client.post(f"{route}/move", json={"by_steps": 5}, headers=known), 409)
    time.sleep(0.3)
    assert cable.grbl.steps == steps


def test_what_waits_as_it_is_started_anew_is_told_why(
    client: TestClient, cable: GrblOnACable, route: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks, goes_on, refuse_start = threading.Event(), threading.Event(), GrblController.refuse_start

    def look(controller: GrblController) -> None:
        refuse_start(controller)
        looks.set()
        assert goes_on.wait(20)

    monkeypatch.setattr(GrblController, "refuse_start", look)
    asked = [("push", {"design": document(ramp__slew_speed_steps_per_s=500)}), ("move", {"by_steps": 5})]
    with ThreadPoolExecutor(3) as pool:
        proven = pool.submit(client.post, f"{route}/prove")
        assert looks.wait(20)
        waiting = [pool.submit(client.post, f"{route}/{what}", json=body) for what, body in asked]
        wait_until(client, route, lambda device: device["progress"] is not None)
        time.sleep(0.2)
        goes_on.set()
        for each in waiting:
            said = error_of(each.result(), 409)["message"]
            assert said.endswith(
                "is being restarted to prove what it has stored, which takes some seconds: ask again then."
            )
    assert ok(proven.result())["proof"]["proven"] == GIVEN
    assert ok(client.post(f"{route}/push", json={"design": asked[0][1]["design"]}))["verified"]
    assert cable.grbl.steps == 0
