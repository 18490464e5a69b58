"""A grbl behind a real pseudo-terminal, over the API: connecting, pushing, moving, stopping, a power cut, restoring."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from controllers.grbl.emulator import Eeprom, GrblEmulator, GrblOnACable
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


@pytest.fixture
def cable() -> Iterator[GrblOnACable]:
    with GrblOnACable() as cable:
        yield cable


@pytest.fixture
def device(client: TestClient, cable: GrblOnACable) -> str:
    """Return the route of a grbl with a ramp of 1000 steps/s and 5000 steps/s²."""
    route = connected(client, cable.port, "grbl")
    ok(client.post(f"{route}/push", json={"design": document()}))
    return route


@pytest.fixture
def motor(cable: GrblOnACable) -> Motor:
    return Motor(lambda: cable.grbl.position[0], lambda: cable.grbl.steps)


class TestOverTheApi(Laws):
    """What holds for a device of every family."""


def test_connecting_asks_and_moves_nothing(client: TestClient, cable: GrblOnACable) -> None:
    cable.grbl.boot_s = 0.5
    device = client.get(connected(client, cable.port, "grbl")).json()
    assert (device["family"], device["state"]) == ("grbl", "ready")
    assert device["capabilities"] == ["keep", "line", "backup", "import", "prove"]
    assert (device["firmware_version"], device["most_axes"], device["clocks_hz"]) == ("1.1h", 3, [])
    assert [axis["steps_per_mm"] for axis in device["axes"]] == [250, 250, 250]
    assert set(cable.grbl.lines) == {"$I", "$$", "$N"}
    assert (cable.grbl.steps, cable.grbl.eeprom.writes, device["backup"]) == (0, 0, None)


def test_a_push_in_both_terms_and_the_backup_before_it(client: TestClient, cable: GrblOnACable, tmp_path: Path) -> None:
    route = connected(client, cable.port, "grbl")
    asked = {"design": document(ramp__base_speed_steps_per_s=100)}
    preview = client.post(f"{route}/push/preview", json=asked).json()
    assert preview["items"][1]["own"] == {"term": "$120", "unit": "mm/s²", "sent": 20, "on_device": 10}
    assert "Base speed 100 steps/s is not kept: grbl starts from 0." in preview["warnings"]
    assert not (tmp_path / "backups").exists()
    pushed = client.post(f"{route}/push", json=asked).json()
    assert (pushed["verified"], pushed["kept"]) == (True, True)
    assert pushed["items"][0]["own"] == {"term": "$110", "unit": "mm/min", "sent": 240, "on_device": 240}
    # As far off as the ramp that is drawn beside the design, with the controller's own 250 steps/mm.
    played = client.post(
        "/api/v1/families/grbl/ramp", json={**asked, "steps_per_mm": 250, "max_points": 100_000}
    ).json()
    planned_us = [
        wait / (1 + error) for wait, error in zip(played["intervals_us"], played["relative_error"], strict=True)
    ]
    off_us = max(abs(wait - plan) for wait, plan in zip(played["intervals_us"], planned_us, strict=True))
    assert pushed["largest_deviation_us"] == preview["largest_deviation_us"] == pytest.approx(off_us, rel=1e-3)
    assert off_us > 100
    [saved] = client.get(f"{route}/backups").json()["backups"]
    assert client.get(route).json()["backup"] == saved["name"]
    [file] = tmp_path.rglob("*.txt")
    text = client.get(f"{route}/backups/{saved['name']}").text
    assert file.read_text() == text
    assert "$120=10.000" in text.splitlines()
    assert "$120=20.000" not in text.splitlines()
    # Once a connection.
    client.post(f"{route}/push", json={"design": document()})
    assert len(client.get(f"{route}/backups").json()["backups"]) == 1
    assert client.post(f"{route}/backups").json()["backups"][0]["name"] > saved["name"]


def test_how_far_a_long_move_is_off_isnt_worked_out_and_that_is_said(client: TestClient, cable: GrblOnACable) -> None:
    route = connected(client, cable.port, "grbl")
    preview = client.post(f"{route}/push/preview", json={"design": document(move__steps=500_001)}).json()
    assert preview["largest_deviation_us"] is None
    assert preview["warnings"][-1] == "How far its delays are from the design's isn't worked out beyond 500,000 steps."


def test_a_backup_that_is_asked_for_writes_nothing_and_says_so(client: TestClient, cable: GrblOnACable) -> None:
    route = connected(client, cable.port, "grbl")
    assert len(client.post(f"{route}/backups").json()["backups"]) == 1

    def lose_power(sent: bytes) -> bytes:
        cable.grbl.is_on = b"$#" not in sent
        return sent

    cable.grbl.on_the_way_in = lose_power
    assert "does not answer" in error_of(client.post(f"{route}/backups"), 502)["message"]
    lost = wait_until(client, route, lambda device: device["state"] == "lost")
    assert "given settings" not in lost["message"]
    assert cable.grbl.eeprom.writes == 0


def test_what_cant_be_saved_isnt_written(client: TestClient, cable: GrblOnACable, tmp_path: Path) -> None:
    route = connected(client, cable.port, "grbl")
    (tmp_path / "backups").write_text("in the way")
    error = error_of(client.post(f"{route}/push", json={"design": document()}), 409)
    assert "can't be saved in" in error["message"]
    assert "nothing was written to it" in error["message"]
    assert cable.grbl.eeprom.writes == 0


def test_restoring(client: TestClient, cable: GrblOnACable, device: str) -> None:
    [saved] = client.get(f"{device}/backups").json()["backups"]
    restored = client.post(f"{device}/backups/{saved['name']}/restore")
    assert restored.status_code == 200, restored.text
    assert cable.grbl.eeprom.settings == Eeprom().settings
    assert any("G28" in remark for remark in restored.json()["remarks"])
    for name in ("2020-01-01", "../secret", "..%2F..%2Fsecret"):
        assert client.post(f"{device}/backups/{name}/restore").status_code == 404


def test_backups_are_read_and_restored_whatever_is_connected(client: TestClient, cable: GrblOnACable) -> None:
    """Also by a server that was started anew, and of a controller that is at another port now."""
    cable.grbl.eeprom.settings |= {100: 80.0, 120: 200.0}
    before = dict(cable.grbl.eeprom.settings)
    route = connected(client, cable.port, "grbl")
    client.post(f"{route}/push", json={"design": document()})
    client.post(f"{route}/backups")
    assert client.delete(route).status_code in (200, 204)
    [source] = client.get("/api/v1/backups").json()["sources"]
    assert (source["family"], len(source["backups"])) == ("grbl", 2)
    oldest = source["backups"][-1]["name"]
    text = client.get(f"/api/v1/backups/{source['name']}/{oldest}").text
    assert "$120=200.000" in text.splitlines()
    for wrong in (f"{source['name']}/2020-01-01", f"grbl-x-1/{oldest}", f"..%2F{source['name']}/{oldest}"):
        assert client.get(f"/api/v1/backups/{wrong}").status_code == 404
    with GrblOnACable(GrblEmulator(eeprom=cable.grbl.eeprom)) as elsewhere:
        route = connected(client, elsewhere.port, "grbl")
        assert client.get(f"{route}/backups").json()["backups"] == []
        wanted = {"source": source["name"], "name": oldest}
        restored = client.post(f"{route}/backups/restore", json=wanted)
        assert restored.status_code == 200, restored.text
        assert elsewhere.grbl.eeprom.settings == before
        # What it had until then is saved, too, as its own.
        assert len(client.get(f"{route}/backups").json()["backups"]) == 1
        error = error_of(client.post(f"{route}/backups/restore", json={**wanted, "name": "nothing"}), 404)
        assert "There is no backup 'nothing'" in error["message"]


def test_a_backup_of_another_family_is_refused(client: TestClient, cable: GrblOnACable, tmp_path: Path) -> None:
    folder = tmp_path / "backups" / "marlin-dev-ttyUSB0-0badcafe"
    folder.mkdir(parents=True)
    (folder / "2026-01-02T03-04-05.000000Z.txt").write_text("M92 X80")
    route = connected(client, cable.port, "grbl")
    wanted = {"source": folder.name, "name": "2026-01-02T03-04-05.000000Z"}
    error = error_of(client.post(f"{route}/backups/restore", json=wanted), 422)
    assert (error["field"], error["value"]) == ("source", folder.name)
    assert error["allowed"] == "a source of the family grbl, as the device is"
    assert cable.grbl.eeprom.writes == 0


def test_a_power_cut_while_it_is_written_to(client: TestClient, cable: GrblOnACable) -> None:
    eeprom = cable.grbl.eeprom
    eeprom.settings |= {100: 80.0, 120: 200.0}
    before = dict(eeprom.settings)
    route = connected(client, cable.port, "grbl")
    eeprom_writes = eeprom.writes
    cable.grbl.dies_at_write = eeprom_writes + 2
    error_of(client.post(f"{route}/push", json={"design": document()}), 502)
    lost = wait_until(client, route, lambda device: device["state"] == "lost")
    assert "some may be new, some old, or its defaults" in lost["message"]
    assert f"What it had is saved as {lost['backup']}: restore that." in lost["message"]
    assert [each["name"] for each in client.get(f"{route}/backups").json()["backups"]] == [lost["backup"]]
    assert eeprom.settings != before
    cable.grbl.power_up()
    route = connected(client, cable.port, "grbl")
    device = client.get(route).json()
    assert (device["state"], device["backup"]) == ("ready", lost["backup"])
    # It isn't as it was only because it is back.
    assert f"saved as {lost['backup']}: restore that." in device["message"]
    # Cut again, in the midst of restoring: what is to be restored is what it had at first, not what it had in between.
    cable.grbl.dies_at_write = eeprom.writes + 2
    error_of(client.post(f"{route}/backups/{lost['backup']}/restore"), 502)
    wait_until(client, route, lambda device: device["state"] == "lost")
    cable.grbl.power_up()
    route = connected(client, cable.port, "grbl")
    assert f"saved as {lost['backup']}: restore that." in client.get(route).json()["message"]
    assert client.post(f"{route}/backups/{lost['backup']}/restore").status_code == 200
    assert client.get(route).json()["message"] is None
    assert eeprom.settings == before
    # What was there in between is saved, too.
    assert len(client.get(f"{route}/backups").json()["backups"]) == 3


def test_cut_twice_what_it_had_at_first_is_to_be_restored(client: TestClient, cable: GrblOnACable) -> None:
    eeprom = cable.grbl.eeprom
    eeprom.settings |= {100: 80.0, 120: 200.0}
    before = dict(eeprom.settings)
    route = connected(client, cable.port, "grbl")
    assert client.get(route).json()["lacks_backup"] is None
    for writes, slew in ((2, 1000), (1, 800)):
        cable.grbl.dies_at_write = eeprom.writes + writes
        design = document(ramp__slew_speed_steps_per_s=slew)
        error_of(client.post(f"{route}/push", json={"design": design}), 502)
        wait_until(client, route, lambda device: device["state"] == "lost")
        cable.grbl.power_up()
        route = connected(client, cable.port, "grbl")
    newest, first = (each["name"] for each in client.get(f"{route}/backups").json()["backups"])
    device = client.get(route).json()
    assert (device["lacks_backup"], device["backup"]) == (first, newest)
    # The newest is of what the first push has left.
    remarks = client.post(f"{route}/backups/{newest}/restore").json()["remarks"]
    assert remarks[-1].endswith(f"Restore {first}, or an older one.")
    device = client.get(route).json()
    assert device["lacks_backup"] == first
    assert f"saved as {first}: restore that." in device["message"]
    remarks = client.post(f"{route}/backups/{first}/restore").json()["remarks"]
    assert not any("still missing" in each for each in remarks)
    device = client.get(route).json()
    assert (device["lacks_backup"], device["message"]) == (None, None)
    assert eeprom.settings == before


def test_moving_stopping_and_halting(client: TestClient, cable: GrblOnACable, device: str) -> None:
    moving = client.post(f"{device}/move", json={"by_steps": -300}).json()
    assert (moving["state"], moving["target_steps"]) == ("moving", -300)
    assert at_rest(client, device)["position_steps"] == cable.grbl.position[0] == -300
    client.post(f"{device}/move", json={"to_steps": 9000})
    wait_until(client, device, lambda device: device["position_steps"] > 100)
    assert client.post(f"{device}/stop").json()["state"] in ("stopping", "ready")
    rested = at_rest(client, device)
    assert 100 < rested["position_steps"] == cable.grbl.position[0] < 9000
    client.post(f"{device}/move", json={"to_steps": 9000})
    wait_until(client, device, lambda device: device["speed_steps_per_s"] > 100)
    halted = client.post(f"{device}/halt").json()
    assert halted["state"] == "ready"
    assert "it was halted while it moved" in halted["message"]
    error = error_of(client.post(f"{device}/move", json={"by_steps": 5}), 409)
    assert "set the position here, which unlocks it" in error["message"]
    assert client.post(f"{device}/position", json={"position_steps": 0}).json()["message"] is None
    one_s_ramp = {"axes": [{"axis": 0, "by_steps": 50}], "ramp_axis": 0}
    assert error_of(client.post(f"{device}/line", json=one_s_ramp), 422)["field"] == "ramp_axis"
    client.post(f"{device}/line", json={"axes": [{"axis": 0, "by_steps": 50}, {"axis": 1, "by_steps": 20}]})
    assert [axis["position_steps"] for axis in at_rest(client, device)["axes"]] == [50, 20, 0]


def test_a_stop_amid_motions_is_final(client: TestClient, cable: GrblOnACable, device: str) -> None:
    """Several ask for motions at the same time as one stops: once that was answered, nothing sets out."""
    for _ in stopped_amid_motions(client, device, turns=4):
        at_rest(client, device)
        steps = cable.grbl.steps
        time.sleep(0.3)
        assert (cable.grbl.steps, cable.grbl.is_moving) == (steps, False)


def test_what_is_no_grbl_leaves_the_port_usable(client: TestClient) -> None:
    grbl = GrblEmulator()
    grbl.banner, grbl.on_the_way_out = "", lambda _: b"\x80nonsense\x00"
    with GrblOnACable(grbl) as cable:
        error = error_of(client.post(DEVICES, json={"port": cable.port, "family": "grbl"}), 409)
        assert "it is no grbl" in error["message"]
        grbl.banner, grbl.on_the_way_out = "Grbl 1.1h ['$' for help]", lambda said: said
        connected(client, cable.port, "grbl")


def test_what_it_really_plays(client: TestClient) -> None:
    asked = {"design": document(), "max_points": 500}
    answer = client.post("/api/v1/families/grbl/ramp", json=asked).json()
    # 2000 / 1000 + 1000 / 5000 s from rest to rest; the step at rest is not waited for.
    assert answer["planned_duration_s"] == pytest.approx(2.2, abs=0.03)
    assert answer["duration_s"] == pytest.approx(2.2, abs=0.03)
    assert len(answer["step"]) == len(answer["intervals_us"]) == len(answer["relative_error"]) < 600
    assert abs(answer["max_relative_error"]) > 0.1
    assert max(answer["speed_steps_per_s"]) == pytest.approx(16e6 / 16_008, rel=1e-4)
    backwards = client.post("/api/v1/families/grbl/ramp", json={"design": document(move__steps=-100)}).json()
    assert backwards["direction"] == -1
    finer = client.post("/api/v1/families/grbl/ramp", json={**asked, "steps_per_mm": 3200}).json()
    assert finer["duration_s"] == pytest.approx(answer["duration_s"], rel=0.01)


@pytest.mark.parametrize(
    ("name", "changes", "status", "words"),
    [
        ("grbll", {}, 404, "There is no family 'grbll'"),
        ("stepramp", {}, 409, "StepRamp plays the planned intervals"),
        ("grbl", {"ramp__acceleration_steps_per_s2": 0.01}, 422, "ramp.acceleration_steps_per_s2 is 0.01"),
        ("grbl", {"move__steps": 5_000_000}, 422, "move.steps is 5000000"),
    ],
)
def test_what_isnt_known_of_a_ramp(
    client: TestClient, name: str, changes: dict[str, object], status: int, words: str
) -> None:
    asked = {"design": document(**changes)}
    assert words in error_of(client.post(f"/api/v1/families/{name}/ramp", json=asked), status)["message"]


def test_starting_from_this_machine(client: TestClient, cable: GrblOnACable) -> None:
    route = connected(client, cable.port, "grbl")
    read = client.post(f"{route}/import", json={"design": document()}).json()
    assert (read["family"], [axis["name"] for axis in read["axes"]]) == ("grbl", ["X", "Y", "Z"])
    design = read["axes"][1]["design"]
    preview = client.post(f"{route}/push/preview", json={"design": design, "to_axis": 1}).json()
    assert preview["same"]
    assert not any(item["differs"] for item in preview["items"])


def test_what_another_controller_tells_in_the_same_text_is_said_to_be_left_out(client: TestClient) -> None:
    grbl = "$100=80.000\n$110=3000.000\n$120=200.000\nok\n"
    marlin = "echo: M92 X80.00\necho: M203 X300.00\necho: M201 X3000.00\nok\n"
    for text in (grbl + marlin, marlin + grbl):
        read = client.post("/api/v1/import", json={"text": text}).json()
        assert read["family"] == "grbl"
        [axis] = read["axes"]
        said = "What Marlin tells is in the text, too, and is left out: bring it on its own."
        assert axis["remarks"][1:] == [said]
    [axis] = client.post("/api/v1/import", json={"text": marlin}).json()["axes"]
    assert not any("left out" in remark for remark in axis["remarks"])


def test_what_another_controller_would_refuse_in_the_same_text_is_said_to_be_left_out(client: TestClient) -> None:
    tic, grbl = "max_speed: fast\nmax_accel: 40000\n", "$100=80.000\n$110=3000.000\n$120=200.000\nok\n"
    read = client.post("/api/v1/import", json={"text": tic + grbl}).json()
    assert read["family"] == "grbl"
    reason = "max_speed is fast; allowed: whole numbers of a Tic's units."
    said = f"What Pololu Tic tells seems to be in the text, too, and is left out: {reason}"
    assert said in read["axes"][0]["remarks"]
    error = error_of(client.post("/api/v1/import", json={"text": tic}), 422)
    assert error["message"] == reason


def test_a_pasted_listing(client: TestClient) -> None:
    text = "Grbl 1.1h ['$' for help]\n$100=80.000\n$110=3000.000\n$120=200.000\nok\n"
    [axis] = client.post("/api/v1/import", json={"text": text}).json()["axes"]
    assert axis["design"]["ramp"]["slew_speed_steps_per_s"] == 4000
    error = error_of(client.post("/api/v1/import", json={"text": "M92 X80"}), 422)
    assert (error["field"], "grbl's lines after $$ ($100=250.000)" in error["allowed"]) == ("text", True)
    # A byte order mark is no part of it.
    [marked] = client.post("/api/v1/import", json={"text": f"\ufeff{text}"}).json()["axes"]
    assert marked["design"] == axis["design"]
    unknown = error_of(client.post("/api/v1/import", json={"text": "\n  Dear all,\nnothing\n" + "x" * 5000}), 422)
    assert unknown["message"].startswith("What begins with 'Dear all,' is nothing that is known; allowed: what a")
    assert len(unknown["message"]) < 400
