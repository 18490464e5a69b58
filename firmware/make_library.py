"""Make the folder that Arduino's Library Manager, or a sketchbook's `libraries`, wants: the library without the rest.

usage: python firmware/make_library.py FOLDER
"""

import shutil
import sys
from pathlib import Path

FIRMWARE = Path(__file__).parent
PARTS = ("library.properties", "keywords.txt", "README.md", "src", "examples")


def make_library(folder: Path) -> None:
    """Copy the library into a folder that isn't there yet."""
    folder.mkdir(parents=True)
    for part in PARTS:
        source = FIRMWARE / part
        if source.is_dir():
            shutil.copytree(source, folder / part)
        else:
            shutil.copy(source, folder / part)
    shutil.copy(FIRMWARE.parent / "LICENSE", folder / "LICENSE")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(str(__doc__))
    if Path(sys.argv[1]).exists():
        sys.exit(f"{sys.argv[1]} is there already")
    make_library(Path(sys.argv[1]))
