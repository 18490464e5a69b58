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

DEVICES = Table(
    "devices",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("family", Text, nullable=False),
    Column("identity", Text, nullable=False),
    Column("name", Text, nullable=False),
    Column("port", Text, nullable=False),
    Column("first_seen_at", String(32), nullable=False),
    Column("last_seen_at", String(32), nullable=False, index=True),
)
"""id: computed from family and identity, so that two libraries call a device the same. port: where it was last."""

PUSHES = Table(
    "pushes",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("device_id", String(32), ForeignKey("devices.id"), nullable=False, index=True),
    Column("pushed_at", String(32), nullable=False, index=True),
    Column("client", Text),
    Column("mode", Text, nullable=False),
    Column("trouble", Text),
    Column("report", Text),
    Column("backup", Text),
)
"""client: who asked, on a shared server. trouble: why it failed, in words; else report has what was read back, as JSON.
backup: the name of the last one taken before."""

PUSHED_AXES = Table(
    "pushed_axes",
    METADATA,
    Column("push_id", String(32), ForeignKey("pushes.id"), primary_key=True),
    Column("axis", Integer, primary_key=True),
    Column("name", Text, nullable=False),
    Column("content", Text, nullable=False),
    Column("content_hash", String(64), nullable=False, index=True),
)
"""The design of each axis, also one that no revision has."""

RECORDS = Table(
    "records",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("design_id", String(32), ForeignKey("designs.id"), nullable=False, index=True),
    Column("revision", Integer, nullable=False),
    Column("kind", Text, nullable=False),
    Column("note", Text, nullable=False),
    Column("content", Text, nullable=False),
    Column("kept_at", String(32), nullable=False),
)
"""What was traced, captured or mapped of a revision, as JSON."""
