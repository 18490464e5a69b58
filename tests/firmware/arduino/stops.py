"""Sketches with an emergency stop, and how soon it is obeyed."""

import random
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from firmware.arduino.timed import BUSY, SPEEDS, run, source_of
from firmware.checker import CYCLES_PER_S, CYCLES_PER_US
from firmware.engine.jobs import Engine
from firmware.rig import RampDesign, image

CYCLES_PER_MS = CYCLES_PER_S // 1000
POLLED_SPEEDS = {1: 2500, 2: 1667, 3: 1250, 4: 1000}
"""[steps/s] of each axis, when so many move and loop() makes the steps of an Uno."""
PINS = ((4, 6, 8, 10), (5, 7, 9, 11))
"""Step pins and direction pins that leave those with an interrupt free."""
STOP_PIN = 2
SPEED_OF_WIDE_PULSES = 1150
PRESSES, FIRST_MS, EVERY_MS, JITTER_MS = 12, 150, 110, 9

_RUN = """
  static uint8_t runs;
  if (StepRamp.stoppedBy() != STEPRAMP_BY_NOTHING) {{
    StepRamp.acknowledge();
  }} else if (!StepRamp.isMoving()) {{
    if (++runs > {presses}) end();
    for (uint8_t axis = 0; axis < {axes}; axis++) StepRamp.run(axis, axis & 1 ? -{interval}L : {interval}L);
  }}
"""
"""Runs, and whatever has stopped it, runs again as soon as that is released."""


@dataclass(frozen=True)
class Stop:
    """Where it is, and what it stops. `timer`: makes the steps, else loop() does."""

    engine: Engine
    axes: int
    pin: int = STOP_PIN
    header: str = ""
    width_us: int = 0
    timer: bool = True
    pressed_ms: float = 4

    @property
    def plan(self) -> RampDesign:
        speed = (SPEEDS if self.timer else POLLED_SPEEDS)[self.axes]
        speed = min(speed, SPEED_OF_WIDE_PULSES) if self.width_us else speed
        return RampDesign(speed, 40 * speed, 40 * speed, **({} if self.timer else {"hz": 2_000_000}))

    @property
    def sketch(self) -> str:
        work = BUSY + _RUN.format(presses=PRESSES, axes=self.axes, interval=self.plan.slew)
        settings = f"StepRamp.setEmergencyStop({self.pin}); StepRamp.setPulseWidth({self.width_us});"
        ramps = image([self.plan] * self.axes)
        text = source_of(self.engine, ramps, "", work, axes=self.axes, settings=settings, pins=PINS)
        timer = f"#include <StepRampTimer{self.engine.timer}.h>"
        return text.replace(timer, timer + self.header if self.timer else self.header)

    def latest_us(self, folder: Path) -> float:
        """Return how long after the edge of the emergency stop the last step comes, of a dozen presses [µs].

        AssertionError when nothing moves before one.
        """
        chance = random.Random(repr(self))
        begins = [FIRST_MS + EVERY_MS * number + chance.random() * JITTER_MS for number in range(PRESSES)]
        presses = ",".join(f"{self.pin}:{begin:.4f}-{begin + self.pressed_ms:.4f}" for begin in begins)
        edges = run(self.engine, self.sketch, folder, "--press", presses, busy=False).edges
        steps = edges["cycle"][np.isin(edges["pin"], PINS[0][: self.axes]) & (edges["value"] == 1)]
        latest = 0.0
        for begin in begins:
            pressed = int(begin * CYCLES_PER_MS)
            assert ((steps > pressed - 10 * CYCLES_PER_MS) & (steps <= pressed)).any(), "nothing moved"
            after = steps[(steps > pressed) & (steps < pressed + (self.pressed_ms + 2) * CYCLES_PER_MS)]
            latest = max(latest, float(after.max() - pressed) / CYCLES_PER_US if after.size else 0.0)
        return latest
