"""Pololu Tics: calls of ticcmd, or the lines of a settings file."""

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.tic.ramp import (
    ACCELERATION_SCALE,
    ACCELERATION_UNIT,
    SPEED_SCALE,
    SPEED_UNIT,
    TicRamp,
    figures_of,
    tic_losses,
)
from stepramp.design import Design
from stepramp.exports.machines.sheet import Setting, Sheet, commented

OPTIONS = ("ticcmd --starting-speed", "ticcmd --max-speed", "ticcmd --max-accel", "ticcmd --max-decel")
KEYS = ("starting_speed:", "max_speed:", "max_accel:", "max_decel:")
UNITS = (*[(SPEED_SCALE, SPEED_UNIT)] * 2, *[(ACCELERATION_SCALE, ACCELERATION_UNIT)] * 2)
"""In the order of TicRamp.figures: what a Tic counts in place of steps/s and steps/s²."""


def ticcmd_calls(design: Design) -> Sheet:
    """Return calls of ticcmd, for a Tic on USB; raises Rejected for what it can't take."""
    about = "Calls of ticcmd, for a shell. The Tic forgets these figures when it is reset or switched off."
    return _sheet(design, OPTIONS, about)


def tic_settings(design: Design) -> Sheet:
    """Return lines for a Tic's settings file; raises Rejected for what it can't take."""
    about = (
        "Lines for a Tic's settings file: write its own with ticcmd --get-settings FILE, keep a copy, put these lines "
        "in the place of those there, and load it with ticcmd --settings FILE. By themselves they are no settings file."
    )
    return _sheet(design, KEYS, about)


def _sheet(design: Design, names: tuple[str, ...], about: str) -> Sheet:
    ramp = TicRamp.of(design)
    settings = tuple(
        Setting(name.strip(":"), unit, float(typed(asked) * scale), str(sent))
        for name, (scale, unit), asked, sent in zip(names, UNITS, figures_of(design), ramp.units, strict=True)
    )
    microsteps = design.axis.microsteps
    counted = f"A Tic counts what its step mode makes of a step: this design has {microsteps} for each full step."
    remarks = (*tic_losses(design), counted)
    lines = [f"{name} {sent}" for name, sent in zip(names, ramp.units, strict=True)]
    return Sheet(commented(design, "#", about, remarks, lines), settings, remarks)
