"""What a motor does with a design, over the API."""

import json
import math
import re
from typing import Any

import pytest
from starlette.testclient import TestClient

import stepramp
from event_loop import run
from motor.trains import LOADED, NEMA_17, whole
from stepramp.http_api.lanes import Lane
from stepramp.http_api.planned import Planned, Wanted

SIMULATE, TORQUE = "/api/v1/motor/simulate", "/api/v1/motor/torque"


def simulated(client: TestClient, **changes: Any) -> dict[str, Any]:
    answer = client.post(SIMULATE, json={"design": whole(**changes)})
    assert answer.status_code == 200, answer.text
    return answer.json()  # type: ignore[no-any-return]


def test_torque_at_speeds(client: TestClient) -> None:
    answer = client.post(TORQUE, json={"design": whole(), "speeds_rpm": [0, 1200]}).json()
    # k T_h = .85 · .41719; at 1,200 rpm the published curve has .22 Nm.
    assert answer["pull_out_nm"] == pytest.approx([0.3546, 0.22], rel=0.1)
    # .01661 Nm for 300,000 steps/s², and 5 % of .59 Nm for friction; beyond the slew speed of 600 rpm friction alone.
    assert answer["required_nm"] == pytest.approx([0.0461, 0.0295], rel=1e-2)


def test_a_move_that_is_safe(client: TestClient) -> None:
    found = simulated(client)
    assert (found["verdict"], found["cause"], found["evidence"], found["first_lost_step"]) == ("safe", None, None, None)
    assert found["lost_full_steps"] == 0  # fmt: skip
    assert [each["damping"] for each in found["runs"]] == [0.02, 0.05, 0.1]
    assert found["proposals"] == []
    assert found["assumed"] == ["motor.detent_torque_nm", "motor.pull_out_factor", "load.friction_nm"]
    assert found["natural_frequency_hz"] == pytest.approx(136.88, rel=1e-3)
    lengths = {len(column) for column in found["rotor"].values()}
    assert len(lengths) == 1
    assert 1000 < lengths.pop() <= 4000


def test_torque_that_is_lacking_is_told(client: TestClient) -> None:
    found = simulated(client, motor=NEMA_17 | {"torque_curve": [[0, 0.4], [500, 0]]})
    assert (found["verdict"], found["evidence"], found["most_used"]) == ("stalls", "no_torque", None)
    found = simulated(client, motor=NEMA_17 | {"stalled": {"rpm": 600, "torque_nm": 0.1}}, load={"torque_nm": 0.3})
    assert (found["verdict"], found["evidence"]) == ("stalls", "measured_torque")
    assert found["most_used"] == pytest.approx(3.35, abs=0.01)


def test_what_a_mechanism_makes_of_the_load_is_told(client: TestClient) -> None:
    screw = {"name": "screw", "lead_mm": 8.0, "mass_kg": 2.0, "friction_n": 5.0}
    found = simulated(client, load={"inertia_g_cm2": 20.0, "mechanism": screw})
    # 82 of the rotor, 20, and 2 kg · (8 mm / 2π)²; 5 N · 8 mm / 2π at an efficiency of .4.
    assert found["shaft"] == pytest.approx(
        {"inertia_g_cm2": 134.4228, "torque_nm": 0, "friction_nm": 0.0159155}, rel=1e-5
    )
    assumed = {each for each in found["assumed"] if each.startswith("load.")}
    assert assumed == {"load.mechanism.efficiency", "load.mechanism.incline_deg"}


@pytest.mark.parametrize(
    ("cause", "changes"),
    [
        ("start", {"ramp__base_speed_steps_per_s": 20_000.0}),
        ("onset", {"ramp__acceleration_steps_per_s2": 1.2e7}),
        ("stop", {"ramp__deceleration_steps_per_s2": 1.2e7, "ramp__slew_speed_steps_per_s": 6e4,
                  "move__steps": 20_000}),
        ("top_speed", {"ramp__slew_speed_steps_per_s": 1.5e5, "ramp__acceleration_steps_per_s2": 2.5e6,
                       "move__steps": 60_000}),
    ],
)  # fmt: skip
def test_each_proposal_makes_a_stalling_move_safe(client: TestClient, cause: str, changes: dict[str, Any]) -> None:
    found = simulated(client, **changes)
    assert (found["verdict"], found["cause"]) == ("stalls", cause)
    assert found["lost_full_steps"] != 0
    assert found["proposals"]
    for proposal in found["proposals"]:
        design = json.loads(json.dumps(whole(**changes)))
        for change in proposal["changes"]:
            part, name = change["field"].split(".")
            design[part][name] = change["value"]
        assert client.post(SIMULATE, json={"design": design}).json()["verdict"] == "safe"


FIGURES = {
    "duration_s", "ramp_up_s", "peak_speed_steps_per_s", "acceleration_steps_per_s2", "most_used", "verdict",
}  # fmt: skip


def test_the_fastest_safe_ramps_are_ready_to_be_put_into_the_design(client: TestClient) -> None:
    design = whole(ramp__slew_speed_steps_per_s=64_000.0, move__steps=30_000)
    found = client.post("/api/v1/motor/fastest", json={"design": design}).json()
    assert [each["shape"] for each in found["candidates"]] == ["constant", "s_curve", "torque"]
    assert [each["is_fastest"] for each in found["candidates"]] == [False, False, True]
    assert (found["margin"], found["present"]["rejections"]) == (0.6, [])
    torque, present = found["candidates"][2], found["present"]
    assert torque["duration_s"] < present["duration_s"]
    assert found["gain"] > 1
    assert found["ramp_gain"] > 1.3
    assert f"{1000 * torque['duration_s']:.4g} ms instead of" in found["words"]
    for change in torque["changes"]:
        part, name = change["field"].split(".")
        design[part][name] = change["value"]
    answer = client.post(SIMULATE, json={"design": design, "max_points": None}).json()
    assert (answer["verdict"], answer["most_used"]) == (torque["verdict"], torque["most_used"])


def test_a_ramp_that_cannot_be_is_told_as_refusals_are(client: TestClient) -> None:
    design = whole(ramp__base_speed_steps_per_s=25_000.0)
    answer = client.post("/api/v1/motor/fastest", json={"design": design, "margin": 0.5})
    assert answer.status_code == 200
    for candidate in answer.json()["candidates"]:
        assert [candidate[name] for name in FIGURES] == [None] * len(FIGURES)
        assert [each["field"] for each in candidate["rejections"]] == ["design.ramp.base_speed_steps_per_s"]
        assert candidate["changes"] == []
    assert answer.json()["present"]["verdict"] == "stalls"
    refused = client.post("/api/v1/motor/fastest", json={"design": whole(motor=None)})
    assert [each["field"] for each in refused.json()["errors"]] == ["design.motor"]


@pytest.mark.parametrize(
    ("route", "asked"),
    [
        ("torque", {"speeds_rpm": []}), ("torque", {"speeds_rpm": [-1.0]}), ("torque", {"speeds_rpm": "abc"}),
        ("torque", {"speeds_rpm": [True]}), ("torque", {"speeds_rpm": None}), ("torque", {"speeds_rpm": [1e6]}),
        ("fastest", {"margin": 2.0}), ("fastest", {"margin": "x"}), ("fastest", {"margin": None}),
        ("map", {"over": "time"}), ("map", {"range": [1.0]}), ("map", {"range": ["a", 1.0]}), ("map", {"cells": 7}),
        ("map", {"range": [5000.0, 4000.0]}), ("map", {"range": [1.0, 1e9]}), ("map", {"cells": 48}),
        ("map", {"accelerations_steps_per_s2": [0.0, -1.0]}), ("map", {"over": "load", "range": [-1e6, None]}),
    ],
)  # fmt: skip
def test_python_refuses_what_the_api_refuses_in_the_same_words(
    client: TestClient, route: str, asked: dict[str, Any]
) -> None:
    made = stepramp.Design(**whole())
    call = {"torque": made.motor_torque, "fastest": made.fastest_ramp, "map": made.stall_map}[route]
    answer = client.post(f"/api/v1/motor/{route}", json={"design": whole(), **asked})
    assert answer.status_code == 422
    # In Python a range is called values: range is a function there.
    said = [re.sub(r"^range", "values", each["message"]) for each in answer.json()["errors"]]
    with pytest.raises(stepramp.Rejected) as caught:
        call(**{{"range": "values"}.get(name, name): value for name, value in asked.items()})
    assert str(caught.value).splitlines() == said
    assert not any("Input should" in each for each in said)


def test_motors_are_told_with_their_sources(client: TestClient) -> None:
    presets = {each["name"]: each for each in client.get("/api/v1/motor/presets").json()["presets"]}
    plain = presets["NEMA 17 · 17HS4401"]
    assert plain["motor"] == {
        "resistance_ohm": 1.5, "inductance_mh": 2.8, "holding_torque_nm": 0.4, "rated_current_a": 1.7,
        "rotor_inertia_g_cm2": 54.0, "detent_torque_nm": 0.022,
    }  # fmt: skip
    assert (plain["drive"], plain["load"], plain["axis"]) == (None, None, None)
    assert set(plain["sources"].values()) == {"datasheet"}
    gauge = presets["Gauge · X27"]
    assert gauge["axis"] == {"full_steps_per_rev": 360, "microsteps": 3}
    assert gauge["drive"] == {"supply_v": 5.0, "current_a": 0.01923, "current_is": "peak"}
    assert gauge["load"]["mechanism"] == {"name": "pointer", "inertia_g_cm2": 2.0}
    assert (gauge["sources"]["motor.resistance_ohm"], gauge["sources"]["motor.inductance_mh"]) == (
        "datasheet", "assumed",
    )  # fmt: skip


def test_a_gauges_table_by_the_makers_rule_can_be_put_into_the_design(client: TestClient) -> None:
    [gauge] = [each for each in client.get("/api/v1/motor/presets").json()["presets"] if each["name"] == "Gauge · X27"]
    parts = {name: gauge[name] for name in ("motor", "drive", "load", "axis")}
    design = whole(**parts, ramp__slew_speed_steps_per_s=1600.0, method__name="exact", move__steps=800)
    found = client.post("/api/v1/motor/gauge_table", json={"design": design}).json()
    assert found["share"] == 0.4
    assert found["reaches_slew_speed"] is True
    assert found["speed_steps_per_s"][-1] == pytest.approx(1600)
    assert found["rows"][0] == [3, 1648]  # 202.3 °/s are 606.9 steps/s.
    design |= {change["field"]: change["value"] for change in found["changes"]}
    assert design["method"]["name"] == "table"
    answer = client.post(SIMULATE, json={"design": design}).json()
    assert answer["lost_full_steps"] == 0
    coarse = design | {"axis": {"full_steps_per_rev": 200, "microsteps": 1}}
    refused = client.post("/api/v1/motor/gauge_table", json={"design": coarse})
    assert [each["field"] for each in refused.json()["errors"]] == ["design.axis.microsteps"]
    refused = client.post("/api/v1/motor/gauge_table", json={"design": whole()})
    assert [each["field"] for each in refused.json()["errors"]] == ["design.motor.kind"]


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"motor": None}, "design.motor"),
        ({"load": LOADED | {"mass_kg": 1}}, "design.load.mass_kg"),
        ({"move__steps": 10_000_000}, "design.move.steps"),
        ({"drive": {"supply_v": 0}}, "design.drive.supply_v"),
        # Its current and its speed swing against each other 4e8 times a second.
        (
            {
                "motor": {
                    "resistance_ohm": 0.0476,
                    "inductance_mh": 12.14,
                    "holding_torque_nm": 40.1,
                    "rated_current_a": 0.0042,
                    "rotor_inertia_g_cm2": 5.66e-3,
                    "full_steps_per_rev": 4,
                },
                "drive": None,
                "load": None,
            },
            "design.motor.rated_current_a",
        ),
    ],
)
def test_what_cannot_be_simulated_is_refused(client: TestClient, changes: dict[str, Any], field: str) -> None:
    answer = client.post(SIMULATE, json={"design": whole(**changes)})
    assert answer.status_code == 422
    assert [each["field"] for each in answer.json()["errors"]] == [field]


def test_a_job_is_told_when_its_client_has_left() -> None:
    wanted, seen = Wanted(), []

    def job() -> None:
        while wanted.is_so():
            pass
        seen.append("ended")
        raise RuntimeError

    async def left() -> dict[str, str]:
        return {"type": "http.disconnect"}

    async def send(message: Any) -> None:
        seen.append(message)

    async def answered() -> None:
        await Planned(Lane("one", 1), job, wanted=wanted)({"headers": []}, left, send)

    run(answered())
    # What it raises then is nobody's trouble, and nothing is sent.
    assert [each for each in seen if each != "ended"] == []


def test_a_table_is_told_with_its_own_torque_whatever_the_ramp_beside_it_is(client: TestClient) -> None:
    """Shaped by torque the ramp would be refused, if it were played: at 10⁶ steps/s nothing is left."""
    rows = [[40, 250], [400, 125]]
    beside = {"name": "torque", "margin": 0.6}
    table = {"method__name": "table", "table": {"rows": rows, "interval_unit": "us"}, "move__steps": 2000}
    told = [simulated(client, **table, **ramp)["torque"]["required_nm"] for ramp in (
        {"ramp__slew_speed_steps_per_s": 1e6}, {"ramp__slew_speed_steps_per_s": 1e6, "ramp__shape": beside},
    )]  # fmt: skip
    assert told[0] == told[1]
    # 4,000 to 8,000 steps/s over 16 steps, of 2π / 3200 each, with 282e-7 kg m².
    asked = 282e-7 * (8000**2 - 4000**2) / 32 * 2 * math.pi / 3200 + 0.0295
    assert max(told[0]) == pytest.approx(asked, rel=1e-6)
