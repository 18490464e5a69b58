"""Traces, captures and stall maps that are kept with a design, on both databases."""

import pytest

from designs import design
from stepramp.errors import NotFound, Rejected
from stepramp.library.database import Database
from stepramp.library.library import About, Library
from stepramp.library.records import Records


def test_what_was_measured_is_kept_with_its_revision(database: Database, library: Library) -> None:
    records = Records(database)
    kept = library.add(design(), About("Lift"))
    other = library.add(design(), About("Other"))
    trace = records.add(kept.id, 1, "trace", {"ticks": [1, 2]}, "at the mill")
    capture = records.add(kept.id, 1, "capture", {"steps": []})
    assert records.all(kept.id) == [capture, trace]
    assert (trace.kind, trace.note, trace.revision) == ("trace", "at the mill", 1)
    assert records.content(kept.id, trace.id) == {"ticks": [1, 2]}
    assert records.all(other.id) == []
    for ask in (
        lambda: records.add(kept.id, 2, "trace", {}),
        lambda: records.add("none", 1, "trace", {}),
        lambda: records.content(other.id, trace.id),
        lambda: records.content(kept.id, "none"),
    ):
        with pytest.raises(NotFound):
            ask()
    with pytest.raises(Rejected, match="NUL"):
        records.add(kept.id, 1, "trace", {}, "a\0")
