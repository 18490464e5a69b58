"""What the routes about motors take and answer."""

from typing import Annotated, Self

import numpy as np
from pydantic import Field

from stepramp.design import Design, Row, Table
from stepramp.errors import Remedy
from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.http_api.error_items import ChangeAnswer, RemedyAnswer
from stepramp.http_api.planning_models import MostPoints
from stepramp.motor.asked import SpeedsAsked
from stepramp.motor.gauge_rows import USUAL_SHARE, GaugeRow
from stepramp.motor.limits import SMOOTH, SUDDEN, greatest_acceleration, greatest_start_speed, resonances
from stepramp.motor.origins import NOT_COVERED, Origin, assumed_of, origins_of
from stepramp.motor.torque import TorqueCurve, Torques, torque_curve_of
from stepramp.motor.train import Run
from stepramp.motor.verdict import USUAL_DAMPING, Cause, Evidence, Outcome, Verdict, cause_of
from stepramp.numerics.drive_train import DriveTrain
from stepramp.ramp.thinning import kept_steps
from stepramp.units import g_cm2_from_kg_m2
from stepramp.validation import Document, Within

NOISE = 1e-9
"""What a speed loses on its way through rad/s."""


class TorquePayload(SpeedsAsked):
    """A design with its motor, and speeds."""

    design: Design


class TorqueAnswer(Answer):
    """Both torques at each of the speeds."""

    pull_out_nm: Numbers = Field(description="What the motor has with its drive [Nm]")
    required_nm: Numbers = Field(
        description="What the design's ramp asks for, with load and friction: of its two sides the larger [Nm]"
    )

    @classmethod
    def of(cls, torques: Torques) -> Self:
        """Return torques as an answer."""
        return cls(pull_out_nm=torques.pull_out_nm, required_nm=torques.required_nm)


class SimulatePayload(Document):
    """A design with its motor, whose move is played through the motor's model."""

    design: Design
    max_points: MostPoints = 2000
    with_proposals: bool = Field(
        True, description="Whether to look for what to change, which takes some tenths of a second, at most 3 s"
    )


class RunAnswer(Answer):
    """What the rotor does with one damping."""

    damping: float = Field(description="ζ, relative to the field")
    lost_full_steps: int = Field(description="How far it is behind at the end [full steps]")
    first_lost_step: int | None = Field(
        description="Pulse after which the first is lost, counted from 1; null: none is"
    )
    largest_load_angle_deg: float = Field(description="How far the field leads at most [electrical °]; 90: a full step")
    speed_ripple: float | None = Field(
        description="The largest deviation of its speed at slew speed, in parts of it; null: the move has no slew phase"
    )
    overshoot_deg: float = Field(description="How far it swings beyond its end [electrical °]")
    settled_after_s: float = Field(
        description="From the end of the last interval until it stays at its end [s]; 12/f_n: not by then"
    )


class LoadAngleAnswer(Answer):
    """What the rotor does along the move with a usual damping, one value a step, thinned to max_points."""

    step: WholeNumbers = Field(description="Counted from 1")
    time_s: Numbers = Field(description="Instant of the step's pulse [s]")
    load_angle_deg: Numbers = Field(description="The largest while the step lasts, with its sign [electrical °]")
    speed_steps_per_s: Numbers = Field(description="Mean speed of the rotor while the step lasts [steps/s]")


class TorqueCurveAnswer(Answer):
    """Both torques over the speed."""

    speed_steps_per_s: Numbers = Field(description="[steps/s]")
    speed_rpm: Numbers = Field(description="The same of the motor's shaft [rpm]")
    pull_out_nm: Numbers = Field(description="[Nm]")
    required_nm: Numbers = Field(description="[Nm]")

    @classmethod
    def of(cls, curve: TorqueCurve) -> Self:
        """Return both torques over the speed as an answer."""
        return cls(
            speed_steps_per_s=curve.speeds,
            speed_rpm=curve.rpm,
            pull_out_nm=curve.torques.pull_out_nm,
            required_nm=curve.torques.required_nm,
        )


class ShaftAnswer(Answer):
    """What the motor's shaft feels, of the load's figures and of its mechanism together."""

    inertia_g_cm2: float = Field(description="J of rotor and load [g·cm²]")
    torque_nm: float = Field(description="T_L: constant, against forward motion; negative: with it [Nm]")
    friction_nm: float = Field(description="T_c: against any motion [Nm]")

    @classmethod
    def of(cls, train: DriveTrain) -> Self:
        """Return what the shaft of a drive train feels."""
        inertia = g_cm2_from_kg_m2(train.inertia_kg_m2)
        return cls(inertia_g_cm2=inertia, torque_nm=train.load_nm, friction_nm=train.friction_nm)


class SimulateAnswer(Answer):
    """Whether the motor makes the move, why not, and what to change."""

    verdict: Verdict = Field(
        description="stalls: steps are lost with a usual damping, or the torque is lacking, at all or as it was "
        "measured. marginal: steps are lost with little damping, the load angle is over 90°, or less than 40 % of the "
        "torque is kept back. Else safe"
    )
    cause: Cause | None = Field(description="What it comes of; null where it is safe")
    evidence: Evidence | None = Field(
        description="What shows it, the strongest: no_torque: the ramp asks for torque where the motor has none. "
        "measured_torque: it asks for more than was measured (motor.stalled, motor.torque_curve), whatever the model's "
        "rotor does. lost_steps: the rotor loses some. load_angle: it is over 90° from the field, or swings for "
        "long. torque: less than 40 % is kept back. null where it is safe"
    )
    lost_full_steps: int = Field(description="How far the rotor is behind at the end [full steps]")
    first_lost_step: int | None = Field(
        description="Pulse after which the first is lost, counted from 1; null: none is"
    )
    largest_load_angle_deg: float = Field(description="How far the field leads at most [electrical °]")
    most_used: float | None = Field(
        description="The largest part of the pull-out torque that the ramp asks for; null: it asks where there is none"
    )
    most_used_at_steps_per_s: float = Field(description="Speed where that is [steps/s]")
    natural_frequency_hz: float = Field(description="f_n of the rotor with its load [Hz]")
    greatest_start_speed_steps_per_s: float = Field(description="To which it can start at once [steps/s]")
    greatest_sudden_acceleration_steps_per_s2: float = Field(description="That may come all at once [steps/s²]")
    greatest_smooth_acceleration_steps_per_s2: float = Field(
        description="With an onset of one period of f_n [steps/s²]"
    )
    resonances_steps_per_s: list[tuple[float, float]] = Field(description="Bands of speed: from, to [steps/s]")
    shaft: ShaftAnswer
    runs: list[RunAnswer] = Field(description="The move with each damping, the least first")
    rotor: LoadAngleAnswer
    torque: TorqueCurveAnswer
    proposals: list[RemedyAnswer] = Field(
        description="Changes with each of which the move is safe; the first the mildest"
    )
    assumed: list[str] = Field(description="Paths of what the design leaves open: a usual value stands for it")
    origins: dict[str, Origin] = Field(
        description="Where each number of motor, drive and load comes from, by its path. measured: a stall point or a "
        "curve. datasheet: of the nearest preset's maker. given: typed, from wherever. assumed: a usual value, or one "
        "that the maker doesn't tell. unused: told, and something else counts. What means none isn't here"
    )
    not_covered: str = Field(description="What the model knows nothing of")

    @classmethod
    def of(cls, design: Design, outcome: Outcome, proposals: list[Remedy], most_points: int | None) -> Self:
        """Return what was found as an answer."""
        train, worst = outcome.train, outcome.worst
        return cls(
            verdict=outcome.verdict,
            cause=cause_of(outcome),
            evidence=outcome.evidence,
            lost_full_steps=outcome.lost_full_steps,
            first_lost_step=worst.first_lost_step or None,
            largest_load_angle_deg=worst.largest_load_angle_deg,
            most_used=outcome.most_used if np.isfinite(outcome.most_used) else None,
            most_used_at_steps_per_s=outcome.most_used_at,
            natural_frequency_hz=train.natural_frequency_hz,
            greatest_start_speed_steps_per_s=greatest_start_speed(train),
            greatest_sudden_acceleration_steps_per_s2=greatest_acceleration(train, SUDDEN),
            greatest_smooth_acceleration_steps_per_s2=greatest_acceleration(train, SMOOTH),
            resonances_steps_per_s=resonances(train),
            shaft=ShaftAnswer.of(train),
            runs=[_run(outcome, damping, run) for damping, run in outcome.runs.items()],
            rotor=_rotor(outcome, most_points),
            torque=TorqueCurveAnswer.of(torque_curve_of(design)),
            proposals=[RemedyAnswer.model_validate(each) for each in proposals],
            assumed=list(assumed_of(design)),
            origins=origins_of(design),
            not_covered=NOT_COVERED,
        )


def _run(outcome: Outcome, damping: float, run: Run) -> RunAnswer:
    return RunAnswer(
        damping=damping,
        lost_full_steps=round(run.lost_periods / outcome.train.periods_per_full_step),
        first_lost_step=run.first_lost_step or None,
        largest_load_angle_deg=run.largest_load_angle_deg,
        speed_ripple=outcome.speed_ripple(run),
        overshoot_deg=run.overshoot_deg,
        settled_after_s=run.settled_after_s,
    )


def _rotor(outcome: Outcome, most_points: int | None) -> LoadAngleAnswer:
    run, profile = outcome.runs[USUAL_DAMPING], outcome.profile
    kept = np.arange(run.speeds.size)
    if most_points is not None and run.speeds.size > most_points:
        kept = kept_steps(np.round(run.load_angles_deg * 1000).astype(np.int64), profile.phases, most_points)
    return LoadAngleAnswer(
        step=kept + 1,
        time_s=profile.time_s[kept],
        load_angle_deg=run.load_angles_deg[kept],
        speed_steps_per_s=run.speeds[kept],
    )


class GaugeTablePayload(Document):
    """A design with a gauge's motor, and how much of its torque a table may use."""

    design: Design
    share: Annotated[float, Within(0.05, 1, "of the torque")] = Field(
        USUAL_SHARE, description="Of the motor's torque at each speed; makers' tables use about 0.4"
    )


class GaugeTableAnswer(Answer):
    """A lookup table by the rule of gauges' makers."""

    share: float = Field(description="As it was asked for: of the dynamic torque")
    rows: list[Row] = Field(description="[last ramp index [steps], delay [µs]], as those of the design's table")
    speed_steps_per_s: Numbers = Field(description="Of each row, before its delay is rounded [steps/s]")
    reaches_slew_speed: bool = Field(description="Whether the last row is the design's slew speed")
    changes: list[ChangeAnswer] = Field(description="What to put into the design so that it plays the table")

    @classmethod
    def of(cls, design: Design, share: float, rows: list[GaugeRow]) -> Self:
        """Return rows as an answer."""
        table = Table(rows=[(row.last_step, row.delay_us) for row in rows])
        method = design.model_copy(update={"table": table}).with_method("table").method
        return cls(
            share=share,
            rows=table.rows,
            speed_steps_per_s=np.array([row.speed for row in rows]),
            reaches_slew_speed=rows[-1].speed >= design.ramp.slew_speed_steps_per_s * (1 - NOISE),
            changes=[
                ChangeAnswer(field="table", value=table.model_dump()),
                ChangeAnswer(field="method", value=method.model_dump()),
            ],
        )
