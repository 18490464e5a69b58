"""What may be changed of a design so that its motor makes the move: one number each, or the ramp's shape.

The least of each is looked for by who asks: `proposals`, and `at_fault` where no ramp is gentle enough.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from stepramp.design import Design
from stepramp.drive_train import Drive
from stepramp.errors import Change, Remedy, StepUnit, Told
from stepramp.motor.changes import reshaping
from stepramp.motor.limits import greatest_start_speed
from stepramp.motor.torque import drive_train
from stepramp.motor.verdict import MOST_USED
from stepramp.numerics.limit_text import highest

EXACTLY = 15
"""Figures of a number that is to be put in place of another, as it is told: all of it."""
FIGURES = 3
LESS = tuple(0.7**power for power in range(1, 14))
"""Parts of a number that are tried, down to a hundredth of it."""
CLOCKS_HZ = (1e6, 2e6, 4e6, 8e6, 16e6, 32e6, 64e6, 125e6)
SUPPLIES_V = (12.0, 24.0, 36.0, 48.0, 60.0, 72.0, 80.0)
MICROSTEPS = (2, 4, 8, 16, 32, 64, 128, 256)
MOST_SPEED = 1e6
"""A design's speeds are at most that [steps/s]."""


@dataclass(frozen=True)
class Way:
    """One thing that may be changed: values that are tried, the mildest first, and what each makes of the design."""

    field: str
    own: float
    """The design's number; NaN where it is a shape that is changed."""
    values: tuple[float, ...]
    made: Callable[[float], Remedy]
    is_even: bool = False
    """Whether any number between two values will do as well, and the less it is, no more torque is asked for."""

    def how_far(self, value: float) -> float:
        """Return how many times the number grows or shrinks; infinite to 0."""
        return max(value / self.own, self.own / value) if value else math.inf


def ways_of(design: Design, peak_speed: float, *, with_stop: bool) -> list[Way]:
    """Return what may be changed. peak_speed: of the design's move [steps/s]. with_stop: whether also how it stops."""
    ways = [*hardware(design)]
    if design.method.plays_table:
        ways += [*_longer_delays(design)]
    else:
        ways += [
            gentler(design), slower(design, peak_speed), *slower_start(design), *_less_torque(design),
            *_other_shapes(design),
        ]  # fmt: skip
        if with_stop or design.ramp.deceleration_steps_per_s2 is not None:
            ways.append(gentler_stop(design))
    return ways


def gentler(design: Design) -> Way:
    """Return lower accelerations, and with them a deceleration that is given, in proportion."""
    own, down = design.ramp.acceleration_steps_per_s2, design.ramp.deceleration_steps_per_s2

    def made(rate: float) -> Remedy:
        remedy = _lowered("acceleration", "ramp.acceleration_steps_per_s2", rate, "steps/s²")
        if down is None:
            return remedy
        slowing = highest(down * rate / own, FIGURES)
        down_to = Told.of(slowing, "steps/s²", EXACTLY, "down")
        changes = (*remedy.changes, Change("ramp.deceleration_steps_per_s2", slowing))
        return Remedy(f"{remedy.text} and the deceleration to {down_to}", changes, (*remedy.told, down_to))

    return Way("ramp.acceleration_steps_per_s2", own, _parts_of(own), made, is_even=True)


def gentler_stop(design: Design) -> Way:
    """Return lower decelerations."""
    field, own = "ramp.deceleration_steps_per_s2", design.ramp.slowdown_steps_per_s2
    return Way(field, own, _parts_of(own), lambda rate: _lowered("deceleration", field, rate, "steps/s²"), is_even=True)


def slower(design: Design, peak_speed: float) -> Way:
    """Return lower slew speeds: a move that doesn't reach its slew speed feels nothing of them down to its peak."""
    field, own, base = (
        "ramp.slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s, design.ramp.base_speed_steps_per_s,
    )  # fmt: skip
    values = tuple(speed for speed in _parts_of(min(own, peak_speed)) if speed > base)
    return Way(field, own, values, lambda speed: _lowered("slew speed", field, speed, "steps/s"), is_even=True)


def slower_altogether(design: Design) -> Way:
    """Return the same ramp slowed down: speeds by a part, accelerations by its square, jerks by its cube."""
    ramp = design.ramp

    def made(part: float) -> Remedy:
        rates = {"acceleration_steps_per_s2": part**2, "deceleration_steps_per_s2": part**2}
        by = {"base_speed_steps_per_s": part, "slew_speed_steps_per_s": part, **rates}
        told = [(field, getattr(ramp, field)) for field in by if getattr(ramp, field) is not None]
        changes = [Change(f"ramp.{field}", highest(value * by[field], FIGURES)) for field, value in told]
        changes += _shape_times(design, part, part**3)
        return Remedy(f"slow the whole ramp down to {part:.2g} of its speed", tuple(changes))

    return Way("ramp.slew_speed_steps_per_s", 1.0, LESS, made, is_even=True)


def slower_start(design: Design) -> Iterator[Way]:
    """Yield lower base speeds, down to none, where there is one."""
    field, own = "ramp.base_speed_steps_per_s", design.ramp.base_speed_steps_per_s
    greatest = greatest_start_speed(drive_train(design))
    values = (*_parts_of(min(own, greatest) if greatest > 0 else own), 0.0)
    if own > 0:
        yield Way(field, own, values, lambda speed: _lowered("base speed", field, speed, "steps/s"), is_even=True)


def finer_clock(design: Design) -> Way:
    """Return faster timers."""
    field, own = "timer.frequency_hz", design.timer.frequency_hz

    def made(clock_hz: float) -> Remedy:
        return Remedy(f"use a timer of {clock_hz / 1e6:g} MHz", (Change(field, clock_hz),))

    return Way(field, own, tuple(each for each in CLOCKS_HZ if each > own), made)


def finer_microsteps(design: Design) -> Iterator[Way]:
    """Yield finer microsteps for the same move: as many times more steps, speeds and accelerations of the driver.

    Not for a lookup table, which is of steps, nor for gauges, which have no others.
    """
    own, ramp = design.axis.microsteps, design.ramp
    if design.method.plays_table or (design.motor is not None and design.motor.kind == "gauge"):
        return

    def made(microsteps: float) -> Remedy:
        times = microsteps / own
        scaled = {
            "base_speed_steps_per_s": ramp.base_speed_steps_per_s * times,
            "slew_speed_steps_per_s": ramp.slew_speed_steps_per_s * times,
            "acceleration_steps_per_s2": ramp.acceleration_steps_per_s2 * times,
        }
        if ramp.deceleration_steps_per_s2 is not None:
            scaled["deceleration_steps_per_s2"] = ramp.deceleration_steps_per_s2 * times
        changes = [Change(f"ramp.{name}", value) for name, value in scaled.items()]
        changes += _shape_times(design, times, times)
        return Remedy(
            f"use {microsteps:g} microsteps a full step for the same move",
            (
                Change("axis.microsteps", int(microsteps)), *changes,
                Change("move.steps", round(design.move.steps * times)),
            ),
        )  # fmt: skip

    finer = [each for each in MICROSTEPS if each > own and each % own == 0]
    values = tuple(float(each) for each in finer if each / own * ramp.slew_speed_steps_per_s <= MOST_SPEED)
    yield Way("axis.microsteps", float(own), values, made)


def hardware(design: Design) -> Iterator[Way]:
    """Yield what leaves the ramp as it is."""
    yield finer_clock(design)
    yield from finer_microsteps(design)
    if design.motor is None or design.motor.kind == "gauge":
        return  # No driver regulates the current of its coils.
    then = design.motor.pinned(design.drive).measured_with
    pinned = () if then == design.motor.measured_with or then is None else (_measured_with(then),)

    def made(volts: float) -> Remedy:
        return Remedy(f"raise the supply to {volts:g} V", (Change("drive.supply_v", volts), *pinned))

    volts = drive_train(design).supply_v
    yield Way("drive.supply_v", volts, tuple(each for each in SUPPLIES_V if each > volts), made)
    rated, drive = design.motor.rated_current_a, design.drive
    if drive is not None and drive.current_a is not None:
        own = drive.current_a if drive.current_is == "rms" else drive.current_a / math.sqrt(2)
        changes = (Change("drive.current_a", rated), Change("drive.current_is", "rms"), *pinned)
        remedy = Remedy(f"set the driver to the motor's rated current, {rated:g} A rms", changes)
        yield Way("drive.current_a", own, (rated,) if own < rated else (), lambda _: remedy)


def _measured_with(drive: Drive) -> Change:
    return Change("motor.measured_with", drive.model_dump())


def _less_torque(design: Design) -> Iterator[Way]:
    """Yield lower margins of a ramp that is shaped by torque."""
    field, own = "ramp.shape.margin", design.ramp.shape.margin
    if own is not None:

        def made(value: float) -> Remedy:
            return Remedy(f"use {value:.3g} of the torque", (Change(field, value),))

        yield Way(field, own, _parts_of(own), made, is_even=True)


def _other_shapes(design: Design) -> Iterator[Way]:
    """Yield the S-curve whose onset takes one natural period, and the ramp that asks for what the motor has."""
    own, ramp = design.ramp.shape.name, design.ramp
    if own != "s_curve":
        jerk = highest(ramp.acceleration_steps_per_s2 * drive_train(design).natural_frequency_hz, FIGURES)
        shape: dict[str, object] = {"name": "s_curve", "jerk_steps_per_s3": jerk}
        told = Told.of(jerk, "steps/s³", EXACTLY, "down")
        yield _reshaped(f"use an S-curve with a jerk of {told}", reshaping(design, shape), told)
    if own != "torque":
        shape = {"name": "torque", "margin": MOST_USED}
        yield _reshaped(f"shape the ramp by the torque, {MOST_USED:.0%} of it", reshaping(design, shape))


def _reshaped(text: str, changes: tuple[Change, ...], *told: Told) -> Way:
    return Way("ramp.shape", math.nan, (math.nan,), lambda _: Remedy(text, changes, told))


def _shape_times(design: Design, speeds: float, jerks: float) -> list[Change]:
    """Return what makes the speeds and the jerks that a shape has so many times as large; nothing where it has none."""
    before = design.ramp.shape.model_dump(by_alias=True)
    shape = dict(before)
    for field in ("jerk_steps_per_s3", "deceleration_jerk_steps_per_s3"):
        if shape.get(field) is not None:
            shape[field] *= jerks
    if shape.get("points") is not None:
        shape["points"] = [(speed * speeds, part) for speed, part in shape["points"]]
    return [] if shape == before else [Change("ramp.shape", shape)]


def _longer_delays(design: Design) -> Iterator[Way]:
    """Yield lookup tables with longer delays, as parts of their speeds."""
    rows = design.table.rows if design.table else []

    def made(part: float) -> Remedy:
        slower_rows = [(index, math.ceil(delay / part)) for index, delay in rows]
        return Remedy(
            f"make all delays of the table {1 / part:.3g} times as long", (Change("table.rows", slower_rows),)
        )

    if rows:
        yield Way("table.rows", 1.0, LESS, made)


def _parts_of(own: float) -> tuple[float, ...]:
    return tuple(highest(own * part, FIGURES) for part in LESS)


def _lowered(what: str, field: str, value: float, unit: StepUnit) -> Remedy:
    told = Told.of(value, unit, EXACTLY, "down")
    return Remedy(f"lower the {what} to {told}", (Change(field, value),), (told,))
