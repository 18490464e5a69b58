"""The library over HTTP: ETags, and what is answered where it can't be used."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from designs import design, document
from stepramp.library.database import FILE_NAME
from stepramp.library.library import About, Library

DESIGNS = "/api/v1/library/designs"


def test_a_design_is_kept_changed_and_compared(client: TestClient) -> None:
    made = client.post(DESIGNS, json={"design": document(), "tags": ["a"], "note": "first"})
    assert made.status_code == 200, made.text
    assert (made.json()["name"], made.headers["etag"]) == ("Test", '"1"')
    place = f"{DESIGNS}/{made.json()['id']}"
    payload = {"design": document(move__steps=5), "note": "shorter"}
    saved = client.post(f"{place}/revisions", json=payload, headers={"If-Match": '"1"'})
    assert saved.headers["etag"] == '"2"'
    late = client.post(f"{place}/revisions", json=payload, headers={"If-Match": '"1"'})
    assert late.status_code == 412
    assert "changed by somebody else" in late.json()["errors"][0]["message"]
    named = client.put(place, json={"name": "Lift", "tags": ["b"]}, headers={"If-Match": '"2"'})
    told = client.get(place)
    assert told.headers["etag"] == named.headers["etag"] == '"3"'
    assert (told.json()["name"], told.json()["tags"]) == ("Lift", ["b"])
    assert [each["note"] for each in told.json()["history"]] == ["shorter", "first"]
    assert client.get(f"{place}/revisions/1").json()["design"]["move"] == {"steps": 2000}
    assert client.get(f"{place}/revisions/1/differences/2").json() == {
        "differences": [{"field": "move.steps", "before": 2000, "after": 5}]
    }
    assert client.post(f"{place}/duplicate", json={"name": "Lift 2"}).json()["name"] == "Lift 2"
    found = client.post("/api/v1/library/search", json={"text": "lift"}).json()
    assert (found["count"], [each["name"] for each in found["designs"]]) == (2, ["Lift 2", "Lift"])


def test_a_change_says_of_which_version_it_is(client: TestClient) -> None:
    made = client.post(DESIGNS, json={"design": document()}).json()
    for given in (None, "*", "1", '"0"', 'W/"1"'):
        headers = {} if given is None else {"If-Match": given}
        refused = client.put(f"{DESIGNS}/{made['id']}", json={"name": "Lift"}, headers=headers)
        [error] = refused.json()["errors"]
        assert (refused.status_code, error["field"], error["value"]) == (422, "If-Match", given)
        assert error["allowed"].startswith("the ETag of the design")


def test_a_design_of_many_changes_is_changed_on(client: TestClient, tmp_path: Path) -> None:
    place = f"{DESIGNS}/{client.post(DESIGNS, json={'design': document()}).json()['id']}"
    with closing(sqlite3.connect(tmp_path / FILE_NAME)) as file, file:
        file.execute("UPDATE designs SET version = 2000000000")
    late = client.put(place, json={"name": "Lift"}, headers={"If-Match": '"9999999999"'})
    assert late.status_code == 412
    named = client.put(place, json={"name": "Lift"}, headers={"If-Match": client.get(place).headers["etag"]})
    assert (named.status_code, named.headers["etag"]) == (200, '"2000000001"')


def test_what_is_not_there_is_404(client: TestClient) -> None:
    assert client.get(f"{DESIGNS}/none").status_code == 404
    made = client.post(DESIGNS, json={"design": document()}).json()
    assert client.get(f"{DESIGNS}/{made['id']}/revisions/2").status_code == 404
    assert client.get(f"{DESIGNS}/{made['id']}/revisions/{10**30}").status_code == 404


def test_all_else_goes_on_without_the_library(client: TestClient, tmp_path: Path) -> None:
    (tmp_path / "library.sqlite3").mkdir()
    away = client.post("/api/v1/library/search", json={})
    assert away.status_code == 503
    assert "The library can't be used" in away.json()["errors"][0]["message"]
    assert client.post("/api/v1/profile", json={"design": document()}).status_code == 200
    (tmp_path / "library.sqlite3").rmdir()
    assert client.post("/api/v1/library/search", json={}).json() == {"count": 0, "designs": []}


@pytest.mark.parametrize("number", ["abc", "1.5", "0", "-1", "9" * 5000])
def test_what_is_no_number_of_a_revision_is_refused_in_words(client: TestClient, number: str) -> None:
    made = client.post(DESIGNS, json={"design": document()}).json()
    for path, field in ((number, "number"), (f"1/differences/{number}", "other")):
        refused = client.get(f"{DESIGNS}/{made['id']}/revisions/{path}")
        [error] = refused.json()["errors"]
        assert (refused.status_code, error["field"]) == (422, field)
        assert error["allowed"] == "the number of a revision, from 1 on"


UNREAD = "a name that can be read"
ESCAPE = "text without control characters; it has U+001B"


def test_names_that_nobody_can_read_are_refused_by_their_field(client: TestClient) -> None:
    kept = client.post(DESIGNS, json={"design": document()})
    place, tag = f"{DESIGNS}/{kept.json()['id']}", {"If-Match": kept.headers["etag"]}
    unnamed = {"design": document() | {"name": ""}}
    for refused, field, allowed in (
        (client.post(DESIGNS, json={"design": document(), "name": "  "}), "name", UNREAD),
        (client.post(DESIGNS, json=unnamed), "name", f"{UNREAD}, as the design has none of its own"),
        (client.post(DESIGNS, json={"design": document() | {"name": " "}}), "design.name", UNREAD),
        (client.post(DESIGNS, json={"design": document() | {"name": "a\x1b[2J"}}), "design.name", ESCAPE),
        (client.post(f"{place}/duplicate", json={"name": ""}), "name", UNREAD),
        (client.post(f"{place}/duplicate", json={"name": "a\x1b"}), "name", ESCAPE),
        (client.put(place, json={"name": "\u2003"}, headers=tag), "name", UNREAD),
    ):
        [error] = refused.json()["errors"]
        assert (refused.status_code, error["field"], error["allowed"]) == (422, field, allowed)
    assert client.post(DESIGNS, json=unnamed | {"name": "Lift"}).json()["name"] == "Lift"


@pytest.mark.parametrize(
    ("about", "field", "character"),
    [
        ({"name": "a\n"}, "name", "U+000A"),
        ({"name": "a", "tags": ["b", "c\x9b"]}, "tags.1", "U+009B"),
        ({"name": "a", "notes": "\x07"}, "notes", "U+0007"),
    ],
)
def test_control_characters_are_refused_where_they_are(
    client: TestClient, about: dict[str, object], field: str, character: str
) -> None:
    kept = client.post(DESIGNS, json={"design": document()})
    place = f"{DESIGNS}/{kept.json()['id']}"
    refused = client.put(place, json=about, headers={"If-Match": kept.headers["etag"]})
    [error] = refused.json()["errors"]
    assert (refused.status_code, error["field"]) == (422, field)
    assert error["allowed"].endswith(f"; it has {character}")
    lines = {"name": "a", "notes": "b\tc\r\nd\n"}
    assert client.put(place, json=lines, headers={"If-Match": kept.headers["etag"]}).json()["notes"] == lines["notes"]


def test_what_is_in_the_library_with_control_characters_is_read_found_and_imported(client: TestClient) -> None:
    library: Library = client.app.state.library  # type: ignore[attr-defined]
    kept = library.add(design(), About("\x1b", "\x07", ["\x9b"]))
    found = client.post("/api/v1/library/search", json={"text": "\x1b", "tags": ["\x9b"]}).json()
    assert [each["notes"] for each in found["designs"]] == ["\x07"]
    assert client.get(f"{DESIGNS}/{kept.id}").json()["name"] == "\x1b"
    copy = client.post(f"{DESIGNS}/{kept.id}/duplicate", json={"name": "Lift"}).json()
    assert (copy["notes"], copy["tags"]) == ("\x07", ["\x9b"])
    whole = client.get("/api/v1/library/file").content
    again = client.post("/api/v1/library/import", content=whole, headers={"content-type": "application/octet-stream"})
    assert again.json()["there_already"] == 2
