"""Playback of the ramps that an image holds, whether they are stored or computed."""

from stepramp.controllers.stepramp.formula_constants import decode_formula
from stepramp.controllers.stepramp.formula_image import encode_formula
from stepramp.controllers.stepramp.ramp_image import ANY_INTERVAL, AxisRamp, FormulaRamp
from stepramp.design import Design
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.on_chip import OnChipMotor, OnChipRamp, design_refusal, on_chip_ramp
from stepramp.ramp.playback.formula import FormulaPlayback
from stepramp.ramp.playback.lists import ListPlayback
from stepramp.ramp.playback.trajectory import Playback
from stepramp.ramp.segments import expand


def playback_of(ramp: AxisRamp) -> Playback:
    """Return the playback of a ramp."""
    return FormulaPlayback(_on_chip(ramp)) if isinstance(ramp, FormulaRamp) else ListPlayback(unpacked(ramp))


def unpacked(ramp: AxisRamp) -> Ramp:
    """Return the intervals that a ramp stands for in a move of full length, in ticks of the controller."""
    if isinstance(ramp, FormulaRamp):
        known = _on_chip(ramp)
        motor = OnChipMotor(known)
        up, down = motor.up(known.up.steps), motor.down(known.down.steps)
        return Ramp(up, known.slew_interval, down[::-1])
    up = expand(ramp.up)
    return Ramp(up, ramp.slew_interval_ticks, up if ramp.down == ramp.up else expand(ramp.down))


def formula_ramp(design: Design, limits: range) -> FormulaRamp | None:
    """Return a design's ramp as a controller computes it, if it can, with intervals within limits [ticks]."""
    if design_refusal(design) is not None:
        return None
    ramp = on_chip_ramp(design)
    inside = ramp.slew_interval in limits and ramp.creep_interval in limits
    return FormulaRamp(encode_formula(ramp)) if inside else None


def _on_chip(ramp: FormulaRamp) -> OnChipRamp:
    whole = ANY_INTERVAL.by_formula(fast_clock=True)
    return decode_formula(ramp.constants, whole)
