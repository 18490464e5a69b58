import numpy as np
import pytest
from starlette.testclient import TestClient

from designs import document


def curves(client: TestClient, methods: list[str], more: dict | None = None, **changes: object) -> dict:
    response = client.post("/api/v1/curves", json={"design": document(**changes), "methods": methods, **(more or {})})
    assert response.status_code == 200, response.text
    return response.json()


def errors_of_request(client: TestClient, body: dict) -> list[dict]:
    response = client.post("/api/v1/curves", json={"design": document(), "methods": ["exact"], **body})
    assert response.status_code == 422, response.text
    return response.json()["errors"]


def whole(client: TestClient, method: str, bound: int | None = None, **changes: object) -> tuple[dict, dict]:
    """Return every step of one method's profile, and of its errors."""
    own = {"method__name": method, "method__arithmetic": "float64"}
    body = {"design": document(**{**changes, **own})}
    names = ["relative_error", "implied_acceleration_steps_per_s2", "method_error_ticks", "arithmetic_error_ticks",
             "rounding_error_ticks", "compression_error_ticks"]  # fmt: skip
    profile = client.post("/api/v1/profile", json=body).json()
    asked = {**body, "methods": [method], "curves": names, "segment_bound_ticks": bound}
    [errors] = client.post("/api/v1/errors", json=asked).json()["methods"]
    return profile, errors


def test_a_short_move_is_whole_but_for_what_is_level(client: TestClient) -> None:
    answer = curves(client, ["exact"], move__steps=-500)
    [exact] = answer["methods"]
    ramp = np.floor(2e6 / np.sqrt(2 * 5000 * np.arange(1, 101)) + 0.5)
    intervals = np.concatenate((ramp, np.full(300, 2000), ramp[::-1]))
    starts = np.concatenate(([0], np.cumsum(intervals)[:-1]))
    # Step 100 of the ramp has the slew interval already, and so has its mirror image.
    kept = [*range(1, 101), *range(401, 501)]
    assert exact["step"] == kept
    assert exact["intervals_ticks"] == [intervals[step - 1] for step in kept]
    assert exact["start_ticks"] == [starts[step - 1] for step in kept]
    assert (answer["timer_hz"], answer["direction"], answer["reference"]) == (2e6, -1, "exact")
    assert exact["summary"]["duration_s"] == pytest.approx(intervals.sum() / 2e6)
    assert exact["phases"][1] == {"name": "slew", "first_step": 101, "last_step": 400}
    assert exact["landing_error_steps_per_s"] == pytest.approx(2e6 / ramp[0])
    # By (6), the most between two delays after the first, which comes from standing still.
    speeds = 2e6 / intervals
    implied = np.diff(speeds**2) / 2
    furthest = int(np.abs(implied).argmax())
    assert exact["peak_acceleration_steps_per_s2"] == {"value": pytest.approx(implied[furthest]), "step": furthest + 2}


def test_lines_between_the_points_are_the_whole_curves(client: TestClient) -> None:
    profile, errors = whole(client, "first_order", move__steps=30_000, ramp__acceleration_steps_per_s2=50)
    changes = {"method__name": "first_order", "move__steps": 30_000, "ramp__acceleration_steps_per_s2": 50}
    [drawn] = curves(client, ["first_order"], {"max_points": 1000}, **changes)["methods"]
    at = np.array(drawn["step"]) - 1
    assert 100 < at.size <= 1500
    assert drawn["intervals_ticks"] == [profile["intervals_ticks"][i] for i in at]
    assert np.array(drawn["start_ticks"]) / 2e6 == pytest.approx(np.array(profile["time_s"])[at])
    error = np.array(errors["relative_error"])
    assert np.array(drawn["relative_error"]) == pytest.approx(error[at], rel=1e-6, abs=1e-9)
    assert {drawn["largest_relative_error"]["step"], int(error.argmax()) + 1, int(error.argmin()) + 1} <= set(at + 1)
    steps = np.arange(30_000)
    between = np.interp(steps, at, drawn["intervals_ticks"]) / np.array(profile["intervals_ticks"]) - 1
    assert np.quantile(np.abs(between), 0.99) < 0.01


def test_a_part_of_a_long_move_gets_the_points(client: TestClient) -> None:
    changes = {"move__steps": 1_000_000, "ramp__acceleration_steps_per_s2": 5}
    more = {"max_points": 400, "first_step": 50_001, "last_step": 50_300}
    [drawn] = curves(client, ["exact"], more, **changes)["methods"]
    steps = set(drawn["step"])
    assert set(range(50_001, 50_301)) <= steps
    assert {1, 1_000_000} <= steps
    assert len(steps) < 700


def test_the_planned_acceleration_and_jerk_come_when_asked_for(client: TestClient) -> None:
    """Of the planned motion no tick is seen: with a coarse timer the implied acceleration leaps, this one does not."""
    changes = {"method__name": "exact", "timer__frequency_hz": 100_000, "ramp__base_speed_steps_per_s": 0}
    [drawn] = curves(client, ["exact"], {"motion": True, "acceleration": True}, **changes)["methods"]
    ramp = document()["ramp"]
    ends = drawn["phases"][0]["last_step"]
    at = [i for i, step in enumerate(drawn["step"]) if step <= ends]
    planned = np.array(drawn["motion"]["acceleration_steps_per_s2"])[at]
    assert planned == pytest.approx(ramp["acceleration_steps_per_s2"], rel=1e-6)
    assert np.ptp(np.array(drawn["implied_acceleration_steps_per_s2"])[at]) > 0.001 * ramp["acceleration_steps_per_s2"]
    assert len(drawn["motion"]["jerk_steps_per_s3"]) == len(drawn["step"])
    [plain] = curves(client, ["exact"])["methods"]
    assert "motion" not in plain


def test_parts_and_implied_acceleration_come_when_asked_for(client: TestClient) -> None:
    more = {"acceleration": True, "parts": True, "segment_bound_ticks": 2, "max_points": 100_000}
    changes = {"method__name": "second_order", "move__steps": 300}
    [drawn] = curves(client, ["second_order"], more, **changes)["methods"]
    _, errors = whole(client, "second_order", 2, move__steps=300)
    at = np.array(drawn["step"]) - 1
    for name, part in drawn["parts"].items():
        assert part == pytest.approx(np.array(errors[f"{name}_error_ticks"])[at], rel=1e-6, abs=1e-4)
    # The rest is as it is planned, without segments.
    _, planned = whole(client, "second_order", move__steps=300)
    assert drawn["largest_relative_error"] == planned["largest_relative_error"]
    acceleration = np.array(planned["implied_acceleration_steps_per_s2"])[at]
    assert drawn["implied_acceleration_steps_per_s2"] == pytest.approx(acceleration, rel=1e-6)
    [plain] = curves(client, ["second_order"])["methods"]
    assert not {"parts", "implied_acceleration_steps_per_s2"} & plain.keys()


def test_a_method_that_does_not_fit_leaves_the_others(client: TestClient) -> None:
    answer = curves(client, ["exact", "table", "newton"], table=None)
    assert [each["method"] for each in answer["methods"]] == ["exact", "newton"]
    [failure] = answer["failures"]
    assert failure["method"] == "table"
    assert failure["errors"][0]["field"] == "design.table"
    assert "a table" in failure["errors"][0]["allowed"]


def test_the_design_s_own_method_may_fail_too(client: TestClient) -> None:
    # In float32 Newton's method goes to infinity over 1.5 million steps.
    own = {"method__name": "newton", "method__arithmetic": "float32", "ramp__acceleration_steps_per_s2": 0.333}
    answer = curves(client, ["exact", "newton", "first_order"], {"max_points": 100}, **own)
    assert [each["method"] for each in answer["methods"]] == ["exact", "first_order"]
    [failure] = answer["failures"]
    [error] = failure["errors"]
    assert (failure["method"], error["field"], error["value"]) == ("newton", "design.method.arithmetic", "float32")


def test_the_design_itself_is_refused_as_everywhere(client: TestClient) -> None:
    for changes in ({"ramp__slew_speed_steps_per_s": -1}, {"method__name": "table", "table": None}):
        body = {"design": document(**changes), "methods": ["exact", "table"]}
        response = client.post("/api/v1/curves", json=body)
        refused = client.post("/api/v1/profile", json={"design": body["design"]})
        assert (response.status_code, response.json()) == (422, refused.json())


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"first_step": 2001}, "first_step"),
        ({"first_step": 5, "last_step": 4}, "last_step"),
        ({"last_step": 2001}, "last_step"),
        ({"first_step": 0}, "first_step"),
        ({"max_points": 9}, "max_points"),
        ({"methods": ["sorted"]}, "methods.0"),
        ({"points": 5}, "points"),
    ],
)
def test_what_can_t_be_drawn_is_named(client: TestClient, body: dict, field: str) -> None:
    assert [error["field"] for error in errors_of_request(client, body)] == [field]


def test_a_million_steps_by_four_methods_are_drawn(client: TestClient) -> None:
    changes = {"move__steps": 1_000_000, "ramp__acceleration_steps_per_s2": 50, "ramp__slew_speed_steps_per_s": 2000}
    answer = curves(client, ["exact", "midpoint", "newton", "table"], **changes)
    for drawn in answer["methods"]:
        assert drawn["summary"]["steps"] == 1_000_000
        assert drawn["step"][-1] == 1_000_000
        assert len(drawn["step"]) <= 4000


def test_a_socket_answers_as_the_route_does(client: TestClient) -> None:
    body = {"design": document(), "methods": ["exact", "newton"], "max_points": 100, "acceleration": True}
    wrong = [{**body, "max_points": 9}, {**body, "design": document(move__steps=0)},
             {**body, "methods": ["table"]}, {**body, "design": document(method__name="table")}]  # fmt: skip
    with client.websocket_connect("/api/v1/curves/socket", headers={"host": "127.0.0.1"}) as socket:
        for asked in (body, *wrong, body):
            socket.send_json(asked)
        for asked in (body, *wrong, body):
            assert socket.receive_json() == client.post("/api/v1/curves", json=asked).json()
        socket.send_text("{")
        [error] = socket.receive_json()["errors"]
        assert error["message"] == "message is '{'; allowed: a JSON object with a design and methods."


def test_answers_over_the_socket_carry_the_id_of_their_question(client: TestClient) -> None:
    body = {"design": document(), "methods": ["exact"], "max_points": 50}
    plain = client.post("/api/v1/curves", json=body).json()
    with client.websocket_connect("/api/v1/curves/socket", headers={"host": "127.0.0.1"}) as socket:
        for number in (0, 7, 2**53 - 1):
            socket.send_json({**body, "id": number})
            assert socket.receive_json() == {"id": number, **plain}
        socket.send_json({**body, "methods": ["none"], "id": 8})
        refused = socket.receive_json()
        assert refused["id"] == 8
        assert refused["errors"][0]["field"] == "methods.0"
        for wrong in (-1, 2**53, 1.5, "1", True):
            socket.send_json({**body, "id": wrong})
            [error] = socket.receive_json()["errors"]
            assert error["field"] == "id"
