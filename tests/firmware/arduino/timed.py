"""Sketches whose steps are made by a timer, for simulated boards, and what their pins do."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from firmware.arduino.board import LEONARDO, MEGA, UNO, Sketch, build_sketch
from firmware.checker import DIRECTION_PINS, STEP_PINS, Edges
from firmware.engine.jobs import Engine, run_on_chip

ENGINES = (Engine(UNO), Engine(MEGA), Engine(MEGA, 5), Engine(LEONARDO, 1), Engine(LEONARDO, 3))
SPEEDS = {1: 100_000, 2: 50_000, 3: 33_333, 4: 25_000}
"""[steps/s] of each axis, when so many move."""
MARK = 14
MARK_MS = 5

_TEXT = """
#include <StepRamp.h>
#include <StepRampTimer{timer}.h>
#include <avr/sleep.h>

#ifdef __AVR_ATmega32U4__
#define PORT Serial1
#else
#define PORT Serial
#endif

const uint8_t RAMP[] = {{{image}}};
const uint8_t STEP_PINS[] = {{{step_pins}}}, DIRECTION_PINS[] = {{{direction_pins}}};
{declarations}

void end() {{
  PORT.flush();
  cli();
  sleep_enable();
  for (;;) sleep_cpu();
}}

void setup() {{
  PORT.begin(115200);
  pinMode({mark}, OUTPUT);
  for (uint8_t axis = 0; axis < sizeof STEP_PINS; axis++) {{
    StepRamp.setStepper(axis, STEP_PINS[axis], DIRECTION_PINS[axis]);
  }}
  {settings}
  if (!StepRamp.begin(RAMP, sizeof RAMP)) {{ PORT.print("bad ramp"); end(); }}
  {begin}
}}

void loop() {{
  StepRamp.poll();
  {work}
}}
"""

BUSY = """
  static uint8_t next;
  static unsigned long marked;
  static volatile float value;
  for (uint8_t i = 0; i < 16 && PORT.availableForWrite() > 0; i++) PORT.write(next++);
  for (uint8_t i = 0; i < 16 && PORT.available() > 0; i++) PORT.read();
  value = value * 0.99f + 1;
  if (millis() - marked >= 5) { marked += 5; digitalWrite(14, !digitalRead(14)); }
"""
"""The serial port has bytes to send and to receive all the time; a float is computed; millis() moves a pin."""

UNTIL_REST = "if (!StepRamp.isMoving()) end();"


@dataclass(frozen=True)
class Played:
    sketch: Sketch
    edges: Edges
    statistics: dict[str, Any]
    sent: bytes


def list_of(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))


def source_of(
    engine: Engine,
    image: bytes,
    begin: str,
    work: str,
    *,
    axes: int = 4,
    settings: str = "",
    declarations: str = "",
    pins: tuple[Sequence[int], Sequence[int]] = (STEP_PINS, DIRECTION_PINS),
) -> str:
    return _TEXT.format(
        timer=engine.timer,
        image=list_of(list(image)),
        step_pins=list_of(pins[0][:axes]),
        direction_pins=list_of(pins[1][:axes]),
        declarations=declarations,
        settings=settings,
        begin=begin,
        work=work,
        mark=MARK,
    )


def run(engine: Engine, source: str, folder: Path, *more: str, busy: bool = True) -> Played:
    """Build a sketch and run it to its end; `more`: options of the simulator."""
    assert engine.board is not None
    file = folder / f"sketch-{abs(hash((engine, source)))}.ino"
    file.write_text(source)
    sketch = build_sketch(file, engine.board)
    assert sketch.warnings == "", sketch.warnings
    options = [*engine.chip.options, *more, *(["--busy"] if busy else [])]
    statistics, edges, sent = run_on_chip(sketch.elf, folder, *options)
    return Played(sketch, edges, statistics, sent)


def move_all(steps: Sequence[int]) -> str:
    return f"const int32_t steps[] = {{{list_of(steps)}}};\n  if (StepRamp.moveAllTo(steps) != STEPRAMP_OK) end();"
