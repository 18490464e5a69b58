"""How Klipper packs steps for its boards: rows of intervals, each of which is longer than the one before by the same.

The board makes a row's k-th step i·k + a·k·(k - 1)/2 clock cycles after the row began. Each step may come earlier than
it should, never later: by up to 25 µs, and by no more than half of its interval. For each row an `a` is searched by
bisection that carries furthest; one of equal intervals is taken where it carries nearly as far.

Source: how Klipper works, as its `klippy/chelper/stepcompress.c` says.
"""

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled

CLOCK_HZ = 16_000_000
"""Of the board: an ATmega's. A faster one tells finer, and packs the same."""
MOST_EARLY_S = 25e-6
"""Klipper's max_stepper_error, which is not to be configured."""
GAP_S = 0.25
"""So long before a move there was no step, or longer."""
_MOST_EARLY = round(MOST_EARLY_S * CLOCK_HZ)
_LEAST_ADD, _MOST_ADD = -0x8000, 0x7FFF
_LONGEST_ROW = 65_535
_STRAIGHT = 0x200
"""A row of more steps is taken as it is."""
_DEVIATION = 11
"""Two rows of n steps within the same windows differ in `a` by 11.66 times the most early, over n²."""


def packed_s(instants: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return when the steps of a move are made [s], given when they should be; both of shape (steps,)."""
    clocks = np.floor((instants + GAP_S) * CLOCK_HZ).astype(np.int64)
    made: NDArray[np.float64] = _packed(clocks) / CLOCK_HZ - GAP_S
    return made


@compiled
def _packed(clocks):  # type: ignore[no-untyped-def]  # compiled
    made = np.empty_like(clocks)
    done, last = 0, np.int64(0)
    while done < clocks.size:
        interval, count, add = _row(clocks, done, last)
        for _ in range(count):
            last += interval
            interval += add
            made[done] = last
            done += 1
    return made


@compiled
def _window(clocks, done, last, number):  # type: ignore[no-untyped-def]  # compiled
    """Return from when to when the n-th step of a row may be made, counted from where the row begins."""
    place = done + number - 1
    latest = clocks[place] - last
    before = clocks[place - 1] - last if number > 1 else 0
    return latest - min((latest - before) // 2, _MOST_EARLY), latest


@compiled
def _row(clocks, done, last):  # type: ignore[no-untyped-def]  # compiled
    """Return the first interval, the number of steps, and what each interval is longer by, of the next row."""
    most = min(clocks.size - done, _LONGEST_ROW)
    low, high = _window(clocks, done, last, 1)
    least_add, most_add, add = _LEAST_ADD, _MOST_ADD, 0
    best, reached, even = (high, 1, 0), np.int64(-(2**62)), (high, 1, 0)
    while True:
        first, count, lowest, highest, wanted = _carried(clocks, done, last, add, low, high, most)
        if count == most:
            return first, count, add
        reach = add * (count * (count - 1) // 2) + first * count
        if reach > reached or (reach == reached and first > best[0]):
            best, reached = (first, count, add), reach
            if add == 0:
                even = best
            if count > _STRAIGHT:
                break
        number = count + 1
        factor = number * (number - 1) // 2
        if add * factor + first * number < wanted:
            least_add, high = add + 1, highest
        else:
            most_add, low = add - 1, lowest
        if count > 1:
            apart = _MOST_EARLY * _DEVIATION // (count * count)
            least_add, most_add = max(least_add, add - apart), min(most_add, add + apart)
        earliest, latest = _window(clocks, done, last, number)
        least_add = max(least_add, -((high * number - earliest) // factor))
        most_add = min(most_add, (latest - low * number) // factor)
        if least_add > most_add:
            break
        add = most_add - (most_add - least_add) // 4
    return even if even[1] + even[1] // 16 >= best[1] else best


@compiled
def _carried(clocks, done, last, add, low, high, most):  # type: ignore[no-untyped-def]  # compiled
    """Return how far a row with an `a` carries: its first interval, its steps, and where it ends.

    That is from which to which first interval the step after it asks for, and the earliest that this may come.
    """
    first, count = high, 1
    while count < most:
        number = count + 1
        earliest, latest = _window(clocks, done, last, number)
        bend = add * (number * (number - 1) // 2)
        next_low = max(low, -((bend - earliest) // number))
        next_high = min(high, (latest - bend) // number)
        if next_low > next_high:
            return first, count, next_low, next_high, earliest
        low, high, first, count = next_low, next_high, next_high, number
    return first, count, low, high, np.int64(0)
