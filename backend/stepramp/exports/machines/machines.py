"""The machines and libraries that a design is exported for, by the name of their format."""

from collections.abc import Callable
from dataclasses import dataclass

from stepramp.controllers.fluidnc.own_ramp import own_ramp as fluidnc_own_ramp
from stepramp.controllers.grbl.own_ramp import own_ramp as grbl_own_ramp
from stepramp.controllers.klipper.own_ramp import own_ramp as klipper_own_ramp
from stepramp.controllers.marlin.own_ramp import own_ramp as marlin_own_ramp
from stepramp.controllers.own_ramp import PlayOwn
from stepramp.controllers.tic.own_ramp import own_ramp as tic_own_ramp
from stepramp.design import Design
from stepramp.exports.machines import accel_stepper_ramp, teensy_step_ramp
from stepramp.exports.machines.accel_stepper import accel_stepper
from stepramp.exports.machines.fast_accel_stepper import fast_accel_stepper
from stepramp.exports.machines.fluidnc import fluidnc_items
from stepramp.exports.machines.grbl import grbl_settings, grblhal_settings
from stepramp.exports.machines.klipper import klipper_options
from stepramp.exports.machines.marlin import marlin_codes, marlin_configuration
from stepramp.exports.machines.sheet import AxisLetter, Sheet
from stepramp.exports.machines.switec_x25 import switec_x25
from stepramp.exports.machines.teensy_step import teensy_step
from stepramp.exports.machines.tic import tic_settings, ticcmd_calls


@dataclass(frozen=True)
class Machine:
    """How a design becomes what one of them is given."""

    ending: str
    """Of the file's name."""
    is_code: bool
    make: Callable[[Design, str, AxisLetter], Sheet]
    """Takes the design, the name that code begins its own names with, and the letter of the axis."""
    play_own: PlayOwn | None = None
    """What it plays of a design's move; None: unplayed says why not."""
    unplayed: str = ""
    """As a sentence."""


MACHINES: dict[str, Machine] = {
    "grbl": Machine("_grbl.txt", False, lambda design, _, letter: grbl_settings(design, letter), grbl_own_ramp),
    "grblhal": Machine(
        "_grblhal.txt",
        False,
        lambda design, _, letter: grblhal_settings(design, letter),
        unplayed="grblHAL has a driver for each board, with a timer of its own: of grbl it is known.",
    ),
    "fluidnc": Machine(
        "_fluidnc.yaml", False, lambda design, _, letter: fluidnc_items(design, letter), fluidnc_own_ramp
    ),
    "marlin": Machine("_marlin.gcode", False, lambda design, _, letter: marlin_codes(design, letter), marlin_own_ramp),
    "marlin_configuration": Machine(
        "_marlin_configuration.h", True, lambda design, _, letter: marlin_configuration(design, letter), marlin_own_ramp
    ),
    "klipper": Machine(
        "_klipper.cfg", False, lambda design, _, letter: klipper_options(design, letter), klipper_own_ramp
    ),
    "tic": Machine("_ticcmd.sh", False, lambda design, *_: ticcmd_calls(design), tic_own_ramp),
    "tic_settings": Machine("_tic.txt", False, lambda design, *_: tic_settings(design), tic_own_ramp),
    "accelstepper": Machine(
        "_accelstepper.ino",
        True,
        lambda design, name, _: accel_stepper(design, name),
        accel_stepper_ramp.own_ramp,
    ),
    "fastaccelstepper": Machine(
        "_fastaccelstepper.ino",
        True,
        lambda design, name, _: fast_accel_stepper(design, name),
        unplayed="FastAccelStepper plans some ms ahead, in logarithms of few bits that change with its versions: what "
        "it plays isn't followed here.",
    ),
    "teensystep": Machine(
        "_teensystep.ino",
        True,
        lambda design, name, _: teensy_step(design, name),
        teensy_step_ramp.own_ramp,
    ),
    "switecx25": Machine(
        "_switecx25.ino",
        True,
        lambda design, name, _: switec_x25(design, name),
        unplayed="SwitecX25 plays the lookup table as the method Lookup table plans it.",
    ),
}
