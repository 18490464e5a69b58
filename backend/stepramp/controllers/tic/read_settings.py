"""Designs of a Tic's settings file, as `ticcmd --get-settings` writes it, and of what a connected Tic tells."""

import re
from collections.abc import Iterator

from stepramp.controllers.read_axis import GAIN, SPEED, ReadAxis, design_read, refused_setting
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.variables import MICROSTEPS
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection

_LINE = re.compile(r"(?P<name>[a-z_]+) *:(?P<value>[^#]*)(?:#.*)?")
_SECTION = re.compile(r"\[[^\]]+\]")
"""What no settings file has, and configurations of other families do."""
FIGURES = ("starting_speed", "max_speed", "max_decel", "max_accel")
"""In the order of TicRamp; of those left out a Tic has what it comes with."""
FIELDS = ("ramp.base_speed_steps_per_s", SPEED, "ramp.deceleration_steps_per_s2", GAIN)
"""What each becomes."""
ALLOWED = "speeds up to 500,000,000, accelerations from 100 to 2,147,483,647, max_decel also 0"
NEEDED = frozenset({"max_speed", "max_accel"})
"""What every settings file has, and other texts don't."""
OF_A_TIC = frozenset({"starting_speed", "max_decel", "step_mode"})
"""Beside one of these, what is missing of those is told."""
WHOLE = "a whole settings file of a Tic, a line for each setting"
IN_USE = "# in use: "
"""What the lines of a backup begin with that say what the Tic had in use, beside what it had stored."""
NEW = {"starting_speed": "0", "max_decel": "0"}
STEP_MODES = {"full": 1, "half": 2, "2_100p": 2, **{str(each): each for each in sorted(set(MICROSTEPS.values()))}}
"""Names of step modes, and how many steps each makes of a full step."""


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design of a settings file, for the only axis; [] for a text that is none.

    base: what holds where a Tic says nothing, as motor, timer and method. A push of such a design changes nothing.
    Raises Rejected for settings that no Tic, or no design, can have.
    """
    if any(_SECTION.match(line.strip()) for line in text.splitlines()):
        return []
    stored, in_use = told_by(text), in_use_by(text)
    told = stored | in_use
    if not told.keys() >= NEEDED:
        if told.keys() & NEEDED and told.keys() & OF_A_TIC:
            [lacking] = NEEDED - told.keys()
            raise Rejected([refused_setting(f"without {lacking}", f"{lacking} isn't there", WHOLE)])
        return []
    ramp, microsteps = ramp_told(told), microsteps_told(told)
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"Tic {told['product']}" if told.get("product") else "Tic"
    if microsteps is not None:
        document["axis"]["microsteps"] = microsteps
    start, fastest, gain, loss = ramp.figures
    document["ramp"] = {
        "base_speed_steps_per_s": start,
        "slew_speed_steps_per_s": fastest,
        "acceleration_steps_per_s2": gain,
        "deceleration_steps_per_s2": None if loss == gain else loss,
    }
    made_of = {field: f"{name} {told.get(name, NEW.get(name))}" for field, name in zip(FIELDS, FIGURES, strict=True)}
    design = design_read(document, "a Tic", made_of)
    is_another = bool(in_use) and _limits(stored) != _limits(told)
    return [ReadAxis("Tic", design, tuple(_remarks(microsteps, is_another, _perhaps_cut(text))))]


def told_by(text: str) -> dict[str, str]:
    """Return the settings that a text tells, by name, as they are written."""
    found = filter(None, map(_LINE.fullmatch, (line.strip() for line in text.splitlines())))
    return {each["name"]: each["value"].strip().strip("\"'") for each in found}


def in_use_by(text: str) -> dict[str, str]:
    """Return what a backup tells that was in use, by name; {} for a settings file, and for those of older versions."""
    lines = (line.strip() for line in text.splitlines())
    return told_by("\n".join(line.removeprefix(IN_USE) for line in lines if line.startswith(IN_USE)))


def ramp_told(settings: dict[str, str]) -> TicRamp:
    """Return the ramp among settings; Rejected for one that no Tic can have."""
    told = NEW | settings
    bad = [each for each in FIGURES if not re.fullmatch(r"\d{1,10}", told[each])]
    if bad:
        allowed = "whole numbers of a Tic's units"
        raise Rejected([refused_setting(f"{each}: {told[each]}", f"{each} is {told[each]}", allowed) for each in bad])
    limits = {each: int(told[each]) for each in FIGURES}
    try:
        return TicRamp.told(*limits.values())
    except ValueError as error:
        wrong = ", ".join(f"{name}: {value}" for name, value in limits.items())
        raise Rejected(
            [Rejection("text", wrong, ALLOWED, reason=f"No Tic has {wrong}; allowed: {ALLOWED}.")]
        ) from error


def microsteps_told(settings: dict[str, str]) -> int | None:
    """Return how many steps of a full step settings tell; None for nothing. Rejected for what no Tic can have."""
    step_mode = settings.get("step_mode")
    if step_mode is None or step_mode in STEP_MODES:
        return None if step_mode is None else STEP_MODES[step_mode]
    allowed = f"a step mode of a Tic: {', '.join(STEP_MODES)}"
    raise Rejected([refused_setting(f"step_mode: {step_mode}", f"step_mode is {step_mode}", allowed)])


def _limits(settings: dict[str, str]) -> list[str | None]:
    """Return the figures of a ramp as they work: a deceleration of 0 is the same as the acceleration."""
    told = NEW | settings
    return [told.get("max_accel" if each == "max_decel" and told[each] == "0" else each) for each in FIGURES]


def _perhaps_cut(text: str) -> str | None:
    """Return the last line of a text if it is one of the ramp's and has no end, as all lines of a whole file have."""
    last = text.splitlines()[-1]
    line = last.strip().removeprefix(IN_USE)
    found = _LINE.fullmatch(line)
    is_of_ramp = found is not None and found["name"] in FIGURES and "#" not in line
    return line if is_of_ramp and text.endswith(last) else None


def _remarks(microsteps: int | None, is_another: bool, cut: str | None) -> Iterator[str]:
    if cut is not None:
        yield (
            f"The text ends at {cut}, without a line end: if it was cut off there, that number may lack digits, and "
            "settings that would follow are missing."
        )
    if is_another:
        yield "The ramp in use is taken: the one that the Tic has stored, and uses after a reset, is another."
    if microsteps is None:
        yield "The step mode is not told: the design's own steps of a full step stay."
    yield "Full steps of a turn and what it moves are not told: the design's own stay."
