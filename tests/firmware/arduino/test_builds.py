"""The examples built for an Arduino Uno, and for a Mega."""

from collections.abc import Callable

import pytest

from firmware.arduino.board import EXAMPLES, LEONARDO, MEGA, UNO, build

pytestmark = pytest.mark.usefixtures("arduino_tools")

STACK_BYTES = 380
"""Left at least for the stack, of which the Controller takes some 250 with the core's interrupts, and others less."""


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_fit_an_uno(example: str, record_property: Callable[..., None]) -> None:
    sketch = build(example)
    record_property("flash_bytes", sketch.flash_bytes)
    record_property("ram_bytes", sketch.ram_bytes)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= UNO.flash_bytes
    assert sketch.ram_bytes <= UNO.ram_bytes - STACK_BYTES


@pytest.mark.parametrize("example", ["ExportedRamp", "LeadScrewStage", "LineOfTwoMotors", "OneMotor", "ThreeGauges"])
def test_these_fit_a_leonardo(example: str, record_property: Callable[..., None]) -> None:
    sketch = build(example, LEONARDO)
    record_property("flash_bytes", sketch.flash_bytes)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= LEONARDO.flash_bytes


def test_a_mega_has_room_for_formulas(record_property: Callable[..., None]) -> None:
    sketch = build("Controller", MEGA)
    record_property("flash_bytes", sketch.flash_bytes)
    record_property("ram_bytes", sketch.ram_bytes)
    assert sketch.warnings == ""
    assert sketch.has_formulas()
    assert not build("Controller").has_formulas()
