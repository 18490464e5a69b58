"""Homing as the server sees to it: on a lease, with what is known afterwards, and what stops everything."""

from __future__ import annotations

import pytest

from devices.bench import ROLES, Bench, by, home
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.motion import AcknowledgeRequest, HomeRequest, StopRequest
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.surroundings import SurroundingsChange, Switches
from stepramp.devices.homing import Homing
from stepramp.devices.leases import Lease
from stepramp.devices.soft_limits import Span
from stepramp.devices.view import AxisView, DeviceState
from stepramp.errors import Refused


@pytest.fixture(autouse=True)
def _from_rest(bench: Bench) -> None:
    bench.reset()


def axis_of(bench: Bench) -> AxisView:
    return bench.device.view.axes[0]


def go_on(bench: Bench, time_s: float) -> None:
    for _ in range(round(time_s / 0.1)):
        bench.clock.now_s += 0.1
        bench.poll()


def press(bench: Bench, *, pressed: bool) -> None:
    bench.witness.controller.change_surroundings(SurroundingsChange(emergency_stop=pressed))
    bench.look()


def test_what_is_shown_of_a_homing(bench: Bench) -> None:
    home(bench)
    assert (axis_of(bench).homing, axis_of(bench).position_known) == (True, False)
    assert bench.device.view.state is DeviceState.MOVING
    go_on(bench, 2.0)
    axis = axis_of(bench)
    assert (axis.homing, axis.position_known, axis.position_steps) == (False, True, -1)
    assert (bench.device.view.state, bench.device.view.after_homing) == (DeviceState.READY, {})
    assert StopRequest.KIND not in bench.witness.seen, "its lease ends with it"


def test_what_is_found_is_called_as_asked_and_the_way_that_the_switch_took_counts(bench: Bench) -> None:
    home(bench, position_steps=5000)
    go_on(bench, 2.0)
    assert (axis_of(bench).position_steps, axis_of(bench).position_known) == (4999, True)


def test_it_is_shown_at_rest_only_once_it_is_known(bench: Bench) -> None:
    """Whoever waits for its end looks then whether it was found."""
    home(bench, position_steps=5000)
    seen = set()
    with bench.devices.listening(lambda: seen.add((bench.device.view.state, axis_of(bench).position_known))):
        go_on(bench, 2.0)
    assert (DeviceState.READY, True) in seen
    assert (DeviceState.READY, False) not in seen


def test_it_is_called_nothing_when_it_was_stopped(bench: Bench) -> None:
    home(bench, position_steps=5000)
    go_on(bench, 0.2)
    bench.device.stop().result(5.0)
    go_on(bench, 2.0)
    assert (axis_of(bench).position_known, axis_of(bench).homing) == (False, False)
    assert -200 < axis_of(bench).position_steps < 0
    assert bench.device.view.after_homing == {}


def test_soft_limits_are_not_kept_by_places_that_have_no_name_yet(bench: Bench) -> None:
    """After a STOP in its midst, or a name that leads out of all numbers, it is to be said where the axis is."""
    for position_steps, stops in ((5000, True), (-(2**31), False)):
        bench.device.limit({0: Span(4900, 6000) if stops else Span(None, 6000)})
        home(bench, position_steps=position_steps)
        go_on(bench, 0.2 if stops else 2.0)
        if stops:
            bench.device.stop().result(5.0)
            go_on(bench, 2.0)
        assert bench.device.view.state is DeviceState.READY
        assert bench.device.view.unknown_positions == (0,)
        for ask in (lambda: bench.device.move_by([by(50)]), lambda: bench.device.move_to([by(5900)])):
            with pytest.raises(Refused, match=r"may be elsewhere than counted, since .* it wasn't homed to the end"):
                ask()
        bench.device.limit({0: Span()})
        bench.device.set_position([AxisCommand(0, 0, "axes.0.position_steps")])
        assert bench.device.view.unknown_positions == ()


def run_other(bench: Bench) -> None:
    bench.device.run([AxisCommand(1, 400.0, "speed_steps_per_s")], Lease({1: 400.0}, 1e6))


@pytest.mark.parametrize("ends", ["stop", "halt"])
@pytest.mark.parametrize("position_steps", [0, 5000])
def test_what_was_homed_stays_known_through_a_stop_while_another_axis_moves(
    bench: Bench, position_steps: int, ends: str
) -> None:
    home(bench, position_steps=position_steps)
    run_other(bench)
    go_on(bench, 2.0)
    # Nothing but 0 is taken as a name before all axes rest.
    known_steps = axis_of(bench).position_steps if axis_of(bench).position_known else None
    assert (axis_of(bench).homing, known_steps) == (False, None if position_steps else -1)
    getattr(bench.device, ends)().result(5.0)
    go_on(bench, 2.0)
    assert (axis_of(bench).position_known, axis_of(bench).position_steps) == (True, position_steps - 1)
    assert (bench.device.view.unknown_positions, bench.device.view.after_homing) == ((), {})


def test_a_stop_of_what_is_still_homed_leaves_only_that_unknown(bench: Bench) -> None:
    home(bench, position_steps=5000)
    run_other(bench)
    go_on(bench, 0.2)
    bench.device.stop([0]).result(5.0)
    go_on(bench, 2.0)
    assert (bench.device.view.unknown_positions, bench.device.view.after_homing) == ((0,), {})


def test_axes_that_are_homed_one_after_another_are_known_each_by_itself(bench: Bench) -> None:
    second = {"input": "A2", "role": "limit", "axis": 1, "end": "low"}
    bench.device.use_settings(StepRampSettings.checked({"inputs": [*ROLES, second]}))
    home(bench)
    go_on(bench, 2.0)
    switch = SurroundingsChange(
        switches={1: Switches(bench.witness.controller.surroundings.axes[1].place_steps - 10_000, None)}
    )
    bench.witness.controller.change_surroundings(switch)
    fast, slow = AxisCommand(1, -800.0, "axes.0.fast_steps_per_s"), AxisCommand(1, 100.0, "slow_steps_per_s")
    bench.device.home(Homing([fast], slow, 20, {1: 0}), Lease({1: -800.0}, 1e6, is_to_home=True))
    go_on(bench, 1.0)
    assert [axis.position_known for axis in bench.device.view.axes] == [True, False]
    bench.device.stop().result(5.0)
    go_on(bench, 2.0)
    assert [axis.position_known for axis in bench.device.view.axes] == [True, False]
    assert (bench.device.view.unknown_positions, bench.device.view.after_homing) == ((1,), {})
    bench.device.use_settings(StepRampSettings.checked({"inputs": ROLES}))


def test_what_waits_for_its_name_is_told_so_where_it_has_soft_limits(bench: Bench) -> None:
    bench.device.limit({0: Span(0, 6000)})
    home(bench, position_steps=5000)
    run_other(bench)
    go_on(bench, 2.0)
    with pytest.raises(Refused, match="Axis 0 was homed, and where it is gets its name once all axes rest"):
        bench.device.move_by([by(5)])
    bench.device.stop().result(5.0)
    go_on(bench, 2.0)
    bench.device.move_by([by(5)])
    bench.settle()
    bench.device.limit({0: Span()})


def test_what_waits_for_its_name_has_none_when_the_device_is_lost(bench: Bench) -> None:
    home(bench, position_steps=5000)
    run_other(bench)
    go_on(bench, 2.0)
    lost = bench.device.view.lost("It is gone.")
    assert (lost.unknown_positions, lost.after_homing) == ((0, 1), {})


def test_it_ends_with_its_lease(bench: Bench) -> None:
    lease = Lease({0: -800.0}, 1e6, is_to_home=True)
    bench.put_switch(10_000)
    fast, slow = AxisCommand(0, -800.0, "axes.0.fast_steps_per_s"), AxisCommand(0, 100.0, "slow_steps_per_s")
    bench.device.home(Homing([fast], slow, 20, {0: 0}), lease)
    go_on(bench, 0.5)
    assert axis_of(bench).homing
    bench.device.end_run(lease)
    go_on(bench, 1.0)
    assert (axis_of(bench).homing, axis_of(bench).position_known) == (False, False)
    with pytest.raises(Refused, match="before it began"):
        bench.device.home(Homing([fast], slow, 20, {0: 0}), lease)
    assert bench.witness.seen.count(HomeRequest.KIND) == 1


def test_it_ends_with_the_page_that_began_it(bench: Bench) -> None:
    bench.put_switch(10_000)
    fast, slow = AxisCommand(0, -800.0, "axes.0.fast_steps_per_s"), AxisCommand(0, 100.0, "slow_steps_per_s")
    homing = Homing([fast], slow, 20, {0: 0})
    with pytest.raises(Refused, match="its page is gone"):
        bench.device.home(homing, Lease({0: -800.0}, 1e6, "one", is_to_home=True))
    bench.device.take_control("one")
    bench.device.home(homing, Lease({0: -800.0}, 1e6, "one", is_to_home=True))
    go_on(bench, 0.5)
    bench.device.leave_control("one")
    go_on(bench, 1.0)
    assert (axis_of(bench).homing, bench.device.view.state) == (False, DeviceState.READY)


def test_soft_limits_do_not_hold_while_it_is_homed_and_hold_again_from_where_it_is(bench: Bench) -> None:
    bench.device.limit({0: Span(-50, 300)})
    assert axis_of(bench).limits_hold
    home(bench)
    assert not axis_of(bench).limits_hold
    go_on(bench, 2.0)
    assert (axis_of(bench).position_steps, axis_of(bench).limits_hold) == (-1, True)
    bench.device.move_by([by(200)])
    bench.settle()
    bench.device.limit({0: Span()})


def test_where_limits_are_is_known_once_it_was_homed(bench: Bench) -> None:
    bench.device.limit({0: Span(-50, 300)})
    bench.device.disconnect()
    bench.device.connect()
    # They were on trial only.
    bench.device.use_settings(StepRampSettings.checked({"inputs": ROLES}))
    assert bench.device.view.unknown_positions == (0,)
    with pytest.raises(Refused, match="may be elsewhere than counted"):
        bench.device.move_by([by(5)])
    home(bench, position_steps=100)
    go_on(bench, 2.0)
    assert (bench.device.view.unknown_positions, axis_of(bench).position_steps) == ((), 99)
    bench.device.move_by([by(5)])
    bench.settle()


def test_what_is_found_being_homed_for_nobody_is_stopped(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    bench.put_switch(10_000)
    home(bench)
    # As a board with a supply of its own that opening its port doesn't reset.
    monkeypatch.setattr(type(bench.witness), "opened", lambda _: None)
    bench.put_switch(10_000)
    bench.device.shut_down()
    bench.witness.seen.clear()
    bench.device.connect()
    assert StopRequest.KIND in bench.witness.seen


def test_an_emergency_stop_is_shown_and_acknowledged(bench: Bench) -> None:
    bench.device.move_by([by(3000)])
    bench.clock.now_s += 0.3
    press(bench, pressed=True)
    view = bench.device.view
    assert (view.state, view.stopped_by) == (DeviceState.READY, ("emergency_stop",))
    assert [(each.input, each.is_active) for each in view.inputs or ()] == [("A0", True), ("A1", False)]
    assert view.message == ("Nothing moves: the emergency stop at A0 is active. First release it, then acknowledge.")
    for ask in (lambda: bench.device.move_by([by(5)]), bench.device.acknowledge, lambda: home(bench)):
        with pytest.raises(Refused, match="the emergency stop at A0 is active"):
            ask()
    press(bench, pressed=False)
    assert (
        bench.device.view.message == "Nothing moves: the emergency stop has stopped all axes. Acknowledge that first."
    )
    bench.device.acknowledge()
    assert (bench.device.view.stopped_by, bench.device.view.message) == ((), None)
    bench.device.move_by([by(5)])
    bench.settle()


def test_what_was_to_be_acknowledged_before_a_stop_is_not_afterwards(bench: Bench) -> None:
    press(bench, pressed=True)
    press(bench, pressed=False)
    asked = bench.devices.order.next()
    bench.device.stop().result(5.0)
    with pytest.raises(Refused, match="A stop came first"):
        bench.device.acknowledge(asked)
    assert AcknowledgeRequest.KIND not in bench.witness.seen
    bench.device.acknowledge()
    assert bench.device.view.stopped_by == ()


def test_an_axis_that_may_be_elsewhere_is_nowhere_told_to_be_known(bench: Bench) -> None:
    """Not once the device is lost, nor when it is connected again and its controller has counted on."""
    home(bench)
    go_on(bench, 2.0)
    known = bench.device.view
    assert known.axes[0].position_known
    lost = known.lost("It is gone.")
    assert (lost.unknown_positions, [axis.position_known for axis in lost.axes]) == ((0, 1), [False, False])
    again = lost.with_status(bench.worker.call(bench.device._attachment._contact.controller.status))
    assert [axis.position_known for axis in again.axes] == [False, False]
    assert again.with_known_positions([0]).axes[0].position_known
