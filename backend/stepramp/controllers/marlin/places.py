"""Where the axes of a Marlin are: its steps, its millimetres, and positions that count from where people say."""

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np

from stepramp.controllers.marlin.dialect import Place
from stepramp.controllers.marlin.settings import EXTRUDER, AxisSettings

TOLD_MM = 0.01
LENGTHS_DIFFER_MM = 1.5 * TOLD_MM
WAY_DECIMALS = 5


class Places:
    """Positions [steps], of the controller as it counts itself, and as they are called here."""

    def __init__(self) -> None:
        self.axes: tuple[AxisSettings, ...] = ()
        self._offsets: list[int] = []
        self._known: dict[int, int] = {}
        """Where axes were sent to: of the extruder it tells hundredths of mm only."""
        self._lengths: dict[int, np.float32] = {}
        """Where it takes axes to be [mm], from where it counts its steps: it adds up the ways that it is told."""
        self._shifts: dict[int, float] = {}
        """By how much what it tells differs from that [mm]: G92, and offsets of its own."""
        self._last: dict[int, tuple[float, int]] = {}
        """Where it last told axes to rest [mm, steps]."""
        self._sent: set[int] = set()
        """Axes that were sent elsewhere since."""

    def learn(self, axes: tuple[AxisSettings, ...]) -> None:
        """Take the scales that a controller has."""
        if tuple(each.steps_per_mm for each in axes) != tuple(each.steps_per_mm for each in self.axes):
            self._known, self._lengths, self._last = {}, {}, {}
        self.axes = axes
        self._offsets = [*self._offsets, *[0] * len(axes)][: len(axes)]

    def counted(self, place: Place) -> list[int]:
        """Return where the axes are as the controller counts [steps]."""
        return [self._step_at(axis, place) for axis in range(len(self.axes))]

    def is_counted_anew(self, place: Place) -> bool:
        """Tell whether steps and mm have changed by other amounts since the last rest: other steps per mm do that."""
        for axis, (length, count) in self._last.items():
            letter, per_mm = self.axes[axis].letter, float(self.axes[axis].steps_per_mm)
            told, counted = place.lengths.get(letter, length), place.counts.get(letter, count)
            # Where nothing was begun here, and the mm are the same, the steps are, too.
            slack = 0.0 if told == length and axis not in self._sent else 1 + TOLD_MM * per_mm
            if abs(counted - count - (told - length) * per_mm) > slack:
                return True
        return False

    def note_rest(self, place: Place, counted: Sequence[int]) -> None:
        """Note where axes rest, and what it takes them to be: it may have been told something else by somebody else."""
        self._sent.clear()
        for axis, scale in enumerate(self.axes):
            told = place.lengths.get(scale.letter, 0.0)
            if scale.letter in place.counts:
                self._last[axis] = (told, counted[axis])
            length = self._lengths.get(axis)
            if length is not None and abs(float(length) + self._shifts.get(axis, 0.0) - told) > LENGTHS_DIFFER_MM:
                del self._lengths[axis]
                length = None
            if length is None:
                self._shifts[axis] = told - counted[axis] / float(scale.steps_per_mm)

    def called(self, counted: Sequence[int]) -> list[int]:
        """Return what places are called here [steps]."""
        return [place + offset for place, offset in zip(counted, self._offsets, strict=True)]

    def counted_of(self, axis: int, called: int) -> int:
        """Return a position as the controller counts it [steps]."""
        return called - self._offsets[axis]

    def call(self, positions: Mapping[int, int], counted: Sequence[int]) -> None:
        """Call places something else from now on [steps]."""
        for axis, position in positions.items():
            self._offsets[axis] = position - counted[axis]

    def way(self, axis: int, target: int, counted: int) -> str:
        """Return the number of mm that leads to a place [steps] from where the controller takes an axis to be."""
        per_mm = self.axes[axis].steps_per_mm
        length = self._lengths.get(axis, np.float32(Fraction(counted) / per_mm))
        return f"{float(Fraction(target) / per_mm) - float(length):.{WAY_DECIMALS}f}"

    def went(self, axis: int, target: int, counted: int, way: str) -> None:
        """Note that an axis was sent to a place [steps], from where it was, by so many mm."""
        length = self._lengths.get(axis, np.float32(Fraction(counted) / self.axes[axis].steps_per_mm))
        self._lengths[axis] = np.float32(length + np.float32(way))
        self._known[axis] = target
        self._sent.add(axis)

    def forget(self) -> None:
        """Take axes to be where they are told to be: a quick stop has the controller do so, too."""
        self._known.clear()
        self._lengths.clear()

    def _step_at(self, axis: int, place: Place) -> int:
        letter = self.axes[axis].letter
        if letter in place.counts:
            return place.counts[letter]
        told, per_mm = place.lengths.get(letter, 0.0), float(self.axes[axis].steps_per_mm)
        known = self._known.get(axis)
        if letter == EXTRUDER and known is not None and abs(known / per_mm - told) <= TOLD_MM:
            return known
        return round(told * per_mm)


def rescaled(before: Sequence[AxisSettings], after: Sequence[AxisSettings]) -> list[int]:
    """Return the axes of which the steps per mm are told as others."""
    return [axis for axis in range(min(len(before), len(after))) if _scale(before, axis) != _scale(after, axis)]


def rescaled_words(before: Sequence[AxisSettings], after: Sequence[AxisSettings]) -> str | None:
    """Return the same as a sentence; None for none."""
    told = (
        f"{after[axis].letter} from {_scale(before, axis)} to {_scale(after, axis)}" for axis in rescaled(before, after)
    )
    which = ", ".join(told)
    return f"Steps per mm (M92) were changed at the machine: {which}." if which else None


def _scale(axes: Sequence[AxisSettings], axis: int) -> str:
    return f"{float(axes[axis].steps_per_mm):,.7g}"
