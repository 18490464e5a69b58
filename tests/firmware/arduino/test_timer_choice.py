"""Which timer a sketch may choose, what it then may still have of its own, and the examples with a timer."""

from collections.abc import Callable
from pathlib import Path

import pytest

from firmware.arduino.board import LEONARDO, LIBRARY, MEGA, UNO, Board, build_files, build_sketch
from firmware.arduino.sketches import image_in

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
    text = (LIBRARY / "examples" / example / f"{example}.ino").read_text()
    source = tmp_path / f"{example}-timer.ino"
    source.write_text(f"#include <StepRampTimer1.h>\n{text}")
    sketch = build_sketch(source, board)
    record_property("flash_bytes", sketch.flash_bytes)
    record_property("ram_bytes", sketch.ram_bytes)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= board.flash_bytes
    assert sketch.ram_bytes <= board.ram_bytes - 400


WITHOUT_COMPUTING = """#include <StepRampAxis.h>
{timer}
const uint8_t RAMP[] PROGMEM = {{{bytes}}};
StepRampAxis motor(4, 7);

void setup() {{
  {inputs}
  motor.useRampInFlash(RAMP, sizeof RAMP);
  if (motor.begin() == STEPRAMP_READY) {order};
}}

void loop() {{ motor.run(); }}
"""
TIMER, STOP = "#include <StepRampTimer1.h>", "StepRamp.setEmergencyStop(2);"
SWITCH, MOVE, HOME = "motor.setLimitSwitches(9);", "motor.moveTo(800)", "motor.home(-500, 100)"


@pytest.mark.parametrize(
    ("board", "timer", "inputs", "order"),
    [
        (LEONARDO, TIMER, "", MOVE),
        (LEONARDO, "", STOP, MOVE),
        (LEONARDO, "", SWITCH, MOVE),
        (UNO, TIMER, STOP + SWITCH, HOME),
    ],
    ids=["leonardo-timer", "leonardo-stop", "leonardo-switch", "uno-all"],
)
def test_where_a_computed_ramp_does_not_an_exported_one_fits(
    tmp_path: Path, board: Board, timer: str, inputs: str, order: str
) -> None:
    """Nothing of computing is linked then, so that 1.5 KB are left for a sketch of one's own."""
    source = tmp_path / "exported.ino"
    ramp = ", ".join(map(str, image_in("ExportedRamp")))
    source.write_text(WITHOUT_COMPUTING.format(timer=timer, bytes=ramp, inputs=inputs, order=order))
    sketch = build_sketch(source, board)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= board.flash_bytes - 1500
