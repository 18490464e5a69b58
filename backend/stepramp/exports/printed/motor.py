"""What a report says of a design's motor: its data and where they come from, what it does with the move, and why."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.drive_train import Drive, Load, Motor
from stepramp.errors import Rejected
from stepramp.exports.printed.numbers import plain
from stepramp.exports.printed.table import Table
from stepramp.exports.printed.told import in_units, shown
from stepramp.motor.fastest import fastest_of
from stepramp.motor.limits import SMOOTH, SUDDEN, greatest_acceleration, greatest_start_speed, resonances
from stepramp.motor.origins import NOT_COVERED, Origin, origins_of
from stepramp.motor.presets import preset_of
from stepramp.motor.proposals import proposals_of
from stepramp.motor.torque import TorqueCurve, drive_train, torque_curve_of
from stepramp.motor.verdict import MOST_USED, USUAL_DAMPING, Cause, Evidence, Outcome, cause_of, outcome_of
from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.limit_text import highest
from stepramp.ramp.thinning import kept_steps
from stepramp.units import Quantity, ShownUnits, g_cm2_from_kg_m2

CAUSES: dict[Cause, str] = {
    "start": "it begins faster than the motor can start",
    "onset": "the acceleration comes on harder than the motor follows",
    "top_speed": "the motor has too little torque at that speed",
    "resonance": "its rotor swings in time with the steps",
    "timer": "the timer is too coarse: before its intervals are rounded the move loses nothing",
    "stop": "the ramp down is harder than the motor follows",
}
EVIDENCE: dict[Evidence, str] = {
    "no_torque": "it asks for torque where the motor has none",
    "measured_torque": "it asks for more torque than the motor was measured to have, whatever the model's rotor does",
    "lost_steps": "the model's rotor loses steps",
    "load_angle": "the model's rotor is over 90° from the field, or swings for long",
    "torque": "it asks for more torque than leaves a margin",
}
WORDS: dict[Origin | None, str] = {
    "measured": "measured",
    "datasheet": "data sheet",
    "given": "given",
    "assumed": "assumed",
    "unused": "told, but doesn't count",
}
ROTOR = (
    "ζ", "the first step lost", "largest load angle, electrical", "largest ripple of its slew speed",
    "beyond its end, electrical", "settled after",
)  # fmt: skip
FIGURES = 4
MOST_POINTS = 4000
NAMES = {
    "resistance_ohm": ("resistance of a phase", "Ω"),
    "inductance_mh": ("inductance of a phase", "mH"),
    "holding_torque_nm": ("holding torque", "Nm"),
    "rated_current_a": ("rated current", "A"),
    "full_steps_per_rev": ("full steps of a turn", ""),
    "rotor_inertia_g_cm2": ("inertia of the rotor", "g·cm²"),
    "detent_torque_nm": ("detent torque", "Nm"),
    "supply_v": ("supply", "V"),
    "current_a": ("current", "A"),
    "inertia_g_cm2": ("inertia beside the rotor", "g·cm²"),
    "torque_nm": ("constant torque", "Nm"),
    "friction_nm": ("friction", "Nm"),
    "lead_mm": ("lead", "mm"),
    "pulley_mm": ("pitch diameter of the pulley", "mm"),
    "mass_kg": ("mass", "kg"),
    "friction_n": ("friction of the mass", "N"),
    "efficiency": ("efficiency", ""),
    "incline_deg": ("incline", "°"),
}
"""What fields of the motor, the drive and the load are called, and their units."""


@dataclass(frozen=True)
class Played:
    """What is drawn of a move that was played through the motor's model."""

    torque: TorqueCurve
    steps: NDArray[np.int64]
    """Counted from 1, shape (M,)."""
    load_angles_deg: NDArray[np.float64]
    """The largest of each of them, with its sign, shape (M,)."""


@dataclass(frozen=True)
class MotorPart:
    """What a report says of the motor."""

    data: Table
    found: Table
    played: Played | None
    """None: the move couldn't be played."""
    rotor: Table | None = None
    """What the rotor does with each damping; None as of played."""

    @property
    def tables(self) -> tuple[Table, ...]:
        """All tables in order."""
        return (self.data, self.found) if self.rotor is None else (self.data, self.found, self.rotor)


def motor_part_of(design: Design, units: ShownUnits, is_wanted: Callable[[], bool] = lambda: True) -> MotorPart | None:
    """Return what is said of a design's motor; None without one. Raises NotWanted as outcome_of does."""
    if design.motor is None:
        return None
    data = Table("Motor, drive and load", ("figure", "value", "from"), tuple(_data(design, design.motor)))
    try:
        outcome, curve = outcome_of(design, is_wanted), torque_curve_of(design)
    except Rejected as rejected:
        told = "\n".join(in_units(each.message, each.told, units) for each in rejected.rejections)
        return MotorPart(data, _found(("verdict", f"not played: {told}")), None)
    angles = outcome.runs[USUAL_DAMPING].load_angles_deg
    kept = kept_steps(np.round(angles * 1000).astype(np.int64), outcome.profile.phases, MOST_POINTS)
    found = _found(
        *_verdict(outcome, units), *_limits(outcome.train, units), *_better(design, outcome, units, is_wanted)
    )
    rotor = Table("What its rotor does, by how much it is damped", ROTOR, tuple(_rotor(outcome)))
    return MotorPart(data, found, Played(curve, kept + 1, angles[kept]), rotor)


def _found(*rows: tuple[str, str]) -> Table:
    return Table("What the motor does with the move", ("figure", "value"), (*rows, ("not covered", NOT_COVERED)))


def _data(design: Design, motor: Motor) -> Iterator[tuple[str, str, str]]:
    preset, train, origins = preset_of(motor), drive_train(design), origins_of(design)

    def row(path: str, value: float, otherwise: str = "none") -> tuple[str, str, str]:
        name, unit = NAMES[path.rpartition(".")[2]]
        return name, f"{plain(value, FIGURES)} {unit}".rstrip(), WORDS.get(origins.get(path), otherwise)

    if preset is not None:
        yield "motor", preset.name, "a preset"
    for field in ("resistance_ohm", "inductance_mh", "holding_torque_nm", "rated_current_a", "rotor_inertia_g_cm2"):
        yield row(f"motor.{field}", getattr(motor, field))
    full_steps = train.periods_per_rev / train.periods_per_full_step
    yield row("motor.full_steps_per_rev", full_steps, "those of the axis")
    yield row("motor.detent_torque_nm", train.detent_nm)
    yield from _pull_out(motor, train, origins)
    if origins.get("motor.measured_with") == "measured":
        then = motor.driven_when_measured(design.drive).counted(motor.rated_current_a)
        told = f"{plain(then.supply_v, FIGURES)} V, {plain(then.peak_current_a, FIGURES)} A peak"
        yield "measured with", told, "measured"
    drive, load = design.drive or Drive(), design.load or Load()
    yield row("drive.supply_v", train.supply_v)
    current = (motor.rated_current_a, "rms") if drive.current_a is None else (drive.current_a, drive.current_is)
    name, value, of = row("drive.current_a", current[0])
    yield f"{name}, {current[1]}", value, of
    yield row("load.inertia_g_cm2", load.inertia_g_cm2)
    yield row("load.torque_nm", load.torque_nm)
    if load.mechanism is None:
        yield row("load.friction_nm", train.friction_nm)
        return
    mechanism = load.mechanism
    yield "mechanism", mechanism.name, "given"
    for field, counts in mechanism.counted.items():
        name, value, of = row(f"load.mechanism.{field}", counts)
        yield f"{mechanism.name}: {name}", value, of
    inertia = g_cm2_from_kg_m2(train.inertia_kg_m2)
    yield "inertia at the shaft, with the rotor", f"{plain(inertia, FIGURES)} g·cm²", "computed"
    yield "constant torque at the shaft", f"{plain(train.load_nm, FIGURES)} Nm", "computed"
    of_friction = "assumed" if origins.get("load.friction_nm") == "assumed" else "computed"
    yield "friction at the shaft", f"{plain(train.friction_nm, FIGURES)} Nm", of_friction


def _pull_out(motor: Motor, train: DriveTrain, origins: dict[str, Origin]) -> Iterator[tuple[str, str, str]]:
    """Yield what the pull-out torque is of, and last what is told of it and doesn't count."""
    factor = f"{plain(train.pull_out_factor, FIGURES)} of the model's"
    told = {"motor.pull_out_factor": f"{plain(motor.pull_out_factor or train.pull_out_factor, FIGURES)} of the model's"}
    if motor.stalled is not None:
        stalled = f"it stalled at {plain(motor.stalled.rpm)} rpm with {plain(motor.stalled.torque_nm)} Nm"
        told["motor.stalled"] = stalled if motor.torque_curve else f"{factor}: {stalled}"
    if motor.torque_curve is not None:
        told["motor.torque_curve"] = f"a curve of {len(motor.torque_curve)} points"
    for path, text in sorted(told.items(), key=lambda each: origins.get(each[0]) == "unused"):
        if path in origins:
            yield "pull-out torque", text, WORDS[origins[path]]


def _verdict(outcome: Outcome, units: ShownUnits) -> Iterator[tuple[str, str]]:
    cause, run = cause_of(outcome), outcome.worst
    yield "verdict", outcome.verdict
    if cause is not None:
        yield "why", CAUSES[cause]
    if outcome.evidence is not None:
        yield "what shows it", EVIDENCE[outcome.evidence]
    if run.first_lost_step:
        yield "lost", f"{_lost(outcome.lost_full_steps)}; the first after step {run.first_lost_step:,}"
    yield from _used(outcome, shown(outcome.most_used_at, units, "speed"))
    yield "largest load angle", f"{plain(run.largest_load_angle_deg, 3)} electrical °; a full step is 90° of two phases"
    dampings = ", ".join(plain(damping) for damping in outcome.runs)
    yield "played with dampings of", f"{dampings}; the plot has {plain(USUAL_DAMPING)}"


def _limits(train: DriveTrain, units: ShownUnits) -> Iterator[tuple[str, str]]:
    yield "natural frequency", f"{plain(train.natural_frequency_hz, FIGURES)} Hz"
    limits: tuple[tuple[str, Quantity, float], ...] = (
        ("greatest start speed", "speed", greatest_start_speed(train)),
        ("greatest sudden acceleration", "acceleration", greatest_acceleration(train, SUDDEN)),
        ("the same over a natural period", "acceleration", greatest_acceleration(train, SMOOTH)),
    )
    for name, quantity, value in limits:
        # A limit is told so that what is told is allowed.
        yield name, f"{plain(highest(units.factor(quantity) * value, FIGURES))} {units.word(quantity)}"
    bands = [[plain(units.factor("speed") * end, FIGURES) for end in band] for band in resonances(train)]
    yield "resonances", " and ".join(f"from {low} to {high} {units.word('speed')}" for low, high in bands)


def _better(
    design: Design, outcome: Outcome, units: ShownUnits, is_wanted: Callable[[], bool]
) -> Iterator[tuple[str, str]]:
    """Yield what to change, and the fastest safe ramp."""
    for remedy in proposals_of(design, outcome, cause_of(outcome), is_wanted):
        yield "what would make it safe", in_units(remedy.text, remedy.told, units)
    yield "the fastest safe ramp", fastest_of(design, MOST_USED, is_wanted).words


def _rotor(outcome: Outcome) -> Iterator[tuple[str, ...]]:
    for damping, run in outcome.runs.items():
        ripple = outcome.speed_ripple(run)
        yield (
            plain(damping),
            f"after step {run.first_lost_step:,}" if run.first_lost_step else "none",
            f"{plain(run.largest_load_angle_deg, 3)}°",
            "no slew phase" if ripple is None else f"{plain(100 * ripple, 3)} %",
            f"{plain(run.overshoot_deg, 3)}°",
            f"{plain(1000 * run.settled_after_s, 3)} ms",
        )


def _lost(full_steps: int) -> str:
    """Return in words how far the rotor is from where it should be at the end."""
    if full_steps == 0:
        return "none at the end: it came back to its place"
    return f"{abs(full_steps):,} full steps {'behind' if full_steps > 0 else 'too far'} at the end"


def _used(outcome: Outcome, at: str) -> Iterator[tuple[str, str]]:
    if np.isinf(outcome.most_used):
        yield "torque that is used", f"there is none at {at}, where some is asked for"
        return
    yield "torque that is used", f"at most {plain(100 * outcome.most_used, 3)} %, at {at}"
    kept = f"{plain(100 * (1 - outcome.most_used), 3)} %" if outcome.most_used < 1 else "none"
    yield "torque that is kept back", f"{kept}; {100 * (1 - MOST_USED):g} % should be"
