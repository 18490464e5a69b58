"""Tables of the library, as they are now. How an older library becomes such a one: migrations."""

from sqlalchemy import Column, ForeignKey, Integer, MetaData, String, Table, Text

METADATA = MetaData()

DESIGNS = Table(
    "designs",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("name", Text, nullable=False),
    Column("notes", Text, nullable=False),
    Column("version", Integer, nullable=False),
    Column("saved_at", String(32), nullable=False, index=True),
    Column("searched", Text, nullable=False),
)
"""version: counts all changes, of the revisions as of the rest. searched: what a search looks at, without case."""

TAGS = Table(
    "tags",
    METADATA,
    Column("design_id", String(32), ForeignKey("designs.id"), primary_key=True),
    Column("place", Integer, primary_key=True),
    Column("tag", Text, nullable=False, index=True),
)

REVISIONS = Table(
    "revisions",
    METADATA,
    Column("design_id", String(32), ForeignKey("designs.id"), primary_key=True),
    Column("number", Integer, primary_key=True),
    Column("content", Text, nullable=False),
    Column("content_hash", String(64), nullable=False, index=True),
    Column("note", Text, nullable=False),
    Column("saved_at", String(32), nullable=False),
)
"""content: the design document as JSON. content_hash: of it, by which a push can refer to a revision."""
