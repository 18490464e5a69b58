"""Profile: the arrays of one planned move."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepramp.design import LEAST_ACCELERATION, Design
from stepramp.errors import Rejected, Rejection, Told
from stepramp.methods import METHODS, REFERENCE
from stepramp.numerics.compiled import counted
from stepramp.numerics.limit_text import told_highest, told_lowest
from stepramp.ramp.motor_contradictions import motor_contradictions
from stepramp.ramp.plan import Plan, plan_of
from stepramp.ramp.slopes import SIDES, full_slopes_of, peak_of
from stepramp.ramp.timer_limits import SlewResolution, TimerWarning, slew_resolution, timer_warnings
from stepramp.shapes.constant import ConstantAcceleration
from stepramp.units import speed_from_interval

_LESS_THAN_A_STEP = "the whole ramp would take less than one step"

BEYOND_SLEW = 0.01
"""Less than this part beyond the slew speed is no matter."""

MOST_TICKS = 2**62
"""Longest move [ticks]: its instants fit in 64 bits."""


@dataclass(frozen=True)
class Phase:
    """A phase of a move: from its first step to its last, counted from 1."""

    name: str
    first_step: int
    last_step: int


@dataclass(frozen=True)
class Profile:
    """One planned move of N steps. Pulse 1 is at time 0; pulse i + 1 comes `intervals_ticks[i - 1]` after pulse i."""

    intervals_ticks: NDArray[np.int64]
    """Wait after each pulse [ticks], shape (N,)."""
    timer_hz: float
    """Ticks a second [Hz]."""
    direction: int
    """1 forwards, -1 backwards."""
    duration_s: float
    """From pulse 1 to the end of the last interval [s]."""
    phases: tuple[Phase, ...]
    """Those that have steps, in order of time."""
    slew_resolution: SlewResolution
    """How finely the timer divides speeds at slew speed."""
    warnings: tuple[TimerWarning, ...]
    plan: Plan
    """The ramp that the move is played from."""
    is_lowered: bool
    """Whether that ramp is made for this move, which is too short for the slew speed."""

    @cached_property
    def time_s(self) -> NDArray[np.float64]:
        """Instant of each pulse [s], shape (N,)."""
        ends = np.cumsum(self.intervals_ticks)
        return np.concatenate(([0], ends[:-1])) / self.timer_hz

    @cached_property
    def position_steps(self) -> NDArray[np.int64]:
        """Position after each pulse [steps], shape (N,)."""
        return counted(1, self.intervals_ticks.size) * self.direction

    @cached_property
    def speed_steps_per_s(self) -> NDArray[np.float64]:
        """Speed of each interval, v = F / p (7) [steps/s], shape (N,)."""
        return self.timer_hz / self.intervals_ticks

    @property
    def peak_speed_steps_per_s(self) -> float:
        """Highest speed of an interval, that of the shortest [steps/s]."""
        return self.timer_hz / int(self.intervals_ticks.min())

    def steps_of(self, phase: str) -> int:
        """Return the number of steps of a phase, 0 when the move has none."""
        return sum(each.last_step - each.first_step + 1 for each in self.phases if each.name == phase)


def profile_of(design: Design) -> Profile:
    """Return the profile of the design's move.

    Raises Rejected as plan_of does, and when the move takes more ticks than can be counted.
    """
    plan, timer_hz = plan_of(design), design.timer.frequency_hz
    intervals, slew_ticks = plan.intervals, plan.real.slew
    if intervals.sum(dtype=np.float64) > MOST_TICKS:
        allowed = f"a lower frequency, so that the move takes at most {MOST_TICKS:,} ticks"
        raise Rejected([Rejection("timer.frequency_hz", timer_hz, allowed)])
    return Profile(
        intervals_ticks=intervals,
        timer_hz=timer_hz,
        direction=int(math.copysign(1, design.move.steps)),
        duration_s=int(intervals.sum()) / timer_hz,
        phases=_phases(plan),
        warnings=(
            *_short_move(design, plan),
            *timer_warnings(design, intervals, slew_ticks),
            *_no_ramp(design, plan),
            *_beyond_slew(design, plan),
            *motor_contradictions(design),
        ),
        slew_resolution=slew_resolution(slew_ticks, timer_hz),
        plan=plan,
        is_lowered=peak_of(design) is not None,
    )


def _phases(plan: Plan) -> tuple[Phase, ...]:
    steps, (n_up, n_down) = plan.steps, plan.sides
    cuts = (("accelerate", 0, n_up), ("slew", n_up, steps - n_down), ("decelerate", steps - n_down, steps))
    return tuple(Phase(name, before + 1, last) for name, before, last in cuts if last > before)


def _short_move(design: Design, plan: Plan) -> list[TimerWarning]:
    is_lowered = peak_of(design) is not None
    needed = math.ceil(sum(slope.length for slope in full_slopes_of(design))) if is_lowered else plan.ramp_steps
    if plan.steps >= needed and not is_lowered:
        return []
    speed = speed_from_interval(float(plan.intervals.min()), design.timer.frequency_hz)
    way, peak = Told(f"{needed:,} steps", needed, "steps", "up"), Told(f"{speed:,.0f} steps/s", speed, "steps/s")
    message = f"Too short to reach full speed, which takes {way}: the move peaks at {peak}."
    return [TimerWarning("move.steps", message, (way, peak)), *_kink(design, plan)]


def _kink(design: Design, plan: Plan) -> list[TimerWarning]:
    """Warn of a short move along a ramp that is not meant to be cut: there its acceleration jumps, by (6)."""
    is_meant = all(slope.begins_alike for slope in full_slopes_of(design))
    if design.move.plan == "this_move" or design.method.plays_table or is_meant:
        return []
    n_up, n_down = plan.sides
    rising, falling = (_steepness(side, design) for side in (plan.real.up[:n_up], plan.real.down[:n_down]))
    before, after = (Told.of(each, "steps/s²") for each in (rising, 0.0 - falling))
    message = (
        f"This move is cut out of a longer ramp: at its peak the acceleration jumps from {before} to {after}. "
        "Planned by itself it keeps to the ramp's jerk."
    )
    return [TimerWarning("move.plan", message, (before, after))]


def _steepness(side: NDArray[np.floating], design: Design) -> float:
    """Return the acceleration at the fast end of a part of a side, slowest interval first [steps/s²], by (6)."""
    speeds = design.timer.frequency_hz / side[-2:].astype(np.float64)
    squares = np.concatenate(([design.ramp.base_speed_steps_per_s], speeds))[-2:] ** 2
    return float(squares[-1] - squares[0]) / 2


def _beyond_slew(design: Design, plan: Plan) -> list[TimerWarning]:
    """Warn of a method whose error leads beyond the slew speed, by more than rounding does."""
    fastest, slew = float(plan.real_intervals.min()), plan.real.slew
    if design.method.plays_table or fastest >= (1 - BEYOND_SLEW) * slew:
        return []
    step = int(plan.real_intervals.argmin()) + 1
    speeds = (speed_from_interval(each, design.timer.frequency_hz) for each in (fastest, slew))
    speed, allowed = (Told.of(each, "steps/s") for each in speeds)
    message = (
        f"Step {step:,} runs at {speed}, beyond the ramp's highest speed of {allowed}: "
        f"there the method's own error is that large. {METHODS[REFERENCE].label} keeps to it."
    )
    return [TimerWarning("method.name", message, (speed, allowed))]


def _no_ramp(design: Design, plan: Plan) -> list[TimerWarning]:
    """Warn of a side that has no step, by (16): one would be more than leads from the base to the slew speed."""
    base, slew, slopes = design.ramp.base_speed_steps_per_s, design.ramp.slew_speed_steps_per_s, full_slopes_of(design)
    is_lowered = peak_of(design) is not None
    sizes = [slope.steps for slope in slopes] if is_lowered else [plan.ramp.up.size, plan.ramp.down.size]
    if all(sizes) or design.method.plays_table or base == slew:
        return []
    warnings = []
    for field, slope, size in zip(SIDES, slopes, sizes, strict=True):
        rate = getattr(design.ramp, field)
        if rate is None or size:
            continue
        most = slope.acceleration_over(1)
        # How a ramp goes on beyond its slew speed only constant acceleration says.
        goes_on = isinstance(slope, ConstantAcceleration)
        reached = float(slope.speeds(1, 1, np.float64)[0]) if goes_on else slew
        is_above = reached > slew
        own, speed = Told.of(rate, "steps/s²"), Told.of(reached, "steps/s")
        gentler, faster = told_highest(most, "steps/s²"), told_lowest(reached, "steps/s")
        why = f"a single step would reach {speed}, above the slew speed" if is_above else _LESS_THAN_A_STEP
        ways = [f"at most {gentler}"] if most >= LEAST_ACCELERATION else []
        ways += [f"a slew speed of at least {faster}"] if is_above else []
        advice = f" Use {', or '.join(ways)}." if ways else ""
        told = [own] + [speed] * is_above + [gentler] * (most >= LEAST_ACCELERATION) + [faster] * is_above
        warnings.append(TimerWarning(f"ramp.{field}", f"At {own} {why}: there is no ramp.{advice}", tuple(told)))
    return warnings
