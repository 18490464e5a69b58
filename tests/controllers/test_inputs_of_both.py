"""Inputs and homing as the client knows them: of the firmware on this machine, and of the virtual controller."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Protocol

import pytest

from controllers.bench import at, by, only_rejection, to
from controllers.conftest import Clock
from designs import design
from firmware.controller_host import Driver, missing_compiler
from stepramp.controllers.capabilities import capabilities_of
from stepramp.controllers.contract import Activity, AxisCommand, AxisStatus, ControllerStatus
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.surroundings import SurroundingsChange, Switches
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.errors import Refused
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort
from tools import require

SWITCH = -40
"""Where axis 0 has a switch at its low end [steps]."""
ROLES = [
    {"input": "A0", "role": "emergency_stop"},
    {"input": "A1", "role": "driver_fault"},
    {"input": "D9", "role": "limit", "axis": 0, "end": "low"},
]
PlugIn = Callable[[VirtualDevice], str]


class Board(VirtualDevice, Protocol):
    """A controller with inputs, and what is at them."""

    def pass_ms(self, time_ms: int) -> None: ...

    def press(self, *inputs: str) -> None:
        """Have these be active, of A0 and A1, and no others."""

    def wire(self) -> None:
        """Put the switch there."""


class VirtualBoard:
    def __init__(self) -> None:
        self.clock = Clock()
        self.controller = VirtualController(self.clock)

    def opened(self) -> None:
        self.controller.opened()

    def exchange(self, sent: bytes) -> bytes:
        return self.controller.exchange(sent)

    def pass_ms(self, time_ms: int) -> None:
        self.clock.now_s += time_ms / 1000

    def press(self, *inputs: str) -> None:
        self.controller.change_surroundings(SurroundingsChange("A0" in inputs, "A1" in inputs))

    def wire(self) -> None:
        self.controller.change_surroundings(SurroundingsChange(switches={0: Switches(SWITCH, None)}))


class FirmwareBoard:
    def __init__(self, driver: Driver) -> None:
        self._driver = driver

    def opened(self) -> None:
        self._driver.ask("begin")

    def exchange(self, sent: bytes) -> bytes:
        return self._driver.send(sent) if sent else b""

    def pass_ms(self, time_ms: int) -> None:
        self._driver.ask("pass", time_ms)

    def press(self, *inputs: str) -> None:
        self._driver.ask("levels", 0x1FF & ~sum(1 << int(name[1]) for name in inputs))
        self.pass_ms(20)

    def wire(self) -> None:
        self._driver.ask("switch", 6, 0, 1, SWITCH)


class Rig:
    """A client of a board, with a ramp of 1000 steps/s for two axes."""

    def __init__(self, board: Board, plug_in: PlugIn) -> None:
        self.board = board
        self.port = SerialPort(plug_in(board))
        self.controller = StepRampController(self.port)
        self.controller.connect()
        self.controller.prepare_push([design(), design()], mode="try")()
        self.controller.use_settings(StepRampSettings.checked({"inputs": ROLES}))
        self.board.wire()

    def go_on(self, time_ms: int) -> ControllerStatus:
        for _ in range(0, time_ms, 100):
            self.board.pass_ms(100)
            self.controller.status()
        return self.controller.status()

    def rest(self) -> AxisStatus:
        for _ in range(200):
            status = self.go_on(100)
            if status.activity is Activity.READY:
                return status.axes[0]
        raise AssertionError(status)

    def home(self, slow: float = 100.0) -> None:
        fast = [AxisCommand(0, -700.0, "axes.0.fast_steps_per_s")]
        self.controller.home(fast, AxisCommand(0, slow, "slow_steps_per_s"), 20)


@pytest.fixture(params=["virtual", "firmware"])
def rig(request: pytest.FixtureRequest, plug_in: PlugIn) -> Iterator[Rig]:
    if request.param == "virtual":
        yield Rig(VirtualBoard(), plug_in)
        return
    require(*missing_compiler())
    with Driver(with_inputs=True) as driver:
        yield Rig(FirmwareBoard(driver), plug_in)


def test_what_they_say_of_themselves(rig: Rig) -> None:
    assert (rig.controller.identity.protocol_version, rig.controller.identity.more[1:]) == (3, bytes([24, 32]))
    assert "inputs" in capabilities_of(rig.controller)
    status = rig.go_on(100)
    assert status.of_inputs is not None
    assert [(each.input, each.is_active) for each in status.of_inputs.inputs] == [
        ("A0", False), ("A1", False), ("D9", False),
    ]  # fmt: skip
    assert [(axis.position_known, axis.homing) for axis in status.axes] == [(False, False)] * 2
    taken = StepRampSettings(silence_s=2.0, silence_ends_moves=True, looks=9, pulse_width_us=3)
    rig.controller.use_settings(taken)
    settings = rig.controller.settings()
    assert (settings.silence_s, settings.looks, settings.pulse_width_us) == (2.048, 9, 3)
    assert settings.inputs == StepRampSettings.checked({"inputs": ROLES}).inputs


def test_a_limit_switch(rig: Rig) -> None:
    rig.controller.move_by(by(-2000))
    axis = rig.rest()
    assert SWITCH - 110 < axis.position_steps <= SWITCH
    for motion in (lambda: rig.controller.move_by(by(-1)), lambda: rig.controller.run(at(-300.0))):
        with pytest.raises(Refused, match="Axis 0 is on the limit switch of its low end at D9"):
            motion()
    rig.controller.move_by(by(5))
    assert rig.rest().position_steps == axis.position_steps + 5


@pytest.mark.parametrize(("where", "cause"), [("A0", "emergency_stop"), ("A1", "driver_fault")])
def test_what_stops_all(rig: Rig, where: str, cause: str) -> None:
    rig.controller.set_position(to(0))
    assert rig.controller.status().axes[0].position_known
    rig.controller.move_by([*by(5000), *by(3000, 1)])
    rig.go_on(500)
    rig.board.press(where)
    status = rig.controller.status()
    assert status.activity is Activity.READY
    assert status.of_inputs is not None
    assert status.of_inputs.stopped_by == (cause,)
    assert status.axes[0].position_known is False
    for ask in (lambda: rig.controller.move_by(by(5)), rig.home, rig.controller.acknowledge):
        with pytest.raises(Refused, match=f"at {where} is active"):
            ask()
    rig.board.press()
    with pytest.raises(Refused, match="Acknowledge that first"):
        rig.controller.move_by(by(5))
    rig.controller.acknowledge()
    rig.controller.move_by(by(5))
    assert rig.rest().position_steps == status.axes[0].position_steps + 5


def test_homing(rig: Rig) -> None:
    rig.home()
    homing = rig.go_on(100).axes[0]
    assert (homing.homing, homing.position_known, homing.activity) == (True, False, Activity.MOVING)
    with pytest.raises(Refused, match="The motor moves"):
        rig.controller.move_by(by(5))
    axis = rig.rest()
    assert (axis.homing, axis.position_known) == (False, True)
    assert -4 <= axis.position_steps <= 0
    # Position 0 is the last place where the switch isn't active: from there one step is enough.
    rig.controller.move_to(to(0))
    rig.rest()
    status = rig.controller.status()
    assert status.of_inputs is not None
    assert [each.input for each in status.of_inputs.inputs if each.is_active] == []


@pytest.mark.parametrize("end", ["stop", "halt", "silence"])
def test_what_ends_a_homing(rig: Rig, end: str) -> None:
    rig.controller.move_by(by(8000))
    rig.rest()
    rig.controller.set_position(to(0))
    rig.home()
    rig.go_on(200)
    if end == "silence":
        rig.board.pass_ms(2000)
    else:
        getattr(rig.controller, end)()
    axis = rig.rest()
    assert (axis.homing, axis.position_known) == (False, False)
    assert -8000 < axis.position_steps < 0


def test_homings_that_cant_be(rig: Rig) -> None:
    field, _, allowed = only_rejection(lambda: rig.home(slow=1500.0))
    assert field == "slow_steps_per_s"
    assert allowed.endswith("to 1,000 steps/s, without a sign")
    for speed in (0.0, -1500.0, 1e-9):
        fast = [AxisCommand(0, speed, "axes.0.fast_steps_per_s")]
        field, _, allowed = only_rejection(lambda: rig.controller.home(fast, AxisCommand(0, 50.0, "slow"), 20))  # noqa: B023
        assert field == "axes.0.fast_steps_per_s"
        assert allowed.endswith("to 1,000 steps/s either way: the sign is the switch's end")
    fast = [AxisCommand(1, -700.0, "axes.0.fast_steps_per_s")]
    field, _, allowed = only_rejection(lambda: rig.controller.home(fast, AxisCommand(0, 50.0, "slow_steps_per_s"), 20))
    assert (field, "at its low end none is named" in allowed) == ("axes.0.fast_steps_per_s", True)


def test_firmware_without_inputs(plug_in: PlugIn) -> None:
    require(*missing_compiler())
    with Driver() as driver:
        controller = StepRampController(SerialPort(plug_in(FirmwareBoard(driver))))
        controller.connect()
        assert (controller.identity.protocol_version, controller.identity.more[1:]) == (3, bytes([12, 27]))
        assert "inputs" not in capabilities_of(controller)
        assert controller.settings().given_of_inputs == []
        assert (controller.status().of_inputs, controller.status().axes[0].homing) == (None, None)
        assert only_rejection(lambda: controller.use_settings(StepRampSettings(inputs=())))[0] == "inputs"
        named = [{"axis": 0, "lowest_steps": 0}, {"axis": 1, "highest_steps": 0}]
        limits = StepRampSettings.checked({"soft_limits": named})
        field, given, allowed = only_rejection(lambda: controller.use_settings(limits))
        assert (field, given) == ("soft_limits", "2 limited axes")
        assert "keeps none" in allowed


def test_soft_limits_of_its_own(rig: Rig) -> None:
    limits = [{"axis": 1, "lowest_steps": -5}, {"axis": 0, "lowest_steps": -200, "highest_steps": 300}]
    rig.controller.use_settings(StepRampSettings.checked({"soft_limits": limits}))
    taken = rig.controller.settings()
    assert taken.inputs == StepRampSettings.checked({"inputs": ROLES}).inputs
    assert taken.soft_limits == StepRampSettings.checked({"soft_limits": limits}).soft_limits
    # They hold once the position is known.
    rig.controller.move_to(to(310))
    assert rig.rest().position_steps == 310
    rig.controller.set_position([*to(0), *to(0, 1)])
    beyond = [
        lambda: rig.controller.move_by(by(301)),
        lambda: rig.controller.move_to(to(301)),
        lambda: rig.controller.line([*by(301), *by(5, 1)]),
    ]
    for motion in beyond:
        with pytest.raises(Refused, match=r"beyond the highest position of axis 0 .*, 300 steps: nothing has moved"):
            motion()
    with pytest.raises(Refused, match=r"beyond the lowest position of axis 1 .*, -5 steps"):
        rig.controller.move_by([*by(1), *by(-6, 1)])
    for speed, end in ((700.0, 300), (-333.0, -200)):
        rig.controller.run(at(speed))
        axis = rig.rest()
        assert (axis.position_steps, axis.target_steps, axis.position_known) == (end, end, True)
        with pytest.raises(Refused, match=r"beyond the (highest|lowest) position of axis 0"):
            rig.controller.run(at(speed))
    # Whoever doesn't know of them takes none away; whoever does, may.
    rig.controller.use_settings(StepRampSettings(pulse_width_us=3))
    assert rig.controller.settings().soft_limits == taken.soft_limits
    rig.controller.use_settings(StepRampSettings(soft_limits=()))
    assert rig.controller.settings().soft_limits == ()
    rig.controller.use_settings(taken)
    rig.controller.roll_back()
    assert rig.controller.settings().soft_limits == ()


def test_steps_that_came_late(plug_in: PlugIn) -> None:
    require(*missing_compiler())
    with Driver(with_inputs=True) as driver:
        rig = Rig(FirmwareBoard(driver), plug_in)
        rig.controller.set_position([*to(0), *to(0, 1)])
        rig.controller.run(at(300.0))
        rig.go_on(300)
        driver.ask("late", 255)
        status = rig.go_on(100)
        assert status.activity is Activity.READY
        assert status.of_inputs is not None
        assert status.of_inputs.stopped_by == ("stepped_late",)
        assert status.trouble == (
            "Nothing moves: steps came late, which has stopped all axes, and motors may have lost some: no position is "
            "known. Acknowledge that first."
        )
        assert [axis.position_known for axis in status.axes] == [False, False]
        with pytest.raises(Refused, match=r"steps came late, which has stopped all axes, .* Acknowledge that first"):
            rig.controller.move_by(by(1))
        rig.controller.acknowledge()
        rig.controller.move_by(by(1))
        assert rig.rest().position_steps == status.axes[0].position_steps + 1


def test_gauges_take_no_inputs_whose_pins_are_theirs(rig: Rig) -> None:
    field, value, allowed = only_rejection(lambda: rig.controller.use_settings(StepRampSettings(outputs="gauges")))
    assert (field, value) == ("outputs", "gauges")
    assert "D9, the limit switch" in allowed
    asked = StepRampSettings.checked({"outputs": "gauges", "inputs": ROLES})
    field, value, allowed = only_rejection(lambda: rig.controller.use_settings(asked))
    assert (field, value) == ("inputs.2.input", "D9")
    assert "for the limit switch one of A0, A1, A2, A3, A4, A5: with gauges, D9 is a coil's pin" in allowed
    rig.controller.use_settings(StepRampSettings.checked({"outputs": "gauges", "inputs": ROLES[:2]}))


def test_an_emergency_stop_keeps_its_input_until_it_is_acknowledged(rig: Rig) -> None:
    rig.board.press("A0")
    rig.go_on(100)
    without = StepRampSettings.checked({"inputs": ROLES[1:]})
    for change in (lambda: rig.controller.use_settings(without), rig.controller.roll_back):
        with pytest.raises(Refused, match=r"the emergency stop at A0 is active. First release it, then acknowledge"):
            change()
    rig.controller.use_settings(StepRampSettings(pulse_width_us=4))
    rig.board.press()
    rig.go_on(100)
    with pytest.raises(Refused, match="Acknowledge that first"):
        rig.controller.use_settings(without)
    rig.controller.acknowledge()
    rig.controller.use_settings(without)
    assert rig.controller.settings().inputs == without.inputs
