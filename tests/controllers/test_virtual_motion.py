import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.virtual_motion import Motion, VirtualMotor
from stepramp.ramp.move import Ramp, play

HZ = 1000
SIDES = st.lists(st.integers(5, 40), max_size=12).map(lambda side: np.array(sorted(side, reverse=True), np.int64))
RAMPS = st.builds(Ramp, SIDES, st.integers(2, 5), SIDES)


def motion_by_step(intervals: list[int], ticks: int) -> tuple[int, int]:
    """Return pulses made and the present interval, found a step at a time."""
    passed = 0
    for index, interval in enumerate(intervals):
        passed += interval
        if ticks < passed:
            return index + 1, interval
    return len(intervals), 0


@given(RAMPS, st.integers(1, 60), st.integers(0, 1500))
def test_a_motion_is_where_its_intervals_say(ramp: Ramp, steps: int, ticks: int) -> None:
    motion = Motion.of(ramp, steps)
    intervals = [int(interval) for interval in play(ramp, steps)]
    assert motion.steps == steps
    assert motion.duration_ticks == sum(intervals)
    assert (motion.pulses(ticks), motion.interval(ticks)) == motion_by_step(intervals, ticks)


def stopped_intervals(ramp: Ramp, steps: int, ticks: int) -> list[int]:
    """Return the intervals of a move that is stopped, by the words of the protocol's text."""
    intervals = [int(interval) for interval in play(ramp, steps)]
    whole = Motion.of(ramp, steps)
    pulses, present = motion_by_step(intervals, ticks)
    if pulses > whole.head.size + whole.slew_steps or not present:
        return intervals
    down = [int(interval) for interval in ramp.down]
    if pulses <= whole.head.size:
        down = down[: next((index for index, interval in enumerate(down) if interval <= present), len(down))]
    return [*intervals[:pulses], *reversed(down)]


@given(RAMPS, st.integers(1, 60), st.integers(0, 1500))
def test_a_stop_follows_the_way_down_and_never_passes_the_target(ramp: Ramp, steps: int, ticks: int) -> None:
    stopped = Motion.of(ramp, steps).stopped(ticks, ramp)
    slewed = [stopped.slew_interval] * stopped.slew_steps
    assert [*stopped.head, *slewed, *stopped.tail] == stopped_intervals(ramp, steps, ticks)
    assert stopped.steps <= steps


def test_a_move_of_two_thousand_million_steps_takes_no_memory() -> None:
    ramp = Ramp(np.array([9, 5]), 2, np.array([9, 5]))
    motion = Motion.of(ramp, 2**31)
    assert motion.slew_steps == 2**31 - 4
    assert motion.pulses(14 + 2 * 10**9) == 2 + 10**9 + 1


@pytest.mark.parametrize("direction", [1, -1])
def test_a_motor_counts_each_pulse(direction: int) -> None:
    now = [0.0]
    motor = VirtualMotor(lambda: now[0], HZ)
    ramp = Ramp(np.array([10]), 5, np.array([10]))
    motor.move(ramp, 4 * direction)
    assert (motor.position, motor.target, motor.interval_ticks) == (direction, 4 * direction, 10)
    now[0] = 0.0101
    motor.settle()
    assert (motor.position, motor.interval_ticks) == (2 * direction, 5)
    motor.halt()
    assert (motor.position, motor.target, motor.moving) == (2 * direction, 2 * direction, False)
    motor.move(ramp, -2 * direction)
    now[0] = 10.0
    motor.settle()
    assert (motor.position, motor.moving, motor.steps_made) == (0, False, 2)
