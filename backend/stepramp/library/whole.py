"""The whole library as one file, and such a file into a library: nothing that is there is overwritten by it.

A file is lines of JSON: what it is, then each design with its revisions, each device, each push with its axes, and each
record; at last how many lines there were and the SHA-256 of them.
"""

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, BinaryIO

from sqlalchemy import Connection, RowMapping, Table, insert, select, update

from stepramp.errors import Rejected, Rejection
from stepramp.library.database import Database
from stepramp.library.library import About, Kept, add_design, change_about, kept_of
from stepramp.library.schema import DESIGNS, DEVICES, PUSHED_AXES, PUSHES, RECORDS, REVISIONS, TAGS
from stepramp.library.texts import as_text, hash_of, now
from stepramp.library.whole_lines import (
    FORMAT,
    MOST_NOTES,
    MOST_TAGS,
    VERSION,
    DesignLine,
    DeviceLine,
    Line,
    PushedAxisLine,
    PushLine,
    RecordLine,
    RevisionLine,
    checked_lines,
    whole_lines,
)

ROWS_AT_ONCE = 50


@dataclass
class Imported:
    """What an import has added, and what was there already."""

    designs: int = 0
    revisions: int = 0
    devices: int = 0
    pushes: int = 0
    records: int = 0
    there_already: int = 0
    described: int = 0
    """Designs that were there, of which the file says more, or has a later name."""
    copies: list[str] = field(default_factory=list)
    """Names of designs that differ from what the library has of them, and were added beside those."""


class Whole:
    """The whole of one database. For any thread."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def lines(self) -> Iterator[bytes]:
        """Yield the lines of a file with everything, as of one moment."""
        digest, count = hashlib.sha256(), 0
        with self._database.reading() as connection:
            for each in _documents(connection):
                line = as_text(each).encode() + b"\n"
                digest.update(line)
                count += 1
                yield line
        yield as_text({"end": {"lines": count, "sha256": digest.hexdigest()}}).encode() + b"\n"

    def add(self, file: BinaryIO) -> Imported:
        """Add what a file has and the library hasn't: all of it, or nothing.

        A design that is there gets the revisions that follow those it has, and what the file says of it beyond what is
        said there; where it has other revisions, that of the file is added as a design of its own. Raises Rejected,
        naming the line, for a file that isn't whole or not such a one, and for notes or tags that are too many.
        """
        lines = whole_lines(file)
        with self._database.writing() as connection:
            return _Import(connection).add(checked_lines(lines))


def _documents(connection: Connection) -> Iterator[dict[str, Any]]:
    yield {FORMAT: VERSION, "saved_at": now()}
    for row in _rows(connection, DESIGNS):
        tags = select(TAGS.c.tag).where(TAGS.c.design_id == row["id"]).order_by(TAGS.c.place)
        about = {name: row[name] for name in ("id", "name", "notes", "version", "saved_at")}
        yield {"design": about | {"tags": list(connection.execute(tags).scalars())}}
        saved = select(REVISIONS).where(REVISIONS.c.design_id == row["id"]).order_by(REVISIONS.c.number)
        for each in connection.execute(saved).mappings():
            about = {name: each[name] for name in ("design_id", "number", "note", "saved_at")}
            yield {"revision": about | {"design": json.loads(each["content"])}}
    for row in _rows(connection, DEVICES):
        yield {"device": row}
    for row in _rows(connection, PUSHES):
        yield {"push": row | {"report": None if row["report"] is None else json.loads(row["report"])}}
        chosen = select(PUSHED_AXES).where(PUSHED_AXES.c.push_id == row["id"]).order_by(PUSHED_AXES.c.axis)
        for each in connection.execute(chosen).mappings():
            about = {name: each[name] for name in ("push_id", "axis", "name")}
            yield {"pushed_axis": about | {"design": json.loads(each["content"])}}
    for row in _rows(connection, RECORDS):
        yield {"record": row | {"content": json.loads(row["content"])}}


def _rows(connection: Connection, table: Table) -> Iterator[dict[str, Any]]:
    """Yield the rows of a table by their ids, not all at once."""
    last = ""
    chosen = select(table).order_by(table.c.id).limit(ROWS_AT_ONCE)
    while found := [dict(row) for row in connection.execute(chosen.where(table.c.id > last)).mappings()]:
        yield from found
        last = found[-1]["id"]


class _Import:
    """Adds lines over a connection, within its transaction."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._made = Imported()
        self._called: dict[str, str] = {}
        """What the designs of the file are called in the library."""
        self._counts: dict[str, int] = {}
        """How many revisions those have by then."""
        self._own_ways: dict[str, str] | None = None
        """Designs that were there, by what those are called that part from others with each of their revisions."""
        self._pushes: dict[str, bool] = {}
        """Pushes of the file, and whether they were there."""
        self._design: DesignLine | None = None
        self._revisions: list[RevisionLine] = []

    def add(self, lines: Iterable[Line]) -> Imported:
        """Add all; raises Rejected for a revision, an axis or a record of nothing that comes before it."""
        for line in lines:
            if isinstance(line, RevisionLine):
                self._take_revision(line)
                continue
            self._end_design()
            match line:
                case DesignLine():
                    self._design = line
                case DeviceLine():
                    self._add_device(line)
                case PushLine():
                    self._add_push(line)
                case PushedAxisLine():
                    self._add_axis(line)
                case RecordLine():
                    self._add_record(line)
        self._end_design()
        return self._made

    def _take_revision(self, line: RevisionLine) -> None:
        if self._design is None or line.design_id != self._design.id:
            raise _stray("revision.design_id", line.design_id, "the id of the design before it")
        if line.number != len(self._revisions) + 1:
            raise _stray("revision.number", line.number, f"{len(self._revisions) + 1:,}, as they are counted")
        self._revisions.append(line)

    def _end_design(self) -> None:
        """Add the design whose revisions have all come."""
        if self._design is None:
            return
        design, revisions = self._design, self._revisions
        self._design, self._revisions = None, []
        if not revisions:
            raise _stray("design.id", design.id, "one with revisions after it")
        given = [hash_of(as_text(each.design)) for each in revisions]
        called, there = self._place_of(design.id, given)
        if called != design.id and not there:
            self._made.copies.append(design.name)
        self._counts[design.id] = max(len(given), len(there))
        self._add_design(design, called, revisions, len(there))

    def _place_of(self, design_id: str, given: list[str]) -> tuple[str, list[str]]:
        """Return what a design of a file is called here, and the revisions, as hashes, that are there of it.

        One that has gone another way is beside that which is there, called by the revision at which they part: so it is
        found again, however long it has become.
        """
        there = self._hashes(design_id)
        if not there:
            design_id = self._own_way_called(design_id)
            there = self._hashes(design_id)
        while (parts_at := _parting(given, there)) is not None:
            design_id = _way_called(design_id, parts_at, given[parts_at])
            there = self._hashes(design_id)
        return design_id, there

    def _own_way_called(self, design_id: str) -> str:
        """Return the design that another library has beside its own by that id; without one, that id."""
        if self._own_ways is None:
            chosen = select(REVISIONS.c.design_id, REVISIONS.c.number, REVISIONS.c.content_hash)
            rows = self._connection.execute(chosen)
            self._own_ways = {_way_called(of, number - 1, revision): of for of, number, revision in rows}
        return self._own_ways.get(design_id, design_id)

    def _hashes(self, design_id: str) -> list[str]:
        chosen = select(REVISIONS.c.content_hash).where(REVISIONS.c.design_id == design_id).order_by(REVISIONS.c.number)
        return list(self._connection.execute(chosen).scalars())

    def _add_design(self, design: DesignLine, called: str, revisions: Sequence[RevisionLine], there: int) -> None:
        """Add the revisions beyond those that are there, and the design where there are none."""
        self._called[design.id] = called
        more = revisions[there:]
        if not there:
            about = About(design.name, design.notes, design.tags)
            add_design(self._connection, called, about, design.version, design.saved_at)
            self._made.designs += 1
        else:
            self._describe(design, called)
        if there and more:
            self._count(called, len(more))
        elif there:
            self._made.there_already += 1
        for each in more:
            row = {"design_id": called, "number": each.number, "note": each.note, "saved_at": each.saved_at}
            content = as_text(each.design)
            self._connection.execute(insert(REVISIONS).values(**row, content=content, content_hash=hash_of(content)))
        self._made.revisions += len(more)

    def _describe(self, design: DesignLine, called: str) -> None:
        """Add to what is said of a design that is there."""
        present = kept_of(self._connection, called)
        said = _joined(present, design)
        if said != About(present.name, present.notes, present.tags):
            change_about(self._connection, called, said)
            self._count(called, 1)
            self._made.described += 1

    def _count(self, called: str, changes: int) -> None:
        count = update(DESIGNS).where(DESIGNS.c.id == called)
        self._connection.execute(count.values(version=DESIGNS.c.version + changes, saved_at=now()))

    def _add_device(self, line: DeviceLine) -> None:
        there = self._row(DEVICES, line.id)
        if there is None:
            self._connection.execute(insert(DEVICES).values(line.model_dump()))
            self._made.devices += 1
            return
        seen = {"first_seen_at": min(there["first_seen_at"], line.first_seen_at)}
        if line.last_seen_at > there["last_seen_at"]:
            seen |= {"last_seen_at": line.last_seen_at, "name": line.name, "port": line.port}
        self._connection.execute(update(DEVICES).where(DEVICES.c.id == line.id).values(seen))
        self._made.there_already += 1

    def _add_push(self, line: PushLine) -> None:
        if self._row(DEVICES, line.device_id) is None:
            raise _stray("push.device_id", line.device_id, "the id of a device before it")
        self._pushes[line.id] = self._row(PUSHES, line.id) is not None
        if self._pushes[line.id]:
            self._made.there_already += 1
            return
        report = None if line.report is None else as_text(line.report)
        self._connection.execute(insert(PUSHES).values(line.model_dump() | {"report": report}))
        self._made.pushes += 1

    def _add_axis(self, line: PushedAxisLine) -> None:
        if line.push_id not in self._pushes:
            raise _stray("pushed_axis.push_id", line.push_id, "the id of a push before it")
        if not self._pushes[line.push_id]:
            content = as_text(line.design)
            row = line.model_dump(exclude={"design"}) | {"content": content, "content_hash": hash_of(content)}
            self._connection.execute(insert(PUSHED_AXES).values(row))

    def _add_record(self, line: RecordLine) -> None:
        design_id = self._called.get(line.design_id)
        if design_id is None:
            raise _stray("record.design_id", line.design_id, "the id of a design before it")
        if line.revision > self._counts[line.design_id]:
            raise _stray("record.revision", line.revision, f"1 to {self._counts[line.design_id]:,}, as the design has")
        if self._row(RECORDS, line.id) is not None:
            self._made.there_already += 1
            return
        row = line.model_dump() | {"design_id": design_id, "content": as_text(line.content)}
        self._connection.execute(insert(RECORDS).values(row))
        self._made.records += 1

    def _row(self, table: Table, called: str) -> RowMapping | None:
        return self._connection.execute(select(table).where(table.c.id == called)).mappings().one_or_none()


def _parting(given: list[str], there: list[str]) -> int | None:
    """Return from which place on two histories differ; None where one only goes on from the other."""
    pairs = zip(given, there, strict=False)
    return next((at for at, (one, other) in enumerate(pairs) if one != other), None)


def _way_called(design_id: str, parts_at: int, revision: str) -> str:
    return hash_of(as_text([design_id, parts_at, revision]))[:32]


def _joined(present: Kept, given: DesignLine) -> About:
    """Return what two libraries say of a design: the later name, the notes of both, the tags of either.

    Raises Rejected where that is more than a file can have.
    """
    notes = next(
        (one for one, other in ((present.notes, given.notes), (given.notes, present.notes)) if other in one),
        f"{present.notes}\n\n{given.notes}",
    )
    tags = list(dict.fromkeys([*present.tags, *given.tags]))
    for name, length, most in (("notes", len(notes), MOST_NOTES), ("tags", len(tags), MOST_TAGS)):
        if length > most:
            allowed = f"with those that the library has, up to {most:,}, not {length:,}"
            raise _stray(f"design.{name}", getattr(given, name), allowed)
    return About(given.name if given.saved_at > present.saved_at else present.name, notes, tags)


def _stray(field: str, value: object, allowed: str) -> Rejected:
    return Rejected([Rejection(f"file: {field}", value, allowed)])
