"""The ramp that a controller works out itself, and how far it is from the design's."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.given_numbers import steps_per_unit
from stepramp.design import Design
from stepramp.errors import Refused, Rejected
from stepramp.ramp.profile import Profile, profile_of
from stepramp.ramp.thinning import kept_steps_of_all
from stepramp.units import MICROSECONDS_PER_SECOND

MOST_COMPARED = 500_000
"""Of longer moves a push doesn't tell how far they are off: a preview is wanted at once [steps]."""


@dataclass(frozen=True)
class OwnRamp:
    """A move as a controller plays it."""

    intervals_s: NDArray[np.float64]
    """The wait after each step [s], shape (N,)."""
    losses: tuple[str, ...]
    """What of the design it doesn't keep, as sentences."""


PlayOwn = Callable[[Design, float], OwnRamp]
"""Works out what a controller plays of a design's move, given the steps per mm that it is set to; pure.

Raises Rejected for what it can't take, Refused for what it can't play."""


@dataclass(frozen=True)
class Beside:
    """A controller's own ramp beside that of the design. Arrays of shape (N,)."""

    own: OwnRamp
    profile: Profile
    """The design's."""

    @classmethod
    def of(cls, design: Design, play: PlayOwn, steps_per_mm: float | None = None) -> "Beside":
        """Return both ramps of a design's move; steps_per_mm: None for the design's own.

        Raises as PlayOwn, and Rejected when the design can't be planned.
        """
        return cls(play(design, steps_per_mm or float(steps_per_unit(design.axis))), profile_of(design))

    @cached_property
    def relative_error(self) -> NDArray[np.float64]:
        """The controller's interval over the design's, less 1: 0.01 is 1 % too long."""
        planned_s = self.profile.intervals_ticks / self.profile.timer_hz
        return self.own.intervals_s / planned_s - 1

    @property
    def largest_error(self) -> tuple[float, int]:
        """The relative error that is furthest from 0, and the first step that has it, counted from 1."""
        place = int(np.abs(self.relative_error).argmax())
        return float(self.relative_error[place]), place + 1

    @property
    def largest_deviation_us(self) -> float:
        """How far an interval of the controller's is from that of the design, at most [µs]."""
        planned_s = self.profile.intervals_ticks / self.profile.timer_hz
        return float(np.abs(self.own.intervals_s - planned_s).max()) * MICROSECONDS_PER_SECOND

    @property
    def duration_s(self) -> float:
        """How long the controller takes [s]."""
        return float(self.own.intervals_s.sum())

    def kept(self, most_points: int) -> NDArray[np.int64]:
        """Return about so many steps, counted from 0, that carry the shape of both curves."""
        curves = [self.own.intervals_s, self.relative_error]
        return kept_steps_of_all(curves, self.profile.phases, most_points)

    @property
    def start_s(self) -> NDArray[np.float64]:
        """Instant of each pulse [s], from the first one on."""
        waits = self.own.intervals_s
        return np.cumsum(waits) - waits


@dataclass(frozen=True)
class Deviation:
    """How far the intervals of controllers' own ramps are from the designs', of all moves together."""

    largest_us: float | None
    """[µs]; None: not worked out."""
    why_not: str | None
    """As a sentence."""

    @classmethod
    def of(cls, designs: Sequence[Design], scales: Sequence[float | None], play: PlayOwn) -> "Deviation":
        """Work it out for moves of up to MOST_COMPARED steps. scales: the steps per mm of each; None: the design's.

        What can't be taken is for a push to reject.
        """
        if sum(abs(design.move.steps) for design in designs) > MOST_COMPARED:
            off = "How far its delays are from the design's"
            return cls(None, f"{off} isn't worked out beyond {MOST_COMPARED:,} steps.")
        try:
            both = [Beside.of(design, play, scale) for design, scale in zip(designs, scales, strict=True)]
        except (Refused, Rejected) as error:
            return cls(None, str(error))
        return cls(max(beside.largest_deviation_us for beside in both), None)


def warm_up_own_ramps(plays: Iterable[PlayOwn | None]) -> None:
    """Have what works ramps out compiled before it is needed, on a small ramp."""
    small = Design.checked(
        {
            "schema": "stepramp/2",
            "timer": {"frequency_hz": 1_000_000},
            "ramp": {"slew_speed_steps_per_s": 200, "acceleration_steps_per_s2": 1000},
            "move": {"steps": 100},
        }
    )
    for play in plays:
        if play is not None:
            play(small, 10.0)
