"""Backups of a device: what it told of itself before it was first written to, as files that outlast everything."""

import os
import re
import zlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from difflib import SequenceMatcher
from itertools import chain
from pathlib import Path
from typing import TypeVar

from stepramp.errors import NotFound, Refused, shown
from stepramp.link.ports import Port

T = TypeVar("T")
ENDING = ".txt"
MOST_SLUG = 60
_MARK = "# StepRamp backup"
_MARKED = re.compile(rf"{_MARK}, CRC-32 (?P<crc>[0-9a-f]{{8}}) of what follows\n")
"""The first line of a file. At its end it would be gone with what is cut off."""
_LIKE_MARK = 0.6
"""A text with a line this much like the first one has that, damaged or elsewhere. Others are at most half."""
LEAST_OF_MARK = 8
"""So many characters of it, and nothing else in a line, are what is left of it."""
UNCHECKED = "Whether the backup {name} is whole can't be checked: it has no checksum, as those of older versions."


@dataclass(frozen=True)
class Backup:
    """A file of one device."""

    name: str
    """When it was saved, in UTC: as its file is called, without the ending."""
    bytes: int


@dataclass(frozen=True)
class Source:
    """What backups are of: a family, and what was plugged in where, as far as that was known."""

    name: str
    """Of their folder."""
    family: str
    plugged_in: str
    """The port, or the USB numbers, of which letters and digits are left."""
    backups: list[Backup]
    """The newest first."""


@dataclass(frozen=True)
class Archived:
    """All that there are backups of."""

    sources: list[Source]
    """That with the newest one first."""
    unreadable: list[str]
    """Which folders can't be listed, and why, as sentences."""


@dataclass(frozen=True)
class Saved:
    """What is saved of one device."""

    backups: list[Backup]
    """The newest first."""
    unreadable: list[str]
    """Which of its folders can't be listed, and why, as sentences."""


class Archive:
    """The backups of all devices that there ever were, connected or not. For any thread."""

    def __init__(self, data: Path) -> None:
        self._folder = data / "backups"

    def all(self) -> Archived:
        """Return what there are backups of; Refused when not even that can be looked at."""
        found, refusals = _each(_source, self._folders())
        sources = sorted((each for each in found if each.backups), key=lambda each: each.backups[0].name, reverse=True)
        return Archived(sources, list(map(str, refusals)))

    def source(self, name: str) -> Source:
        """Return one of them; NotFound when there is none of that name."""
        # Whether the others can be looked at is nothing to it.
        for folder in self._folders():
            if folder.name == name and (found := _source(folder)).backups:
                return found
        raise NotFound(f"There are no backups of {shown(name)}.")

    def read(self, source: str, name: str) -> str:
        """Return the text of a backup; NotFound when there is none of that name."""
        return _read(self._folder / self.source(source).name, name, f"of {source}")

    def _folders(self) -> list[Path]:
        try:
            return [each for each in self._folder.iterdir() if each.match("*-*-*") and each.is_dir()]
        except FileNotFoundError:
            return []
        except OSError as error:
            raise _cant_be_listed(self._folder, error) from error


def _each(look: Callable[[Path], T], folders: Iterable[Path]) -> tuple[list[T], list[Refused]]:
    """Look at each folder; return what was found, and why others can't be looked at."""
    found: list[T] = []
    refusals: list[Refused] = []
    for folder in folders:
        try:
            found.append(look(folder))
        except Refused as refusal:
            refusals.append(refusal)
    return found, refusals


def _source(folder: Path) -> Source:
    family, *middle, _ = folder.name.split("-")
    return Source(folder.name, family, "-".join(middle), _all(folder))


def _all(folder: Path) -> list[Backup]:
    """Return what is in a folder, the newest first; Refused when that can't be looked at."""
    found = []
    try:
        for each in sorted(folder.iterdir(), reverse=True):
            # One may be deleted meanwhile, by whoever looks after the folder.
            with suppress(FileNotFoundError):
                if each.suffix == ENDING and not each.name.startswith("."):
                    found.append(Backup(each.stem, each.stat().st_size))
    except FileNotFoundError:
        return []
    except OSError as error:
        raise _cant_be_listed(folder, error) from error
    return found


def _cant_be_listed(folder: Path, error: OSError) -> Refused:
    return Refused(f"The backups in {folder} can't be listed: {error.strerror or error}.")


def _read(folder: Path, name: str, of: str) -> str:
    if name not in {each.name for each in _all(folder)}:
        raise NotFound(f"There is no backup {shown(name)} {of}.")
    try:
        return (folder / f"{name}{ENDING}").read_text(encoding="utf-8-sig")
    except OSError as error:
        raise NotFound(f"The backup {shown(name)} {of} can't be read: {error.strerror or error}.") from error
    except UnicodeDecodeError as error:
        raise Refused(
            f"The backup {shown(name)} {of} isn't text in UTF-8, as it was saved: take another one."
        ) from error


def marked(text: str) -> str:
    """Return a text with a first line by which it is known to be whole; no controller is given that."""
    return f"{_MARK}, CRC-32 {zlib.crc32(text.encode()):08x} of what follows\n{text}"


def unmarked(text: str) -> str:
    """Return a text without that line, whether it is whole or not."""
    return text.partition("\n")[2] if text.startswith(_MARK) else text


def checked(text: str, name: str) -> tuple[str, tuple[str, ...]]:
    """Return the text of a backup of this name without its mark, and what is to be said of it, as sentences.

    Raises Refused for one that is not as it was saved.
    """
    if not (text.startswith(_MARK) or _has_damaged_mark(text)):
        return text, (UNCHECKED.format(name=shown(name)),)
    mark, rest = _MARKED.match(text), unmarked(text)
    if mark is None or int(mark["crc"], 16) != zlib.crc32(rest.encode()):
        raise Refused(
            f"The backup {shown(name)} is not as it was saved: it is damaged, cut short, or was changed since, as the "
            "checksum in its first line tells. Take another one; whoever has changed it deletes that line."
        )
    return rest, ()


def _has_damaged_mark(text: str) -> bool:
    """Whether a text has nearly the line with the checksum, wherever: else it would be taken for one of before."""
    return any(map(_is_like_mark, text.lstrip().splitlines()))


def _is_like_mark(line: str) -> bool:
    whole = marked("").rstrip("\n").casefold()
    line = re.sub(r"[0-9a-f]{8}", "0" * 8, line.casefold())
    matcher = SequenceMatcher(None, whole, line[: len(whole)], autojunk=False)
    is_part = len(line) >= LEAST_OF_MARK and line in whole and line.strip("0 ") != ""
    return is_part or (matcher.real_quick_ratio() > _LIKE_MARK and matcher.ratio() > _LIKE_MARK)


class Backups:
    """Those of one device: a folder for its family and for what is plugged in there. For any thread.

    Where older versions called that by the name that its port was given, or by its port alone, what they have saved is
    there as well.
    """

    def __init__(self, data: Path, family: str, known: Port) -> None:
        self._data, self._family = data, family
        self.know(known)

    def know(self, known: Port) -> None:
        """Take those of what is plugged in, as far as that is known now."""

        def of(identity: object) -> Path:
            text = repr(identity)
            slug = re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")[:MOST_SLUG]
            return self._data / "backups" / f"{self._family}-{slug}-{zlib.crc32(text.encode()):08x}"

        self.folder = of(known.board)
        former = () if known.unit else (known.identity, known.port)
        self.former = tuple(each for each in dict.fromkeys(map(of, former)) if each != self.folder)
        """Folders of older versions."""

    def are_in(self, source: str) -> bool:
        """Whether a source of backups, by its name, is this device."""
        return source in {folder.name for folder in (self.folder, *self.former)}

    def save(self, text: str) -> str:
        """Write a backup so that it is there whole or not at all, also after a power cut; return its name.

        Raises Refused when it can't be written.
        """
        name = datetime.now(UTC).strftime("%Y-%m-%dT%H-%M-%S.%fZ")
        try:
            write_whole(self.folder / f"{name}{ENDING}", marked(text))
        except OSError as error:
            reason = error.strerror or str(error)
            raise Refused(
                f"What the device has now can't be saved in {self.folder} ({reason}): nothing was written to it."
            ) from error
        return name

    def all(self) -> Saved:
        """Return what there is; Refused when all that there may be can't be looked at."""
        found, refusals = _each(_all, (self.folder, *self.former))
        backups = sorted(chain.from_iterable(found), key=lambda each: each.name, reverse=True)
        if refusals and not backups:
            raise refusals[0]
        return Saved(backups, list(map(str, refusals)))

    def read(self, name: str) -> str:
        """Return the text of a backup; NotFound when there is none of that name, Refused when that isn't known."""
        found, refusals = _each(lambda folder: (folder, _all(folder)), (self.folder, *self.former))
        place = next((folder for folder, there in found if name in {each.name for each in there}), None)
        if place is None and refusals:
            raise refusals[0]
        return _read(place or self.folder, name, "of this device")


def write_whole(file: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all, also after a power cut; OSError when it can't be."""
    part = file.with_name(f".{file.stem}.part")
    try:
        _make(file.parent)
        with part.open("w", encoding="utf-8", newline="\n") as opened:
            opened.write(text)
            opened.flush()
            os.fsync(opened.fileno())
        part.replace(file)
        _sync(file.parent)
    except OSError:
        with suppress(OSError):
            part.unlink()
        raise


def _make(folder: Path) -> None:
    """Make a folder, and those above it that are missing, so that they outlast a power cut."""
    if not folder.is_dir():
        _make(folder.parent)
        folder.mkdir(exist_ok=True)
        _sync(folder.parent)


def _sync(folder: Path) -> None:
    """Have what a folder lists on the disk."""
    if os.name == "posix":
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
