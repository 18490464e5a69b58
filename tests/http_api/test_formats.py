"""Profiles and errors in other forms: CSV, npz, compressed, and only some steps of them."""

from __future__ import annotations

import csv
import gzip
import io
import json
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from designs import document

COLUMNS = ["step", "intervals_ticks", "time_s", "position_steps", "speed_steps_per_s"]
ERRORS = {"methods": ["newton", "table"], "curves": ["relative_error", "time_error_s"]}


def ask(client: TestClient, path: str, accept: str | None = None, **body: Any) -> Any:
    headers = {} if accept is None else {"accept": accept}
    return client.post(f"/api/v1/{path}", json={"design": document(move__steps=5000)} | body, headers=headers)


@pytest.mark.parametrize(
    "accept", ["text/csv", "text/*", "application/json;q=0.5, text/csv", "text/csv; charset=utf-8"]
)
def test_a_profile_as_csv_has_the_same_numbers(client: TestClient, accept: str) -> None:
    whole = ask(client, "profile").json()
    answer = ask(client, "profile", accept)
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    names, *rows = csv.reader(io.StringIO(answer.text))
    assert names == COLUMNS
    for name, column in zip(names, zip(*rows, strict=True), strict=True):
        assert [float(value) for value in column] == whole[name]


def test_a_profile_as_npz_has_the_same_numbers(client: TestClient) -> None:
    whole = ask(client, "profile").json()
    answer = ask(client, "profile", "application/x-npz")
    with np.load(io.BytesIO(answer.content)) as arrays:
        assert list(arrays) == COLUMNS
        for name in COLUMNS:
            np.testing.assert_array_equal(arrays[name], whole[name])
        assert (arrays["intervals_ticks"].dtype, arrays["time_s"].dtype) == (np.int64, np.float64)


def test_errors_have_the_method_before_them(client: TestClient) -> None:
    whole = {each["method"]: each for each in ask(client, "errors", max_points=50, **ERRORS).json()["methods"]}
    names, *rows = csv.reader(io.StringIO(ask(client, "errors", "text/csv", max_points=50, **ERRORS).text))
    assert names == ["name", "step", *ERRORS["curves"]]
    assert list(dict.fromkeys(row[0] for row in rows)) == ERRORS["methods"]
    with np.load(io.BytesIO(ask(client, "errors", "application/x-npz", max_points=50, **ERRORS).content)) as arrays:
        for method, curves in whole.items():
            for at, name in enumerate(names[1:], 1):
                assert [float(row[at]) for row in rows if row[0] == method] == curves[name]
                np.testing.assert_array_equal(arrays[f"{method}/{name}"], curves[name])


def test_a_method_without_curves_is_told_where_only_columns_are_wanted(client: TestClient) -> None:
    failing = {"methods": ["exact", "table"], "design": document(timer__frequency_hz=1000, table={"rows": [[10, 400]]})}
    assert ask(client, "errors", **failing).json()["failures"]
    answer = ask(client, "errors", "text/csv", **failing)
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/json")
    assert answer.json()["errors"][0]["field"] == "design.table.rows.0.1"


@pytest.mark.parametrize("accept", [None, "*/*", "", "application/*", "text/html, application/json;q=0.9, */*;q=0.8"])
def test_whoever_takes_anything_gets_json(client: TestClient, accept: str | None) -> None:
    answer = ask(client, "profile", accept)
    assert answer.headers["content-type"] == "application/json"
    assert set(answer.headers["vary"].split(", ")) >= {"accept", "accept-encoding"}


@pytest.mark.parametrize("accept", ["image/png", "nonsense", "application/json;q=0"])
def test_other_forms_are_refused_by_name(client: TestClient, accept: str) -> None:
    answer = ask(client, "profile", accept)
    assert answer.status_code == 406
    [error] = answer.json()["errors"]
    assert (error["field"], error["value"]) == ("Accept", accept)
    assert error["allowed"] == "one of application/json, text/csv, application/x-npz, or */*"


@pytest.mark.parametrize(("first", "last"), [(1, 1), (17, 1200), (4990, 5000), (None, 3), (4999, None)])
def test_only_some_steps_of_a_profile(client: TestClient, first: int | None, last: int | None) -> None:
    whole = ask(client, "profile").json()
    part = ask(client, "profile", first_step=first, last_step=last).json()
    begin, end = (first or 1) - 1, last or 5000
    for name in COLUMNS:
        assert part[name] == whole[name][begin:end]
    assert part["summary"] == whole["summary"]


def test_a_part_is_thinned_within_itself(client: TestClient) -> None:
    part = ask(client, "profile", first_step=40, last_step=4960, max_points=30).json()
    assert part["step"][0] == 40
    assert part["step"][-1] == 4960
    assert 4 < len(part["step"]) <= 30
    [errors] = ask(client, "errors", methods=["newton"], first_step=40, last_step=42).json()["methods"]
    assert errors["step"] == [40, 41, 42]


@pytest.mark.parametrize(
    ("given", "field", "allowed"),
    [
        ({"first_step": 5001}, "first_step", "a whole number from 1 to 5,000 steps, or null"),
        ({"last_step": 5001}, "last_step", "a whole number from 1 to 5,000 steps, or null"),
        ({"first_step": 20, "last_step": 19}, "last_step", "a whole number from 20 to 5,000 steps, or null"),
        ({"first_step": 0}, "first_step", "a whole number from 1 to 10,000,000 steps, or null"),
    ],
)
def test_steps_that_are_not_there_are_refused(client: TestClient, given: dict, field: str, allowed: str) -> None:
    for path in ("profile", "errors"):
        answer = ask(client, path, **given, **({"methods": ["newton"]} if path == "errors" else {}))
        [error] = answer.json()["errors"]
        assert (answer.status_code, error["field"], error["allowed"]) == (422, field, allowed)


def raw(client: TestClient, encoding: str, steps: int, accept: str) -> tuple[Any, bytes]:
    headers = {"accept-encoding": encoding, "accept": accept}
    body = {"design": document(move__steps=steps)}
    with client.stream("POST", "/api/v1/profile", json=body, headers=headers) as answer:
        return answer.headers, b"".join(answer.iter_raw())


@pytest.mark.parametrize("accept", ["application/json", "text/csv"])
def test_a_long_answer_is_compressed_for_who_takes_that(client: TestClient, accept: str) -> None:
    _, plain = raw(client, "identity", 30_000, accept)
    headers, packed = raw(client, "deflate, gzip;q=0.8", 30_000, accept)
    assert headers["content-encoding"] == "gzip"
    assert gzip.decompress(packed) == plain
    assert len(packed) < 0.5 * len(plain)


def test_npz_is_compressed_by_itself(client: TestClient) -> None:
    headers, content = raw(client, "gzip", 30_000, "application/x-npz")
    assert "content-encoding" not in headers
    with np.load(io.BytesIO(content)) as arrays:
        assert len(content) < 0.5 * sum(each.nbytes for each in arrays.values())


@pytest.mark.parametrize(("encoding", "steps"), [("gzip;q=0", 30_000), ("br", 30_000), ("", 30_000), ("gzip", 200)])
def test_others_get_it_as_it_is(client: TestClient, encoding: str, steps: int) -> None:
    headers, content = raw(client, encoding, steps, "application/json")
    assert "content-encoding" not in headers
    assert len(json.loads(content)["step"]) == steps
