"""The page for those who come from other libraries: its sketches are compiled, its calls exist."""

import re
from pathlib import Path

import pytest

from firmware.arduino.board import LIBRARY, UNO, build_sketch

PAGE = (Path(__file__).parents[3] / "docs" / "coming_from.md").read_text(encoding="utf-8")
SKETCHES = re.findall(r"```cpp\n(.*?)```", PAGE, re.DOTALL)
OURS = [row.split("|")[2] for row in PAGE.splitlines() if row.startswith("| ") and "MobaTools" not in row]
"""The cells of the table's column StepRampAxis."""


def methods_of(header: str) -> set[str]:
    text = (LIBRARY / "src" / header).read_text(encoding="utf-8").partition("private:")[0]
    return set(re.findall(r"(\w+)\([^()]*\)(?: const)?;", text))


@pytest.mark.usefixtures("arduino_tools")
@pytest.mark.parametrize("number", range(3))
def test_its_sketches_are_compiled_without_a_warning(tmp_path: Path, number: int) -> None:
    source = tmp_path / f"ComingFrom{number}.ino"
    source.write_text(SKETCHES[number])
    sketch = build_sketch(source)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= UNO.flash_bytes


def test_all_sketches_are_tried() -> None:
    assert len(SKETCHES) == 3


def test_each_call_in_the_table_exists() -> None:
    calls = {call for cell in OURS for call in re.findall(r"\bx\.(\w+)\(", cell)}
    assert len(calls) > 10
    assert calls <= methods_of("StepRampAxis.h")
    whole = {call for cell in OURS for call in re.findall(r"\bStepRamp\.(\w+)\(", cell)}
    assert whole <= methods_of("StepRamp.h")
    assert whole


def test_each_call_of_an_axis_is_on_the_page() -> None:
    named = set(re.findall(r"(\w+)\(", PAGE))
    assert methods_of("StepRampAxis.h") - named - {"StepRampAxis", "mostSpeed", "useRampInFlash"} == set()
