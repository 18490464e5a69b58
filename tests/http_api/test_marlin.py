"""A Marlin behind a real pseudo-terminal, over the API: connecting, pushing, moving, stops, a power cut, restoring."""

from __future__ import annotations

import copy
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from controllers.marlin.bench import QUESTIONS
from controllers.marlin.emulator import DEFAULTS, MarlinEmulator, MarlinOnACable
from designs import document
from http_api.families import (
    DEVICES,
    Laws,
    Motor,
    at_rest,
    connected,
    error_of,
    ok,
    stopped_amid_motions,
    wait_until,
)
from stepramp.controllers.marlin import memory


@pytest.fixture
def cable() -> Iterator[MarlinOnACable]:
    with MarlinOnACable() as cable:
        yield cable


@pytest.fixture
def device(client: TestClient, cable: MarlinOnACable) -> str:
    """Return the route of a Marlin with a ramp of 1000 steps/s and 5000 steps/s²."""
    route = connected(client, cable.port, "marlin")
    ok(client.post(f"{route}/push", json={"design": document()}))
    return route


@pytest.fixture
def motor(cable: MarlinOnACable) -> Motor:
    return Motor(lambda: cable.marlin.position[0], lambda: cable.marlin.steps)


class TestOverTheApi(Laws):
    """What holds for a device of every family."""

    jogs_keep_their_speed = "Axes that run keep their speeds: stop them first."


@pytest.mark.parametrize("family", ["marlin", "marlin_250000"])
def test_connecting_asks_and_moves_nothing(client: TestClient, cable: MarlinOnACable, family: str) -> None:
    cable.marlin.boot_s, cable.marlin.chats = 0.8, True
    device = client.get(connected(client, cable.port, family)).json()
    assert (device["family"], device["state"]) == (family, "ready")
    assert device["capabilities"] == ["keep", "try", "line", "backup", "import"]
    assert (device["firmware_version"], device["most_axes"], device["clocks_hz"]) == ("2.1.2.5", 4, [])
    assert [axis["steps_per_mm"] for axis in device["axes"]] == [80, 80, 400, 93]
    assert set(cable.marlin.lines) <= QUESTIONS
    assert (cable.marlin.steps, cable.marlin.eeprom.writes, device["backup"]) == (0, 0, None)


def test_a_backup_is_restored_at_whatever_rate_it_talks(client: TestClient, cable: MarlinOnACable) -> None:
    route = connected(client, cable.port, "marlin")
    client.post(f"{route}/push", json={"design": document()})
    assert client.delete(route).status_code in (200, 204)
    kinds = {each["name"]: each["kind"] for each in client.get("/api/v1/ports").json()["families"]}
    assert (kinds["marlin"], kinds["marlin_250000"], kinds["grbl"]) == ("marlin", "marlin", "grbl")
    [source] = client.get("/api/v1/backups").json()["sources"]
    pushed = dict(cable.marlin.settings)
    route = connected(client, cable.port, "marlin_250000")
    wanted = {"source": source["name"], "name": source["backups"][-1]["name"]}
    restored = client.post(f"{route}/backups/restore", json=wanted)
    assert restored.status_code == 200, restored.text
    assert cable.marlin.settings != pushed


def test_a_push_in_both_terms_and_the_backup_before_it(
    client: TestClient, cable: MarlinOnACable, tmp_path: Path
) -> None:
    route = connected(client, cable.port, "marlin")
    asked = {"design": document(ramp__base_speed_steps_per_s=100)}
    preview = client.post(f"{route}/push/preview", json=asked).json()
    assert preview["items"][0]["own"] == {"term": "M201 X", "unit": "mm/s²", "sent": 62, "on_device": 500}
    assert "Base speed 100 steps/s is not kept: Marlin starts and ends at 120 steps/s." in preview["warnings"]
    assert not (tmp_path / "backups").exists()
    pushed = client.post(f"{route}/push", json=asked).json()
    assert (pushed["verified"], pushed["kept"]) == (True, True)
    assert pushed["items"][1]["own"] == {"term": "M203 X", "unit": "mm/s", "sent": 12.5, "on_device": 12.5}
    [saved] = client.get(f"{route}/backups").json()["backups"]
    assert client.get(route).json()["backup"] == saved["name"]
    text = client.get(f"{route}/backups/{saved['name']}").text
    [file] = tmp_path.rglob("*.txt")
    assert file.read_text() == text
    assert "echo:  M203 X500.00 Y500.00 Z5.00 E25.00" in text.splitlines()
    # Once a connection.
    client.post(f"{route}/push", json={"design": document(), "mode": "try"})
    assert client.get(route).json()["on_trial"]
    assert client.post(f"{route}/roll_back").status_code == 200
    assert len(client.get(f"{route}/backups").json()["backups"]) == 1
    restored = client.post(f"{route}/backups/{saved['name']}/restore")
    assert (restored.status_code, restored.json()["remarks"]) == (200, [])
    assert cable.marlin.eeprom.settings == DEFAULTS


def test_what_cant_be_saved_isnt_written(client: TestClient, cable: MarlinOnACable, tmp_path: Path) -> None:
    route = connected(client, cable.port, "marlin")
    (tmp_path / "backups").write_text("in the way")
    error = error_of(client.post(f"{route}/push", json={"design": document()}), 409)
    assert "nothing was written to it" in error["message"]
    assert (cable.marlin.eeprom.writes, cable.marlin.settings) == (0, DEFAULTS)


def test_a_power_cut_while_it_stores(
    client: TestClient, cable: MarlinOnACable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "STORING_S", 0.4)
    own = copy.deepcopy(DEFAULTS)
    own["M92"]["X"] = 160.0
    cable.marlin.eeprom.settings = copy.deepcopy(own)
    route = connected(client, cable.port, "marlin")
    cable.marlin.dies_at_write = cable.marlin.eeprom.writes + 1
    error_of(client.post(f"{route}/push", json={"design": document()}), 502)
    lost = wait_until(client, route, lambda device: device["state"] == "lost")
    assert f"What it had is saved as {lost['backup']}: restore that." in lost["message"]
    cable.marlin.power_up()
    route = connected(client, cable.port, "marlin")
    assert client.get(route).json()["axes"][0]["steps_per_mm"] == 80
    assert client.post(f"{route}/backups/{lost['backup']}/restore").status_code == 200
    assert cable.marlin.eeprom.settings == own
    assert client.get(route).json()["axes"][0]["steps_per_mm"] == 160


def test_moving_and_stopping(client: TestClient, cable: MarlinOnACable, device: str) -> None:
    moving = client.post(f"{device}/move", json={"by_steps": -300}).json()
    assert (moving["state"], moving["target_steps"]) == ("moving", -300)
    assert at_rest(client, device)["position_steps"] == cable.marlin.position[0] == -300
    client.post(f"{device}/move", json={"to_steps": 9000})
    wait_until(client, device, lambda device: device["position_steps"] > 100)
    assert client.post(f"{device}/stop").json()["state"] in ("stopping", "ready")
    steps = cable.marlin.steps
    rested = at_rest(client, device)
    assert 100 < rested["position_steps"] == cable.marlin.position[0] < 9000
    client.post(f"{device}/line", json={"axes": [{"axis": 0, "by_steps": 50}, {"axis": 1, "by_steps": 20}]})
    at_rest(client, device)
    assert cable.marlin.steps > steps
    assert cable.marlin.position[:2] == [rested["position_steps"] + 50, 20]
    assert client.post(f"{device}/position", json={"position_steps": 0}).json()["position_steps"] == 0


@pytest.mark.parametrize("has_emergency_parser", [False, True])
def test_a_stop_amid_motions_is_final(
    client: TestClient, cable: MarlinOnACable, device: str, has_emergency_parser: bool
) -> None:
    """Several ask for motions at the same time as one stops: once that was answered, nothing sets out."""
    cable.marlin.has_emergency_parser = has_emergency_parser
    for _ in stopped_amid_motions(client, device, turns=2):
        steps = cable.marlin.steps
        time.sleep(0.3)
        assert (cable.marlin.steps, cable.marlin.is_moving) == (steps, False)


def test_what_is_no_marlin_leaves_the_port_usable(client: TestClient) -> None:
    marlin = MarlinEmulator()
    marlin.on_the_way_out = lambda _: b"\x80nonsense\x00"
    with MarlinOnACable(marlin) as cable:
        error = error_of(client.post(DEVICES, json={"port": cable.port, "family": "marlin"}), 409)
        assert "it is no Marlin" in error["message"]
        marlin.on_the_way_out = lambda said: said
        connected(client, cable.port, "marlin")


def test_what_it_really_plays(client: TestClient) -> None:
    asked = {"design": document(), "max_points": 500, "steps_per_mm": 80}
    answer = client.post("/api/v1/families/marlin/ramp", json=asked).json()
    # 2000 / 1000 + 1000 / 5000 s from rest to rest; Marlin begins and ends at 120 steps/s, 2 · 120 / 4960 s less.
    assert answer["planned_duration_s"] == pytest.approx(2.2, abs=0.03)
    assert answer["duration_s"] == pytest.approx(2.15, abs=0.02)
    assert len(answer["step"]) == len(answer["intervals_us"]) == len(answer["relative_error"]) < 600
    assert abs(answer["max_relative_error"]) > 0.05
    assert max(answer["speed_steps_per_s"]) == pytest.approx(2e6 / 2001, rel=1e-4)


def test_starting_from_this_machine(client: TestClient, cable: MarlinOnACable) -> None:
    route = connected(client, cable.port, "marlin")
    read = client.post(f"{route}/import", json={"design": document()}).json()
    assert (read["family"], [axis["name"] for axis in read["axes"]]) == ("marlin", ["X", "Y", "Z", "E"])
    design = read["axes"][1]["design"]
    preview = client.post(f"{route}/push/preview", json={"design": design, "to_axis": 1}).json()
    assert preview["same"]
    assert not any(item["differs"] for item in preview["items"])


def test_a_pasted_listing(client: TestClient) -> None:
    text = "echo:  M92 X80.00 Y80.00\necho:  M203 X50.00 Y60.00\necho:  M201 X200.00 Y300.00\nok\n"
    answer = client.post("/api/v1/import", json={"text": text}).json()
    assert answer["family"] == "marlin"
    assert [axis["design"]["ramp"]["slew_speed_steps_per_s"] for axis in answer["axes"]] == [4000, 4800]
