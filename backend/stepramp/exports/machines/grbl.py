"""grbl 1.1 and grblHAL: three settings of an axis."""

from collections.abc import Iterator
from fractions import Fraction

from stepramp.controllers.given_numbers import steps_per_unit, typed
from stepramp.controllers.grbl.numbers import exact, read
from stepramp.controllers.grbl.ramp import GrblRamp, grbl_losses
from stepramp.controllers.grbl.settings import ACCELERATION, MOST_RATE, STEPS_PER_MM, rate_of
from stepramp.controllers.losses import rounding, scale_losses, slower
from stepramp.controllers.per_mm import Quantity, kept_scale
from stepramp.design import Design
from stepramp.exports.machines.sheet import AxisLetter, Setting, Sheet, axis_number, commented

AXES_OF_GRBL, AXES_OF_GRBLHAL = 3, 6
SCALE = Quantity(6, Fraction(1, 1000), Fraction(100_000))


def grbl_settings(design: Design, letter: AxisLetter) -> Sheet:
    """Return the settings of an axis of grbl 1.1; raises Rejected for what it can't take."""
    return _sheet(design, "grbl", axis_number(letter, AXES_OF_GRBL, "grbl"))


def grblhal_settings(design: Design, letter: AxisLetter) -> Sheet:
    """Return the settings of an axis of grblHAL; raises Rejected for what it can't take."""
    return _sheet(design, "grblHAL", axis_number(letter, AXES_OF_GRBLHAL, "grblHAL"))


def _sheet(design: Design, name: str, axis: int) -> Sheet:
    scale, scale_text = kept_scale(design, name, SCALE, lambda text: exact(read(text)))
    ramp = GrblRamp.of(design, read(scale_text), name=name)
    rate = rate_of(typed(design.ramp.slew_speed_steps_per_s), ramp.steps_per_mm)
    settings = (
        Setting(f"${STEPS_PER_MM + axis}", "steps/mm", float(steps_per_unit(design.axis)), scale_text),
        Setting(f"${MOST_RATE + axis}", "mm/min", float(rate), ramp.rate_text),
        Setting(f"${ACCELERATION + axis}", "mm/s²", float(slower(design) / scale), ramp.acceleration_text),
    )
    remarks = tuple(_remarks(design, name, ramp))
    about = (
        f"Send these lines to {name} one at a time, and wait for each ok: while it stores one it loses what comes in. "
        "Keep what $$ lists before."
    )
    lines = [f"{each.name}={each.sent}" for each in settings]
    return Sheet(commented(design, ";", about, remarks, lines), settings, remarks)


def _remarks(design: Design, name: str, ramp: GrblRamp) -> Iterator[str]:
    yield from grbl_losses(design, name)
    speed, rate = typed(ramp.speed_steps_per_s), typed(ramp.acceleration_steps_per_s2)
    yield from rounding("Slew speed", "steps/s", typed(design.ramp.slew_speed_steps_per_s), speed)
    yield from rounding("Acceleration", "steps/s²", slower(design), rate)
    yield from scale_losses(design, name, exact(ramp.steps_per_mm))
