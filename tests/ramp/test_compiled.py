"""Machine code is made anew when any of its sources has changed; what was made before is removed unless it is used."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from stepramp.numerics.compiled import PACKAGE

READ = """
from stepramp.capture.formats.csv_rows import LATE, _instant
import numpy as np
text = np.frombuffer(b"100000000000000001,", np.uint8)
print(_instant(text, 0, ord(","), 0)[2] == LATE)
"""
COMPILES = """
from stepramp.numerics.compiled import counted
print("uses its folder", flush=True)
input()
print(counted(4, 3).tolist())
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Return a copy of the package, without machine code."""
    copy = tmp_path / "stepramp"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    return copy


def environment(package: Path) -> dict[str, str]:
    """Return that of a process that runs a copy of the package."""
    own = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    return {**own, "PYTHONPATH": str(package.parent)}


def run(package: Path, script: str) -> str:
    """Return what a script prints with a copy of the package."""
    command, settings = [sys.executable, "-c", script], environment(package)
    return subprocess.run(command, env=settings, input="\n", capture_output=True, text=True, check=True).stdout


def is_late(package: Path) -> bool:
    """Return whether a time of 10**17 and 1 ticks is late, by code that takes its limit from another module."""
    return run(package, READ).strip() == "True"


def change(package: Path) -> None:
    """Add a line to a source of which machine code is made."""
    recording = package / "capture" / "recording.py"
    recording.write_text(recording.read_text() + "# changed\n")


def folders(package: Path) -> set[Path]:
    """Return those of machine code."""
    return {path for path in (package / "__pycache__").glob("stepramp-*") if path.is_dir()}


@contextmanager
def older_process(package: Path) -> Iterator[subprocess.Popen[str]]:
    """Run a process that uses its folder, and compiles once it is told to."""
    command = [sys.executable, "-c", COMPILES]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=environment(package), stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "uses its folder\n"
        yield process


def test_a_constant_of_another_module_is_never_an_old_one(package: Path) -> None:
    assert not is_late(package)
    recording = package / "capture" / "recording.py"
    recording.write_text(recording.read_text().replace("LATEST_TICKS = 10**18", "LATEST_TICKS = 10**17"))
    assert is_late(package)


def test_what_was_made_of_older_sources_is_removed_and_nothing_else(package: Path) -> None:
    run(package, COMPILES)
    [older] = folders(package)
    # No folder, which can't be removed as one.
    odd = package / "__pycache__" / "stepramp-odd"
    odd.touch()
    run(package, COMPILES)
    assert folders(package) == {older}, "still that of the sources"
    change(package)
    run(package, COMPILES)
    [newer] = folders(package)
    assert newer != older
    assert odd.exists()
    assert list(newer.rglob("*.nbi")), "made, and kept"


def test_what_a_process_of_older_sources_uses_stays_until_it_has_ended(package: Path) -> None:
    with older_process(package) as process:
        [older] = folders(package)
        change(package)
        run(package, COMPILES)
        assert older in folders(package)
        told, _ = process.communicate("\n")
        assert (told, process.returncode) == ("[4, 5, 6]\n", 0)
        assert list(older.rglob("*.nbi")), "kept as ever"
    change(package)
    run(package, COMPILES)
    assert len(folders(package)) == 1


def test_a_folder_that_somebody_named_is_left_alone(package: Path, tmp_path: Path) -> None:
    other = tmp_path / "named" / "stepramp-0123456789ab"
    other.mkdir(parents=True)
    script = "import stepramp.numerics.compiled"
    settings = {**environment(package), "NUMBA_CACHE_DIR": str(other.parent)}
    subprocess.run([sys.executable, "-c", script], env=settings, check=True)
    assert other.exists()
    assert len(list(other.parent.iterdir())) == 2
    assert not folders(package)
