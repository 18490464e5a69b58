"""A judge of pulse times: says what is wrong with a move, from the edges of the pins and what it was designed for.

It knows neither how the firmware plays a ramp nor how a ramp is computed, only what a motor asks for: pulses in number,
length and direction as ordered, a speed that rises, stays and falls, and no acceleration beyond the designed ones.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

CYCLES_PER_US = 16
CYCLES_PER_S = 16_000_000
STEP_PINS = (2, 3, 4, 12)
DIRECTION_PINS = (5, 6, 7, 13)
ENABLE_PIN = 8
WINDOWS = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512)
"""Steps over which a speed is taken: the longer, the less does the lateness of single steps count."""

PART = 64

Edges = npt.NDArray[np.void]
Cycles = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Limits:
    """What a move was designed for, and how far the pulses may be from it."""

    steps: int
    """With sign."""
    start_interval_us: float
    """From rest: the first interval is not shorter."""
    slew_speed: float
    """[steps/s]"""
    acceleration: float
    """[steps/s²]"""
    deceleration: float
    setup_us: float = 30.0
    """From the direction to the pulse."""
    pulse_us: float = 1.0
    """Least width of a pulse and of the pause after it."""
    late_us: float = 2.0
    """How late a single pulse may be."""
    tick_us: float = 1 / 16
    compression: float = 0.0
    """By which share an interval may differ from the designed one, besides the tick."""
    steeper: float = 0.1
    """By which share the acceleration may be higher than designed."""
    is_one_way: bool = True
    """The speed rises, stays and falls, once."""
    step_inverted: bool = False
    direction_inverted: bool = False
    both_edges: bool = False

    def unsure(self, spans: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return by how much times between pulses may differ from the designed ones [cycles]."""
        return (self.late_us + self.tick_us) * CYCLES_PER_US + self.compression * spans


@dataclass(frozen=True)
class AxisEdges:
    """The edges of one axis."""

    steps: Cycles
    """When its steps began."""
    ends: Cycles
    """When its pulses ended; none where each edge is a step."""
    turns: Cycles
    forward: npt.NDArray[np.bool_]
    """For each step."""

    @property
    def travel(self) -> int:
        return int(2 * self.forward.sum() - self.forward.size)


def of_pin(edges: Edges, pin: int) -> Edges:
    return edges[edges["pin"] == pin]


def axis_of(
    edges: Edges,
    axis: int = 0,
    *,
    step_inverted: bool = False,
    direction_inverted: bool = False,
    both_edges: bool = False,
) -> AxisEdges:
    """Return what the pins of an axis did. A pin that has no edge yet is low."""
    step, turn = of_pin(edges, STEP_PINS[axis]), of_pin(edges, DIRECTION_PINS[axis])
    # An inverted pin rises once to its resting level, before any step.
    step = step[1:] if step_inverted and step.size and step[0]["value"] == 1 else step
    begins = np.ones(step.size, bool) if both_edges else step["value"] == (0 if step_inverted else 1)
    steps = step["cycle"][begins].astype(np.int64)
    last_turn = np.searchsorted(turn["cycle"], steps, side="right") - 1
    levels = np.where(last_turn >= 0, turn["value"][last_turn] if turn.size else 0, 0)
    return AxisEdges(steps, step["cycle"][~begins], turn["cycle"], (levels == 1) != direction_inverted)


def faults(edges: Edges, limits: Limits, axis: int = 0) -> list[str]:
    """Return what is wrong with a move of an axis; `edges` are those of this move, with the direction before it."""
    options = {name: getattr(limits, name) for name in ("step_inverted", "direction_inverted", "both_edges")}
    made = axis_of(edges, axis, **options)
    found = _count_faults(made, limits) + _pin_faults(made, limits)
    if made.steps.size < 2:
        return found
    intervals = np.diff(made.steps).astype(float)
    found += _speed_faults(intervals, limits) + _slope_faults(intervals, limits)
    return found + _shape_faults(intervals, limits) if limits.is_one_way else found


def assert_good(edges: Edges, limits: Limits, axis: int = 0) -> None:
    found = faults(edges, limits, axis)
    assert not found, "\n".join(found)


def _count_faults(made: AxisEdges, limits: Limits) -> list[str]:
    found = []
    if made.steps.size != abs(limits.steps):
        found.append(f"{made.steps.size} steps instead of {abs(limits.steps)}")
    wrong = int((made.forward != (limits.steps > 0)).sum())
    if wrong:
        found.append(f"{wrong} steps in the wrong direction")
    return found


def _pin_faults(made: AxisEdges, limits: Limits) -> list[str]:
    """Pulses long enough and complete, and the direction set in time and then still."""
    found, shortest = [], limits.pulse_us * CYCLES_PER_US
    if not limits.both_edges:
        if made.ends.size != made.steps.size or (made.ends <= made.steps).any():
            return ["a pulse without an end"]
        if (made.ends - made.steps < shortest).any():
            found.append(f"a pulse of {(made.ends - made.steps).min() / CYCLES_PER_US:.2f} us")
        if (made.steps[1:] - made.ends[:-1] < shortest).any():
            found.append(f"a pause of {(made.steps[1:] - made.ends[:-1]).min() / CYCLES_PER_US:.2f} us")
    for turn in made.turns:
        after, before = made.steps[made.steps >= turn], made.steps[made.steps < turn]
        if after.size and after[0] - turn < limits.setup_us * CYCLES_PER_US:
            found.append(f"a step {(after[0] - turn) / CYCLES_PER_US:.2f} us after the direction")
        if before.size and after.size:
            found.append("the direction changes within the move")
    return found


def _speed_faults(intervals: npt.NDArray[np.float64], limits: Limits) -> list[str]:
    """Never faster than slew speed, and no jump from or to rest."""
    found, slew = [], CYCLES_PER_S / limits.slew_speed
    rounding = limits.tick_us / 2 * CYCLES_PER_US + limits.compression * slew
    for count, spans in _spans(intervals):
        if (spans < count * (slew - rounding) - limits.late_us * CYCLES_PER_US - 1).any():
            speed = count / (spans.min() / CYCLES_PER_S)
            found.append(f"{speed:.0f} steps/s over {count} steps, slew speed is {limits.slew_speed:.0f}")
            break
    sure = intervals + limits.unsure(intervals)
    if sure[0] < limits.start_interval_us * CYCLES_PER_US:
        found.append(f"the first interval is {intervals[0] / CYCLES_PER_US:.2f} us")
    # Between its last two pulses a motor has one step and a half to stop in.
    slowest_end = CYCLES_PER_S / np.sqrt(3 * limits.deceleration * (1 + limits.steeper))
    if sure[-1] < min(slowest_end, limits.start_interval_us * CYCLES_PER_US):
        found.append(f"the last interval is {intervals[-1] / CYCLES_PER_US:.2f} us")
    return found


def _shape_faults(intervals: npt.NDArray[np.float64], limits: Limits) -> list[str]:
    """Up, level, down: taken over windows, speeds rise to the highest and then fall; and the level is even."""
    for _, spans in _spans(intervals):
        top = int(spans.argmin())
        for name, side in (("rises", spans[: top + 1]), ("falls", spans[top:][::-1])):
            back = side - np.minimum.accumulate(side) - 2 * (limits.late_us + limits.tick_us) * CYCLES_PER_US
            if (back > 0).any():
                at = int(back.argmax())
                return [
                    f"the speed goes back while it {name}: interval {at if name == 'rises' else spans.size - 1 - at}"
                ]
    return _level_faults(intervals, limits)


def _level_faults(intervals: npt.NDArray[np.float64], limits: Limits) -> list[str]:
    """At slew speed, well away from the ramps, the steps lie on a line, so that none is later than allowed. In parts,
    each against a parabola: the end of a gentle ramp can't be told from slew speed."""
    spans, slew = dict(_spans(intervals)).get(PART // 4, np.empty(0)), CYCLES_PER_S / limits.slew_speed
    near = np.flatnonzero(spans - limits.unsure(spans) <= PART // 4 * slew)
    if near.size < 2 * PART:
        return []
    times = np.concatenate(([0.0], np.cumsum(intervals)))[near[0] + PART // 2 : near[-1] - PART // 4]
    late, place = 0.0, np.linspace(-1, 1, PART)
    for begin in range(0, times.size - PART + 1, PART // 2):
        part = times[begin : begin + PART]
        rest = part - np.polyval(np.polyfit(place, part, 2), place)
        late = max(late, float(rest.max() - rest.min()) / CYCLES_PER_US)
    allowed = 1.1 * limits.late_us + limits.tick_us + limits.compression * PART / 2 * slew / CYCLES_PER_US
    return [f"a step is {late:.1f} us late at slew speed"] if late > allowed else []


def _slope_faults(intervals: npt.NDArray[np.float64], limits: Limits) -> list[str]:
    """The least acceleration that the times allow is not above the designed one, nor the deceleration."""
    found = []
    for count, spans in _spans(intervals):
        before, after = spans[:-count], spans[count:]
        between = (before + after) / 2 / CYCLES_PER_S
        up = count * CYCLES_PER_S * (_slowest(after, limits) - _fastest(before, limits)) / between
        down = count * CYCLES_PER_S * (_slowest(before, limits) - _fastest(after, limits)) / between
        for name, made, designed in (("up", up, limits.acceleration), ("down", down, limits.deceleration)):
            if made.size and made.max() > designed * (1 + limits.steeper):
                found.append(
                    f"{made.max():.0f} steps/s² {name} at step {int(made.argmax()) + count}, over {count} steps"
                )
    return found


def _slowest(spans: npt.NDArray[np.float64], limits: Limits) -> npt.NDArray[np.float64]:
    return 1 / (spans + limits.unsure(spans))


def _fastest(spans: npt.NDArray[np.float64], limits: Limits) -> npt.NDArray[np.float64]:
    return 1 / np.maximum(spans - limits.unsure(spans), 1)


def _spans(intervals: npt.NDArray[np.float64]) -> list[tuple[int, npt.NDArray[np.float64]]]:
    """Return for each window the times that so many steps took, wherever they began."""
    times = np.concatenate(([0.0], np.cumsum(intervals)))
    return [(count, times[count:] - times[:-count]) for count in WINDOWS if count <= intervals.size]


def lateness_us(steps: Cycles, intervals: npt.ArrayLike, cycles_per_tick: int) -> npt.NDArray[np.float64]:
    """Return how late each step is, after the earliest place that all of them allow. There must be as many intervals
    [ticks] as steps; the last one is not measured."""
    planned = np.asarray(intervals, np.int64)[:-1] * cycles_per_tick
    assert steps.size == planned.size + 1, f"{steps.size} steps instead of {planned.size + 1}"
    late = steps - np.concatenate(([0], np.cumsum(planned)))
    return (late - late.min()) / CYCLES_PER_US


def resting(steps: Cycles, longest_us: float) -> list[Cycles]:
    """Return the steps from rest to rest, where a pause longer than this is a rest."""
    ends = np.flatnonzero(np.diff(steps) > longest_us * CYCLES_PER_US) + 1
    return [steps[begin:end] for begin, end in pairwise([0, *ends, steps.size])]
