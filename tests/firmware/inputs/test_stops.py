"""An emergency stop, a driver's fault and limit switches stop motors, and keep them from setting out."""

import pytest

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT
from firmware.inputs.machine import (
    FAULT_INPUT,
    FOUR_AXES,
    HIGH_INPUT,
    LOW_INPUT,
    ROLES,
    STOP_INPUT,
    Machine,
)
from firmware.protocol import InputSettings, Settings, for_axes, values_of

MOTIONS = [
    (p.MOVE_BY, for_axes({0: 100})),
    (p.MOVE_TO, for_axes({0: 5000})),
    (p.RUN, for_axes({0: 3000})),
    (p.LINE, bytes([1, 0]) + values_of({0: 100})),
    (p.ZERO, bytes([1, 50, 0])),
    (p.HOME, bytes([1]) + (20_000).to_bytes(4, "little") + bytes([5, 0]) + values_of({0: -3000})),
]
WHILE_SETTLING_MS = 4 + 3
ROLES_AT = 15
"""Among the packed settings."""


@pytest.mark.parametrize(("number", "cause"), [(STOP_INPUT, p.BY_EMERGENCY_STOP), (FAULT_INPUT, p.BY_DRIVER_FAULT)])
def test_it_stops_all_until_it_is_released_and_acknowledged(machine: Machine, number: int, cause: int) -> None:
    machine.ok(p.RUN, for_axes({0: 3000}))
    machine.pass_ms(300)
    machine.pull_down(number)
    machine.pass_ms(WHILE_SETTLING_MS)
    there = machine.steps()
    assert there[0] > 50
    machine.go_on_ms(400)
    assert machine.steps() == there
    status = machine.inputs()
    assert (status.active, status.stopped_by, status.known & 1) == (1 << number, cause, 0)
    assert machine.status().position == there[0]
    for kind, body in MOTIONS:
        assert machine.refused(kind, body) == (p.STOPPED, 1 << number), hex(kind)
    assert machine.refused(p.ACKNOWLEDGE) == (p.STOPPED, 1 << number)
    machine.pull_down()
    machine.pass_ms(WHILE_SETTLING_MS)
    assert machine.inputs().stopped_by == cause
    for kind, body in MOTIONS:
        assert machine.refused(kind, body) == (p.STOPPED, 0), hex(kind)
    for kind, body in ((p.MOVE_TO, for_axes({0: there[0]})), (p.MOVE_BY, for_axes({0: 0})), (p.RUN, for_axes({0: 0}))):
        assert machine.refused(kind, body) == (p.STOPPED, 0), "nor where it is"
    machine.ok(p.ACKNOWLEDGE)
    assert machine.inputs().stopped_by == 0
    machine.ok(p.MOVE_BY, for_axes({0: 10}))
    machine.go_to_rest()
    assert machine.steps()[0] == there[0] + 10


def test_an_emergency_stop_is_final_however_short_it_is(machine: Machine) -> None:
    machine.ok(p.RUN, for_axes({0: 3000}))
    machine.pass_ms(300)
    machine.pull_down(STOP_INPUT)
    machine.pull_down()
    there = machine.steps()
    machine.go_on_ms(400)
    assert machine.steps() == there
    assert machine.inputs().stopped_by == p.BY_EMERGENCY_STOP
    assert machine.refused(p.MOVE_BY, for_axes({0: 1})) == (p.STOPPED, 0)


def test_an_emergency_stop_that_is_there_from_the_beginning_is_seen(machine: Machine) -> None:
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    machine.driver.ask("begin")
    machine.pull_down(STOP_INPUT)
    machine.ok(p.HELLO, b"\3")
    machine.pass_ms(WHILE_SETTLING_MS)
    assert machine.inputs().stopped_by == p.BY_EMERGENCY_STOP


@pytest.mark.parametrize(
    ("role", "pulled_down"),
    [(p.EMERGENCY_STOP | p.ACTIVE_HIGH, ()), (p.EMERGENCY_STOP, (3,)), (p.EMERGENCY_STOP, (3, 6))],
)
def test_no_input_becomes_an_emergency_stop_that_is_active_already(
    machine: Machine, role: int, pulled_down: tuple[int, ...]
) -> None:
    """By a wrong level it could never be released, and no software may take its role away."""
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    machine.pull_down(*pulled_down)
    machine.pass_ms(20)
    before = machine.ok(p.READ_SETTINGS)
    packed = Settings(enable_lead_ms=9).packed() + InputSettings(looks=2, roles={**ROLES, 3: role}).packed()
    assert machine.refused(p.WRITE_SETTINGS, packed) == (p.OUT_OF_RANGE, ROLES_AT + 3)
    machine.pass_ms(20)
    assert machine.ok(p.READ_SETTINGS) == before
    assert machine.inputs().stopped_by == 0
    assert machine.status().flags & p.ON_TRIAL == 0
    machine.ok(p.MOVE_BY, for_axes({0: 10}))
    machine.go_to_rest()
    # Of the other level, or once it is released, it may become one.
    machine.pull_down()
    machine.pass_ms(20)
    machine.give(InputSettings(roles={**ROLES, 3: p.EMERGENCY_STOP}))
    machine.pass_ms(20)
    assert machine.inputs().stopped_by == 0


@pytest.mark.parametrize("looks", [1, 4, 10])
def test_the_next_request_goes_by_the_new_role_of_what_is_active(machine: Machine, looks: int) -> None:
    machine.give(InputSettings(looks=looks, roles={}))
    machine.pull_down(LOW_INPUT)
    machine.pass_ms(20)
    machine.ok(p.MOVE_BY, for_axes({0: -10}))
    machine.go_to_rest()
    there = machine.steps()
    machine.give(InputSettings(looks=looks, roles={LOW_INPUT: p.LOW_LIMIT}))
    assert machine.refused(p.MOVE_BY, for_axes({0: -10})) == (p.AT_LIMIT, LOW_INPUT << 8)
    machine.go_on_ms(100)
    assert machine.steps() == there
    # Without its role it is free at once, too.
    machine.give(InputSettings(looks=looks, roles={}))
    machine.ok(p.MOVE_BY, for_axes({0: -10}))
    machine.go_to_rest()


def test_all_but_its_level_may_be_set_of_what_has_been_an_emergency_stop(machine: Machine) -> None:
    machine.give(InputSettings(looks=7, roles=ROLES))
    machine.pull_down(FAULT_INPUT)
    machine.pass_ms(20)
    # A driver's fault hinders nobody from setting what it is: its role may be taken away.
    machine.give(InputSettings(roles={STOP_INPUT: p.EMERGENCY_STOP}))
    assert machine.inputs().stopped_by == p.BY_DRIVER_FAULT
    machine.give()
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)


def test_nothing_is_stored_in_an_emergency(machine: Machine) -> None:
    machine.give(InputSettings(looks=7, roles=ROLES))
    machine.pull_down(STOP_INPUT)
    machine.pass_ms(20)
    assert machine.refused(p.COMMIT) == (p.STOPPED, 1 << STOP_INPUT)
    machine.pull_down()
    machine.pass_ms(20)
    assert machine.refused(p.COMMIT) == (p.STOPPED, 0)
    machine.ok(p.ACKNOWLEDGE)
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    assert machine.status().flags & p.ON_TRIAL == 0


def test_between_a_request_and_its_start_it_stops_as_well(machine: Machine) -> None:
    """A motion that waits for its start, at each moment of the first milliseconds."""
    for rounds in range(1, 60):
        machine.pull_down()
        machine.pass_ms(WHILE_SETTLING_MS)
        machine.ok(p.ACKNOWLEDGE)
        before = machine.steps()[0]
        machine.ok(p.MOVE_BY, for_axes({0: 40}))
        machine.run(rounds)
        machine.pull_down(STOP_INPUT)
        there = machine.steps()[0]
        machine.pass_ms(100)
        assert machine.steps()[0] == there, rounds
        assert machine.status().position == there
        assert before <= there < before + 40


def test_settings_forget_no_emergency_stop(machine: Machine) -> None:
    machine.pull_down(STOP_INPUT)
    machine.pull_down()
    machine.pass_ms(20)
    packed = Settings(enable_lead_ms=9).packed()
    for pressed in ((), (STOP_INPUT,)):
        machine.pull_down(*pressed)
        machine.pass_ms(20)
        refusal = (p.STOPPED, sum(1 << each for each in pressed))
        assert machine.refused(p.WRITE_SETTINGS, packed + InputSettings().packed()) == refusal
        assert machine.refused(p.ROLL_BACK) == refusal
    # All else may be set.
    machine.ok(p.WRITE_SETTINGS, packed)
    machine.give(outputs=Settings(enable_lead_ms=3))
    assert machine.refused(p.ACKNOWLEDGE) == (p.STOPPED, 1 << STOP_INPUT)
    assert machine.refused(p.MOVE_BY, for_axes({0: 1}))[0] == p.STOPPED
    machine.pull_down()
    machine.pass_ms(20)
    machine.ok(p.ACKNOWLEDGE)
    machine.give(InputSettings())


@pytest.mark.parametrize("after_rounds", [1, 20, 40])
def test_what_is_rolled_back_to_waits_until_it_is_over(machine: Machine, after_rounds: int) -> None:
    """Pressed while that is being written: its input stays one until it is released."""
    machine.give(InputSettings())
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    machine.give()
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    machine.ok(p.ROLL_BACK)
    machine.run(after_rounds)
    machine.pull_down(STOP_INPUT)
    machine.run(WHOLE_COMMIT)
    assert machine.inputs().stopped_by == p.BY_EMERGENCY_STOP
    assert machine.refused(p.ACKNOWLEDGE) == (p.STOPPED, 1 << STOP_INPUT)
    assert machine.refused(p.MOVE_BY, for_axes({0: 1})) == (p.BUSY, 0)
    machine.pull_down()
    machine.run(WHOLE_COMMIT)
    machine.ok(p.ACKNOWLEDGE)
    machine.run(WHOLE_COMMIT)
    machine.pull_down(STOP_INPUT)
    machine.pass_ms(20)
    assert machine.inputs().stopped_by == 0
    machine.ok(p.MOVE_BY, for_axes({0: 10}))
    machine.go_to_rest()
    assert machine.steps()[0] == 10


def test_a_fault_has_to_last_for_as_many_looks_as_set(machine: Machine) -> None:
    for looks in (1, 4, 10):
        machine.give(InputSettings(looks=looks, roles=ROLES))
        machine.pass_ms(20)
        machine.pull_down(FAULT_INPUT)
        machine.pass_ms(looks - 1)
        machine.pull_down()
        machine.pass_ms(20)
        assert machine.inputs().stopped_by == 0
        machine.pull_down(FAULT_INPUT)
        machine.pass_ms(looks + 2)
        machine.pull_down()
        machine.pass_ms(20)
        assert machine.inputs().stopped_by == p.BY_DRIVER_FAULT
        machine.ok(p.ACKNOWLEDGE)


def test_one_that_comes_while_another_cause_is_acknowledged_is_told(machine: Machine) -> None:
    machine.ok(p.RUN, for_axes({0: 3000}))
    machine.pass_ms(300)
    machine.driver.ask("tap")
    there = machine.steps()[0]
    machine.pass_ms(WHILE_SETTLING_MS)
    assert machine.inputs().stopped_by == p.BY_EMERGENCY_STOP
    assert (machine.status().state, machine.steps()[0]) == (p.IDLE, there)
    machine.ok(p.ACKNOWLEDGE)
    machine.ok(p.MOVE_BY, for_axes({0: 10}))
    machine.go_to_rest()
    assert machine.steps()[0] == there + 10


@pytest.mark.parametrize("number", [STOP_INPUT, FAULT_INPUT, LOW_INPUT])
@pytest.mark.parametrize("position", [0, -50, 50])
def test_zeroing_sets_out_backward_wherever_it_is(machine: Machine, number: int, position: int) -> None:
    machine.ok(p.SET_POSITION, for_axes({0: position}))
    machine.pull_down(HIGH_INPUT, number)
    machine.pass_ms(20)
    refusal = (p.AT_LIMIT, LOW_INPUT << 8) if number == LOW_INPUT else (p.STOPPED, 1 << number | 1 << HIGH_INPUT)
    assert machine.refused(p.ZERO, bytes([1, 50, 0])) == refusal
    machine.pass_ms(200)
    assert (machine.steps()[0], machine.status().position) == (0, position)
    assert (machine.status().state, machine.inputs().known & 1) == (p.IDLE, 1)
    machine.pull_down(HIGH_INPUT)
    machine.pass_ms(20)
    machine.ok(p.ACKNOWLEDGE)
    machine.ok(p.ZERO, bytes([1, 50, 0]))
    machine.go_to_rest()
    assert machine.steps()[0] == -50


def test_a_limit_stops_with_the_ramp_and_the_way_back_is_free(machine: Machine) -> None:
    machine.ok(p.SET_POSITION, for_axes({0: 0}))
    machine.add_switch(LOW_INPUT, 0, -100, is_backward=True)
    machine.ok(p.RUN, for_axes({0: -3000}))
    status = machine.go_to_rest()
    assert -160 < status.position < -100
    assert machine.steps()[0] == status.position
    assert (machine.inputs().active, machine.inputs().known & 1) == (1 << LOW_INPUT, 1)
    detail = LOW_INPUT << 8 | 0
    for kind, body in [
        (p.MOVE_BY, for_axes({0: -1})),
        (p.MOVE_TO, for_axes({0: status.position - 1})),
        (p.RUN, for_axes({0: -3000})),
        (p.LINE, bytes([1, 0]) + values_of({0: -5})),
    ]:
        assert machine.refused(kind, body) == (p.AT_LIMIT, detail)
    machine.ok(p.MOVE_BY, for_axes({0: 0}))
    machine.ok(p.MOVE_TO, for_axes({0: 0}))
    assert machine.go_to_rest().position == 0
    assert machine.inputs().active == 0


def test_a_limit_stops_at_once_where_its_role_says_so(machine: Machine) -> None:
    machine.ok(p.SET_POSITION, for_axes({0: 0}))
    machine.add_switch(HIGH_INPUT, 0, 200, is_backward=False)
    machine.ok(p.MOVE_TO, for_axes({0: 5000}))
    status = machine.go_to_rest()
    # At up to 8000 steps/s, four looks a millisecond apart.
    assert 200 <= status.position <= 240
    assert machine.steps()[0] == status.position
    assert machine.inputs().known & 1 == 0
    assert machine.refused(p.MOVE_BY, for_axes({0: 1})) == (p.AT_LIMIT, HIGH_INPUT << 8)


@pytest.mark.parametrize(("number", "way"), [(LOW_INPUT, 1), (HIGH_INPUT, -1)])
def test_a_switch_at_the_other_end_stops_nothing(machine: Machine, number: int, way: int) -> None:
    machine.pull_down(number)
    machine.pass_ms(20)
    machine.ok(p.MOVE_BY, for_axes({0: 300 * way}))
    assert machine.go_to_rest().position == 300 * way


def test_a_limit_of_one_axis_stops_a_line_as_a_whole(machine: Machine) -> None:
    machine.push(FOUR_AXES)
    machine.give(InputSettings(roles={LOW_INPUT: p.LOW_LIMIT + 2}))
    machine.add_switch(LOW_INPUT, 2, -300, is_backward=True)
    machine.ok(p.LINE, bytes([15, 0]) + values_of({0: 4000, 1: 2000, 2: -1000, 3: 0}))
    machine.go_to_rest()
    steps = machine.steps()
    assert -400 < steps[2] < -300
    assert [abs(steps[axis] - round(-4 * share * steps[2])) <= 2 for axis, share in ((0, 1), (1, 0.5))] == [True, True]
    for axis in range(4):
        assert machine.status(axis).position == steps[axis]
    detail = LOW_INPUT << 8 | 2
    assert machine.refused(p.LINE, bytes([15, 0]) + values_of({0: 5, 1: 5, 2: -1, 3: 0})) == (p.AT_LIMIT, detail)
    machine.ok(p.LINE, bytes([15, 0]) + values_of({0: 5, 1: 5, 2: 1, 3: 0}))


def test_a_motion_that_turns_round_into_a_limit_is_stopped(machine: Machine) -> None:
    """It was asked for while the switch was inactive, and the switch comes while it still slows down the other way."""
    machine.ok(p.RUN, for_axes({0: 3000}))
    machine.go_on_ms(400)
    machine.ok(p.MOVE_TO, for_axes({0: -2000}))
    machine.pull_down(LOW_INPUT)
    status = machine.go_to_rest()
    assert status.position > -20


@pytest.mark.parametrize("before", range(1, 9))
def test_a_limit_stops_at_once_what_is_about_to_turn_round(machine: Machine, before: int) -> None:
    """At 1000 steps/s, which is in the queue for 8 ms and more."""
    machine.push(p.Ramp([], 16_000, []).image(1, fast=True))
    machine.give(InputSettings(looks=1, roles={LOW_INPUT: p.LOW_LIMIT | p.AT_ONCE}))
    machine.add_switch(LOW_INPUT, 0, -100, is_backward=True)
    machine.ok(p.RUN, for_axes({0: -16_000}))
    while machine.steps()[0] > -100 + before:
        machine.run(1)
    machine.driver.send(machine.frame(p.RUN, for_axes({0: 16_000})))
    lowest = 0
    for _ in range(600):
        machine.run(1)
        lowest = min(lowest, machine.steps()[0])
    assert lowest >= -102
    # The way back is free at once.
    machine.ok(p.STOP)
    machine.go_to_rest()
    machine.ok(p.RUN, for_axes({0: 16_000}))
    machine.pass_ms(300)
    assert machine.steps()[0] > 0


def test_switches_that_open_are_active_high(machine: Machine) -> None:
    machine.pull_down(FAULT_INPUT)
    machine.give(InputSettings(roles={FAULT_INPUT: p.DRIVER_FAULT | p.ACTIVE_HIGH}))
    machine.pass_ms(20)
    assert machine.inputs().active == 0
    machine.pull_down()
    machine.pass_ms(20)
    assert (machine.inputs().active, machine.inputs().stopped_by) == (1 << FAULT_INPUT, p.BY_DRIVER_FAULT)


@pytest.mark.parametrize(
    ("settings", "bad"),
    [
        (InputSettings(silence=1), 12),
        (InputSettings(silence=201), 12),
        (InputSettings(silence_flags=2), 13),
        (InputSettings(looks=0), 14),
        (InputSettings(looks=11), 14),
        (InputSettings(roles={0: 3}), 15),
        (InputSettings(roles={1: p.AT_ONCE}), 16),
        (InputSettings(roles={2: p.EMERGENCY_STOP | p.AT_ONCE}), 17),
        (InputSettings(roles={3: 16}), 18),
        (InputSettings(roles={6: p.EMERGENCY_STOP}), 21),
        (InputSettings(roles={8: 7}), 23),
    ],
)
def test_bad_settings_of_inputs_are_refused(machine: Machine, settings: InputSettings, bad: int) -> None:
    assert machine.refused(p.WRITE_SETTINGS, Settings().packed() + settings.packed()) == (p.OUT_OF_RANGE, bad)
    assert machine.settings() == Settings().packed() + InputSettings(roles=ROLES).packed()


def test_silence_ends_runs_after_the_time_set_and_moves_when_set(machine: Machine) -> None:
    machine.give(InputSettings(silence=10, roles=ROLES))
    machine.ok(p.RUN, for_axes({0: 3000}))
    machine.pass_ms(2000)
    assert machine.status().axis_state == p.IN_MOTION
    machine.pass_ms(4000)
    assert machine.status().state == p.IDLE
    machine.ok(p.MOVE_BY, for_axes({0: 5000}))
    machine.pass_ms(8000)
    assert machine.status().position == machine.status().target
    machine.give(InputSettings(silence=2, silence_flags=1, roles=ROLES))
    machine.ok(p.SET_POSITION, for_axes({0: 0}))
    machine.ok(p.MOVE_BY, for_axes({0: 50_000}))
    machine.pass_ms(2000)
    status = machine.status()
    assert (status.state, status.position < 8000) == (p.IDLE, True)
    assert machine.inputs().known & 1


def test_the_position_is_known_once_it_is_set_and_until_a_halt_at_speed(machine: Machine) -> None:
    assert machine.inputs().known == 0
    machine.ok(p.SET_POSITION, for_axes({0: 0}))
    assert machine.inputs().known == 1
    machine.ok(p.MOVE_BY, for_axes({0: 3000}))
    machine.pass_ms(500)
    machine.ok(p.STOP)
    machine.go_to_rest()
    assert machine.inputs().known == 1
    machine.ok(p.RUN, for_axes({0: 30_000}))
    machine.go_on_ms(400)
    machine.ok(p.HALT)
    assert machine.inputs().known == 1
    machine.ok(p.RUN, for_axes({0: 3000}))
    machine.go_on_ms(400)
    machine.ok(p.HALT)
    assert machine.inputs().known == 0


def test_a_halt_is_judged_by_the_steps_that_are_made_then(machine: Machine) -> None:
    """Not by those that are planned: 8 ms ahead of a steep ramp's last steps it is fast yet."""
    side = [(35_777, 1, 0), (14_819, 1, 0), (11_371, 3, -1000), (7000, 60, -90)]
    machine.push(p.Ramp(side, 1600, side).image(1, fast=True))
    judged = set()
    for after_ms in range(90, 140):
        machine.ok(p.SET_POSITION, for_axes({0: 0}))
        machine.ok(p.MOVE_TO, for_axes({0: 1000}))
        machine.pass_ms(after_ms - 1)
        before = machine.steps()[0]
        machine.pass_ms(1)
        made = machine.steps()[0] - before
        interval = machine.status().interval
        machine.ok(p.HALT)
        known = machine.inputs().known
        if made >= 4:
            assert (known, interval < 16_000) == (0, True), after_ms
        judged.add((made, known))
    assert {(10, 0), (0, 1)} <= judged


def test_on_a_ramp_of_long_intervals_no_halt_is_judged_by_what_is_planned(machine: Machine) -> None:
    """Of an interval that is longer than an event, as of 1.9 to 6.9 ms, no more is known than that it is."""
    side = [(111_040, 1, 0), (46_880, 1, 0), (36_000, 1, 0), (30_240, 1, 0), (26_000, 20, -300)]
    machine.push(p.Ramp(side, 20_000, side).image(1, fast=True))
    known_after = {}
    for kind, value in ((p.MOVE_BY, 40), (p.RUN, -20_000)):
        for after_ms in range(1, 100):
            before = machine.steps()[0]
            machine.ok(p.SET_POSITION, for_axes({0: 0}))
            machine.ok(kind, for_axes({0: value}))
            machine.pass_ms(after_ms)
            machine.ok(p.HALT)
            known_after.setdefault(machine.steps()[0] - before, set()).add(machine.inputs().known)
    assert {2, 3, 4, 37, 38, 39, 40, -2, -3, -4} <= known_after.keys()
    assert 1 in known_after[40], "at rest"
    assert set().union(*(known for steps, known in known_after.items() if abs(steps) != 1 and steps != 40)) == {0}


def test_what_has_run_as_slowly_from_rest_on_stays_known(machine: Machine) -> None:
    machine.push(p.Ramp([(111_040, 1, 0), (46_880, 1, 0)], 20_000, [(46_880, 2, 0)]).image(1, fast=True))
    for turned in (1, -1):
        machine.ok(p.SET_POSITION, for_axes({0: 0}))
        machine.ok(p.RUN, for_axes({0: turned * 160_000}))
        machine.pass_ms(100)
        machine.ok(p.RUN, for_axes({0: turned * -200_000}))
        machine.pass_ms(97)
        machine.ok(p.HALT)
        assert machine.inputs().known == 1
