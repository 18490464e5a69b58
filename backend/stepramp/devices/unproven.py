"""What a device was given whose storing isn't proven yet: a file beside its backups, which outlasts the program."""

import json
import logging
import os
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import ClassVar

from stepramp.devices.backups import write_whole

FILE = "unproven.json"
MOST_CHARACTERS = 40
"""Of a name, a value and a time."""
DAMAGED = (
    "What was written from here and isn't proven to be stored was noted in {file}, which can't be read ({why}): "
    "whether the controller has stored it isn't known. Compare the settings that it has with a backup of this device, "
    "or push again."
)
OF_THE_PORT = (
    "What was written at this port and isn't proven to be stored was noted in {file} by the port alone, as older "
    "versions do: whether this controller was given it isn't known. Compare the settings that it has with a backup of "
    "this device, or push again."
)

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Given:
    """What a setting was given. at: when, in UTC, for people."""

    value: str
    at: str


class Unproven:
    """The settings of one device by name. Not for two threads at once.

    folder: that of its backups. former: where they were noted of whatever was at the port, which is told until the next
    change, and never taken for what this device was given. Where the folder can't be written, they are known as long as
    the program runs.
    """

    _unwritten: ClassVar[dict[Path, tuple[Mapping[str, Given], str]]] = {}
    """What couldn't be written, and why, by the file that is older now."""

    def __init__(self, folder: Path, former: Collection[Path] = ()) -> None:
        self._file = folder / FILE
        self.damage: str | None = None
        """Why it isn't known what was given before, and what is to be done, as a sentence; None: it is."""
        self.given: Mapping[str, Given] = {}
        try:
            self.given = self._read(self._file)
        except FileNotFoundError:
            self._look_at([each / FILE for each in former])

    @property
    def trouble(self) -> str | None:
        """Why the file isn't as they are, and what comes of that, as a sentence; None: it is."""
        if self._file not in self._unwritten:
            return None
        _, why = self._unwritten[self._file]
        return (
            f"What is to be proven at its next start can't be written down in {self._file.parent} ({why}): it is known "
            "only as long as StepRamp runs."
        )

    def note(self, given: Mapping[str, str | None]) -> None:
        """Note what settings were given just now; of those that are None nothing is to be proven."""
        at = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
        left = {name: each for name, each in self.given.items() if name not in given}
        self._keep(left | {name: Given(value, at) for name, value in given.items() if value is not None})

    def drop(self, names: Collection[str]) -> None:
        """Note that these settings are proven."""
        self._keep({name: each for name, each in self.given.items() if name not in names})

    def _keep(self, given: Mapping[str, Given]) -> None:
        if given == self.given and self._file not in self._unwritten and self.damage is None:
            return
        self.given, self.damage = given, None
        try:
            write_whole(self._file, json.dumps({name: asdict(each) for name, each in given.items()}, indent=1))
            self._unwritten.pop(self._file, None)
        except OSError as error:
            self._unwritten[self._file] = given, error.strerror or str(error)
            _logger.warning("What isn't proven yet can't be kept in %s: %s", self._file, error.strerror or error)

    def _look_at(self, former: Collection[Path]) -> None:
        """Tell of the first of these files that has anything."""
        for file in former:
            with suppress(FileNotFoundError):
                if self._read(file):
                    self.damage = OF_THE_PORT.format(file=file)
            if self.damage is not None:
                return

    def _read(self, file: Path) -> Mapping[str, Given]:
        """Return what is noted in a file, or would be; damage tells why that can't be read. FileNotFoundError: none."""
        if file in self._unwritten:
            return self._unwritten[file][0]
        try:
            told = json.loads(file.read_text(encoding="utf-8"))
            return {
                _sensible(name): Given(_sensible(each["value"]), _sensible(each["at"])) for name, each in told.items()
            }
        except FileNotFoundError:
            raise
        except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            _logger.warning("What isn't proven yet can't be read from %s: %s", os.fspath(file), error)
            why = error.strerror if isinstance(error, OSError) and error.strerror else "it is damaged"
            self.damage = DAMAGED.format(file=file, why=why)
            return {}


def _sensible(told: object) -> str:
    """Return a text of the file; ValueError for one that this program has not written: the file is damaged."""
    if not isinstance(told, str) or not 0 < len(told) <= MOST_CHARACTERS or not (told.isascii() and told.isprintable()):
        raise ValueError(f"{str(told)[:MOST_CHARACTERS]!r} makes no sense there")
    return told
