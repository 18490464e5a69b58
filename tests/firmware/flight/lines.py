"""Straight lines."""

from collections.abc import Sequence

import numpy as np

from firmware.checker import CYCLES_PER_US, AxisEdges
from firmware.flight.judgement import Judgement, at, us
from firmware.flight.motion import Flight, leader_of

TOGETHER_US = 1.0
"""So near to the leader's steps of a line are those of its other axes."""


def judge_lines(flights: Sequence[Flight], found: Judgement) -> None:
    for line, end in flights[0].lines:
        leader, values = leader_of(line), line.values
        if leader >= len(flights):
            continue
        its = _between(flights[leader], line.arrived, end)
        for axis, steps in values.items():
            made = _between(flights[axis], line.arrived, end)
            if (made.forward != (steps > 0)).any():
                found.add(f"axis {axis}: steps of a line {at(line.arrived)} in the wrong direction")
            if axis == leader or steps == 0:
                continue
            most, own = abs(values[leader]), abs(steps)
            places = -(-most * (2 * np.arange(1, own + 1) - 1) // (2 * own))
            wanted = its.steps[places[places <= its.steps.size] - 1]
            if wanted.size != made.steps.size:
                found.add(f"axis {axis}: {made.steps.size} steps of a line {at(line.arrived)} instead of {wanted.size}")
            elif wanted.size and np.abs(wanted - made.steps).max() > TOGETHER_US * CYCLES_PER_US:
                found.add(f"axis {axis}: a step of a line {us(np.abs(wanted - made.steps).max())} from the leader's")


def _between(flight: Flight, begin: float, end: float) -> AxisEdges:
    first, last = np.searchsorted(flight.made.steps, [begin, end])
    made = flight.made
    return AxisEdges(made.steps[first:last], made.ends[first:last], made.turns, made.forward[first:last])
