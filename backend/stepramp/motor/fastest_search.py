"""The fastest ramp of one shape that a motor makes safely: what its torque allows, and of that what the model makes.

Of constant acceleration and of the S-curve, whose onset takes one natural period, it is the largest acceleration for
which J a + |T_L| + T_c is at most m T_po(ω) at every speed that the move comes to; shaped by torque, m itself says it.
Each is played through the motor's model, and made gentler until the move is safe. docs/motor.md.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.design import LEAST_ACCELERATION, MOST_STEPS, Design
from stepramp.errors import Change, Rejected, Rejection
from stepramp.motor.at_fault import at_fault, refuse_start
from stepramp.motor.changes import reshaping, with_changes
from stepramp.motor.glance import reached_speed
from stepramp.motor.limits import required_nm
from stepramp.motor.patience import Patience
from stepramp.motor.shortened import shortened
from stepramp.motor.torque import drive_train
from stepramp.motor.verdict import MOST_USED, ROUNDING, Outcome, outcome_of, verdict_of
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.limit_text import highest, lowest
from stepramp.ramp.slopes import playable_slopes_of, slopes_of

Shape = Literal["constant", "s_curve", "torque"]
SEARCH_S = 10.0
"""So long is looked for them, all together; what is found until then is told [s]."""
CANDIDATES: tuple[Shape, ...] = ("constant", "s_curve", "torque")

FIGURES = 4
PLACES = 2048
"""Speeds at which the torque is looked at."""
HALVINGS = 48
"""Of the range in which the largest acceleration lies that the torque allows."""
GENTLEST = 1e-4
"""Of the largest acceleration at rest: what even that is too much for is refused."""
GENTLER = 0.7
GENTLEST_PLAYED = 0.03
"""A ramp that isn't safe is made gentler step by step, down to such a part."""
REFINEMENTS = 5
"""So many times it is halved between the last that wasn't and the first that was: to 1.1 %."""
ABOVE_THE_PEAK = 1.02
"""Of the speed that a move comes to: so far a ramp leads that is else too long to be planned."""
BELOW_THE_END = 0.98
"""Of the speed at which no torque is left: so far a ramp shaped by torque leads that needn't come to its slew speed."""


def does(outcome: Outcome, margin: float) -> bool:
    """Tell whether a move will do: a safe one up to the usual margin; beyond it one that loses no step."""
    if outcome.most_used > margin + ROUNDING:
        return False
    if margin <= MOST_USED + ROUNDING:
        return outcome.verdict == "safe"
    return _loses_nothing(outcome)


@dataclass(frozen=True)
class Search:
    """What is looked for: the fastest ramps of a design that use no more than a part of its motor's torque."""

    design: Design
    margin: float
    patience: Patience

    def fastest(self, shape: Shape) -> tuple[Change, ...]:
        """Return what gives the design the fastest ramp of a shape that will do. Raises Rejected where none does."""
        try:
            return self._fastest(shape)
        except Rejected:
            # Whatever else is wrong, that comes first.
            refuse_start(self.design)
            raise

    def _fastest(self, shape: Shape) -> tuple[Change, ...]:
        largest = self._largest_within(shape)

        def made(part: float) -> tuple[Change, ...]:
            if shape == "torque":
                return self._shaped_by_torque(highest(self.margin * part, FIGURES), largest)
            return self._with(shape, max(highest(largest * part, FIGURES), LEAST_ACCELERATION))

        part = _largest_part(lambda part: self._will_do(with_changes(self.design, made(part))))
        if part == 0:
            raise self._fault
        return made(part)

    @property
    def is_slew_beyond(self) -> bool:
        """Whether the part of the torque doesn't do for the slew speed, even without acceleration."""
        slew = np.array([self.design.ramp.slew_speed_steps_per_s])
        return bool(_possible(drive_train(self.design), slew, self.margin)[0] <= 0)

    @cached_property
    def _fault(self) -> Rejected:
        """What keeps even a gentle ramp of constant acceleration from being safe. Raises Rejected: the time is up."""
        self._refuse_without_time()
        gentle = self._with("constant", max(GENTLEST_PLAYED * self._at_rest, LEAST_ACCELERATION))
        found = at_fault(with_changes(self.design, gentle), self._will_do)
        self._refuse_without_time()
        return found

    def _refuse_without_time(self) -> None:
        if self.patience.is_over():
            allowed = f"fewer, of which more can be tried: in {SEARCH_S:g} s no such ramp was found"
            raise Rejected([Rejection("move.steps", self.design.move.steps, allowed)])

    def _will_do(self, design: Design) -> bool:
        """Tell whether a design does, as `does` has it; not where the time is up."""
        if self.patience.is_over():
            return False
        played = shortened(design)
        margin = min(self.margin, MOST_USED)
        verdict = self.patience.within(partial(verdict_of, played, margin=margin))
        if self.margin <= MOST_USED + ROUNDING or verdict != "marginal":
            return verdict == "safe"
        outcome = self.patience.within(partial(outcome_of, played))
        return outcome is not None and does(outcome, self.margin)

    def _with(self, shape: Shape, acceleration: float, margin: float | None = None) -> tuple[Change, ...]:
        """Return what gives the design a ramp of a shape, the same up and down."""
        own: dict[str, object] = {}
        if shape == "s_curve":
            own["jerk_steps_per_s3"] = highest(acceleration * drive_train(self.design).natural_frequency_hz)
        if shape == "torque":
            own["margin"] = self.margin if margin is None else margin
        changes = [Change("ramp.acceleration_steps_per_s2", acceleration)]
        if self.design.ramp.deceleration_steps_per_s2 is not None:
            changes.append(Change("ramp.deceleration_steps_per_s2", None))
        changes += reshaping(self.design, {"name": shape, **own})
        return tuple(changes) if shape == "torque" else (*changes, *self._no_longer_than_planned(changes, acceleration))

    def _no_longer_than_planned(self, changes: list[Change], acceleration: float) -> tuple[Change, ...]:
        """Return what leads a ramp that is too long to be planned to no more than the speed that the move comes to."""
        ramp, steps = self.design.ramp, abs(self.design.move.steps)
        if ramp.slew_speed_steps_per_s**2 <= acceleration * MOST_STEPS:
            return ()  # Half of what is planned, whatever the shape: it needn't be looked at.
        slopes = slopes_of(with_changes(self.design, changes))
        if slopes[0].length <= MOST_STEPS or 2 * slopes[0].length <= steps:
            return ()
        lower = lowest(ABOVE_THE_PEAK * reached_speed(slopes, steps), FIGURES)
        return (Change("ramp.slew_speed_steps_per_s", min(lower, ramp.slew_speed_steps_per_s)),)

    def _largest_within(self, shape: Shape) -> float:
        """Return the largest acceleration of a shape that the torque does for [steps/s²]. Raises Rejected: none."""
        usual, train = self._at_rest, drive_train(self.design)
        if shape == "torque":
            self._shaped_by_torque(self.margin, usual)
            return usual

        def fits(acceleration: float) -> bool:
            return self._fits(with_changes(self.design, self._with(shape, acceleration)), train)

        low, high = max(GENTLEST * usual, LEAST_ACCELERATION), usual
        if not fits(low):
            # Says which speed, which margin or which load leaves no torque.
            playable_slopes_of(with_changes(self.design, self._with("torque", usual)))
            raise self._fault
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if fits(middle) else (low, middle)
        return max(highest(low, FIGURES), LEAST_ACCELERATION)

    @cached_property
    def _at_rest(self) -> float:
        """The largest acceleration that the part of the torque does for at any speed of the ramp [steps/s²]."""
        train, ramp = drive_train(self.design), self.design.ramp
        speeds = np.linspace(ramp.base_speed_steps_per_s, ramp.slew_speed_steps_per_s, PLACES)
        largest = float(_possible(train, speeds, self.margin).max())
        return max(highest(largest, FIGURES), LEAST_ACCELERATION)

    def _shaped_by_torque(self, margin: float, acceleration: float) -> tuple[Change, ...]:
        """Return what gives the design a ramp shaped by torque. Raises Rejected where no torque is left at slew speed.

        But where the move comes to no such speed anyway: then the ramp leads to a lower one.
        """
        changes = self._with("torque", acceleration, margin)
        try:
            playable_slopes_of(with_changes(self.design, changes))
        except Rejected as rejected:
            changes = self._to_a_lower_speed(changes, rejected)
            made = with_changes(self.design, changes)
            if reached_speed(slopes_of(made), abs(made.move.steps)) >= made.ramp.slew_speed_steps_per_s:
                raise
        return changes

    def _to_a_lower_speed(self, changes: tuple[Change, ...], rejected: Rejected) -> tuple[Change, ...]:
        """Return what leads a ramp to less than the slew speed that is refused. Raises Rejected where nothing does."""
        [rejection] = rejected.rejections
        if rejection.field != "ramp.slew_speed_steps_per_s" or not rejection.limits or not rejection.limits.highest:
            raise rejected
        lower = highest(BELOW_THE_END * rejection.limits.highest, FIGURES)
        if lower <= self.design.ramp.base_speed_steps_per_s:
            raise rejected
        made = (*changes, Change("ramp.slew_speed_steps_per_s", lower))
        try:
            playable_slopes_of(with_changes(self.design, made))
        except Rejected as again:
            # Torque is left there, and yet it is a way too long to be planned.
            return self._to_a_lower_speed(changes, again)
        return made

    def _fits(self, design: Design, train: DriveTrain) -> bool:
        """Tell whether a ramp of constant acceleration or an S-curve asks nowhere for more than the margin."""
        slopes = slopes_of(design)
        slope, top = slopes[0], reached_speed(slopes, abs(design.move.steps))
        base, jerk = slope.base_speed, slope.parameters.jerk
        corners = [speed / train.radians_per_step for speed, _ in train.curve]
        speeds = np.unique(np.concatenate((np.linspace(base, top, PLACES), np.clip(corners, base, top))))
        # After a time t from either end of an S-curve the speed has gone j t²/2 and the acceleration is j t.
        to_an_end = np.minimum(speeds - base, slope.slew_speed - speeds)
        accelerations = np.full(speeds.shape, slope.acceleration)
        if np.isfinite(jerk):
            accelerations = np.minimum(accelerations, np.sqrt(2 * jerk * to_an_end))
        available = self.margin * train.pull_out_nm(speeds * train.radians_per_step)
        return bool((required_nm(train, accelerations) <= available).all())


def _loses_nothing(outcome: Outcome) -> bool:
    return outcome.verdict != "stalls" and not any(run.first_lost_step for run in outcome.runs.values())


def _possible(train: DriveTrain, speeds: NDArray[np.float64], margin: float) -> NDArray[np.float64]:
    """Return the accelerations that a part of the torque does for at speeds [steps/s²]."""
    per_step = train.radians_per_step
    torque = margin * train.pull_out_nm(speeds * per_step) - train.holding_back_nm
    allowed: NDArray[np.float64] = torque / train.inertia_kg_m2 / per_step
    return allowed


def _largest_part(will_do: Callable[[float], bool]) -> float:
    """Return the largest part, up to 1, that will do: tried from above, then halved; 0: none does."""
    if will_do(1.0):
        return 1.0
    low = _first_gentle_enough(will_do)
    high = low / GENTLER
    for _ in range(REFINEMENTS if low else 0):
        middle = (low + high) / 2
        low, high = (middle, high) if will_do(middle) else (low, middle)
    return low


def _first_gentle_enough(will_do: Callable[[float], bool]) -> float:
    part = GENTLER
    while part >= GENTLEST_PLAYED:
        try:
            if will_do(part):
                return part
        except Rejected:
            # So little torque doesn't move the load, or so gentle a ramp takes too long: so does what comes next.
            return 0.0
        part *= GENTLER
    return 0.0
