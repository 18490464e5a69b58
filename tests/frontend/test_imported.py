"""What is told of settings that were imported, and of backups, in words that a person meets elsewhere in the page."""

from datetime import UTC, datetime

from designs import document
from frontend.modules import Modules


def test_a_remark_names_its_axis_where_it_is_not_of_all(modules: Modules) -> None:
    axes = [
        {"design": document(name=name), "remarks": remarks, "remarks_told": [[] for _ in remarks]}
        for name, remarks in (
            ("X", ["No jerk is kept.", "The travel is unknown."]),
            ("Y", ["No jerk is kept."]),
            ("Z", ["No jerk is kept.", "The travel is unknown.", "It is slow."]),
        )
    ]
    units = {"length": "steps", "time": "s"}
    told = modules.call("/model/imported.js", "remarksOf", axes, units)
    assert told == ["No jerk is kept.", "X: The travel is unknown.", "Z: The travel is unknown.", "Z: It is slow."]
    alone = modules.call("/model/imported.js", "remarksOf", axes[:1], units)
    assert alone == ["No jerk is kept.", "The travel is unknown."]


def test_a_message_tells_when_a_backup_was_saved_as_lists_do(modules: Modules) -> None:
    # As `devices/backups.py` names them.
    name = datetime(2026, 11, 26, 0, 34, 30, 440152, UTC).strftime("%Y-%m-%dT%H-%M-%S.%fZ")
    listed = modules.call("/model/saved_at.js", "savedAtText", name)
    assert listed == "2026-11-26 00:34:30 UTC"
    said = f"It was lost. What it had is saved as {name}: restore that."
    told = modules.call("/model/saved_at.js", "withSavedAt", said)
    assert told == f"It was lost. What it had is saved as {listed}: restore that."
    assert modules.call("/model/saved_at.js", "withSavedAt", "Saved as usual.") == "Saved as usual."
