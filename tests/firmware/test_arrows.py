"""Who may include whom: the step queue is all that is between motion and hardware."""

import re
from pathlib import Path

SOURCES = Path(__file__).parents[2] / "firmware" / "src"
BELOW_THE_EDGE = {"engine.h", "line_pieces.h", "play_event.h", "step_places.h", "step_rings.h"}
"""How a board keeps and plays segments."""


def included(folder: str) -> dict[str, set[str]]:
    """Return what each file of a folder of the core includes of the library, as paths below src/."""
    files = [path for path in (SOURCES / "stepramp" / folder).iterdir() if path.suffix in {".c", ".h"}]
    assert len(files) > 3
    return {path.name: set(re.findall(r'#include "([^"]+)"', path.read_text(encoding="utf-8"))) for path in files}


def test_what_is_above_the_edge_knows_nothing_of_how_segments_are_played() -> None:
    for folder in ("motion", "protocol", "store"):
        for name, headers in included(folder).items():
            known = {header.removeprefix("stepramp/edge/") for header in headers}
            assert not known & BELOW_THE_EDGE, f"{folder}/{name}"
            assert not [header for header in headers if header.startswith("boards/")], f"{folder}/{name}"


def test_the_edge_knows_nothing_of_what_is_above_it() -> None:
    for name, headers in included("edge").items():
        above = [header for header in headers if header.startswith("stepramp/") and "/edge/" not in header]
        assert above == [], name
