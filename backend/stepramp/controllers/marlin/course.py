"""Where axes are on their way along a line, as planned: what a Marlin tells is mostly where they will come to rest."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from stepramp.controllers.marlin.settings import EXTRUDER, PRINT, AxisSettings, Settings

BEGINS_AFTER_S = 0.1
"""So long it waits for further moves before it begins the first [s]."""


@dataclass(frozen=True)
class Course:
    """A trapezoid from rest to rest along a line, which may still be made longer [mm, s]."""

    begun_s: float
    starts: Mapping[int, int]
    """Where the axes set out from, by axis [steps]."""
    targets: Mapping[int, int]
    length: float
    speed: float
    acceleration: float

    @classmethod
    def of(
        cls,
        begun_s: float,
        ways: Mapping[int, tuple[int, int]],
        axes: Sequence[AxisSettings],
        settings: Settings,
        speed: float | None = None,
    ) -> "Course":
        """Return the course of axes, each from one place to another [steps].

        speed: along the line [mm/s]; None: the highest that the axes have.
        """
        lengths = {axis: abs(b - a) / float(axes[axis].steps_per_mm) for axis, (a, b) in ways.items()}
        length = math.hypot(*lengths.values())
        shares = {axis: each / length for axis, each in lengths.items() if each}
        highest = min(float(axes[axis].speed) / share for axis, share in shares.items())
        if len(shares) == 1:
            gain = min(float(axes[axis].effective_acceleration) for axis in shares)
        else:
            gains = [float(axes[axis].acceleration) / share for axis, share in shares.items()]
            has_extruder = any(axes[axis].letter == EXTRUDER for axis in shares)
            shared = settings.number("M204", PRINT if has_extruder else "T")
            gain = min([*gains, *([float(shared)] if shared else [])])
        starts, targets = ({axis: way[end] for axis, way in ways.items()} for end in (0, 1))
        return cls(begun_s, starts, targets, length, min(highest, speed or highest), gain)

    @property
    def ends_s(self) -> float:
        """When it comes to rest."""
        peak = min(self.speed, math.sqrt(self.acceleration * self.length))
        return self.begun_s + BEGINS_AFTER_S + self.length / peak + peak / self.acceleration

    @property
    def brakes_s(self) -> float:
        """How long it slows down from its speed [s]."""
        return self.speed / self.acceleration

    def longer(self, targets: Mapping[int, int]) -> "Course":
        """Return the same as far as further targets on the same line."""
        ratios = [
            (place - self.starts[axis]) / (self.targets[axis] - self.starts[axis])
            for axis, place in targets.items()
            if self.targets[axis] != self.starts[axis]
        ]
        return replace(self, targets=targets, length=self.length * max(ratios))

    def places(self, now_s: float) -> dict[int, int]:
        """Return where the axes are [steps]."""
        share = self._way(now_s) / self.length
        return {axis: a + round((self.targets[axis] - a) * share) for axis, a in self.starts.items()}

    def speed_of(self, axis: int, now_s: float) -> float:
        """Return how fast an axis is [steps/s]."""
        steps = abs(self.targets[axis] - self.starts[axis])
        since_s, left_s = now_s - self.begun_s - BEGINS_AFTER_S, self.ends_s - now_s
        along = min(self.speed, self.acceleration * max(0.0, since_s), self.acceleration * max(0.0, left_s))
        return along / self.length * steps

    def _way(self, now_s: float) -> float:
        since_s, left_s = now_s - self.begun_s - BEGINS_AFTER_S, self.ends_s - now_s
        if since_s <= 0:
            return 0.0
        if left_s <= 0:
            return self.length
        peak = min(self.speed, math.sqrt(self.acceleration * self.length))
        ramp_s = peak / self.acceleration
        if since_s < ramp_s:
            return self.acceleration * since_s**2 / 2
        if left_s < ramp_s:
            return self.length - self.acceleration * left_s**2 / 2
        return peak * (since_s - ramp_s / 2)
