"""The rule by which makers of gauge motors make acceleration tables: from each full step to the next.

J (ω_i - ω_(i-1)) ω_i / φ = M(ω_i): over a full step φ, which takes φ / ω_i, the speed grows by what the torque allows.
With ω in °/s and φ = 1° that is J (ω_i - ω_(i-1)) ω_i π/180 = M_d(ω_i). Here M is a share of the motor's torque at that
speed, less load and friction. docs/motor.md.
"""

import math
from dataclasses import dataclass

import numpy as np

from stepramp.design import MOST_MICROSTEPS, MOST_STEPS, MOST_TABLE_ROWS, SLOWEST_STEPS_PER_S, Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.motor.torque import drive_train
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.limit_text import lowest
from stepramp.units import us_from_ticks

USUAL_SHARE = 0.4
"""How much of their motors' dynamic torque makers' published tables use."""


@dataclass(frozen=True)
class GaugeRow:
    """A row of the table."""

    last_step: int
    """Ramp index up to which it holds [steps]."""
    speed: float
    """By the rule [steps/s]."""
    delay_us: int
    """Of a step, rounded up: never faster than the rule has it."""


def gauge_rows_of(design: Design, share: float) -> list[GaugeRow]:
    """Return the rows that lead a gauge's motor from rest to the design's slew speed, one for each full step.

    They end earlier where the torque leaves nothing to gain: where a row would have the delay of the one before it.
    share: of the motor's torque. Raises Rejected without a motor, for one of another kind, where load and friction
    take the whole share or what they leave is next to nothing, and where the axis' steps are no table's.
    """
    train = drive_train(design)
    if design.motor is not None and design.motor.kind != "gauge":
        raise Rejected([Rejection("motor.kind", design.motor.kind, "gauge: it is a rule for gauges' motors")])
    _refuse_longer_steps(design, train)
    available = float(train.pull_out_nm(np.zeros(1))[0])
    if available <= train.holding_back_nm:
        allowed = (
            f"a load that the motor moves: of {available:.3g} Nm load and friction take {train.holding_back_nm:.3g} Nm"
        )
        raise Rejected([Rejection("load", design.load and design.load.model_dump(), allowed)])
    if share * available <= train.holding_back_nm:
        least = train.holding_back_nm / available
        note = ", which moves the load and more"
        raise Rejected([Rejection.outside("share", share, Limits(lowest(least), 1, "of the torque", note=note))])
    rows: list[GaugeRow] = []
    speed, fastest = 0.0, design.ramp.slew_speed_steps_per_s * train.radians_per_step
    for number in range(1, MOST_TABLE_ROWS + 1):
        speed = _next(train, share, speed, fastest)
        steps_per_s = speed / train.radians_per_step
        if steps_per_s < SLOWEST_STEPS_PER_S:
            allowed = f"a load that {share:.0%} of the torque brings to {SLOWEST_STEPS_PER_S:g} steps/s in a full step"
            raise Rejected([Rejection("load", design.load and design.load.model_dump(), allowed)])
        delay_us = math.ceil(us_from_ticks(1, steps_per_s))
        if rows and delay_us >= rows[-1].delay_us:
            break
        last_step = math.floor(number * train.steps_per_full_step)
        if last_step > MOST_STEPS:
            allowed = f"fewer, so that the table ends within {MOST_STEPS:,} steps"
            raise Rejected([Rejection("axis.microsteps", design.axis.microsteps, allowed)])
        rows.append(GaugeRow(last_step, steps_per_s, delay_us))
    return rows


def _refuse_longer_steps(design: Design, train: DriveTrain) -> None:
    """Refuse an axis whose steps are longer than the motor's: no row has part of one."""
    if train.steps_per_full_step >= 1:
        return
    axis = design.axis
    full_steps = train.periods_per_rev / train.periods_per_full_step
    needed = math.ceil(full_steps / axis.full_steps_per_rev)
    note = f": a row is a full step of the motor, of which a turn has {full_steps:g}"
    if needed > MOST_MICROSTEPS:
        limits = Limits(math.ceil(full_steps / MOST_MICROSTEPS), None, "full steps", True, note)
        raise Rejected([Rejection.outside("axis.full_steps_per_rev", axis.full_steps_per_rev, limits)])
    limits = Limits(needed, MOST_MICROSTEPS, "per step", True, note)
    raise Rejected([Rejection.outside("axis.microsteps", axis.microsteps, limits)])


def _next(train: DriveTrain, share: float, before: float, fastest: float) -> float:
    """Return ω_i after ω_(i-1), at most the fastest [rad/s], by halving."""
    full_step = train.steps_per_full_step * train.radians_per_step

    def is_allowed(speed: float) -> bool:
        torque = share * float(train.pull_out_nm(np.array([speed]))[0]) - train.holding_back_nm
        return train.inertia_kg_m2 * (speed - before) * speed <= torque * full_step

    if is_allowed(fastest):
        return fastest
    low, high = before, fastest
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if is_allowed(middle) else (low, middle)
    return low
