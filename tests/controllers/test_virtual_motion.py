"""The virtual motors against the rule of docs/serial_protocol.md, played a step at a time by a program of its own."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from designs import design
from stepramp.controllers.stepramp.messages.status import AxisState
from stepramp.controllers.virtual.motor_state import state_of
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.move import play
from stepramp.ramp.on_chip import on_chip_ramp
from stepramp.ramp.playback.formula import FormulaPlayback
from stepramp.ramp.playback.lists import ListPlayback
from stepramp.ramp.playback.motor import InstantsOf, Motor
from stepramp.ramp.playback.trajectory import pulse_instants

SETUP_TICKS = 7
FAR = 2**31 - 1


def falling(longest: int) -> st.SearchStrategy:
    side = st.lists(st.integers(6, longest), max_size=12, unique=True)
    return side.map(lambda intervals: np.array(sorted(intervals, reverse=True), np.int64))


RAMPS = st.builds(Ramp, falling(40), st.integers(2, 5), falling(40))


class SteppedMotor:
    """The rule, an interval at a time; lists fall strictly. Instants are told as (instant, position)."""

    def __init__(self, ramp: Ramp) -> None:
        self.up, self.down = [int(each) for each in ramp.up], [int(each) for each in ramp.down]
        self.slew = int(ramp.slew)
        self.position = self.due = 0
        self.interval = self.direction = 0
        self.target, self.level, self.stops = 0, self.slew, False
        self.falls = False
        """The present interval is one of the ramp down."""

    def longer(self, interval: int) -> int:
        return sum(each > interval for each in self.down)

    def next_interval(self, left: int) -> int:
        """Return the interval that follows the present one, with so many steps left; 0: at rest."""
        needed = self.longer(self.interval) if self.interval else 0
        falls, self.falls = self.falls, True
        if self.stops or left < needed or not left:
            return self.down[needed - 1] if needed else 0
        if falls and left == needed:
            return self.down[left - 1]
        if self.interval and self.interval < self.level and needed and self.down[needed - 1] <= self.level:
            return self.down[needed - 1]
        self.falls = False
        present = self.level if 0 < self.interval < self.level else self.interval
        for each in self.up:
            if (not present or each < present or (falls and each == present)) and each >= self.level:
                self.falls = left < 1 + self.longer(each)
                return self.down[left - 1] if self.falls else each
        steps_down = len(self.down) if self.level == self.slew else self.longer(self.level)
        self.falls = left <= steps_down
        return self.down[left - 1] if self.falls else self.level

    def play(self, until: int) -> list[tuple[int, int]]:
        """Return the pulses up to an instant."""
        pulses = []
        while self.due <= until:
            if not self.interval:
                if self.stops or self.target == self.position:
                    return pulses
                self.direction = 1 if self.target > self.position else -1
                self.falls = False
            left = max(0, (self.target - self.position) * self.direction)
            self.interval = self.next_interval(left)
            if self.interval:
                self.position += self.direction
                pulses.append((self.due, self.position))
                self.due += self.interval
            elif self.stops:
                self.target, self.stops = self.position, False
            elif self.target != self.position:
                self.due += SETUP_TICKS
        return pulses


class Pulses:
    """Notes the pulses of a motor."""

    def __init__(self) -> None:
        self.instants: list[int] = []
        self.told: list[str] = []

    def set_out(self) -> None:
        self.told.append("out")

    def pulses(self, first: int, count: int, instants_of: InstantsOf) -> None:
        self.instants += instants_of(np.arange(first, first + count)).tolist()

    def at_rest(self) -> None:
        self.told.append("rest")


@given(RAMPS, st.integers(1, 60))
def test_a_course_from_rest_is_the_move_of_the_ramp(ramp: Ramp, steps: int) -> None:
    playback = ListPlayback(ramp)
    trajectory = playback.trajectory(playback.rest, steps)
    intervals = [int(each) for each in play(ramp, steps)]
    played = [each for train in trajectory for each in np.resize(train.intervals, train.count).tolist()]
    assert played == intervals
    instants = pulse_instants(trajectory, np.arange(1, steps + 3))
    assert instants.tolist() == [*np.cumsum([0, *intervals]).tolist(), sum(intervals)]


@given(st.lists(st.integers(5, 9), max_size=20), st.lists(st.integers(5, 9), max_size=20), st.integers(1, 50))
def test_it_is_so_with_intervals_in_any_order(up: list[int], down: list[int], steps: int) -> None:
    ramp = Ramp(np.array(up, np.int64), 6, np.array(down, np.int64))
    playback = ListPlayback(ramp)
    trajectory = playback.trajectory(playback.rest, steps)
    played = [each for train in trajectory for each in np.resize(train.intervals, train.count).tolist()]
    assert played == [int(each) for each in play(ramp, steps)]


ORDERS = st.one_of(
    st.tuples(st.just("to"), st.integers(-80, 80)),
    st.tuples(st.just("run"), st.sampled_from([-45, -20, -9, -5, 5, 9, 20, 45])),
    st.tuples(st.just("stop"), st.just(0)),
)


@given(RAMPS, st.lists(st.tuples(st.integers(0, 300), ORDERS), min_size=1, max_size=6))
@settings(max_examples=400)
def test_orders_in_flight(ramp: Ramp, orders: list[tuple[int, tuple[str, int]]]) -> None:
    pulses, stepped = Pulses(), SteppedMotor(ramp)
    motor = Motor(ListPlayback(ramp), SETUP_TICKS, watch=pulses)
    expected: list[tuple[int, int]] = []
    now = 0
    for wait, (what, value) in orders:
        now += wait
        motor.settle(now)
        expected += stepped.play(now)
        if not motor.moving:
            stepped.due = now
        if what == "stop":
            motor.stop()
            stepped.stops = stepped.stops or bool(stepped.interval)
            if not stepped.interval:
                stepped.target = stepped.position
        elif what == "to":
            motor.move_to(value, now)
            stepped.target, stepped.level, stepped.stops = value, stepped.slew, False
        else:
            motor.run(abs(value), 1 if value > 0 else -1, now)
            stepped.target, stepped.level, stepped.stops = FAR if value > 0 else -FAR - 1, abs(value), False
        motor.settle(now)
        expected += stepped.play(now)
    motor.stop()
    target = motor.target
    stepped.stops = bool(stepped.interval)
    if not stepped.interval:
        stepped.target = stepped.position
    motor.settle(now + 10_000)
    expected += stepped.play(now + 10_000)
    assert pulses.instants == [instant for instant, _ in expected]
    assert motor.position == stepped.position == motor.target == target
    assert state_of(motor) is AxisState.IDLE
    assert pulses.told[:2] in ([], ["out", "rest"])


@given(RAMPS, st.integers(-60, 60), st.lists(st.integers(0, 100), max_size=20))
def test_a_motor_is_where_its_pulses_have_brought_it(ramp: Ramp, steps: int, waits: list[int]) -> None:
    motor, stepped = Motor(ListPlayback(ramp), SETUP_TICKS), SteppedMotor(ramp)
    motor.move_to(steps, 0)
    stepped.target = steps
    for now in np.cumsum([0, *waits]).tolist():
        motor.settle(now)
        stepped.play(now)
        assert (motor.position, motor.interval) == (stepped.position, stepped.interval)
        assert motor.steps_made == abs(motor.position)
        assert motor.target == steps


def test_a_move_of_two_thousand_million_steps_takes_no_memory() -> None:
    motor = Motor(ListPlayback(Ramp(np.array([9, 5]), 2, np.array([9, 5]))), SETUP_TICKS)
    motor.move_to(2**31 - 1, 0)
    motor.settle(14 + 2 * 10**9)
    assert motor.position == 2 + 10**9 + 1


@pytest.mark.parametrize("direction", [1, -1])
def test_a_halted_motor_counts_each_pulse(direction: int) -> None:
    motor = Motor(ListPlayback(Ramp(np.array([10]), 5, np.array([10]))), SETUP_TICKS, position=100)
    motor.move_to(100 + 4 * direction, 0)
    motor.settle(10)
    assert (motor.position, motor.target, motor.interval) == (100 + 2 * direction, 100 + 4 * direction, 5)
    motor.halt()
    assert (motor.position, motor.target, motor.moving) == (100 + 2 * direction, 100 + 2 * direction, False)
    motor.move_to(100, 50)
    motor.settle(1000)
    assert (motor.position, motor.moving, motor.steps_made) == (100, False, 2)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_run_goes_on_past_the_last_position(direction: int) -> None:
    last = FAR if direction > 0 else -FAR - 1
    motor = Motor(ListPlayback(Ramp(np.array([10, 8]), 5, np.array([10, 8]))), SETUP_TICKS, last)
    motor.run(5, direction, 0)
    motor.settle(17)
    assert (motor.position, motor.interval) == (last + direction * (2 - 2**32), 8)
    motor.settle(18 + 5 * 10**10)
    assert motor.moving
    assert (motor.position - last - direction * (3 + 10**10)) % 2**32 == 0
    motor.stop()
    target = motor.target
    motor.settle(10**11)
    assert (motor.moving, motor.position) == (False, target)


def test_a_run_tells_its_position_as_target_and_a_stop_where_it_ends() -> None:
    motor = Motor(ListPlayback(Ramp(np.array([10, 8]), 5, np.array([10, 8]))), SETUP_TICKS)
    motor.run(5, 1, 0)
    motor.settle(100)
    assert motor.target == motor.position
    motor.stop()
    assert (state_of(motor), motor.target) == (AxisState.STOPPING, motor.position + 2)


@pytest.mark.parametrize("method", ["first_order", "compromise", "newton"])
@pytest.mark.parametrize("deceleration", [None, 2500, 9000])
class TestByFormula:
    def playback(self, method: str, deceleration: float | None) -> FormulaPlayback:
        wanted = design(method__name=method, method__arithmetic="fixed", ramp__deceleration_steps_per_s2=deceleration)
        self.ramp = on_chip_ramp(wanted)
        return FormulaPlayback(self.ramp)

    def test_a_course_from_rest_is_the_move_of_the_ramp(self, method: str, deceleration: float | None) -> None:
        playback = self.playback(method, deceleration)
        for steps in (1, 2, 3, 10, 101, 300, 301, 1000):
            trajectory = playback.trajectory(playback.rest, steps)
            played = [each for train in trajectory for each in np.resize(train.intervals, train.count).tolist()]
            assert played == self.ramp.move(steps).tolist()

    @pytest.mark.parametrize("at_ticks", [1, 30_000, 200_000, 400_000, 700_000])
    @pytest.mark.parametrize("target", [-30, 0, 40, 180, 900])
    def test_targets_in_flight_are_reached(
        self, method: str, deceleration: float | None, at_ticks: int, target: int
    ) -> None:
        playback = self.playback(method, deceleration)
        pulses = Pulses()
        motor = Motor(playback, SETUP_TICKS, watch=pulses)
        motor.move_to(400, 0)
        motor.settle(at_ticks)
        motor.move_to(target, at_ticks)
        motor.settle(10**8)
        assert (motor.position, motor.moving) == (target, False)
        assert np.diff(pulses.instants).min() >= playback.slew_interval

    def test_a_run_keeps_to_its_speed(self, method: str, deceleration: float | None) -> None:
        motor = Motor(self.playback(method, deceleration), SETUP_TICKS)
        for interval, until in ((5000, 10**6), (2000, 2 * 10**6), (9000, 3 * 10**6), (3000, 4 * 10**6)):
            motor.run(interval, 1, until - 10**6)
            motor.settle(until)
            assert motor.interval == interval
        motor.stop()
        target = motor.target
        motor.settle(10**7)
        assert (motor.moving, motor.position) == (False, target)
