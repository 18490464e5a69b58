"""Backups: on the disk before the first write, and restored whatever the controller is like by then."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from controllers.plain_controller import NoWire, PlainController
from designs import design
from stepramp.controllers.capabilities import BacksUp, StoresRamps
from stepramp.controllers.contract import ControllerStatus, PushMode, PushReport
from stepramp.controllers.families import Family
from stepramp.controllers.remark import Unwritten
from stepramp.design import Design
from stepramp.devices.backups import Archive, Archived, Backups, Source, checked, marked, unmarked
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, NotFound, Refused
from stepramp.link.ports import known_port


class Keeper(PlainController, StoresRamps, BacksUp):
    """One that keeps a text. log: what is done with it, and with the disk."""

    log: list[str]
    text = "figure 1\n"
    is_broken = False
    is_gone = False
    is_gone_once_written = False
    remarks: tuple[str, ...] = ("All is well.",)

    def status(self) -> ControllerStatus:
        if self.is_gone:
            raise DeviceLost("Nothing answers at a wire.")
        return super().status()

    def prepare_push(
        self,
        designs: Sequence[Design],  # noqa: ARG002
        first_axis: int | None = None,  # noqa: ARG002
        mode: PushMode = "keep",  # noqa: ARG002
    ) -> Callable[[], PushReport]:
        return self._written

    def _written(self) -> PushReport:
        self.log.append("pushed")
        self.is_gone = self.is_gone_once_written
        return PushReport((), True, None, 8, None, None, True, ())

    def backup(self) -> str:
        if self.is_broken:
            raise Refused("What it keeps can't be read.")
        self.log.append("read")
        return self.text

    def use_backup(self, text: str) -> tuple[str, ...]:
        self.log.append("written")
        self.text, self.is_broken, self.is_gone = text, False, self.is_gone_once_written
        return self.remarks


@pytest.fixture
def log() -> list[str]:
    return []


@pytest.fixture
def made() -> list[Keeper]:
    return []


@pytest.fixture
def device(log: list[str], made: list[Keeper], tmp_path: Path) -> Iterator[Device]:
    def make(*asked: object) -> Keeper:
        made.append(Keeper(*asked))  # type: ignore[arg-type]
        made[-1].log = log
        return made[-1]

    devices = Devices({"keeper": Family("keeper", "Keeper", NoWire, make)}, data=tmp_path / "data" / "of" / "mine")
    yield devices.connect("a wire", "keeper")
    devices.close()


def saved_in(device: Device, tmp_path: Path) -> Path:
    [folder] = (tmp_path / "data" / "of" / "mine" / "backups").iterdir()
    names = [each.stem for each in sorted(folder.iterdir(), reverse=True)]
    assert [each.name for each in device.backups().backups] == names
    return folder


@pytest.mark.skipif(os.name != "posix", reason="folders are synced where that can be done")
def test_it_is_on_the_disk_with_every_folder_above_it_before_anything_is_written(
    device: Device, log: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", lambda number: log.append(os.path.realpath(f"/proc/self/fd/{number}")))
    device.restore_from(Source("keeper-elsewhere-0", "keeper", "elsewhere", []), "x", "figure 2\n")
    folder = saved_in(device, tmp_path)
    *synced, last = [each for each in log if each.startswith("/")]
    assert [Path(each) for each in synced[:-1]] == [
        tmp_path, tmp_path / "data", tmp_path / "data/of", tmp_path / "data/of/mine", tmp_path / "data/of/mine/backups",
    ]  # fmt: skip
    assert Path(synced[-1]).parent == folder
    assert last == str(folder)
    assert log.index(last) < log.index("written")


def test_what_cant_be_read_is_no_hindrance_to_a_restore(device: Device, log: list[str], made: list[Keeper]) -> None:
    device.back_up()
    [saved] = device.backups().backups
    # Over another connection nothing is saved yet.
    device.disconnect()
    device.connect()
    made[-1].is_broken = True
    assert device.restore_backup(saved.name) == (
        "What the controller had before isn't saved, since it can't be read: What it keeps can't be read.",
        "All is well.",
    )
    assert log[-1] == "written"


def test_what_is_half_written_is_whole_again_only_by_all_of_a_backup_of_its_own(
    device: Device, made: list[Keeper]
) -> None:
    device.back_up()
    [saved] = device.backups().backups
    device._live.change(lambda view: replace(view, half_written="Restore it.", lacks_backup=saved.name))
    other, own = (Source(name, "keeper", "x", []) for name in ("keeper-elsewhere-0", device._backups.folder.name))
    # One of long ago, as by its name.
    assert "this backup is of another device" in device.restore_from(other, "2020", "figure 2\n")[-1]
    assert device.view.lacks_backup == saved.name
    made[-1].remarks = (Unwritten("$110 is not as in the backup."),)
    assert "not all that can be written" in device.restore_backup(saved.name)[-1]
    assert (device.view.half_written, device.view.message) == ("Restore it.", "Restore it.")
    made[-1].remarks = ("All is well.",)
    assert device.restore_from(own, saved.name, "figure 1\n")[-1] == "All is well."
    assert (device.view.half_written, device.view.lacks_backup) == (None, None)


def test_nothing_else_is_written_to_one_that_cant_be_read(device: Device, made: list[Keeper]) -> None:
    made[-1].is_broken = True
    with pytest.raises(Refused, match="What it keeps can't be read"):
        device.back_up()


def test_what_is_written_is_reported_though_the_device_is_lost_just_then(device: Device, made: list[Keeper]) -> None:
    """What was read back is known, and nothing is half written: that it was lost tells its state, as soon as that."""
    device.back_up()
    [saved] = device.backups().backups
    made[-1].is_gone_once_written = True
    assert device.restore_backup(saved.name) == ("All is well.",)
    assert (device.view.state, device.view.message) == (DeviceState.LOST, "Nothing answers at a wire.")
    device.connect()
    made[-1].is_gone_once_written = True
    report = device.push([design()])
    assert report.verified
    assert (device.view.state, device.view.message) == (DeviceState.LOST, "Nothing answers at a wire.")
    assert (device.view.pushed, device.view.half_written) == (report, None)
    device.connect()
    assert device.view.state is DeviceState.READY


def test_why_something_was_refused_is_told_though_the_device_is_lost_just_then(
    device: Device, made: list[Keeper], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse() -> None:
        made[-1].is_gone = True
        raise Refused("Nothing is on trial.")

    monkeypatch.setattr(made[-1], "keep", refuse)
    with pytest.raises(Refused, match="Nothing is on trial"):
        device.keep()
    assert device.view.state is DeviceState.LOST


def test_a_backup_that_is_damaged_or_gone_is_refused_in_words(device: Device, tmp_path: Path) -> None:
    device.back_up()
    folder = saved_in(device, tmp_path)
    [file] = folder.iterdir()
    file.write_bytes(b"figure \xff\n")
    with pytest.raises(Refused, match="isn't text in UTF-8, as it was saved: take another one"):
        device.restore_backup(file.stem)
    file.unlink()
    with pytest.raises(NotFound, match="There is no backup"):
        device.restore_backup(file.stem)


def test_a_backup_is_whole_or_refused(device: Device, made: list[Keeper], tmp_path: Path) -> None:
    made[-1].text = "figure 1\nfigure ½\n"
    device.back_up()
    [file] = saved_in(device, tmp_path).iterdir()
    saved = file.read_bytes()
    assert device.restore_backup(file.stem) == ("All is well.",)
    assert made[-1].text == "figure 1\nfigure ½\n"
    # As an editor of Windows writes it.
    file.write_bytes(b"\xef\xbb\xbf" + saved.replace(b"\n", b"\r\n"))
    assert device.restore_backup(file.stem) == ("All is well.",)
    made[-1].text = "what it has"
    damaged = [saved[:end] for end in range(len("# StepRamp backup"), len(saved)) if saved[end - 1] != 0xC2]
    damaged += [saved.replace(b"figure 1", b"figure 2"), saved + b"figure 3\n"]
    for text in damaged:
        file.write_bytes(text)
        with pytest.raises(Refused, match=f"The backup {file.stem!r} is not as it was saved: it is damaged, cut short"):
            device.restore_backup(file.stem)
    assert made[-1].text == "what it has"


@pytest.mark.parametrize("put", ["", "X", "\n", "##"], ids=["lost", "other", "line end", "more"])
def test_a_damaged_checksum_is_no_missing_one(put: str) -> None:
    whole = marked("figure 1\n")
    for place in range(len(whole) - len("\nfigure 1\n")):
        with pytest.raises(Refused, match="is not as it was saved: it is damaged"):
            checked(whole[:place] + put + whole[place + 1 :], "x")
    # Several at once, and something before it.
    line, _, rest = whole.partition("\n")
    elsewhere = ("# edited by me\n" + whole, f"{rest}{line}\n", f"$100=25\n{whole}", whole.upper(), whole.lower())
    parts = [f"{part}\n{rest}" for part in (line[:12], line[:30], line[20:], line[40:])]
    for text in (whole.replace("e", "?").replace("R", "?"), "\n " + whole, *elsewhere, *parts):
        with pytest.raises(Refused, match="is not as it was saved: it is damaged"):
            checked(text, "x")


@pytest.mark.parametrize(
    "first",
    ["", "; $I", "# $I", "$100=250.000", "# All settings that a Pololu Tic keeps, as far as its serial port tells",
     "{", "# backup of my machine, made by hand", "# of what follows only rates are new"],
)  # fmt: skip
def test_what_never_had_a_checksum_is_taken(first: str) -> None:
    text = f"{first}\n$110=500.000\n"
    rest, [said] = checked(text, "x")
    assert rest == text
    assert "has no checksum" in said


def test_one_of_an_older_version_is_restored_and_said_to_be_unchecked(
    device: Device, made: list[Keeper], tmp_path: Path
) -> None:
    device.back_up()
    [file] = saved_in(device, tmp_path).iterdir()
    file.write_text("figure 2\n")
    assert device.restore_backup(file.stem) == (
        f"Whether the backup {file.stem!r} is whole can't be checked: it has no checksum, as those of older versions.",
        "All is well.",
    )
    assert made[-1].text == "figure 2\n"


def test_backups_that_cant_be_listed_are_told(tmp_path: Path) -> None:
    assert Archive(tmp_path).all() == Archived([], [])
    (tmp_path / "backups").write_text("in the folder's place")
    with pytest.raises(Refused, match=r"The backups in .*backups can't be listed: Not a directory"):
        Archive(tmp_path).all()


def test_what_cant_be_listed_hides_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder may not be entered, as after StepRamp ran as another user: the rest is listed, and that one named."""
    blocked, other = (Backups(tmp_path, "grbl", known_port(f"/dev/ttyUSB{each}")) for each in range(2))
    names = [each.save("figure 1") for each in (blocked, other)]
    iterdir = Path.iterdir

    def refuse(folder: Path) -> Iterator[Path]:
        if folder == blocked.folder:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        return iterdir(folder)

    monkeypatch.setattr(Path, "iterdir", refuse)
    said = f"The backups in {blocked.folder} can't be listed: Permission denied."
    found = Archive(tmp_path).all()
    assert [[each.name for each in source.backups] for source in found.sources] == [names[1:]]
    assert found.unreadable == [said]
    # Of a device with folders of older versions, too, whichever of both it is.
    assert other.all().unreadable == []
    other.former, blocked.former = (blocked.folder,), (other.folder,)
    for each in (other, blocked):
        assert ([backup.name for backup in each.all().backups], each.all().unreadable) == (names[1:], [said])
        assert unmarked(each.read(names[1])) == "figure 1"


def test_a_folder_of_backups_that_can_not_be_entered_is_told(tmp_path: Path) -> None:
    """Those of other devices can be read all the same, and those of this one that lie elsewhere."""
    blocked, other = (Backups(tmp_path, "grbl", known_port(f"/dev/ttyUSB{each}")) for each in range(2))
    name = other.save("figure 1")
    blocked.folder.write_text("in the folder's place")
    for ask in (blocked.all, lambda: blocked.read(name)):
        with pytest.raises(Refused, match=rf"The backups in {blocked.folder} can't be listed: Not a directory"):
            ask()
    assert unmarked(Archive(tmp_path).read(other.folder.name, name)) == "figure 1"
    other.former = (blocked.folder,)
    assert unmarked(other.read(name)) == "figure 1"


def test_backups_are_of_a_port_by_all_its_names_and_those_by_the_name_alone_are_found(
    tmp_path: Path,
) -> None:
    port, link = tmp_path / "ttyUSB0", tmp_path / "by-id"
    port.touch()
    link.symlink_to(port)
    by_link, by_name = (Backups(tmp_path, "grbl", known_port(str(each))) for each in (link, port))
    assert by_link.folder == by_name.folder
    name = by_name.save("figure 1")
    # As an older version called it.
    [former] = by_link.former
    former.mkdir()
    (former / "2026-01-01.txt").write_text("figure 2")
    assert [each.name for each in by_link.all().backups] == [name, "2026-01-01"]
    assert (unmarked(by_link.read(name)), by_link.read("2026-01-01")) == ("figure 1", "figure 2")
    assert [each.name for each in by_name.all().backups] == [name]
