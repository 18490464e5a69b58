"""Whether a motor makes the design's move: what its rotor does, why it stalls, and what to change."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.motor.bounds import refuse_too_long
from stepramp.motor.demand import demands_of
from stepramp.motor.limits import greatest_start_speed, required_nm, resonances
from stepramp.motor.origins import torque_is_measured
from stepramp.motor.torque import drive_train
from stepramp.motor.train import Run, Swing, run_of, swing_of
from stepramp.numerics.drive_train import DriveTrain
from stepramp.ramp.profile import Profile, profile_of

Verdict = Literal["safe", "marginal", "stalls"]
Cause = Literal["start", "onset", "top_speed", "resonance", "timer", "stop"]
Evidence = Literal["no_torque", "measured_torque", "lost_steps", "load_angle", "torque"]
"""What shows it: torque that the motor doesn't have, at all or as it was measured; a rotor that loses steps, or is
close to it; or more of the torque than leaves a margin."""

DAMPINGS = (0.02, 0.05, 0.1)
"""ζ: the least-known number of the model, so the move is played with all of them."""
USUAL_DAMPING = DAMPINGS[1]
MOST_USED = 0.6
"""Of the pull-out torque: 40 % of it are kept back for what the model doesn't know."""
ROUNDING = 0.02
"""A ramp shaped for just so much comes this close to it, by rounding to ticks and whole steps."""
LAST_BITS = 1e-9
"""Of a share of the torque: what computing it loses."""
LARGE_ANGLE_DEG = 90.0
"""Beyond it the motor pulls less the farther it is behind; a pulse takes the field a step farther at once."""
ONSET_PERIODS = 2.0
"""So long after the beginning a step that is lost is lost to how the move begins."""


@dataclass(frozen=True)
class Outcome:
    """A design's move, played through the model with each damping."""

    train: DriveTrain
    profile: Profile
    runs: dict[float, Run]
    most_used: float
    """The largest share of the pull-out torque that the ramp asks for; inf: it asks where there is none."""
    most_used_on: Literal["up", "down", "slew"]
    most_used_at: float
    """Speed where that is [steps/s]."""
    is_timers_fault: bool
    """Whether it is rounding to ticks that loses steps: the same move in real numbers loses none."""
    is_measured: bool
    """Whether it was measured what pull-out torque the motor has."""

    @property
    def verdict(self) -> Verdict:
        """stalls: without the torque, or with a usual damping or more. marginal: with little damping, or little margin.

        What was measured of the torque counts, whatever the rotor does; what is computed of it is the rotor's affair.
        """
        lacks_torque = self.evidence in ("no_torque", "measured_torque")
        if lacks_torque or any(run.first_lost_step for damping, run in self.runs.items() if damping >= USUAL_DAMPING):
            return "stalls"
        return "safe" if self.evidence is None else "marginal"

    @property
    def evidence(self) -> Evidence | None:
        """What shows that the move isn't safe, the strongest; None where it is."""
        lacking = _lacking(self.most_used, self.is_measured)
        if lacking is not None:
            return lacking
        if any(run.first_lost_step for run in self.runs.values()):
            return "lost_steps"
        if _is_close(self.runs[USUAL_DAMPING], self.train) or not all(run.is_held for run in self.runs.values()):
            return "load_angle"
        return "torque" if self.most_used > MOST_USED + ROUNDING else None

    @property
    def worst(self) -> Run:
        """The run that the verdict is of: the usual one, unless only another loses steps, with the largest damping."""
        return self.runs[_worst(self.runs)]

    @property
    def lost_full_steps(self) -> int:
        """4 · round(φ / 2π) of two phases [full steps]; less than 0: the motor is ahead."""
        return round(self.worst.lost_periods / self.train.periods_per_full_step)

    def speed_ripple(self, run: Run) -> float | None:
        """Return how far a run's speed is from the slew speed at most, in parts of it; None: there is no slew phase."""
        slew = next((phase for phase in self.profile.phases if phase.name == "slew"), None)
        if slew is None:
            return None
        at = slice(slew.first_step - 1, slew.last_step)
        return float(np.abs(run.speeds[at] / self.profile.speed_steps_per_s[at] - 1).max())

    @cached_property
    def intervals_s(self) -> NDArray[np.float64]:
        """The move's intervals [s], shape (N,)."""
        return self.profile.intervals_ticks / self.profile.timer_hz


def outcome_of(design: Design, is_wanted: Callable[[], bool] = lambda: True) -> Outcome:
    """Return what the motor does with the design's move.

    Raises Rejected as profile_of does, without a motor, and as refuse_too_long does; NotWanted as run_of does.
    """
    train, profile, intervals_s = _playable(design)
    directed = train if profile.direction > 0 else _backwards(train)
    runs = {damping: run_of(directed, intervals_s, damping, is_wanted=is_wanted) for damping in DAMPINGS}
    worst = _worst(runs)
    is_timers_fault = False
    if runs[worst].first_lost_step:
        real_s = profile.plan.real_intervals / profile.timer_hz
        is_timers_fault = not swing_of(directed, real_s, worst, is_wanted).first_lost_step
    used = _most_used(design, train, profile)
    return Outcome(train, profile, runs, *used, is_timers_fault, torque_is_measured(design))


def verdict_of(design: Design, is_wanted: Callable[[], bool] = lambda: True, *, margin: float = MOST_USED) -> Verdict:
    """Return the verdict of outcome_of, playing no more than decides it: a map asks for thousands. Raises the same.

    A step that is lost ends it, and with the least damping it is played only where nothing else is found. margin: of
    the pull-out torque, what asks for more is marginal.
    """
    train, profile, intervals_s = _playable(design)
    most_used, *_ = _most_used(design, train, profile)
    if _lacking(most_used, torque_is_measured(design)) is not None:
        return "stalls"
    directed = train if profile.direction > 0 else _backwards(train)

    def swing(damping: float) -> Swing:
        return swing_of(directed, intervals_s, damping, is_wanted)

    usual = swing(USUAL_DAMPING)
    damped = [] if usual.first_lost_step else [swing(damping) for damping in DAMPINGS if damping > USUAL_DAMPING]
    if usual.first_lost_step or any(each.first_lost_step for each in damped):
        return "stalls"
    is_little = most_used > margin + ROUNDING
    if is_little or _is_close(usual, train) or not all(each.is_held for each in damped):
        return "marginal"
    least = (swing(damping) for damping in DAMPINGS if damping < USUAL_DAMPING)
    return "marginal" if any(each.first_lost_step or not each.is_held for each in least) else "safe"


def _playable(design: Design) -> tuple[DriveTrain, Profile, NDArray[np.float64]]:
    """Return what is played of a design: its drive train, its profile and the profile's intervals [s]."""
    train, profile = drive_train(design), profile_of(design)
    refuse_too_long(design, profile.plan.real)
    return train, profile, profile.intervals_ticks / profile.timer_hz


def _worst(runs: dict[float, Run]) -> float:
    lost = [damping for damping, run in runs.items() if run.first_lost_step]
    return USUAL_DAMPING if USUAL_DAMPING in lost else max(lost, default=USUAL_DAMPING)


def _lacking(most_used: float, is_measured: bool) -> Evidence | None:
    """Return how it is known, whatever the model's rotor does, that the motor lacks the torque; None: it isn't."""
    if np.isinf(most_used):
        return "no_torque"
    # Where it was seen to stall it stalls again.
    return "measured_torque" if is_measured and most_used > 1 - LAST_BITS else None


def _is_close(swing: Swing, train: DriveTrain) -> bool:
    """Tell whether the rotor was nearly lost, or isn't held as long as it is watched."""
    large_deg = LARGE_ANGLE_DEG + 360 * train.periods_per_full_step / train.steps_per_full_step
    return swing.largest_load_angle_deg > large_deg or not swing.is_held


def cause_of(outcome: Outcome) -> Cause | None:
    """Return what the verdict comes of; None where it is safe."""
    if outcome.verdict == "safe":
        return None
    run, lacks_torque = outcome.worst, outcome.evidence in ("no_torque", "measured_torque")
    if not run.first_lost_step or (lacks_torque and outcome.is_timers_fault):
        return _cause_of_little_torque(outcome)
    if outcome.is_timers_fault:
        return "timer"
    step = run.first_lost_step
    phase = next(each.name for each in outcome.profile.phases if each.first_step <= step <= each.last_step)
    speed = float(outcome.profile.speed_steps_per_s[step - 1])
    if phase == "decelerate" or run.is_lost_at_end:
        return "stop"
    time_s = float(outcome.profile.time_s[step - 1])
    if time_s <= ONSET_PERIODS / outcome.train.natural_frequency_hz:
        return "start" if _starts_too_fast(outcome) else "onset"
    is_in_band = any(low <= speed <= high for low, high in resonances(outcome.train))
    enough = 1 if is_in_band else MOST_USED + ROUNDING
    return "resonance" if outcome.most_used <= enough else "top_speed"


def _cause_of_little_torque(outcome: Outcome) -> Cause:
    run = outcome.worst
    if outcome.most_used <= MOST_USED + ROUNDING:
        worst = int(np.abs(run.load_angles_deg).argmax())
        if outcome.profile.time_s[worst] <= ONSET_PERIODS / outcome.train.natural_frequency_hz:
            return "start" if _starts_too_fast(outcome) else "onset"
        return "resonance"
    if outcome.most_used_on == "down":
        return "stop"
    is_slow = outcome.most_used_at <= outcome.profile.peak_speed_steps_per_s / 2
    return "onset" if outcome.most_used_on == "up" and is_slow else "top_speed"


def _starts_too_fast(outcome: Outcome) -> bool:
    base = float(outcome.profile.speed_steps_per_s[0])
    return base > MOST_USED * greatest_start_speed(outcome.train)


def _backwards(train: DriveTrain) -> DriveTrain:
    """Return the train as a move backwards has it: the same forwards, with the load on the other side."""
    return replace(train, load_nm=-train.load_nm)


def _most_used(
    design: Design, train: DriveTrain, profile: Profile
) -> tuple[float, Literal["up", "down", "slew"], float]:
    peak = profile.peak_speed_steps_per_s
    places: list[tuple[Literal["up", "down", "slew"], NDArray[np.float64], NDArray[np.float64]]] = [
        ("slew", np.array([peak]), required_nm(train, np.zeros(1)))
    ]
    places += [(each.side, each.speeds, each.torques_nm) for each in demands_of(design, train, peak * (1 + ROUNDING))]
    shares = []
    for name, speeds, asked in places:
        if speeds.size:
            available = train.pull_out_nm(speeds * train.radians_per_step)
            # Where the motor has nothing, nothing is too much, too.
            used = np.divide(asked, available, out=np.full(asked.shape, np.inf), where=available > 0)
            worst = int(used.argmax())
            shares.append((float(used[worst]), name, float(speeds[worst])))
    return max(shares)
