"""What a report says: tables of texts and the lines of its plots, in the units that people have chosen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, MethodName
from stepramp.errors import Rejected, Rejection
from stepramp.exports.matplotlib_turn import style_of
from stepramp.exports.printed.checks import Check, checks_of
from stepramp.exports.printed.motor import MotorPart, motor_part_of
from stepramp.exports.printed.numbers import plain, signed
from stepramp.exports.printed.stall_maps import PlayedMap, StallMapPlot, stall_map_plot
from stepramp.exports.printed.table import Table
from stepramp.exports.printed.told import shown
from stepramp.exports.shape_text import shape_text
from stepramp.methods import METHODS, REFERENCE
from stepramp.ramp.drawing import Drawing, Drawn
from stepramp.ramp.error_curves import ErrorCurves
from stepramp.units import LengthUnit, ShownUnits, TimeUnit, us_from_ticks
from stepramp.version import __version__

MOST_POINTS = 4000
PINNED_STYLE = {"color": "#7a8491", "linewidth": 1.4, "linestyle": "--"}


@dataclass(frozen=True)
class Asked:
    """What a report is asked to be about."""

    design: Design
    pinned: Design | None
    """A design that it is compared with."""
    methods: tuple[MethodName, ...]
    """Methods that the design's own is compared with."""
    length: LengthUnit
    time: TimeUnit
    maps: tuple[PlayedMap, ...] = ()
    """Stall maps of the design that were played before."""


@dataclass(frozen=True)
class Line:
    """A move as it is drawn; arrays of shape (M,)."""

    label: str
    style: dict[str, Any]
    step: NDArray[np.int64]
    speed: NDArray[np.float64]
    """In the chosen unit."""
    delay_us: NDArray[np.float64]
    error_percent: NDArray[np.float64]
    acceleration: NDArray[np.float64] | None
    """As planned, in the chosen unit; None where it isn't shown."""
    jerk: NDArray[np.float64] | None


@dataclass(frozen=True)
class Report:
    """All that a report says."""

    title: str
    made: str
    """When, and by what."""
    parameters: Table
    move: Table
    checks: Table
    methods: Table
    lookup_table: Table | None
    drawn_ramp: Table | None
    """The points of a drawn acceleration; None: it has another shape."""
    motor: MotorPart | None
    """None: nothing is known of the motor."""
    maps: tuple[StallMapPlot, ...]
    lines: tuple[Line, ...]
    units: ShownUnits

    @property
    def tables(self) -> tuple[Table, ...]:
        """All tables in order."""
        of_motor = () if self.motor is None else self.motor.tables
        all_of_them = (
            self.parameters,
            self.move,
            self.checks,
            *of_motor,
            self.methods,
            self.drawn_ramp,
            self.lookup_table,
        )
        return tuple(table for table in all_of_them if table is not None)


def report_of(asked: Asked, made_on: date, is_wanted: Callable[[], bool] = lambda: True) -> Report:
    """Return what a report says.

    Raises Rejected when a design can't be planned, or has no length in the chosen unit; NotWanted as outcome_of does.
    """
    units = _units_of(asked.design, asked)
    lines: list[Line] = []
    figures: list[tuple[str, ...]] = []
    own: ErrorCurves | None = None
    methods = tuple(dict.fromkeys((asked.design.method.name, *asked.methods)))
    for method, drawn in _drawing(asked.design, methods).methods():
        label = METHODS[method].label
        if isinstance(drawn, Rejected):
            if own is None:
                raise drawn
            figures.append((label, *[""] * 6, f"fails: {drawn}"))
            continue
        lines.append(_line(label, style_of(method), drawn, units, is_own=own is None))
        own = own or drawn.judged
        figures.append((label, *_figures(drawn.judged, units)))
    assert own is not None
    if asked.pinned is not None:
        line, pinned_figures = _pinned(asked.pinned, asked)
        lines.append(line)
        figures.append(pinned_figures)
    return Report(
        title=asked.design.name or "Ramp",
        made=f"{made_on.day} {made_on:%B %Y}, by StepRamp {__version__}",
        parameters=_parameters_table(asked, units),
        move=Table("The move", ("figure", "value"), tuple(_move(own, units))),
        checks=_checks_table(checks_of(asked.design, own.profile, units)),
        methods=Table("Methods against exact", _figures_head(), tuple(figures)),
        lookup_table=_lookup_table(asked.design),
        drawn_ramp=_drawn_ramp(asked.design, units),
        motor=motor_part_of(asked.design, units, is_wanted),
        maps=tuple(stall_map_plot(each, asked.design, units) for each in asked.maps),
        lines=tuple(lines),
        units=units,
    )


def _units_of(design: Design, asked: Asked) -> ShownUnits:
    length_of_step = design.axis.length_of_step(asked.length)
    if length_of_step is None:
        allowed = f"steps, rev or deg: the travel of '{design.name}' is in {design.axis.travel_unit}"
        raise Rejected([Rejection("units.length", asked.length, allowed)])
    return ShownUnits(asked.length, asked.time, length_of_step)


def _pinned(design: Design, asked: Asked) -> tuple[Line, tuple[str, ...]]:
    """Return the line and the figures of the pinned design by its own method, against its own exact ramp."""
    try:
        units = _units_of(design, asked)
        [(_, drawn)] = _drawing(design, (design.method.name,)).methods()
        if isinstance(drawn, Rejected):
            raise drawn
    except Rejected as rejected:
        raise _of_pinned(rejected) from None
    label = f"pinned: {design.name or 'Ramp'}, {METHODS[design.method.name].label}"
    line = _line(label, PINNED_STYLE, drawn, units, is_own=True)
    return line, (label, *_figures(drawn.judged, units))


def _of_pinned(rejected: Rejected) -> Rejected:
    """Return a rejection with the field's path in the pinned design; the units are those of the whole report."""
    return Rejected(
        [each if each.field.startswith("units.") else each.within("pinned.") for each in rejected.rejections],
        rejected.more,
    )


def _drawing(design: Design, methods: tuple[MethodName, ...]) -> Drawing:
    return Drawing(design, methods, REFERENCE, MOST_POINTS, with_motion=True)


def _line(label: str, style: dict[str, Any], drawn: Drawn, units: ShownUnits, *, is_own: bool) -> Line:
    """Return a line. is_own: it is by its design's own method, of which alone the motion is shown."""
    judged, kept = drawn.judged, drawn.kept
    intervals = judged.played_ticks[kept]
    motion = drawn.motion if is_own else None
    return Line(
        label=label,
        style=style,
        step=kept + 1,
        speed=units.factor("speed") * judged.timer_hz / intervals,
        delay_us=np.asarray(us_from_ticks(1, judged.timer_hz) * intervals),
        error_percent=100 * judged.relative_error[kept],
        acceleration=units.factor("acceleration") * motion.acceleration_steps_per_s2[kept] if motion else None,
        jerk=units.factor("jerk") * motion.jerk_steps_per_s3[kept] if motion else None,
    )


def _parameters_table(asked: Asked, units: ShownUnits) -> Table:
    rows = _parameters(asked.design, units)
    if asked.pinned is None:
        return Table("Parameters", ("parameter", "value"), tuple(rows))
    others = _parameters(asked.pinned, _units_of(asked.pinned, asked))
    both = [(name, value, other) for (name, value), (_, other) in zip(rows, others, strict=True)]
    return Table("Parameters", ("parameter", "value", f"pinned: {asked.pinned.name or 'Ramp'}"), tuple(both))


def _parameters(design: Design, units: ShownUnits) -> list[tuple[str, str]]:
    ramp, timer, method, axis = design.ramp, design.timer, design.method, design.axis
    return [
        ("base speed", shown(ramp.base_speed_steps_per_s, units, "speed")),
        ("slew speed", shown(ramp.slew_speed_steps_per_s, units, "speed")),
        ("acceleration", shown(ramp.acceleration_steps_per_s2, units, "acceleration")),
        ("deceleration", shown(ramp.slowdown_steps_per_s2, units, "acceleration")),
        ("shape", shape_text(ramp.shape, design.move, lambda jerk: shown(jerk, units, "jerk"))),
        ("move", shown(design.move.steps, units, "length")),
        ("timer", f"{plain(timer.frequency_hz, 10)} Hz, {timer.counter_bits} bits"),
        ("shortest interval", f"{plain(timer.shortest_interval_us)} µs"),
        ("method", f"{METHODS[method.name].label} in {method.arithmetic}, rounding {method.rounding}"),
        ("motor", f"{axis.full_steps_per_rev:,} full steps a turn, {axis.microsteps:,} pulses each"),
        ("travel", f"{plain(axis.travel_per_rev)} {axis.travel_unit} a turn"),
    ]


def _move(own: ErrorCurves, units: ShownUnits) -> list[tuple[str, str]]:
    profile = own.profile
    shortest, longest = int(profile.intervals_ticks.min()), int(profile.intervals_ticks.max())
    steps = profile.intervals_ticks.size
    length = shown(steps, units, "length")
    return [
        ("length", length if units.length == "steps" else f"{length}, {steps:,} steps"),
        ("direction", "forward" if profile.direction > 0 else "backward"),
        ("duration", f"{plain(profile.duration_s)} s"),
        ("peak speed", shown(profile.peak_speed_steps_per_s, units, "speed")),
        ("longest interval", _interval(longest, own.timer_hz)),
        ("shortest interval", _interval(shortest, own.timer_hz)),
        *((each.name, f"{each.last_step - each.first_step + 1:,} steps") for each in profile.phases),
    ]


def _interval(ticks: int, timer_hz: float) -> str:
    return f"{plain(us_from_ticks(ticks, timer_hz))} µs, {ticks:,} ticks"


def _checks_table(checks: Sequence[Check]) -> Table:
    rows = tuple((check.what, check.verdict, check.detail) for check in checks)
    return Table("Checks", ("what was checked", "verdict", "by these figures"), rows)


def _figures_head() -> tuple[str, ...]:
    return (
        "method", "duration", "largest error", "at step", "r.m.s. error", "largest acceleration", "time difference",
        "last-step speed error",
    )  # fmt: skip


def _figures(judged: ErrorCurves, units: ShownUnits) -> tuple[str, ...]:
    worst = judged.largest_relative_error
    return (
        f"{plain(judged.profile.duration_s)} s",
        f"{signed(100 * worst.value)} %",
        f"{worst.step:,}",
        f"{plain(100 * judged.rms_relative_error, 3)} %",
        shown(judged.peak_acceleration.value, units, "acceleration"),
        f"{signed(1000 * judged.time_difference_s, 4)} ms",
        f"{signed(units.factor('speed') * judged.landing_error_steps_per_s, 4)} {units.word('speed')}",
    )


def _lookup_table(design: Design) -> Table | None:
    if design.table is None:
        return None
    unit = "µs" if design.table.interval_unit == "us" else "ticks"
    rows = tuple((f"{row}", f"{last:,}", f"{delay:,}") for row, (last, delay) in enumerate(design.table.rows, 1))
    return Table("Lookup table", ("row", "last ramp index", f"delay, {unit}"), rows)


def _drawn_ramp(design: Design, units: ShownUnits) -> Table | None:
    if design.ramp.shape.points is None:
        return None
    rows = tuple(
        (f"{number}", shown(speed, units, "speed"), f"{plain(100 * part)} %")
        for number, (speed, part) in enumerate(design.ramp.shape.points, 1)
    )
    return Table("Drawn ramp", ("point", "at speed", "part of the acceleration"), rows)
