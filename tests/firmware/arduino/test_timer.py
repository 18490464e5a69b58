"""Sketches whose steps are made by a timer: each edge of the pins against the ramp, while loop() does other things and
Arduino's own interrupts come in between."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from firmware.arduino.board import LEONARDO, MEGA, UNO
from firmware.arduino.timed import BUSY, ENGINES, MARK, MARK_MS, SPEEDS, UNTIL_REST, Played, move_all, run, source_of
from firmware.checker import CYCLES_PER_S, CYCLES_PER_US, assert_good, axis_of, faults, lateness_us
from firmware.engine.jobs import Engine
from firmware.rig import RampDesign, image

pytestmark = pytest.mark.usefixtures("arduino_tools")

LATE_US = {1: 12, 2: 30, 3: 50, 4: 50}
BEHIND_OTHERS_US = 15
"""Timer1's interrupts go before Timer0's and the serial port's, those of Timer3, 4 and 5 behind: then steps are later.
Most of the rest is where several axes load a segment at the same instant."""
LONGEST_POLL_US = 5000
LONGEST_ROUND_MS = 15
"""Of loop(), while four axes at their highest speed leave it a fifth of the processor."""


COMPUTED = """
#include <StepRampAxis.h>
#include <StepRampTimer5.h>
#include <avr/sleep.h>

StepRampAxis a(4, 9), b(6, 10), c(8, 11), d(14, 15), *const AXES_OF[] = {&a, &b, &c, &d};

void setup() {
  Serial.begin(115200);
  for (StepRampAxis *axis : AXES_OF) axis->setRamp(25000, 62500, 187500);
  a.begin();
  for (StepRampAxis *axis : AXES_OF) axis->moveTo(15500);
  unsigned long longest = 0, from, took;
  do {
    from = micros();
    StepRamp.poll();
    took = micros() - from;
    if (took > longest) longest = took;
    from = micros();
    while (micros() - from < 2000) {}
  } while (StepRamp.isMoving());
  Serial.print(longest);
  Serial.print(' ');
  Serial.print(StepRamp.ranDry());
  Serial.print(' ');
  Serial.print(d.position());
  Serial.flush();
  cli();
  sleep_enable();
  sleep_cpu();
}

void loop() {}
"""
"""Four axes at their highest speed, on ramps that are as long as 4 KB of RAM have room for."""


@pytest.fixture(params=ENGINES, ids=lambda engine: engine.name)
def engine(request: pytest.FixtureRequest) -> Engine:
    """Return each timer of each chip that is tried."""
    chosen: Engine = request.param
    return chosen


def check_axes(played: Played, plan: RampDesign, steps: list[int], late_us: float) -> float:
    """Each axis keeps to its plan and to its design; return how late the latest step is [us]."""
    latest = 0.0
    for axis, count in enumerate(steps):
        made = axis_of(played.edges, axis).steps
        latest = max(latest, float(lateness_us(made, plan.ramp.intervals(abs(count)), plan.cycles_per_tick).max()))
        assert latest <= late_us
        assert_good(played.edges, plan.limits(count, late_us=late_us), axis)
    return latest


def check_millis(played: Played) -> None:
    """millis() goes as the crystal does: what loop() marks late is late by its own rounds, and no more and more so."""
    marks = played.edges["cycle"][played.edges["pin"] == MARK] / (1000 * CYCLES_PER_US)
    assert marks.size > 20
    late = marks - marks[0] - MARK_MS * np.arange(marks.size)
    first, second = np.array_split(late, 2)
    assert abs(first.min() - second.min()) <= 2
    assert late.max() <= LONGEST_ROUND_MS


@pytest.mark.parametrize("count", SPEEDS)
def test_axes_at_their_highest_speed(
    tmp_path: Path, engine: Engine, record_property: Callable[..., None], count: int
) -> None:
    """With the serial port busy, up to three axes both ways: no step is lost, and none later than stated."""
    plan = RampDesign(SPEEDS[count], 30 * SPEEDS[count], 40 * SPEEDS[count])
    steps = [(-1) ** axis * (SPEEDS[count] // 5 + 200 * axis) for axis in range(count)]
    source = source_of(engine, image([plan] * count), move_all(steps), BUSY + UNTIL_REST, axes=count)
    played = run(engine, source, tmp_path, busy=count < len(SPEEDS))
    late_us = LATE_US[count] + (0 if engine.timer == 1 else BEHIND_OTHERS_US)
    record_property("late_us", check_axes(played, plan, steps, late_us))
    check_millis(played)
    assert played.statistics["lost_bytes"] == 0
    # The line carries 11,520 bytes/s.
    assert played.statistics["sent_bytes"] > 5000 * played.statistics["cycles"] / CYCLES_PER_S


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize("both_edges", [False, True])
@pytest.mark.parametrize("width_us", [0, 20])
def test_pins_are_as_the_settings_want_them(tmp_path: Path, inverted: bool, both_edges: bool, width_us: int) -> None:
    """Pulses, pauses, levels and the time from the direction to the pulse; on pins of three ports."""
    engine, axes, steps = Engine(MEGA, 3), 2, [1500, -1700]
    plan = RampDesign(5000, 40_000, 60_000)
    calls = {"StepInverted": inverted, "DirectionInverted": inverted, "BothEdges": both_edges}
    settings = "".join(f"StepRamp.set{name}({axis}); " for name, on in calls.items() if on for axis in range(axes))
    settings += f"StepRamp.setPulseWidth({width_us}); StepRamp.setDirectionSetup(200);"
    there = move_all(steps)
    source = source_of(engine, image([plan] * axes), there, BUSY + UNTIL_REST, axes=axes, settings=settings)
    played = run(engine, source, tmp_path)
    late_us = 30 + 2 * width_us
    for axis, count in enumerate(steps):
        limits = plan.limits(
            count,
            late_us=late_us,
            setup_us=200.0,
            pulse_us=max(width_us, 1),
            step_inverted=inverted,
            direction_inverted=inverted,
            both_edges=both_edges,
        )
        assert_good(played.edges, limits, axis)


IN_FLIGHT = """
  static uint8_t stage;
  static unsigned long since = millis();
  unsigned long passed = millis() - since;
  if (stage == 0 && passed >= 40) { StepRamp.moveTo(0, -1500); stage++; }
  else if (stage == 1 && passed >= 200) { StepRamp.stop(); stage++; }
  else if (stage == 2 && !StepRamp.isMoving()) { StepRamp.moveTo(0, 9000); since = millis(); stage++; }
  else if (stage == 3 && passed >= 60) {
    StepRamp.halt();
    digitalWrite(14, HIGH);
    PORT.println(StepRamp.position(0));
    since = millis();
    stage++;
  }
  else if (stage == 4 && passed >= 20) end();
"""
"""Back in flight, a stop in flight, another move, and a halt, marked by pin 14 as soon as it returns."""


def test_moves_change_in_flight_and_a_halt_ends_all(tmp_path: Path, engine: Engine) -> None:
    plan = RampDesign(60_000, 900_000, 900_000)
    source = source_of(engine, image([plan]), "StepRamp.moveTo(0, 5000);", IN_FLIGHT, axes=1)
    played = run(engine, source, tmp_path, busy=False)
    made, edges = axis_of(played.edges), played.edges
    [marked] = edges["cycle"][edges["pin"] == MARK]
    assert (made.steps < marked).all()
    assert int(played.sent.split()[-1]) == made.travel
    assert -1000 < made.travel < 8000
    turns = [int(turn) for turn in made.turns if made.steps[0] < turn < made.steps[-1]]
    assert len(turns) == 2
    parts = np.split(made.steps, np.searchsorted(made.steps, turns))
    for turn, part in zip(turns, parts[1:], strict=True):
        assert part[0] - turn >= 30 * CYCLES_PER_US
    for number, part in enumerate(parts):
        own = edges[(edges["cycle"] >= part[0]) & (edges["cycle"] <= part[-1] + 100)]
        limits = plan.limits(part.size, late_us=12 + BEHIND_OTHERS_US, is_one_way=False)
        found = [fault for fault in faults(own, limits) if "direction" not in fault]
        # The halt takes the last part at its speed.
        assert [fault for fault in found if number < 2 or "last interval" not in fault] == []


LINE_PLAN = RampDesign(50_000, 1_500_000, 1_500_000)
LINES = [(6000, -2500), (6000, 5999, -1), (3000, -6000, 5000, 1777)]


@pytest.mark.parametrize("steps", LINES, ids=len)
def test_lines_are_straight_and_each_step_is_in_time(
    tmp_path: Path, engine: Engine, steps: tuple[int, ...], record_property: Callable[..., None]
) -> None:
    """As fast as the same number of single axes, and faster: the leader keeps to its ramp, the others to the line."""
    plan, late_us = LINE_PLAN, 20 + BEHIND_OTHERS_US
    line = f"const int32_t by[] = {{{', '.join(map(str, steps))}}};\n  if (StepRamp.lineBy(by) != STEPRAMP_OK) end();"
    source = source_of(engine, image([plan] * len(steps)), line, BUSY + UNTIL_REST, axes=len(steps))
    played = run(engine, source, tmp_path, busy=False)
    check_millis(played)
    made = [axis_of(played.edges, axis) for axis in range(len(steps))]
    assert [one.travel for one in made] == list(steps)
    leader = int(np.abs(steps).argmax())
    latest = float(lateness_us(made[leader].steps, plan.ramp.intervals(abs(steps[leader])), plan.cycles_per_tick).max())
    record_property("late_us", latest)
    assert latest <= late_us
    assert_good(played.edges, plan.limits(steps[leader], late_us=late_us), leader)
    for one in made:
        # With each step of the leader, within half a step of the line.
        done = np.searchsorted(one.steps, made[leader].steps + 40, side="right")
        exact = np.arange(1, abs(steps[leader]) + 1) * one.steps.size / abs(steps[leader])
        assert np.abs(done - exact).max() <= 0.5 + 1e-9


@pytest.mark.parametrize(("most_steps_per_s", "loop_us"), [(100_000, 2000), (10_000, 4000)])
@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("engine", [Engine(UNO), Engine(MEGA, 3), Engine(LEONARDO, 3)], ids=lambda engine: engine.name)
def test_loop_may_take_milliseconds(
    tmp_path: Path, engine: Engine, count: int, most_steps_per_s: int, loop_us: int
) -> None:
    """Where it takes 0.2 s to that speed: with shorter ramps the queue of an Uno holds less time."""
    speed = min(SPEEDS[count], most_steps_per_s)
    plan = RampDesign(speed, 5 * speed, 5 * speed)
    steps = [(-1) ** axis * (speed // 2 + 200 * axis) for axis in range(count)]
    work = f"unsigned long from = micros(); while (micros() - from < {loop_us}) {{}}"
    source = source_of(engine, image([plan] * count), move_all(steps), work + UNTIL_REST, axes=count)
    check_axes(run(engine, source, tmp_path, busy=False), plan, steps, LATE_US[count] + BEHIND_OTHERS_US)


def test_poll_takes_no_longer_than_is_stated(tmp_path: Path, record_property: Callable[..., None]) -> None:
    longest_us, dry, position = map(int, run(Engine(MEGA, 5), COMPUTED, tmp_path, busy=False).sent.split())
    record_property("longest_us", longest_us)
    assert (dry, position) == (0, 15_500)
    assert 0.8 * LONGEST_POLL_US < longest_us <= LONGEST_POLL_US


def test_a_loop_that_comes_much_too_late_loses_no_step_and_is_told_of(tmp_path: Path) -> None:
    plan = RampDesign(40_000, 400_000, 400_000)
    work = "delay(30); if (!StepRamp.isMoving()) { PORT.print(StepRamp.ranDry()); PORT.print(' '); "
    work += "PORT.print(StepRamp.position(0)); end(); }"
    played = run(
        Engine(UNO),
        source_of(Engine(UNO), image([plan]), "StepRamp.moveTo(0, 5000);", work, axes=1),
        tmp_path,
        busy=False,
    )
    dry, position = played.sent.split()
    assert int(dry) > 0
    assert int(position) == axis_of(played.edges).travel == 5000
