"""What isn't played through a motor's model, since that would take too many steps of the integration.

Each refusal names what would do: as many steps of the move as fit, or of the motor's figures one with which its fastest
oscillation is slow enough. What is named was tried.
"""

import math
from collections.abc import Callable
from functools import cached_property, partial

from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.motor.step_width import LONGEST_STEP_S, integration_step_s, settling_steps
from stepramp.motor.torque import drive_train
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.limit_text import highest, lowest
from stepramp.numerics.ramp import RealRamp
from stepramp.ramp.move import split
from stepramp.ramp.plan import real_ramp
from stepramp.units import us_from_ticks

MOST_STEPS = 10_000_000
"""Steps of the integration for a move, besides one for each pulse, and for what follows its end."""
LONGEST_S = MOST_STEPS * LONGEST_STEP_S
"""Longest move that is played [s]: 200 s, where no oscillation needs shorter steps."""
MOST_SETTLING_STEPS = MOST_STEPS // 4
"""For as long as a rotor is watched at least; one that isn't held then is watched four times as long."""
TRIES = 16
"""So many lengths of a move that is too long are tried, of those that have no slew phase to be shortened."""
FIGURES = 4
CURES: dict[str, tuple[float, str]] = {
    "rotor_inertia_g_cm2": (1e8, "g·cm²"),
    "rated_current_a": (100.0, "A"),
    "inductance_mh": (10_000.0, "mH"),
    "holding_torque_nm": (1e-6, "Nm"),
    "detent_torque_nm": (0.0, "Nm"),
}
"""Figures of a motor: as far as each may go to where the oscillations become slower, and its unit."""


class TooLong(Rejected):
    """A move that isn't played through the motor's model.

    What would do instead is looked for when somebody reads it: a map meets thousands of such moves.
    """

    def __init__(self, design: Design, real: RealRamp) -> None:
        self._refused, self.more = (design, real), 0

    @cached_property
    def rejections(self) -> tuple[Rejection, ...]:  # type: ignore[override]  # set in the other kinds
        """Which value it is, and what is allowed."""
        return _why(*self._refused).rejections

    def __str__(self) -> str:
        return "\n".join(rejection.message for rejection in self.rejections)


def refuse_too_long(design: Design, real: RealRamp) -> None:
    """Refuse a move that isn't played through the motor's model. real: the design's ramp. Raises TooLong."""
    train = drive_train(design)
    if settling_steps(train) > MOST_SETTLING_STEPS or _duration_s(design, real) > _longest_s(train):
        raise TooLong(design, real)


def _why(design: Design, real: RealRamp) -> Rejected:
    """Return why a move is too long: what is named instead was tried."""
    train = drive_train(design)
    duration_s, longest_s = _duration_s(design, real), _longest_s(train)
    most = _most_steps(design, real, duration_s, longest_s) if settling_steps(train) <= MOST_SETTLING_STEPS else 0
    if most:
        allowed = (1, most) if design.move.steps > 0 else (-most, -1)
        note = f", so that the move takes at most {longest_s:.3g} s: so long it is played through the motor's model"
        return Rejected([Rejection.outside("move.steps", design.move.steps, Limits(*allowed, "steps", True, note))])
    first = _with_steps(design, 1)
    return _unresolved(design, train, _duration_s(first, real_ramp(first)))


def _longest_s(train: DriveTrain) -> float:
    return MOST_STEPS * integration_step_s(train)


def _duration_s(design: Design, real: RealRamp) -> float:
    """Return how long the design's move takes before its intervals are rounded [s]."""
    steps = abs(design.move.steps)
    n_up, n_down = split(real, steps)
    ramps = float(real.up[:n_up].sum(dtype=float)) + float(real.down[:n_down].sum(dtype=float))
    return (ramps + (steps - n_up - n_down) * real.slew) / design.timer.frequency_hz


def _most_steps(design: Design, real: RealRamp, duration_s: float, longest_s: float) -> int:
    """Return how many steps a move may have that isn't too long; 0: not one."""

    def is_played(steps: int) -> bool:
        shorter = _with_steps(design, steps)
        return _duration_s(shorter, real_ramp(shorter)) <= longest_s

    steps = abs(design.move.steps)
    shorter = steps - math.ceil((duration_s - longest_s) / real.slew * design.timer.frequency_hz)
    if shorter >= real.up.size + real.down.size and shorter >= 1 and is_played(shorter):
        return shorter
    if not is_played(1):
        return 0
    low, high = 1, steps
    for _ in range(TRIES):
        middle = math.isqrt(low * high)
        low, high = (middle, high) if is_played(middle) else (low, middle)
    return low


def _with_steps(design: Design, steps: int) -> Design:
    signed = int(math.copysign(steps, design.move.steps))
    return design.model_copy(update={"move": design.move.model_copy(update={"steps": signed})})


def _unresolved(design: Design, train: DriveTrain, duration_s: float) -> Rejected:
    """Return why not even one step is played that takes so long: a figure of the motor, or the step itself."""
    if duration_s > LONGEST_S:
        return _too_slow(design)
    motor = design.motor
    assert motor is not None  # without one there is no drive train

    def is_played(field: str, value: float) -> bool:
        # No k need fit what was measured: the rotor doesn't feel it.
        other = motor.model_copy(update={"stalled": None, field: value})
        changed = drive_train(design.model_copy(update={"motor": other}))
        return duration_s <= _longest_s(changed) and settling_steps(changed) <= MOST_SETTLING_STEPS

    note = ": else an oscillation of the model is so fast that it takes too long to be played"
    for field, (end, unit) in CURES.items():
        own = getattr(motor, field)
        value = train.detent_nm if own is None else own
        limit = _border(value, end, partial(is_played, field))
        if limit is not None:
            limits = Limits(limit, None, unit, note=note) if end > value else Limits(None, limit, unit, note=note)
            return Rejected([Rejection.outside(f"motor.{field}", own, limits)])
    allowed = "another motor: of this one an oscillation is so fast that it takes too long to be played"
    return Rejected([Rejection("motor", motor.model_dump(exclude_unset=True), allowed)])


def _too_slow(design: Design) -> Rejected:
    """Return what makes a single step last longer than what is played."""
    note = f": a step may take {LONGEST_S:g} s, so long it is played through the motor's model"
    ramp, table = design.ramp, design.table
    if design.method.plays_table and table is not None:
        ticks, unit = LONGEST_S * design.timer.frequency_hz, "ticks"
        if table.interval_unit == "us":
            ticks, unit = us_from_ticks(ticks, design.timer.frequency_hz), "µs"
        limits = Limits(1, math.floor(ticks), unit, True, note)
        return Rejected([Rejection.outside("table.rows.0.1", table.rows[0][1], limits)])
    slowest = lowest(1 / LONGEST_S)
    if ramp.slew_speed_steps_per_s < slowest:
        limits = Limits(slowest, None, "steps/s", note=note)
        return Rejected([Rejection.outside("ramp.slew_speed_steps_per_s", ramp.slew_speed_steps_per_s, limits)])
    field = "ramp.acceleration_steps_per_s2"
    return Rejected([Rejection(field, ramp.acceleration_steps_per_s2, f"more, with this shape{note}")])


def _border(value: float, end: float, is_allowed: Callable[[float], bool]) -> float | None:
    """Return from which value on, on the way to the end, it is allowed, rounded to that side; None: nowhere."""
    if not is_allowed(end):
        return None
    refused, allowed = value, end
    while not math.isclose(refused, allowed, rel_tol=10**-FIGURES):
        # Far from the end a figure is halved, or doubled; the end may be 0.
        middle = math.sqrt(refused * allowed) if allowed > 0 else refused / 2
        if middle in (refused, allowed) or middle < 1e-12:
            break
        refused, allowed = (refused, middle) if is_allowed(middle) else (middle, allowed)
    rounded = (lowest if end > value else highest)(allowed, FIGURES)
    return rounded if is_allowed(rounded) else allowed
