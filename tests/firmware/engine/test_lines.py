"""Straight lines: the assembly on the simulated chip and its twin in C against Bresenham's formula."""

import random
from pathlib import Path

import numpy as np
import pytest

from firmware.engine.jobs import LINE, Engine, Job, LineSegment, play_in_twin, play_on_chip

START_TICKS = {True: 480, False: 60}
A_PIECE_LOADED = 300
"""Cycles that an event may be late when the one before began a piece."""
AXIS_3_LATER = 2
"""Cycles from the edges of port D to that of axis 3."""
NEXT_AXIS_LATER = 10
"""In a sketch, whose pins may be any: from each axis to the next."""


def expected_line(segments: list[LineSegment], setup: int) -> list[list[int]]:
    """Return the times of each axis' steps [ticks] after the first event: follower's step m of its piece comes with the
    leaders' step ceil(total (2 m - 1) / (2 delta))."""
    times: list[list[int]] = [[], [], [], []]
    now = setup
    piece, made = LineSegment(1), 0
    for segment in segments:
        if segment.total:
            piece, made = segment, 0
        with_step = {
            (axis, -(-piece.total * (2 * m - 1) // (2 * delta)))
            for axis, delta in piece.followers
            for m in range(1, delta + 1)
        }
        for i in range(segment.count):
            made += segment.leaders != 0
            for axis in range(4):
                if segment.leaders and (segment.leaders >> axis & 1 or (axis, made) in with_step):
                    times[axis].append(now)
            now += segment.interval + i * segment.add
    return times


def random_line(choice: random.Random, shortest: int, pieces: int) -> list[LineSegment]:
    segments: list[LineSegment] = []
    for _ in range(pieces):
        axes = choice.sample(range(4), choice.randint(1, 4))
        total = choice.choice([1, 2, choice.randint(3, 40), choice.randint(200, 700)])
        followers = tuple((axis, choice.choice([total, 1, choice.randint(0, total)])) for axis in axes[1:])
        first = choice.randint(1, total)
        turn_axes = choice.randint(0, 15)
        if segments:
            segments.append(LineSegment(choice.randint(shortest, 10 * shortest), choice.randint(1, 3), leaders=0))
        begin = LineSegment(shortest + first, first, -1, 1 << axes[0], total, followers, turn_axes)
        segments.append(begin)
        if choice.random() < 0.5:
            segments.append(LineSegment(shortest * 2, leaders=0))
        if first < total:
            segments.append(LineSegment(shortest, total - first, 1, 1 << axes[0], 0, followers))
    return segments


@pytest.mark.parametrize("seed", range(6))
def test_equals_the_formula(tmp_path: Path, engine: Engine, seed: int) -> None:
    choice = random.Random(seed)
    fast = seed % 2 == 0
    cycles_per_tick = 1 if fast else 8
    segments = random_line(choice, 700 // cycles_per_tick, 12)
    job = Job([segments], fast=fast, mode=LINE, setup_ticks=choice.randint(1000, 30_000), busy=seed % 3 == 0)
    twin, chip = play_in_twin(job, tmp_path), play_on_chip(job, tmp_path, engine)
    expected = expected_line(segments, job.setup_ticks)
    late = []
    for axis in range(4):
        assert (twin.steps[axis] - START_TICKS[fast]).tolist() == expected[axis]
        late.append(chip.steps[axis] - twin.steps[axis] * cycles_per_tick)
        assert chip.turns[axis].size == twin.turns[axis].size == sum(s.turn_axes >> axis & 1 for s in segments)
    together = np.concatenate(late)
    assert together.max() - together.min() <= engine.late(A_PIECE_LOADED)
    assert chip.positions[0] == twin.positions[0] == sum(s.count for s in segments if s.leaders)
    assert chip.empty[0] == twin.empty[0] == 1


def test_pins_rise_together(tmp_path: Path, engine: Engine) -> None:
    """Axes 0 to 2 in the same cycle, axis 3 with the next instruction; in a sketch one right after the other."""
    line = LineSegment(400, 300, leaders=1, total=300, followers=((1, 300), (2, 300), (3, 300)))
    chip = play_on_chip(Job([[line]], mode=LINE, busy=True), tmp_path, engine)
    assert len(chip.steps[0]) == 300
    later = [axis * NEXT_AXIS_LATER for axis in range(4)] if engine.board else [0, 0, 0, AXIS_3_LATER]
    for axis in range(4):
        assert (chip.steps[axis] - chip.steps[0] == later[axis]).all()


def test_several_axes_can_lead(tmp_path: Path, engine: Engine) -> None:
    line = LineSegment(400, 100, leaders=0b1011, total=100, followers=((2, 37),))
    chip = play_on_chip(Job([[line]], mode=LINE), tmp_path, engine)
    assert [len(chip.steps[axis]) for axis in range(4)] == [100, 100, 37, 100]


@pytest.mark.parametrize("both_edges", [0, 0b1010])
def test_each_edge_a_step_and_wide_pulses(tmp_path: Path, engine: Engine, both_edges: int) -> None:
    line = LineSegment(1000, 50, leaders=1, total=50, followers=((1, 25), (2, 10), (3, 7)))
    for width_us in (0, 20):
        job = Job([[line]], mode=LINE, both_edges=both_edges, step_inverted=0b0100, pulse_width_us=width_us)
        chip = play_on_chip(job, tmp_path, engine)
        assert [len(chip.steps[axis]) for axis in range(4)] == [50, 25, 10, 7]
        for pin in (2, 4) if both_edges else (2, 3, 4, 12):
            own = chip.edges["cycle"][chip.edges["pin"] == pin]
            assert np.diff(own)[::2].min() >= max(width_us, 2.5) * 16


@pytest.mark.parametrize("loads", [2, 5])
def test_halt_leaves_exact_counts(tmp_path: Path, engine: Engine, loads: int) -> None:
    segments = [LineSegment(500, 60, leaders=2, total=60, followers=((0, 41), (3, 9))) for _ in range(8)]
    job = Job([segments], mode=LINE, halted=1, halt_loads=loads)
    chip = play_on_chip(job, tmp_path, engine)
    assert 0 < chip.positions[0] == len(chip.steps[1]) < 480
    whole, rest = divmod(len(chip.steps[1]), 60)
    for axis, delta in ((0, 41), (3, 9)):
        of_rest = sum(-(-60 * (2 * m - 1) // (2 * delta)) <= rest for m in range(1, delta + 1))
        assert len(chip.steps[axis]) == whole * delta + of_rest
