"""The stall map over the API: a job from its beginning to its end, and who isn't kept waiting by it."""

from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from motor.trains import LOADED, whole, with_motor
from server_process import ServerProcess
from stepramp.motor.verdict import outcome_of
from waiting import until

PATIENCE_S = 120
MAP = "/api/v1/motor/map"
QUICK = {
    "axis__microsteps": 1, "ramp__slew_speed_steps_per_s": 2000.0, "ramp__acceleration_steps_per_s2": 2e4,
    "move__steps": 600,
}  # fmt: skip
WORST = {"move__steps": 4_000_000, "ramp__acceleration_steps_per_s2": 800.0}


def begun(client: TestClient, **more: Any) -> str:
    answer = client.post(MAP, json={"design": whole(**QUICK), "cells": 8, **more})
    assert answer.status_code == 202, answer.text
    assert answer.headers["location"] == f"/api/v1/jobs/{answer.json()['id']}"
    return answer.headers["location"]


def pictures(client: TestClient, place: str) -> list[dict[str, Any]]:
    """Return all that is told of a job until it has ended."""
    told: list[dict[str, Any]] = []

    def has_ended() -> bool:
        told.append(client.get(place).json())
        return told[-1]["state"] not in ("waiting", "running")

    until(has_ended, PATIENCE_S)
    return told


def test_a_map_grows_to_its_end(client: TestClient) -> None:
    told = pictures(client, begun(client, cells=16))
    progress = [each["progress"] for each in told]
    assert progress == sorted(progress)
    last = told[-1]
    assert (last["kind"], last["state"], last["progress"]) == ("motor_map", "done", 1.0)
    assert "errors" not in last
    found = last["result"]
    assert (found["over"], found["over_unit"], found["over_spacing"]) == ("slew_speed", "steps/s", "ratios")
    assert 81 < found["played"] < 17**2
    assert {len(row) for row in found["verdicts"]} == {17} == {len(found["verdicts"])}
    # Each as the whole move says of the design with these two values.
    words = {"safe": 0, "marginal": 1, "stalls": 2}
    for row, column in ((0, 0), (4, 12), (16, 16), (9, 3)):
        changes = QUICK | {
            "ramp__acceleration_steps_per_s2": found["accelerations_steps_per_s2"][row],
            "ramp__slew_speed_steps_per_s": found["over_values"][column],
        }
        assert found["verdicts"][row][column] == words[outcome_of(with_motor(**changes)).verdict]
    assert found["design_point"] == {"acceleration_steps_per_s2": 2e4, "over_value": 2000.0, "verdict": 0}


def test_over_load_and_voltage_and_with_ranges_of_ones_own(client: TestClient) -> None:
    ends = {"range": [-0.1, 0.5], "accelerations_steps_per_s2": [1e3, 1e6]}
    load = pictures(client, begun(client, over="load", **ends))[-1]["result"]
    assert load["over_values"] == pytest.approx([-0.1 + 0.075 * number for number in range(9)])
    assert load["accelerations_steps_per_s2"] == pytest.approx([10 ** (3 + 3 * number / 8) for number in range(9)])
    assert (load["over_unit"], load["over_spacing"]) == ("Nm", "even")
    # More load than the motor holds, at any acceleration; with none there are some that it makes.
    assert {row[-1] for row in load["verdicts"]} == {2}
    assert 0 in {row[1] for row in load["verdicts"]}
    volts = pictures(client, begun(client, over="supply_voltage", range=[6, 48]))[-1]["result"]
    assert volts["over_values"] == pytest.approx([6 * 8 ** (number / 8) for number in range(9)])
    assert (volts["over_unit"], volts["over_spacing"]) == ("V", "ratios")


def test_the_same_question_is_computed_once(client: TestClient) -> None:
    place = begun(client)
    found = pictures(client, place)[-1]["result"]
    for same in (begun(client), begun(client, design=whole(**QUICK, name="another name"))):
        assert same != place
        told = client.get(same).json()
        assert (told["state"], told["result"]) == ("done", found)
    other = pictures(client, begun(client, over="load"))[-1]
    assert (other["state"], other["result"]["over"]) == ("done", "load")
    assert other["result"]["verdicts"] != found["verdicts"]


def test_who_ends_a_job_ends_nobody_elses(client: TestClient) -> None:
    """Two clients ask the same of a map that takes long; each has a job of its own."""
    mine, yours = begun(client, cells=128), begun(client, cells=128)
    assert client.delete(mine).json()["state"] == "cancelled"
    assert client.get(yours).json()["state"] in ("waiting", "running")
    assert client.delete(yours).json()["state"] == "cancelled"


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"design": whole(motor=None)}, "design.motor", "a motor"),
        ({"design": whole(load=LOADED | {"mass_kg": 1})}, "design.load.mass_kg", "no such field"),
        ({"over": "microsteps"}, "over", "slew_speed, load, supply_voltage"),
        ({"cells": 24}, "cells", "8, 16, 32, 64 or 128"),
        ({"cells": 256}, "cells", "from 8 to 128 cells, a power of two"),
        ({"range": [1, 2, 3]}, "range", "two numbers, the least and the most"),
        ({"range": [3e3, 2e3]}, "range.1", "more than 3,000"),
        ({"range": [3e3, 2e6]}, "range.1", "from 0.001 to 1,000,000 steps/s"),
        ({"over": "supply_voltage", "range": [0.1, 9]}, "range.0", "from 0.5 to 1,000 V"),
        ({"accelerations_steps_per_s2": [0, 1e4]}, "accelerations_steps_per_s2.0", "steps/s²"),
        ({"accelerations_steps_per_s2": [1e5, 1e5]}, "accelerations_steps_per_s2.1", "more than 100,000"),
    ],
)
def test_nonsense_is_refused_by_name(client: TestClient, changes: dict[str, Any], field: str, allowed: str) -> None:
    answer = client.post(MAP, json={"design": whole(), **changes})
    assert answer.status_code == 422
    [error] = answer.json()["errors"]
    assert error["field"] == field
    assert allowed in error["allowed"]


def test_the_worst_map_keeps_neither_a_profile_nor_a_stop_waiting_and_is_cancelled() -> None:
    """In a server of its own: 128 cells of a move of 10,000,000 steps, twice."""
    with ServerProcess(8700) as server:
        device = server.ask("POST", "devices", {"port": "sim://"})["id"]
        jobs = []
        for name in ("slew_speed", "load"):
            status, started = server.answer("POST", "motor/map", {"design": whole(**WORST), "over": name, "cells": 128})
            assert status == 202, started
            jobs.append(started["id"])
        until(lambda: all(server.ask("GET", f"jobs/{job}")["state"] == "running" for job in jobs), PATIENCE_S)
        assert server.ask("POST", "profile", {"design": document(), "max_points": 100})["phases"]
        assert server.ask("POST", f"devices/{device}/stop")["state"] == "ready"
        for job in jobs:
            assert server.ask("DELETE", f"jobs/{job}")["state"] == "cancelled"
            assert server.ask("DELETE", f"jobs/{job}")["state"] == "cancelled"
        # Their threads are free again: another one comes to its end.
        status, started = server.answer("POST", "motor/map", {"design": whole(**QUICK), "cells": 8})
        until(lambda: server.ask("GET", f"jobs/{started['id']}")["state"] == "done", PATIENCE_S)
