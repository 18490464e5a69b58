"""What the routes over the library take and answer."""

import unicodedata
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from stepramp.design import Design
from stepramp.http_api.answer import Answer
from stepramp.library.documents import tellable
from stepramp.validation import Document, ListOf, Text, Within, refuse

A_NAME = "a name that can be read"


def _refuse_control(field: str, text: str, but: str = "", but_words: str = "") -> str:
    """Return a text without control characters: nobody sees them, and a terminal obeys them.

    but: these may be in it.
    """
    found = next((each for each in text if unicodedata.category(each) == "Cc" and each not in but), None)
    if found is not None:
        refuse(field, text, f"text without control characters{but_words}; it has U+{ord(found):04X}")
    return text


def _words(text: str) -> str:
    return _refuse_control("", text)


def _lines(text: str) -> str:
    return _refuse_control("", text, "\t\n\r", " but tabs and line ends")


def _name(text: str, field: str = "") -> str:
    if not text.strip():
        refuse(field, text, A_NAME)
    return _refuse_control(field, text)


def _name_or_none(text: str) -> str:
    return _name(text) if text else text


Name = Annotated[str, Text(100), AfterValidator(_name)]
NameOrNone = Annotated[str, Text(100), AfterValidator(_name_or_none)]
Notes = Annotated[str, Text(20_000), AfterValidator(_lines)]
Note = Annotated[str, Text(1_000), AfterValidator(_lines)]
Tags = Annotated[list[Annotated[str, Text(50), AfterValidator(_words)]], ListOf("tags", most=30)]
AnyTags = Annotated[list[Annotated[str, Text(50)]], ListOf("tags", most=30)]
"""Also such as were imported, or kept by an older StepRamp: they are searched by."""


class NewDesignPayload(Document):
    """A design to be kept, as its revision 1."""

    design: Design
    name: NameOrNone = Field("", description="What it is called in the library; empty: the design's own name")
    notes: Notes = Field("", description="What is to be known of it")
    tags: Tags = Field([], description="Words to find it by")
    note: Note = Field("", description="What is to be known of this revision")

    @model_validator(mode="after")
    def _is_named(self) -> Self:
        if not self.name and not self.design.name:
            refuse("name", self.name, f"{A_NAME}, as the design has none of its own")
        if not self.name:
            _name(self.design.name, "design.name")
        return self


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
    tags: AnyTags = Field([], description="Tags that a design has, all of them")
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
    document: Annotated[dict[str, Any], AfterValidator(tellable)] = Field(
        description="As it was answered when it was measured or computed"
    )


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
    described: int = Field(description="Designs that were there and got more notes or tags from it, or a later name")
    copies: list[str] = Field(
        description="Names of designs that the library has otherwise: those of the file were added beside them"
    )
