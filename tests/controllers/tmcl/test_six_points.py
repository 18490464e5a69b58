"""The ramp that a module plays, beside a chip that goes slice by slice."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.tmcl.chip import ACCELERATION, POSITION, SPEED, Chip
from stepramp.controllers.six_points import SixPoints

SLICE_S = 5e-6
LONG_S = 30.0


def registers(**figures: int) -> dict[str, int]:
    usual = {"vstart": 0, "a1": 0, "v1": 0, "amax": 500, "vmax": 5000, "dmax": 300, "d1": 300, "vstop": 10}
    return usual | figures


def six_points(figures: dict[str, int]) -> SixPoints:
    return SixPoints(
        **{name: value * (SPEED if name.startswith("v") else ACCELERATION) for name, value in figures.items()}
    )


def instants_of_a_chip(figures: dict[str, int], steps: int) -> np.ndarray:
    chip = Chip()
    for name, value in figures.items():
        setattr(chip, name, value)
    chip.mode, chip.target, chip.keeps_instants = POSITION, steps, True
    for _ in range(round(LONG_S / SLICE_S)):
        chip.advance(SLICE_S)
        if chip.position == steps and not chip.speed:
            return np.array(chip.instants)
    raise AssertionError(chip.place)


@pytest.mark.parametrize(
    ("figures", "steps"),
    [
        (registers(), 900),
        (registers(), 40),
        (registers(vstart=300, vstop=300), 500),
        (registers(vstart=100, vstop=400), 300),
        (registers(a1=900, v1=2000, d1=700), 900),
        (registers(a1=200, v1=3000, d1=1500), 60),
        (registers(a1=900, v1=9000, d1=700), 700),
        (registers(vmax=300), 100),
        (registers(vstart=300, vmax=300, vstop=300), 50),
    ],
    ids=["slews", "too short to slew", "base speed", "stops faster", "six points", "peak below V1", "V1 above VMAX",
         "slow", "level"],
)  # fmt: skip
def test_the_steps_are_those_of_a_chip(figures: dict[str, int], steps: int) -> None:
    """Each within 0.2 ms; the last, to which a chip creeps, within 1 ms: so much its slices make of it."""
    made = instants_of_a_chip(figures, steps)
    planned = np.cumsum(six_points(figures).intervals_s(steps))
    assert made.shape == planned.shape
    assert np.abs(made - planned)[:-1].max() < 2e-4
    assert abs(made[-1] - planned[-1]) < 1e-3


FIGURES = st.builds(
    SixPoints,
    vstart=st.floats(0, 2000),
    a1=st.floats(120, 1e6),
    v1=st.one_of(st.just(0.0), st.floats(1, 5000)),
    amax=st.floats(120, 1e6),
    vmax=st.floats(1, 10_000),
    dmax=st.floats(120, 1e6),
    d1=st.floats(120, 1e6),
    vstop=st.floats(9, 2000),
)


@given(FIGURES, st.integers(1, 3000))
def test_each_step_takes_some_time_and_none_is_faster_than_allowed(points: SixPoints, steps: int) -> None:
    waits = points.intervals_s(steps)
    assert waits.shape == (steps,)
    fastest = max(points.vmax, points.vstart, points.vstop)
    assert waits.min() * fastest > 1 - 1e-6


@given(FIGURES, st.integers(1, 3000))
def test_what_is_slowed_down_as_it_was_sped_up_is_the_same_backwards(points: SixPoints, steps: int) -> None:
    even = dataclasses.replace(points, vstop=max(points.vstart, 9), vstart=max(points.vstart, 9), d1=points.a1)
    even = dataclasses.replace(even, dmax=even.amax)
    waits = even.intervals_s(steps)
    assert waits == pytest.approx(waits[::-1], rel=1e-6)
