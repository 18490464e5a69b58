"""The fastest ramp that a motor makes safely, of each shape, with the same part of its torque kept back.

The design as it is takes part: nothing is called the fastest that is slower. How the others are found:
`motor/fastest_search.py`; docs/motor.md.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial

from stepramp.design import Design
from stepramp.errors import Change, Rejected
from stepramp.motor.changes import with_changes
from stepramp.motor.fastest_search import CANDIDATES, SEARCH_S, Search, Shape, does
from stepramp.motor.patience import Patience
from stepramp.motor.shortened import shortened
from stepramp.motor.verdict import MOST_USED, ROUNDING, Outcome, Verdict, outcome_of
from stepramp.ramp.profile import profile_of

NAMES: dict[Shape, str] = {
    "constant": "constant acceleration", "s_curve": "an S-curve", "torque": "a ramp shaped by the torque",
}  # fmt: skip
WORTH_TELLING = 1.005
"""A gain that is less is none."""
FAULTS = {
    "ramp.base_speed_steps_per_s": "its base speed is too fast to start at",
    "ramp.slew_speed_steps_per_s": "its slew speed is too fast",
    "timer.frequency_hz": "its timer is too coarse",
    "axis.microsteps": "its microsteps are too coarse",
    "margin": "that part of the torque doesn't move the load",
    "load": "the load is too much",
    "move.steps": "its move is too long to be played through the model",
}
"""What is said to be wrong, by the field that is refused."""


@dataclass(frozen=True)
class Figures:
    """What a design's move is with its motor."""

    duration_s: float
    ramp_up_s: float
    """Of the move's acceleration."""
    peak_speed_steps_per_s: float
    acceleration_steps_per_s2: float
    """The largest along the ramp up."""
    most_used: float
    """Of the pull-out torque."""
    verdict: Verdict


@dataclass(frozen=True)
class Candidate:
    """The fastest ramp of a shape; figures or rejected is None."""

    shape: Shape | None
    """None: the design as it is."""
    changes: tuple[Change, ...] = ()
    """What makes it of the design."""
    figures: Figures | None = None
    rejected: Rejected | None = None
    """Why there is none."""


@dataclass(frozen=True)
class Fastest:
    """The fastest ramp of each shape, and the design as it is."""

    margin: float
    candidates: tuple[Candidate, ...]
    present: Figures | Rejected
    will_do: bool
    """Whether the design as it is takes part: it is safe, within the margin."""
    is_slew_beyond: bool
    """Whether the part of the torque doesn't do for its slew speed, even without acceleration."""
    is_cut_short: bool = False
    """Whether the time was up before all was tried."""

    @property
    def best(self) -> Candidate | None:
        """The one whose move is the shortest, of several the simplest; None where there is none."""
        own = [Candidate(None, figures=self.present)] if self.will_do and isinstance(self.present, Figures) else []
        return _quickest([*own, *self.candidates])

    @property
    def gain(self) -> float | None:
        """How many times the better of the others lasts as long as the one shaped by torque; None without either."""
        return self._gain(lambda figures: figures.duration_s)

    @property
    def ramp_gain(self) -> float | None:
        """The same of their ramps up; None where the first step is at slew speed already, so that there is none."""
        return self._gain(lambda figures: figures.ramp_up_s)

    @property
    def other(self) -> Candidate | None:
        """The better of those that aren't shaped by torque."""
        return _quickest(self.candidates[:-1])

    @property
    def words(self) -> str:
        """What is gained by which shape, of the whole move and of the ramp, in a sentence or two."""
        best, torque, other = self.best, self.candidates[-1].figures, self.other
        if best is None or best.figures is None:
            if self.is_cut_short:
                return f"In {SEARCH_S:g} s no safe ramp was found: it takes long to play this move through the model."
            return f"No ramp is safe with this motor: {self._fault}."
        if best.shape is None:
            said = f"Nothing is quicker than the design as it is, whose move takes {_s(best.figures.duration_s)}."
        elif torque is not None and other is not None and other.figures is not None and other.shape is not None:
            said = _compared(torque, other.figures, NAMES[other.shape])
        else:
            others = "another shape wasn't found in time" if self.is_cut_short else "not every shape does"
            said = f"With {NAMES[best.shape]} the move takes {_s(best.figures.duration_s)}; {others}."
        if self.is_slew_beyond:
            said += (
                f" At its slew speed {self.margin:.0%} of the torque doesn't move the load: the move never comes to "
                "it, and a lower one may be quicker."
            )
        if self.is_cut_short:
            said += f" The search ended after {SEARCH_S:g} s: there may be quicker ones."
        return said + self._reserve(best.figures)

    def _reserve(self, best: Figures) -> str:
        """Return what is to be said of the torque that is kept back, by these or by the design as it is."""
        if self.margin > MOST_USED + ROUNDING:
            return f" Only {1 - self.margin:.0%} of the torque is kept back, which is marginal: keep 40 %."
        own = self.present
        if isinstance(own, Figures) and own.verdict == "safe" and own.duration_s < best.duration_s:
            return f" The design as it is takes {_s(own.duration_s)}, but asks for {own.most_used:.0%} of the torque."
        return ""

    @property
    def _fault(self) -> str:
        """What is wrong where no shape will do."""
        fields = [each.rejected.rejections[0].field for each in self.candidates if each.rejected]
        known = [FAULTS[field] for field in fields if field in FAULTS]
        return known[0] if known else "not one of these shapes can be made"

    def _gain(self, measure: Callable[[Figures], float]) -> float | None:
        torque, other = self.candidates[-1].figures, self.other
        if torque is None or other is None or other.figures is None:
            return None
        return measure(other.figures) / measure(torque) if measure(torque) > 0 else None


def fastest_of(design: Design, margin: float, is_wanted: Callable[[], bool] = lambda: True) -> Fastest:
    """Return the fastest ramp of each shape that uses no more than a part of the motor's torque.

    Up to the usual margin of 0.6 each move is safe, as outcome_of has it; beyond it loses no step, but is marginal. A
    design that is so itself takes part. Of a long slew phase as much is played as decides that. After SEARCH_S it
    ends with what was found. Raises Rejected without a motor; NotWanted as run_of does.
    """
    search = Search(design, margin, Patience(is_wanted))
    candidates = []
    for number, shape in enumerate(CANDIDATES, start=1):
        # Each has its share of the time, and what those before it have left of theirs.
        search.patience.lasts_s = SEARCH_S * number / len(CANDIDATES)
        candidates.append(_candidate(search, shape))
    ended = search.patience.has_ended
    found = partial(Fastest, margin, tuple(candidates), is_slew_beyond=search.is_slew_beyond, is_cut_short=ended)
    try:
        outcome = outcome_of(shortened(design), is_wanted)
    except Rejected as rejected:
        return found(present=rejected, will_do=False)
    return found(present=figures_of(design, outcome), will_do=does(outcome, margin))


def figures_of(design: Design, outcome: Outcome) -> Figures:
    """Return what a design's move is. outcome: of as much of it as was played."""
    profile = profile_of(design)
    up = next((phase for phase in profile.phases if phase.name == "accelerate"), None)
    ticks = int(profile.intervals_ticks[up.first_step - 1 : up.last_step].sum()) if up else 0
    return Figures(
        duration_s=profile.duration_s,
        ramp_up_s=ticks / profile.timer_hz,
        peak_speed_steps_per_s=profile.peak_speed_steps_per_s,
        acceleration_steps_per_s2=design.ramp.acceleration_steps_per_s2,
        most_used=outcome.most_used,
        verdict=outcome.verdict,
    )


def _candidate(search: Search, shape: Shape) -> Candidate:
    try:
        changes = search.fastest(shape)
        made = with_changes(search.design, changes)
        outcome = outcome_of(shortened(made), search.patience.is_wanted)
    except Rejected as rejected:
        return Candidate(shape, rejected=_of_asked(rejected))
    return Candidate(shape, changes, figures_of(made, outcome))


def _of_asked(rejected: Rejected) -> Rejected:
    """Return a rejection with the margin where it is asked for: the design's shape needn't have one."""
    fields = {"ramp.shape.margin": "margin"}
    return Rejected([replace(each, field=fields.get(each.field, each.field)) for each in rejected.rejections])


def _quickest(candidates: Iterable[Candidate]) -> Candidate | None:
    return min((each for each in candidates if each.figures), key=_duration, default=None)


def _duration(candidate: Candidate) -> float:
    return candidate.figures.duration_s if candidate.figures else 0.0


def _compared(torque: Figures, other: Figures, name: str) -> str:
    """Return what shaping by the torque gains over another shape, of the whole move and of its ramp up."""
    move, others = _s(torque.duration_s), _s(other.duration_s)
    ramp = f"{_s(torque.ramp_up_s)} instead of {_s(other.ramp_up_s)}"
    is_ramp_quicker = other.ramp_up_s >= WORTH_TELLING * torque.ramp_up_s > 0
    if other.duration_s >= WORTH_TELLING * torque.duration_s:
        of_ramp = f", its ramp up {ramp}," if is_ramp_quicker else ""
        return f"Shaped by the torque the move takes {move} instead of {others}{of_ramp} within the same margin."
    if is_ramp_quicker and other.duration_s > torque.duration_s:
        saved = _s(other.duration_s - torque.duration_s)
        return (
            f"Shaped by the torque the ramp up takes {ramp} within the same margin; of the whole move of {others} that "
            f"saves {saved}."
        )
    return (
        f"Nothing is gained by shaping it by the torque: the move takes {move}, and {others} with {name} within the "
        "same margin."
    )


def _s(seconds: float) -> str:
    return f"{seconds:.4g} s" if seconds >= 1 else f"{seconds * 1000:.4g} ms"
