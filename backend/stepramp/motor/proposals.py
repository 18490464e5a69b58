"""What to change of a design whose motor stalls, or has too little torque kept back: changes that were tried."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, islice

from stepramp.design import Design
from stepramp.errors import Rejected, Remedy
from stepramp.motor.changes import changed
from stepramp.motor.glance import share_asked
from stepramp.motor.patience import Patience
from stepramp.motor.shortened import shortened
from stepramp.motor.verdict import MOST_USED, Cause, Outcome, verdict_of
from stepramp.motor.ways import FIGURES, LESS, Way, hardware, slower_altogether, ways_of
from stepramp.numerics.limit_text import highest
from stepramp.ramp.profile import profile_of

SEARCH_S = 3.0
"""So long is looked for changes, all together; what is found until then is told [s]."""
LITTLE = MOST_USED + 0.05
"""What asks for more of the torque, at a glance, needn't be played."""
HALVINGS = 4
"""So many times the way from a number that won't do to one that does is halved: to 2 % of it."""
FIRST: dict[Cause, tuple[str, ...]] = {
    "start": ("ramp.base_speed_steps_per_s",),
    "onset": ("ramp.acceleration_steps_per_s2", "ramp.shape"),
    "top_speed": ("ramp.slew_speed_steps_per_s", "ramp.acceleration_steps_per_s2"),
    "resonance": ("ramp.slew_speed_steps_per_s", "ramp.acceleration_steps_per_s2"),
    "timer": ("timer.frequency_hz", "ramp.slew_speed_steps_per_s"),
    "stop": ("ramp.deceleration_steps_per_s2", "ramp.shape"),
}
"""What is looked at first, by cause."""


def proposals_of(
    design: Design, outcome: Outcome, cause: Cause | None, is_wanted: Callable[[], bool] = lambda: True
) -> list[Remedy]:
    """Return changes with each of which, by itself, the move is safe; none where it is safe already, or none is found.

    Of each kind the mildest, and the mildest kind first: by how many times its number grows or shrinks; a change of
    shape by how many times as long the move takes. Where none does by itself, one that is several. Raises NotWanted as
    run_of does.
    """
    if cause is None:
        return []
    first = FIRST[cause]
    trial = _Trial(design, Patience(is_wanted, SEARCH_S))
    ways = ways_of(design, outcome.profile.peak_speed_steps_per_s, with_stop=cause == "stop")
    found: list[tuple[float, Remedy]] = []
    for way in sorted(ways, key=lambda way: first.index(way.field) if way.field in first else len(first)):
        value = trial.mildest(way)
        if value is not None:
            remedy = way.made(value)
            how_far = trial.times_as_long(remedy, outcome) if math.isnan(value) else way.how_far(value)
            found.append((how_far, remedy))
    if not found:
        return list(islice(_together(trial, with_stop=cause == "stop"), 1))
    return [remedy for _, remedy in sorted(found, key=lambda each: each[0])]


def _together(trial: "_Trial", *, with_stop: bool) -> Iterator[Remedy]:
    """Yield what several numbers do where no single one is enough: the whole ramp slowed down, or two kinds of change.

    The first of the two leaves the ramp as it is.
    """
    yield from _slowed(trial)
    # A timer is seldom what is lacking.
    for first in reversed([*hardware(trial.design)]):
        for value in first.values:
            remedy = first.made(value)
            made = changed(trial.design, remedy.changes)
            if made is None or trial.patience.is_over():
                continue
            after = replace(trial, design=made)
            others = [way for way in ways_of(made, math.inf, with_stop=with_stop) if way.field != first.field]
            found = (way.made(best) for way in others if (best := after.mildest(way)) is not None)
            for second in chain(found, _slowed(after)):
                # What both change is as the second has it.
                changes = {change.field: change for change in (*remedy.changes, *second.changes)}
                told = (*remedy.told, *second.told)
                yield Remedy(f"{remedy.text}, and {second.text}", tuple(changes.values()), told)


def _slowed(trial: "_Trial") -> Iterator[Remedy]:
    if not trial.design.method.plays_table:
        way = slower_altogether(trial.design)
        part = trial.mildest(way)
        if part is not None:
            yield way.made(part)


@dataclass(frozen=True)
class _Trial:
    """Tries changes of a design, while there is patience."""

    design: Design
    patience: Patience

    def mildest(self, way: Way) -> float | None:
        """Return the mildest value of a way with which the move is safe; None: none was found."""
        first = self._first_asking_little(way) if way.is_even else 0
        for index in range(first, len(way.values)):
            if self._is_safe(way, way.values[index]):
                return self._between(way, index) if way.is_even else way.values[index]
        return None

    def times_as_long(self, remedy: Remedy, outcome: Outcome) -> float:
        """Return how many times as long, or as short, a remedy makes the move."""
        made = changed(self.design, remedy.changes)
        times = profile_of(made).duration_s / outcome.profile.duration_s if made else 1.0
        return max(times, 1 / times)

    def _first_asking_little(self, way: Way) -> int:
        """Return from which value on enough of the torque is kept back, which needn't be played to be known."""
        low, high = 0, len(way.values)
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if self._asks_little(way, way.values[middle]) else (middle + 1, high)
        return low

    def _between(self, way: Way, index: int) -> float:
        """Return a value that is safe, close to one that isn't, between a safe one of the way and the one before it."""
        safe = way.values[index]
        other = way.values[index - 1] if index else safe / LESS[0]
        for _ in range(HALVINGS if safe else 0):
            middle = highest(math.sqrt(safe * other), FIGURES)
            safe, other = (middle, other) if self._is_safe(way, middle) else (safe, middle)
        return safe

    def _asks_little(self, way: Way, value: float) -> bool:
        made = changed(self.design, way.made(value).changes)
        try:
            return made is None or share_asked(made) <= LITTLE
        except Rejected:
            # What isn't played may come after something that does.
            return True

    def _is_safe(self, way: Way, value: float) -> bool:
        made = changed(self.design, way.made(value).changes)
        if made is None or self.patience.is_over():
            return False
        try:
            is_little = made.method.plays_table or share_asked(made) <= LITTLE
            return is_little and self.patience.within(partial(verdict_of, shortened(made))) == "safe"
        except Rejected:
            return False
