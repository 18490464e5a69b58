"""The virtual controller's inputs: switches, an emergency stop, a driver's fault; and what the client says of them."""

from __future__ import annotations

import pytest

from controllers.bench import POLL_S, at, by, only_rejection, to
from controllers.conftest import Clock
from designs import design
from stepramp.controllers.capabilities import HasInputs, capabilities_of, capable
from stepramp.controllers.contract import Activity, AxisCommand, AxisStatus, ControllerStatus
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.surroundings import Surroundings, SurroundingsChange, Switches
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.errors import Refused

LOW, HIGH = -500, 900
ROLES = [
    {"input": "A0", "role": "emergency_stop"},
    {"input": "A1", "role": "driver_fault"},
    {"input": "A2", "role": "limit", "axis": 0, "end": "low"},
    {"input": "A3", "role": "limit", "axis": 0, "end": "high", "stops": "at_once"},
    {"input": "D11", "role": "limit", "axis": 1, "end": "low"},
]


class Bench:
    """A virtual controller with two axes and switches, its client, and the clock of both."""

    def __init__(self, clock: Clock, virtual: VirtualController, controller: StepRampController) -> None:
        self.clock, self.virtual, self.controller = clock, virtual, controller
        controller.prepare_push([design(), design()], mode="try")()
        controller.use_settings(StepRampSettings.checked({"inputs": ROLES}))
        self.put(Switches(LOW, HIGH))

    def put(self, switches: Switches, axis: int = 0) -> None:
        self.virtual.change_surroundings(SurroundingsChange(switches={axis: switches}))

    def press(self, **pressed: bool) -> None:
        self.virtual.change_surroundings(SurroundingsChange(**pressed))

    def wait(self, time_s: float) -> ControllerStatus:
        until_s = self.clock.now_s + time_s
        while self.clock.now_s < until_s:
            self.clock.now_s += min(POLL_S, until_s - self.clock.now_s)
            self.controller.status()
        return self.controller.status()

    def rest(self) -> AxisStatus:
        for _ in range(1000):
            status = self.wait(POLL_S)
            if status.activity is Activity.READY:
                return status.axes[0]
        raise AssertionError(status)

    def home(self, speed: float = -800.0, slow: float = 100.0, back_off: int = 30, axis: int = 0) -> None:
        self.controller.home(
            [AxisCommand(axis, speed, "axes.0.fast_steps_per_s")], AxisCommand(0, slow, "slow_steps_per_s"), back_off
        )

    @property
    def place(self) -> int:
        return self.around.axes[0].place_steps

    @property
    def around(self) -> Surroundings:
        return self.virtual.surroundings


@pytest.fixture
def bench(clock: Clock, virtual: VirtualController, controller: StepRampController) -> Bench:
    return Bench(clock, virtual, controller)


def test_what_it_says_of_its_inputs(bench: Bench) -> None:
    status = bench.controller.status()
    assert status.of_inputs is not None
    told = [(each.input, each.role, each.axis, each.end, each.stops) for each in status.of_inputs.inputs]
    assert told == [
        ("A0", "emergency_stop", None, None, None),
        ("A1", "driver_fault", None, None, None),
        ("A2", "limit", 0, "low", "ramp"),
        ("A3", "limit", 0, "high", "at_once"),
        ("D11", "limit", 1, "low", "ramp"),
    ]
    assert not any(each.is_active for each in status.of_inputs.inputs)
    assert (status.of_inputs.stopped_by, status.trouble) == ((), None)
    assert [(axis.position_known, axis.homing) for axis in status.axes] == [(False, False)] * 2
    assert "inputs" in capabilities_of(bench.controller)


def test_a_limit_switch_stops_with_the_ramp_and_the_other_way_is_free(bench: Bench) -> None:
    bench.controller.move_by(by(-5000))
    axis = bench.rest()
    # 100 steps down from 1000 steps/s with 5000 steps/s².
    assert LOW - 101 <= axis.position_steps == bench.place < LOW - 90
    for motion in (lambda: bench.controller.move_by(by(-1)), lambda: bench.controller.run(at(-300.0))):
        with pytest.raises(Refused, match=r"Axis 0 is on the limit switch of its low end at A2.*move it the other way"):
            motion()
    bench.controller.move_by(by(300))
    assert bench.rest().position_steps == axis.position_steps + 300


def test_a_limit_switch_stops_at_once(bench: Bench) -> None:
    bench.controller.set_position(to(0))
    assert bench.controller.status().axes[0].position_known
    bench.controller.run(at(700.0))
    axis = bench.rest()
    assert axis.position_steps == HIGH
    assert axis.position_known is False


def test_a_limit_switch_stops_a_line_as_a_whole(bench: Bench) -> None:
    bench.controller.line([*by(-1000), *by(-500, 1)])
    axis = bench.rest()
    other = bench.controller.status().axes[1]
    assert axis.position_steps == pytest.approx(2 * other.position_steps, abs=2)
    assert LOW - 120 < axis.position_steps <= LOW


@pytest.mark.parametrize("name", ["emergency_stop", "driver_fault"])
def test_what_stops_all_has_to_be_acknowledged(bench: Bench, name: str) -> None:
    where = "A0" if name == "emergency_stop" else "A1"
    bench.controller.move_by([*by(5000), *by(3000, 1)])
    bench.wait(0.5)
    bench.press(**{name: True})
    status = bench.controller.status()
    assert status.activity is Activity.READY
    assert status.of_inputs is not None
    assert status.of_inputs.stopped_by == (name,)
    assert [each.input for each in status.of_inputs.inputs if each.is_active] == [where]
    assert where in (status.trouble or "")
    for motion in (lambda: bench.controller.move_by(by(5)), bench.home):
        with pytest.raises(Refused, match=rf"at {where} is active\. First .*, then acknowledge"):
            motion()
    with pytest.raises(Refused, match=f"at {where} is active"):
        bench.controller.acknowledge()
    bench.press(**{name: False})
    with pytest.raises(Refused, match="Acknowledge that first"):
        bench.controller.move_by(by(5))
    bench.controller.acknowledge()
    before = bench.controller.status().axes[0].position_steps
    bench.controller.move_by(by(5))
    assert bench.rest().position_steps == before + 5


@pytest.mark.parametrize(("speed", "switch", "direction"), [(-800.0, LOW, -1), (600.0, HIGH, 1)])
def test_homing_finds_the_switch(bench: Bench, speed: float, switch: int, direction: int) -> None:
    bench.home(speed)
    homing = bench.wait(0.2).axes[0]
    assert (homing.homing, homing.position_known, homing.activity) == (True, False, Activity.MOVING)
    with pytest.raises(Refused, match="The motor moves"):
        bench.controller.move_by(by(5))
    axis = bench.rest()
    # The switch stopped it with the first step at which it is active: position 0 is the place before that.
    assert (axis.position_steps, axis.position_known, axis.homing) == (direction, True, False)
    assert bench.place == switch
    bench.controller.move_to(to(0))
    assert bench.rest().position_steps == 0
    assert bench.place == switch - direction


def test_homing_from_within_the_switch_begins_with_the_way_back(bench: Bench) -> None:
    bench.put(Switches(40, None))
    bench.home()
    assert bench.wait(0.3).axes[0].position_steps > 0
    axis = bench.rest()
    assert (bench.place, axis.position_steps, axis.position_known) == (40, -1, True)


@pytest.mark.parametrize("end", ["stop", "halt", "emergency", "silence", "no switch"])
def test_what_ends_a_homing(bench: Bench, end: str) -> None:
    bench.controller.set_position(to(0))
    if end == "no switch":
        bench.put(Switches(None, None))
        bench.home()
        bench.wait(5.0)
        bench.controller.stop()
    else:
        bench.home()
        bench.wait(0.3)
    if end == "emergency":
        bench.press(emergency_stop=True)
    elif end == "silence":
        bench.clock.now_s += 3.0
    elif end in ("stop", "halt"):
        getattr(bench.controller, end)()
    axis = bench.rest()
    assert (axis.position_known, axis.homing) == (False, False)
    assert bench.place > -500 or end == "no switch"


def test_two_axes_are_homed_each_by_itself(bench: Bench) -> None:
    bench.put(Switches(-3000, None), axis=1)
    bench.controller.home(
        [AxisCommand(0, 400.0, "axes.0.fast_steps_per_s"), AxisCommand(1, -900.0, "axes.1.fast_steps_per_s")],
        AxisCommand(0, 80.0, "slow_steps_per_s"),
        1,
    )
    bench.rest()
    places = [axis.place_steps for axis in bench.around.axes[:2]]
    axes = bench.controller.status().axes
    assert (places, [axis.position_steps for axis in axes]) == ([HIGH, -3000], [1, -1])


def test_homings_that_cant_be(bench: Bench) -> None:
    field, value, allowed = only_rejection(lambda: bench.home(800.0, axis=1))
    assert (field, value) == ("axes.0.fast_steps_per_s", 800.0)
    assert "at its high end none is named" in allowed
    assert only_rejection(lambda: bench.home(-1200.0))[:2] == ("axes.0.fast_steps_per_s", -1200.0)
    assert only_rejection(lambda: bench.home(slow=1200.0))[:2] == ("slow_steps_per_s", 1200.0)
    assert only_rejection(lambda: bench.home(axis=3))[:2] == ("axes.0.axis", 3)


def test_the_silence_is_that_of_the_settings_and_ends_moves_if_told_to(bench: Bench) -> None:
    bench.put(Switches(None, None))
    bench.controller.use_settings(StepRampSettings(silence_s=3.0, silence_ends_moves=True))
    assert bench.controller.settings().silence_s == 3.072
    assert bench.controller.settings().inputs == StepRampSettings.checked({"inputs": ROLES}).inputs
    for begin in (lambda: bench.controller.run(at(500.0)), lambda: bench.controller.move_by(by(100_000))):
        begin()
        bench.clock.now_s += 3.0
        assert bench.controller.status().activity is Activity.MOVING
        bench.clock.now_s += 5.0
        assert bench.controller.status().activity is Activity.READY


def test_settings_are_kept_with_what_inputs_are_for(bench: Bench) -> None:
    clock = bench.clock
    bench.controller._storage._transfer._give_way = lambda pause_s: setattr(clock, "now_s", clock.now_s + pause_s)
    limits = StepRampSettings.checked({"soft_limits": [{"axis": 1, "lowest_steps": -9, "highest_steps": 9}]})
    bench.controller.use_settings(limits)
    bench.controller.keep()
    bench.virtual.opened()
    bench.controller.connect()
    assert bench.controller.settings().inputs == StepRampSettings.checked({"inputs": ROLES}).inputs
    assert bench.controller.settings().soft_limits == limits.soft_limits


def test_a_controller_without_inputs_is_told_apart(bench: Bench) -> None:
    bench.controller._hello = None
    bench.controller._conversation._version = 2
    bench.controller.connect()
    assert "inputs" not in capabilities_of(bench.controller)
    status = bench.controller.status()
    assert (status.of_inputs, status.axes[0].position_known, status.axes[0].homing) == (None, None, None)
    with pytest.raises(Refused, match=r"Virtual can't tell of inputs, nor be homed from here: its firmware is without"):
        capable(bench.controller, HasInputs, "Virtual", "StepRamp")
    assert bench.controller.settings().given_of_inputs == []
    field, value, allowed = only_rejection(lambda: bench.controller.use_settings(StepRampSettings(looks=3)))
    assert (field, value) == ("looks", 3)
    assert allowed.startswith("null: the controller at sim://")
    assert only_rejection(lambda: bench.controller.use_settings(StepRampSettings(inputs=())))[0] == "inputs"
    bench.controller.use_settings(StepRampSettings(pulse_width_us=9))
    assert bench.controller.settings().pulse_width_us == 9
