"""A Pololu Tic behind a real pseudo-terminal, over the API: connecting, pushing, moving, stopping, unplugging."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient

from controllers.tic.emulator import HALTED, READ, VELOCITY, TicEmulator, TicOnACable
from designs import document
from http_api.families import (
    DEVICES,
    Laws,
    Motor,
    at_rest,
    connected,
    error_of,
    ok,
    stopped_around_motions,
    wait_until,
)


@pytest.fixture
def cable() -> Iterator[TicOnACable]:
    tic = TicEmulator()
    tic.has_been_up(60)
    with TicOnACable(tic) as cable:
        yield cable


@pytest.fixture
def device(client: TestClient, cable: TicOnACable) -> str:
    """Return the route of a Tic with a ramp of 1000 steps/s and 5000 steps/s²."""
    route = connected(client, cable.port, "tic")
    ok(client.post(f"{route}/push", json={"design": document(), "mode": "try"}))
    return route


@pytest.fixture
def motor(cable: TicOnACable) -> Motor:
    return Motor(lambda: cable.tic.position, lambda: cable.tic.steps)


class TestOverTheApi(Laws):
    """What holds for a device of every family."""


def test_the_family_is_listed(client: TestClient) -> None:
    families = client.get("/api/v1/ports").json()["families"]
    [tic] = [family for family in families if family["name"] == "tic"]
    assert (tic["title"], tic["plays_own"]) == ("Pololu Tic", True)
    assert any(
        sentence.startswith("Storing a ramp: a Tic takes settings to keep over its USB port only")
        for sentence in tic["cannot"]
    )


def test_connecting_asks_and_moves_nothing(client: TestClient, cable: TicOnACable) -> None:
    device = client.post(DEVICES, json={"port": cable.port, "family": "tic"}).json()
    assert (device["family"], device["state"], device["capabilities"]) == (
        "tic",
        "ready",
        ["try", "zero", "backup", "import"],
    )
    assert (device["clocks_hz"], device["timer_hz"], device["firmware_version"]) == ([], None, None)
    assert (device["on_trial"], device["motors_on"], device["message"], device["starved"]) == (False, False, None, None)
    assert device["most_axes"] == 1
    assert {command[0] for command in cable.tic.commands} <= READ
    assert not cable.tic.energized


def test_pushing(client: TestClient, cable: TicOnACable, device: str) -> None:
    assert cable.tic.ramp == [0, 10_000_000, 500_000, 500_000]
    pushed = client.get(device).json()["pushed"]
    assert (pushed["verified"], pushed["kept"], pushed["segments"]) == (True, False, None)
    # The first step of 5000 steps/s² takes √(2/a); the design's ramp has 1/√(2a), as all its methods do.
    assert pushed["largest_deviation_us"] == pytest.approx(10_000, rel=0.01)
    figures = {"requested": 1000, "sent": 1000, "read_back": 1000}
    own = {"term": "Max speed", "unit": "steps/10,000 s", "sent": 10_000_000, "on_device": 10_000_000}
    assert {"name": "Full speed", "unit": "steps/s", "axis": 0, "own": own, **figures} in pushed["items"]
    assert "The method Exact is not kept: a Tic works its intervals out itself." in pushed["warnings"]
    assert (pushed["sequence"], client.get(device).json()["ramp"]["sequence"]) == (None, None)
    slower = {"design": document(ramp__slew_speed_steps_per_s=300)}
    preview = client.post(f"{device}/push/preview", json=slower).json()
    assert [item["name"] for item in preview["items"] if item["differs"]] == ["Full speed"]
    assert client.get(device).json()["on_trial"]
    assert not client.post(f"{device}/roll_back").json()["on_trial"]
    assert cable.tic.ramp == [0, 2_000_000, 40_000, 40_000]


def test_its_microsteps_are_told_and_no_move_is_made_by_others(
    client: TestClient, cable: TicOnACable, device: str
) -> None:
    """Whoever reckons a way in mm does so by what was told."""
    assert client.get(device).json()["axes"][0]["microsteps"] == 1
    ok(client.post(f"{device}/move", json={"by_steps": 100}))
    at_rest(client, device)
    cable.tic.step_mode = 4
    assert (
        "makes 16 steps of a full step"
        in error_of(client.post(f"{device}/move", json={"by_steps": 100}), 409)["message"]
    )
    told = wait_until(client, device, lambda device: device["axes"][0]["microsteps"] == 16)
    assert (cable.tic.position, told["axes"][0]["position_steps"]) == (100, 100)
    assert "Set the position here." in told["message"]
    ok(client.post(f"{device}/position", json={"position_steps": 0}))
    ok(client.post(f"{device}/move", json={"by_steps": 160}))
    assert at_rest(client, device)["position_steps"] == cable.tic.position == 160


def test_starting_from_this_machine(client: TestClient, cable: TicOnACable, device: str) -> None:
    """A push of what was read changes nothing."""
    cable.tic.step_mode = 4
    read = client.post(f"{device}/import", json={"design": document()}).json()
    assert (read["family"], [axis["name"] for axis in read["axes"]]) == ("tic", ["Tic"])
    design = read["axes"][0]["design"]
    assert (design["axis"]["microsteps"], design["ramp"]["slew_speed_steps_per_s"]) == (16, 1000)
    assert client.post(f"{device}/push/preview", json={"design": design}).json()["same"]


def test_the_backup_before_the_first_write_and_a_cable_cut_in_the_midst(client: TestClient, cable: TicOnACable) -> None:
    """The Tic has a supply of its own: what had arrived of the push it still has."""
    route, new = connected(client, cable.port, "tic"), cable.tic.ramp
    is_cut = False

    def cut(sent: bytes) -> bytes:
        nonlocal is_cut
        before, acceleration, _ = sent.partition(b"\xea")
        arrives = b"" if is_cut else before
        is_cut = is_cut or bool(acceleration)
        return arrives

    cable.tic.on_the_way_in = cut
    error_of(client.post(f"{route}/push", json={"design": document(), "mode": "try"}), 502)
    lost = wait_until(client, route, lambda device: device["state"] == "lost")
    assert f"What it had is saved as {lost['backup']}: restore that." in lost["message"]
    assert cable.tic.ramp == [0, 10_000_000, *new[2:]]
    cable.tic.on_the_way_in = lambda sent: sent
    route = connected(client, cable.port, "tic")
    restored = client.post(f"{route}/backups/{lost['backup']}/restore")
    assert (restored.status_code, restored.json()["remarks"]) == (200, [])
    assert cable.tic.ramp == new == [0, 2_000_000, 40_000, 40_000]
    # What was there in between is saved, too.
    assert len(client.get(f"{route}/backups").json()["backups"]) == 2


def test_what_it_really_plays(client: TestClient) -> None:
    answer = client.post("/api/v1/families/tic/ramp", json={"design": document()}).json()
    # 2000 / 1000 + 1000 / 5000 s.
    assert answer["duration_s"] == pytest.approx(2.2, abs=0.01)
    assert answer["duration_s"] == pytest.approx(answer["planned_duration_s"], abs=0.03)
    assert answer["losses"][-1].startswith("At which instants a Tic works its speed out anew isn't published")


def test_a_settings_file(client: TestClient) -> None:
    text = "# Pololu Tic USB Stepper Controller settings file.\nproduct: T825\nmax_speed: 2000000\nmax_accel: 40000\n"
    answer = client.post("/api/v1/import", json={"text": text}).json()
    assert (answer["family"], answer["axes"][0]["design"]["ramp"]["slew_speed_steps_per_s"]) == ("tic", 200)


def test_a_backup_is_a_settings_file_with_all_that_the_tic_keeps(
    client: TestClient, cable: TicOnACable, device: str
) -> None:
    cable.tic.command_timeout_ms = 2000
    name = ok(client.post(f"{device}/backups"))["backups"][0]["name"]
    [source] = [each["name"] for each in ok(client.get("/api/v1/backups"))["sources"] if each["family"] == "tic"]
    text = client.get(f"/api/v1/backups/{source}/{name}").text
    lines = text.splitlines()
    assert lines[0].startswith("# StepRamp backup, CRC-32 ")
    assert {"command_timeout: 2000", "max_speed: 2000000", "# in use: max_speed: 10000000"} <= set(lines)
    for file in (text, text.replace("#T834 ", "")):
        answer = ok(client.post("/api/v1/import", json={"text": file}))
        assert (answer["family"], answer["axes"][0]["design"]["ramp"]["slew_speed_steps_per_s"]) == ("tic", 1000)
    cable.tic.command_timeout_ms = 3000
    [remark, _] = ok(client.post(f"{device}/backups/{name}/restore"))["remarks"]
    assert "command_timeout 3000 (in the backup 2000). ticcmd --settings FILE or the Tic Control Center" in remark


def test_what_a_tic_cant_play_names_the_field(client: TestClient, device: str) -> None:
    too_fast = document(ramp__slew_speed_steps_per_s=50_001)
    for path in ("push", "push/preview"):
        mode = {"mode": "try"} if path == "push" else {}
        error = error_of(client.post(f"{device}/{path}", json={"design": too_fast, **mode}), 422)
        assert (error["field"], error["value"]) == ("design.ramp.slew_speed_steps_per_s", 50_001)
        assert error["allowed"] == "at most 50,000 steps/s with a Tic"


@pytest.mark.parametrize(
    ("method", "path", "body", "words"),
    [
        ("POST", "push", {"design": document()}, "store ramps"),
        ("POST", "keep", None, "store ramps"),
        ("POST", "restore", None, "bring back the ramps that it had before"),
        ("GET", "settings", None, "be given settings"),
        ("PUT", "settings", {}, "be given settings"),
        ("POST", "line", {"axes": [{"axis": 0, "by_steps": 5}]}, "move axes along a straight line"),
        ("PUT", "trace", {"traced_axis": 0}, "trace moves"),
        ("GET", "trace", None, "trace moves"),
    ],
)
def test_what_a_tic_cant_do_is_refused(
    client: TestClient, device: str, method: str, path: str, body: Any, words: str
) -> None:
    error = error_of(client.request(method, f"{device}/{path}", json=body), 409)
    assert f"can't {words}: no controller of its family, Pololu Tic, can." in error["message"]


def test_moving_further_than_its_timeout_lasts(client: TestClient, cable: TicOnACable, device: str) -> None:
    moving = client.post(f"{device}/move", json={"by_steps": -1800}).json()
    assert (moving["state"], moving["target_steps"], moving["motors_on"]) == ("moving", -1800, True)
    rested = at_rest(client, device)
    assert rested["position_steps"] == cable.tic.position == -1800
    assert rested["message"] is None
    assert client.post(f"{device}/position", json={"position_steps": 7}).json()["position_steps"] == 7
    client.post(f"{device}/zero", json={"steps": 30})
    assert at_rest(client, device)["position_steps"] == 0


def test_stopping(client: TestClient, cable: TicOnACable, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 5000})
    wait_until(client, device, lambda device: device["position_steps"] > 200)
    stopping = client.post(f"{device}/stop").json()
    assert stopping["state"] in ("stopping", "ready")
    rested = at_rest(client, device)
    assert 200 < rested["position_steps"] == rested["target_steps"] == cable.tic.position < 5000
    client.post(f"{device}/move", json={"to_steps": 5000})
    assert client.post(f"{device}/halt").json()["state"] == "ready"
    assert cable.tic.velocity == 0


def test_what_keeps_it_from_moving_is_told(client: TestClient, cable: TicOnACable, device: str) -> None:
    cable.tic.press("low_vin")
    error = error_of(client.post(f"{device}/move", json={"by_steps": 5}), 409)
    assert error["message"].startswith("The Tic can't move: the supply of its motor is off or too low")
    told = wait_until(client, device, lambda device: device["message"] is not None)
    assert (told["message"], told["state"]) == (error["message"], "ready")
    cable.tic.press("low_vin", False)
    client.post(f"{device}/move", json={"by_steps": 5})
    assert at_rest(client, device)["message"] is None


def test_a_tic_that_is_switched_off_and_on_again_is_lost_and_found(
    client: TestClient, cable: TicOnACable, device: str
) -> None:
    client.post(f"{device}/move", json={"by_steps": 40})
    at_rest(client, device)
    cable.tic.power_up()
    lost = wait_until(client, device, lambda device: device["state"] == "lost")
    assert "was restarted: its position is no longer known" in lost["message"]
    steps = cable.tic.steps
    again = client.post(DEVICES, json={"port": cable.port, "family": "tic"}).json()
    assert (again["state"], again["on_trial"], again["unknown_positions"]) == ("ready", False, [0])
    assert cable.tic.steps == steps


def test_a_tic_is_no_stepramp_controller_nor_the_other_way_round(client: TestClient, cable: TicOnACable) -> None:
    refused = error_of(client.post(DEVICES, json={"port": "sim://", "family": "tic"}), 422)
    assert (refused["field"], refused["value"], refused["allowed"]) == ("family", "tic", "stepramp")
    assert client.get(DEVICES).json() == {"devices": []}
    assert client.post(DEVICES, json={"port": cable.port, "family": "tic"}).status_code == 200
    assert "disconnect it first" in error_of(client.post(DEVICES, json={"port": cable.port}), 409)["message"]


@pytest.mark.parametrize("path", ["move", "run", "zero"])
def test_a_stop_at_a_random_moment_around_a_motion_is_final(
    client: TestClient, cable: TicOnACable, device: str, path: str
) -> None:
    """Though the Tic's own precautions against what it was told before are switched off."""
    cable.tic.disable_safe_start = True
    body = {"move": {"by_steps": 3000}, "run": {"speed_steps_per_s": 900, "for_s": 60}, "zero": {"steps": 2000}}[path]
    for _ in stopped_around_motions(client, device, path, body):
        assert cable.tic.told in ((VELOCITY, 0), (HALTED, 0))
        assert cable.tic.velocity == 0
