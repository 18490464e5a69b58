"""Designs of what a Marlin lists after M503."""

import math
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import takewhile

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.marlin.settings import (
    ACCELERATIONS,
    EXTRUDER,
    LETTERS,
    OF_AN_AXIS,
    AxisSettings,
    Settings,
    unreadable,
)
from stepramp.controllers.read_axis import GAIN, SCALE, SPEED, ReadAxis, design_read, refused_setting, with_notes
from stepramp.design import Design
from stepramp.errors import Count, Rejected, shown

OTHER_LETTERS = "ABCIJKUVW"
"""Of axes that Marlin may have besides."""
FURTHER_EXTRUDER = re.compile(r"T[1-9]\d*")
LEAST_CODES = 2
"""So many of M92, M201 and M203 a listing has; a program may have one."""


def read_settings(text: str, base: Design) -> list[ReadAxis]:
    """Return a design for each axis of a listing; [] for a text that is none.

    base: what holds where Marlin says nothing, as motor, timer and method. An axis with such a design moves as before.
    Raises Rejected for settings that no design can have, for a line that can't be read, and for those in inches.
    """
    lines = text.splitlines()
    if bad := unreadable(lines):
        allowed = "numbers with a point, as M503 tells them"
        raise Rejected([refused_setting(line, f"The line {shown(line)} can't be read", allowed) for line in bad])
    settings = Settings.of(lines)
    told = {code for code, _ in settings.commands}
    if len(told & set(OF_AN_AXIS)) < LEAST_CODES:
        return []
    if settings.is_in_inches:
        raise Rejected([refused_setting("G20", "The settings are in inches (G20)", "settings in mm (G21)")])
    axes = list(takewhile(lambda axis: not any(_lacks(settings, axis.letter)), settings.axes()))
    if not axes:
        lacks = list(_lacks(settings, "X"))
        allowed = "M92, M203 and M201 of axis X, above 0 and not cut off"
        raise Rejected([refused_setting(Count(lack), lack, allowed) for lack in lacks])
    letters = [axis.letter for axis in axes]
    notes = [*_left_out(settings, letters), *_told_again(settings), *_perhaps_cut(settings, letters)]
    return with_notes([_axis(axis, settings.shared_by(axis.letter), base) for axis in axes], notes)


def _left_out(settings: Settings, read: Sequence[str]) -> Iterator[str]:
    """Yield what is told of axes that aren't read, as sentences."""
    told = {letter for code in OF_AN_AXIS for letter in settings.words(code)}
    for letter in LETTERS:
        if letter in told and letter not in read:
            yield f"Axis {letter} is left out: {next(_lacks(settings, letter), 'one before it is')}."
    if others := sorted(told & set(OTHER_LETTERS)):
        yield f"Axes other than X, Y, Z and E are left out: {', '.join(others)}."
    for code, words in settings.commands:
        if code in OF_AN_AXIS and (found := FURTHER_EXTRUDER.search(words)) is not None:
            of_it = " ".join(word for word in words.split() if word[0] in (found[0][0], EXTRUDER))
            yield f"{code} {of_it} is left out: of several extruders the first is read, not {found[0]}."


def _told_again(settings: Settings) -> Iterator[str]:
    """Yield which numbers are told again, and differently, as sentences: of those the last counts, as in Marlin."""
    for code in (*OF_AN_AXIS, ACCELERATIONS):
        last = settings.words(code)
        former = dict.fromkeys((letter, value) for told in settings.told_by(code) for letter, value in told.items())
        for letter, value in former:
            if (letter in LETTERS or code == ACCELERATIONS) and value != last[letter]:
                yield f"{code} {letter}{value} is left out: it is told again, as {letter}{last[letter]}, which counts."


def _perhaps_cut(settings: Settings, read: Sequence[str]) -> Iterator[str]:
    """Yield which number of axes that are read may lack digits: its line ends with it, and others go on."""
    known = {letter for code in OF_AN_AXIS for letter in settings.words(code)}
    for code in OF_AN_AXIS:
        words = settings.words(code)
        last = max((letter for letter in LETTERS if letter in words), key=LETTERS.index)
        beyond = [letter for letter in LETTERS[LETTERS.index(last) + 1 :] if letter in known]
        if beyond and last in read:
            yield (
                f"{code} ends with {last}{words[last]}, and tells no {', '.join(beyond)}: if the text was cut off "
                "there, that number may lack digits, too."
            )


def _lacks(settings: Settings, letter: str) -> Iterator[str]:
    """Yield what is wrong with the numbers of an axis, in words."""
    for code in OF_AN_AXIS:
        value, number = settings.words(code).get(letter), settings.number(code, letter)
        if value is None:
            yield f"{code} {letter} is not told"
        elif number is None or number <= 0:
            yield f"{code} {letter}{value} is no number above 0"
    for code, each in (*((code, letter) for code in OF_AN_AXIS), (ACCELERATIONS, settings.shared_by(letter))):
        if (decimals := settings.decimals_cut(code, each)) is not None:
            value = settings.words(code)[each]
            yield f"{code} {each}{value} is cut off, as it seems: the others of its line have {decimals} decimals"


def _axis(axis: AxisSettings, shared: str, base: Design) -> ReadAxis:
    """Return the design of an axis. shared: what of M204 it keeps to."""
    per_mm = float(axis.steps_per_mm)
    document = base.model_dump(mode="json", by_alias=True)
    document["name"] = f"Marlin axis {axis.letter}"
    document["axis"] |= {"travel_per_rev": _neat(base.axis.steps_per_rev / per_mm), "travel_unit": "mm"}
    document["ramp"] = {
        "base_speed_steps_per_s": 0,
        "slew_speed_steps_per_s": _no_less(axis.speed * axis.most_steps_per_mm),
        "acceleration_steps_per_s2": _no_less(axis.effective_acceleration * axis.most_steps_per_mm),
        "deceleration_steps_per_s2": None,
    }
    speed, gain = float(axis.speed), float(axis.effective_acceleration)
    made_of = {SCALE: f"M92 {per_mm:.10g}", SPEED: f"M203 {speed:.10g}", GAIN: f"an acceleration of {gain:.10g} mm/s²"}
    design = design_read(document, f"axis {axis.letter}", made_of)
    return ReadAxis(axis.letter, design, tuple(_remarks(axis, shared, design, base)))


def _remarks(axis: AxisSettings, shared: str, design: Design, base: Design) -> Iterator[str]:
    yield (
        f"Full steps and microsteps are not told: {base.axis.full_steps_per_rev:,} times {base.axis.microsteps:,} "
        f"steps a turn, {design.axis.travel_per_rev:,.10g} mm, are {float(axis.steps_per_mm):,.7g} steps/mm."
    )
    if axis.shared_acceleration is None:
        yield f"M204 {shared} is not told: the acceleration is that of M201 alone."
    if axis.effective_acceleration != axis.acceleration:
        alone = "on its own, whatever its M201 is" if axis.letter == EXTRUDER else "less than its M201"
        yield (f"The acceleration is that of M204 {shared}, {float(axis.effective_acceleration):,.7g} mm/s², {alone}.")


def _no_less(exactly: Fraction) -> float:
    """Return the least float that is written as no less: a push, which rounds down, makes of it what was read."""
    value = float(exactly)
    while typed(value) < exactly:
        value = math.nextafter(value, math.inf)
    return value


def _neat(length: float) -> float:
    """Return a length without what division leaves in its last places."""
    return float(f"{length:.12g}")
