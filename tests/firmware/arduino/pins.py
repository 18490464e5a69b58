"""What the pins of a sketch did in the simulator."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.avr import CLOCK_HZ, SimulatedController

Edges = npt.NDArray[np.void]
TIMEOUT_S = 90.0
MOST_EARLY_US = 150
"""No interval is shorter than planned by more: STEPRAMP_MOST_CATCH_UP_US in arduino_limits.h, and some 10 us for the
clock's grain and 15 us for each other axis that steps at the same time."""


def edges_until(simulated: SimulatedController, is_enough: Callable[[Edges], bool]) -> Edges:
    """Run a sketch until its edges are enough. AssertionError when they aren't after a long time."""
    simulated.start()
    try:
        deadline = time.monotonic() + TIMEOUT_S
        while not is_enough(simulated.edges()):
            assert time.monotonic() < deadline, f"only {len(simulated.edges())} edges"
            time.sleep(0.1)
    finally:
        simulated.stop()
    return simulated.edges()


def after_s(seconds: float) -> Callable[[Edges], bool]:
    return lambda edges: len(edges) > 0 and edges["cycle"][-1] > seconds * CLOCK_HZ


def times_us(edges: Edges, pin: int, value: int) -> npt.NDArray[np.float64]:
    return edges["cycle"][(edges["pin"] == pin) & (edges["value"] == value)] * 1e6 / CLOCK_HZ


@dataclass(frozen=True)
class Move:
    """Steps in one direction, from rest to rest."""

    backward: bool
    times_us: npt.NDArray[np.float64]

    @property
    def intervals_us(self) -> npt.NDArray[np.float64]:
        return np.diff(self.times_us)


def moves_of(edges: Edges, step_pin: int, direction_pin: int, rest_us: float) -> list[Move]:
    """Return the moves of a stepper: separated by a change of direction or a rest that is longer than any interval."""
    rises = times_us(edges, step_pin, 1)
    turns = edges[edges["pin"] == direction_pin]
    turn_times, levels = turns["cycle"] * 1e6 / CLOCK_HZ, turns["value"]
    # The last edge of the direction pin before each step; high is forward.
    last = np.searchsorted(turn_times, rises) - 1
    assert (last >= 0).all()
    backward = levels[last] == 0
    begins = np.flatnonzero((np.diff(rises) > rest_us) | (np.diff(last) != 0)) + 1
    return [Move(bool(backward[group[0]]), rises[group]) for group in np.split(np.arange(len(rises)), begins)]
