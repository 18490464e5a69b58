"""What is kept, as text: designs, their hashes, and times."""

import hashlib
import json
import re
from collections.abc import Mapping
from datetime import UTC, datetime

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection

ID = re.compile("[0-9a-f]{32}")
"""What designs, pushes and records are called."""


def content_of(design: Design) -> str:
    """Return a design as JSON, sorted and without spaces: the same ramp is the same text."""
    return as_text(design.model_dump(mode="json", by_alias=True))


def as_text(document: object) -> str:
    """Return a document as such JSON."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"))


def hash_of(content: str) -> str:
    """Return by what a push and a revision of the same ramp know each other: SHA-256 of its text."""
    return hashlib.sha256(content.encode()).hexdigest()


def refuse_nul(texts: Mapping[str, str]) -> None:
    """Raise Rejected for texts with the character NUL, which PostgreSQL keeps none of."""
    found = [Rejection(field, text, "text without the character NUL") for field, text in texts.items() if "\0" in text]
    if found:
        raise Rejected(found)


def without_nul(text: str) -> str:
    """Return a text that isn't a user's, as PostgreSQL keeps it."""
    return text.replace("\0", "\N{SYMBOL FOR NULL}")


def now() -> str:
    """Return the time in UTC, as it is kept."""
    return datetime.now(UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")
