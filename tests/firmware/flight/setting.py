"""What a flight must keep to: how fast its axes may speed up and slow down, and how late a step may be."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from firmware.checker import CYCLES_PER_US
from firmware.protocol import Settings

Ticks = npt.NDArray[np.float64]

BLOCKED_US, LOADING_US, LONGEST_INTERRUPT_US = 5.0, 11.0, 32.5
"""What a step may have to wait for: a blocked section (engine.c), another axis that loads a segment (94 and 85 cycles:
engine.S; both in firmware/src/boards/avr/), the two axes of the other channel (520 cycles: budget.toml)."""
LATE_US = (
    3.1,
    BLOCKED_US + LOADING_US,
    BLOCKED_US + LONGEST_INTERRUPT_US,
    BLOCKED_US + LONGEST_INTERRUPT_US + LOADING_US,
)
"""How late a step may be when 1, 2, 3, 4 axes move; alone: firmware/README.md."""
WIDEST_DEAF_US = 10
"""Wider pulses let the serial port's interrupts in, which nothing interrupts then."""
BESIDE_WIDE_PULSES_US = 1.6
"""Their 75 cycles rather than 3.1 us."""


@dataclass(frozen=True)
class Slopes:
    """How fast the speed of an axis may change: intervals from rest on, the longest first [ticks]."""

    up: Ticks
    down: Ticks
    slew: int
    places: int = 0
    """An interval that lies between two of a list may count as one so many places on."""
    last_places: int = 1
    """So many intervals of the ramp down may be left out or unseen before rest: no step follows the last one."""


@dataclass(frozen=True)
class Setting:
    """What a flight must keep to."""

    slopes: Sequence[Slopes]
    """Of each axis."""
    cycles_per_tick: int
    settings: Settings

    @property
    def late_cycles(self) -> float:
        """How late a step may be: what is stated, and the pulses of the others [cycles]."""
        others = len(self.slopes) - 1
        late_us = LATE_US[others] + (BESIDE_WIDE_PULSES_US if self.settings.pulse_width_us > WIDEST_DEAF_US else 0)
        return (late_us + others * self.settings.pulse_width_us) * CYCLES_PER_US + self.cycles_per_tick
