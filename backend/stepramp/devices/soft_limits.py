"""Soft limits: how far axes may go, as the person at the machine says. The server keeps them; controllers know none."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.microsteps import steps
from stepramp.design import MOST_STEPS
from stepramp.errors import Limits, Rejected, Rejection, Told

REACTION_S = 0.5
"""What may pass until a run that comes near a limit is slowed down [s]: while a request isn't answered it is looked
every 0.2 s, and the stop itself may have to be repeated once, after 0.2 s."""


class CountsSteps(Protocol):
    """An axis, with what a step of it is as far as it tells."""

    @property
    def axis(self) -> int:
        """Its number."""

    @property
    def microsteps(self) -> int | None:
        """How many steps it makes of a full step."""

    @property
    def steps_per_mm(self) -> float | None:
        """How many it makes of a mm."""


@dataclass(frozen=True)
class Span:
    """Positions that an axis may be sent to [steps]; None: no limit on that side."""

    lowest_steps: int | None = None
    highest_steps: int | None = None
    microsteps: int | None = None
    """How many steps the axis made of a full step when they were set; None where that isn't told."""
    steps_per_mm: float | None = None
    """The same of a mm."""

    def contains(self, position_steps: int) -> bool:
        """Whether an axis may be there."""
        above = self.lowest_steps is None or position_steps >= self.lowest_steps
        return above and (self.highest_steps is None or position_steps <= self.highest_steps)

    def is_open(self, direction: int) -> bool:
        """Whether there is no limit in a direction, given by its sign."""
        return (self.highest_steps if direction > 0 else self.lowest_steps) is None

    def limits(self, note: str, origin_steps: int = 0) -> Limits:
        """Return where an axis may go as limits, counted from an origin [steps]. note: see Limits."""
        low, high = (None if end is None else end - origin_steps for end in (self.lowest_steps, self.highest_steps))
        return Limits(low, high, "steps", is_whole=True, note=note)

    @property
    def words(self) -> str:
        """The span as people read it."""
        low = "any position" if self.lowest_steps is None else f"{self.lowest_steps:,}"
        high = "any position" if self.highest_steps is None else f"{self.highest_steps:,}"
        return f"{low} to {high} steps"


FREE = Span()
Spans = Mapping[int, Span]


def refuse_beyond(
    spans: Spans, commands: Sequence[AxisCommand], from_steps: Mapping[int, int], *, relative: bool
) -> None:
    """Reject targets beyond soft limits, and ways of more than ten million steps towards where an axis has none.

    commands: distances, or else positions [steps]. from_steps: where each axis would come to rest otherwise [steps];
    axes that aren't known are left to the controller.
    """
    rejections = []
    for each in commands:
        if each.axis not in from_steps:
            continue
        start, span = from_steps[each.axis], spans.get(each.axis, FREE)
        target = start + int(each.value) if relative else int(each.value)
        if not span.contains(target):
            to = f", and this leads to {target:,}" if relative else ""
            allowed = f"what stays within the soft limits of axis {each.axis}, {span.words}{to}"
            note = f", the soft limits of axis {each.axis}{' from there' if relative and start else ''}"
            limits = span.limits(note, start if relative else 0)
            rejections.append(Rejection(each.field, int(each.value), allowed, limits))
        elif abs(target - start) > MOST_STEPS and span.is_open(target - start):
            origin = 0 if relative else start
            note = f", since axis {each.axis} has no soft limit there"
            limits = Limits(origin - MOST_STEPS, origin + MOST_STEPS, "steps", is_whole=True, note=note)
            rejections.append(Rejection.outside(each.field, int(each.value), limits))
    if rejections:
        raise Rejected(rejections)


def trouble_of(spans: Spans, axes: Iterable[CountsSteps]) -> str | None:
    """Return what keeps axes from being moved whose steps are others than when these were set, as a sentence.

    None for nothing. Of the same number of steps other microsteps make another place, and other steps per mm another
    length than was asked for.
    """
    for each in axes:
        span = spans.get(each.axis, FREE)
        if span.microsteps and each.microsteps and span.microsteps != each.microsteps:
            before, now = f"{steps(span.microsteps)} of a full step", steps(each.microsteps)
        elif span.steps_per_mm and each.steps_per_mm and not _is_same(span.steps_per_mm, each.steps_per_mm):
            before, now = f"{span.steps_per_mm:,.7g} steps per mm", f"{each.steps_per_mm:,.7g}"
        else:
            continue
        return (
            f"The soft limits of axis {each.axis} were set while it made {before}, and by now it makes {now}, so they "
            "would be at other places: it doesn't move. Set them anew, or take them away."
        )
    return None


def _is_same(one_per_mm: float, other_per_mm: float) -> bool:
    """Tell whether steps per mm differ by less than any of as many steps as an axis is sent shows."""
    return math.isclose(one_per_mm, other_per_mm, rel_tol=1 / MOST_STEPS)


def out_of_limits(command: AxisCommand, span: Span, fastest_steps_per_s: int) -> Rejection:
    """Return the rejection of a speed that leads out of soft limits, or too near to them to stop in time.

    fastest_steps_per_s: the fastest that way with which it would stop in time; 0: none.
    """
    fastest = Told(f"{fastest_steps_per_s:,} steps/s", fastest_steps_per_s, "steps/s", "down")
    low, high = (
        None if end is None else Told(f"{end:,} steps", end, "steps") for end in (span.lowest_steps, span.highest_steps)
    )
    ends = f"{low or 'any position'} to {high or 'any position'}"
    speed = f"at most {fastest} that way" if fastest_steps_per_s else "no speed that way"
    allowed = f"{speed}, as axis {command.axis} has to come to rest within its soft limits, {ends}"
    told = ([fastest] if fastest_steps_per_s else []) + [end for end in (low, high) if end is not None]
    return Rejection(command.field, command.value, allowed, told=tuple(told))


def comes_too_near(span: Span, position_steps: float, velocity_steps_per_s: float, steps_to_rest: int) -> bool:
    """Tell whether an axis that runs comes to rest beyond its soft limits, unless it slows down now.

    velocity_steps_per_s: with its sign. steps_to_rest: what slowing down takes.
    """
    ahead = steps_to_rest + abs(velocity_steps_per_s) * REACTION_S
    if velocity_steps_per_s > 0:
        return span.highest_steps is not None and position_steps + ahead >= span.highest_steps
    return span.lowest_steps is not None and position_steps - ahead <= span.lowest_steps
