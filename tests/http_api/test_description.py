"""The description of the API: its examples are what the server takes, and its keys are where they count."""

from __future__ import annotations

from typing import Any

import pytest
from jsonschema_rs import ValidationError, validate
from starlette.testclient import TestClient

from stepramp.http_api.app import create_app

DESCRIBED = create_app().openapi()
NAMES = {"format": "c_newton", "machine": "grbl", "name": "grbl"}
PARAMETERS = {"/api/v1/report": {"format": "pdf"}}
OTHERS = {
    "/api/v1/motor/map": (202, "id"),
    # An example can't know what there is, or how it is set.
    "/api/v1/devices/{device_id}/home": (422, "where the settings name a limit switch"),
    "/api/v1/devices/{device_id}/backups/restore": (404, "There are no backups"),
    "/api/v1/devices/{device_id}/import": (409, ""),
    "/api/v1/devices/{device_id}/line": (422, "axis"),
    "/api/v1/ports/find": (409, ""),
}
BODIES = [
    (method, path)
    for path, operations in DESCRIBED["paths"].items()
    for method, operation in operations.items()
    if "application/json" in operation.get("requestBody", {}).get("content", {})
]


def names_in(client: TestClient, path: str) -> dict[str, str]:
    """Return what stands for the names in a path, made where there is none."""
    names = dict(NAMES)
    if "{device_id}" in path:
        device = client.post("/api/v1/devices", json={"port": "sim://"}).json()["id"]
        assert (
            client.post(f"/api/v1/devices/{device}/push", json=example("/api/v1/profile", "design")).status_code == 200
        )
        names["device_id"] = device
    if "{design_id}" in path:
        kept = client.post("/api/v1/library/designs", json=example("/api/v1/profile", "design"))
        names["design_id"] = kept.json()["id"]
    return names


def example(path: str, *fields: str, method: str = "post") -> dict[str, Any]:
    body = DESCRIBED["paths"][path][method]["requestBody"]["content"]["application/json"]["example"]
    return {field: body[field] for field in fields} if fields else body


@pytest.mark.parametrize(("method", "path"), BODIES)
def test_each_body_has_an_example_that_is_taken(client: TestClient, method: str, path: str) -> None:
    address = path.format_map(names_in(client, path))
    asked = {"json": example(path, method=method), "params": PARAMETERS.get(path), "headers": {"If-Match": '"1"'}}
    answer = client.request(method, address, **asked)
    status, word = OTHERS.get(path, (200, ""))
    assert answer.status_code == status, answer.text
    assert word.encode() in answer.content


def test_messages_of_web_sockets_are_described(client: TestClient) -> None:
    events = DESCRIBED["x-websockets"]["/api/v1/devices/events"]
    client.post("/api/v1/devices", json={"port": "sim://"})
    with client.websocket_connect("ws://127.0.0.1:8000/api/v1/devices/events") as socket:
        told = socket.receive_json()
        asked = {"do": "stop", "number": 7}
        socket.send_json(asked)
        answer = told
        while "did" not in answer:
            answer = socket.receive_json()
    assert told["devices"]
    assert (answer["did"]["number"], "errors" in answer) == (7, False)
    for message, side in ((told, "sends"), (answer, "sends"), (asked, "takes")):
        validate(events[side] | {"components": DESCRIBED["components"]}, message)
    with pytest.raises(ValidationError):
        validate(events["takes"] | {"components": DESCRIBED["components"]}, {"do": "go"})


def test_who_may_ask_and_where_is_said() -> None:
    assert DESCRIBED["servers"][0]["url"] == "/"
    assert set(DESCRIBED["components"]["securitySchemes"]) == {"token", "session"}
    assert {} in DESCRIBED["security"]


def test_keys_are_described_where_they_count() -> None:
    keyed = {
        (method, path)
        for path, operations in DESCRIBED["paths"].items()
        for method, operation in operations.items()
        if any(each["name"] == "Idempotency-Key" for each in operation.get("parameters", []))
    }
    assert ("post", "/api/v1/devices/{device_id}/move") in keyed
    assert ("post", "/api/v1/devices/{device_id}/push") in keyed
    assert ("delete", "/api/v1/devices/{device_id}") in keyed
    assert ("post", "/api/v1/library/designs") in keyed
    assert not [
        each for each in keyed if each[0] == "get" or each[1].endswith(("/stop", "/halt", "/preview", "/search"))
    ]
    assert not [
        each for each in keyed if not each[1].startswith(("/api/v1/devices", "/api/v1/ports", "/api/v1/library"))
    ]
