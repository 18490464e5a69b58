"""Designs of what a grbl lists after `$$`."""

from stepramp.controllers.given_numbers import no_less
from stepramp.controllers.grbl.settings import (
    ACCELERATION,
    LETTERS,
    MOST_RATE,
    STEPS_PER_MM,
    AxisSettings,
    CutOff,
    Settings,
    acceleration_of,
    speed_of,
)
from stepramp.controllers.read_axis import GAIN, SCALE, SPEED, ReadAxis, design_read, refused_setting, with_notes
from stepramp.design import Design
from stepramp.errors import Count, Rejected

MOST_AXES_READ = 4


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a listing; [] for a text that is none.

    base: what holds where grbl says nothing, as motor, timer and method. A push of such a design changes nothing.
    Raises Rejected for settings that no design can have, or that no axis can move with. Where others can, one that
    can't is left out, and told of.
    """
    lines = text.splitlines()
    settings, cut = Settings.pasted(lines), Settings.cut_off(lines)
    lacks = {axis: lack for axis in range(MOST_AXES_READ) if (lack := _lack(settings, axis, cut))}
    whole = [axis for axis in range(MOST_AXES_READ) if axis not in lacks]
    senseless = [(LETTERS[axis], listed) for axis in whole if (listed := settings.senseless(axis))]
    axes = [_axis(axis, scale, settings, base) for axis in whole if (scale := settings.axis(axis)) is not None]
    if senseless and not axes:
        letter, listed = senseless[0]
        allowed = f"settings that axis {letter} can move with: numbers above 0"
        if "," in listed:
            allowed += ", with a point for the comma"
        raise Rejected([refused_setting(listed, f"{listed} is listed", allowed)])
    if lacks and not axes:
        axis, (value, words) = next(iter(lacks.items()))
        raise Rejected([refused_setting(Count(value), words, f"all settings of axis {LETTERS[axis]}, a line each")])
    if axes:
        left_out = [f"Axis {letter} is left out: with {listed} it can't move." for letter, listed in senseless]
        left_out += [f"Axis {LETTERS[axis]} is left out: {words}." for axis, (_, words) in lacks.items()]
        left_out += [f"{each} are listed: the last holds." for each in Settings.told_twice(lines)]
        return with_notes(axes, left_out)
    return axes


def _lack(settings: Settings, axis: int, cut: CutOff | None) -> tuple[str, str] | None:
    """Return what an axis lacks of which there is something: what of it is refused, and words; None for nothing."""
    if cut is not None and cut.number in (first + axis for first in (STEPS_PER_MM, MOST_RATE, ACCELERATION)):
        listed = f"${cut.number}={cut.value}"
        return listed, f"{listed} is cut off, as it seems: the others have {cut.decimals} decimals"
    if not (missing := settings.missing(axis)):
        return None
    names = ", ".join(missing)
    return f"without {names}", f"{names} {'aren' if len(missing) > 1 else 'isn'}'t there"


def _axis(axis: int, scale: AxisSettings, settings: Settings, base: Design) -> ReadAxis:
    per_mm = float(scale.steps_per_mm)
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"grbl axis {LETTERS[axis]}"
    document["axis"] |= {"travel_per_rev": _neat(base.axis.steps_per_rev / per_mm), "travel_unit": "mm"}
    document["ramp"] = {
        "base_speed_steps_per_s": 0,
        "slew_speed_steps_per_s": no_less(speed_of(scale.most_rate, scale.most_steps_per_mm)),
        "acceleration_steps_per_s2": no_less(acceleration_of(scale.acceleration, scale.most_steps_per_mm)),
        "deceleration_steps_per_s2": None,
    }
    numbers = {SCALE: STEPS_PER_MM + axis, SPEED: MOST_RATE + axis, GAIN: ACCELERATION + axis}
    made_of = {field: f"${number}={settings.values[number]}" for field, number in numbers.items()}
    design = design_read(document, f"axis {LETTERS[axis]}", made_of)
    return ReadAxis(
        LETTERS[axis],
        design,
        (
            f"Full steps and microsteps are not told: {base.axis.full_steps_per_rev:,} times {base.axis.microsteps:,} "
            f"steps a turn, {design.axis.travel_per_rev:,.10g} mm, are {per_mm:,.7g} steps/mm.",
            *(() if scale.rounding_words is None else (scale.rounding_words,)),
        ),
    )


def _neat(length: float) -> float:
    """Return a length without what division leaves in its last places."""
    return float(f"{length:.12g}")
