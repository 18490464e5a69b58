"""Texts that no controller tells, of every family's reader: each is read to its end, however it is made up.

Python's regular expressions let nothing else of the program go on: a text that keeps one busy keeps a STOP waiting.
"""

from __future__ import annotations

import pytest

from designs import design
from stepramp.controllers.families import FAMILIES
from stepramp.errors import Rejected

LONG = 100_000
"""So many characters an import takes."""
ODD_TEXTS = {
    "numbers after each other": "M92" + " X1111111111" * (LONG // 12) + "!",
    "a number without an end": "M92 X" + "1" * LONG + "!",
    "blanks before quotes": "max_speed:" + " " * LONG + "''x",
    "blanks in a name": "[printer]\na" + " " * LONG + "b",
    "blanks before a colon": "[printer]\na" + " " * LONG + "b: 1",
    "blanks in a value": "[printer]\na: b" + " " * LONG + "c",
    "other blanks": "[printer]\na" + "\u2003" * LONG + "b: 1",
    "brackets": "$110=1" + " (" * (LONG // 2) + ")",
    "tabs before nothing": "\t" * LONG,
}
READERS = {name: family.read_settings for name, family in FAMILIES.items() if family.read_settings is not None}


@pytest.mark.parametrize("text", ODD_TEXTS.values(), ids=ODD_TEXTS.keys())
@pytest.mark.parametrize("family", READERS)
def test_every_text_is_read_to_its_end(family: str, text: str) -> None:
    try:
        axes = READERS[family](text, design())
    except Rejected as rejected:
        assert [each.field for each in rejected.rejections] == ["text"]
    else:
        assert axes == []
