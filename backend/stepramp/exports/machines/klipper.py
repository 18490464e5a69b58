"""Klipper: options of its printer.cfg."""

from decimal import Decimal

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.klipper.ramp import klipper_losses, klipper_ramp
from stepramp.controllers.losses import slower
from stepramp.design import Design
from stepramp.exports.machines.sheet import AxisLetter, Setting, Sheet, commented

OF_THE_PRINTER = {"X": "max_", "Y": "max_", "Z": "max_z_"}
"""By axis, how the names of its limits begin in the section [printer]; other axes have a section of their own."""


def klipper_options(design: Design, letter: AxisLetter) -> Sheet:
    """Return the options of an axis; raises Rejected for what Klipper can't take."""
    given, axis = klipper_ramp(design), letter.lower()
    begin = OF_THE_PRINTER.get(letter, "")
    way = Decimal(str(design.axis.travel_per_rev))
    turn = (
        Setting("rotation_distance", "mm", float(way), f"{way:f}"),
        Setting("microsteps", "", design.axis.microsteps, str(design.axis.microsteps)),
        Setting("full_steps_per_rotation", "", design.axis.full_steps_per_rev, str(design.axis.full_steps_per_rev)),
    )
    limits = (
        Setting(
            f"{begin}velocity",
            "mm/s",
            float(typed(design.ramp.slew_speed_steps_per_s) / given.scale),
            given.speed,
        ),
        Setting(f"{begin}accel", "mm/s²", float(slower(design) / given.scale), given.acceleration),
    )
    section = f"[stepper_{axis}]" if begin else f"[manual_stepper {axis}]"
    lines = [section, *map(_line, turn), *(("", "[printer]") if begin else ()), *map(_line, limits)]
    remarks = (*klipper_losses(design, given), *_whose(letter))
    about = "Options of Klipper's printer.cfg: put them in the place of those there, keep the others, then RESTART."
    if begin == "max_":
        about += (
            " Until then lower limits are tried by "
            f"SET_VELOCITY_LIMIT VELOCITY={given.speed} ACCEL={given.acceleration}"
        )
    return Sheet(commented(design, "#", about, remarks, lines), (*turn, *limits), remarks)


def _line(setting: Setting) -> str:
    return f"{setting.name}: {setting.sent}"


def _whose(letter: AxisLetter) -> tuple[str, ...]:
    """Return whom the limits hold for, where that is not this axis alone."""
    if letter == "Z":
        return ("max_z_velocity and max_z_accel count only up to max_velocity and max_accel, which hold for all axes.",)
    if letter in OF_THE_PRINTER:
        return ("max_velocity and max_accel hold for the tool as a whole: for all axes, and along slanted lines.",)
    return ()
