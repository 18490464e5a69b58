"""The whole library as a file, and into others: nothing is lost, and nothing overwritten."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest

from designs import design
from stepramp.errors import Rejected
from stepramp.library.database import Database
from stepramp.library.history import Device, History, Push
from stepramp.library.library import About, Library
from stepramp.library.records import Records
from stepramp.library.whole import Imported, Whole

GRBL = Device("grbl", "A1", "CH340 adapter on ttyUSB0", "/dev/ttyUSB0")


class Place:
    """A database, and all that is kept in it."""

    def __init__(self, database: Database) -> None:
        self.library, self.history = Library(database), History(database)
        self.records, self.whole = Records(database), Whole(database)

    def file(self) -> bytes:
        return b"".join(self.whole.lines())

    def add(self, content: bytes) -> Imported:
        return self.whole.add(BytesIO(content))

    def all(self) -> dict[str, Any]:
        """Return everything, without when the file was made."""
        return {str(at): json.loads(line) for at, line in enumerate(self.file().splitlines()[1:-1])}


@pytest.fixture
def filled(tmp_path: Path) -> Place:
    place = Place(Database(tmp_path / "filled"))
    lift = place.library.add(design(move__steps=5), About("Lift", "of Größe 7\n", ["b", "a"]), "first")
    place.library.save(lift.id, lift.version, design(move__steps=6), "second")
    place.library.add(design(), About("Other"))
    place.history.note_push(
        Push(GRBL, {0: design(move__steps=6), 1: design()}, "keep", "operate 1", {"verified": True})
    )
    place.history.note_push(Push(GRBL, {0: design()}, "try", trouble="It is gone."))
    place.records.add(lift.id, 2, "stall_map", {"levels": [1.5, None]}, "with the old drive")
    return place


@pytest.fixture
def empty(database: Database) -> Place:
    return Place(database)


def test_an_empty_library_becomes_the_same(filled: Place, empty: Place) -> None:
    assert empty.add(filled.file()) == Imported(designs=2, revisions=3, devices=1, pushes=2, records=1)
    assert empty.all() == filled.all()
    assert empty.library.search("größe")[0] == 1
    assert empty.history.pushes()[1] == filled.history.pushes()[1]


@pytest.mark.parametrize("rest", [b"", b"\r\n\r\n"])
def test_lines_may_end_as_windows_ends_them_and_empty_ones_may_follow(filled: Place, empty: Place, rest: bytes) -> None:
    assert empty.add(filled.file().replace(b"\n", b"\r\n") + rest).designs == 2
    assert empty.all() == filled.all()


def test_what_is_there_already_is_not_added_twice(filled: Place) -> None:
    before = filled.all()
    assert filled.add(filled.file()) == Imported(there_already=6)
    assert filled.all() == before


def test_a_design_gets_the_revisions_that_follow_those_it_has(filled: Place, empty: Place) -> None:
    older = filled.file()
    [lift] = filled.library.search("lift")[1]
    filled.library.save(lift.id, lift.version, design(move__steps=7), "third")
    empty.add(older)
    assert empty.add(filled.file()) == Imported(revisions=1, there_already=5)
    told, revisions = empty.library.get(lift.id)
    assert (told.version, [each.note for each in revisions]) == (3, ["third", "second", "first"])
    # An older file adds nothing, and takes nothing away.
    assert empty.add(older) == Imported(there_already=6)
    assert empty.library.get(lift.id)[0] == told


def test_what_two_libraries_say_of_a_design_is_joined(filled: Place, empty: Place) -> None:
    empty.add(filled.file())
    [lift] = filled.library.search("lift")[1]
    empty.library.describe(lift.id, lift.version, About("Lift of the gate", "of Größe 7\nquiet", ["a", "gate"]))
    filled.library.save(lift.id, lift.version, design(move__steps=7))
    assert filled.add(empty.file()) == Imported(described=1, there_already=6)
    told = filled.library.get(lift.id)[0]
    assert (told.name, told.notes, told.tags) == ("Lift", "of Größe 7\nquiet", ["b", "a", "gate"])
    assert (told.version, told.revisions) == (lift.version + 2, 3)
    assert filled.library.search("gate")[0] == 1
    assert empty.add(filled.file()) == Imported(revisions=1, described=1, there_already=5)
    again = empty.library.get(lift.id)[0]
    assert (again.name, again.notes, sorted(again.tags)) == (told.name, told.notes, sorted(told.tags))
    assert filled.add(empty.file()).described == 0


def test_a_record_is_of_a_revision_that_is_there(filled: Place, empty: Place) -> None:
    lines = list(filled.all().values())
    [record] = [each["record"] for each in lines if "record" in each]
    record["revision"] = 3
    with pytest.raises(Rejected, match=r"record.revision is 3; allowed: 1 to 2"):
        empty.add(ended(*lines))


def test_two_libraries_that_went_their_own_ways_have_both_of_each_after_a_file_each_way(
    filled: Place, empty: Place
) -> None:
    """However often, and whatever was saved in between."""
    empty.add(filled.file())
    [lift] = filled.library.search("lift")[1]
    for at in range(4):
        for steps, place in ((100 + at, filled), (200 + at, empty)):
            place.library.save(lift.id, place.library.get(lift.id)[0].version, design(move__steps=steps), f"{steps}")
        filled.add(empty.file())
        empty.add(filled.file())
        notes = [
            sorted([note.note for note in place.library.get(each.id)[1]] for each in place.library.search("lift")[1])
            for place in (filled, empty)
        ]
        both = [[f"{first + late}" for late in range(at, -1, -1)] + ["second", "first"] for first in (100, 200)]
        assert notes == [both, both]
    again = empty.add(filled.file())
    assert (again.designs, again.revisions, again.copies) == (0, 0, [])


def test_notes_that_differ_are_both_kept(filled: Place, empty: Place) -> None:
    empty.add(filled.file())
    [lift] = filled.library.search("lift")[1]
    filled.library.describe(lift.id, lift.version, About("Lift", "ours"))
    theirs = empty.library.describe(lift.id, lift.version, About("Lifter", "theirs"))
    filled.add(empty.file())
    told = filled.library.get(lift.id)[0]
    assert (told.name, told.notes, told.tags) == ("Lifter", "ours\n\ntheirs", [])
    empty.add(filled.file())
    assert empty.library.get(lift.id)[0].notes == told.notes
    empty.library.describe(lift.id, theirs.version + 1, About("Lifter", "n" * 19_990))
    with pytest.raises(Rejected, match=r"design.notes is 'n.*; allowed: with those that the library has, up to 20,000"):
        filled.add(empty.file())
    assert filled.library.get(lift.id)[0] == told


def test_a_design_that_went_another_way_is_added_beside(filled: Place, empty: Place) -> None:
    empty.add(filled.file())
    [lift] = filled.library.search("lift")[1]
    filled.library.save(lift.id, lift.version, design(move__steps=7), "theirs")
    filled.records.add(lift.id, 3, "trace", {"ticks": []})
    mine = empty.library.save(lift.id, lift.version, design(move__steps=8), "mine")
    made = empty.add(filled.file())
    assert (made.copies, made.designs, made.revisions, made.records) == (["Lift"], 1, 3, 1)
    assert empty.library.get(lift.id)[0] == mine
    [copy] = [each for each in empty.library.search("lift")[1] if each.id != lift.id]
    assert [each.note for each in empty.library.get(copy.id)[1]] == ["theirs", "second", "first"]
    assert [each.revision for each in empty.records.all(copy.id)] == [3]
    # The same file once more makes no other copy.
    again = empty.add(filled.file())
    assert (again.copies, again.designs, again.revisions, again.records) == ([], 0, 0, 0)


def test_a_device_was_seen_first_and_last_by_either(filled: Place, empty: Place) -> None:
    empty.history.note_device(replace(GRBL, port="/dev/ttyUSB7"))
    empty.add(filled.file())
    [told] = empty.history.devices()
    [theirs] = filled.history.devices()
    assert (told.first_seen_at, told.port, told.pushes) == (theirs.first_seen_at, "/dev/ttyUSB7", 2)


def ended(*lines: dict[str, Any]) -> bytes:
    """Return a whole file of these lines."""
    head = {"stepramp_library": 1, "saved_at": "2026-01-31T12:00:00Z"}
    content = b"".join(json.dumps(line).encode() + b"\n" for line in (head, *lines))
    end = {"end": {"lines": len(lines) + 1, "sha256": hashlib.sha256(content).hexdigest()}}
    return content + json.dumps(end).encode() + b"\n"


ID = "0" * 32
TIME = "2026-01-31T12:00:00Z"
DESIGN = {"design": {"id": ID, "name": "A", "notes": "", "version": 1, "saved_at": TIME, "tags": []}}
REVISION = {
    "revision": {
        "design_id": ID, "number": 1, "note": "", "saved_at": TIME,
        "design": design().model_dump(mode="json", by_alias=True),
    }
}  # fmt: skip
AXIS = {"pushed_axis": {"push_id": ID, "axis": 0, "name": "A", "design": REVISION["revision"]["design"]}}
PUSH = {
    "push": {
        "id": ID, "device_id": ID, "pushed_at": TIME, "client": None, "mode": "try", "trouble": None, "report": None,
        "backup": None,
    }
}  # fmt: skip
RECORD = {
    "record": {
        "id": ID, "design_id": ID, "revision": 1, "kind": "trace", "note": "", "content": {}, "kept_at": TIME,
    }
}  # fmt: skip


def kept(content: dict[str, Any]) -> dict[str, Any]:
    return changed(RECORD, content=content)


def nested(levels: int) -> dict[str, Any]:
    inner: dict[str, Any] = {}
    for _ in range(levels - 1):
        inner = {"a": inner}
    return inner


def changed(line: dict[str, Any], **values: object) -> dict[str, Any]:
    [(name, said)] = line.items()
    return {name: said | values}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (lambda _: b"", "file is ''; allowed: a library that StepRamp has saved"),
        (lambda _: b"\n\n", "a library that StepRamp has saved"),
        (lambda whole: whole + b"{}", "allowed: a whole file: its last line"),
        (lambda whole: whole[:-1] + b" " * 9_000_000, r"lines.1[0-9] is .*; allowed: a line of up to 8,388,608 bytes"),
        (lambda _: b"\xff\x00" * 5000, "a library that StepRamp has saved"),
        (lambda _: b"[" * 100_000, "a library that StepRamp has saved"),
        (lambda whole: whole[:-1000], "allowed: a whole file: its last line"),
        (lambda whole: b"\n".join(whole.splitlines()[:-2]) + b"\n", "allowed: a whole file: its last line"),
        (lambda whole: whole.replace(b'"second"', b'"secons"'), "allowed: a whole file: its last line"),
        (lambda whole: whole.replace(b'"stepramp_library":1', b'"stepramp_library":2'), "of a newer StepRamp"),
        (lambda _: ended(DESIGN), "one with revisions after it"),
        (lambda _: ended(REVISION), "the id of the design before it"),
        (lambda _: ended(changed(DESIGN, version=2_000_000_001), REVISION), "from 1 to 2,000,000,000"),
        (lambda _: ended(DESIGN, changed(REVISION, number=2)), "allowed: 1, as they are counted"),
        (lambda _: ended(DESIGN, REVISION, AXIS), "the id of a push before it"),
        (lambda _: ended(DESIGN, REVISION, PUSH), "the id of a device before it"),
        (lambda _: ended(RECORD), "the id of a design before it"),
        (lambda _: ended({"desing": {}}), "lines.2.document is 'desing'; allowed: one of design, revision"),
        (lambda _: ended({}), "lines.2.document"),
        (lambda _: ended(changed(DESIGN, id="x")), "lines.2.id is 'x'; allowed: 32 of the letters"),
        (lambda _: ended(changed(DESIGN, saved_at="yesterday")), "lines.2.saved_at is 'yesterday'; allowed: a time"),
        (lambda _: ended(changed(DESIGN, name="a\0")), "lines.2.name is .*; allowed: text without"),
        (lambda _: ended(changed(DESIGN, color=1)), "lines.2.color is 1; allowed: nothing; there is no such field"),
        (lambda _: ended(DESIGN, REVISION, kept({"a": math.inf})), "lines.4.content is .* are finite"),
        (lambda _: ended(DESIGN, REVISION, kept({"a": [2**63]})), "whole numbers have up to 64 bits"),
        (lambda _: ended(DESIGN, REVISION, kept(nested(40))), "lines.4.content is .* up to 32 levels"),
        (lambda _: ended(changed(PUSH, report={"a": -math.inf})), "lines.2.report is .* are finite"),
        (lambda _: ended(DESIGN, changed(REVISION, design={})), "lines.3.design"),
        (lambda _: ended(DESIGN, REVISION, changed(RECORD, kind="song")), "lines.4.kind is 'song'; allowed: trace,"),
        (lambda _: ended(DESIGN, changed(REVISION, note=[[]] * 50_000)), "lines.3.document .*values"),
    ],
)  # fmt: skip
def test_what_is_no_whole_library_changes_nothing(
    filled: Place, tmp_path: Path, content: Callable[[bytes], bytes], words: str
) -> None:
    empty = Place(Database(tmp_path / "empty"))
    empty.library.add(design(), About("Mine"))
    before = empty.all()
    with pytest.raises(Rejected, match=words):
        empty.add(content(filled.file()))
    assert empty.all() == before
