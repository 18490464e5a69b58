from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from designs import design, document
from stepramp.http_api.schedule_models import ScheduleAnswer
from stepramp.ramp.profile import profile_of


def post(client: TestClient, designs: object, mode: object = "line", **more: object) -> dict[str, Any]:
    response = client.post("/api/v1/schedule", json={"designs": designs, "mode": mode, **more})
    assert response.status_code == 200, response.text
    answer: dict[str, Any] = response.json()
    ScheduleAnswer.model_validate(answer, extra="forbid")
    return answer


def rejection(client: TestClient, body: object) -> dict[str, Any]:
    response = client.post("/api/v1/schedule", json=body)
    assert response.status_code == 422, response.text
    [error] = response.json()["errors"]
    assert {"field", "value", "allowed", "message"} <= set(error)
    assert error["field"] in error["message"]
    return error


def test_independent_axes(client: TestClient) -> None:
    changes = [{"name": "X", "move__steps": 300}, {"name": "Y", "move__steps": -20, "timer__frequency_hz": 1e6}]
    answer = post(client, [document(**each) for each in changes], "independent")
    profiles = [profile_of(design(**each)) for each in changes]
    for axis, profile, change in zip(answer["axes"], profiles, changes, strict=True):
        assert axis["name"] == change["name"]
        assert axis["direction"] * axis["steps"] == change["move__steps"]
        assert axis["duration_s"] == profile.duration_s
        assert axis["pulses"]["step"] == list(range(1, axis["steps"] + 1))
        for name in ("time_s", "position_steps", "speed_steps_per_s"):
            assert axis["pulses"][name] == pytest.approx(getattr(profile, name).tolist())
    schedule = answer["schedule"]
    assert schedule["time_s"] == sorted(np.concatenate([profile.time_s for profile in profiles]).tolist())
    assert len(schedule["axis"]) == len(schedule["position_steps"]) == 320
    assert answer["duration_s"] == profiles[0].duration_s
    assert (answer["leader"], answer["limits"]) == (None, [])
    assert [warning["field"] for warning in answer["warnings"]] == ["designs.1.move.steps"]


def test_conflicts_are_pairs_of_pulses_with_their_gap(client: TestClient) -> None:
    # Both begin at 0 and slew at once, with intervals of 1,000 and 1,015 µs.
    slews = {"ramp__base_speed_steps_per_s": 1000, "timer__frequency_hz": 1e6, "move__steps": 3}
    later = slews | {"ramp__base_speed_steps_per_s": 1e6 / 1015, "ramp__slew_speed_steps_per_s": 1e6 / 1015}
    designs = [document(**slews), document(**later)]
    assert post(client, designs, "independent")["conflicts"] == {
        "count": 1,
        "first": [{"time_s": 0.001, "axes": [0, 1], "gap_us": pytest.approx(15)}],
    }
    assert post(client, designs, "independent", shortest_spacing_us=15)["conflicts"]["count"] == 0
    assert post(client, designs, "independent", shortest_spacing_us=31)["conflicts"]["count"] == 2
    assert post(client, designs)["conflicts"]["count"] == 0


def test_a_line_tells_who_leads_and_what_limits_it(client: TestClient) -> None:
    slow = document(name="Y", ramp__slew_speed_steps_per_s=100, move__steps=-500)
    answer = post(client, [slow, document(name="X", move__steps=1000)])
    assert answer["leader"] == 1
    assert answer["limits"] == [
        {
            "field": "designs.0.ramp.slew_speed_steps_per_s",
            "axis": 0,
            "message": "Y (axis 0) allows a slew speed of 100 steps/s: "
            "along the line that of X (axis 1) is 200 steps/s instead of 1,000 steps/s.",
            "told": [
                {"text": f"{value:,} steps/s", "value": value, "unit": "steps/s", "rounding": "nearest", "axis": axis}
                for value, axis in ((100, 0), (200, 1), (1000, 1))
            ],
        }
    ]
    follower, leader = answer["axes"]
    assert set(follower["pulses"]["time_s"]) <= set(leader["pulses"]["time_s"])
    assert follower["pulses"]["position_steps"] == list(range(-1, -501, -1))
    assert max(follower["pulses"]["speed_steps_per_s"]) == 100
    assert follower["duration_s"] == leader["duration_s"] == answer["duration_s"]


@pytest.mark.parametrize("mode", ["independent", "line"])
def test_a_thinned_schedule_counts_all_conflicts(client: TestClient, mode: str) -> None:
    designs = [
        document(move__steps=30_000),
        document(move__steps=29_000, ramp__acceleration_steps_per_s2=5100),
        document(move__steps=12),
    ]
    whole = post(client, designs, mode, shortest_spacing_us=300)
    thin = post(client, designs, mode, shortest_spacing_us=300, max_points=200)
    assert thin["conflicts"] == whole["conflicts"]
    assert sum(len(axis["pulses"]["step"]) for axis in thin["axes"]) == len(thin["schedule"]["time_s"]) < 500
    for thinned, every in zip(thin["axes"], whole["axes"], strict=True):
        steps = thinned["pulses"]["step"]
        assert (steps[0], steps[-1]) == (1, every["steps"])
        for name, values in thinned["pulses"].items():
            assert values == [every["pulses"][name][step - 1] for step in steps]
    assert thin["axes"][2] == whole["axes"][2]
    merged = [*zip(*(thin["schedule"][name] for name in ("time_s", "axis", "position_steps")), strict=True)]
    assert merged == sorted(
        (time, number, position)
        for number, axis in enumerate(thin["axes"])
        for time, position in zip(axis["pulses"]["time_s"], axis["pulses"]["position_steps"], strict=True)
    )


def test_one_axis_is_a_line_of_its_own(client: TestClient) -> None:
    answer = post(client, [document()])
    assert (answer["leader"], answer["limits"], answer["conflicts"]["count"]) == (0, [], 0)


@pytest.mark.parametrize(("number", "mode"), [(0, "line"), (5, "line"), (0, "independent"), (5, "independent")])
def test_too_few_or_too_many_designs_are_refused(client: TestClient, number: int, mode: str) -> None:
    error = rejection(client, {"designs": [document()] * number, "mode": mode})
    assert (error["field"], error["value"]) == ("designs", f"{number} items")
    assert error["allowed"] == "a list of 1 to 4 designs"


@pytest.mark.parametrize(
    ("change", "field", "value", "allowed"),
    [
        ({"designs": document()}, "designs", None, "a list of 1 to 4 designs"),
        ({"designs": "x"}, "designs", "x", "a list of 1 to 4 designs"),
        ({"designs": [document(), 5]}, "designs.1", 5, "an object with named fields"),
        ({"designs": [document(), document(move__steps=0)]}, "designs.1.move.steps", 0, "but not 0"),
        ({"mode": "circle"}, "mode", "circle", "independent, line"),
        ({"mode": None}, "mode", None, "independent, line"),
        ({"max_points": 9}, "max_points", 9, "from 10 to 10,000,000 points"),
        ({"shortest_spacing_us": -1}, "shortest_spacing_us", -1, "from 0 to 1,000,000 µs"),
        ({"shortest_spacing_us": "20"}, "shortest_spacing_us", "20", "from 0 to 1,000,000 µs"),
        ({"spacing": 20}, "spacing", 20, "nothing; there is no such field"),
    ],
)
def test_a_rejection_names_field_value_and_what_is_allowed(
    client: TestClient, change: dict[str, object], field: str, value: object, allowed: str
) -> None:
    error = rejection(client, {"designs": [document()], "mode": "line"} | change)
    assert error["field"] == field
    assert value is None or error["value"] == value
    assert allowed in error["allowed"]


def test_a_mode_is_needed(client: TestClient) -> None:
    error = rejection(client, {"designs": [document()]})
    assert (error["field"], error["allowed"]) == ("mode", "a value; this field is required")


@pytest.mark.parametrize("mode", ["independent", "line"])
def test_rejections_that_the_numerics_make_have_the_path_of_the_design(client: TestClient, mode: str) -> None:
    weak = document(ramp__acceleration_steps_per_s2=1e-6)
    error = rejection(client, {"designs": [document(), weak], "mode": mode})
    assert (error["field"], error["value"]) == ("designs.1.ramp.acceleration_steps_per_s2", 1e-6)


def test_every_field_is_described(client: TestClient) -> None:
    schemas = client.get("/api/v1/openapi.json").json()["components"]["schemas"]
    for name in ("SchedulePayload", "AxisPulsesAnswer", "PulsesAnswer", "ConflictAnswer", "LimitAnswer"):
        assert all(field.get("description") for field in schemas[name]["properties"].values()), name
