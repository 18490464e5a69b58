"""Designs of FluidNC's configuration: its file, or what `$CD` tells."""

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from stepramp.controllers.fluidnc.configuration import ITEMS, LEAST, LETTERS, MOST, Configuration
from stepramp.controllers.fluidnc.memory import file_in
from stepramp.controllers.given_numbers import no_less
from stepramp.controllers.grbl.numbers import exact
from stepramp.controllers.grbl.settings import AxisSettings, speed_of
from stepramp.controllers.read_axis import GAIN, SCALE, SPEED, ReadAxis, design_read, refused_setting, with_notes
from stepramp.design import Design
from stepramp.errors import Rejected, shown

MOST_AXES_READ = 4
_WHOLE = re.compile(r"[1-9][0-9]{0,5}")
_INDENTED_BY_TABS = re.compile(rf"(?=[^\S\t]*\t)\s*(?:{'|'.join(ITEMS)})\s*:")


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a configuration; [] for a text that is none.

    base: what holds where it says nothing, as motor, timer and method. A push of such a design changes nothing.
    Raises Rejected for a configuration that no design can have.
    """
    lines = text.splitlines()
    configuration = Configuration.of(lines).with_scales_of(Configuration.of(file_in(lines)))
    tabbed = next((line for line in lines if _INDENTED_BY_TABS.match(line)), None)
    if tabbed is not None:
        allowed = "items that are indented by blanks: FluidNC takes no tabs"
        raise Rejected([refused_setting(tabbed, f"The line {shown(tabbed.strip())} is indented by tabs", allowed)])
    read = range(min(MOST_AXES_READ, len(configuration.axes)))
    senseless = [item for item in map(configuration.senseless, read) if item is not None]
    if senseless:
        allowed = f"axes with numbers from {LEAST:g} to {MOST:,.0f}"
        raise Rejected([refused_setting(item, f"{item} is there", allowed) for item in senseless])
    found = [(axis, configuration.axis(axis)) for axis in read]
    axes = [_axis(axis, settings, configuration, base) for axis, settings in found if settings is not None]
    return with_notes(axes, _ending(configuration, [axis.name for axis in axes]) if axes else ())


def _ending(configuration: Configuration, found: Sequence[str]) -> Iterator[str]:
    """Yield that the text ends among its axes, and which there are: it may be cut off, and most items are optional."""
    last = list(configuration.items)[-1]
    section, *path = last.split("/")
    if section != "axes" or not path or path[0] not in LETTERS:
        return
    motor = f"axes/{path[0]}/motor0"
    lacks = "" if motor in configuration.sections else ", before anything of its motor0"
    yield (
        f"The text ends within axis {path[0].upper()}, at {last}{lacks}. {'Axes' if len(found) > 1 else 'Axis'} "
        f"{', '.join(found)} {'are' if len(found) > 1 else 'is'} found: if it was cut off, others are missing, and its "
        "last number may lack digits."
    )


def _axis(axis: int, settings: AxisSettings, configuration: Configuration, base: Design) -> ReadAxis:
    letter, per_mm = LETTERS[axis], exact(settings.steps_per_mm)
    microsteps = _microsteps(configuration, letter) or base.axis.microsteps
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"FluidNC axis {letter.upper()}"
    travel = Fraction(base.axis.full_steps_per_rev * microsteps) / per_mm
    document["axis"] |= {
        "microsteps": microsteps,
        "travel_per_rev": float(f"{float(travel):.12g}"),
        "travel_unit": "mm",
    }
    document["ramp"] = {
        "base_speed_steps_per_s": 0,
        "slew_speed_steps_per_s": no_less(speed_of(settings.most_rate, settings.most_steps_per_mm)),
        "acceleration_steps_per_s2": no_less(exact(settings.acceleration) * exact(settings.most_steps_per_mm)),
        "deceleration_steps_per_s2": None,
    }
    made_of = {
        SCALE: f"steps_per_mm {float(per_mm):.10g}",
        SPEED: f"max_rate_mm_per_min {float(settings.most_rate):.10g}",
        GAIN: f"acceleration_mm_per_sec2 {float(settings.acceleration):.10g}",
    }
    design = design_read(document, f"axis {letter.upper()}", made_of)
    return ReadAxis(letter.upper(), design, tuple(_remarks(design, settings, configuration.untold(axis))))


def _microsteps(configuration: Configuration, letter: str) -> int | None:
    """Return the microsteps of an axis' first motor; None where its driver isn't told them."""
    begin, end = f"axes/{letter}/motor0/", "/microsteps"
    texts = [text for path, text in configuration.items.items() if path.startswith(begin) and path.endswith(end)]
    found = _WHOLE.fullmatch(texts[0]) if texts else None
    return None if found is None else int(texts[0])


def _remarks(design: Design, settings: AxisSettings, untold: Sequence[str]) -> Iterator[str]:
    yield (
        f"Full steps are not told: {design.axis.full_steps_per_rev:,} times {design.axis.microsteps:,} steps a turn, "
        f"{design.axis.travel_per_rev:,.10g} mm, are {float(settings.steps_per_mm):,.7g} steps/mm."
    )
    if settings.rounding_words is not None:
        yield settings.rounding_words
    for words in untold:
        yield f"{words}, as FluidNC does where it isn't told."
