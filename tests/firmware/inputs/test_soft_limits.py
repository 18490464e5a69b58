"""Soft limits: what leads beyond is refused, and a run ends at them with its ramp, while the position is known."""

import random
import struct

import pytest

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT
from firmware.controller.ramps import FOUR_AXES, OTHER, RAMP
from firmware.controller_host import Driver
from firmware.inputs.machine import LOW_INPUT, Machine
from firmware.inputs.test_homing import FAST, home
from firmware.protocol import InputSettings, for_axes, values_of

LOW, HIGH = 0xFE, 0xFF
"""In place of an input's number."""
NO_LIMITS = (-(2**31), 2**31 - 1)


def limit(machine: Machine, lowest: int = NO_LIMITS[0], highest: int = NO_LIMITS[1], axis: int = 0) -> None:
    machine.ok(p.WRITE_LIMITS, struct.pack("<Bii", axis, lowest, highest))


def limits(machine: Machine, axis: int = 0) -> tuple[int, int]:
    low, high = struct.unpack("<ii", machine.ok(p.READ_LIMITS, bytes([axis])))
    return low, high


@pytest.fixture
def known(machine: Machine) -> Machine:
    """A machine whose axis may go from -100 to 500, and is at 0, which is known."""
    limit(machine, -100, 500)
    machine.ok(p.SET_POSITION, for_axes({0: 0}))
    return machine


def test_there_are_none_unless_they_are_said(machine: Machine) -> None:
    assert [limits(machine, axis) for axis in range(4)] == [NO_LIMITS] * 4
    limit(machine, -7, 7, axis=2)
    assert [limits(machine, axis) for axis in range(4)] == [NO_LIMITS, NO_LIMITS, (-7, 7), NO_LIMITS]
    limit(machine, axis=2)
    assert limits(machine, 2) == NO_LIMITS


def test_senseless_ones_are_refused(machine: Machine) -> None:
    assert machine.refused(p.WRITE_LIMITS, struct.pack("<Bii", 3, 8, 7)) == (p.OUT_OF_RANGE, 3)
    assert machine.refused(p.WRITE_LIMITS, struct.pack("<Bii", 4, 7, 8)) == (p.OUT_OF_RANGE, 4)
    assert machine.refused(p.READ_LIMITS, b"\4") == (p.OUT_OF_RANGE, 4)
    assert machine.refused(p.WRITE_LIMITS, bytes(8)) == (p.BAD_LENGTH, 8)
    machine.ok(p.MOVE_BY, for_axes({0: 100}))
    assert machine.refused(p.WRITE_LIMITS, struct.pack("<Bii", 0, 7, 8)) == (p.MOVING, 0)


@pytest.mark.parametrize(
    ("kind", "body", "end"),
    [
        (p.MOVE_TO, for_axes({0: 501}), HIGH),
        (p.MOVE_TO, for_axes({0: -101}), LOW),
        (p.MOVE_BY, for_axes({0: 501}), HIGH),
        (p.LINE, bytes([1, 0]) + values_of({0: -101}), LOW),
        (p.LINE, bytes([1, 0]) + values_of({0: 501}), HIGH),
    ],
)
def test_what_ends_beyond_is_refused_before_anything_moves(known: Machine, kind: int, body: bytes, end: int) -> None:
    assert known.refused(kind, body) == (p.AT_LIMIT, end << 8)
    known.pass_ms(50)
    assert known.steps()[0] == 0
    assert known.status().state == p.IDLE


def test_one_axis_beyond_keeps_the_others(known: Machine) -> None:
    known.push(FOUR_AXES)
    known.ok(p.SET_POSITION, for_axes({0: 0, 1: 0, 2: 0}))
    limit(known, 0, 10, axis=2)
    everywhere = {0: 400, 1: 400, 2: 11}
    assert known.refused(p.MOVE_TO, for_axes(everywhere)) == (p.AT_LIMIT, HIGH << 8 | 2)
    assert known.refused(p.LINE, bytes([7, 0]) + values_of(everywhere)) == (p.AT_LIMIT, HIGH << 8 | 2)
    known.pass_ms(50)
    assert known.steps()[:3] == [0, 0, 0]
    known.ok(p.LINE, bytes([7, 0]) + values_of({0: 400, 1: 400, 2: 10}))
    known.go_to_rest()
    assert known.steps()[:3] == [400, 400, 10]


def test_the_limits_themselves_may_be_reached(known: Machine) -> None:
    for end in (500, -100):
        known.ok(p.MOVE_TO, for_axes({0: end}))
        assert known.go_to_rest().position == end


@pytest.mark.parametrize("interval", [2000, 2001, 3000, 12_345, 200_000])
@pytest.mark.parametrize(("direction", "end"), [(1, 500), (-1, -100)])
def test_a_run_ends_at_them_with_its_ramp(known: Machine, interval: int, direction: int, end: int) -> None:
    known.ok(p.RUN, for_axes({0: direction * interval}))
    status = known.go_to_rest()
    assert (status.position, status.target, known.steps()[0]) == (end, end, end)
    assert known.inputs().known & 1
    refusal = (p.AT_LIMIT, (HIGH if end > 0 else LOW) << 8)
    assert known.refused(p.RUN, for_axes({0: direction * interval})) == refusal
    known.ok(p.RUN, for_axes({0: -direction * 3000}))
    assert known.go_to_rest().position == {500: -100, -100: 500}[end]


def test_without_a_limit_on_that_side_it_goes_on(known: Machine) -> None:
    limit(known, lowest=-100)
    known.ok(p.RUN, for_axes({0: 3000}))
    known.go_on_ms(2000)
    assert known.steps()[0] > 1000
    known.ok(p.RUN, for_axes({0: -3000}))
    assert known.go_to_rest().position == -100


def test_a_run_ends_in_silence_all_the_same(known: Machine) -> None:
    limit(known, -100, 2_000_000)
    known.ok(p.RUN, for_axes({0: 20_000}))
    known.pass_ms(3000)
    assert known.status().state == p.IDLE
    assert 0 < known.steps()[0] < 2500


def test_a_run_tells_its_position_as_its_target(known: Machine) -> None:
    known.ok(p.RUN, for_axes({0: 20_000}))
    known.pass_ms(100)
    status = known.status()
    assert status.position == status.target > 0
    # From where it is, not from where it would end.
    (target,) = struct.unpack("<i", known.ok(p.MOVE_BY, for_axes({0: 30})))
    assert 30 < target < 300
    assert known.go_to_rest().position == target


def test_in_flight_nothing_comes_beyond(known: Machine) -> None:
    """Runs, moves and stops in any order, at any moment."""
    known.push(OTHER)
    known.ok(p.SET_POSITION, for_axes({0: 0}))
    rng = random.Random(5)
    reached = set()
    for _ in range(400):
        kind = rng.choice([p.RUN, p.RUN, p.RUN, p.MOVE_TO, p.MOVE_BY, p.STOP])
        interval = rng.choice([3000, 3000, 3500, 5000, 20_000]) * rng.choice([1, -1])
        value = interval if kind == p.RUN else rng.randint(-150, 550) if kind == p.MOVE_TO else rng.randint(-300, 300)
        reply = known.send(kind, bytes([1]) if kind == p.STOP else for_axes({0: value}))
        assert reply[0] in (p.OK, p.AT_LIMIT)
        for _ in range(rng.randint(1, 12)):
            known.pass_ms(rng.randint(1, 20))
            assert -100 <= known.steps()[0] <= 500
        reached.add(known.steps()[0])
    assert {-100, 500} <= reached


def test_they_hold_only_where_the_position_is_known(machine: Machine) -> None:
    limit(machine, -100, 500)
    machine.ok(p.MOVE_TO, for_axes({0: 700}))
    assert machine.go_to_rest().position == 700
    machine.ok(p.SET_POSITION, for_axes({0: 700}))
    # Beyond them the way back is free, and no other.
    assert machine.refused(p.MOVE_TO, for_axes({0: 699})) == (p.AT_LIMIT, HIGH << 8)
    assert machine.refused(p.RUN, for_axes({0: 3000})) == (p.AT_LIMIT, HIGH << 8)
    machine.ok(p.RUN, for_axes({0: -3000}))
    assert machine.go_to_rest().position == -100


def test_homing_and_zeroing_go_wherever_the_switch_or_stop_is(known: Machine) -> None:
    known.give(InputSettings(roles={LOW_INPUT: p.LOW_LIMIT}))
    known.add_switch(LOW_INPUT, 0, -300, is_backward=True)
    known.ok(p.HOME, home({0: -FAST}))
    known.go_to_rest()
    assert known.inputs().known & 1
    assert known.refused(p.MOVE_TO, for_axes({0: 501})) == (p.AT_LIMIT, HIGH << 8)
    known.ok(p.MOVE_TO, for_axes({0: 200}))
    known.go_to_rest()
    # Refused, it stays known where it is.
    assert known.refused(p.HOME, home({0: FAST})) == (p.OUT_OF_RANGE, 0)
    assert known.inputs().known & 1
    limit(known, 5, 500)
    known.ok(p.ZERO, bytes([1, 50, 0]))
    assert known.go_to_rest().position == 0
    assert known.inputs().known & 1


def test_while_it_is_zeroed_a_position_is_not_known(known: Machine) -> None:
    known.ok(p.ZERO, bytes([1, 100, 0]))
    known.pass_ms(20)
    assert known.inputs().known & 1 == 0
    known.go_to_rest()
    assert (known.status().position, known.inputs().known & 1) == (0, 1)


@pytest.mark.parametrize(
    ("kind", "body"),
    [
        (p.STOP, b""),
        (p.HALT, b""),
        (p.MOVE_TO, for_axes({0: 3100})),
        (p.MOVE_BY, for_axes({0: 700})),
        (p.RUN, for_axes({0: 3000})),
    ],
)
def test_what_keeps_a_zeroing_from_its_end_leaves_it_unknown(known: Machine, kind: int, body: bytes) -> None:
    known.ok(p.ZERO, struct.pack("<BH", 1, 3000))
    known.pass_ms(100)
    known.ok(kind, body)
    known.pass_ms(100)
    known.ok(p.STOP)
    assert known.go_to_rest().position > 1000
    assert known.inputs().known & 1 == 0


def test_they_are_kept_and_rolled_back(driver: Driver, known: Machine) -> None:
    known.ok(p.COMMIT)
    known.run(WHOLE_COMMIT)
    limit(known, -1, 1)
    assert known.status().flags & p.ON_TRIAL
    # A delivery that is dropped takes nothing of them away.
    known.deliver(OTHER.image())
    known.ok(p.SET_POSITION, for_axes({0: 0}))
    assert known.read() == RAMP.image()
    assert limits(known) == (-1, 1)
    known.ok(p.ROLL_BACK)
    assert limits(known) == (-100, 500)
    driver.ask("begin")
    again = Machine(driver)
    again.ok(p.HELLO, b"\3")
    assert limits(again) == (-100, 500)
    again.ok(p.ROLL_BACK)
    again.run(WHOLE_COMMIT)
    assert limits(again) == NO_LIMITS
