"""A backup of a Klipper: its configuration's files, line by line, and the limits that it had in use."""

import json
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from stepramp.controllers.klipper.configuration import MAIN
from stepramp.errors import Count, Rejected, Rejection

KIND = "klipper"
LIMITS = ("VELOCITY", "ACCEL", "MINIMUM_CRUISE_RATIO", "SQUARE_CORNER_VELOCITY")
"""What SET_VELOCITY_LIMIT sets; the first two are above 0."""
ALLOWED = "a backup of a Klipper, as StepRamp saves it"


class _Document(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)

    backup_of: str = Field(pattern=f"^{KIND}$")
    main: str
    limits: dict[str, float]
    files: dict[str, list[str]]


@dataclass(frozen=True)
class Backup:
    """What can be written again."""

    main: str
    limits: dict[str, float]
    """In use, by the names of SET_VELOCITY_LIMIT; none of a Klipper that wasn't ready."""
    files: dict[str, str]
    """The texts by their paths."""

    @classmethod
    def read(cls, text: str) -> Self | None:
        """Return what a text says; None for one that is no such backup."""
        if KIND not in text[:100]:
            return None
        try:
            document = _Document.model_validate_json(text)
        except ValidationError:
            return None
        files = {path: "\n".join(lines) for path, lines in document.files.items()}
        are_limits = all(_is_limit(name, value) for name, value in document.limits.items())
        if document.main not in files or not all(map(_is_below, files)) or not are_limits:
            return None
        return cls(document.main, document.limits, files)

    @classmethod
    def of(cls, text: str) -> Self:
        """Return what a text says; Rejected for one that is no such backup."""
        backup = cls.read(text)
        if backup is None:
            raise Rejected([Rejection("text", Count(f"{len(text.splitlines())} lines"), ALLOWED)])
        return backup

    @property
    def text(self) -> str:
        """The same as text, in which each line of a file is one."""
        files = {path: text.split("\n") for path, text in self.files.items()}
        document = {"backup_of": KIND, "main": self.main, "limits": self.limits, "files": files}
        return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def pasted(text: str) -> Backup:
    """Return a configuration that somebody has pasted as what a backup of it would be."""
    return Backup(MAIN, {}, {MAIN: text})


def _is_below(path: str) -> bool:
    """Tell whether a path stays below the folder of configurations."""
    return not PurePosixPath(path).is_absolute() and ".." not in PurePosixPath(path).parts


def _is_limit(name: str, value: float) -> bool:
    return value > 0 if name in LIMITS[:2] else name in LIMITS and value >= 0
