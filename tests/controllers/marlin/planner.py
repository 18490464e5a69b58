"""Motors of a Marlin, and what it has planned for them: a row of blocks that is gone along at speeds slice by slice.

Nothing here is worked out in closed forms: in each slice of time the speed is what the acceleration lets it become, no
more than the blocks allow, and no more than can still be braked from within what is planned.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

AXES = "XYZE"
LEAST_STEPS = 6
"""Blocks of fewer steps are left out."""
FIRST_AFTER_S = 0.1


@dataclass
class Block:
    """A straight way [steps, mm]."""

    ends: dict[str, int]
    steps: dict[str, int]
    length: float
    speed: float
    gain: float


class Planner:
    """The queue, and the motors. settings: M92, M201, M203, M204 by letter."""

    def __init__(self, settings: Callable[[], Mapping[str, Mapping[str, float]]]) -> None:
        self._settings = settings
        self.counts = dict.fromkeys(AXES, 0)
        self.targets = dict.fromkeys(AXES, 0)
        self.blocks: list[Block] = []
        self._speed = self._done = 0.0
        self._waits_s = 0.0

    @property
    def is_busy(self) -> bool:
        return bool(self.blocks)

    def add(self, target: Mapping[str, int], feed: float) -> None:
        """Plan a way to a place; feed along it [mm/s]."""
        settings = self._settings()
        steps = {axis: target[axis] - self.targets[axis] for axis in AXES}
        if max(map(abs, steps.values())) < LEAST_STEPS:
            return
        lengths = {axis: abs(steps[axis]) / settings["M92"][axis] for axis in AXES if steps[axis]}
        length = math.hypot(*lengths.values())
        speed = min([feed, *(settings["M203"][axis] * length / each for axis, each in lengths.items())])
        if set(lengths) == {"E"}:
            gain = settings["M204"]["R"]
        else:
            shared = settings["M204"]["P" if "E" in lengths else "T"]
            gain = min([shared, *(settings["M201"][axis] * length / each for axis, each in lengths.items())])
        assert gain > 0
        assert speed > 0
        if not self.blocks:
            self._waits_s = FIRST_AFTER_S
        self.blocks.append(Block(dict(target), steps, length, speed, gain))
        self.targets = dict(target)

    def quick_stop(self) -> None:
        """Make no further step."""
        self.blocks, self._speed, self._done = [], 0.0, 0.0
        self.targets = dict(self.counts)

    def go_on(self, time_s: float) -> int:
        """Go on for so long; return how many steps were made."""
        self._waits_s = max(0.0, self._waits_s - time_s)
        if not self.blocks or self._waits_s:
            return 0
        block, before = self.blocks[0], dict(self.counts)
        left = sum(self._along()) - self._done
        wanted = min(block.speed, math.sqrt(2 * block.gain * max(left, 0.0)))
        change = block.gain * time_s
        self._speed = max(wanted, self._speed - change) if self._speed > wanted else min(wanted, self._speed + change)
        self._done += max(self._speed, 0.05) * time_s
        while self.blocks and self._done >= self.blocks[0].length:
            self._done -= self.blocks[0].length
            self.counts = self.blocks.pop(0).ends
        if self.blocks:
            share = self._done / self.blocks[0].length
            self.counts = {
                axis: self.blocks[0].ends[axis] - self.blocks[0].steps[axis] + math.floor(each * share + 0.5)
                for axis, each in self.blocks[0].steps.items()
            }
        else:
            self._speed = self._done = 0.0
        return max(abs(self.counts[axis] - before[axis]) for axis in AXES)

    def _along(self) -> list[float]:
        """Return the lengths of the blocks that go on in the direction of the first."""
        first, found = self.blocks[0], []
        for block in self.blocks:
            if any(
                abs(block.steps[axis] / block.length - first.steps[axis] / first.length) > 0.02 * 400 for axis in AXES
            ):
                break
            found.append(block.length)
        return found
