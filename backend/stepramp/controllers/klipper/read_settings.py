"""Designs of Klipper's configuration, as a printer.cfg or as a backup."""

from dataclasses import replace
from fractions import Fraction

from stepramp.controllers.given_numbers import no_less
from stepramp.controllers.klipper.backup import Backup, pasted
from stepramp.controllers.klipper.configuration import Configuration
from stepramp.controllers.klipper.machine import LETTERS, PRINTER, Machine, Senseless, Stepper
from stepramp.controllers.read_axis import GAIN, SCALE, SPEED, ReadAxis, design_read
from stepramp.design import Design
from stepramp.errors import Refused, Rejected, Rejection


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a configuration; [] for a text that is none.

    base: what holds where it says nothing, as timer and method. A push of such a design changes nothing.
    Raises Rejected for a configuration that no design can be made of.
    """
    # Some editors put a byte order mark before a text.
    text = text.removeprefix("\ufeff")
    backup = Backup.read(text) or pasted(text)
    try:
        sections = Configuration(backup.files, backup.main).sections
    except Refused:
        return []
    if PRINTER not in sections or "kinematics" not in sections[PRINTER]:
        return []
    try:
        machine = Machine.of(sections)
    except Senseless as error:
        raise Rejected([Rejection("text", "a configuration", "one of axes", reason=_sentence(error))]) from error
    in_use = {name.lower(): Fraction(value) for name, value in backup.limits.items() if name in ("VELOCITY", "ACCEL")}
    machine = replace(machine, limits=replace(machine.limits, **in_use))
    return [_axis(machine, axis, stepper, base) for axis, stepper in enumerate(machine.steppers)]


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
