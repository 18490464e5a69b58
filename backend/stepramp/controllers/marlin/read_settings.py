"""Designs of what a Marlin lists after M503."""

import math
from collections.abc import Iterator
from fractions import Fraction

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.marlin.settings import EXTRUDER, AxisSettings, Settings, shared_by
from stepramp.controllers.read_axis import ReadAxis
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a listing; [] for a text that is none.

    base: what holds where Marlin says nothing, as motor, timer and method. An axis with such a design moves as before.
    Raises Rejected for settings that no design can have, and for those in inches.
    """
    settings = Settings.of(text.splitlines())
    axes = settings.axes()
    if axes and settings.is_in_inches:
        raise Rejected([Rejection("text", "G20", "settings in mm (G21)")])
    return [_axis(axis, base) for axis in axes]


def _axis(axis: AxisSettings, base: Design) -> ReadAxis:
    per_mm = float(axis.steps_per_mm)
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"Marlin axis {axis.letter}"
    document["axis"] |= {"travel_per_rev": _neat(base.axis.steps_per_rev / per_mm), "travel_unit": "mm"}
    document["ramp"] = {
        "base_speed_steps_per_s": 0,
        "slew_speed_steps_per_s": _no_less(axis.speed * axis.most_steps_per_mm),
        "acceleration_steps_per_s2": _no_less(axis.effective_acceleration * axis.most_steps_per_mm),
        "deceleration_steps_per_s2": None,
    }
    try:
        design = Design.checked(document)
    except Rejected as error:
        raise Rejected(
            [
                Rejection("text", each.value, f"settings of axis {axis.letter} that a design can have: {each.message}")
                for each in error.rejections
            ]
        ) from error
    return ReadAxis(axis.letter, design, tuple(_remarks(axis, design, base)))


def _remarks(axis: AxisSettings, design: Design, base: Design) -> Iterator[str]:
    yield (
        f"Full steps and microsteps are not told: {base.axis.full_steps_per_rev:,} times {base.axis.microsteps:,} "
        f"steps a turn, {design.axis.travel_per_rev:,.10g} mm, are {float(axis.steps_per_mm):,.7g} steps/mm."
    )
    if axis.effective_acceleration != axis.acceleration:
        alone = "on its own, whatever its M201 is" if axis.letter == EXTRUDER else "less than its M201"
        yield (
            f"The acceleration is that of M204 {shared_by(axis.letter)}, "
            f"{float(axis.effective_acceleration):,.7g} mm/s², {alone}."
        )


def _no_less(exactly: Fraction) -> float:
    """Return the least float that is written as no less: a push, which rounds down, makes of it what was read."""
    value = float(exactly)
    while typed(value) < exactly:
        value = math.nextafter(value, math.inf)
    return value


def _neat(length: float) -> float:
    """Return a length without what division leaves in its last places."""
    return float(f"{length:.12g}")
