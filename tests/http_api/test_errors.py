import json
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document


def errors_of(response, status: int) -> list[dict]:
    assert response.status_code == status, response.text
    body = response.json()
    assert set(body) == {"errors"}
    assert body["errors"]
    for error in body["errors"]:
        assert {"field", "value", "allowed", "message"} <= set(error)
        assert error["message"].endswith(".")
        assert "Traceback" not in error["message"]
    return body["errors"]


@pytest.mark.parametrize(
    ("change", "value", "shown"),
    [
        ("timer__frequency_hz", 0, 0),
        ("timer__frequency_hz", "abc", "abc"),
        ("ramp__slew_speed_steps_per_s", -5, -5),
        ("ramp__acceleration_steps_per_s2", None, None),
        ("ramp__base_speed_steps_per_s", 5000, 5000),
        ("move__steps", 0, 0),
        ("move__steps", 10**12, 10**12),
        ("move__steps", 10**40, str(10**40)),
        ("method__name", "magic", "magic"),
    ],
)
def test_a_rejection_names_field_value_and_what_is_allowed(
    client: TestClient, change: str, value: object, shown: object
) -> None:
    response = client.post("/api/v1/profile", content=json.dumps({"design": document(**{change: value})}),
                           headers={"content-type": "application/json"})  # fmt: skip
    [error] = errors_of(response, 422)
    assert error["field"] == "design." + change.replace("__", ".")
    assert error["value"] == shown
    assert error["allowed"]
    assert error["field"] in error["message"]


@pytest.mark.parametrize("literal", ["NaN", "Infinity", "-Infinity", "1e400", "-2.5E+0400", "9" * 190 + ".5e120"])
def test_numbers_that_are_none_are_refused_as_they_were_written(client: TestClient, literal: str) -> None:
    text = json.dumps({"design": document(ramp__slew_speed_steps_per_s=12345.5)}).replace("12345.5", literal)
    response = client.post("/api/v1/profile", content=text, headers={"content-type": "application/json"})
    [error] = errors_of(response, 422)
    assert error["field"] == "design.ramp.slew_speed_steps_per_s"
    assert "to 1,000,000 steps/s" in error["allowed"]
    assert error["value"] == literal
    assert f"design.ramp.slew_speed_steps_per_s is {literal[:70]}" in error["message"]


def test_a_number_of_many_figures_that_is_too_large_is_told_in_short(client: TestClient) -> None:
    text = json.dumps({"design": document(move__steps=12345)}).replace("12345", "7" * 1000 + ".0")
    response = client.post("/api/v1/profile", content=text, headers={"content-type": "application/json"})
    [error] = errors_of(response, 422)
    assert error["value"] == "7" * 200 + "… (1,002 characters)"


def test_null_is_told_as_null_and_what_is_not_there_as_missing(client: TestClient) -> None:
    def refused(text: str) -> list[str]:
        response = client.post("/api/v1/errors", content=text, headers={"content-type": "application/json"})
        return [error["message"] for error in errors_of(response, 422) if error["value"] is None]

    assert refused("null") == ["document is null; allowed: an object with named fields."]
    assert refused('{"design": null, "methods": []}') == ["design is null; allowed: an object with named fields."]
    assert refused('{"methods": []}') == ["design is missing; allowed: a value; this field is required."]


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (True, "true"),
        ([False, None, "ü", 2.5], '[false, null, "ü", 2.5]'),
        ({"a": None, "b": {"c": [True]}}, '{"a": null, "b": {"c": [true]}}'),
        ("true", "'true'"),
    ],
)
def test_values_are_told_as_json_tells_them(client: TestClient, value: object, told: str) -> None:
    response = client.post("/api/v1/profile", json={"design": document(), "max_points": value})
    [error] = errors_of(response, 422)
    assert error["message"].startswith(f"max_points is {told}; allowed: ")


def test_rejections_that_the_numerics_make_have_the_same_path(client: TestClient) -> None:
    response = client.post("/api/v1/profile", json={"design": document(ramp__acceleration_steps_per_s2=0.01)})
    [error] = errors_of(response, 422)
    assert error["field"] == "design.ramp.acceleration_steps_per_s2"


@pytest.mark.parametrize("body", ["", "{", "[]", "5", "null", '"x"', "{}", '{"design": 5}', '{"design": []}', "\ud800"])
@pytest.mark.parametrize("route", ["profile", "errors"])
def test_bodies_that_are_no_request_are_refused(client: TestClient, route: str, body: str) -> None:
    content = body.encode("utf-8", "surrogatepass")
    response = client.post(f"/api/v1/{route}", content=content, headers={"content-type": "application/json"})
    errors_of(response, 422)


def test_unknown_fields_of_a_request_are_refused(client: TestClient) -> None:
    [error] = errors_of(client.post("/api/v1/profile", json={"design": document(), "points": 5}), 422)
    assert (error["field"], error["value"]) == ("points", 5)
    assert error["allowed"] == "nothing; there is no such field, only design, max_points, first_step, last_step"


def test_a_field_under_another_name_is_one_mistake(client: TestClient) -> None:
    """Nothing is said of the field that is missing but beside the name that was given instead of it."""
    [line] = errors_of(client.post("/api/v1/devices/1/line", json={"axes": [{"axis": 0, "steps": 5}]}), 422)
    assert line["message"] == (
        "axes.0.steps is 5; allowed: nothing; there is no such field, only axis, by_steps (missing)."
    )
    body = {"designs": [document()], "spacing": 3, "axes": {}}
    spacing, axes = errors_of(client.post("/api/v1/schedule", json=body), 422)
    assert (spacing["field"], axes["field"]) == ("spacing", "axes")
    assert "mode (missing)" in spacing["allowed"]


def test_what_is_missing_elsewhere_is_told_for_itself(client: TestClient) -> None:
    body = {"design": document(timer={}), "points": 5}
    assert {error["field"] for error in errors_of(client.post("/api/v1/profile", json=body), 422)} == {
        "design.timer.frequency_hz",
        "points",
    }


@pytest.mark.parametrize("points", [0, 9, 10**9, "many", 12.5, True])
def test_a_wrong_number_of_points_is_refused(client: TestClient, points: object) -> None:
    [error] = errors_of(client.post("/api/v1/profile", json={"design": document(), "max_points": points}), 422)
    assert (error["field"], error["value"]) == ("max_points", points)
    assert "from 10 to 10,000,000 points" in error["allowed"]


@pytest.mark.parametrize(("methods", "field"), [(["magic"], "methods.0"), ("exact", "methods"), (None, "methods")])
def test_wrong_methods_are_refused(client: TestClient, methods: object, field: str) -> None:
    [error] = errors_of(client.post("/api/v1/errors", json={"design": document(), "methods": methods}), 422)
    assert error["field"] == field


METHODS = "exact, ideal, midpoint, first_order, second_order, compromise, tuned, newton, austin, table"
WORDS = {
    "profile": {"design.method.rounding": "nearest, floor, carry", "design.axis.travel_unit": "mm, deg"},
    "schedule": {"mode": "independent, line", "designs.0.schema": "stepramp/1, stepramp/2"},
    "curves": {"parts": "true or false", "acceleration": "true or false", "methods.1": METHODS, "reference": METHODS},
    "export/csv": {"arithmetic": "float64, float32, fixed"},
    "devices/1/push": {"mode": "keep, try"},
}


def with_value(document: object, path: list[str], value: object) -> object:
    """Return a document with another value at a path."""
    if not path:
        return value
    first, *rest = path
    if isinstance(document, list):
        at = int(first)
        return [*document[:at], with_value(document[at], rest, value), *document[at + 1 :]]
    assert isinstance(document, dict)
    return {**document, first: with_value(document.get(first), rest, value)}


@pytest.mark.parametrize(
    ("changes", "limits", "unit"),
    [
        (
            {"ramp__slew_speed_steps_per_s": -5},
            {"lowest": 0.001, "highest": 1_000_000, "is_whole": False, "note": ""},
            "steps/s",
        ),
        (
            {"ramp__base_speed_steps_per_s": 1001},
            {"lowest": 0, "highest": 1000, "is_whole": False, "note": ", the slew speed"},
            "steps/s",
        ),
        (
            {"move__steps": 0},
            {"lowest": -10_000_000, "highest": 10_000_000, "is_whole": True, "note": ", but not 0"},
            "steps",
        ),
        # By (16) the ramp has v² / 2 a steps: a is at least 1,000,000 / 20,000,000.
        (
            {"ramp__acceleration_steps_per_s2": 0.04},
            {
                "lowest": 0.05,
                "highest": None,
                "is_whole": False,
                "note": " between these speeds, for a ramp of at most 10,000,000 steps",
            },
            "steps/s²",
        ),
        ({"name": "x" * 101}, {"lowest": 0, "highest": 100, "is_whole": True, "note": ""}, "characters"),
        (
            {"table__rows": [[row, 9] for row in range(1001)]},
            {"lowest": 1, "highest": 1000, "is_whole": True, "note": ""},
            "items",
        ),
    ],
)
def test_limits_are_told_as_data(
    client: TestClient, changes: dict[str, Any], limits: dict[str, Any], unit: str
) -> None:
    [error] = errors_of(client.post("/api/v1/profile", json={"design": document(**changes)}), 422)
    assert (error["limits"], error["unit"]) == (limits, unit)
    assert error["field"] == "design." + next(iter(changes)).replace("__", ".")


def test_what_has_no_limits_tells_none(client: TestClient) -> None:
    [error] = errors_of(client.post("/api/v1/profile", json={"design": document(method__name="magic")}), 422)
    assert set(error) == {"field", "value", "allowed", "message"}


@pytest.mark.parametrize("wrong", ["magic", "", 1, ["keep"], {"keep": 1}])
@pytest.mark.parametrize(("route", "field"), [(route, field) for route, fields in WORDS.items() for field in fields])
def test_a_word_that_is_none_of_the_allowed_names_them(
    client: TestClient, route: str, field: str, wrong: object
) -> None:
    bodies = {
        "schedule": {"designs": [document()], "mode": "line"},
        "curves": {"design": document(), "methods": ["exact", "ideal"]},
    }
    body = with_value(bodies.get(route, {"design": document()}), field.split("."), wrong)
    [error] = errors_of(client.post(f"/api/v1/{route}", json=body), 422)
    allowed = WORDS[route][field]
    assert (error["field"], error["value"], error["allowed"]) == (field, wrong, allowed)
    assert error["message"].endswith(f"; allowed: {allowed}.")


def test_a_format_that_is_none_names_the_formats(client: TestClient) -> None:
    [error] = errors_of(client.post("/api/v1/export/magic", json={"design": document()}), 422)
    assert (error["field"], error["value"]) == ("format", "magic")
    of_c = "c_table, c_table_progmem, c_segments, c_ramp_image, c_first_order, c_second_order, c_compromise, c_newton"
    machines = "grbl, grblhal, fluidnc, marlin, marlin_configuration, klipper, tic, tic_settings"
    libraries = "accelstepper, fastaccelstepper, teensystep, switecx25"
    others = "csv, json, html, svg, png"
    assert error["allowed"] == f"{of_c}, arduino, arduino_library, {machines}, {libraries}, {others}"


def test_pages_and_routes_that_are_not_there(client: TestClient) -> None:
    [error] = errors_of(client.get("/api/v1/nothing"), 404)
    assert (
        error["message"]
        == "Not Found: GET /api/v1/nothing. The routes are described at /docs, for programs at /api/v1/openapi.json."
    )
    errors_of(client.get("/nothing.html"), 404)
    errors_of(client.get("/../pyproject.toml"), 404)
    errors_of(client.post("/api/v1/nothing"), 404)
    errors_of(client.get("/api"), 404)
    errors_of(client.get("/api/v1/profile/"), 404)
    errors_of(client.get("/x%00y"), 404)
    [long] = errors_of(client.get("/" + "x" * 10_000), 404)
    assert len(long["message"]) < 400


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("GET", "/api/v1/profile", "POST"),
        ("TRACE", "/api/v1/profile", "POST"),
        ("OPTIONS", "/api/v1/devices", "GET, POST"),
        ("HEAD", "/api/v1/devices/1", "GET, DELETE"),
        ("PATCH", "/api/v1/devices/%ff%00", "GET, DELETE"),
        ("POST", "/api/v1/devices/1/settings", "GET, PUT"),
        ("FROBNICATE", "/api/v1/export/csv", "POST"),
        ("POST", "/index.html", "GET, HEAD"),
        ("POST", "/docs", "GET"),
        ("POST", "/assets/plotly/plotly.min.js", "GET, HEAD"),
    ],
)
def test_a_method_that_a_path_does_not_know(client: TestClient, method: str, path: str, allowed: str) -> None:
    answer = client.request(method, path)
    assert (answer.status_code, answer.headers["allow"]) == (405, allowed)
    if method != "HEAD":
        [error] = errors_of(answer, 405)
        assert error["message"].endswith(f"; allowed: {allowed}.")


@pytest.mark.parametrize("device_id", ["%00", "%ff", "..%2f..", "%ed%a0%80", "x" * 5000, "%F0%9F%9A%80", "1%20"])
def test_odd_ids_are_no_devices(client: TestClient, device_id: str) -> None:
    [error] = errors_of(client.get(f"/api/v1/devices/{device_id}/settings?x=%00&&=&x=1"), 404)
    assert len(error["message"]) < 400


def test_how_many_there_are_is_told_without_quotes(client: TestClient) -> None:
    body = {"designs": [document()] * 5, "mode": "line"}
    [error] = client.post("/api/v1/schedule", json=body).json()["errors"]
    assert (error["field"], error["value"]) == ("designs", "5 items")
    assert error["message"].startswith("designs is 5 items; allowed: a list of 1 to 4 designs")
    # What somebody has written is quoted as ever.
    [error] = client.post("/api/v1/devices", json={"port": "sim://", "family": "5 of them"}).json()["errors"]
    assert error["message"].startswith("family is '5 of them'; allowed: ")
