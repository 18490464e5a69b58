"""Texts that no controller tells, for every family's reader: each is read to its end, however it is made up.

Python's regular expressions let nothing else of the program go on: a text that keeps one busy keeps a STOP waiting.
"""

from __future__ import annotations

import pytest

from designs import design
from stepramp.controllers.families import FAMILIES
from stepramp.controllers.grbl.backup import Backup
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
    "brackets that stay open": "$N0=" + " (" * (LONG // 2) + "!",
    "blanks in a start-up line": "$N0=G54" + " " * LONG + "!",
    "tabs before nothing": "\t" * LONG,
    "tabs before something": "\t" * LONG + "!",
    "blanks before something": " " * LONG + "!",
    "blanks behind a terminal's mark": "Recv:" + " " * LONG + "!",
    **{
        f"{piece!r} again and again": piece * (LONG // len(piece)) + "!"
        for piece in ("> ", "echo:", "[1] ", "a: ", "$1=", "# ", "axis 0 ", "22:10 ", ">", "[", "$$ ")
    },
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


@pytest.mark.parametrize("text", ODD_TEXTS.values(), ids=ODD_TEXTS.keys())
def test_every_text_is_read_to_its_end_as_a_backup_of_grbl(text: str) -> None:
    with pytest.raises(Rejected) as rejected:
        Backup.of(text)
    assert [each.field for each in rejected.value.rejections] == ["text"]


NUMBERS = ["0", "-1", "nan", "inf", "1e308", "1e-308", "5e-324", "9" * 37, "9" * 400, "1_0", "1.2.3", "0x10", "", "-"]
LISTINGS = {
    "grbl": "$100={0}\n$110={1}\n$120={2}",
    "marlin": "M92 X{0} Y80 Z400 E93\nM203 X{1} Y1 Z1 E1\nM201 X{2} Y1 Z1 E1",
    "fluidnc": "axes:\n  x:\n    steps_per_mm: {0}\n    max_rate_mm_per_min: {1}\n    motor0:\n      microsteps: {2}",
    "tic": "max_speed: {0}\nmax_accel: {1}\nstarting_speed: {2}",
    "klipper": (
        "[printer]\nkinematics: cartesian\nmax_velocity: {1}\nmax_accel: {2}\n"
        + "".join(f"[stepper_{each}]\nmicrosteps: 16\nrotation_distance: {{0}}\n" for each in "xyz")
    ),
}
TYPICAL = ("80", "500", "40")


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("family", LISTINGS)
def test_a_number_that_no_axis_has_is_refused_or_left_out(family: str, place: int, number: str) -> None:
    numbers = [number if each == place else usual for each, usual in enumerate(TYPICAL)]
    try:
        axes = READERS[family](LISTINGS[family].format(*numbers), design())
    except Rejected as rejected:
        assert rejected.rejections[0].field == "text"
    else:
        assert all(each.design.ramp.slew_speed_steps_per_s > 0 for each in axes)
