"""A Klipper behind its server, over the API: connecting, pushing, moving, stopping, restoring, importing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from controllers.klipper.printer import CONFIG, MACROS
from controllers.klipper.server import MoonrakerServer
from designs import document
from http_api.families import DEVICES, at_rest, connected, ok, wait_until
from stepramp.http_api.app import create_app
from stepramp.link.remote_ports import RemotePorts


@pytest.fixture
def server() -> Iterator[MoonrakerServer]:
    with MoonrakerServer() as server:
        yield server
    assert server.moonraker.wrong == []


@pytest.fixture
def client(tmp_path: Path, server: MoonrakerServer) -> Iterator[TestClient]:
    app = create_app(data=tmp_path, remote_ports=RemotePorts.named([server.host]))
    with TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        yield client


@pytest.fixture
def route(client: TestClient, server: MoonrakerServer) -> str:
    return connected(client, server.address, "klipper")


def test_from_connecting_to_restoring(client: TestClient, route: str, server: MoonrakerServer, tmp_path: Path) -> None:
    device = client.get(route).json()
    assert device["capabilities"] == ["keep", "try", "line", "backup", "import"]
    assert [axis["steps_per_mm"] for axis in device["axes"]] == [80, 160, 400]
    design = document(ramp__slew_speed_steps_per_s=8000, ramp__acceleration_steps_per_s2=80_000)
    preview = ok(client.post(f"{route}/push/preview", json={"design": design, "to_axis": 0}))
    assert [item["own"]["term"] for item in preview["items"]] == ["max_velocity", "max_accel"]
    assert list(tmp_path.rglob("*.txt")) == []
    server.printer.files["macros/start.cfg"] += "[fan]\n"
    preview = ok(client.post(f"{route}/push/preview", json={"design": design, "to_axis": 0}))
    assert any(each.endswith("changed since it started, by somebody else.") for each in preview["warnings"])
    server.printer.files["macros/start.cfg"] = MACROS
    report = ok(client.post(f"{route}/push", json={"design": design, "to_axis": 0}))
    assert (report["verified"], report["kept"]) == (True, True)
    [saved] = tmp_path.rglob("*.txt")
    assert "max_velocity: 300" in saved.read_text()
    assert "max_velocity: 100" in server.printer.files["printer.cfg"]
    server.printer.homed = "xyz"
    ok(client.post(f"{route}/move", json={"by_steps": 1600}))
    wait_until(client, route, lambda device: device["axes"][0]["position_steps"] == 9600)
    at_rest(client, route)
    server.printer.has_current = False
    ok(client.post(f"{route}/backups/{saved.stem}/restore"))
    assert server.printer.files["printer.cfg"] == CONFIG
    assert server.printer.velocity == 300


def test_what_is_changed_besides_is_told_with_what_is_kept(client: TestClient, route: str) -> None:
    ok(client.post(f"{route}/push", json={"design": document(), "to_axis": 0, "mode": "try"}))
    forgets = "Klipper forgets these limits when it is restarted."
    tried = ok(client.get(route))["pushed"]
    assert not tried["kept"]
    assert forgets in tried["warnings"]
    kept = ok(client.post(f"{route}/keep"))
    # The report is that of what is stored now.
    assert kept["pushed"]["kept"]
    assert forgets not in kept["pushed"]["warnings"]
    assert set(kept["remarks"]) < set(kept["pushed"]["warnings"])
    copied, lowered, _ = kept["remarks"]
    assert copied.startswith("printer.cfg as it was is printer.cfg.stepramp-")
    assert lowered.startswith("max_z_accel is lowered to 62.5 with max_accel")
    assert not kept["on_trial"]


def test_a_stop_on_the_way(client: TestClient, route: str, server: MoonrakerServer) -> None:
    ok(client.post(f"{route}/push", json={"design": document(), "to_axis": 0, "mode": "try"}))
    ok(client.post(f"{route}/move", json={"by_steps": 8000}))
    wait_until(client, route, lambda device: device["axes"][0]["position_steps"] > 8100)
    ok(client.post(f"{route}/stop"))
    told = len(server.printer.scripts)
    device = wait_until(client, route, lambda device: device["state"] == "ready")
    assert 8100 < device["axes"][0]["position_steps"] < 16_000
    assert len(server.printer.scripts) == told


def test_a_stop_that_is_refused_promises_nothing(client: TestClient, route: str, server: MoonrakerServer) -> None:
    server.printer.prints = "printing"
    answer = client.post(f"{route}/stop")
    [of_all] = ok(client.post(f"{DEVICES}/stop"))["errors"]
    [told] = answer.json()["errors"]
    assert answer.status_code == 409
    assert told["message"] == of_all["message"]
    assert told["message"].endswith("which shuts Klipper down. It isn't told to stop again by itself.")


def test_a_connection_that_ends_on_the_way(client: TestClient, route: str, server: MoonrakerServer) -> None:
    server.moonraker.loses = ["printer.objects.query"]
    device = wait_until(client, route, lambda device: device["state"] == "lost")
    assert "does not answer" in device["message"]


@pytest.mark.parametrize("left", ["", "[include macros/*.cfg]\n[prin", CONFIG[:300]])
def test_a_printer_that_does_not_start_since_its_file_was_cut(
    client: TestClient, route: str, server: MoonrakerServer, tmp_path: Path, left: str
) -> None:
    ok(client.post(f"{route}/backups"))
    before = list(tmp_path.rglob("*.txt"))
    saved = before[0]
    ok(client.delete(route))
    server.printer.files["printer.cfg"] = left
    server.printer.state, server.printer.message = "error", "Unable to parse config file"
    connected = client.post(DEVICES, json={"port": server.address, "family": "klipper"})
    assert connected.status_code == 200, connected.text
    again = f"{DEVICES}/{connected.json()['id']}"
    assert "Unable to parse config file" in client.get(again).text
    for act in ("push", "push/preview"):
        refused = client.post(f"{again}/{act}", json={"design": document(), "to_axis": 0})
        assert refused.status_code == 409, refused.text
        assert "Klipper isn't ready" in refused.json()["errors"][0]["message"]
    ok(client.post(f"{again}/backups/{saved.stem}/restore"))
    assert server.printer.files["printer.cfg"] == CONFIG
    # What was left is saved, too.
    assert len(list(tmp_path.rglob("*.txt"))) == len(before) + 1


def test_a_connection_that_ends_in_mid_move_ends_the_move(
    client: TestClient, route: str, server: MoonrakerServer
) -> None:
    ok(client.post(f"{route}/push", json={"design": document(), "to_axis": 0, "mode": "try"}))
    ok(client.post(f"{route}/move", json={"by_steps": 8000}))
    wait_until(client, route, lambda device: device["axes"][0]["position_steps"] > 8100)
    server.moonraker.loses = ["printer.objects.query"]
    wait_until(client, route, lambda device: device["state"] == "lost")
    told = len(server.printer.scripts)
    # It is connected again by itself, or by whoever asks; what was told by then has come to rest, or does.
    answer = client.post(DEVICES, json={"port": server.address, "family": "klipper"})
    assert answer.status_code == 200, answer.text
    device = wait_until(client, route, lambda device: device["state"] == "ready")
    assert device["axes"][0]["position_steps"] < 16_000
    assert not any("G1" in script for script in server.printer.scripts[told:])


def test_what_it_has_becomes_designs(client: TestClient, route: str) -> None:
    of_device = ok(client.post(f"{route}/import", json={"design": document()}))
    of_text = ok(client.post("/api/v1/import", json={"text": CONFIG, "design": document()}))
    assert of_text["family"] == "klipper"
    assert [axis["name"] for axis in of_device["axes"]] == ["X", "Y", "Z"]
    assert [axis["design"] for axis in of_device["axes"]] == [axis["design"] for axis in of_text["axes"]]


def test_a_configuration_with_a_fan_of_a_highest_speed_is_one(client: TestClient) -> None:
    text = f"{CONFIG}\n[temperature_fan chamber]\nmax_speed: 1.0\n"
    assert ok(client.post("/api/v1/import", json={"text": text}))["family"] == "klipper"


def test_what_it_plays_is_drawn_without_one(client: TestClient) -> None:
    answer = ok(client.post("/api/v1/families/klipper/ramp", json={"design": document(), "steps_per_mm": 80}))
    assert any("Klipper works its intervals out itself" in loss for loss in answer["losses"])


def test_half_a_surrogate_pair_in_what_it_tells_is_told_escaped(client: TestClient, server: MoonrakerServer) -> None:
    server.printer.state, server.printer.message = "error", "bad \ud800 text"
    server.printer.config_file = "/home/pi/printer_data/config/\udfff.cfg"
    device = ok(client.post(DEVICES, json={"port": server.address, "family": "klipper"}))
    assert device["message"] == "Klipper isn't ready: bad \\ud800 text"
    assert ok(client.get(DEVICES))["devices"][0]["message"] == device["message"]
    refused = client.post(f"{DEVICES}/{device['id']}/backups")
    assert refused.status_code == 409, refused.text
    assert "Moonraker doesn't give \\\\udfff.cfg" in refused.text


def test_a_host_that_was_not_named(client: TestClient) -> None:
    answer = client.post(DEVICES, json={"port": "moonraker://127.0.0.1:1", "family": "klipper"})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "port"
