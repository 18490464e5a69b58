"""Machine code is made anew when any of its sources has changed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from stepramp.numerics.compiled import PACKAGE

READ = """
from stepramp.capture.formats.csv_rows import LATE, _instant
import numpy as np
text = np.frombuffer(b"100000000000000001,", np.uint8)
print(_instant(text, 0, ord(","), 0)[2] == LATE)
"""


def is_late(package: Path) -> bool:
    """Return whether a time of 10**17 and 1 ticks is late, by code that takes its limit from another module."""
    settings = {**os.environ, "PYTHONPATH": str(package.parent)}
    result = subprocess.run([sys.executable, "-c", READ], env=settings, capture_output=True, text=True, check=True)
    return result.stdout.strip() == "True"


def test_a_constant_of_another_module_is_never_an_old_one(tmp_path: Path) -> None:
    package = tmp_path / "stepramp"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    assert not is_late(package)
    recording = package / "capture" / "recording.py"
    recording.write_text(recording.read_text().replace("LATEST_TICKS = 10**18", "LATEST_TICKS = 10**17"))
    assert is_late(package)
