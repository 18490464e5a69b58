"""Designs of what a module has told as a backup."""

from stepramp.controllers.read_axis import GAIN, SPEED, ReadAxis, design_read, with_notes
from stepramp.controllers.remark import Remark, quantity
from stepramp.controllers.tmcl.backup import Backup
from stepramp.controllers.tmcl.ramp import TmclRamp
from stepramp.controllers.tmcl.units import Units
from stepramp.design import Design

MOST_AXES_READ = 4
FULL_STEPS = 202
"""The axis parameter with the full steps of a turn."""


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a backup; [] for a text that is none.

    base: what holds where a module says nothing, as motor, timer and method.
    Raises Rejected for settings that no design can have.
    """
    backup = Backup.of(text)
    if backup is None:
        return []
    axes = []
    for axis in sorted(backup.settings)[:MOST_AXES_READ]:
        ramp, units = backup.ramp(axis), backup.units(axis)
        if ramp is not None and units is not None:
            axes.append(_axis(axis, ramp, units, backup, base))
    return with_notes(axes, [f"{name} = {told} are listed: the last holds." for name, told in backup.twice.items()])


def _axis(axis: int, ramp: TmclRamp, units: Units, backup: Backup, base: Design) -> ReadAxis:
    settings = backup.settings[axis]
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"{backup.module.name} axis {axis}"
    if (resolution := settings.get(backup.module.parameters.resolution)) is not None:
        document["axis"]["microsteps"] = 1 << max(0, min(resolution, 8))
    if full_steps := settings.get(FULL_STEPS):
        document["axis"]["full_steps_per_rev"] = full_steps
    gain, loss = (float(units.acceleration_again(rate) * units.acceleration) for rate in (ramp.amax, ramp.dmax))
    document["ramp"] = {
        "base_speed_steps_per_s": float(ramp.vstart * units.speed),
        "slew_speed_steps_per_s": float(ramp.vmax * units.speed),
        "acceleration_steps_per_s2": gain,
        "deceleration_steps_per_s2": None if loss == gain else loss,
    }
    made_of = {
        "ramp.base_speed_steps_per_s": f"VSTART {ramp.vstart}",
        SPEED: f"VMAX {ramp.vmax}",
        GAIN: f"AMAX {ramp.amax}",
        "ramp.deceleration_steps_per_s2": f"DMAX {ramp.dmax}",
        "axis.full_steps_per_rev": f"parameter {FULL_STEPS} {full_steps}",
    }
    design = design_read(document, f"axis {axis}", made_of)
    return ReadAxis(str(axis), design, tuple(_remarks(ramp, units)))


def _remarks(ramp: TmclRamp, units: Units) -> list[str]:
    """Return what is not as the module has it."""
    remarks = ["What a turn moves is not told: the design's own stays."]
    if ramp.v1:
        remarks.append(
            Remark(
                "Up to V1, ",
                quantity(float(ramp.v1 * units.speed), "steps/s"),
                ", the module has accelerations of their own (A1, D1): the design has those above.",
            )
        )
    return remarks
