"""Devices of several families: what only some controllers can do, and that none is taken for one of another family."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from controllers.plain_controller import PLAIN, NoWire, PlainController
from designs import design
from stepramp.controllers.capabilities import CAPABILITIES, HasSettings
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.families import FAMILIES, Family
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.device import Device
from stepramp.devices.homing import Homing
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.soft_limits import Span
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused, Rejected

BY = [AxisCommand(0, 5, "by_steps")]
AT_SERIAL_PORTS = [name for name in FAMILIES if name != "klipper"]
HOMING = Homing([AxisCommand(0, -9.0, "fast")], AxisCommand(0, 5.0, "slow"), 5, {0: 0})
ALL = ("keep", "try", "restore", "settings", "trace", "line", "zero", "inputs")


@pytest.fixture
def made() -> list[PlainController]:
    """Return the plain controllers that have been made, in that order."""
    return []


@pytest.fixture
def devices(made: list[PlainController]) -> Iterator[Devices]:
    def make(*asked: object) -> PlainController:
        made.append(PlainController(*asked))  # type: ignore[arg-type]
        return made[-1]

    devices = Devices(FAMILIES | {"plain": Family("plain", "Plain", NoWire, make)})
    yield devices
    devices.close()


@pytest.fixture
def plain(devices: Devices) -> Device:
    return devices.connect("at a plain wire", "plain")


def test_what_is_remembered_at_a_port_is_of_one_kind_of_controller() -> None:
    plain = Family("plain", "Plain", NoWire, PlainController)
    alike, other = (
        replace(plain, name="faster", same_as="plain"),
        replace(plain, name="other"),
    )
    devices = Devices({each.name: each for each in (plain, alike, other)})

    def connected(family: str) -> tuple[dict[int, Span], tuple[int, ...]]:
        device = devices.connect("at a plain wire", family)
        known = dict(device.view.soft_limits), device.view.unknown_positions
        devices.disconnect(device.view.id)
        return known

    device = devices.connect("at a plain wire", "plain")
    device.limit({0: Span(-10, 5)})
    devices.disconnect(device.view.id)
    assert connected("other") == ({}, ())
    assert connected("faster") == connected("plain") == ({0: Span(-10, 5)}, (0,))
    devices.close()


def test_a_device_is_given_its_connection_and_its_controller(plain: Device, made: list[PlainController]) -> None:
    assert [controller.connection.name for controller in made] == ["at a plain wire"]
    view = plain.view
    assert (view.family, view.capabilities, view.state) == ("plain", (), DeviceState.READY)
    assert (view.clocks_hz, view.timer_hz, view.starved, view.ramp) == ((), None, None, None)
    plain.move_by(BY)
    plain.stop().result()
    assert made[0].asked == ["move_by", "stop None"]
    assert plain.view.position_steps == 5


def test_what_a_controller_cant_tell_is_not_told(plain: Device) -> None:
    assert plain.view.firmware_version is None
    assert plain.preview_push([design()]).largest_deviation_us is None


def test_what_keeps_a_motor_from_moving_is_told_until_it_is_over(plain: Device, made: list[PlainController]) -> None:
    assert plain.view.message is None
    for trouble in ("Its emergency stop is pressed.", None):
        made[0].trouble = trouble
        plain.set_position([AxisCommand(0, 0, "position_steps")])
        assert (plain.view.message, plain.view.state) == (trouble, DeviceState.READY)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda device: device.push([design()]), "store ramps"),
        (lambda device: device.push([design()], mode="try"), "try ramps without storing them"),
        (Device.keep, "store ramps"),
        (Device.roll_back, "try ramps without storing them"),
        (Device.restore, "bring back the ramps that it had before"),
        (lambda device: device.settings_model, "be given settings"),
        (Device.settings, "be given settings"),
        (lambda device: device.use_settings(StepRampSettings()), "be given settings"),
        (Device.trace, "trace moves"),
        (lambda device: device.trace_moves(0, 1), "trace moves"),
        (lambda device: device.line(BY), "move axes along a straight line"),
        (lambda device: device.zero([0], 5), "zero gauges"),
        (Device.acknowledge, "tell of inputs, nor be homed from here"),
        (lambda device: device.home(HOMING, Lease({0: -9.0})), "tell of inputs, nor be homed from here"),
        (Device.backups, "be backed up"),
        (Device.back_up, "be backed up"),
        (Device.prove, "be started anew to prove what it has stored"),
        (lambda device: device.present_designs(design()), "tell settings that designs can be made of"),
    ],
)
def test_what_only_others_can_do_is_refused_in_plain_words(
    plain: Device, made: list[PlainController], ask: Callable[[Device], object], words: str
) -> None:
    told = f"{plain.view.name} can't {words}: no controller of its family, Plain, can."
    with pytest.raises(Refused, match=re.escape(told)):
        ask(plain)
    assert (made[0].asked, plain.view.state) == ([], DeviceState.READY)


def test_a_controller_of_ours_can_do_all(devices: Devices, plug_in: Callable) -> None:
    view = devices.connect(plug_in(VirtualController())).view
    assert (view.family, view.capabilities) == ("stepramp", ALL)
    assert tuple(each.name for each in CAPABILITIES) == (*ALL, "backup", "import", "prove")


def test_there_is_no_such_family(devices: Devices) -> None:
    with pytest.raises(Rejected) as caught:
        devices.connect("at a plain wire", "tick")
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value, rejection.allowed) == (
        "family",
        "tick",
        ", ".join([*AT_SERIAL_PORTS, "plain"]),
    )
    assert devices.views() == []


def test_a_device_is_not_taken_for_one_of_another_family(
    devices: Devices, plain: Device, made: list[PlainController]
) -> None:
    with pytest.raises(Refused, match="connected as one of the family Plain, not of StepRamp: disconnect it first"):
        devices.connect("at a plain wire")
    assert (devices.views(), len(made)) == ([plain.view], 1)
    devices.disconnect(plain.view.id)
    with pytest.raises(DeviceLost):
        devices.connect("at a plain wire")
    assert len(made) == 1


def test_what_was_lost_is_connected_again_as_one_of_its_family(
    devices: Devices, made: list[PlainController], tmp_path: Path
) -> None:
    port = tmp_path / "wire"
    device = devices.connect(str(port), "plain")

    def go() -> None:
        raise DeviceLost("It has gone.")

    made[0].status = go  # type: ignore[assignment, method-assign]
    with pytest.raises(DeviceLost):
        device.move_by(BY)
    assert device.view.state is DeviceState.LOST
    with pytest.raises(
        Refused,
        match=r"Device 1, \S+wire, was connected until it was lost, as one of the family Plain, not of StepRamp: disco",
    ):
        devices.connect(str(port))
    port.touch()
    assert device.reconnect()
    assert (device.view.state, device.view.family, len(made)) == (DeviceState.READY, "plain", 2)


def test_a_family_has_a_model_of_settings_if_its_controllers_have_settings() -> None:
    for family in [*FAMILIES.values(), PLAIN]:
        controller = family.make(NoWire("unopened", lambda: None), lambda _: None, lambda _: None)
        assert isinstance(controller, HasSettings) == (family.settings is not None)
