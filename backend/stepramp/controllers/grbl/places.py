"""Where the axes of a grbl are: its millimetres as steps, and positions that count from where people say."""

from collections.abc import Mapping, Sequence
from itertools import takewhile

import numpy as np

from stepramp.controllers.axes import MOST_AXES
from stepramp.controllers.grbl.dialect import Report
from stepramp.controllers.grbl.numbers import exact
from stepramp.controllers.grbl.settings import LETTERS, MM_PER_INCH, REPORTS_INCHES, AxisSettings, Known

MM_TOLD = 0.001
INCHES_TOLD = 0.0001


class Places:
    """Positions [steps], of the controller as it counts itself, and as they are called here."""

    def __init__(self) -> None:
        self.axes: tuple[AxisSettings, ...] = ()
        self._offsets: list[int] = []
        self._known: dict[int, int] = {}
        """Where axes were sent to, as the controller counts: what it tells is coarser."""
        self.changed: dict[int, str] = {}
        """Axes whose steps per mm have changed since it was known where they are, and how, as part of a sentence."""
        self.rescaled: tuple[str, ...] = ()
        """How steps per mm have changed by what was last learned, wherever the axes are, as parts of a sentence."""
        self._work_offset: tuple[float, ...] | None = None
        self._rested_at: list[float] | None = None
        """Where they were last seen to rest [mm]; None: they were sent elsewhere since."""
        self.trouble: str | None = None
        """Which axes can't be used, and why, as a sentence; None: all can."""
        self.mm_per_unit, self._told_mm = 1.0, MM_TOLD

    def learn(self, settings: Known, report: Report) -> None:
        """Take the scales that a controller has, of the axes up to the first whose settings make no sense."""
        found = [settings.axis(axis) for axis in range(min(MOST_AXES, len(report.position)))]
        before = self.axes
        self.axes = tuple(each for each in takewhile(lambda each: each is not None, found) if each is not None)
        self.trouble = None
        if len(self.axes) < len(found):
            letter = LETTERS[len(self.axes)]
            self.trouble = (
                f"The settings of axis {letter} make no sense: it can't be used, nor can those after it. Restore a "
                "backup of this device, or set them at the machine."
            )
        self._offsets = [*self._offsets, *[0] * len(self.axes)][: len(self.axes)]
        inches = bool(settings.number(REPORTS_INCHES))
        self.mm_per_unit = MM_PER_INCH if inches else 1.0
        self._told_mm = INCHES_TOLD * MM_PER_INCH if inches else MM_TOLD
        self.changed = {axis: words for axis, words in self.changed.items() if axis < len(self.axes)}
        rescaled = {}
        for axis, (was, now) in enumerate(zip(before, self.axes, strict=False)):
            if was.steps_per_mm != now.steps_per_mm:
                figures = f"from {float(was.steps_per_mm):,.7g} to {float(now.steps_per_mm):,.7g}"
                rescaled[axis] = f"{settings.scale_name(axis)} has changed {figures}"
        self.rescaled = tuple(rescaled.values())
        # 0 is the same place by whatever steps per mm.
        self.changed |= {axis: words for axis, words in rescaled.items() if self.counted(report)[axis]}

    @property
    def change_words(self) -> str:
        """What has changed, and what comes of that, as a sentence."""
        which = " and ".join(LETTERS[axis] for axis in self.changed)
        return f"{', '.join(self.changed.values())}, so {which} may be at another place than is counted."

    def note(self, report: Report) -> bool:
        """Note the offset of the workpiece, and return whether positions can be told from a report.

        One that tells too few of them has lost some on its way.
        """
        if len(report.position) < len(self.axes):
            return False
        if report.offset is not None:
            self._work_offset = report.offset
        return not report.is_of_work or self._work_offset is not None

    def note_rest(self, report: Report) -> None:
        """Note where the axes are told to rest."""
        self._rested_at = self._lengths(report)

    def is_elsewhere(self, report: Report) -> bool:
        """Tell whether axes rest elsewhere than they did, though nothing was begun here: other steps per mm do that."""
        return self._rested_at not in (None, self._lengths(report))

    def counted(self, report: Report) -> list[int]:
        """Return where the axes are as the controller counts [steps]."""
        return [self._step_at(axis, length) for axis, length in enumerate(self._lengths(report))]

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
            self.changed.pop(axis, None)

    def aim(self, targets: Mapping[int, int]) -> None:
        """Note where axes are sent to, as the controller counts [steps]."""
        self._known |= targets
        self._rested_at = None

    def forget(self) -> None:
        """Know no more of the axes than they tell: they were stopped on their way."""
        self._known.clear()

    def _lengths(self, report: Report) -> list[float]:
        """Return where the axes are told to be [mm]."""
        added = self._work_offset if report.is_of_work and self._work_offset is not None else (0.0,) * len(self.axes)
        pairs = zip(report.position[: len(self.axes)], added[: len(self.axes)], strict=True)
        return [(told + offset) * self.mm_per_unit for told, offset in pairs]

    def _step_at(self, axis: int, length_mm: float) -> int:
        per_mm = float(exact(self.axes[axis].steps_per_mm))
        known = self._known.get(axis)
        # Half of the last place that is told, and what float32 makes of the length.
        slack_mm = self._told_mm / 2 + 4 * float(np.spacing(np.float32(length_mm)))
        if known is not None and abs(known / per_mm - length_mm) <= slack_mm:
            return known
        return round(length_mm * per_mm)
