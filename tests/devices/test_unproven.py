"""What is kept of settings that aren't proven: damaged files are told; what can't be written isn't forgotten."""

from __future__ import annotations

from pathlib import Path

import pytest

from stepramp.devices.unproven import FILE, Unproven


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "[" * 100_000,
        '{"$110": {"value": null, "at": "2026-11-28 04:00 UTC"}}',
        '{"": {"value": "1", "at": "then"}}',
        '{"$\\u00b2": {"value": "1", "at": "then"}}',
        '{"\\ud800": {"value": "1", "at": "then"}}',
        '{"$110": {"value": "' + "1" * 5000 + '", "at": "then"}}',
        '{"$110": {"value": "1"}}',
    ],
    ids=range(9),
)
def test_a_damaged_file_is_none_and_told_until_something_is_written(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text)
    unproven = Unproven(tmp_path)
    assert unproven.given == {}
    assert f"was noted in {tmp_path / FILE}, which can't be read (it is damaged)" in (unproven.damage or "")
    # Whether a setting was taken isn't known: of it nothing is to be proven.
    unproven.note({"$110": None})
    assert unproven.damage is None
    assert (Unproven(tmp_path).given, Unproven(tmp_path).damage) == ({}, None)


def test_what_can_not_be_written_is_known_as_long_as_the_program_runs(tmp_path: Path) -> None:
    Unproven(tmp_path).note({"$110": "216.000"})
    kept = (tmp_path / FILE).read_text()
    # Nothing can be written there: what would be the file is a folder.
    blocked = tmp_path / "other"
    (blocked / FILE).mkdir(parents=True)
    assert "can't be read (Is a directory)" in (Unproven(blocked).damage or "")
    Unproven(blocked).note({"$110": "168.000"})
    assert Unproven(blocked).given["$110"].value == "168.000"
    assert f"can't be written down in {blocked} (Is a directory)" in (Unproven(blocked).trouble or "")
    assert (Unproven(tmp_path).trouble, Unproven(tmp_path).damage) == (None, None)
    Unproven(blocked).drop(["$110"])
    assert Unproven(blocked).given == {}
    assert Unproven(tmp_path).given["$110"].value == "216.000"
    assert (tmp_path / FILE).read_text() == kept


def test_what_was_noted_of_whatever_was_at_the_port_is_told_and_claimed_by_nobody(tmp_path: Path) -> None:
    former, one, other = (tmp_path / each for each in ("by-port", "one", "other"))
    Unproven(former).note({"$110": "216.000"})
    for folder in (one, other):
        found = Unproven(folder, [tmp_path / "none", former])
        assert found.given == {}
        assert f"was noted in {former / FILE} by the port alone" in (found.damage or "")
        # Until this board is written to.
        found.note({"$111": "5.000"})
        assert (found.damage, set(Unproven(folder, [former]).given)) == (None, {"$111"})
    assert set(Unproven(former).given) == {"$110"}
    # Where nothing was left to be proven, nothing is told.
    Unproven(former).drop(["$110"])
    assert Unproven(tmp_path / "third", [former]).damage is None


def test_a_folder_that_can_not_be_entered_is_told_and_hinders_nothing(tmp_path: Path) -> None:
    """As that of another user; who runs the tests may enter any, so here it is a file."""
    (tmp_path / "folder").write_text("in its place")
    for folders in ([tmp_path / "folder"], [tmp_path / "none", [tmp_path / "folder"]]):
        assert "which can't be read (Not a directory)" in (Unproven(*folders).damage or "")
