"""Designs that are kept: named, tagged, with notes, and with every save as a revision of its own."""

import json
import uuid
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Connection, RowMapping, delete, func, insert, select, update

from stepramp.design import Design
from stepramp.errors import NotFound, Outdated, shown
from stepramp.library.database import Database
from stepramp.library.schema import DESIGNS, REVISIONS, TAGS
from stepramp.library.texts import ID, content_of, hash_of, now, refuse_nul

_NUMBERS = range(1, 2**31)
"""What databases can count."""


@dataclass(frozen=True)
class About:
    """What people say of a design."""

    name: str
    notes: str = ""
    tags: Sequence[str] = ()

    def __post_init__(self) -> None:
        given = {"name": self.name, "notes": self.notes} | {f"tags.{at}": tag for at, tag in enumerate(self.tags)}
        refuse_nul(given)


@dataclass(frozen=True)
class Revision:
    """A save of a design; its content is asked for by itself."""

    number: int
    note: str
    content_hash: str
    saved_at: str


@dataclass(frozen=True)
class Kept:
    """A design of the library. version: counts its changes, so that who changes it can say what was known of it."""

    id: str
    version: int
    name: str
    notes: str
    tags: list[str]
    saved_at: str
    revisions: int


class Library:
    """The designs of one database. For any thread."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def close(self) -> None:
        """Let go of the database."""
        self._database.close()

    def add(self, design: Design, about: About, note: str = "") -> Kept:
        """Keep a design, as revision 1; return it."""
        with self._database.writing() as connection:
            made = _add(connection, about)
            _add_revision(connection, made, 1, content_of(design), note)
            return kept_of(connection, made)

    def save(self, design_id: str, version: int, design: Design, note: str = "") -> Kept:
        """Keep another revision. version: see describe."""
        with self._database.writing() as connection:
            _count_change(connection, design_id, version)
            last = select(func.max(REVISIONS.c.number)).where(REVISIONS.c.design_id == design_id)
            _add_revision(connection, design_id, connection.execute(last).scalar_one() + 1, content_of(design), note)
            return kept_of(connection, design_id)

    def describe(self, design_id: str, version: int, about: About) -> Kept:
        """Change what is said of a design.

        version: what the change was made on. Raises Outdated, and changes nothing, when there is a newer one.
        """
        with self._database.writing() as connection:
            _count_change(connection, design_id, version)
            change_about(connection, design_id, about)
            return kept_of(connection, design_id)

    def duplicate(self, design_id: str, name: str) -> Kept:
        """Keep a copy under another name: the newest revision, as revision 1."""
        with self._database.writing() as connection:
            source = kept_of(connection, design_id)
            content = revision_text(connection, design_id, source.revisions)
            made = _add(connection, About(name, source.notes, source.tags))
            _add_revision(connection, made, 1, content, f"Copy of revision {source.revisions} of {source.name}")
            return kept_of(connection, made)

    def get(self, design_id: str) -> tuple[Kept, list[Revision]]:
        """Return a design and its revisions, the newest first."""
        columns = (REVISIONS.c.number, REVISIONS.c.note, REVISIONS.c.content_hash, REVISIONS.c.saved_at)
        chosen = select(*columns).where(REVISIONS.c.design_id == design_id).order_by(REVISIONS.c.number.desc())
        with self._database.reading() as connection:
            kept = kept_of(connection, design_id)
            return kept, [Revision(**row) for row in connection.execute(chosen).mappings()]

    def content(self, design_id: str, number: int) -> object:
        """Return the design document of a revision, as it was saved."""
        with self._database.reading() as connection:
            kept_of(connection, design_id)
            return json.loads(revision_text(connection, design_id, number))

    def search(
        self, text: str = "", tags: Sequence[str] = (), first: int = 0, most: int = 100
    ) -> tuple[int, list[Kept]]:
        """Return how many designs have all words of a text, and all of the tags, and some of them, newest first."""
        refuse_nul({"text": text} | {f"tags.{at}": tag for at, tag in enumerate(tags)})
        chosen = select(DESIGNS)
        for word in text.casefold().split():
            chosen = chosen.where(DESIGNS.c.searched.contains(word, autoescape=True))
        for tag in tags:
            chosen = chosen.where(select(TAGS).where(TAGS.c.design_id == DESIGNS.c.id, TAGS.c.tag == tag).exists())
        newest = chosen.order_by(DESIGNS.c.saved_at.desc(), DESIGNS.c.id).offset(first).limit(most)
        with self._database.reading() as connection:
            count = connection.execute(select(func.count()).select_from(chosen.subquery())).scalar_one()
            return count, [_told(connection, row) for row in connection.execute(newest).mappings().all()]


def add_design(connection: Connection, design_id: str, about: About, version: int, saved_at: str) -> None:
    """Keep what is said of a design that has no revision yet."""
    connection.execute(insert(DESIGNS).values(id=design_id, version=version, saved_at=saved_at, **_columns(about)))
    _add_tags(connection, design_id, about.tags)


def change_about(connection: Connection, design_id: str, about: About) -> None:
    """Keep what is said of a design by now; the change is counted by who makes it."""
    connection.execute(update(DESIGNS).where(DESIGNS.c.id == design_id).values(_columns(about)))
    connection.execute(delete(TAGS).where(TAGS.c.design_id == design_id))
    _add_tags(connection, design_id, about.tags)


def _add(connection: Connection, about: About) -> str:
    made = uuid.uuid4().hex
    add_design(connection, made, about, 1, now())
    return made


def _add_tags(connection: Connection, design_id: str, tags: Sequence[str]) -> None:
    rows = [{"design_id": design_id, "place": place, "tag": tag} for place, tag in enumerate(tags)]
    if rows:
        connection.execute(insert(TAGS), rows)


def _add_revision(connection: Connection, design_id: str, number: int, content: str, note: str) -> None:
    refuse_nul({"note": note})
    row = {"design_id": design_id, "number": number, "content": content, "note": note, "saved_at": now()}
    connection.execute(insert(REVISIONS).values(**row, content_hash=hash_of(content)))


def _count_change(connection: Connection, design_id: str, version: int) -> None:
    """Count a change made on a version: of two only the first is let.

    Who writes is alone, but for servers of an older StepRamp at the same PostgreSQL: so the version is asked for in
    the writing, too.
    """
    present = kept_of(connection, design_id)
    if present.version == version:
        counted = update(DESIGNS).where(DESIGNS.c.id == design_id, DESIGNS.c.version == version)
        if connection.execute(counted.values(version=version + 1, saved_at=now())).rowcount == 1:
            return
        present = kept_of(connection, design_id)
    raise Outdated(
        f"{shown(present.name)} was changed by somebody else meanwhile: you know its version {version}, "
        f"it is at {present.version}. Nothing was overwritten; look at it, and save again."
    )


def kept_of(connection: Connection, design_id: str) -> Kept:
    """Return a design; NotFound when there is none."""
    chosen = select(DESIGNS).where(DESIGNS.c.id == design_id)
    row = connection.execute(chosen).mappings().one_or_none() if ID.fullmatch(design_id) else None
    if row is None:
        raise NotFound(f"There is no design {shown(design_id)} in the library.")
    return _told(connection, row)


def _told(connection: Connection, row: RowMapping) -> Kept:
    tags = select(TAGS.c.tag).where(TAGS.c.design_id == row["id"]).order_by(TAGS.c.place)
    count = select(func.count()).select_from(REVISIONS).where(REVISIONS.c.design_id == row["id"])
    return Kept(
        **{name: row[name] for name in ("id", "version", "name", "notes", "saved_at")},
        tags=list(connection.execute(tags).scalars()),
        revisions=connection.execute(count).scalar_one(),
    )


def revision_text(connection: Connection, design_id: str, number: int) -> str:
    """Return the document of a revision; NotFound when there is none."""
    chosen = select(REVISIONS.c.content).where(REVISIONS.c.design_id == design_id, REVISIONS.c.number == number)
    content: str | None = connection.execute(chosen).scalar_one_or_none() if number in _NUMBERS else None
    if content is None:
        raise NotFound(f"The design has no revision {number:,}.")
    return content


def _columns(about: About) -> dict[str, str]:
    searched = "\n".join([about.name, about.notes, *about.tags]).casefold()
    return {"name": about.name, "notes": about.notes, "searched": searched}
