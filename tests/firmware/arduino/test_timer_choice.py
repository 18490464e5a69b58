"""Which timer a sketch may choose, what it then may still have of its own, and the examples with a timer."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from firmware.arduino.board import LEONARDO, MEGA, UNO, Board, build_files, build_sketch
from firmware.arduino.sketches import image_in, source_of

pytestmark = pytest.mark.usefixtures("arduino_tools")

SKETCH = "#include <StepRamp.h>\n{}\nvoid setup() {{ StepRamp.poll(); }}\nvoid loop() {{}}\n"
TIMERS = [(UNO, 1), (MEGA, 1), (MEGA, 3), (MEGA, 4), (MEGA, 5), (LEONARDO, 1), (LEONARDO, 3)]
SERVO_VECTORS = {UNO: (1,), MEGA: (1, 3, 4, 5), LEONARDO: (1,)}
"""The timers whose compare A the Servo library has as soon as it is linked."""


def source_file(folder: Path, lines: str) -> Path:
    source = folder / "choice.ino"
    source.write_text(SKETCH.format(lines))
    return source


@pytest.mark.parametrize(("board", "timer"), TIMERS, ids=lambda value: getattr(value, "name", value))
def test_each_timer_of_a_board_can_be_chosen(tmp_path: Path, board: Board, timer: int) -> None:
    """And no other interrupt is taken: on boards with a compare C, Servo can be linked beside it."""
    lines = f"#include <StepRampTimer{timer}.h>\n"
    lines += "".join(f"ISR(TIMER{number}_COMPA_vect) {{}}\n" for number in SERVO_VECTORS[board] if board != UNO)
    assert build_sketch(source_file(tmp_path, lines), board).warnings == ""


@pytest.mark.parametrize("board", [UNO, MEGA, LEONARDO], ids=lambda board: board.name)
def test_without_a_choice_all_interrupts_are_the_sketchs(tmp_path: Path, board: Board) -> None:
    vectors = [f"TIMER{number}_COMP{channel}_vect" for number in SERVO_VECTORS[board] for channel in "AB"]
    source = source_file(tmp_path, "".join(f"ISR({vector}) {{}}\n" for vector in vectors))
    assert build_sketch(source, board).warnings == ""


@pytest.mark.parametrize(
    ("board", "lines", "message"),
    [
        (UNO, "#include <StepRampTimer3.h>", "This board has no Timer3 that StepRamp could use"),
        (LEONARDO, "#include <StepRampTimer4.h>", "This board has no Timer4 that StepRamp could use"),
        (UNO, "#define Servo_h\n#include <StepRampTimer1.h>", "Servo has Timer1"),
        (MEGA, "#include <StepRampTimer1.h>\n#include <StepRampTimer5.h>", "Only one of StepRampTimer1.h"),
        (UNO, "#include <StepRampTimer1.h>\nISR(TIMER1_COMPA_vect) {}", "redefinition of .*__vector_11"),
    ],
)
def test_a_bad_choice_is_told_in_words(tmp_path: Path, board: Board, lines: str, message: str) -> None:
    with pytest.raises(AssertionError, match=message):
        build_sketch(source_file(tmp_path, lines), board)


def test_a_second_file_with_it_is_told_of_by_the_linker(tmp_path: Path) -> None:
    first, second = tmp_path / "first.cpp", tmp_path / "second.cpp"
    first.write_text("#include <Arduino.h>\n" + SKETCH.format("#include <StepRampTimer1.h>"))
    second.write_text("#include <Arduino.h>\n#include <StepRampTimer1.h>\n")
    with pytest.raises(AssertionError, match="StepRampTimer_is_included_in_more_than_one_file"):
        build_files([first, second], tmp_path, UNO)


COMPUTED = ["OneMotor", "LineOfTwoMotors", "StopInFlight", "EmergencyStop", "Controller"]
"""Examples with more than a Leonardo's flash has room for, with a timer."""
EXPORTED = ["LeadScrewStage", "ExportedRamp", "ThreeGauges"]


@pytest.mark.parametrize(
    ("board", "example"),
    [(board, example) for board in (UNO, MEGA) for example in COMPUTED + EXPORTED]
    + [(MEGA, "Homing")]
    + [(LEONARDO, example) for example in EXPORTED],
    ids=lambda value: getattr(value, "name", value),
)
def test_examples_with_a_timer_fit(
    tmp_path: Path, example: str, board: Board, record_property: Callable[..., None]
) -> None:
    text = source_of(example)
    source = tmp_path / f"{example}-timer.ino"
    source.write_text(f"#include <StepRampTimer1.h>\n{text}")
    sketch = build_sketch(source, board)
    record_property("flash_bytes", sketch.flash_bytes)
    record_property("ram_bytes", sketch.ram_bytes)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= board.flash_bytes
    assert sketch.ram_bytes <= board.ram_bytes - 400


def built_with_exported_ramp(folder: Path, board: Board, timer: bool, text: str) -> int:
    """Return the flash [bytes] of a sketch with an exported ramp, `RAMP`, in flash."""
    ramp = ", ".join(map(str, image_in("ExportedRamp")))
    lines = [TIMER if timer else "", "#include <StepRampAxis.h>", f"const uint8_t RAMP[] PROGMEM = {{{ramp}}};"]
    source = folder / "exported.ino"
    source.write_text("\n".join([*lines, text]))
    sketch = build_sketch(source, board)
    assert sketch.warnings == ""
    return sketch.flash_bytes


TIMER = "#include <StepRampTimer1.h>"


@pytest.mark.parametrize(
    ("example", "board", "timer"),
    [
        ("OneMotor", LEONARDO, True),
        ("LineOfTwoMotors", LEONARDO, True),
        ("StopInFlight", LEONARDO, True),
        ("EmergencyStop", LEONARDO, False),
        ("Homing", UNO, True),
    ],
)
def test_where_a_computed_ramp_does_not_an_exported_one_fits(
    tmp_path: Path, example: str, board: Board, timer: bool
) -> None:
    """As nothing of computing is linked then. 1 KB is left for a sketch of one's own."""
    text, changed = re.subn(r"\.setRamp\([^)]*\)", ".useRampInFlash(RAMP, sizeof RAMP)", source_of(example))
    assert changed == 1
    assert built_with_exported_ramp(tmp_path, board, timer, text) <= board.flash_bytes - 1000


BY_STEPRAMP = """
uint8_t ramp[sizeof RAMP];
void setup() {{
  memcpy_P(ramp, RAMP, sizeof ramp);
  StepRamp.setStepper(0, 4, 7);
  {}
  StepRamp.begin(ramp, sizeof ramp);
}}
void loop() {{
  StepRamp.poll();
  {}
}}
"""


@pytest.mark.parametrize(
    ("timer", "setup", "loop"),
    [
        (True, "StepRamp.setEmergencyStop(2);", "StepRamp.moveTo(0, 800); StepRamp.acknowledge();"),
        (False, "StepRamp.setEmergencyStop(2); StepRamp.setLowLimit(0, 9);", "StepRamp.home(0, -4000, 20000);"),
    ],
)
def test_without_an_axis_object_more_fits_a_leonardo(tmp_path: Path, timer: bool, setup: str, loop: str) -> None:
    text = BY_STEPRAMP.format(setup, loop)
    assert built_with_exported_ramp(tmp_path, LEONARDO, timer, text) <= LEONARDO.flash_bytes - 500
