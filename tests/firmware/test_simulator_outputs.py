"""What the settings make of the pins on the simulated chip; and gauges, which have four pins each."""

from itertools import pairwise

import numpy as np
import pytest

from firmware.checker import (
    CYCLES_PER_US,
    DIRECTION_PINS,
    ENABLE_PIN,
    STEP_PINS,
    Edges,
    assert_good,
    lateness_us,
    of_pin,
)
from firmware.protocol import STATUS, ZERO, Client, Ramp, Settings
from firmware.rig import Make, Played, RampDesign, image, move_by, play, request

PLAN = RampDesign(10_000, 200_000, 100_000)
LATE_US = 60
"""Of four axes that set out at the same tick."""
START_US = 250
"""At the start of a move, in addition to the set-up."""
CYCLES_PER_MS = 1000 * CYCLES_PER_US
COILS = (0x9, 0x1, 0x7, 0x6, 0xE, 0x8)
"""The six states of a gauge's motor, its first pin in bit 0; forward is from left to right."""
STEPS = (300, -200, 100, -50)


def play_four(make: Make, settings: Settings) -> Played:
    return play(make, image([PLAN] * 4), move_by(*STEPS), settings=settings)


@pytest.mark.parametrize(
    "settings",
    [
        Settings(step_inverted=0b1010),
        Settings(direction_inverted=0b0110),
        Settings(step_inverted=0b1111, direction_inverted=0b1111, pulse_width_us=5),
        Settings(both_edges=0b0101),
        Settings(both_edges=0b1000, direction_inverted=0b1000),
    ],
    ids=str,
)
def test_axes_with_pins_of_their_own_kind(simulated_controller: Make, settings: Settings) -> None:
    """Whatever the pins are like, the motors make the same moves."""
    played = play_four(simulated_controller, settings)
    for axis, steps in enumerate(STEPS):
        limits = PLAN.limits(
            steps,
            late_us=LATE_US,
            step_inverted=bool(settings.step_inverted >> axis & 1),
            direction_inverted=bool(settings.direction_inverted >> axis & 1),
            both_edges=bool(settings.both_edges >> axis & 1),
        )
        assert_good(played.edges, limits, axis)
        made = played.axis(axis, settings)
        assert made.travel == steps == played.statuses[axis].position
        assert lateness_us(made.steps, PLAN.ramp.intervals(abs(steps)), 1).max() <= LATE_US


@pytest.mark.parametrize("width_us", [0, 1, 3, 10, 100])
def test_pulses_are_so_wide_at_least(simulated_controller: Make, width_us: int) -> None:
    """And not much wider, but for interrupts of the serial port in between, for which wide ones leave room."""
    slow = RampDesign(2000, 40_000, 40_000)
    played = play(simulated_controller, image([slow]), move_by(200), settings=Settings(pulse_width_us=width_us))
    widths = (played.axis().ends - played.steps()) / CYCLES_PER_US
    assert widths.min() >= max(width_us, 2.0)
    assert widths.min() <= max(width_us, 2.5) + 2.5
    assert np.median(widths) <= max(width_us, 2.5) + (2.5 if width_us <= 10 else 10)


@pytest.mark.parametrize("setup_us", [20, 30, 500, 15_000])
def test_the_direction_is_set_in_time(simulated_controller: Make, setup_us: int) -> None:
    played = play(
        simulated_controller, image([PLAN]), move_by(-20), move_by(20), settings=Settings(direction_setup_us=setup_us)
    )
    turns = played.axis().turns
    assert len(turns) >= 2
    for turn in turns[-2:]:
        waited = played.steps()[played.steps() > turn][0] - turn
        assert setup_us <= waited / CYCLES_PER_US <= setup_us + START_US


@pytest.mark.parametrize("active_high", [False, True])
@pytest.mark.parametrize(("lead_ms", "hold_ms"), [(0, 0), (5, 20), (50, 100)])
def test_motors_are_enabled_in_time_and_let_go(
    simulated_controller: Make,
    lead_ms: int,
    hold_ms: int,
    active_high: bool,
) -> None:
    settings = Settings(enable_lead_ms=lead_ms, enable_hold_ms=hold_ms, enable_flags=int(active_high))

    def wait(client: Client) -> None:
        while client.status().flags & 4:
            pass

    played = play(simulated_controller, image([PLAN]), move_by(100), wait, settings=settings)
    on, off = (edge["cycle"] for edge in enable_edges(played.edges, active_high)[-2:])
    steps = played.steps()
    assert lead_ms <= (steps[0] - on) / CYCLES_PER_MS <= lead_ms + 3
    last_interval = PLAN.ramp.intervals(100)[-1]
    assert hold_ms - 2 <= (off - steps[-1] - last_interval) / CYCLES_PER_MS <= hold_ms + 3


def enable_edges(edges: Edges, active_high: bool) -> Edges:
    """Return the edges of the enable pin; the last but one must enable, the last one disable."""
    own = of_pin(edges, ENABLE_PIN)
    assert own["value"][-2:].tolist() == [int(active_high), int(not active_high)]
    return own


def test_motors_stay_enabled_for_good(simulated_controller: Make) -> None:
    played = play(simulated_controller, image([PLAN]), move_by(50))
    assert played.statuses[0].flags & 4
    assert of_pin(played.edges, ENABLE_PIN)["value"][-1] == 0


# ---- gauges ----

GAUGE = Ramp([(4000, 6, 0), (2500, 20, 0), (1500, 40, 0)], 1000, [(4000, 6, 0), (2500, 20, 0), (1500, 40, 0)])
GAUGES = Settings(outputs=1)
TOGETHER_CYCLES = 5 * CYCLES_PER_US
GAUGE_LATE_US = 150
"""The shortest interval of a gauge is 200 us."""


def coils_of(edges: Edges, gauge: int) -> list[tuple[int, int]]:
    """Return (cycle, pattern) of a gauge's four pins: when they became a gauge's, then each time that they changed.

    Edges within 5 us are one change. Pin 9 is used by gauges alone, and high when the second one is at its first state.
    """
    pins, begun = range(2 + 4 * gauge, 6 + 4 * gauge), of_pin(edges, 9)["cycle"][0] + TOGETHER_CYCLES
    pattern, changes = 0, [(int(begun), 0)]
    for edge in edges[np.isin(edges["pin"], pins)]:
        bit = 1 << int(edge["pin"]) - pins[0]
        pattern = pattern | bit if edge["value"] else pattern & ~bit
        if edge["cycle"] - changes[-1][0] < TOGETHER_CYCLES:
            changes[-1] = changes[-1][0], pattern
        else:
            changes.append((int(edge["cycle"]), pattern))
    return changes


def travel_of(changes: list[tuple[int, int]]) -> list[int]:
    """Return the steps, 1 or -1 each, from the first state that a gauge took; each must be to the next state."""
    states = [COILS.index(pattern) for _, pattern in changes]
    steps = [(after - before) % 6 for before, after in pairwise(states)]
    assert set(steps) <= {1, 5}
    return [1 if step == 1 else -1 for step in steps]


@pytest.mark.parametrize("gauges", [1, 3])
def test_gauges_step_through_their_six_states(simulated_controller: Make, gauges: int) -> None:
    steps = (200, -151, 77)[:gauges]
    played = play(simulated_controller, GAUGE.image(gauges), move_by(*steps), settings=GAUGES)
    for gauge, count in enumerate(steps):
        changes = coils_of(played.edges, gauge)
        assert travel_of(changes) == [1 if count > 0 else -1] * abs(count)
        times = np.array([cycle for cycle, _ in changes[1:]])
        assert lateness_us(times, GAUGE.intervals(abs(count)), 8).max() <= GAUGE_LATE_US
        assert played.statuses[gauge].position == count


def test_zero_drives_a_gauge_against_its_stop(simulated_controller: Make) -> None:
    """945 steps back, wherever it is; then it is at 0."""
    zero = request(ZERO, b"\1" + (945).to_bytes(2, "little"))
    played = play(simulated_controller, GAUGE.image(), move_by(30), zero, move_by(10), settings=GAUGES)
    travel = travel_of(coils_of(played.edges, 0))
    assert travel == [1] * 30 + [-1] * 945 + [1] * 10
    assert played.statuses[0].position == 10


def test_gauges_leave_step_pins_alone_before(simulated_controller: Make) -> None:
    """Until gauges are set no pin of theirs has more than its resting level."""
    played = play(simulated_controller, GAUGE.image(), request(STATUS, b"\0"))
    assert not np.isin(played.edges["pin"], STEP_PINS).any()
    assert set(played.edges["pin"].tolist()) <= {*DIRECTION_PINS, ENABLE_PIN}
