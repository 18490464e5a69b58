import numpy as np
import pytest
from starlette.testclient import TestClient

from designs import document


def profile(client: TestClient, max_points: int | None = None, **changes: object) -> dict:
    response = client.post("/api/v1/profile", json={"design": document(**changes), "max_points": max_points})
    assert response.status_code == 200, response.text
    return response.json()


def test_a_profile_has_every_step_when_no_number_of_points_is_given(client: TestClient) -> None:
    answer = profile(client, move__steps=-500)
    ramp = np.floor(2e6 / np.sqrt(2 * 5000 * np.arange(1, 101)) + 0.5)
    intervals = np.concatenate((ramp, np.full(300, 2000), ramp[::-1]))
    assert answer["step"] == list(range(1, 501))
    assert answer["intervals_ticks"] == intervals.tolist()
    assert answer["position_steps"] == list(range(-1, -501, -1))
    assert answer["time_s"] == pytest.approx(np.concatenate(([0], np.cumsum(intervals)[:-1])) / 2e6)
    assert answer["speed_steps_per_s"] == pytest.approx(2e6 / intervals)
    assert answer["phases"] == [
        {"name": "accelerate", "first_step": 1, "last_step": 100},
        {"name": "slew", "first_step": 101, "last_step": 400},
        {"name": "decelerate", "first_step": 401, "last_step": 500},
    ]
    assert answer["summary"] == {
        "steps": 500,
        "duration_s": pytest.approx(intervals.sum() / 2e6),
        "peak_speed_steps_per_s": 1000,
        "accelerate_steps": 100,
        "slew_steps": 300,
        "decelerate_steps": 100,
    }
    assert answer["warnings"] == []


def test_a_thinned_profile_says_which_steps_it_has(client: TestClient) -> None:
    whole, thin = profile(client, move__steps=30_000), profile(client, 200, move__steps=30_000)
    assert 20 < len(thin["step"]) <= 200
    for name in ("intervals_ticks", "time_s", "position_steps", "speed_steps_per_s"):
        assert thin[name] == [whole[name][step - 1] for step in thin["step"]]
    assert thin["summary"] == whole["summary"]


def test_warnings_name_the_field_of_the_request(client: TestClient) -> None:
    answer = profile(client, move__steps=10, timer__frequency_hz=16_000_000)
    assert {warning["field"] for warning in answer["warnings"]} == {"design.move.steps", "design.timer.counter_bits"}


def test_errors_of_methods(client: TestClient) -> None:
    body = {"design": document(), "methods": ["first_order", "table", "exact"], "reference": "exact"}
    answer = client.post("/api/v1/errors", json=body).json()
    assert answer["reference"] == "exact"
    first_order, table, exact = answer["methods"]
    assert [each["method"] for each in answer["methods"]] == ["first_order", "table", "exact"]
    assert first_order["step"] == list(range(1, 2001))
    assert first_order["relative_error"][1] == pytest.approx(0.5 / 0.5**0.5 - 1, abs=1e-3)
    assert first_order["tick_error"][1] == pytest.approx(10_000 - 20_000 / 2**0.5, abs=0.51)
    assert table["relative_error"][0] == pytest.approx(10_000 / 20_000 - 1)
    assert max(map(abs, exact["tick_error"])) <= 0.5
    for curve in answer["methods"]:
        for name in ("relative_error", "tick_error"):
            largest = curve[f"largest_{name}"]
            assert curve[name][largest["step"] - 1] == largest["value"]
            assert max(map(abs, curve[name])) == abs(largest["value"])


def test_thinned_errors_keep_their_largest(client: TestClient) -> None:
    body = {"design": document(move__steps=50_000), "methods": ["first_order"], "max_points": 100}
    [curve] = client.post("/api/v1/errors", json=body).json()["methods"]
    assert len(curve["step"]) <= 100
    assert curve["largest_relative_error"]["step"] in curve["step"]


def test_examples_can_be_planned(client: TestClient) -> None:
    examples = client.get("/api/v1/examples").json()["examples"]
    assert [example["title"] for example in examples] == ["Lead-screw stage", "Laser-table axis", "Gauge"]
    for example in examples:
        answer = client.post("/api/v1/profile", json={"design": example["design"]}).json()
        assert answer["summary"]["slew_steps"] > 0
        assert answer["warnings"] == []


def test_the_longest_move_is_planned(client: TestClient) -> None:
    answer = profile(client, 2000, move__steps=10_000_000)
    assert answer["summary"]["steps"] == 10_000_000
    assert answer["position_steps"][-1] == 10_000_000


def test_health(client: TestClient) -> None:
    assert client.get("/api/v1/health").json() == {"status": "ok", "version": "0.1.0"}
