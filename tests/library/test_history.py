"""The history of pushes, and the devices that were seen, on both databases."""

import pytest

from designs import design
from stepramp.errors import NotFound
from stepramp.library.database import Database
from stepramp.library.history import Device, History, Push
from stepramp.library.library import About, Library

GRBL = Device("grbl", "USB 1A86:7523, serial number A1", "CH340 adapter on ttyUSB0", "/dev/ttyUSB0")
TIC = Device("tic", "/dev/ttyACM0", "Pololu Tic T825 on ttyACM0", "/dev/ttyACM0")


@pytest.fixture
def history(database: Database) -> History:
    return History(database)


def test_a_push_is_kept_with_its_designs_and_what_was_read_back(history: History) -> None:
    asked = {0: design(name="X"), 2: design(name="Z", move__steps=7)}
    made = history.note_push(Push(GRBL, asked, "keep", "operate 1", {"verified": True}, backup="2026-01-31T12-00-00"))
    told, report, designs = history.push(made)
    assert (told.device_id, told.device, told.client, told.mode, told.trouble, told.backup) == (
        GRBL.id, GRBL.name, "operate 1", "keep", None, "2026-01-31T12-00-00",
    )  # fmt: skip
    assert [(each.axis, each.name, each.revisions) for each in told.axes] == [(0, "X", []), (2, "Z", [])]
    assert report == {"verified": True}
    assert designs[2]["move"] == {"steps": 7}  # type: ignore[index]


def test_a_push_names_the_revisions_that_are_the_same(history: History, library: Library) -> None:
    kept = library.add(design(move__steps=5), About("Lift"))
    kept = library.save(kept.id, kept.version, design(move__steps=6))
    other = library.add(design(move__steps=8), About("Other"))
    for steps in (5, 6, 7):
        history.note_push(Push(GRBL, {0: design(move__steps=steps)}, "try"))
    # One that is saved after it was pushed is known, too.
    library.save(kept.id, kept.version, design(move__steps=7))
    pushes = history.pushes(design_id=kept.id)[1]
    assert [[each.number for each in push.axes[0].revisions] for push in pushes] == [[3], [2], [1]]
    assert pushes[0].axes[0].revisions[0].name == "Lift"
    assert history.pushes(design_id=other.id) == (0, [])


def test_a_push_that_failed_says_why(history: History) -> None:
    history.note_push(Push(TIC, {0: design(name="X\0")}, "try", trouble="The Tic\0 is gone."))
    [told] = history.pushes(device_id=TIC.id)[1]
    assert (told.trouble, told.axes[0].name) == ("The Tic\N{SYMBOL FOR NULL} is gone.", "X\N{SYMBOL FOR NULL}")
    assert history.push(told.id)[1] is None
    assert history.pushes(device_id=GRBL.id) == (0, [])


def test_devices_are_known_by_what_tells_them_apart(history: History) -> None:
    history.note_device(TIC)
    history.note_device(GRBL)
    moved = Device(GRBL.family, GRBL.identity, "CH340 adapter on ttyUSB3", "/dev/ttyUSB3")
    history.note_push(Push(moved, {0: design()}, "try"))
    history.note_device(Device("marlin", TIC.identity, TIC.name, TIC.port))
    told = history.devices()
    assert [(each.family, each.port, each.pushes) for each in told] == [
        ("marlin", "/dev/ttyACM0", 0), ("grbl", "/dev/ttyUSB3", 1), ("tic", "/dev/ttyACM0", 0),
    ]  # fmt: skip
    assert told[1].first_seen_at < told[1].last_seen_at


def test_pushes_are_told_in_pages_the_newest_first(history: History) -> None:
    made = [history.note_push(Push(GRBL, {0: design(move__steps=steps)}, "try")) for steps in (1, 2, 3)]
    count, found = history.pushes(first=1, most=1)
    assert (count, [each.id for each in found]) == (3, [made[1]])


@pytest.mark.parametrize("name", ["none", "0" * 32])
def test_a_push_that_is_not_there(history: History, name: str) -> None:
    with pytest.raises(NotFound, match=f"no push '{name}'"):
        history.push(name)
