"""The lines of a file with a whole library, and how they are checked before anything is added."""

import hashlib
import json
from collections.abc import Iterable, Iterator
from dataclasses import replace
from datetime import datetime
from itertools import islice, repeat
from typing import Annotated, Any, BinaryIO, Literal, TypeVar

from pydantic import AfterValidator

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.json_text import MOST_VALUES, parsed_json, why_unreadable
from stepramp.library.documents import tellable
from stepramp.library.texts import ID
from stepramp.validation import Document, ListOf, Text, Within, refuse

FORMAT = "stepramp_library"
VERSION = 1
MORE_VALUES = 100
"""Around a document its line has so many more at most."""
MOST_LINE_BYTES = 2**23
"""No document that the library keeps takes as much; what takes more to parse would keep a STOP waiting [bytes]."""
MOST_NOTES = 20_000
"""[characters]"""
MOST_TAGS = 30
MOST_NUMBER = 2**31 - 1
"""What databases can count."""
MOST_VERSION = 2_000_000_000
"""A design of more couldn't be changed for long: each change counts one on."""

T = TypeVar("T", str, str | None)


def _id(text: str) -> str:
    return text if ID.fullmatch(text) else refuse("", text, "32 of the letters 0 to 9 and a to f")


def _time(text: str) -> str:
    try:
        is_utc = text.endswith("Z") and datetime.fromisoformat(text) is not None
    except ValueError:
        is_utc = False
    return text if is_utc else refuse("", text, "a time in UTC, as 2026-01-31T12:00:00.000000Z")


def _design(content: dict[str, Any]) -> dict[str, Any]:
    """Return a design's document as it was saved: by what it was saved as, a push knows it."""
    Design.checked(content)
    return content


def _text(text: T) -> T:
    return refuse("", text, "text without the character NUL") if text is not None and "\0" in text else text


Id = Annotated[str, Text(32), AfterValidator(_id)]
Time = Annotated[str, Text(32), AfterValidator(_time)]
Told = Annotated[dict[str, Any], AfterValidator(tellable)]
Saved = Annotated[dict[str, Any], AfterValidator(_design)]
Number = Annotated[int, Within(1, MOST_NUMBER)]
Name = Annotated[str, Text(200), AfterValidator(_text)]
Words = Annotated[str, Text(20_000), AfterValidator(_text)]
WordsOrNull = Annotated[str | None, AfterValidator(_text)]


class DesignLine(Document):
    """A design without its revisions, which follow."""

    id: Id
    name: Name
    notes: Annotated[str, Text(MOST_NOTES), AfterValidator(_text)]
    version: Annotated[int, Within(1, MOST_VERSION)]
    saved_at: Time
    tags: Annotated[list[Name], ListOf("tags", most=MOST_TAGS)]


class RevisionLine(Document):
    """A revision of the design before it."""

    design_id: Id
    number: Number
    note: Words
    saved_at: Time
    design: Saved


class DeviceLine(Document):
    """A device."""

    id: Id
    family: Name
    identity: Words
    name: Words
    port: Words
    first_seen_at: Time
    last_seen_at: Time


class PushLine(Document):
    """A push without its axes, which follow."""

    id: Id
    device_id: Id
    pushed_at: Time
    client: WordsOrNull
    mode: Name
    trouble: WordsOrNull
    report: Told | None
    backup: WordsOrNull


class PushedAxisLine(Document):
    """An axis of the push before it."""

    push_id: Id
    axis: Annotated[int, Within(0, MOST_NUMBER)]
    name: Name
    design: Saved


class RecordLine(Document):
    """A record of a design."""

    id: Id
    design_id: Id
    revision: Number
    kind: Literal["trace", "capture", "stall_map"]
    note: Words
    content: Told
    kept_at: Time


Line = DesignLine | RevisionLine | DeviceLine | PushLine | PushedAxisLine | RecordLine

KINDS: dict[str, type[Line]] = {
    "design": DesignLine,
    "revision": RevisionLine,
    "device": DeviceLine,
    "push": PushLine,
    "pushed_axis": PushedAxisLine,
    "record": RecordLine,
}


def whole_lines(file: BinaryIO) -> Iterator[bytes]:
    """Return the lines between the first and the last; Rejected for what is no such file, or not a whole one.

    Lines may end with CRLF, as some mail and editors have them: within a line JSON has neither character. The file is
    read twice, since all of it has to be whole before any of it is used.
    """
    lines = _lines(file)
    last = next(lines, b"")
    head = _read(last)
    if not isinstance(head, dict) or FORMAT not in head:
        raise _refused(last[:100].decode("utf-8", "replace"), "a library that StepRamp has saved as a file")
    if head[FORMAT] != VERSION:
        raise Rejected([Rejection(f"lines.1.{FORMAT}", head[FORMAT], f"{VERSION}: the file is of a newer StepRamp")])
    digest, count = hashlib.sha256(), 0
    for line in lines:
        digest.update(last + b"\n")
        last, count = line, count + 1
    if _read(last) != {"end": {"lines": count, "sha256": digest.hexdigest()}}:
        raise _refused(
            f"{count + 1:,} lines",
            "a whole file: its last line doesn't fit those before, so it was cut or changed",
        )
    return islice(_lines(file), 1, count)


def _lines(file: BinaryIO) -> Iterator[bytes]:
    """Yield the lines without what ends them, and without empty ones at the end."""
    file.seek(0)
    empty = 0
    for number, line in enumerate(iter(lambda: file.readline(MOST_LINE_BYTES + 1), b""), start=1):
        if len(line) > MOST_LINE_BYTES:
            allowed = f"a line of up to {MOST_LINE_BYTES:,} bytes"
            raise Rejected([Rejection(f"lines.{number}", line[:100].decode("utf-8", "replace"), allowed)])
        told = line.removesuffix(b"\n").removesuffix(b"\r")
        if not told:
            empty += 1
            continue
        yield from repeat(b"", empty)
        empty = 0
        yield told


def checked_lines(lines: Iterable[bytes]) -> Iterator[Line]:
    """Yield what lines say; Rejected, naming the line and the field, for what can't be."""
    for number, line in enumerate(lines, start=2):
        try:
            document = parsed_json(line.decode(), MOST_VALUES + MORE_VALUES)
            [(name, said)] = document.items() if isinstance(document, dict) and len(document) == 1 else [("", None)]
            if name not in KINDS:
                raise Rejected([Rejection("document", name, f"one of {', '.join(KINDS)}")])
            yield KINDS[name].checked(said)
        except Rejected as error:
            raise Rejected([replace(each, field=f"lines.{number}.{each.field}") for each in error.rejections]) from None
        except ValueError as error:
            shown_text = line[:100].decode("utf-8", "replace")
            raise Rejected([Rejection(f"lines.{number}", shown_text, f"JSON ({why_unreadable(error)})")]) from None


def _read(line: bytes) -> object:
    try:
        return json.loads(line) if len(line) < 1000 else None
    except ValueError:
        return None


def _refused(value: str, allowed: str) -> Rejected:
    return Rejected([Rejection("file", value, allowed)])
