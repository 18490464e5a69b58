"""A ramp generator of the TMC5160's kind, as its data sheet says that one goes: in small slices of time.

It knows no formula for a whole ramp: in each slice it gains speed, keeps it, or has to brake to get to rest in time.
"""

from __future__ import annotations

import math

CLOCK_HZ = 16_000_000
SPEED, ACCELERATION = CLOCK_HZ / 2**24, CLOCK_HZ**2 / 2**41
"""Its units [steps/s, steps/s²]."""
POSITION, FORWARDS, BACKWARDS = 0, 1, 2


class Chip:
    """One axis; its registers in its own units, its motion in steps and seconds."""

    def __init__(self) -> None:
        self.vstart, self.a1, self.v1, self.amax = 0, 500, 0, 500
        self.vmax, self.dmax, self.d1, self.vstop = 0, 500, 500, 10
        self.mode, self.target = FORWARDS, 0
        self.place, self.speed = 0.0, 0.0
        """Where it is [steps] and how fast, with sign [steps/s]."""
        self.forward_switch = self.backward_switch = False
        self.steps = 0
        """How many it has made, to and fro."""
        self.instants: list[float] = []
        """When it made each, if they are kept; from when it was told to [s]."""
        self.keeps_instants = False
        self._now_s = 0.0

    @property
    def position(self) -> int:
        return math.floor(self.place + 1e-9) if self.speed >= 0 else math.ceil(self.place - 1e-9)

    @position.setter
    def position(self, steps: int) -> None:
        self.place = float(steps)

    def advance(self, slice_s: float) -> None:
        before, place = self.position, self.place
        if self.mode == POSITION:
            self._to_the_target(slice_s)
        else:
            self._towards(self.vmax * SPEED * (1 if self.mode == FORWARDS else -1), slice_s)
        if (self.forward_switch and self.speed > 0) or (self.backward_switch and self.speed < 0):
            self.speed = 0.0
        self._note(before, place, slice_s)

    def _towards(self, wanted: float, slice_s: float) -> None:
        """Go at a speed: with AMAX up to it and down to it."""
        most = self.amax * ACCELERATION * slice_s
        last = self.speed
        speed = last + max(-most, min(most, wanted - last))
        self.place += (last + speed) / 2 * slice_s
        if not speed:
            # A step that was only begun is none: it rests at the last one that it has made.
            self.place = float(self.position)
        self.speed = speed

    def _to_the_target(self, slice_s: float) -> None:
        ahead = self.target - self.place
        direction = 1 if ahead > 0 else -1
        if self.speed * direction < 0:
            self._brake(slice_s)
            return
        speed = abs(self.speed)
        if not ahead:
            self.speed = 0.0
            return
        if not speed:
            speed = self.vstart * SPEED
        if self._way_to_rest(speed) >= abs(ahead):
            last, speed = speed, max(self.vstop * SPEED, speed - self._rate(speed, self.d1, self.dmax) * slice_s)
        else:
            last = speed
            speed = min(max(self.vmax * SPEED, 0.0), speed + self._rate(speed, self.a1, self.amax) * slice_s)
        way = (last + speed) / 2 * slice_s
        if way >= abs(ahead):
            self.place, self.speed = float(self.target), 0.0
        else:
            self.place, self.speed = self.place + direction * way, direction * speed

    def _brake(self, slice_s: float) -> None:
        sign = 1 if self.speed > 0 else -1
        last = abs(self.speed)
        speed = last - self._rate(last, self.d1, self.dmax) * slice_s
        speed = 0.0 if speed <= self.vstop * SPEED else speed
        self.place += sign * (last + speed) / 2 * slice_s
        self.speed = sign * speed

    def _rate(self, speed: float, below: int, above: int) -> float:
        return (below if speed < self.v1 * SPEED else above) * ACCELERATION

    def _way_to_rest(self, speed: float) -> float:
        bend, stop = self.v1 * SPEED, self.vstop * SPEED
        above = max(0.0, speed**2 - max(bend, stop) ** 2) / (2 * self.dmax * ACCELERATION)
        below = max(0.0, min(speed, bend) ** 2 - stop**2) / (2 * self.d1 * ACCELERATION) if bend else 0.0
        return above + below

    def _note(self, before: int, place: float, slice_s: float) -> None:
        made = abs(self.position - before)
        self.steps += made
        if self.keeps_instants and made:
            # Within a slice it goes evenly.
            pace = slice_s / (self.place - place)
            self.instants += [self._now_s + (before + 1 + each - place) * pace for each in range(made)]
        self._now_s += slice_s
