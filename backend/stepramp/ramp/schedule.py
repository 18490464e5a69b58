"""Schedules: the pulses of up to four axes that move at the same time, and where they come too close."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection
from stepramp.numerics.compiled import compiled, counted
from stepramp.numerics.limit_text import told_highest
from stepramp.ramp.line import Limit, called, fields_of, leader_of, line_profile, steps_of, steps_together
from stepramp.ramp.profile import Profile, profile_of
from stepramp.ramp.thinning import kept_steps
from stepramp.ramp.timer_limits import TimerWarning
from stepramp.shapes import SHAPES, USUAL_SHAPE
from stepramp.units import MICROSECONDS_PER_SECOND, speed_from_interval, ticks_from_us, us_from_ticks

Mode = Literal["independent", "line"]

MOST_AXES = 4
MOST_LISTED = 100
"""Conflicts that are listed one by one; all are counted."""

ROUNDING = 2.0**-51
"""Instants are doubles: a gap that is short by less than this part of its instant may be so only by rounding, and is
not counted as short."""


@dataclass(frozen=True)
class ScheduledAxis:
    """One axis of a schedule. Each of its pulses comes with a pulse of a profile, its pace."""

    name: str
    steps: int
    """Length of the move [steps]."""
    direction: int
    """1 forwards, -1 backwards."""
    pace: Profile
    """The axis' own profile; along a line, the leader's."""
    step: NDArray[np.int64]
    """Which steps of the axis the arrays are of, counted from 1, shape (n,)."""
    pace_step: NDArray[np.int64]
    """With which step of the pace each comes, counted from 1, shape (n,)."""

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Instant of the pulse of each step [s], shape (n,)."""
        return self.pace.time_s[self.pace_step - 1]

    @property
    def position_steps(self) -> NDArray[np.int64]:
        """Position after the pulse of each step [steps], shape (n,)."""
        return self.direction * self.step

    @property
    def speed_steps_per_s(self) -> NDArray[np.float64]:
        """Speed after the pulse of each step: along a line its even share of the leader's [steps/s], shape (n,)."""
        return self.pace.speed_steps_per_s[self.pace_step - 1] * (self.steps / self.pace.time_s.size)

    def thinned(self, most: int) -> "ScheduledAxis":
        """Return the axis with about `most` steps that keep the shape of its pace, the first and the last of them."""
        if self.step.size <= most:
            return self
        drawn = kept_steps(self.pace.intervals_ticks, self.pace.phases, most) + 1
        kept = np.unique(np.maximum(np.searchsorted(self.pace_step, drawn, side="right") - 1, 0))
        return replace(self, step=self.step[kept], pace_step=self.pace_step[kept])


@dataclass(frozen=True)
class Schedule:
    """What one to four axes do from time 0 on."""

    axes: tuple[ScheduledAxis, ...]
    leader: int | None
    """The axis that leads the line, counted from 0; None when each axis moves on its own."""
    limits: tuple[Limit, ...]
    """What makes a line slower than its leader's own move."""
    warnings: tuple[TimerWarning, ...]
    """Their fields are paths from `designs` on."""

    @property
    def duration_s(self) -> float:
        """From time 0 to the end of the last interval of all axes [s]."""
        return max(axis.pace.duration_s for axis in self.axes)


@dataclass(frozen=True)
class Pulses:
    """Pulses of several axes in order of time; those of one instant in order of the axes. Arrays of shape (n,)."""

    time_s: NDArray[np.float64]
    axis: NDArray[np.uint8]
    """The axis that pulses, counted from 0."""
    position_steps: NDArray[np.int64]
    """The axis' position after the pulse [steps]."""


@dataclass(frozen=True)
class Conflict:
    """Two pulses of different axes that come too close."""

    time_s: float
    """Instant of the earlier pulse [s]."""
    axes: tuple[int, int]
    """The axis of the earlier and that of the later pulse, counted from 0."""
    gap_us: float
    """From the earlier to the later pulse [µs]."""


@dataclass(frozen=True)
class Conflicts:
    """All pairs of pulses that come too close."""

    count: int
    first: tuple[Conflict, ...]
    """The first of them, at most MOST_LISTED, in order of the earlier pulse and then of the later one."""


def schedule_of(designs: Sequence[Design], mode: Mode) -> Schedule:
    """Return the schedule of the designs' moves, which all begin at time 0.

    independent: each axis plays its own profile with its own timer. line: straight in the space of all axes' steps;
    one axis leads and the others follow, as `line` says, all with the leader's timer.

    Raises Rejected when there aren't one to four designs, and as profile_of does; fields are paths from `designs` on.
    """
    if not 1 <= len(designs) <= MOST_AXES:
        raise Rejected([Rejection("designs", Count(f"{len(designs)} designs"), f"a list of 1 to {MOST_AXES} designs")])
    return _independent(designs) if mode == "independent" else _line(designs)


def merged(axes: Sequence[ScheduledAxis]) -> Pulses:
    """Return the pulses of all axes in order of time."""
    times = np.concatenate([axis.time_s for axis in axes])
    # Stable, and quick on runs that are sorted already: it merges them.
    order = np.argsort(times, kind="stable")
    owners = np.repeat(np.arange(len(axes), dtype=np.uint8), [axis.step.size for axis in axes])
    positions = np.concatenate([axis.position_steps for axis in axes])
    return Pulses(times[order], owners[order], positions[order])


def conflicts_of(pulses: Pulses, shortest_spacing_us: float) -> Conflicts:
    """Return the pairs of pulses of different axes that come closer than the controller can serve them.

    Pulses of one instant, which one interrupt serves together, are no conflict.
    """
    pairs = np.empty((MOST_LISTED, 2), np.int64)
    count = int(_close_pairs(pulses.time_s, pulses.axis, shortest_spacing_us / MICROSECONDS_PER_SECOND, pairs))
    first = tuple(
        Conflict(
            time_s=float(pulses.time_s[earlier]),
            axes=(int(pulses.axis[earlier]), int(pulses.axis[later])),
            gap_us=float(pulses.time_s[later] - pulses.time_s[earlier]) * MICROSECONDS_PER_SECOND,
        )
        for earlier, later in pairs[:count]
    )
    return Conflicts(count, first)


def _independent(designs: Sequence[Design]) -> Schedule:
    profiles = []
    for axis, design in enumerate(designs):
        with fields_of(axis):
            profiles.append(profile_of(design))
    axes = tuple(_axis(design, profile) for design, profile in zip(designs, profiles, strict=True))
    warnings = [warning for axis, profile in enumerate(profiles) for warning in _warnings(axis, profile)]
    return Schedule(axes, None, (), tuple(warnings))


def _line(designs: Sequence[Design]) -> Schedule:
    leader = leader_of(designs)
    pace, limits = line_profile(designs, leader)
    axes = tuple(_axis(design, pace) for design in designs)
    warnings = _warnings(leader, pace)
    for number, axis in enumerate(axes):
        if number != leader:
            warnings += _other_shape(designs, leader, number)
            warnings += _bunched(designs, leader, number, axis)
    return Schedule(axes, leader, limits, tuple(warnings))


def _axis(design: Design, pace: Profile) -> ScheduledAxis:
    steps = steps_of(design)
    return ScheduledAxis(
        name=design.name,
        steps=steps,
        direction=int(math.copysign(1, design.move.steps)),
        pace=pace,
        step=counted(1, steps),
        pace_step=steps_together(pace.time_s.size, steps),
    )


def _warnings(axis: int, profile: Profile) -> list[TimerWarning]:
    return [replace(warning, field=warning.field and f"designs.{axis}.{warning.field}") for warning in profile.warnings]


def _other_shape(designs: Sequence[Design], leader: int, number: int) -> list[TimerWarning]:
    """Warn of a follower that was given a shape of its own: the leader's holds for all."""
    led, own = designs[leader], designs[number]
    is_its_own = own.ramp.shape.name != USUAL_SHAPE and not own.method.plays_table
    is_the_leaders = led.ramp.shape.name == own.ramp.shape.name and led.ramp.shape.points == own.ramp.shape.points
    if not is_its_own or (is_the_leaders and not led.method.plays_table):
        return []
    leads = "plays its table" if led.method.plays_table else f"has the shape {SHAPES[led.ramp.shape.name].label}"
    message = (
        f"Along the line the shape of {called(designs, number)}, {SHAPES[own.ramp.shape.name].label}, does not hold: "
        f"{called(designs, leader)} leads and {leads}{'' if led.method.plays_table else ', which holds for all'}."
    )
    return [TimerWarning(f"designs.{number}.ramp.shape.name", message)]


def _bunched(designs: Sequence[Design], leader: int, number: int, axis: ScheduledAxis) -> list[TimerWarning]:
    """Warn of a follower whose steps come closer than its driver allows: they fall on the leader's, so not evenly."""
    timer, timer_hz = designs[number].timer, designs[leader].timer.frequency_hz
    ends = np.cumsum(axis.pace.intervals_ticks)
    gaps = np.diff(ends[axis.pace_step - 1] - axis.pace.intervals_ticks[axis.pace_step - 1])
    least = ticks_from_us(timer.shortest_interval_us, timer_hz)
    if not gaps.size or gaps.min() >= least:
        return []
    n_l, n = axis.pace.time_s.size, axis.steps
    fastest = told_highest(speed_from_interval(least, timer_hz) * (n_l // n) * n / n_l, "steps/s")
    message = (
        f"Along the line, steps of {called(designs, number)} come as close as "
        f"{us_from_ticks(int(gaps.min()), timer_hz):,.6g} µs, less than the {timer.shortest_interval_us:g} µs that the "
        f"controller needs: use a slew speed of at most {fastest}."
    )
    return [TimerWarning(f"designs.{number}.timer.shortest_interval_us", message, (fastest,))]


@compiled
def _close_pairs(time_s, axis, spacing_s, pairs):  # type: ignore[no-untyped-def]  # compiled
    """Count pairs of pulses that are closer than the spacing, and write the first of them as [earlier, later]."""
    in_window = np.zeros(256, np.int64)
    count, after, until = 0, 0, 0
    for earlier in range(time_s.size):
        # The window of pulses that are later than this one, but too close: it only moves on.
        while until < time_s.size and time_s[until] - time_s[earlier] + ROUNDING * time_s[until] < spacing_s:
            in_window[axis[until]] += 1
            until += 1
        while after < until and time_s[after] <= time_s[earlier]:
            in_window[axis[after]] -= 1
            after += 1
        found = until - after - in_window[axis[earlier]]
        later = after
        while found and count < len(pairs) and later < until:
            if axis[later] != axis[earlier]:
                pairs[count] = (earlier, later)
                count += 1
                found -= 1
            later += 1
        count += found
    return count
