"""begin() of StepRampAxis where a timer makes the steps: what it leaves, and whether its ramps run dry."""

from pathlib import Path

import numpy as np
import pytest

from firmware.arduino.board import MEGA, UNO, Board
from firmware.arduino.timed import Played, list_of, run
from firmware.checker import CYCLES_PER_US
from firmware.engine.jobs import Engine
from firmware.protocol import Ramp

pytestmark = pytest.mark.usefixtures("arduino_tools")

PINS = ((2, 5), (3, 6), (4, 7), (12, 13))
FAST = Ramp([(80_000, 6, -8000), (36_000, 50, -400)], 16_000, [(80_000, 6, -8000), (36_000, 40, -480)])
_TEXT = """
#include <StepRampAxis.h>
#include <StepRampTimer{timer}.h>
#include <avr/sleep.h>

{declarations}

void end() {{
  Serial.flush();
  cli();
  sleep_enable();
  for (;;) sleep_cpu();
}}

void tell(long number) {{
  Serial.print(number);
  Serial.print(' ');
}}

void setup() {{
  Serial.begin(115200);
  {work}
  end();
}}

void loop() {{
}}
"""


def played(folder: Path, engine: Engine, declarations: str, work: str) -> tuple[list[int], Played]:
    """Return the numbers that a sketch has told, and what it did."""
    source = _TEXT.format(timer=engine.timer, declarations=declarations, work=work)
    done = run(engine, source, folder, busy=False)
    return [int(number) for number in done.sent.split()], done


def steps_of(done: Played, axis: int) -> np.ndarray:
    """Return when an axis' step pin rose [cycles]."""
    edges = done.edges
    return edges["cycle"][(edges["pin"] == PINS[axis][0]) & (edges["value"] == 1)].astype(np.int64)


REFUSED = """
  x.setRamp(5000, 50000);
  tell(x.begin());
  y.setRamp(0.005, 1);
  tell(y.begin());
  tell(x.runAt(500));
  while (x.position() < 20) x.run();
  x.halt();
  StepRamp.setEnablePin(60);
  tell(x.begin());
  StepRamp.setEnablePin(8);
  x.useRamp(RAMP, sizeof RAMP);
  y.setRamp(1000, 5000);
  tell(x.begin());
  y.setRamp(0.5, 10);
  tell(y.begin());
  tell(x.move(4000));
  tell(x.begin());
"""
READY, BAD_PINS, BAD_SPEED, NO_RAMP, BAD_IMAGE = 0, 2, 4, 5, 8


def test_what_is_refused_changes_no_clock(tmp_path: Path) -> None:
    """Nor does an axis stay ready whose exported ramp is for another clock than the one that all have now."""
    declarations = (
        f"const uint8_t RAMP[] = {{{list_of(list(FAST.image(1, fast=True)))}}};\nStepRampAxis x(2, 5), y(3, 6);"
    )
    told, done = played(tmp_path, Engine(UNO), declarations, REFUSED)
    assert told == [READY, BAD_SPEED, READY, BAD_PINS, READY, READY, NO_RAMP, BAD_IMAGE]
    assert np.diff(steps_of(done, 0)).min() > 1990 * CYCLES_PER_US


MOVE = """
  for (StepRampAxis &each : all) each.setRamp({speed}, {acceleration});
  for (StepRampAxis &each : all) tell(each.begin());
  tell(millis());
  for (StepRampAxis &each : all) each.moveTo({steps});
  while (StepRamp.isMoving()) {{
    StepRamp.poll();
    delayMicroseconds({wait_us});
  }}
  tell(StepRamp.ranDry());
"""


@pytest.mark.parametrize(
    ("board", "axes", "speed", "acceleration", "wait_us", "most_ms"),
    [
        (UNO, 1, 100_000, 500_000, 2000, 6000),
        (UNO, 1, 10_000, 50_000, 2000, 800),
        (MEGA, 2, 50_000, 1_000_000, 0, 4500),
        (MEGA, 4, 20_000, 100_000, 0, 9500),
    ],
)
def test_a_ramp_that_is_ready_does_not_run_dry(
    tmp_path: Path, board: Board, axes: int, speed: int, acceleration: int, wait_us: int, most_ms: int
) -> None:
    """All axes set out at once; each ramp is computed once, however often begin() is called."""
    steps = int(1.2 * speed**2 / acceleration)
    work = MOVE.format(speed=speed, acceleration=acceleration, steps=steps, wait_us=wait_us)
    pins = ", ".join(f"{{{step}, {direction}}}" for step, direction in PINS[:axes])
    told, done = played(tmp_path, Engine(board), f"StepRampAxis all[] = {{{pins}}};", work)
    *problems, ms, dry = told
    assert (problems, dry) == ([READY] * axes, 0)
    assert ms <= most_ms
    for axis in range(axes):
        intervals = np.diff(steps_of(done, axis))
        middle = intervals[len(intervals) // 3 : len(intervals) * 2 // 3]
        assert len(intervals) == steps - 1
        assert middle.max() < 2 * 16_000_000 / speed + 60 * CYCLES_PER_US


ROUNDS = """
  for (const float *each : RAMPS) {
    x.setRamp(each[0], each[1], each[2], each[3]);
    unsigned long from = millis();
    tell(x.begin());
    tell(millis() - from);
    x.move(each[0] * each[0] / each[1] + 500);
    while (x.isMoving()) {
      StepRamp.poll();
      delayMicroseconds(2000);
    }
    tell(StepRamp.ranDry());
  }
"""
SHORT_RAMPS = [
    (30_000, 750_000, 0, 0),
    (40_000, 400_000, 0, 0),
    (50_000, 385_000, 0, 0),
    (50_000, 500_000, 0, 0),
    (60_000, 500_000, 0, 5000),
    (60_000, 1_500_000, 0, 0),
    (100_000, 1_430_000, 0, 0),
]
"""Speed, acceleration, deceleration and base speed: they take 0.04 to 0.13 s."""
TOO_LONG = (100_000, 2000, 4000, 0)
"""2.5 million steps: no board of 2 KB has room for that."""
BAD_ACCELERATION = 6


def test_loop_may_take_2_ms_besides_poll_and_what_has_no_room_is_refused_at_once(tmp_path: Path) -> None:
    ramps = ", ".join(f"{{{list_of(ramp)}}}" for ramp in (*SHORT_RAMPS, TOO_LONG))
    told, _ = played(tmp_path, Engine(UNO), f"const float RAMPS[][4] = {{{ramps}}};\nStepRampAxis x(2, 5);", ROUNDS)
    problems, begun_ms, dry = told[::3], told[1::3], told[2::3]
    assert problems == [READY] * len(SHORT_RAMPS) + [BAD_ACCELERATION]
    assert dry == [0] * len(problems)
    assert max(begun_ms) < 1500
    assert begun_ms[-1] <= 10
