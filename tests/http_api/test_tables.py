import itertools
import json
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient

from designs import document

RECORD = json.loads((Path(__file__).parents[1] / "reference" / "gauge_table_moves.json").read_text())


@pytest.mark.parametrize("case", RECORD["cases"], ids=[case["name"] for case in RECORD["cases"]])
def test_recorded_moves_over_the_api(client: TestClient, case: dict) -> None:
    body = {"table": {"rows": case["table"], "interval_unit": "us"}, "range_steps": case["range_steps"],
            "targets": case["targets"]}  # fmt: skip
    answer = client.post("/api/v1/table/play", json=body).json()
    names = ("at_us", "position", "direction", "ramp_index", "delay_us")
    assert [list(step) for step in zip(*(answer["steps"][name] for name in names), strict=True)] == case["steps"]
    assert [[stop["at_us"], stop["position"]] for stop in answer["stops"]] == case["stops"]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"table": {"rows": [[10, 500]], "interval_unit": "ticks"}}, "table.interval_unit"),
        ({"range_steps": 0}, "range_steps"),
        ({"targets": [{"at_us": 5, "target": 1}, {"at_us": 4, "target": 1}]}, "targets.1.at_us"),
        ({"targets": [{"at_us": -1, "target": 1}]}, "targets.0.at_us"),
        ({"targets": 7}, "targets"),
    ],
)
def test_what_can_t_be_played_is_refused(client: TestClient, change: dict, field: str) -> None:
    body = {"table": {"rows": [[10, 500]]}, "range_steps": 945, "targets": [{"at_us": 0, "target": 5}], **change}
    response = client.post("/api/v1/table/play", json=body)
    assert response.status_code == 422
    assert [error["field"] for error in response.json()["errors"]] == [field]


def fit(client: TestClient, **wish: object) -> dict:
    gauge = document(
        timer__frequency_hz=1e6, ramp__base_speed_steps_per_s=200, ramp__slew_speed_steps_per_s=1666,
        ramp__acceleration_steps_per_s2=8000,
    )  # fmt: skip
    return client.post("/api/v1/table/fit", json={"design": gauge, **wish}).json()


def test_a_table_is_fitted_by_rows_error_or_bytes(client: TestClient) -> None:
    by_rows, by_bytes = fit(client, rows=5), fit(client, bytes=23)
    assert by_rows == by_bytes
    assert fit(client, bytes=4) == fit(client, bytes=5) == fit(client, rows=1)
    assert (by_rows["rows"], by_rows["bytes"], len(by_rows["table"]["rows"])) == (5, 20, 5)
    by_error = fit(client, largest_relative_error=by_rows["largest_relative_error"])
    assert by_error["rows"] == 5
    # The fitted table is a table of a design.
    client.post("/api/v1/profile", json={"design": document(table=by_rows["table"])}).raise_for_status()


def test_a_fit_is_to_what_is_played_unless_the_ramp_index_is_asked_for(client: TestClient) -> None:
    played, indexed = fit(client, rows=16), fit(client, rows=16, fit_to="ramp_index")
    assert fit(client, rows=16, fit_to="played") == played
    # Index 2 plays v(1) = sqrt(200² + 2 · 8000) up and v(3) down: off by (v(3) - v(1)) / (v(3) + v(1)).
    up, down = (200**2 + 2 * 8000) ** 0.5, (200**2 + 6 * 8000) ** 0.5
    worst = pytest.approx((down - up) / (down + up), abs=2e-4)
    assert played["floor"] == {"relative_error": worst, "ramp_index": 2}
    assert played["largest_relative_error"] == worst
    assert indexed["largest_relative_error"] == pytest.approx(0.0579, abs=2e-4)
    assert indexed["floor"]["relative_error"] < 0.0008, "a delay is a whole µs"
    # As the plots show it.
    for fitted, is_kept in ((played, True), (indexed, False)):
        table = document(timer__frequency_hz=1e6, ramp__base_speed_steps_per_s=200, ramp__slew_speed_steps_per_s=1666,
                         ramp__acceleration_steps_per_s2=8000, table=fitted["table"])  # fmt: skip
        [judged] = client.post("/api/v1/errors", json={"design": table, "methods": ["table"]}).json()["methods"]
        assert (abs(judged["largest_relative_error"]["value"]) <= fitted["largest_relative_error"] + 1e-9) == is_kept
    [refused] = fit(client, rows=16, fit_to="speed")["errors"]
    assert (refused["field"], refused["allowed"]) == ("fit_to", "played, ramp_index")


@pytest.mark.parametrize(
    "wish",
    [
        {},
        {"rows": 5, "bytes": 20},
        {"rows": 0},
        {"largest_relative_error": 0},
        {"bytes": 3},
        {"bytes": 5, "row_kind": "linear"},
    ],
)
def test_a_wish_that_is_none_is_refused(client: TestClient, wish: dict) -> None:
    response = client.post("/api/v1/table/fit", json={"design": document(), **wish})
    assert response.status_code == 422
    assert all(error["allowed"] for error in response.json()["errors"])


def test_linear_rows_do_better_with_fewer(client: TestClient) -> None:
    linear = fit(client, rows=5, row_kind="linear", fit_to="ramp_index")
    assert linear["table"] is None
    assert (linear["rows"], linear["bytes"], len(linear["linear_rows"])) == (5, 30, 5)
    assert linear["largest_relative_error"] < 0.04
    assert fit(client, bytes=33, row_kind="linear", fit_to="ramp_index") == linear
    assert fit(client, largest_relative_error=0.04, row_kind="linear", fit_to="ramp_index")["rows"] <= 5


def test_an_error_that_whole_delays_can_t_keep_is_refused(client: TestClient) -> None:
    for kind in ("constant", "linear"):
        for fit_to, least in (("ramp_index", 0.00077), ("played", 0.113)):
            [error] = fit(client, largest_relative_error=0.00001, row_kind=kind, fit_to=fit_to)["errors"]
            assert error["field"] == "largest_relative_error"
            assert f"at least {least}," in error["allowed"]
            # What is told is rounded up, so that it is allowed.
            assert fit(client, largest_relative_error=least, row_kind=kind, fit_to=fit_to)["rows"] <= 1000


def test_a_table_is_checked_row_by_row(client: TestClient) -> None:
    body = {"rows": [[10, 5000], [5, 6000]], "slew_interval_us": 600}
    answer = client.post("/api/v1/table/check", json=body).json()
    assert [(each["row"], each["wrong"]) for each in answer["findings"]] == [(1, True), (1, False), (1, False)]
    assert answer["row_changes"][0]["acceleration_steps_per_s2"] == pytest.approx(20_000)


def test_delays_in_ticks_are_checked_as_such(client: TestClient) -> None:
    body = {"rows": [[10, 10000], [20, 12000]], "interval_unit": "ticks", "slew_interval_us": 600}
    [missing] = client.post("/api/v1/table/check", json=body).json()["errors"]
    assert missing["field"] == "frequency_hz"
    answer = client.post("/api/v1/table/check", json={**body, "frequency_hz": 2e6}).json()
    assert [each["reason"] for each in answer["findings"]] == [
        "delay 12,000 ticks rises: the row before has 10,000 ticks",
        "the last row is missing: the table ends at 12,000 ticks, far from the 1,200 ticks of the slew speed",
    ]
    # 10,000 ticks of 0.5 µs are 200 steps/s, reached within one step: 200² / 2.
    assert answer["row_changes"][0]["acceleration_steps_per_s2"] == pytest.approx(20_000)


def test_the_error_against_the_rows_is_that_of_each_fit(client: TestClient) -> None:
    for kind, bytes_per_row in (("constant", 4), ("linear", 6)):
        body = {"design": document(), "most_rows": 6, "row_kind": kind}
        curve = client.post("/api/v1/table/fit/curve", json=body).json()
        assert curve["rows"] == [1, 2, 3, 4, 5, 6]
        assert curve["bytes"] == [bytes_per_row * rows for rows in curve["rows"]]
        for rows, error in zip(curve["rows"], curve["largest_relative_error"], strict=True):
            wish = {"design": document(), "rows": rows, "row_kind": kind}
            assert client.post("/api/v1/table/fit", json=wish).json()["largest_relative_error"] == error


def test_a_ramp_too_short_for_more_rows_has_a_short_curve(client: TestClient) -> None:
    short = document(ramp__slew_speed_steps_per_s=100, ramp__acceleration_steps_per_s2=1000)  # 5 steps
    body = {"design": short, "fit_to": "ramp_index"}
    curve = client.post("/api/v1/table/fit/curve", json=body).json()
    assert curve["rows"] == [1, 2, 3, 4, 5], "five delays, the last of them the slew interval"
    assert curve["largest_relative_error"][-1] == curve["floor"]["relative_error"] < 0.001
    refused = client.post("/api/v1/table/fit/curve", json={"design": short, "most_rows": 65}).json()
    assert [error["field"] for error in refused["errors"]] == ["most_rows"]


def test_a_table_fitted_from_a_base_speed_is_a_table_of_a_design(client: TestClient) -> None:
    based = document(ramp__base_speed_steps_per_s=100)
    body = {"design": based, "rows": 24, "fit_to": "ramp_index"}
    fitted = client.post("/api/v1/table/fit", json=body).json()["table"]
    assert fitted["rows"][0] == [0, 10_000], "the interval of the base speed, where a deceleration ends"
    client.post("/api/v1/profile", json={"design": document(table=fitted)}).raise_for_status()


def test_delays_of_less_than_a_tick_are_refused_for_any_wish(client: TestClient) -> None:
    # 5,000 steps/s on a timer of 1,000 Hz: 0.2 ticks a step.
    fast = document(timer__frequency_hz=1000, ramp__slew_speed_steps_per_s=5000, ramp__acceleration_steps_per_s2=50_000)
    for wish in ({"rows": 3}, {"bytes": 12}, {"largest_relative_error": 0.5}):
        for kind, fit_to in itertools.product(("constant", "linear"), ("played", "ramp_index")):
            body = {"design": fast, "interval_unit": "ticks", "row_kind": kind, "fit_to": fit_to, **wish}
            response = client.post("/api/v1/table/fit", json=body)
            assert response.status_code == 422
            [error] = response.json()["errors"]
            assert (error["field"], error["value"]) == ("design.ramp.slew_speed_steps_per_s", 5000)
            assert error["allowed"] == "at most 1,000 steps/s with this timer: a delay is 1 tick or more"
    in_us = client.post("/api/v1/table/fit", json={"design": fast, "rows": 3}).json()
    assert in_us["rows"] == 3, "200 µs are no matter of the timer"


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    frequency_hz=st.floats(1000, 1e7),
    slew=st.floats(1, 1e6),
    steps=st.integers(0, 300),
    wish=st.one_of(
        st.tuples(st.just("rows"), st.integers(1, 40)),
        st.tuples(st.just("bytes"), st.integers(6, 200)),
        st.tuples(st.just("largest_relative_error"), st.floats(0.0001, 1)),
    ),
    kind=st.sampled_from(["constant", "linear"]),
    unit=st.sampled_from(["us", "ticks"]),
    fit_to=st.sampled_from(["played", "ramp_index"]),
)
def test_a_wish_is_kept_or_refused_with_what_is_allowed(
    client: TestClient, frequency_hz: float, slew: float, steps: int, wish: tuple[str, float], kind: str, unit: str,
    fit_to: str,
) -> None:  # fmt: skip
    name, wanted = wish
    made = document(timer__frequency_hz=frequency_hz, ramp__slew_speed_steps_per_s=slew,
                    ramp__acceleration_steps_per_s2=min(max(slew**2 / (2 * steps + 1), 0.001), 1e9))  # fmt: skip
    body = {"design": made, name: wanted, "row_kind": kind, "interval_unit": unit, "fit_to": fit_to}
    response = client.post("/api/v1/table/fit", json=body)
    if response.status_code == 200:
        assert response.json()[name] <= wanted * (1 + 1e-9)
        return
    [error] = response.json()["errors"]
    if error["field"] == "design.ramp.slew_speed_steps_per_s":
        assert (unit, slew > frequency_hz) == ("ticks", True)
        return
    assert (error["field"], error["value"]) == ("largest_relative_error", wanted)
    least = float(re.match(r"at least ([\d.]+),", error["allowed"])[1])
    assert client.post("/api/v1/table/fit", json=body | {name: least}).json()[name] <= least * (1 + 1e-9)
