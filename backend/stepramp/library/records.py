"""What was traced, captured or mapped of a design's revision, kept beside it."""

import json
import uuid
from dataclasses import dataclass

from sqlalchemy import Connection, insert, select

from stepramp.errors import NotFound, shown
from stepramp.library.database import Database
from stepramp.library.library import kept_of, revision_text
from stepramp.library.schema import RECORDS
from stepramp.library.texts import ID, as_text, now, refuse_nul


@dataclass(frozen=True)
class Record:
    """A record; its content is asked for by itself. kind: "trace", "capture" or "stall_map"."""

    id: str
    revision: int
    kind: str
    note: str
    kept_at: str


class Records:
    """Those of one database. For any thread."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def add(self, design_id: str, revision: int, kind: str, content: object, note: str = "") -> Record:
        """Keep what was measured of a revision, as a document; NotFound when there is no such revision."""
        refuse_nul({"note": note})
        record = Record(uuid.uuid4().hex, revision, kind, note, now())
        with self._database.writing() as connection:
            kept_of(connection, design_id)
            revision_text(connection, design_id, revision)
            connection.execute(insert(RECORDS).values(design_id=design_id, content=as_text(content), **vars(record)))
        return record

    def all(self, design_id: str) -> list[Record]:
        """Return the records of a design, the newest first; NotFound when there is no such design."""
        columns = [RECORDS.c[name] for name in ("id", "revision", "kind", "note", "kept_at")]
        chosen = select(*columns).where(RECORDS.c.design_id == design_id)
        with self._database.reading() as connection:
            kept_of(connection, design_id)
            newest = connection.execute(chosen.order_by(RECORDS.c.kept_at.desc(), RECORDS.c.id))
            return [Record(**row) for row in newest.mappings()]

    def content(self, design_id: str, record_id: str) -> object:
        """Return the document of a record; NotFound when there is none."""
        with self._database.reading() as connection:
            kept_of(connection, design_id)
            return json.loads(_text_of(connection, design_id, record_id))


def _text_of(connection: Connection, design_id: str, record_id: str) -> str:
    chosen = select(RECORDS.c.content).where(RECORDS.c.id == record_id, RECORDS.c.design_id == design_id)
    text: str | None = connection.execute(chosen).scalar_one_or_none() if ID.fullmatch(record_id) else None
    if text is None:
        raise NotFound(f"There is no record {shown(record_id)} of the design.")
    return text
