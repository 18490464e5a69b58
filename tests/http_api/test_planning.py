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
        "ramp_steps": 200,
        "ramp_speed_steps_per_s": 1000,
        "is_lowered": False,
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


def test_a_method_that_can_t_leaves_the_others(client: TestClient) -> None:
    long = document(ramp__acceleration_steps_per_s2=0.05, table=None)
    body = {"design": long, "methods": ["exact", "newton", "table", "first_order"], "max_points": 100}
    answer = client.post("/api/v1/errors", json=body).json()
    assert [each["method"] for each in answer["methods"]] == ["exact", "first_order"]
    newton, table = answer["failures"]
    [error] = newton["errors"]
    assert (newton["method"], error["field"], error["value"]) == ("newton", "design.method.arithmetic", "float32")
    assert error["allowed"].startswith("float64 for this ramp")
    assert (table["method"], table["errors"][0]["field"]) == ("table", "design.table")
    # A row that is less than a tick is the table's fault, whichever the design's own method is.
    short = document(timer__frequency_hz=1000, table={"rows": [[10, 400]]})
    answer = client.post("/api/v1/errors", json={"design": short, "methods": ["exact", "table"]}).json()
    assert [each["method"] for each in answer["methods"]] == ["exact"]
    [[error]] = [each["errors"] for each in answer["failures"]]
    assert (error["field"], error["value"]) == ("design.table.rows.0.1", 400)
    # Without a reference there is nothing to answer.
    refused = client.post("/api/v1/errors", json={"design": short, "methods": ["exact"], "reference": "table"})
    assert [error["field"] for error in refused.json()["errors"]] == ["design.table.rows.0.1"]


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


def test_tuned_says_how_much_better_it_is(client: TestClient) -> None:
    tuning = profile(client, method__name="tuned", ramp__slew_speed_steps_per_s=2000, move__steps=1200,
                     ramp__acceleration_steps_per_s2=4000)["tuning"]  # fmt: skip
    errors = tuning["largest_relative_error"]
    assert errors["tuned"] < 0.04 < errors["compromise"] < errors["second_order"] < errors["first_order"]
    assert abs(tuning["time_error"]["tuned"]) < abs(tuning["time_error"]["first_order"])
    assert 0 < tuning["coefficient_up"] < tuning["coefficient_down"] < 4
    assert profile(client)["tuning"] is None


def test_the_timer_s_resolution_at_slew_speed(client: TestClient) -> None:
    resolution = profile(client, timer__frequency_hz=1e6, ramp__slew_speed_steps_per_s=30_000,
                         ramp__acceleration_steps_per_s2=1e6)["slew_resolution"]  # fmt: skip
    assert resolution == {
        "relative": pytest.approx(0.03),
        "speed_below_steps_per_s": pytest.approx(29_411.76, abs=0.01),
        "speed_above_steps_per_s": pytest.approx(30_303.03, abs=0.01),
    }


def test_curves_are_sent_on_request(client: TestClient) -> None:
    names = ["time_error_s", "method_error_ticks", "arithmetic_error_ticks", "rounding_error_ticks", "tick_error",
             "compression_error_ticks", "position_lag_steps", "implied_acceleration_steps_per_s2"]  # fmt: skip
    body = {"design": document(), "methods": ["newton"], "curves": names, "segment_bound_ticks": 2}
    [curves] = client.post("/api/v1/errors", json=body).json()["methods"]
    assert "relative_error" not in curves
    parts = np.sum([curves[name] for name in names if name.endswith("_error_ticks")], axis=0)
    np.testing.assert_allclose(parts, curves["tick_error"], atol=1e-6)
    assert any(curves["compression_error_ticks"])
    assert curves["landing_error_steps_per_s"] > 0
    refused = client.post("/api/v1/errors", json={**body, "curves": ["magic"]})
    assert refused.json()["errors"][0]["field"] == "curves.0"


def test_more_numbers_than_an_answer_can_hold_are_refused_before_they_are_worked_out(client: TestClient) -> None:
    long = document(move__steps=10_000_000)
    curves = {
        "design": long,
        "methods": ["exact", "newton", "ideal", "tuned"],
        "curves": ["tick_error", "time_error_s"],
    }
    # 4 methods with the steps and two curves each are 12 numbers a point.
    for points in (None, 10_000_000, 8_333_334):
        response = client.post("/api/v1/errors", json={**curves, "max_points": points})
        assert response.status_code == 422
        [error] = response.json()["errors"]
        assert error["field"] == "max_points"
        assert (error["limits"]["lowest"], error["limits"]["highest"]) == (10, 8_333_333)
    # An axis has four numbers a point, and three among the pulses of all: four such moves are just too long.
    four = {"designs": [document(move__steps=3_571_429)] * 4, "mode": "independent"}
    [error] = client.post("/api/v1/schedule", json=four).json()["errors"]
    assert error["field"] == "max_points"
    assert (error["limits"]["lowest"], error["limits"]["highest"]) == (10, 3_571_428)
    assert "more than 100,000,000 numbers" in error["message"]
    assert client.post("/api/v1/schedule", json={**four, "max_points": 1000}).status_code == 200
