"""What the pins do: pulses of any kind, gauges, the enable pin, and the clock of milliseconds."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from firmware.engine.jobs import (
    DIRECTION_PINS,
    GAUGES,
    STEP_PINS,
    Engine,
    Job,
    Segment,
    chip_sources,
    play_on_chip,
    pulse_widths,
    run_on_chip,
)
from simulator.avr import build_program

CYCLES_PER_US = 16
ENABLE_PIN, CLOCK_PIN = 8, 14
BETWEEN_EVENTS = 200
"""Cycles: coils that change together do so within less."""
RAMP = [Segment(2500, 40, -20), Segment(1700, 2, is_step=False), Segment(1700, 40, 20, turns=True)]
FOUR_AXES = [RAMP] * 4
COIL_STATES = [(1, 0, 0, 1), (1, 0, 0, 0), (1, 1, 1, 0), (0, 1, 1, 0), (0, 1, 1, 1), (0, 0, 0, 1)]
"""Of a Switec X25's four pins, along one turn of its magnet."""


@pytest.mark.parametrize("inverted", [0b0000, 0b1010, 0b1111])
@pytest.mark.parametrize("width_us", [0, 3, 10, 60])
def test_pulses(tmp_path: Path, engine: Engine, inverted: int, width_us: int) -> None:
    job = Job(
        FOUR_AXES if width_us < 60 else [RAMP],
        step_inverted=inverted,
        direction_inverted=inverted,
        pulse_width_us=width_us,
    )
    chip = play_on_chip(job, tmp_path, engine)
    for axis in range(len(job.axes)):
        widths = pulse_widths(chip.edges, STEP_PINS[axis], inverted >> axis & 1)
        assert len(chip.steps[axis]) == len(widths) == 80
        assert widths.min() >= max(width_us, 2.5) * CYCLES_PER_US
        assert np.median(widths) <= (max(width_us, 4) + 1) * CYCLES_PER_US
        turn = chip.edges[chip.edges["pin"] == DIRECTION_PINS[axis]]
        assert turn["value"].tolist() == [inverted >> axis & 1]
        # From the direction to the pulse there is the silent interval.
        assert chip.steps[axis][40] - turn["cycle"][0] > 1000


def test_each_edge_a_step(tmp_path: Path, engine: Engine) -> None:
    chip = play_on_chip(Job(FOUR_AXES, both_edges=0b0101), tmp_path, engine)
    for axis in range(4):
        assert len(chip.steps[axis]) == 80
        assert (chip.edges["pin"] == STEP_PINS[axis]).sum() == (80 if axis in (0, 2) else 160)


def coil_states(edges: np.ndarray, gauge: int) -> list[int]:  # type: ignore[type-arg]
    """Return the states that a gauge's coils go through. What lies between two edges of one event is none."""
    levels, states = list(COIL_STATES[0]), [0]
    own = edges[(edges["pin"] >= 2 + 4 * gauge) & (edges["pin"] < 6 + 4 * gauge)]
    for i, edge in enumerate(own):
        levels[edge["pin"] - 2 - 4 * gauge] = edge["value"]
        if i + 1 == len(own) or own["cycle"][i + 1] - edge["cycle"] > BETWEEN_EVENTS:
            states.append(COIL_STATES.index(tuple(levels)))
    return states


def test_gauges(tmp_path: Path, engine: Engine) -> None:
    """Three at once, each through the six states in both directions, and never by more than one state."""
    forth_and_back = [Segment(2000, 20, -10), Segment(2000, 3, is_step=False), Segment(1800, 13, 10, turns=True)]
    job = Job([forth_and_back, forth_and_back[:1], [*forth_and_back, *forth_and_back]], fast=False, mode=GAUGES)
    chip = play_on_chip(job, tmp_path, engine)
    for gauge, end in enumerate((7, 20, 20 - 13 + -20 + 13)):
        states = coil_states(chip.edges, gauge)
        moves = [(after - before + 3) % 6 - 3 for before, after in pairwise(states)]
        assert set(moves) <= {-1, 1}
        assert sum(moves) == chip.positions[gauge] == end
    assert chip.empty == (1, 1, 1, 0)


def test_halted_gauges(tmp_path: Path, engine: Engine) -> None:
    job = Job([[Segment(2000, 50)] * 4] * 3, fast=False, mode=GAUGES, halted=0b011, halt_loads=2)
    chip = play_on_chip(job, tmp_path, engine)
    for gauge in range(3):
        assert len(coil_states(chip.edges, gauge)) - 1 == chip.positions[gauge]
    assert 0 < chip.positions[0] < 200
    assert chip.positions[2] == 200


@pytest.fixture(params=[False, True], ids=["without a boot loader", "behind optiboot"])
def loader(request: pytest.FixtureRequest) -> list[str | Path]:
    """Return the simulator's options for a boot loader, which keeps to itself why it began."""
    return ["--boot-loader", request.getfixturevalue("optiboot")] if request.param else []


def test_the_watchdog_lets_no_motor_coast(tmp_path: Path, loader: list[str | Path]) -> None:
    """The enable pin is let go of for a few microseconds; the program knows why it began; its clock is right."""
    source = Path(__file__).with_name("hang.c")
    program = build_program("hang", [source, *chip_sources()])
    statistics, edges, sent = run_on_chip(program, tmp_path, *loader)
    assert statistics["resets"] == 1
    assert list(sent) == [0 if loader else 1, 8], "reset by power, as far as that is told, then by the watchdog"
    enable = edges[edges["pin"] == ENABLE_PIN]
    assert enable["value"].tolist() == [1, 0, 1]
    assert enable["cycle"][2] - enable["cycle"][1] < 10 * CYCLES_PER_US
    clock = edges["cycle"][edges["pin"] == CLOCK_PIN]
    assert np.diff(clock) == pytest.approx(100_000 * CYCLES_PER_US, abs=1100 * CYCLES_PER_US)


def test_a_stack_that_comes_to_the_variables_ends_in_a_reset(tmp_path: Path, loader: list[str | Path]) -> None:
    source = Path(__file__).with_name("overflow.c")
    program = build_program("overflow", [source, *chip_sources()])
    statistics, _, sent = run_on_chip(program, tmp_path, *loader)
    assert statistics["resets"] == 1
    assert list(sent) == [0 if loader else 1, 8], "reset by power, as far as that is told, then by the watchdog"
