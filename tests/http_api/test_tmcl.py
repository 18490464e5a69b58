"""A TMCL module behind a real pseudo-terminal, over the API: the whole path, a power cut and its restoring, stops."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from starlette.testclient import TestClient

from controllers.tmcl.emulator import FACTORY, QUESTIONS, ROR, ModuleOnACable, TmclEmulator
from designs import document
from http_api.families import (
    Laws,
    Motor,
    at_rest,
    connected,
    error_of,
    ok,
    stopped_around_motions,
    wait_until,
)

PUSHED = {4: 1048, 5: 42, 17: 42, 19: 0, 20: 10, 15: 42, 16: 0, 18: 42}
"""1000 steps/s and 5000 steps/s² in the chip's units."""


@pytest.fixture
def cable() -> Iterator[ModuleOnACable]:
    module = TmclEmulator()
    module.has_been_up(60)
    with ModuleOnACable(module) as cable:
        yield cable


@pytest.fixture
def device(client: TestClient, cable: ModuleOnACable) -> str:
    """Return the route of a module with a ramp of 1000 steps/s and 5000 steps/s²."""
    route = connected(client, cable.port, "tmcl")
    ok(client.post(f"{route}/push", json={"design": document(), "mode": "try"}))
    return route


@pytest.fixture
def motor(cable: ModuleOnACable) -> Motor:
    return Motor(lambda: cable.module.chip.position, lambda: cable.module.chip.steps)


class TestOverTheApi(Laws):
    """What holds for a device of every family."""


def ramp_of(cable: ModuleOnACable, *, stored: bool = False) -> dict[int, int]:
    motor = cable.module.motors[0]
    return {number: (motor.stored if stored else motor.settings)[number] for number in FACTORY}


def test_the_family_says_what_it_cant_do(client: TestClient) -> None:
    families = client.get("/api/v1/ports").json()["families"]
    [tmcl] = [family for family in families if family["name"] == "tmcl"]
    assert (tmcl["title"], tmcl["plays_own"], tmcl["reads_settings"]) == ("Trinamic TMCL", True, True)
    assert any("Shapes other than constant acceleration" in sentence for sentence in tmcl["cannot"])


def test_connecting_asks_and_moves_nothing(client: TestClient, cable: ModuleOnACable) -> None:
    device = client.get(connected(client, cable.port, "tmcl")).json()
    assert (device["family"], device["state"]) == ("tmcl", "ready")
    assert device["capabilities"] == ["keep", "try", "backup", "import"]
    assert (device["firmware_version"], device["most_axes"], device["clocks_hz"]) == ("1.19", 1, [])
    assert (device["on_trial"], device["message"], device["backup"]) == (False, None, None)
    assert {command[0] for command in cable.module.commands} <= QUESTIONS
    assert cable.module.chip.steps == 0


def test_the_whole_path(client: TestClient, cable: ModuleOnACable) -> None:
    """Connect, difference, push, verify, move, stop, roll back, keep."""
    route = connected(client, cable.port, "tmcl")
    asked = {"design": document(ramp__base_speed_steps_per_s=50)}
    preview = client.post(f"{route}/push/preview", json=asked).json()
    [speed] = [item for item in preview["items"] if item["name"] == "Full speed"]
    # What it comes with, told in whole steps, and what its chip gets.
    chip_speed, chip_acceleration = 16e6 / 2**24, 16e6**2 / 2**41
    assert (speed["on_device"], speed["to_send"], speed["differs"]) == (51_199, 1048 * chip_speed, True)
    assert speed["own"] == {"term": "4 (VMAX)", "unit": "pps", "sent": 999, "on_device": 51_199}
    assert any("140): its steps are sent as microsteps" in warning for warning in preview["warnings"])
    pushed = client.post(f"{route}/push", json={**asked, "mode": "try"}).json()
    assert (pushed["verified"], pushed["kept"]) == (True, False)
    figures = {item["own"]["term"]: (item["requested"], item["sent"], item["read_back"]) for item in pushed["items"]}
    assert figures["5 (AMAX)"] == (5000, 42 * chip_acceleration, 42 * chip_acceleration)
    assert figures["19 (VSTART)"] == figures["20 (VSTOP)"] == (50, 52 * chip_speed, 52 * chip_speed)
    assert client.post(f"{route}/push/preview", json=asked).json()["same"]
    moving = client.post(f"{route}/move", json={"to_steps": 5000}).json()
    assert (moving["state"], moving["target_steps"]) == ("moving", 5000)
    wait_until(client, route, lambda device: device["position_steps"] > 200)
    assert client.post(f"{route}/stop").json()["state"] in ("stopping", "ready")
    rested = at_rest(client, route)
    assert 200 < rested["position_steps"] == cable.module.chip.position < 5000
    assert rested["on_trial"]
    assert not client.post(f"{route}/roll_back").json()["on_trial"]
    assert ramp_of(cable) == FACTORY
    client.post(f"{route}/push", json={"design": document(), "mode": "try"})
    assert not client.post(f"{route}/keep").json()["on_trial"]
    assert ramp_of(cable, stored=True) == PUSHED


def test_moving_halting_and_setting_positions(client: TestClient, cable: ModuleOnACable, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": -300})
    assert at_rest(client, device)["position_steps"] == cable.module.chip.position == -300
    assert client.post(f"{device}/position", json={"position_steps": 7}).json()["position_steps"] == 7
    client.post(f"{device}/move", json={"to_steps": 5000})
    wait_until(client, device, lambda device: device["speed_steps_per_s"] > 500)
    halted = client.post(f"{device}/halt").json()
    assert (halted["state"], cable.module.chip.speed) == ("ready", 0)
    assert halted["position_steps"] == cable.module.chip.position < 5000
    assert ramp_of(cable) == PUSHED


def test_what_a_module_cant_play_names_the_field(client: TestClient, device: str) -> None:
    would_hang = document(ramp__acceleration_steps_per_s2=100)
    for path in ("push", "push/preview"):
        mode = {"mode": "try"} if path == "push" else {}
        error = error_of(client.post(f"{device}/{path}", json={"design": would_hang, **mode}), 422)
        assert (error["field"], error["value"]) == ("design.ramp.acceleration_steps_per_s2", 100)
        assert error["allowed"].startswith("a number from 117 to ")


def test_a_locked_memory_is_told(client: TestClient, cable: ModuleOnACable, device: str) -> None:
    cable.module.is_locked = True
    assert "its EEPROM, is locked" in error_of(client.post(f"{device}/keep"), 409)["message"]
    error = error_of(client.post(f"{device}/push", json={"design": document()}), 409)
    assert "nothing was stored" in error["message"]
    assert client.get(device).json()["on_trial"]


def test_the_backup_before_the_first_write_and_a_power_cut(client: TestClient, cable: ModuleOnACable) -> None:
    route = connected(client, cable.port, "tmcl")
    cable.module.dies_after_stores = 3
    error_of(client.post(f"{route}/push", json={"design": document()}), 502)
    lost = wait_until(client, route, lambda device: device["state"] == "lost")
    assert f"What it had is saved as {lost['backup']}: restore that." in lost["message"]
    cable.module.dies_after_stores = None
    cable.module.power_up()
    assert FACTORY != ramp_of(cable) != PUSHED
    route = connected(client, cable.port, "tmcl")
    text = client.get(f"{route}/backups/{lost['backup']}").text
    assert text.splitlines()[1:3] == ["module TMCM-1276", "firmware 1.19"]
    restored = client.post(f"{route}/backups/{lost['backup']}/restore")
    assert (restored.status_code, restored.json()["remarks"]) == (200, [])
    assert ramp_of(cable) == ramp_of(cable, stored=True) == FACTORY
    # What was there in between is saved, too.
    assert len(client.get(f"{route}/backups").json()["backups"]) == 2


def test_starting_from_this_machine(client: TestClient, device: str) -> None:
    read = client.post(f"{device}/import", json={"design": document()}).json()
    assert (read["family"], [axis["name"] for axis in read["axes"]]) == ("tmcl", ["0"])
    design = read["axes"][0]["design"]
    assert design["axis"]["microsteps"] == 256
    assert client.post(f"{device}/push/preview", json={"design": design}).json()["same"]
    text = client.get(f"{device}/backups/{client.get(device).json()['backup']}").text
    pasted = client.post("/api/v1/import", json={"text": text}).json()
    assert pasted["family"] == "tmcl"


def test_what_it_really_plays(client: TestClient) -> None:
    """2000 steps up to 999.45 steps/s at 4889.4 steps/s²: s / v + v / a; less than a thousandth more for stopping."""
    asked = {"design": document(), "max_points": 500}
    answer = client.post("/api/v1/families/tmcl/ramp", json=asked).json()
    speed, rate = 1048 * 16e6 / 2**24, 42 * 16e6**2 / 2**41
    assert answer["duration_s"] == pytest.approx(2000 / speed + speed / rate, rel=2e-3)
    assert max(answer["speed_steps_per_s"]) == pytest.approx(speed, rel=1e-6)
    assert any("Acceleration 5,000 steps/s² is rounded down to 4,889.4" in loss for loss in answer["losses"])
    backwards = client.post("/api/v1/families/tmcl/ramp", json={"design": document(move__steps=-3)}).json()
    assert backwards["direction"] == -1


def test_a_module_that_is_switched_off_and_on_again_is_lost_and_found(
    client: TestClient, cable: ModuleOnACable, device: str
) -> None:
    client.post(f"{device}/move", json={"by_steps": 40})
    at_rest(client, device)
    cable.module.power_up()
    lost = wait_until(client, device, lambda device: device["state"] == "lost")
    assert "was restarted: its positions are no longer known" in lost["message"]
    again = client.get(connected(client, cable.port, "tmcl")).json()
    assert (again["state"], again["unknown_positions"]) == ("ready", [0])


def test_a_program_in_the_module_is_told_and_ended_by_a_stop(
    client: TestClient, cable: ModuleOnACable, device: str
) -> None:
    cable.module.program = lambda module: module._move(module.motors[0], ROR, 300)
    wait_until(client, device, lambda device: device["state"] == "moving")
    assert client.post(f"{device}/stop").status_code == 200
    at_rest(client, device)
    assert (cable.module.program, cable.module.chip.speed) == (None, 0)


@pytest.mark.parametrize("path", ["move", "run"])
def test_a_stop_at_a_random_moment_around_a_motion_is_final(
    client: TestClient, cable: ModuleOnACable, device: str, path: str
) -> None:
    body = {"move": {"by_steps": 3000}, "run": {"speed_steps_per_s": 900, "for_s": 60}}[path]
    for _ in stopped_around_motions(client, device, path, body):
        assert (cable.module.chip.vmax, cable.module.chip.speed) == (0, 0)
