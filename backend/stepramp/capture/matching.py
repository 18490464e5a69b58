"""Matching: which planned step each measured one is, when some are missing and others are too many.

Waits are compared, not instants: a clock that is a little fast or a controller that once is late shifts all instants
that follow, but only the waits where it happens. Where a wait is not the planned one, what explains it best is taken:
a delay, steps that are missing, or steps too many. How well, is told by the waits that follow, and by whether as many
steps are left as the plan has left.
"""

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled, counted

EXTRA = -1
"""Which planned step one is that is none."""
ALIKE = 0.25
"""A wait that differs from the planned one by less than this part is taken for it."""
PER_PART, WORST = 1.5, 3.0
"""What a wait costs that is twice the planned one, and the most that one can cost; a missing or extra step costs 1."""
MUCH = 2
LOOK_AHEAD = 12
"""So many waits behind a place tell what has happened there."""
BACK = 2
"""So many matches before a wait that is not the planned one may be wrong already: a step too many that comes shortly
before a planned one makes the wait after it short, and its own nearly as planned."""
FEW = 3
"""Fewer than so many steps missing, and too many, at one place are tried together."""
SAMPLES = 64
"""So many waits tell where in the move a capture begins that doesn't begin with the move."""
HEAD = 4
"""So many waits at the beginning tell whether it does."""
PER_SHIFT = 0.001
"""What a step costs that such a capture begins later: of places that fit alike the first is taken."""


def match(measured_s: NDArray[np.float64], planned_s: NDArray[np.float64], first_is_first: bool) -> NDArray[np.int64]:
    """Return which planned step each measured one is, counted from 0, or EXTRA, shape of measured_s; increasing.

    measured_s, planned_s: instants [s], not decreasing and increasing, at least one each. first_is_first: the first
    measured step is the first planned one.
    """
    found = np.full(measured_s.size, EXTRA, np.int64)
    cost = _follow(measured_s, planned_s, 0, 0, found)
    if _cost_one_by_one(measured_s, planned_s) <= cost:
        cost = _cost_one_by_one(measured_s, planned_s)
        count = min(measured_s.size, planned_s.size)
        found[:count], found[count:] = counted(0, count), EXTRA
    j, i = (0, 0) if first_is_first else _begin(measured_s, planned_s)
    if j or i:
        within = np.full(measured_s.size, EXTRA, np.int64)
        if _follow(measured_s, planned_s, j, i, within) < cost:
            return within
    return found


@compiled
def _cost(measured, planned):  # type: ignore[no-untyped-def]  # compiled
    return min(PER_PART * abs(measured - planned) / planned, WORST)


@compiled
def _cost_one_by_one(measured, planned):  # type: ignore[no-untyped-def]  # compiled
    count = min(measured.size, planned.size)
    cost = 1.0 * abs(measured.size - planned.size)
    for i in range(1, count):
        cost += _cost(measured[i] - measured[i - 1], planned[i] - planned[i - 1])
    return cost


@compiled
def _cost_of_skipped(extra, missing, more_planned):  # type: ignore[no-untyped-def]  # compiled
    """Return what it costs to skip so many steps, where the plan has so many steps left more than were measured.

    Skipping that makes up for the difference has to be done somewhere: at one place it costs no more than MUCH. What
    adds to it has to be made up for elsewhere, which but for one step costs as much again.
    """
    change = abs(more_planned - missing + extra) - abs(more_planned)
    return extra + missing + max(change - 1, 0) - max(-change - MUCH, 0)


@compiled
def _cost_of_skip(measured, planned, j, i, extra, missing):  # type: ignore[no-untyped-def]  # compiled
    """Return what it costs that behind a match of measured j with planned i come so many extra and missing steps."""
    to_j, to_i = j + 1 + extra, i + 1 + missing
    cost = 1.0 * _cost_of_skipped(extra, missing, (planned.size - i) - (measured.size - j))
    unit = planned[to_i] - planned[to_i - 1]
    apart = abs((measured[to_j] - measured[j]) - (planned[to_i] - planned[i]))
    cost += min(PER_PART * apart / unit, WORST)
    for _ in range(LOOK_AHEAD):
        to_j, to_i = to_j + 1, to_i + 1
        if to_j >= measured.size or to_i >= planned.size:
            break
        cost += _cost(measured[to_j] - measured[to_j - 1], planned[to_i] - planned[to_i - 1])
    return cost


@compiled
def _best_skip(measured, planned, j, i):  # type: ignore[no-untyped-def]  # compiled
    """Return what is likeliest behind a match of measured j with planned i, and what it costs."""
    most_extra, most_missing = measured.size - j - 2, planned.size - i - 2
    best, best_extra, best_missing = np.inf, 0, 0
    # Many missing: those that were to be made meanwhile. Many too many: those made before the next was to be.
    wanted = planned[i] + (measured[j + 1] - measured[j])
    far_missing = np.searchsorted(planned[i + 1 :], wanted)
    wanted = measured[j] + (planned[i + 1] - planned[i])
    far_extra = np.searchsorted(measured[j + 1 :], wanted)
    for extra in range(FEW + 3):
        for missing in range(FEW + 3):
            if (extra >= FEW and missing > 0) or (missing >= FEW and extra > 0):
                continue
            skips = extra if extra < FEW else far_extra + extra - FEW - 1
            misses = missing if missing < FEW else far_missing + missing - FEW - 1
            if 0 <= skips <= most_extra and 0 <= misses <= most_missing:
                cost = _cost_of_skip(measured, planned, j, i, skips, misses)
                if cost < best:
                    best, best_extra, best_missing = cost, skips, misses
    return best, best_extra, best_missing


@compiled
def _place_of_skip(measured, planned, j, i, found):  # type: ignore[no-untyped-def]  # compiled
    """Return how many matches before that of j with i something happened, and what the waits between cost."""
    best, best_back, left_out, best_left_out = np.inf, 0, 0.0, 0.0
    for back in range(BACK + 1):
        at, to = j - back, i - back
        if at < 0 or to < 0 or found[at] != to:
            break
        cost, extra, missing = _best_skip(measured, planned, at, to)
        # With no step skipped it is the path that led here.
        if (back == 0 or extra > 0 or missing > 0) and cost - left_out < best:
            best, best_back, best_left_out = cost - left_out, back, left_out
        if at > 0 and to > 0:
            left_out += _cost(measured[at] - measured[at - 1], planned[to] - planned[to - 1])
    return best_back, best_left_out


@compiled
def _follow(measured, planned, j, i, found):  # type: ignore[no-untyped-def]  # compiled
    """Follow both from a match of measured j with planned i on; put matches into `found`; return the cost."""
    cost = 1.0 * (i + j)
    found[j] = i
    while j + 1 < measured.size and i + 1 < planned.size:
        step = _cost(measured[j + 1] - measured[j], planned[i + 1] - planned[i])
        if step <= PER_PART * ALIKE:
            j, i = j + 1, i + 1
        else:
            back, left_out = _place_of_skip(measured, planned, j, i, found)
            found[j - back + 1 : j + 1] = EXTRA
            j, i, cost = j - back, i - back, cost - left_out
            _, extra, missing = _best_skip(measured, planned, j, i)
            unit = planned[i + 1 + missing] - planned[i + missing]
            apart = abs((measured[j + 1 + extra] - measured[j]) - (planned[i + 1 + missing] - planned[i]))
            step = extra + missing + min(PER_PART * apart / unit, WORST)
            j, i = j + 1 + extra, i + 1 + missing
        cost += step
        found[j] = i
    return cost + (measured.size - 1 - j) + (planned.size - 1 - i)


@compiled
def _begin(measured, planned):  # type: ignore[no-untyped-def]  # compiled
    """Return which measured and which planned step to begin with: the first ones, unless their waits differ."""
    head = 0.0
    for each in range(1, min(HEAD + 1, measured.size, planned.size)):
        head += _cost(measured[each] - measured[each - 1], planned[each] - planned[each - 1])
    count = min(measured.size, planned.size) - 1
    if head <= 1 or count < 1:
        return 0, 0
    best, best_j, best_i = np.inf, 0, 0
    samples = min(SAMPLES, count)
    for shift in range(max(measured.size, planned.size) - count):
        j, i = (shift, 0) if measured.size > planned.size else (0, shift)
        cost = PER_SHIFT * shift
        for sample in range(samples):
            at = sample * count // samples
            wait = planned[i + at + 1] - planned[i + at]
            cost += _cost(measured[j + at + 1] - measured[j + at], wait) * count / samples
            if cost >= best:
                break
        if cost < best:
            best, best_j, best_i = cost, j, i
    return best_j, best_i
