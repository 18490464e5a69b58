"""StepRamp from Python: a design that plans its move, and a profile that compares and draws itself."""

import math
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from stepramp import design as document
from stepramp.design import MethodName, Schema
from stepramp.errors import Change, Limits, Rejected, Rejection, Remedy
from stepramp.executors.choice import executor
from stepramp.figure import figure_of
from stepramp.methods import REFERENCE
from stepramp.motor.asked import MapAsked, MarginAsked, SpeedsAsked
from stepramp.motor.changes import with_changes
from stepramp.motor.fastest import Fastest, fastest_of
from stepramp.motor.map_points import SPACINGS, Over, verdict_at
from stepramp.motor.map_ranges import UNITS, question_of
from stepramp.motor.origins import Origin, assumed_of, origins_of
from stepramp.motor.presets import PRESETS
from stepramp.motor.proposals import proposals_of
from stepramp.motor.stall_map import stall_map
from stepramp.motor.torque import Torques, torques_at
from stepramp.motor.verdict import MOST_USED, USUAL_DAMPING, Cause, Evidence, Outcome, Verdict, cause_of, outcome_of
from stepramp.ramp.error_curves import ErrorCurves, error_curves
from stepramp.ramp.profile import Phase, Profile, profile_of
from stepramp.ramp.timer_limits import TimerWarning
from stepramp.validation import Document, rejected

if TYPE_CHECKING:
    import plotly.graph_objects as go

MOTORS = {preset.name: preset for preset in PRESETS}
"""Motors that many people have, by name: `.motor` is a part of a design, `.sources` where each figure comes from."""
MAP_VERDICTS: tuple[Verdict | Literal["not possible"], ...] = ("safe", "marginal", "stalls", "not possible")
"""What the numbers of a map stand for."""
CHANGE = "a stepramp.errors.Change: the path of a field and its value"


class Design(document.Design):
    """A design document, made from its parts; see stepramp.design for them.

    Raises Rejected, naming each field, its value and what is allowed.

    >>> design = Design(
    ...     timer={"frequency_hz": 2_000_000},
    ...     ramp={"slew_speed_steps_per_s": 1000, "acceleration_steps_per_s2": 5000},
    ...     move={"steps": 500},
    ... )
    >>> design.ramp.slew_speed_steps_per_s
    1000.0
    >>> Design(timer={"frequency_hz": 0}, ramp=design.ramp, move=design.move)
    Traceback (most recent call last):
    stepramp.errors.Rejected: timer.frequency_hz is 0; allowed: a number from 1,000 to 1,000,000,000 Hz.
    """

    schema_: Schema = Field("stepramp/2", alias="schema", description="Name and version of the document's format")

    def __init__(self, **parts: object) -> None:
        try:
            super().__init__(**parts)
        except ValidationError as error:
            raise rejected(error.errors(include_url=False)) from None

    @classmethod
    def checked(cls, document: object) -> Self:
        """Return the document as an instance, as the class does with its parts."""
        if not isinstance(document, dict):
            return super().checked(document)
        # Made by pydantic, all that making an instance refuses would be one refusal.
        return cls(**{str(name): part for name, part in document.items()})

    def profile(self) -> "PlannedMove":
        """Plan the move.

        Raises Rejected when the ramp can't be made, as an acceleration so small that the ramp takes more than
        10,000,000 steps.
        """
        return PlannedMove(self, profile_of(self))

    def with_changes(self, changes: Iterable[Change]) -> Self:
        """Return the design with other values in some fields, as proposals and the fastest ramps have them.

        Raises Rejected when that is no design.
        """
        if not isinstance(changes, Iterable):
            raise Rejected([Rejection("changes", changes, f"a list, each {CHANGE}")])
        told = list(changes)
        for number, change in enumerate(told):
            if not (isinstance(change, Change) and isinstance(change.field, str)):
                raise Rejected([Rejection(f"changes.{number}", change, CHANGE)])
        return with_changes(self, [replace(change, value=plain(change.value)) for change in told])

    def motor_torque(self, speeds_rpm: Sequence[float] | NDArray[np.float64]) -> Torques:
        """Return the torque that the motor has and that the ramp asks for at speeds of its shaft [Nm], each (n,).

        speeds_rpm: from 0 to 100,000, at most 10,000 of them. Raises Rejected for others, when the design has no motor,
        and for a ramp that can't be made.

        >>> motor = MOTORS["NEMA 17 · 17HS19-2004S1"].motor
        >>> design = Design(
        ...     schema="stepramp/2", axis={"microsteps": 16}, timer={"frequency_hz": 16_000_000}, motor=motor,
        ...     ramp={"slew_speed_steps_per_s": 32_000, "acceleration_steps_per_s2": 300_000}, move={"steps": 10_000},
        ... )
        >>> design.motor_torque([300, 1200]).pull_out_nm.round(2)
        array([0.5 , 0.21])
        """
        asked = _asked(SpeedsAsked, speeds_rpm=speeds_rpm)
        return torques_at(self, np.array(asked.speeds_rpm))

    def simulate_motor(self) -> "PlayedMove":
        """Play the move, tick by tick, through a model of the motor.

        Raises Rejected when the design has no motor, for a ramp that can't be made, and for moves of over 200 s.

        >>> design = Design(
        ...     schema="stepramp/2", axis={"microsteps": 16}, timer={"frequency_hz": 16_000_000},
        ...     motor=MOTORS["NEMA 17 · 17HS19-2004S1"].motor, load={"inertia_g_cm2": 200},
        ...     ramp={"slew_speed_steps_per_s": 32_000, "acceleration_steps_per_s2": 12_000_000},
        ...     move={"steps": 10_000},
        ... )
        >>> played = design.simulate_motor()
        >>> played.verdict, played.cause
        ('stalls', 'onset')
        >>> [proposal.changes[0].field for proposal in played.proposals()]
        ['ramp.shape', 'ramp.acceleration_steps_per_s2', 'ramp.slew_speed_steps_per_s']
        """
        return PlayedMove(self, outcome_of(self))

    def fastest_ramp(self, margin: float = MOST_USED) -> Fastest:
        """Find the fastest safe ramp of each shape that uses no more than a part of the motor's torque.

        margin: from 0.05 to 1. Raises Rejected for another, and when the design has no motor; a shape that has no such
        ramp says why in its candidate.

        >>> design = Design(
        ...     schema="stepramp/2", axis={"microsteps": 16}, timer={"frequency_hz": 16_000_000},
        ...     motor=MOTORS["NEMA 17 · 17HS19-2004S1"].motor, load={"inertia_g_cm2": 200},
        ...     drive={"supply_v": 24, "current_a": 2, "current_is": "peak"},
        ...     ramp={"slew_speed_steps_per_s": 64_000, "acceleration_steps_per_s2": 300_000},
        ...     move={"steps": 40_000},
        ... )
        >>> fastest = design.fastest_ramp()
        >>> fastest.words.split(",")[0]
        'Shaped by the torque the move takes 648.8 ms instead of 659.8 ms'
        >>> design.with_changes(fastest.best.changes).ramp.shape.name
        'torque'
        """
        return fastest_of(self, _asked(MarginAsked, margin=margin).margin)

    def stall_map(
        self,
        over: Over = "slew_speed",
        values: tuple[float, float] | None = None,
        accelerations_steps_per_s2: tuple[float, float] | None = None,
        cells: int = 64,
    ) -> "StallMap":
        """Play the move with other accelerations, and other slew speeds, loads or supply voltages.

        values: from where to where [steps/s, Nm or V]; None: around the design's own, as far as its border. cells:
        along each side. Raises Rejected without a motor, for cells other than 8, 16, 32, 64 or 128, and for ends that
        aren't two increasing numbers within what a design may have.

        >>> design = Design(
        ...     schema="stepramp/2", axis={"microsteps": 16}, timer={"frequency_hz": 16_000_000},
        ...     motor=MOTORS["NEMA 17 · 17HS19-2004S1"].motor, load={"inertia_g_cm2": 200},
        ...     ramp={"slew_speed_steps_per_s": 32_000, "acceleration_steps_per_s2": 300_000}, move={"steps": 2000},
        ... )
        >>> found = design.stall_map(values=(8_000, 64_000), accelerations_steps_per_s2=(1e5, 1e8), cells=8)
        >>> found.verdict_at(acceleration_steps_per_s2=1e5, value=8_000), found.verdict_at(1e8, 64_000)
        ('safe', 'stalls')
        """
        names = {"range": "values"}
        asked = _asked(
            MapAsked, names, over=over, range=values, accelerations_steps_per_s2=accelerations_steps_per_s2, cells=cells
        )
        question = question_of(self, asked.over, asked.range, asked.accelerations_steps_per_s2, asked.cells)
        with executor() as spread:
            task = partial(verdict_at, question)
            pictures = stall_map(asked.cells, lambda points: spread.results(task, points, lambda: True))
            # One for each point that is played: only the last is kept.
            [whole] = deque(pictures, maxlen=1)
        return StallMap(
            asked.over, np.array(question.over_values), np.array(question.accelerations), whole.verdicts, whole.played
        )


@dataclass(frozen=True)
class PlannedMove:
    """A design's move of N steps, and what can be asked about it."""

    design: document.Design
    profile: Profile

    @property
    def intervals_ticks(self) -> NDArray[np.int64]:
        """Wait after each pulse [ticks], shape (N,)."""
        return self.profile.intervals_ticks

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Instant of each pulse, the first at 0 [s], shape (N,)."""
        return self.profile.time_s

    @property
    def position_steps(self) -> NDArray[np.int64]:
        """Position after each pulse [steps], shape (N,)."""
        return self.profile.position_steps

    @property
    def speed_steps_per_s(self) -> NDArray[np.float64]:
        """Speed of each interval, v = F / p, formula (7) [steps/s], shape (N,)."""
        return self.profile.speed_steps_per_s

    @property
    def duration_s(self) -> float:
        """From pulse 1 to the end of the last interval [s]."""
        return self.profile.duration_s

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Acceleration, slew and deceleration, as far as the move has them."""
        return self.profile.phases

    @property
    def warnings(self) -> tuple[TimerWarning, ...]:
        """What works, but not as the design says, and what to change."""
        return self.profile.warnings

    def errors(self, reference: MethodName = REFERENCE, method: MethodName | None = None) -> ErrorCurves:
        """Compare the move, or the one by another method, with a reference, step by step.

        >>> design = Design(
        ...     timer={"frequency_hz": 1_000_000},
        ...     ramp={"slew_speed_steps_per_s": 2000, "acceleration_steps_per_s2": 4000},
        ...     move={"steps": 1200},
        ... )
        >>> worst = design.profile().errors(method="compromise").largest_relative_error
        >>> f"{worst.value:+.1%} at step {worst.step}"
        '-19.0% at step 1200'
        """
        return error_curves(self.design, method or self.design.method.name, reference)

    def figure(self, methods: Sequence[MethodName] = ()) -> "go.Figure":
        """Draw velocity, delay and error of the move, and of other methods beside it, as a Plotly figure.

        >>> design = Design(
        ...     timer={"frequency_hz": 1_000_000},
        ...     ramp={"slew_speed_steps_per_s": 2000, "acceleration_steps_per_s2": 4000},
        ...     move={"steps": 1200},
        ... )
        >>> [trace.name for trace in design.profile().figure(["newton"]).data]
        ['exact', 'exact', 'exact', 'newton', 'newton', 'newton']
        """
        names = dict.fromkeys([self.design.method.name, *methods])
        return figure_of([error_curves(self.design, name, REFERENCE) for name in names])


@dataclass(frozen=True)
class PlayedMove:
    """What a design's motor does with its move, and why."""

    design: document.Design
    outcome: Outcome
    """All that was found, with each damping."""

    @property
    def verdict(self) -> Verdict:
        """safe, marginal or stalls."""
        return self.outcome.verdict

    @property
    def cause(self) -> Cause | None:
        """What the verdict comes of; None where it is safe."""
        return cause_of(self.outcome)

    @property
    def evidence(self) -> Evidence | None:
        """What shows it: lost_steps, load_angle, torque, measured_torque or no_torque; None where it is safe."""
        return self.outcome.evidence

    @property
    def lost_full_steps(self) -> int:
        """How far the rotor is behind at the end [full steps]."""
        return self.outcome.lost_full_steps

    @property
    def most_used(self) -> float:
        """The largest part of the pull-out torque that the ramp asks for; inf: it asks where there is none."""
        return self.outcome.most_used

    @property
    def load_angles_deg(self) -> NDArray[np.float64]:
        """How far the field leads at most while each step lasts, with a usual damping [electrical °], shape (N,)."""
        return self.outcome.runs[USUAL_DAMPING].load_angles_deg

    @property
    def assumed(self) -> list[str]:
        """Paths of what the design leaves open: a usual value stands for it."""
        return list(assumed_of(self.design))

    @property
    def origins(self) -> dict[str, Origin]:
        """Where each number of motor, drive and load comes from, by its path: measured, datasheet, given and so on."""
        return origins_of(self.design)

    def proposals(self) -> list[Remedy]:
        """Return changes with each of which the move is safe, the mildest first; none where it is."""
        return proposals_of(self.design, self.outcome, self.cause)


@dataclass(frozen=True)
class StallMap:
    """Whether the motor makes a design's move, over its acceleration and another value."""

    over: Over
    """What is varied beside the acceleration."""
    values: NDArray[np.float64]
    """Of slew speed [steps/s], load torque [Nm] or supply [V], one a column, shape (n,)."""
    accelerations_steps_per_s2: NDArray[np.float64]
    """One a row, shape (n,)."""
    verdicts: NDArray[np.int8]
    """0 safe, 1 marginal, 2 stalls, 3 not possible, shape (n, n)."""
    played: int
    """How many points were played; the others lie within equal ones."""

    def verdict_at(self, acceleration_steps_per_s2: float, value: float) -> Verdict | Literal["not possible"]:
        """Return the verdict of the nearest point, by ratio but for loads. Raises Rejected beyond the map."""
        at = {"acceleration_steps_per_s2": acceleration_steps_per_s2, "value": value}
        for field, told, ends in zip(at, at.values(), (self.accelerations_steps_per_s2, self.values), strict=True):
            unit = "steps/s²" if field != "value" else UNITS[self.over]
            _refuse_outside(field, plain(told), Limits(float(ends[0]), float(ends[-1]), unit, note=", on the map"))
        row = _nearest(np.log(self.accelerations_steps_per_s2), math.log(acceleration_steps_per_s2))
        is_even = SPACINGS[self.over] == "even"
        column = _nearest(self.values if is_even else np.log(self.values), value if is_even else math.log(value))
        return MAP_VERDICTS[int(self.verdicts[row, column])]


def _nearest(places: NDArray[np.float64], place: float) -> int:
    return int(np.abs(places - place).argmin())


Asked = TypeVar("Asked", bound=Document)


def _asked(kind: type[Asked], names: Mapping[str, str] | None = None, **values: object) -> Asked:
    """Return what is asked, checked as over HTTP. names: what fields are called here, by their names there."""
    try:
        return kind.checked({name: plain(value) for name, value in values.items()})
    except Rejected as rejection:
        told = [replace(each, field=_renamed(each.field, names or {})) for each in rejection.rejections]
        raise Rejected(told, rejection.more) from None


def _renamed(path: str, names: Mapping[str, str]) -> str:
    first, *others = path.split(".")
    return ".".join([names.get(first, first), *others])


def _refuse_outside(field: str, value: object, limits: Limits) -> None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not (is_number and limits.lowest <= value <= limits.highest):  # type: ignore[operator]  # both ends are there
        raise Rejected([Rejection.outside(field, value, limits)])


def plain(value: object) -> object:
    """Return arrays, sequences and numbers of NumPy as lists and numbers of Python; all else as it is."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [plain(each) for each in value]
    return value
