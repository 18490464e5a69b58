"""Where machine code is kept: a folder for each state of the sources, and none of older ones that nobody uses."""

import hashlib
import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path

if sys.platform != "win32":
    import fcntl

SOURCES = ("numerics", "shapes", "methods", "ramp", "capture")
"""Folders of all that is compiled, and of what it calls and takes its constants from."""
PREFIX = "stepramp-"
IN_USE = "in_use"
"""A file of each folder, locked by the processes that use it for as long as they run."""


def code_folder(package: Path, parent: Path) -> Path:
    """Return where machine code made of these sources is kept: their names, sizes and times are in its name."""
    digest = hashlib.sha256()
    for source in sorted(path for folder in SOURCES for path in (package / folder).rglob("*.py")):
        about = source.stat()
        digest.update(f"{source.relative_to(package)} {about.st_size} {about.st_mtime_ns}\n".encode())
    return parent / f"{PREFIX}{digest.hexdigest()[:12]}"


def use(folder: Path) -> None:
    """Keep a folder for as long as this process runs; a new one takes the place of those that nobody uses."""
    # Where nothing can be written, nothing is kept.
    with suppress(OSError):
        is_new = not folder.exists()
        folder.mkdir(parents=True, exist_ok=True)
        # It stays open until the process ends.
        _lock(_opened(folder), is_alone=False)
        if is_new:
            for other in folder.parent.glob(f"{PREFIX}*"):
                if other != folder:
                    _remove_unless_used(other)


def _remove_unless_used(folder: Path) -> None:
    """Remove a folder: a process of older sources may compile yet, and can't go on without its own."""
    # What can't be removed does no harm.
    with suppress(OSError):
        file = _opened(folder)
        try:
            _lock(file, is_alone=True)
        finally:
            os.close(file)
        (folder / IN_USE).unlink()
        shutil.rmtree(folder, ignore_errors=True)


def _opened(folder: Path) -> int:
    return os.open(folder / IN_USE, os.O_RDWR | os.O_CREAT)


def _lock(file: int, *, is_alone: bool) -> None:
    """Lock a file with others or, if nobody has it, alone: else OSError. On Windows one that is open stays anyway."""
    if sys.platform != "win32":
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB if is_alone else fcntl.LOCK_SH)
