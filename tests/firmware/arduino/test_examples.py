"""The examples on a simulated Uno: when their pins really change."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from firmware.arduino.board import build, build_sketch, missing
from firmware.arduino.pins import MOST_EARLY_US, Edges, Move, after_s, edges_until, moves_of, times_us
from firmware.arduino.sketches import RAMPS, image_in
from simulator.avr import CLOCK_HZ, SimulatedController
from tools import require

Make = Callable[..., SimulatedController]

TICK_US = 0.5
MOST_LATE_US = 500
"""What one round of loop() may take in these examples, where nobody asks for reports."""
BEGUN_US = 260_000
"""By then a ramp of 375 steps has been computed, and the first of them made."""
SLOWER = 1.04
"""So much longer a whole move may take."""
STEP, DIRECTION, ENABLE = 2, 5, 8
STATES = [0x9, 0x1, 0x7, 0x6, 0xE, 0x8]
"""Coils of a gauge rotor's six states, the first pin in bit 0."""


def check_move(move: Move, planned_ticks: list[int]) -> None:
    """Its steps are as many as planned, and its intervals as long, within what polling makes of them."""
    planned = np.array(planned_ticks[:-1]) * TICK_US
    assert len(move.times_us) == len(planned_ticks)
    late = move.intervals_us - planned
    assert late.min() >= -MOST_EARLY_US
    assert late.max() <= MOST_LATE_US
    assert move.intervals_us.sum() <= planned.sum() * SLOWER + MOST_LATE_US


def pulse_widths(edges: Edges) -> npt.NDArray[np.float64]:
    rises, falls = times_us(edges, STEP, 1), times_us(edges, STEP, 0)
    falls = falls[falls > rises[0]]
    return falls[: len(rises)] - rises[: len(falls)]


def test_the_stage_goes_to_its_places(simulated_uno: Make) -> None:
    edges = edges_until(simulated_uno("LeadScrewStage"), after_s(6.5))
    moves = moves_of(edges, STEP, DIRECTION, rest_us=500_000)
    assert [(move.backward, len(move.times_us)) for move in moves[:3]] == [(False, 1000), (True, 750), (False, 375)]
    for move in moves[:3]:
        check_move(move, RAMPS["LeadScrewStage"].ramp.intervals(len(move.times_us)))
    # Driven high, off, from begin() on; enabled for good by the first move.
    enabled, rises = times_us(edges, ENABLE, 0), times_us(edges, STEP, 1)
    assert len(enabled) == 1
    assert 1000 <= rises[0] - enabled[0] < 10_000
    turns = edges["cycle"][edges["pin"] == DIRECTION] * 1e6 / CLOCK_HZ
    for turn in turns[turns < rises[-1]]:
        assert rises[rises > turn][0] - turn >= 30


def exact_ticks(steps: int, speed: float, acceleration: float, deceleration: float) -> list[int]:
    """Return the intervals of a long move from rest to rest at constant acceleration, from the times of its steps."""
    up, down = (
        np.diff(np.sqrt(2 * np.arange(speed**2 / (2 * rate) + 1) / rate)) / (TICK_US * 1e-6)
        for rate in (acceleration, deceleration)
    )
    level = np.full(steps - up.size - down.size, 1e6 / TICK_US / speed)
    return [round(ticks) for ticks in np.concatenate([up, level, down[::-1]])]


def test_a_ramp_that_the_board_computes_is_played_to_and_fro(simulated_uno: Make) -> None:
    edges = edges_until(simulated_uno("OneMotor"), after_s(3.4))
    moves = moves_of(edges, STEP, DIRECTION, rest_us=100_000)
    assert [(move.backward, len(move.times_us)) for move in moves[:2]] == [(False, 800), (True, 800)]
    assert moves[0].times_us[0] < BEGUN_US
    for move in moves[:2]:
        check_move(move, exact_ticks(800, 1000, 2000, 4000))


def test_a_button_stops_the_motor_in_flight(simulated_uno: Make) -> None:
    edges = edges_until(simulated_uno("OneMotor", press=(14, 960, 2410)), after_s(4.2))
    first, second = moves_of(edges, STEP, DIRECTION, rest_us=300_000)[:2]
    # begin() takes a quarter of a second. From slew speed 125 steps lead to rest, once what is queued has been played.
    assert 500 < len(first.times_us) < 800
    assert first.times_us[-1] - first.times_us[0] < 1_500_000
    assert second.backward is False
    assert len(first.times_us) + len(second.times_us) == 800
    assert second.times_us[0] - first.times_us[-1] > 500_000


def test_an_exported_ramp_is_played_to_and_fro(simulated_uno: Make) -> None:
    edges = edges_until(simulated_uno("ExportedRamp"), after_s(3.6))
    moves = moves_of(edges, STEP, DIRECTION, rest_us=500_000)
    assert [(move.backward, len(move.times_us)) for move in moves[:2]] == [(False, 800), (True, 800)]
    for move in moves[:2]:
        check_move(move, RAMPS["ExportedRamp"].ramp.intervals(800))
    assert pulse_widths(edges).min() >= 5


FLASH_SKETCH = """#include <StepRampAxis.h>
const uint8_t RAMP[] PROGMEM = {{{bytes}}};
StepRampAxis motor(2, 5);
void setup() {{
  motor.useRampInFlash(RAMP, sizeof RAMP);
  if (motor.begin() == STEPRAMP_READY) motor.moveTo(-800);
}}
void loop() {{ motor.run(); }}
"""


def test_a_ramp_in_flash_is_played(tmp_path: Path) -> None:
    require(*missing())
    source = tmp_path / "RampInFlash.ino"
    source.write_text(FLASH_SKETCH.format(bytes=",".join(map(str, image_in("ExportedRamp")))))
    sketch = build_sketch(source)
    assert sketch.warnings == ""
    edges = edges_until(SimulatedController(sketch.elf, tmp_path, real_time=False), made_steps(800))
    (move,) = moves_of(edges, STEP, DIRECTION, rest_us=500_000)
    assert move.backward
    check_move(move, RAMPS["ExportedRamp"].ramp.intervals(800))


def made_steps(steps: int) -> Callable[[Edges], bool]:
    """Tell when so many have been made on axis 0."""
    return lambda edges: len(times_us(edges, STEP, 1)) >= steps


@pytest.mark.parametrize("press", [None, (14, 700, 1500)])
def test_two_motors_draw_their_lines(simulated_uno: Make, press: tuple[int, int, int] | None) -> None:
    """From (0, 0) to (600, 150), (200, 400) and back: the motor with less to do is never off by more than a step."""
    edges = edges_until(simulated_uno("LineOfTwoMotors", press=press), after_s(4.4 if press is None else 5.6))
    x, y = moves_of(edges, STEP, DIRECTION, rest_us=1e9), moves_of(edges, STEP + 1, DIRECTION + 1, rest_us=1e9)
    # At rest the direction pins are forward, so that each line backward is a move of its own.
    assert [(move.backward, len(move.times_us)) for move in x[:3]] == [(False, 600), (True, 400), (True, 200)]
    assert [(move.backward, len(move.times_us)) for move in y[:2]] == [(False, 400), (True, 400)]
    forward, back = x[0].times_us, np.concatenate([x[1].times_us, x[2].times_us])
    off = 1 if press is None else 2  # a line that goes on after a stop is another one
    steps = np.arange(1, 601)
    assert np.abs(np.searchsorted(y[0].times_us, forward) - steps / 4).max() <= off
    assert np.abs(np.searchsorted(y[0].times_us, back[:400]) - (150 + steps[:400] * 250 / 400)).max() <= 1
    assert np.abs(np.searchsorted(back, y[1].times_us) - (400 + steps[:400] / 2)).max() <= 1
    rest_us = np.diff(forward).max()
    assert rest_us > 300_000 if press is not None else rest_us < 40_000


def gauge_states(edges: Edges, gauge: int) -> tuple[npt.NDArray[np.float64], list[int]]:
    """Return when a gauge's coils came to a new state [us], and the states. Its pins change one after the other."""
    first = 2 + 4 * gauge
    own = edges[(edges["pin"] >= first) & (edges["pin"] < first + 4)]
    times = own["cycle"] * 1e6 / CLOCK_HZ
    coils, states, whens = 0, [], []
    for i, edge in enumerate(own):
        bit = 1 << (edge["pin"] - first)
        coils = coils | bit if edge["value"] else coils & ~bit
        if i + 1 == len(own) or times[i + 1] - times[i] > 300:
            whens.append(times[i])
            states.append(STATES.index(coils))
    return np.array(whens), states


@pytest.fixture(scope="module")
def gauge_edges(tmp_path_factory: pytest.TempPathFactory) -> Edges:
    require(*missing())
    simulated = SimulatedController(build("ThreeGauges").elf, tmp_path_factory.mktemp("gauges"), real_time=False)
    return edges_until(simulated, after_s(7))


@pytest.mark.parametrize("gauge", range(3))
def test_gauges_are_zeroed_and_follow_their_values(gauge_edges: Edges, gauge: int) -> None:
    times, states = gauge_states(gauge_edges, gauge)
    # A step is one state on or back: nothing is left out.
    changes = (np.diff(states) + 1) % 6 - 1
    assert set(changes) <= {-1, 1}
    assert (changes[:945] == -1).all()
    positions = 945 + np.cumsum(changes)
    assert positions[944] == 0
    assert positions.min() == 0
    assert positions.max() > 300
    intervals = np.diff(times)
    assert intervals.min() >= RAMPS["ThreeGauges"].ramp.slew * TICK_US - MOST_EARLY_US
    # The first move is the ramp's, from rest to rest.
    check_move(Move(True, times[1:946]), RAMPS["ThreeGauges"].ramp.intervals(945))


def test_gauges_go_on_from_the_speed_they_have(gauge_edges: Edges) -> None:
    """Four targets a second, a quarter of a second's way ahead: no needle stops in between."""
    times, _ = gauge_states(gauge_edges, 0)
    intervals = np.diff(times[960:])
    first_interval_us = RAMPS["ThreeGauges"].ramp.up[0][0] * TICK_US
    assert intervals[30:300].max() < first_interval_us / 2
