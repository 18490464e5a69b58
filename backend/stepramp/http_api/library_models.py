"""What the routes over the library take and answer."""

from typing import Annotated, Any, Literal

from pydantic import Field

from stepramp.design import Design
from stepramp.http_api.answer import Answer
from stepramp.validation import Document, ListOf, Text, Within

Name = Annotated[str, Text(100)]
Notes = Annotated[str, Text(20_000)]
Note = Annotated[str, Text(1_000)]
Tags = Annotated[list[Annotated[str, Text(50)]], ListOf("tags", most=30)]


class NewDesignPayload(Document):
    """A design to be kept, as its revision 1."""

    design: Design
    name: Name = Field("", description="What it is called in the library; empty: the design's own name")
    notes: Notes = Field("", description="What is to be known of it")
    tags: Tags = Field([], description="Words to find it by")
    note: Note = Field("", description="What is to be known of this revision")


class RevisionPayload(Document):
    """A design to be kept as another revision."""

    design: Design
    note: Note = Field("", description="What is to be known of this revision")


class AboutPayload(Document):
    """All that people say of a design; what is left out is empty."""

    name: Name
    notes: Notes = ""
    tags: Tags = Field([], description="Words to find it by")


class DuplicatePayload(Document):
    """What a copy is called."""

    name: Name


class SearchPayload(Document):
    """What designs are searched by; nothing: all of them."""

    text: Annotated[str, Text(200)] = Field(
        "", description="Words that name, notes and tags have together, all of them"
    )
    tags: Tags = Field([], description="Tags that a design has, all of them")
    first: Annotated[int, Within(0, 1_000_000)] = Field(0, description="So many are left out, the newest ones")
    most: Annotated[int, Within(1, 500)] = Field(100, description="So many are told")


class KeptAnswer(Answer):
    """A design of the library."""

    id: str = Field(description="What the routes call it")
    version: int = Field(description="Counts its changes; the ETag is this number in quotes")
    name: str
    notes: str
    tags: list[str] = Field(description="Words to find it by")
    saved_at: str = Field(description="When it was changed last, in UTC")
    revisions: int = Field(description="How many it has; this is the number of the newest")


class RevisionAnswer(Answer):
    """A save of a design."""

    number: int = Field(description="Counted from 1")
    note: str
    content_hash: str = Field(description="SHA-256 of the document, sorted and without spaces: the same ramp, the same")
    saved_at: str = Field(description="When it was saved, in UTC")


class KeptWithRevisionsAnswer(KeptAnswer):
    """A design of the library with what it was."""

    history: list[RevisionAnswer] = Field(description="The newest first")


class ContentAnswer(Answer):
    """The design of a revision."""

    number: int = Field(description="Of the revision, counted from 1")
    design: dict[str, object] = Field(description="The document, as it was saved")


class DifferenceAnswer(Answer):
    """A field that two revisions differ in."""

    field: str = Field(description="Its path in the design")
    before: object = Field(description="Its value in the first of them; null: it hasn't got it")
    after: object = Field(description="Its value in the second")


class DifferencesAnswer(Answer):
    """What two revisions differ in."""

    differences: list[DifferenceAnswer]


class FoundAnswer(Answer):
    """What a search found."""

    count: int = Field(description="How many there are, also those that aren't told")
    designs: list[KeptAnswer] = Field(description="Those changed last first")


class RecordPayload(Document):
    """What was measured of a revision."""

    revision: Annotated[int, Within(1, 2**31 - 1)] = Field(description="Of the design, counted from 1")
    kind: Literal["trace", "capture", "stall_map"] = Field(description="What it is")
    note: Note = Field("", description="What is to be known of it")
    document: dict[str, Any] = Field(description="As it was answered when it was measured or computed")


class RecordAnswer(Answer):
    """What was measured of a revision."""

    id: str = Field(description="What the routes call it")
    revision: int = Field(description="Of the design, counted from 1")
    kind: str = Field(description="trace, capture or stall_map")
    note: str
    kept_at: str = Field(description="In UTC")


class RecordsAnswer(Answer):
    """What was measured of a design."""

    records: list[RecordAnswer] = Field(description="The newest first")


class RecordContentAnswer(Answer):
    """The document of a record."""

    document: dict[str, object] = Field(description="As it was kept")


class ImportedAnswer(Answer):
    """What a file has added to the library."""

    designs: int = Field(description="Designs that were added")
    revisions: int = Field(description="Revisions that were added, also to designs that were there")
    devices: int = Field(description="Devices that were added")
    pushes: int = Field(description="Pushes that were added")
    records: int = Field(description="Traces, captures and stall maps that were added")
    there_already: int = Field(description="Of all these, what the library had already")
    copies: list[str] = Field(
        description="Names of designs that the library has otherwise: those of the file were added beside them"
    )
