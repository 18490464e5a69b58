"""A straight way of the tool, told to Klipper in parts: how far ahead it is told, and what a part says."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

from stepramp.controllers.klipper.machine import LETTERS

AHEAD_S = 1.75
"""So long it goes on, besides slowing down, when nobody tells it to [s]: Klipper slows down once it has less than 1 s
in its plan."""
PART_S = 0.25
"""It is told no shorter parts [s], but the last one."""
DECIMALS = 9
"""Of the lengths that are told [mm]."""
STATE = "stepramp"
"""What the state of its G-code is called that is put back after each part."""
PUT_BACK = f"RESTORE_GCODE_STATE NAME={STATE}"
"""Without MOVE it moves nothing."""
ARRIVED_MM = 1e-4
"""Nearer than that to where it was sent it has arrived [mm]: far less than a step."""


@dataclass(frozen=True)
class Route:
    """A way from a place to another one [mm], at a speed [mm/s] with an acceleration [mm/s²] along it."""

    start: Mapping[int, float]
    """By the axes that move."""
    goal: Mapping[int, float]
    speed: float
    acceleration: float
    cruise_ratio: float

    @property
    def length(self) -> float:
        """How long it is [mm]."""
        return math.dist(tuple(self.start.values()), tuple(self.goal.values()))

    def share(self, axis: int) -> float:
        """Return an axis' part of each mm of the way, with its sign."""
        return (self.goal[axis] - self.start[axis]) / self.length if axis in self.goal else 0.0

    def done(self, position: Sequence[float]) -> float:
        """Return how far along it a place is [mm]."""
        way = sum((position[axis] - place) * self.share(axis) for axis, place in self.start.items())
        return min(max(way, 0.0), self.length)

    @property
    def ahead(self) -> float:
        """How far ahead of where it is the tool is sent, so that it needn't slow down [mm]."""
        braking = self.speed**2 / (2 * self.acceleration * (1 - self.cruise_ratio))
        return self.speed * AHEAD_S + braking

    def next_end(self, position: Sequence[float], sent: float) -> float | None:
        """Return how far it is to be told next [mm], from where it is told by now; None for no further yet."""
        done, part = self.done(position), self.speed * PART_S
        if sent >= self.length or sent - done >= self.ahead:
            return None
        end = done + self.ahead + part
        return self.length if self.length - end < part else end

    def place(self, way: float) -> dict[int, float]:
        """Return where the tool is so far along it [mm]."""
        if way >= self.length:
            return dict(self.goal)
        return {axis: place + way * self.share(axis) for axis, place in self.start.items()}


def script(start: Mapping[int, float], end: Mapping[int, float], speed: float) -> tuple[str, dict[int, float]]:
    """Return the G-code of a part from a place to another one [mm, mm/s], and its lengths as they are told.

    Whatever state its G-code is in, relative or absolute, faster or slower, is as before afterwards.
    """
    words = {axis: _length(start[axis], place) for axis, place in end.items()}
    move = "".join(f" {LETTERS[axis].upper()}{word}" for axis, word in words.items())
    lines = (
        f"SAVE_GCODE_STATE NAME={STATE}",
        "M220 S100",
        "G91",
        f"G1{move} F{speed * 60:.{DECIMALS}f}",
        PUT_BACK,
    )
    return "\n".join(lines), {axis: float(word) for axis, word in words.items()}


def _length(start: float, end: float) -> str:
    """Return a length as it is told [mm]: rounded so that it leads no further than to its end.

    Klipper adds it to the start in double, and refuses what is beyond an end of the travel by however little.
    """
    told = Decimal(f"{end - start:.{DECIMALS}f}")
    least = Decimal(1).scaleb(-DECIMALS).copy_sign(Decimal(end - start))
    while (start + float(told) > end) if end >= start else (start + float(told) < end):
        told -= least
    return f"{told:.{DECIMALS}f}"
