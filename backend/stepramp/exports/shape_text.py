"""The shape of a ramp in words, for files that people read."""

from collections.abc import Callable

from stepramp.design import Move, RampShape
from stepramp.shapes import SHAPES


def shape_text(shape: RampShape, move: Move, jerk_text: Callable[[float], str]) -> str:
    """Return the shape with its own numbers, and how short moves are planned if that is not as usual.

    jerk_text: a jerk [steps/s³] as it is shown.
    """
    label = SHAPES[shape.name].label or shape.name
    parts = []
    if shape.jerk_steps_per_s3 is not None:
        parts.append(f"jerk {jerk_text(shape.jerk_steps_per_s3)}")
    if shape.deceleration_jerk_steps_per_s3 is not None:
        parts.append(f"down {jerk_text(shape.deceleration_jerk_steps_per_s3)}")
    if shape.points is not None:
        parts.append(f"{len(shape.points)} points")
    if shape.margin is not None:
        parts.append(f"{shape.margin:.0%} of the motor's torque")
    if move.plan == "any_move":
        parts.append("short moves cut out of it")
    return ", ".join([label, *parts])
