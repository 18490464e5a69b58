"""What turns: a motor, what drives it, and what it moves, as parts of a design document.

All of it is optional. What is left open has a default that is said to be one. Formulas, sources: docs/motor.md.
"""

import math
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from stepramp.errors import Limits
from stepramp.mechanism import AtShaft, Mechanism
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.limit_text import highest, lowest
from stepramp.units import henry_from_mh, kg_m2_from_g_cm2, peak_from_rms, rad_per_s_from_rpm
from stepramp.validation import Document, ListOf, Within, is_none, refuse

MOST_CURVE_POINTS = 200
DETENT_PART = 0.04
"""The detent torque where none is given: so much of the holding torque."""
FRICTION_PART = 0.05
"""The friction where none is given: so much of the holding torque."""
PULL_OUT_FACTOR = 0.85
"""k of NEMA 17 and 23 motors: comes within 10 % RMS of published curves of both."""
SUPPLY_V = 24.0
FULL_STEPS = 200

Torque = Annotated[float, Within(0, 1000, "Nm")]
LEAST_TORQUE_NM = 1e-6
SomeTorque = Annotated[float, Within(LEAST_TORQUE_NM, 1000, "Nm")]
Inertia = Annotated[float, Within(0, 1e8, "g·cm²")]
SomeInertia = Annotated[float, Within(1e-6, 1e8, "g·cm²")]
Rpm = Annotated[float, Within(0, 100_000, "rpm")]
CurvePoint = Annotated[tuple[Rpm, Torque], ListOf("two numbers, the speed [rpm] and the torque [Nm]", length=2)]


class Drive(Document):
    """What feeds the motor: a driver that regulates its current."""

    supply_v: Annotated[float, Within(0.5, 1000, "V")] | None = Field(
        None, description=f"Voltage of the supply [V]; null: {SUPPLY_V:g} V, a usual one"
    )
    current_a: Annotated[float, Within(0.001, 200, "A")] | None = Field(
        None, description="A phase, as the driver is set [A]; null: the motor's rated current, as rms"
    )
    current_is: Literal["rms", "peak"] | None = Field(
        None,
        description="Whether current_a is rms, as Trinamic and Klipper set it, or peak, as A4988 and DRV8825 do; "
        "without current_a it doesn't count",
    )

    @model_validator(mode="after")
    def _current_as_what(self) -> Self:
        if self.current_a is not None and self.current_is is None:
            refuse("current_is", None, "'rms' or 'peak', since current_a is given: they differ by 41 %")
        return self

    def counted(self, rated_current_a: float) -> "Supplied":
        """Return what counts of it, told or usual, with a motor rated for a current [A rms]."""
        supply_v = SUPPLY_V if self.supply_v is None else self.supply_v
        if self.current_a is None:
            return Supplied(supply_v, peak_from_rms(rated_current_a))
        is_peak = self.current_is == "peak"
        return Supplied(supply_v, self.current_a if is_peak else peak_from_rms(self.current_a))


@dataclass(frozen=True)
class Supplied:
    """What a motor gets."""

    supply_v: float
    peak_current_a: float
    """Of a phase."""


class StallPoint(Document):
    """Where a motor was seen to stall, and the torque that it was asked for there."""

    rpm: Annotated[float, Within(1, 100_000, "rpm")] = Field(description="Speed at which it stalled [rpm]")
    torque_nm: SomeTorque = Field(description="Torque that was asked for: of load, friction and acceleration [Nm]")


class Motor(Document):
    """A stepper motor, as its datasheet has it."""

    kind: Literal["hybrid", "gauge"] = Field(
        "hybrid", description="hybrid: two phases, 4 full steps an electrical period. gauge: 6 partial steps a period"
    )
    resistance_ohm: Annotated[float, Within(0.01, 10_000, "Ω")] = Field(description="R of one phase [Ω]")
    inductance_mh: Annotated[float, Within(0.01, 10_000, "mH")] = Field(description="L of one phase [mH]")
    holding_torque_nm: SomeTorque = Field(description="With both phases at the rated current [Nm]")
    rated_current_a: Annotated[float, Within(0.001, 100, "A")] = Field(description="A phase, as rated [A]")
    full_steps_per_rev: Annotated[int, Within(4, 10_000, "full steps")] | None = Field(
        None, description="Full steps of a turn of the shaft [full steps]; null: axis.full_steps_per_rev"
    )
    rotor_inertia_g_cm2: SomeInertia = Field(description="Of the rotor alone [g·cm²]")
    detent_torque_nm: Torque | None = Field(
        None, description=f"Without current [Nm]; null: {DETENT_PART:.0%} of the holding torque, a usual one"
    )
    pull_out_factor: Annotated[float, Within(0.05, 1.5, "of the model's torque")] | None = Field(
        None,
        description=f"k: how much of the model's torque the motor has; null: {PULL_OUT_FACTOR:g}, a usual one, which "
        "fits NEMA 17 and 23. With stalled or torque_curve it doesn't count",
    )
    stalled: StallPoint | None = Field(
        None,
        description="A measured point, which k is made to fit; null: none was measured. With torque_curve it doesn't "
        "count",
    )
    torque_curve: Annotated[list[CurvePoint], ListOf("points", most=MOST_CURVE_POINTS, least=2)] | None = Field(
        None,
        description="[speed [rpm], pull-out torque [Nm]], with increasing speeds, in place of the model; null: none",
    )
    measured_with: Drive | None = Field(
        None,
        description="What drove the motor when stalled or torque_curve was measured, where the design's drive is "
        "another; of it what is left open, and null: as the design's drive has it",
        exclude_if=is_none,
    )

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        for number, ((before, _), (rpm, _)) in enumerate(pairwise(self.torque_curve or ()), start=1):
            if rpm <= before:
                refuse(f"torque_curve.{number}.0", rpm, f"more than {before:,.15g} rpm, the speed of the point before")
        return self

    @property
    def is_measured(self) -> bool:
        """Whether there is a point or a curve of it."""
        return self.stalled is not None or self.torque_curve is not None

    def driven_when_measured(self, drive: Drive | None) -> Drive:
        """Return what drove it while it was measured; what isn't told of that is as a design's own drive has it."""
        own, then = drive or Drive(), self.measured_with or Drive()
        current = own if then.current_a is None else then
        told = own if then.supply_v is None else then
        supply_v = SUPPLY_V if told.supply_v is None else told.supply_v
        if current.current_a is None:
            return Drive(supply_v=supply_v, current_a=self.rated_current_a, current_is="rms")
        return Drive(supply_v=supply_v, current_a=current.current_a, current_is=current.current_is)

    def pinned(self, drive: Drive | None) -> Self:
        """Return the motor with what drove it when it was measured, before a design's own drive becomes another one.

        What was measured was measured with one drive: without that it would be fitted anew. As it is where nothing was.
        """
        if not self.is_measured:
            return self
        return self.model_copy(update={"measured_with": self.driven_when_measured(drive)})


class Load(Document):
    """What the motor moves, at its shaft or by a mechanism: what is left out is none, but for the friction."""

    inertia_g_cm2: Inertia = Field(0.0, description="Without the rotor [g·cm²]")
    torque_nm: Annotated[float, Within(-1000, 1000, "Nm")] = Field(
        0.0, description="Constant, against forward motion; negative: with it, as of a weight that sinks [Nm]"
    )
    friction_nm: Torque | None = Field(
        None,
        description=f"Against any motion [Nm]; null: what mechanism.friction_n tells, or else "
        f"{FRICTION_PART:.0%} of the holding torque, a usual one",
    )
    mechanism: Mechanism | None = Field(
        None,
        description="What lies between the shaft and what it moves, felt at the shaft on top of the other fields; "
        "null: nothing",
        exclude_if=is_none,
    )

    @property
    def friction_is_told(self) -> bool:
        """Whether there is a figure for it, so that no usual one stands for it."""
        return self.friction_nm is not None or (self.mechanism is not None and self.mechanism.friction_n is not None)


PERIODS_PER_FULL_STEP = {"hybrid": 1 / 4, "gauge": 1 / 2}
FACTORS = (0.05, 1.5)
"""Within these k lies: beyond them a measurement is of something else."""


def drive_train_of(
    motor: Motor, drive: Drive | None, load: Load | None, steps_per_rev: int, full_steps_per_rev: int = FULL_STEPS
) -> DriveTrain:
    """Return a motor with its drive and its load in SI units; k fits what was measured.

    full_steps_per_rev: of the axis, for a motor that tells none of its own. Refuses, as a validator does, a measured
    point that no k fits: its torque, or its speed where the model has none.
    """
    drive, load = drive or Drive(), load or Load()
    part = PERIODS_PER_FULL_STEP[motor.kind]
    moved = AtShaft() if load.mechanism is None else load.mechanism.at_shaft
    friction = (load.friction_nm or 0.0) if load.friction_is_told else FRICTION_PART * motor.holding_torque_nm
    detent = motor.detent_torque_nm if motor.detent_torque_nm is not None else DETENT_PART * motor.holding_torque_nm
    own_steps = full_steps_per_rev if motor.full_steps_per_rev is None else motor.full_steps_per_rev
    train = DriveTrain(
        **asdict(drive.counted(motor.rated_current_a)),
        resistance_ohm=motor.resistance_ohm,
        inductance_h=henry_from_mh(motor.inductance_mh),
        torque_constant_nm_per_a=motor.holding_torque_nm / (math.sqrt(2) * motor.rated_current_a),
        periods_per_rev=own_steps * part,
        periods_per_full_step=part,
        inertia_kg_m2=kg_m2_from_g_cm2(motor.rotor_inertia_g_cm2 + load.inertia_g_cm2) + moved.inertia_kg_m2,
        detent_nm=detent,
        friction_nm=friction + moved.friction_nm,
        load_nm=load.torque_nm + moved.torque_nm,
        steps_per_rev=steps_per_rev,
        pull_out_factor=PULL_OUT_FACTOR if motor.pull_out_factor is None else motor.pull_out_factor,
        curve=tuple((rad_per_s_from_rpm(rpm), torque) for rpm, torque in motor.torque_curve or ()),
    )
    then = replace(train, **asdict(motor.driven_when_measured(drive).counted(motor.rated_current_a)))
    if motor.torque_curve is not None:
        return train if then == train else replace(train, when_measured=then)
    if motor.stalled is not None:
        return replace(train, pull_out_factor=_fitted_factor(then, motor.stalled))
    return train


def _fitted_factor(train: DriveTrain, stalled: StallPoint) -> float:
    """Return the k with which the pull-out torque goes through a measured point. Refuses as drive_train_of does."""
    modelled = float(train.model_nm(np.array([rad_per_s_from_rpm(stalled.rpm)]))[0])
    low, high = (factor * modelled for factor in FACTORS)
    driven = f"with {train.supply_v:.6g} V and {train.peak_current_a:.4g} A peak"
    if high < LEAST_TORQUE_NM:
        allowed = f"a speed at which the model has torque {driven}: there it has {modelled:.4g} Nm"
        refuse("motor.stalled.rpm", stalled.rpm, allowed)
    low = max(low, LEAST_TORQUE_NM)
    if not low <= stalled.torque_nm <= high:
        why = f": at {stalled.rpm:,.6g} rpm the model has {modelled:.4g} Nm {driven}"
        refuse("motor.stalled.torque_nm", stalled.torque_nm, Limits(lowest(low), highest(high), "Nm", note=why))
    return stalled.torque_nm / modelled
