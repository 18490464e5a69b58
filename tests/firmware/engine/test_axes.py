"""Axes on their own: the assembly on the simulated chip against its twin in C, and both against plain arithmetic."""

import random
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from firmware.engine.jobs import (
    DIRECTION_PINS,
    HALT_PIN,
    LONGEST_WAIT,
    STEP_PINS,
    Engine,
    Job,
    Played,
    Segment,
    expected_steps,
    play_in_twin,
    play_on_chip,
)

CYCLES_PER_US = 16
ALL_INTERRUPTS_AT_ONCE = 560
"""Cycles that an event may be late when four axes want theirs at once and all of them load a segment."""
LOADS_AT_ONCE = 300
"""The same for two axes on different channels, or when the others don't load."""
ONLY_ITSELF = 2 * CYCLES_PER_US
"""How late one motor's step may be below 50,000 steps/s."""
Choice = random.Random


def random_segments(choice: Choice, shortest: int, steps: int) -> list[Segment]:
    """Return segments of all kinds with about so many steps. A direction turns only after a silent wait."""
    segments: list[Segment] = []
    while steps > 0:
        count = min(steps, choice.choice([1, 2, 3, choice.randint(4, 60), choice.randint(257, 600)]))
        first, last = (int(shortest * 2 ** choice.uniform(0, 3)) for _ in range(2))
        add = int((last - first) / count)
        segments.append(Segment(first, count, add))
        steps -= count
        if choice.random() < 0.2:
            segments.append(Segment(choice.choice([shortest * 2, LONGEST_WAIT]), choice.randint(1, 3), is_step=False))
            segments.append(Segment(first, 1, turns=choice.random() < 0.7))
    # The last segment's last interval isn't waited for.
    return segments


def check_against_twin(chip: Played, twin: Played, cycles_per_tick: int, bound: int) -> int:
    """Every event comes at its time, all of them so many cycles after it. Return the constant."""
    late = [chip.steps[axis] - twin.steps[axis] * cycles_per_tick for axis in range(4)]
    together = np.concatenate(late)
    assert [len(one) for one in late] == [len(twin.steps[axis]) for axis in range(4)]
    constant = int(together.min())
    assert (together - constant).max() <= bound
    for axis in range(4):
        # A turn is seen one load after the edge.
        turned = chip.turns[axis] - twin.turns[axis] * cycles_per_tick - constant
        assert ((turned > 0) & (turned <= bound + 150)).all()
    return constant


def position(segments: list[Segment]) -> int:
    total, sign = 0, 1
    for segment in segments:
        sign = -sign if segment.turns else sign
        total += sign * segment.count * segment.is_step
    return total


@pytest.mark.parametrize("seed", range(10))
def test_equals_its_twin(tmp_path: Path, engine: Engine, seed: int) -> None:
    choice = random.Random(seed)
    fast = seed % 2 == 0
    axes = [[], [], [], []]
    for axis in choice.sample(range(4), choice.randint(1, 4)) if seed > 1 else range(4):
        axes[axis] = random_segments(choice, 1600 if fast else 200, choice.randint(100, 800))
    job = Job(axes, fast=fast, setup_ticks=choice.randint(1000, 30_000), busy=seed % 3 == 0)
    twin, chip = play_in_twin(job, tmp_path), play_on_chip(job, tmp_path, engine)
    start = 480 if fast else 60
    for axis, segments in enumerate(axes):
        assert (twin.steps[axis] - start).tolist() == expected_steps(segments, job.setup_ticks)
    check_against_twin(chip, twin, 1 if fast else 8, engine.late(ALL_INTERRUPTS_AT_ONCE))
    assert chip.positions == twin.positions == tuple(position(segments) for segments in axes)
    assert chip.empty == twin.empty == tuple(int(bool(segments)) for segments in axes)


@pytest.mark.parametrize("axis", range(4))
@pytest.mark.parametrize("fast", [True, False])
def test_one_motor_is_punctual(tmp_path: Path, engine: Engine, axis: int, fast: bool) -> None:
    """Below 50,000 steps/s, with the serial port busy and short segments."""
    shortest = 330 if fast else 41
    ramp = [Segment(shortest + 20 - i, 50) for i in range(20)] + [Segment(shortest, 700), Segment(shortest, 1, 40)]
    job = Job([[]] * axis + [ramp], fast=fast, busy=True)
    twin, chip = play_in_twin(job, tmp_path), play_on_chip(job, tmp_path, engine)
    check_against_twin(chip, twin, 1 if fast else 8, engine.late(ONLY_ITSELF))
    assert chip.statistics["lost_bytes"] == 0
    # Each byte counted was the expected one. After the last step nobody takes them any more.
    assert 0 <= chip.statistics["received_bytes"] - chip.received < 130


def test_trace_tells_when_segments_were_loaded(tmp_path: Path, engine: Engine) -> None:
    segments = [Segment(1000 + 50 * i, 3 + i) for i in range(12)]
    for fast in (True, False):
        job = Job([segments, segments], fast=fast)
        twin, chip = play_in_twin(job, tmp_path), play_on_chip(job, tmp_path, engine)
        for axis in range(2):
            late = np.diff(chip.traced[axis]).astype(np.uint16) - np.diff(twin.traced[axis]).astype(np.uint16)
            assert (np.abs(late.astype(np.int16)) <= engine.late(LOADS_AT_ONCE) // (1 if fast else 8)).all()


def test_counts_up_to_65536_events(tmp_path: Path, engine: Engine) -> None:
    job = Job([[Segment(180, 65_536), Segment(180, 256), Segment(180, 257), Segment(180, 1)]])
    chip = play_on_chip(job, tmp_path, engine)
    assert chip.positions[0] == len(chip.steps[0]) == 65_536 + 256 + 257 + 1
    assert np.abs(np.diff(chip.steps[0]) - 180).max() <= engine.late(ONLY_ITSELF)


def test_an_axis_that_starts_later_neither_waits_nor_disturbs(tmp_path: Path, engine: Engine) -> None:
    """Axes 2 and 1 start in step while axis 0 runs; each shares a channel or has one of its own."""
    for fast in (True, False):
        scale = 1 if fast else 8
        running = [Segment(1000 // scale, 60)] * 40
        job = Job(
            [running, [Segment(777 // scale, 200)], [Segment(901 // scale, 200)]],
            fast=fast,
            first=1,
            later=6,
            later_loads=9,
        )
        twin, chip = play_in_twin(job, tmp_path), play_on_chip(job, tmp_path, engine)
        late = chip.steps[0] - twin.steps[0] * scale
        assert late.max() - late.min() <= engine.late(LOADS_AT_ONCE)
        own = [chip.steps[axis] - twin.steps[axis] * scale for axis in (1, 2)]
        assert max(one.max() for one in own) - min(one.min() for one in own) <= engine.late(LOADS_AT_ONCE)
        assert chip.steps[1][0] > chip.steps[0][100]
        assert chip.positions == (2400, 200, 200, 0)


def counted(chip: Played, axis: int) -> int:
    """Return where an axis really is, from its edges."""
    position, sign = 0, 1
    edges = chip.edges[np.isin(chip.edges["pin"], (STEP_PINS[axis], DIRECTION_PINS[axis]))]
    for edge in edges:
        if edge["pin"] == DIRECTION_PINS[axis]:
            sign = -sign
        elif edge["value"]:
            position += sign
    return position


@pytest.mark.parametrize("halted", [1, 2, 4, 5, 8, 10, 11, 15])
def test_halt_leaves_exact_counts(tmp_path: Path, engine: Engine, halted: int) -> None:
    """And no pulse comes after it, none is cut short, and the other axes go on as if nothing had happened."""
    choice = random.Random(halted)
    axes = [random_segments(choice, 1600, 700) for _ in range(4)]
    job = Job(axes, halted=halted, halt_loads=5, watched=(halted & -halted).bit_length() - 1)
    twin, chip = play_in_twin(job, tmp_path), play_on_chip(job, tmp_path, engine)
    mark = chip.edges["cycle"][chip.edges["pin"] == HALT_PIN]
    assert len(mark) == 1
    for axis in range(4):
        assert chip.positions[axis] == counted(chip, axis)
        pin = chip.edges[chip.edges["pin"] == STEP_PINS[axis]]
        assert len(pin) % 2 == 0
        if halted >> axis & 1:
            assert 0 < len(chip.steps[axis]) < 700
            assert (pin["cycle"] < mark[0]).all()
        else:
            late = chip.steps[axis] - twin.steps[axis]
            assert late.max() - late.min() <= engine.late(ALL_INTERRUPTS_AT_ONCE)
            assert chip.positions[axis] == position(axes[axis])


def test_the_busy_line_loses_no_byte_at_the_highest_speed(tmp_path: Path, engine: Engine) -> None:
    """150,000 steps/s on the controller, 100,000 in a sketch."""
    interval = 160 if engine.board else 107
    job = Job([[Segment(interval, 50)]], repeats=(400, 1, 1, 1), busy=True)
    chip = play_on_chip(job, tmp_path, engine)
    assert chip.statistics["lost_bytes"] == 0
    assert len(chip.steps[0]) == 20_000
    intervals = np.diff(chip.steps[0])
    late: npt.NDArray[np.int64] = chip.steps[0] - chip.steps[0][0] - np.arange(20_000) * interval
    assert late.max() - late.min() <= engine.late(5 * CYCLES_PER_US)
    assert intervals.min() > 60
    assert all(after > before for before, after in pairwise(chip.steps[0].tolist()))
