"""The judge of pulse times sees each kind of fault, and none where there is none."""

from dataclasses import replace

import numpy as np
import pytest

from firmware.checker import CYCLES_PER_S, DIRECTION_PINS, STEP_PINS, Edges, Limits, faults, lateness_us, resting
from simulator.avr import EDGE

LIMITS = Limits(1200, 4000.0, 10_000, 100_000, 50_000, pulse_us=2.0)
"""500 steps up, 1000 down where there is room; 1200 steps don't reach slew speed."""
LONG = replace(LIMITS, steps=2500)
PULSE_CYCLES = 40


def pulse_times(limits: Limits) -> np.ndarray:
    """Return when the pulses of a motor come [cycles] that accelerates evenly, from the formulas for motion."""
    steps, up, down = abs(limits.steps), limits.acceleration, limits.deceleration
    top = min(limits.slew_speed, (2 * steps * up * down / (up + down)) ** 0.5)
    distance = np.arange(steps, dtype=float)
    rising, falling = top**2 / (2 * up), top**2 / (2 * down)
    level_s = (steps - rising - falling) / top
    times = np.where(
        distance < rising,
        np.sqrt(2 * distance / up),
        np.where(
            distance < steps - falling,
            top / up + (distance - rising) / top,
            top / up + level_s + top / down - np.sqrt(2 * (steps - distance) / down),
        ),
    )
    return 100_000 + np.round(times * CYCLES_PER_S).astype(np.int64)


def as_edges(times: np.ndarray, *, forward: bool = True, setup_us: float = 30, width: int = PULSE_CYCLES) -> Edges:
    """Return edges of axis 0: its direction, then its pulses. Forward has been set long before, backward is set now."""
    turn = int(times[0] - setup_us * 16)
    rows = [(0, DIRECTION_PINS[0], 1)] if forward else [(0, DIRECTION_PINS[0], 1), (turn, DIRECTION_PINS[0], 0)]
    rows += [(int(t) + after, STEP_PINS[0], value) for t in times for after, value in ((0, 1), (width, 0))]
    return np.array(sorted(rows), EDGE)


@pytest.mark.parametrize("steps", [1, 2, 3, 50, 1200, 2500, -1, -2500])
def test_an_even_move_is_good(steps: int) -> None:
    limits = replace(LIMITS, steps=steps)
    assert faults(as_edges(pulse_times(limits), forward=steps > 0), limits) == []


@pytest.mark.parametrize("late_us", [0.5, 1.9])
def test_lateness_is_forgiven_as_far_as_it_is_allowed(late_us: float) -> None:
    random = np.random.default_rng(1)
    late = (random.random(LONG.steps) * late_us * 16).astype(np.int64)
    assert faults(as_edges(pulse_times(LONG) + late), LONG) == []


def test_steps_in_whole_slow_ticks_are_good() -> None:
    intervals = np.round(np.diff(pulse_times(LONG)) / 8).astype(np.int64) * 8
    times = 100_000 + np.concatenate(([0], np.cumsum(intervals)))
    assert faults(as_edges(times), replace(LONG, tick_us=0.5)) == []


def seen(times: np.ndarray, limits: Limits = LONG, **how: object) -> str:
    return "; ".join(faults(as_edges(times, **how), limits))  # type: ignore[arg-type]  # of as_edges


@pytest.mark.parametrize("at", [1, 20, 300, 700, 1200, 2000, 2498])
def test_a_lost_step(at: int) -> None:
    """It shows in the count; and in the speed, when there is one too many elsewhere."""
    times = pulse_times(LONG)
    lost = np.delete(times, at)
    assert "2499 steps" in seen(lost)
    moved = replace(LONG, steps=2499)
    assert any(word in seen(lost, moved) for word in ("steps/s²", "back", "late"))


@pytest.mark.parametrize("at", [0, 20, 700, 2400])
def test_an_extra_step(at: int) -> None:
    times = pulse_times(LONG)
    extra = np.sort(np.append(times, (times[at] + times[at + 1]) // 2))
    assert "2501 steps" in seen(extra)
    assert any(word in seen(extra, replace(LONG, steps=2501)) for word in ("steps/s", "the first interval"))


def test_an_extra_step_after_the_end() -> None:
    times = pulse_times(LONG)
    assert "2501 steps" in seen(np.append(times, times[-1] + 1_000_000))


@pytest.mark.parametrize("at", [300, 900, 2000])
@pytest.mark.parametrize("late_us", [10, -10])
def test_a_late_or_early_step(at: int, late_us: int) -> None:
    times = pulse_times(LONG)
    times[at] += late_us * 16
    assert seen(times)


def test_a_step_that_is_a_little_late_at_slew_speed() -> None:
    times = pulse_times(LONG)
    times[900] += 3 * 16
    assert "us late at slew speed" in seen(times)


def test_a_speed_spike() -> None:
    """Twenty steps 10 % faster than slew speed."""
    times = pulse_times(LONG)
    intervals = np.diff(times)
    intervals[800:820] = intervals[800:820] * 9 // 10
    assert "slew speed is 10000" in seen(times[0] + np.concatenate(([0], np.cumsum(intervals))))


def test_a_slew_speed_that_is_slightly_too_high() -> None:
    faster = replace(LONG, slew_speed=10_100.0)
    assert "slew speed is 10000" in seen(pulse_times(faster))


def test_the_wrong_direction() -> None:
    assert "2500 steps in the wrong direction" in seen(pulse_times(LONG), forward=False)


def test_a_change_of_direction_on_the_way() -> None:
    edges = as_edges(pulse_times(LONG))
    at = edges["cycle"][len(edges) // 2] - 2
    turned = np.sort(np.append(edges, np.array([(at, DIRECTION_PINS[0], 0)], EDGE)), order="cycle")
    found = "; ".join(faults(turned, LONG))
    assert "steps in the wrong direction" in found
    assert "the direction changes within the move" in found


@pytest.mark.parametrize("steps", [300, 1200, 2500])
@pytest.mark.parametrize(("up", "down"), [(1.25, 1), (1, 1.25)])
def test_a_ramp_too_steep(steps: int, up: float, down: float) -> None:
    limits = replace(LIMITS, steps=steps)
    steep = replace(limits, acceleration=up * limits.acceleration, deceleration=down * limits.deceleration)
    assert (
        "steps/s² up" in seen(pulse_times(steep), limits)
        if up > 1
        else "steps/s² down" in seen(pulse_times(steep), limits)
    )


def test_no_ramp_at_all() -> None:
    found = seen(100_000 + 1600 * np.arange(2500))
    assert "the first interval is 100.00 us" in found


def test_a_move_cut_short_at_speed() -> None:
    """As many steps as ordered, but the last of them at slew speed."""
    longer = pulse_times(replace(LONG, steps=4000))[:2500]
    assert "the last interval is 100.00 us" in seen(longer)


def test_a_short_pulse_and_a_short_pause() -> None:
    assert "a pulse of 1.50 us" in seen(pulse_times(LONG), width=24)
    assert "a pause of" in seen(pulse_times(LONG), width=1580)


def test_a_step_during_the_set_up() -> None:
    limits = replace(LONG, steps=-2500)
    times = pulse_times(limits)
    assert faults(as_edges(times, forward=False, setup_us=30), limits) == []
    assert "a step 29.00 us after the direction" in "; ".join(
        faults(as_edges(times, forward=False, setup_us=29), limits)
    )


def test_lateness_against_a_plan() -> None:
    steps = np.array([1000, 1800, 2610, 3400])
    assert lateness_us(steps, [100, 100, 100, 100], 8).tolist() == [0, 0, 10 / 16, 0]
    with pytest.raises(AssertionError, match="4 steps instead of 3"):
        lateness_us(steps, [100, 100, 100], 8)


def test_moves_are_told_apart_by_rests() -> None:
    assert [part.tolist() for part in resting(np.array([0, 160, 3200, 3360]), 100)] == [[0, 160], [3200, 3360]]
