"""The examples built for an Arduino Uno, and for a Mega."""

import re
from collections.abc import Callable

import pytest

from firmware.arduino.board import EXAMPLES, LEONARDO, LIBRARY, MEGA, UNO, Sketch, build
from firmware.arduino.sketches import source_of

pytestmark = pytest.mark.usefixtures("arduino_tools")

STACK_BYTES = 380
"""Left at least for the stack, of which the Controller takes some 250 with the core's interrupts, and others less."""
CLOSE = 0.02
"""So far may the library's page be off."""


def told_flash_bytes() -> dict[str, list[int | None]]:
    """Return what the library's page says of each example's flash: on an Uno, a Leonardo, each with a timer, too."""
    text = (LIBRARY / "README.md").read_text().partition("\n### Flash\n")[2].partition("\n#")[0]
    rows = re.findall(r"^\| `(\w+)` \| (.+) \|$", text, re.MULTILINE)
    numbers = {name: [cell.replace(",", "") for cell in cells.split(" | ")] for name, cells in rows}
    return {name: [int(cell) if cell.isdigit() else None for cell in cells] for name, cells in numbers.items()}


TOLD = told_flash_bytes()


def is_as_told(sketch: Sketch, told: int | None) -> bool:
    return told is not None and abs(sketch.flash_bytes - told) <= CLOSE * told


def test_the_page_names_each_example() -> None:
    assert sorted(TOLD) == EXAMPLES


FITS = {
    (True, True, True, True): "It fits an Uno, a Mega and a Leonardo, with a timer, too.",
    (True, True, True, False): "It fits an Uno and a Mega, with a timer, too; a Leonardo without a timer.",
    (True, True, False, False): "It fits an Uno and a Mega, with a timer, too; no Leonardo.",
    (True, False, False, False): "It fits an Uno without a timer, and a Mega; no Leonardo.",
}


@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_says_at_its_head_where_it_fits(example: str) -> None:
    head = source_of(example).partition("*/")[0]
    assert FITS[tuple(told is not None for told in TOLD[example])] in " ".join(head.split())


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_fit_an_uno(example: str, record_property: Callable[..., None]) -> None:
    sketch = build(example)
    record_property("flash_bytes", sketch.flash_bytes)
    record_property("ram_bytes", sketch.ram_bytes)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= UNO.flash_bytes
    assert is_as_told(sketch, TOLD[example][0])
    assert sketch.ram_bytes <= UNO.ram_bytes - STACK_BYTES


@pytest.mark.parametrize("example", [example for example, told in TOLD.items() if told[2]])
def test_these_fit_a_leonardo(example: str, record_property: Callable[..., None]) -> None:
    sketch = build(example, LEONARDO)
    record_property("flash_bytes", sketch.flash_bytes)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= LEONARDO.flash_bytes
    assert is_as_told(sketch, TOLD[example][2])


def test_a_mega_has_room_for_formulas(record_property: Callable[..., None]) -> None:
    sketch = build("Controller", MEGA)
    record_property("flash_bytes", sketch.flash_bytes)
    record_property("ram_bytes", sketch.ram_bytes)
    assert sketch.warnings == ""
    assert sketch.has_formulas()
    assert not build("Controller").has_formulas()
