"""What a verdict about a motor rests on: where each of its numbers comes from, and what no figure covers."""

from collections.abc import Iterator
from functools import reduce
from typing import Literal

from stepramp.design import Design
from stepramp.drive_train import Motor
from stepramp.motor.presets import PRESETS, Preset
from stepramp.validation import Document

Origin = Literal["measured", "datasheet", "given", "assumed", "unused"]
"""given: typed, from wherever. assumed: a usual value stands for it, or its preset's maker doesn't tell it. unused: it
is told, and something else counts in its place."""

FEWEST_ALIKE = 3
"""So many figures of a motor are those of a preset that it began with."""
NONE_AS_ZERO = ("load.inertia_g_cm2", "load.torque_nm")
"""Where 0 is none, told or not."""
NOT_A_NUMBER = ("kind", "name", "mechanism")

NOT_COVERED = (
    "closed-loop drives, hot windings, a supply that sags, belts and couplings that give, NEMA 34 motors unless a "
    "point was measured"
)


def origins_of(design: Design) -> dict[str, Origin]:
    """Return where each number of a design's motor, drive and load comes from, by its path; none without a motor.

    What is left open and means none isn't among them; motor.full_steps_per_rev left open is the axis's.
    """
    motor = design.motor
    if motor is None:
        return {}
    unused = set(_unused(design, motor))
    found: dict[str, Origin] = dict.fromkeys(assumed_of(design), "assumed")
    for path in _told(design):
        found[path] = "unused" if path in unused else _source(design, motor, path)
    return found


def assumed_of(design: Design) -> Iterator[str]:
    """Yield the paths of what a design leaves open about its motor, its drive and its load: a usual value counts."""
    motor, drive, load = design.motor, design.drive, design.load
    if motor is not None and motor.detent_torque_nm is None:
        yield "motor.detent_torque_nm"
    if motor is not None and motor.pull_out_factor is None and not motor.is_measured:
        yield "motor.pull_out_factor"
    if drive is None or drive.supply_v is None:
        yield "drive.supply_v"
    if drive is None or drive.current_a is None:
        yield "drive.current_a"
    if load is None or not load.friction_is_told:
        yield "load.friction_nm"
    if load is not None and load.mechanism is not None:
        yield from (f"load.mechanism.{field}" for field in load.mechanism.assumed)


def torque_is_measured(design: Design) -> bool:
    """Tell whether a design's pull-out torque is what somebody measured, and no preset's."""
    motor = design.motor
    if motor is None or not motor.is_measured:
        return False
    path = "motor.stalled" if motor.torque_curve is None else "motor.torque_curve"
    return _source(design, motor, path) == "measured"


def _unused(design: Design, motor: Motor) -> Iterator[str]:
    """Yield the paths of what doesn't count, if it is told."""
    if motor.torque_curve is not None:
        yield "motor.stalled"
    if motor.is_measured:
        yield "motor.pull_out_factor"
    else:
        yield "motor.measured_with"
    if design.drive is not None and design.drive.current_a is None:
        yield "drive.current_is"


def _told(design: Design) -> Iterator[str]:
    for place in ("motor", "drive", "load", "load.mechanism"):
        part = _value(design, place)
        for field in type(part).model_fields if isinstance(part, Document) else ():
            path, value = f"{place}.{field}", getattr(part, field)
            is_none = value is None or (value == 0 and path in NONE_AS_ZERO)
            if not is_none and field not in NOT_A_NUMBER:
                yield path


def _source(design: Design, motor: Motor, path: str) -> Origin:
    nearest = max(PRESETS, key=lambda preset: _alike(preset, motor))
    if _alike(nearest, motor) >= FEWEST_ALIKE and _value(nearest, path) == _value(design, path):
        # A part's source is that of all its fields.
        known = [source for whole, source in nearest.sources.items() if path == whole or path.startswith(f"{whole}.")]
        if known:
            return known[0]
    return "measured" if path in ("motor.stalled", "motor.torque_curve", "motor.measured_with") else "given"


def _alike(preset: Preset, motor: Motor) -> int:
    """Return how many figures of a motor are as a preset has them."""
    return sum(getattr(preset.motor, field) == getattr(motor, field) for field in preset.motor.model_fields_set)


def _value(holder: object, path: str) -> object:
    return reduce(lambda part, name: getattr(part, name, None), path.split("."), holder)
