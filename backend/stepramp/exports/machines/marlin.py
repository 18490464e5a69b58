"""Marlin: M-codes that are sent to it, or the lines of its Configuration.h."""

from stepramp.controllers.given_numbers import steps_per_unit, typed
from stepramp.controllers.losses import slower
from stepramp.controllers.marlin.ramp import marlin_losses, marlin_ramp
from stepramp.controllers.per_mm import PerMm
from stepramp.design import Design
from stepramp.exports.machines.sheet import LETTERS, AxisLetter, Setting, Sheet, commented

PLACES = ("X", "Y", "Z")
"""What each of Configuration.h's lists has at least, before its extruder."""


def marlin_codes(design: Design, letter: AxisLetter) -> Sheet:
    """Return what is sent to Marlin; raises Rejected for what it can't take."""
    given = marlin_ramp(design)
    rate = given.acceleration
    lines = [
        f"M92 {letter}{given.steps_per_mm}",
        f"M203 {letter}{given.speed}",
        f"M201 {letter}{rate}",
        f"M204 P{rate} T{rate}",
        "M500",
    ]
    about = "Send these lines to Marlin: steps/mm, mm/s, mm/s^2; M500 stores them. Keep what M503 lists before."
    names = (f"M92 {letter}", f"M203 {letter}", f"M201 {letter}", "M204 P T")
    return _sheet(design, given, names, "; ", about, lines)


def marlin_configuration(design: Design, letter: AxisLetter) -> Sheet:
    """Return lines for Marlin's Configuration.h; raises Rejected for what it can't take."""
    given = marlin_ramp(design)
    names = (
        "DEFAULT_AXIS_STEPS_PER_UNIT",
        "DEFAULT_MAX_FEEDRATE",
        "DEFAULT_MAX_ACCELERATION",
        "DEFAULT_ACCELERATION",
    )
    lists = zip(names, (given.steps_per_mm, given.speed, given.acceleration), strict=False)
    lines = [
        *(f"#define {name} {{ {', '.join(_places(letter, name, value))} }}" for name, value in lists),
        f"#define DEFAULT_ACCELERATION {given.acceleration}",
        f"#define DEFAULT_TRAVEL_ACCELERATION {given.acceleration}",
    ]
    about = (
        "Lines for Marlin's Configuration.h: steps/mm, mm/s, mm/s^2. Names such as Y_STEPS_PER_UNIT stand for the "
        "numbers that your file has there; put them in their place. What M500 has stored wins until M502."
    )
    return _sheet(design, given, names, "//", about, lines)


def _places(letter: AxisLetter, name: str, value: str) -> list[str]:
    """Return what a list of Configuration.h has for each axis."""
    number = LETTERS.index(letter)
    axes = [*LETTERS[: max(number + 1, len(PLACES))], "E"]
    return [value if each == letter else f"{each}{name.removeprefix('DEFAULT').replace('_AXIS', '')}" for each in axes]


def _sheet(design: Design, given: PerMm, names: tuple[str, ...], mark: str, about: str, lines: list[str]) -> Sheet:
    remarks = tuple(marlin_losses(design, given))
    rate = float(slower(design) / given.scale)
    speed = float(typed(design.ramp.slew_speed_steps_per_s) / given.scale)
    values = (
        ("steps/mm", float(steps_per_unit(design.axis)), given.steps_per_mm),
        ("mm/s", speed, given.speed),
        ("mm/s²", rate, given.acceleration),
        ("mm/s²", rate, given.acceleration),
    )
    settings = tuple(Setting(name, *value) for name, value in zip(names, values, strict=True))
    return Sheet(commented(design, mark.strip(), about, remarks, lines), settings, remarks)
