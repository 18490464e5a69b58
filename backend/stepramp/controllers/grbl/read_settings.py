"""Designs of what a grbl lists after `$$`."""

from stepramp.controllers.given_numbers import no_less
from stepramp.controllers.grbl.settings import LETTERS, AxisSettings, Settings, acceleration_of, speed_of
from stepramp.controllers.read_axis import ReadAxis, design_read
from stepramp.design import Design

MOST_AXES_READ = 4


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a listing; [] for a text that is none.

    base: what holds where grbl says nothing, as motor, timer and method. A push of such a design changes nothing.
    Raises Rejected for settings that no design can have.
    """
    settings = Settings.of(text.splitlines())
    found = [(axis, settings.axis(axis)) for axis in range(MOST_AXES_READ)]
    return [_axis(axis, scale, base) for axis, scale in found if scale is not None]


def _axis(axis: int, scale: AxisSettings, base: Design) -> ReadAxis:
    per_mm = float(scale.steps_per_mm)
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"grbl axis {LETTERS[axis]}"
    document["axis"] |= {"travel_per_rev": _neat(base.axis.steps_per_rev / per_mm), "travel_unit": "mm"}
    document["ramp"] = {
        "base_speed_steps_per_s": 0,
        "slew_speed_steps_per_s": no_less(speed_of(scale.most_rate, scale.steps_per_mm)),
        "acceleration_steps_per_s2": no_less(acceleration_of(scale.acceleration, scale.steps_per_mm)),
        "deceleration_steps_per_s2": None,
    }
    design = design_read(document, f"axis {LETTERS[axis]}")
    return ReadAxis(
        LETTERS[axis],
        design,
        (
            f"Full steps and microsteps are not told: {base.axis.full_steps_per_rev:,} times {base.axis.microsteps:,} "
            f"steps a turn, {design.axis.travel_per_rev:,.10g} mm, are {per_mm:,.7g} steps/mm.",
        ),
    )


def _neat(length: float) -> float:
    """Return a length without what division leaves in its last places."""
    return float(f"{length:.12g}")
