"""Exports over HTTP: every format, and what is refused. tests/exports runs the C files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from designs import document
from exports.c_program import PLAY_MOVES, compiled, printed
from stepramp.exports.export import FORMAT_NAMES
from stepramp.exports.machines.machines import MACHINES

ENDINGS = {"arduino": ".ino", "arduino_library": "_library.ino"} | {
    name: each.ending for name, each in MACHINES.items()
}
CODE = "text/x-c; charset=utf-8"
TYPES = {
    **dict.fromkeys((name for name in FORMAT_NAMES if name.startswith("c_")), CODE),
    **dict.fromkeys(("arduino", "arduino_library"), CODE),
    **{name: CODE if each.is_code else "text/plain; charset=utf-8" for name, each in MACHINES.items()},
    "csv": "text/csv; charset=utf-8",
    "json": "application/json",
    "html": "text/html; charset=utf-8",
    "svg": "image/svg+xml",
    "png": "image/png",
}


def exported(client: TestClient, kind: str, **body: Any) -> Any:
    return client.post(f"/api/v1/export/{kind}", json={"design": document(), **body})


@pytest.mark.parametrize("name", TYPES)
def test_every_format_comes_as_a_file_of_its_kind(client: TestClient, name: str) -> None:
    answer = exported(client, name, design=document(name="Lead-screw stage"), segment_bound_ticks=10)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == TYPES[name]
    ending = f"_{name[2:]}.h" if name.startswith("c_") else ENDINGS.get(name, f".{name}")
    assert answer.headers["content-disposition"] == f'attachment; filename="lead_screw_stage{ending}"'
    assert len(answer.content) > 300


def test_a_machine_is_told_with_its_figures_and_what_is_lost(client: TestClient) -> None:
    asked = document(name="Gantry", ramp__base_speed_steps_per_s=100)
    body = {"design": asked, "axis_letter": "Z"}
    told = client.post("/api/v1/machine/marlin", json=body).json()
    assert told["file_name"] == "gantry_marlin.gcode"
    assert told["text"] == client.post("/api/v1/export/marlin", json=body).text
    # 200 · 2 / 8 = 50 steps/mm; 1000 / 50 = 20 mm/s.
    assert told["settings"][1] == {"name": "M203 Z", "unit": "mm/s", "requested": 20, "sent": "20"}
    assert told["remarks"][0] == "Base speed 100 steps/s is not kept: Marlin starts and ends at 120 steps/s."
    assert [each["text"] for each in told["remarks_told"][0]] == ["100 steps/s", "120 steps/s"]
    assert len(told["remarks_told"]) == len(told["remarks"])


def test_what_a_library_really_plays(client: TestClient) -> None:
    """After a rest AccelStepper makes its first step at once, so that the wait after it is 0.6 · 0.676 of √(2/a).

    The design's is 1/√(2a).
    """
    asked = {"design": document(ramp__acceleration_steps_per_s2=5000, move__steps=500)}
    assert client.post("/api/v1/machine/accelstepper", json=asked).json()["unplayed"] is None
    played = client.post("/api/v1/machine/accelstepper/ramp", json=asked).json()
    assert played["intervals_us"][0] == pytest.approx(0.6 * 0.676 * (2 / 5000) ** 0.5 * 1e6, abs=1)
    assert played["relative_error"][0] == pytest.approx(2 * 0.6 * 0.676 - 1, abs=0.001)
    assert played["losses"][-1].startswith("Between two polls")


def test_what_isnt_known_of_a_library_says_why(client: TestClient) -> None:
    asked = {"design": document()}
    unplayed = client.post("/api/v1/machine/fastaccelstepper", json=asked).json()["unplayed"]
    refused = client.post("/api/v1/machine/fastaccelstepper/ramp", json=asked)
    assert (refused.status_code, refused.json()["errors"][0]["message"]) == (409, unplayed)
    assert "isn't followed here" in unplayed


@pytest.mark.parametrize(
    ("machine", "body", "field", "allowed"),
    [
        ("arduino", {}, "machine", ", ".join(MACHINES)),
        ("marlin", {"axis_letter": "E"}, "axis_letter", "X, Y, Z, A, B, C"),
        (
            "marlin",
            {"design": document(ramp__acceleration_steps_per_s2=1)},
            "design.ramp.acceleration_steps_per_s2",
            "50",
        ),
        ("accelstepper", {"name": "2 axes"}, "name", "a letter, then letters"),
    ],
)
def test_what_a_machine_can_t_be_told_is_refused(
    client: TestClient, machine: str, body: dict[str, Any], field: str, allowed: str
) -> None:
    answer = client.post(f"/api/v1/machine/{machine}", json={"design": document(), **body})
    assert answer.status_code == 422
    [error] = answer.json()["errors"]
    assert error["field"] == field
    assert allowed in error["allowed"]


@pytest.mark.parametrize("name", ["c_segments", "c_first_order", "c_second_order", "c_compromise", "c_newton"])
@pytest.mark.parametrize("steps", [5, 150, 333])
def test_exported_code_plays_the_move_that_profile_plans(
    client: TestClient, tmp_path: Path, name: str, steps: int
) -> None:
    method = {"name": name.removeprefix("c_").replace("segments", "tuned"), "arithmetic": "fixed"}
    asked = document(method=method, move__steps=steps, ramp__deceleration_steps_per_s2=8000)
    program = compiled(tmp_path, exported(client, name, design=asked, name="axis_2").text, "axis_2", PLAY_MOVES)
    planned = client.post("/api/v1/profile", json={"design": asked}).json()["intervals_ticks"]
    np.testing.assert_array_equal(printed(program, [steps]), planned)


@pytest.mark.parametrize(
    ("name", "body", "field", "allowed"),
    [
        ("c_code", {}, "format", ", ".join(FORMAT_NAMES)),
        ("c_table", {"design": document(table=None)}, "design.table", "a table: this design has none to export"),
        ("c_table", {"name": "2 axes"}, "name", "a letter, then letters, digits and underscores"),
        ("c_table", {"name": "double"}, "name", "no keyword of C"),
        ("html", {"methods": ["fastest"]}, "methods.0", "exact, ideal, midpoint"),
        ("html", {"methods": ["table"], "design": document(table=None)}, "design.table", "a table"),
        ("c_newton", {"arithmetic": "decimal"}, "arithmetic", "float64, float32, fixed"),
        ("c_segments", {"segment_bound_ticks": -1}, "segment_bound_ticks", "a whole number from 0 to 10,000 ticks"),
        ("csv", {"design": document(move__steps=2_000_000)}, "design.move.steps", "up to 1,000,000 steps"),
        ("json", {"colour": "red"}, "colour", "nothing; there is no such field"),
        ("json", {"design": document(move__steps=0)}, "design.move.steps", "but not 0"),
        ("json", {"design": document(name=7)}, "design.name", "a text of up to 100 characters"),
    ],
)
def test_what_can_t_be_exported_is_refused_by_field_value_and_what_is_allowed(
    client: TestClient, name: str, body: dict[str, Any], field: str, allowed: str
) -> None:
    answer = exported(client, name, **body)
    assert answer.status_code == 422
    [error] = answer.json()["errors"]
    assert error["field"] == field
    assert allowed in error["allowed"]
    assert error["message"].startswith(field)
