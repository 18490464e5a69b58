import json
from collections.abc import Iterator
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from stepramp import json_text
from stepramp.errors import Overloaded
from stepramp.http_api import bodies
from stepramp.http_api.bodies import LARGE_BYTES, MOST_BYTES, Room

PROFILE = "/api/v1/profile"
DEVICES = "/api/v1/devices"
JSON = {"content-type": "application/json"}
LONGEST_ANSWER_BYTES = 20_000


def errors_of(response: Any, status: int) -> list[dict[str, Any]]:
    assert response.status_code == status, response.text[:1000]
    assert response.headers["content-type"] == "application/json"
    assert len(response.content) < LONGEST_ANSWER_BYTES
    body = response.json()
    assert set(body) == {"errors"}
    assert all({"field", "value", "allowed", "message"} <= set(error) for error in body["errors"])
    errors: list[dict[str, Any]] = body["errors"]
    return errors


def asked(client: TestClient, route: str, body: object) -> Any:
    content = body if isinstance(body, bytes) else json.dumps(body, separators=(",", ":")).encode()
    return client.post(route, content=content, headers=JSON)


def test_a_body_that_is_too_large_is_refused(client: TestClient) -> None:
    [error] = errors_of(asked(client, PROFILE, b" " * (MOST_BYTES + 1)), 413)
    assert "up to 2,000,000 bytes" in error["message"]
    assert errors_of(asked(client, PROFILE, b" " * MOST_BYTES), 422)


def test_a_body_of_unknown_length_is_read_no_further_than_it_may_be_large(client: TestClient) -> None:
    read = []

    def chunks() -> Iterator[bytes]:
        for number in range(1000):
            read.append(number)
            yield b" " * 100_000

    [error] = errors_of(client.post(PROFILE, content=chunks(), headers=JSON), 413)
    assert "up to 2,000,000 bytes" in error["message"]


def test_a_large_design_is_understood(client: TestClient) -> None:
    rows = [[index, 5000 - index] for index in range(1000)]
    body = {"design": document(table__rows=rows), "max_points": 10}
    text = json.dumps(body, indent=4).encode()
    assert len(text) > LARGE_BYTES
    large = asked(client, PROFILE, text)
    assert large.status_code == 200
    assert large.json() == asked(client, PROFILE, {"design": document(), "max_points": 10}).json()


def test_what_is_wrong_with_a_large_body_is_told_as_with_a_small_one(client: TestClient) -> None:
    wrong = {"design": document(timer__frequency_hz=5), "points": 1}
    small = asked(client, PROFILE, wrong)
    large = asked(client, PROFILE, json.dumps(wrong).encode() + b" " * LARGE_BYTES)
    assert errors_of(large, 422) == errors_of(small, 422)
    assert {error["field"] for error in large.json()["errors"]} == {"design.timer.frequency_hz", "points"}


def test_only_large_bodies_take_a_thread(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []

    class Noted:
        async def run(self, job: partial[object]) -> object:
            sizes.append(len(job.args[0]))
            return job()

    monkeypatch.setattr(bodies, "CHECKING", Noted())
    body = json.dumps({"design": document()}).encode()
    for size in (LARGE_BYTES, LARGE_BYTES + 1):
        assert asked(client, PROFILE, body + b" " * (size - len(body))).status_code == 200
    assert sizes == [LARGE_BYTES + 1]


@pytest.mark.parametrize("count", [21, 25, 30_000])
def test_twenty_errors_are_told_and_how_many_more(client: TestClient, count: int) -> None:
    wrong = {"design": document()} | {f"field {number}": number for number in range(count)}
    errors = errors_of(asked(client, PROFILE, wrong), 422)
    assert [error["field"] for error in errors[:20]] == [f"field {number}" for number in range(20)]
    [more] = errors[20:]
    left = "One more value" if count == 21 else f"{count - 20:,} more values"
    assert (more["field"], more["message"]) == (None, f"{left} can't be used.")


def test_unknown_fields_within_fields_are_counted_too(client: TestClient) -> None:
    wrong = {"design": document(surprise=1)} | {f"field {number}": 1 for number in range(30)}
    wrong["design"]["axis"] |= {f"field {number}": 1 for number in range(50)}
    *_, more = errors_of(asked(client, PROFILE, wrong), 422)
    assert more["message"] == "61 more values can't be used."


def play(**changed: object) -> dict[str, object]:
    table = {"rows": [[10, 5000]]}
    return {"table": table, "range_steps": 10, "targets": [{"at_us": 0, "target": 1}]} | changed


TARGET = {"at_us": 0, "target": 1}


@pytest.mark.parametrize(
    ("route", "body", "field", "value", "allowed"),
    [
        ("table/play", play(targets=[TARGET] * 10_001), "targets", "10,001 items", "up to 10,000 targets"),
        ("table/play", play(targets=[{}] * 15_000), "targets", "15,000 items", "up to 10,000 targets"),
        ("table/check", {"rows": []}, "rows", "0 items", "1 to 1,000 rows"),
        ("table/check", {"rows": [[1]] * 1001}, "rows", "1,001 items", "1 to 1,000 rows"),
        ("profile", {"design": document(table__rows=[0] * 30_000)}, "design.table.rows", "30,000 items", "1,000 rows"),
        ("schedule", {"designs": [5] * 5, "mode": "line"}, "designs", "5 items", "1 to 4 designs"),
        ("errors", {"design": document(), "methods": ["x"] * 21}, "methods", "21 items", "up to 20 method names"),
        ("curves", {"design": document(), "methods": ["x"] * 21}, "methods", "21 items", "up to 20 method names"),
    ],
)  # fmt: skip
def test_the_length_of_a_list_is_checked_before_its_items(
    client: TestClient, route: str, body: object, field: str, value: str, allowed: str
) -> None:
    [error] = errors_of(asked(client, f"/api/v1/{route}", body), 422)
    assert (error["field"], error["value"]) == (field, value)
    assert allowed in error["allowed"]


MANY = {
    "pairs": b'{"rows":[' + b"[1,2]," * 300_000 + b"[1,2]]}",
    "empty lists": b'{"rows":[' + b"[]," * 600_000 + b"[]]}",
    "numbers": b'{"rows":[' + b"1," * 900_000 + b"1]}",
    "texts": rb'{"rows":["\",[\\"' + rb',"\\\""' * 200_000 + b"]}",
    "objects in no list": b'{"a":' * 300_000,
    "40,001": b"[" + b"0," * 39_999 + b"0]",
}


@pytest.mark.parametrize("body", MANY.values(), ids=MANY.keys())
def test_a_body_of_more_values_than_any_has_is_refused_before_it_is_parsed(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, body: bytes
) -> None:
    """To parse it, nothing else goes on in between: a stop would wait."""
    parsed: list[str] = []
    monkeypatch.setattr(json_text, "json", SimpleNamespace(loads=lambda text, **_: parsed.append(text)))
    for route in ("/api/v1/table/check", f"{DEVICES}/1/move"):
        [error] = errors_of(asked(client, route, body), 422)
        assert (error["field"], error["allowed"]) == ("document", "at most 40,000 values")
    assert parsed == []


def test_the_largest_bodies_are_not_refused_for_their_many_values(client: TestClient) -> None:
    table = {"rows": [[index + 1, 5000] for index in range(1000)]}
    answer = asked(client, "/api/v1/table/play", play(table=table, targets=[TARGET] * 10_000))
    assert answer.status_code == 200


def test_what_stands_in_a_text_are_no_values(client: TestClient) -> None:
    """Also behind a quote or a backslash that is escaped."""
    for text in ("[1,2]," * 10_000, '"[{,' * 20_000, "\\" + "{," * 30_000, '\\"' + "{," * 30_000):
        [error] = errors_of(asked(client, PROFILE, {"design": document(name=text)}), 422)
        assert error["field"] == "design.name"
        [error] = errors_of(asked(client, PROFILE, [text, *[0] * 40_000]), 422)
        assert (error["field"], error["value"]) == ("document", "40,002 values")


def test_wrong_targets_are_not_all_told(client: TestClient) -> None:
    wrong = play(targets=[{str(number): 0 for number in range(2)}] * 10_000)
    errors = errors_of(asked(client, "/api/v1/table/play", wrong), 422)
    assert {error["field"].rpartition(".")[0] for error in errors} == {"targets.0"}


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("x" * 1_000_000, "x" * 200 + "… (1,000,000 characters)"),
        (10**4000, "1" + "0" * 199 + "… (4,001 characters)"),
        ([0] * 21, "a list of 21 items"),
        ([[[[[0]]]]], [[["a list of 1 items"]]]),
        ([["y" * 100] * 10] * 10, "a list of 10 items"),
        ({str(number): 0 for number in range(21)}, "an object of 21 fields"),
        ({"z" * 300: None}, {"z" * 200 + "… (300 characters)": None}),
    ],
)
def test_values_are_told_in_short(client: TestClient, value: object, told: object) -> None:
    [error] = errors_of(asked(client, PROFILE, {"design": document(), "max_points": value}), 422)
    assert error["value"] == told
    assert len(error["message"]) < 300


@pytest.mark.parametrize(
    "body",
    [
        b"[" * 900 + b"]" * 900,
        b"[" * 100_000 + b"]" * 100_000,
        b'{"design":' * 900 + b"1" + b"}" * 900,
        b'{"max_points": ' + b"[" * 900 + b"]" * 900 + b"}",
        b'{"max_points": ' + b"9" * 4290 + b"}",
        b'{"max_points": ' + b"9" * 100_000 + b"}",
        b'{"max_points": -1e400}',
        b"\xff\xfe\x00",
        b'"\xed\xa0\x80"',
        "{}".encode("utf-16"),
        b"{} {}",
        b'{"a": 1,}',
        b"\0",
    ],
    ids=lambda body: repr(body[:20]),
)
def test_odd_json_is_refused(client: TestClient, body: bytes) -> None:
    assert errors_of(asked(client, PROFILE, body), 422)


@pytest.mark.parametrize(
    ("route", "body", "field"),
    [
        (PROFILE, b'{"design": {"name": "\\ud800"}}', "design.name"),
        (PROFILE, b'{"design": {"a": [0, {"b": "\\uDFFFx"}]}}', "design.a.1.b"),
        (PROFILE, b'{"design": {"n\\ud800": 1}}', "design.n\\ud800"),
        (PROFILE, b'"\\udead"', "document"),
        (DEVICES, b'{"port": "\\ud83d"}', "port"),
        ("/api/v1/export/csv", b'{"name": "\\ud83d"}', "name"),
    ],
)
def test_halves_of_surrogate_pairs_are_refused(client: TestClient, route: str, body: bytes, field: str) -> None:
    [error] = errors_of(asked(client, route, body), 422)
    assert (error["field"], error["allowed"]) == (field, "text without halves of surrogate pairs")


@pytest.mark.parametrize(
    ("route", "body", "field", "values"),
    [
        (PROFILE, b'{"max_points": 10, "design": {}, "max_points": 20}', "max_points", [10, 20]),
        (PROFILE, b'{"design": {"move": {"steps": 5, "steps": 6, "steps": 5}}}', "design.move.steps", [5, 6, 5]),
        (PROFILE, b'{"a": {"b": 1, "b": 1}, "a": 2}', "a", [{"b": 1}, 2]),
        (PROFILE, b'{"a": [0, {"\\u0062": 1, "b": {}}]}', "a.1.b", [1, {}]),
        (DEVICES, b'{"port": "sim://", "port": "sim://other"}', "port", ["sim://", "sim://other"]),
    ],
)
def test_a_field_that_is_given_twice_is_refused(
    client: TestClient, route: str, body: bytes, field: str, values: list[object]
) -> None:
    """Which of its values is meant, nobody knows."""
    for padding in (b"", b" " * LARGE_BYTES):
        [error] = errors_of(asked(client, route, body + padding), 422)
        assert (error["field"], error["value"], error["allowed"]) == (field, values, "one value, given once")


def test_of_thirty_thousand_fields_the_one_given_twice_is_found_soon(client: TestClient) -> None:
    fields = ",".join(f'"{number}":0' for number in (*range(30_000), 29_999))
    [error] = errors_of(asked(client, PROFILE, f"{{{fields}}}".encode()), 422)
    assert (error["field"], error["value"]) == ("29999", [0, 0])


def test_whole_surrogate_pairs_are_text(client: TestClient) -> None:
    escaped = json.dumps({"designs": [document(name="\U0001f680")], "mode": "line", "max_points": 10}).encode()
    assert b"\\ud83d\\ude80" in escaped
    assert asked(client, "/api/v1/schedule", escaped).json()["axes"][0]["name"] == "\U0001f680"


@pytest.mark.parametrize("kind", [None, "", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data",
                                  "application/jsonx", "application/json/x", ";", "x" * 1000])  # fmt: skip
@pytest.mark.parametrize("route", [PROFILE, "/api/v1/table/check", "/api/v1/export/csv", DEVICES])
def test_bodies_of_another_type_are_refused(client: TestClient, route: str, kind: str | None) -> None:
    headers = {} if kind is None else {"content-type": kind.encode("latin-1")}
    [error] = errors_of(client.post(route, content=b"\xff\x00{}", headers=headers), 415)
    assert error["message"].startswith(
        f"The Content-Type header is {'missing' if kind is None else chr(39) + kind[:60]}"
    )
    assert error["message"].endswith("allowed: application/json.")
    assert (error["field"], error["allowed"]) == ("Content-Type", "application/json")


@pytest.mark.parametrize("charset", ["latin-1", "UTF-16", '"iso-8859-1"', "utf-8; charset=latin-1", ""])
def test_json_in_other_charsets_is_refused(client: TestClient, charset: str) -> None:
    kind = f"application/json; charset={charset}"
    response = client.post(PROFILE, content=json.dumps({"design": document()}), headers={"content-type": kind})
    [error] = errors_of(response, 415)
    allowed = "application/json with charset utf-8 or us-ascii, or without one"
    assert error["message"] == f"The Content-Type header is {kind!r}; allowed: {allowed}."


@pytest.mark.parametrize("route", [PROFILE, "/api/v1/capture"])
@pytest.mark.parametrize("encodings", [["gzip"], ["identity, br"], ["identity", "zstd"]])
def test_compressed_bodies_are_refused(client: TestClient, route: str, encodings: list[str]) -> None:
    kind = "application/json" if route == PROFILE else "application/octet-stream"
    headers = [("content-type", kind), *(("content-encoding", each) for each in encodings)]
    [error] = errors_of(client.post(route, content=b"\x1f\x8b\x08", headers=headers), 415)
    told = ", ".join(encodings)
    assert error["message"] == f"The Content-Encoding header is {told!r}; allowed: identity, or none."
    assert (error["field"], error["value"], error["allowed"]) == ("Content-Encoding", told, "identity, or none")


def test_a_body_that_says_it_is_not_compressed_is_taken(client: TestClient) -> None:
    answer = client.post(PROFILE, json={"design": document()}, headers={"content-encoding": "Identity"})
    assert answer.status_code == 200


@pytest.mark.parametrize("kind", ["application/json", "Application/JSON; charset=utf-8", "application/json ;x",
                                  'application/json;version=1; Charset="UTF-8"', "application/json;charset=US-ASCII",
                                  "application/json; charset=utf8"])  # fmt: skip
def test_json_is_known_however_it_is_written(client: TestClient, kind: str) -> None:
    body = json.dumps({"design": document(), "max_points": 10}).encode()
    assert client.post(PROFILE, content=body, headers={"content-type": kind}).status_code == 200


def test_a_table_whose_rows_all_end_at_0_is_checked(client: TestClient) -> None:
    answer = asked(client, "/api/v1/table/check", {"rows": [[0, 171], [0, 5253]]})
    assert answer.status_code == 200
    assert "does not increase" in answer.json()["findings"][0]["reason"]


def test_large_bodies_have_only_so_much_room_together_and_small_ones_always_have_some() -> None:
    room = Room(50_000)
    with room.held() as first, room.held() as second, room.held() as small:
        first(LARGE_BYTES)
        first(30_000)
        small(LARGE_BYTES)
        second(LARGE_BYTES + 1)
        second(20_000)
        with pytest.raises(Overloaded):
            second(20_001)
        with pytest.raises(Overloaded):
            first(30_001)
        small(LARGE_BYTES)
    with room.held() as next_one:
        next_one(50_000)
        with pytest.raises(Overloaded):
            next_one(50_001)


@pytest.mark.parametrize(
    ("body", "allowed"),
    [
        (json.dumps({"design": {}}).encode("utf-16"), "JSON in UTF-8, not compressed"),
        (b"\x1f\x8b\x08\x00", "JSON in UTF-8, not compressed"),
        (b"", "JSON (It is empty.)"),
        (b'{"design": {},\n }', "JSON (It can't be read from line 2, column 2 on.)"),
        (b"{} and more", "JSON (It can't be read from line 1, column 4 on.)"),
        (b'{"max_points": ' + b"1" * 5000 + b"}", "JSON (It has a number of more than 4,300 digits.)"),
    ],
)
def test_a_body_that_can_not_be_read_says_why_in_words(client: TestClient, body: bytes, allowed: str) -> None:
    [error] = errors_of(asked(client, PROFILE, body), 422)
    assert (error["field"], error["allowed"]) == ("body", allowed)
