"""Designs of Klipper's configuration, as a printer.cfg or as a backup."""

import re
from collections.abc import Iterator
from dataclasses import replace

from stepramp.controllers.given_numbers import no_less, typed
from stepramp.controllers.klipper.backup import Backup, pasted
from stepramp.controllers.klipper.configuration import Configuration, Sections, includes_of
from stepramp.controllers.klipper.machine import LETTERS, PRINTER, Machine, Senseless, Stepper, Z
from stepramp.controllers.read_axis import GAIN, SCALE, SPEED, ReadAxis, design_read, refused_setting, with_notes
from stepramp.design import Design
from stepramp.errors import Refused, Rejected, Rejection

STEPPERS = frozenset(f"stepper_{letter}" for letter in LETTERS)
"""Sections that no other text has."""
WHOLE = "a whole configuration of Klipper, with [printer] and a section for each axis' stepper"
Z_LIMITS = (("max_z_velocity", "max_velocity"), ("max_z_accel", "max_accel"))
"""Options of z, and what stands for each where it isn't there."""
_HEADER = re.compile(r"\s*\[([^\]]+)\]")
_ENDS_WITH_A_NUMBER = re.compile(r"\s*\w+\s*[:=][^#;]*[0-9]\.?")
_ENDS_BEFORE_A_VALUE = re.compile(r"\s*\w+\s*[:=](?:[^#;]*,)?\s*")


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a configuration; [] for a text that is none.

    base: what holds where it says nothing, as timer and method. A push of such a design changes nothing.
    Raises Rejected for a configuration that no design can be made of.
    """
    # Some editors put a byte order mark before a text.
    text = text.removeprefix("\ufeff")
    saved = Backup.read(text)
    backup = saved or pasted(text)
    try:
        sections = Configuration(backup.files, backup.main).sections
    except Refused as error:
        if STEPPERS.isdisjoint(_headers(text)):
            return []
        raise Rejected([Rejection("text", "a configuration", WHOLE, reason=str(error))]) from error
    if STEPPERS.isdisjoint(sections) and "kinematics" not in sections.get(PRINTER, {}):
        return []
    if PRINTER not in sections:
        perhaps = " (nor is what is included)" if saved is None and includes_of(text) else ""
        raise Rejected([refused_setting(f"without [{PRINTER}]", f"[{PRINTER}] isn't there{perhaps}", WHOLE)])
    try:
        machine = Machine.of(sections)
    except Senseless as error:
        raise Rejected([Rejection("text", "a configuration", "one of axes", reason=_sentence(error))]) from error
    in_use = {name.lower(): typed(value) for name, value in backup.limits.items() if name in ("VELOCITY", "ACCEL")}
    machine = replace(machine, limits=replace(machine.limits, **in_use))
    axes = [_axis(machine, axis, stepper, base) for axis, stepper in enumerate(machine.steppers)]
    axes[Z] = replace(axes[Z], remarks=(*axes[Z].remarks, *_stand_ins(sections)))
    return axes if saved is not None else with_notes(axes, _of_a_paste(text))


def _headers(text: str) -> list[str]:
    """Return the names of sections in a text, also in one that is indented, and in one that can't be read."""
    return [found[1] for found in map(_HEADER.match, text.splitlines()) if found is not None]


def _stand_ins(sections: Sections) -> Iterator[str]:
    """Yield which limits of z aren't told, and what stands for them."""
    for option, other in Z_LIMITS:
        if option not in sections[PRINTER]:
            yield f"{option} isn't told: it is taken for {other}, as Klipper does."


def _of_a_paste(text: str) -> Iterator[str]:
    """Yield what a configuration may lack that was copied: what it includes, and what was cut off at its end."""
    if included := includes_of(text):
        yield f"What it includes isn't in it, and may say otherwise: {', '.join(included)}."
    last = text.splitlines()[-1]
    section = next(reversed(_headers(text)), "")
    # A text that is whole ends with a line end, mostly.
    if not text.endswith(last) or (section != PRINTER and section not in STEPPERS):
        return
    if _ENDS_WITH_A_NUMBER.fullmatch(last):
        yield (
            f"The text ends within [{section}], at {last.strip()}: if it was cut off there, its last number may lack "
            "digits, and options that would follow are missing."
        )
    elif _ENDS_BEFORE_A_VALUE.fullmatch(last):
        yield (
            f"The text ends within [{section}], at {last.strip()} as it seems in the midst of a value: if it was cut "
            "off there, the rest of that value and options that would follow are missing."
        )


def _axis(machine: Machine, axis: int, stepper: Stepper, base: Design) -> ReadAxis:
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"Klipper axis {LETTERS[axis].upper()}"
    document["axis"] |= {
        "full_steps_per_rev": stepper.full_steps,
        "microsteps": stepper.microsteps,
        "travel_per_rev": float(f"{float(stepper.travel_per_rev):.12g}"),
        "travel_unit": "mm",
    }
    scale = stepper.steps_per_mm
    document["ramp"] = {
        "base_speed_steps_per_s": 0,
        "slew_speed_steps_per_s": no_less(machine.limits.velocity_of(axis) * scale),
        "acceleration_steps_per_s2": no_less(machine.limits.accel_of(axis) * scale),
        "deceleration_steps_per_s2": None,
    }
    letter = LETTERS[axis].upper()
    speed, gain = float(machine.limits.velocity_of(axis)), float(machine.limits.accel_of(axis))
    made_of = {
        SCALE: f"rotation_distance {float(stepper.travel_per_rev):.10g}",
        SPEED: f"a velocity of {speed:.10g} mm/s",
        GAIN: f"an acceleration of {gain:.10g} mm/s²",
    }
    design = design_read(document, f"axis {letter}", made_of)
    return ReadAxis(letter, design, () if machine.remark is None or letter == "Z" else (machine.remark,))


def _sentence(error: Senseless) -> str:
    return f"No designs can be made of this configuration: {error}."
