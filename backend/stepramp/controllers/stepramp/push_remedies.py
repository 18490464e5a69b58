"""What to change of a design whose ramp is too long for a controller: changes that were tried, each remedy by itself.

A remedy changes fields of the refused axis only. How long it is looked for is bounded: by the number of plans that are
made, and by the time that they take together.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.push import PushPlan, TooLong, plan_push
from stepramp.controllers.stepramp.ramp_image import RampImage
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.design import Design
from stepramp.errors import Change, Rejected, Rejection, Remedy, StepUnit, Told
from stepramp.methods import METHODS
from stepramp.numerics.limit_text import highest, lowest
from stepramp.ramp.on_chip import ON_CHIP
from stepramp.ramp.plan import longest_side

MOST_STEPS_TO_SEARCH = 200_000
"""Of all ramps that are refused, as they would be: longer ones take too long to be planned again and again [steps]."""
SEARCH_S = 2.0
"""So long numbers are looked for, all together; what is found until then is told [s]."""
DOUBLINGS, HALVINGS = 12, 5
FIGURES = 3
"""Of the numbers that are told."""
EXACTLY = 15
"""Figures of such a number as it is told: all of it."""

Fits = Callable[[Design], bool]
Changes = tuple[Change, ...]


def plan_or_remedies(
    designs: Sequence[Design],
    hello: HelloReply,
    settings: StepRampSettings,
    first_axis: int | None = None,
    present: RampImage | None = None,
) -> PushPlan:
    """Return what to send, as plan_push does; what is rejected for its length says what would be accepted instead."""

    def try_to_plan(instead: Sequence[Design]) -> None:
        plan_push(instead, hello, settings, first_axis, present, coarsest_only=True)

    try:
        return plan_push(designs, hello, settings, first_axis, present)
    except TooLong as error:
        raise Rejected(list(_with_remedies(error, designs, try_to_plan)), error.more) from error


def _with_remedies(
    error: TooLong, designs: Sequence[Design], try_to_plan: Callable[[Sequence[Design]], None]
) -> Iterator[Rejection]:
    """Yield the rejections of ramps that are too long, with what would be accepted instead."""
    steps = [one.ramp.up.size + one.ramp.down.size for one in error.pushed]
    # For each ramp three numbers are looked for at most.
    each_s = SEARCH_S / (3 * len(error.pushed))
    for rejection, one, own_steps in zip(error.rejections, error.pushed, steps, strict=False):

        def fits(design: Design, axis: int = one.axis, path: str = one.path) -> bool:
            instead = [*designs]
            instead[axis if len(designs) > 1 else 0] = design
            try:
                try_to_plan(instead)
            except TooLong as still:
                # That other axes are too long by themselves is told of them.
                return not still.together and all(each.path != path for each in still.pushed)
            except Rejected:
                return False
            return True

        def fits_soon(design: Design, others: int = sum(steps) - own_steps, fits: Fits = fits) -> bool:
            return others + 2 * longest_side(design) <= MOST_STEPS_TO_SEARCH and fits(design)

        yield _with(rejection, one.path, list(_remedies(one.design, fits, fits_soon, each_s)))


def _with(rejection: Rejection, path: str, remedies: Sequence[Remedy]) -> Rejection:
    if not remedies:
        return rejection
    *others, last = [remedy.text for remedy in remedies]
    ways = f"{', '.join(others)}, or {last}" if others else last
    in_place = (
        replace(remedy, changes=tuple(Change(path + each.field, each.value) for each in remedy.changes))
        for remedy in remedies
    )
    return replace(rejection, remedies=tuple(in_place), reason=f"{rejection.reason.removesuffix('.')}; {ways}.")


def _remedies(design: Design, fits: Fits, fits_soon: Fits, search_s: float) -> Iterator[Remedy]:
    """Yield what makes a design's ramp fit; numbers are looked for among ramps that are planned soon enough."""
    if not design.method.plays_table:
        yield from _least(design, _steeper, fits_soon, search_s)
        if design.ramp.shape.jerk_steps_per_s3 is not None:
            yield from _least(design, _sharper, fits_soon, search_s)
        yield from _least(design, _slower, fits_soon, search_s)
    yield from _computed(design, fits)


def _least(design: Design, by: Callable[[Design, float], Remedy], fits: Fits, search_s: float) -> Iterator[Remedy]:
    """Yield the remedy with about the least factor of those that fit, if there is one."""
    until_s = time.monotonic() + search_s

    def fitting(power: float) -> Remedy | None:
        remedy = by(design, 2.0**power)
        return remedy if time.monotonic() < until_s and _fits_changed(design, remedy.changes, fits) else None

    power, found = 0.0, None
    while found is None and power < DOUBLINGS:
        power += 1.0
        found = fitting(power)
    if found is None:
        return
    too_little = power - 1.0
    for _ in range(HALVINGS):
        middle = (too_little + power) / 2
        if better := fitting(middle):
            power, found = middle, better
        else:
            too_little = middle
    yield found


def _steeper(design: Design, factor: float) -> Remedy:
    """Raise the jerk with the square of the acceleration: the ramp keeps its form, over a shorter time."""
    return _raised(design, {"acceleration": factor, "deceleration": factor, "jerk": factor**2, "jerk down": factor**2})


def _sharper(design: Design, factor: float) -> Remedy:
    return _raised(design, {"jerk": factor, "jerk down": factor})


RAISED: dict[str, tuple[str, StepUnit]] = {
    "acceleration": ("ramp.acceleration_steps_per_s2", "steps/s²"),
    "deceleration": ("ramp.deceleration_steps_per_s2", "steps/s²"),
    "jerk": ("ramp.shape.jerk_steps_per_s3", "steps/s³"),
    "jerk down": ("ramp.shape.deceleration_jerk_steps_per_s3", "steps/s³"),
}
"""Field and unit of what can be raised, as it is called."""


def _raised(design: Design, factors: dict[str, float]) -> Remedy:
    """Return the remedy that raises so many times what the design has of these."""
    changes: list[Change] = []
    ways: list[str] = []
    told: list[Told] = []
    for word, factor in factors.items():
        field, unit = RAISED[word]
        if (present := _value_at(design, field)) is None:
            continue
        value = lowest(present * factor, FIGURES)
        changes.append(Change(field, value))
        told.append(Told.of(value, unit, EXACTLY, "up"))
        ways.append(f"the {word} to {told[-1]}")
    return Remedy(f"raise {' and '.join(ways)}", tuple(changes), tuple(told))


def _value_at(design: Design, field: str) -> float | None:
    value: Any = design
    for part in field.split("."):
        value = getattr(value, part)
    return None if value is None else float(value)


def _slower(design: Design, factor: float) -> Remedy:
    speed = highest(design.ramp.slew_speed_steps_per_s / factor, FIGURES)
    told = Told.of(speed, "steps/s", EXACTLY, "down")
    changes = (Change("ramp.slew_speed_steps_per_s", speed),)
    return Remedy(f"lower the slew speed to {told}", changes, (told,))


def _computed(design: Design, fits: Fits) -> Iterator[Remedy]:
    """Yield a method that the controller can compute while it plays the ramp: the design's own, or the most exact."""
    for name in dict.fromkeys([design.method.name, *reversed(ON_CHIP)]):
        wanted = {"name": name, "arithmetic": "fixed", "rounding": "nearest"}
        present = design.method.model_dump()
        changes = tuple(Change(f"method.{key}", value) for key, value in wanted.items() if present[key] != value)
        if name in ON_CHIP and changes and _fits_changed(design, changes, fits):
            yield Remedy(f"use a formula ({METHODS[name].label}, in fixed arithmetic)", changes)
            return


def _fits_changed(design: Design, changes: Changes, fits: Fits) -> bool:
    """Tell whether changes make a design that fits; those that make none don't."""
    document = design.model_dump(by_alias=True)
    for change in changes:
        *parts, name = change.field.split(".")
        part: Any = document
        for each in parts:
            part = part[each]
        part[name] = change.value
    try:
        return fits(Design.checked(document))
    except Rejected:
        return False
