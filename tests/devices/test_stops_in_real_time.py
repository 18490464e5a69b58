"""Stops of devices in real time, whatever they do."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest

from controllers.usb_board import UsbBoard
from designs import design
from devices.motion import LONG_MOVE, PATIENCE_S, by_steps, wait_for
from stepramp.controllers.stepramp.messages.status import AxisState
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.controllers.virtual.motor_state import state_of
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused


def test_halt_is_at_once(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.move_by(by_steps(LONG_MOVE))
    device.halt().result(PATIENCE_S)
    assert device.view.state is DeviceState.READY


def test_a_stop_gets_through_in_the_midst_of_a_push_and_the_push_goes_on(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    with ThreadPoolExecutor(1) as pool:
        pushing = pool.submit(device.push, [design()])
        wait_for(device, DeviceState.WRITING)
        device.stop().result(PATIENCE_S)
        assert device.view.state is DeviceState.WRITING
        assert not pushing.done()
        assert pushing.result(PATIENCE_S).verified


def test_a_move_that_waits_behind_a_push_does_not_begin_after_a_stop(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    with ThreadPoolExecutor(2) as pool:
        pushing = pool.submit(device.push, [design()])
        wait_for(device, DeviceState.WRITING)
        moving = pool.submit(device.move_by, by_steps(LONG_MOVE))
        while not device._attachment._contact.worker._waiting:
            time.sleep(0.001)
        device.stop().result(PATIENCE_S)
        with pytest.raises(Refused, match="A stop came first"):
            moving.result(PATIENCE_S)
        assert pushing.result(PATIENCE_S).verified
    assert device.view.position_steps == 0


def test_all_are_stopped_whatever_they_do(devices: Devices, plug_in: Callable) -> None:
    moving = [devices.connect(plug_in(VirtualController())) for _ in range(2)]
    for device in moving:
        device.push([design()])
        device.move_by(by_steps(LONG_MOVE))
    with UsbBoard() as board:
        lost = devices.connect(board.port)
        board.unplug()
        wait_for(lost, DeviceState.LOST)
    devices.stop_all()
    assert [device.view.state for device in moving] == [DeviceState.STOPPING] * 2
    assert lost.view.state is DeviceState.LOST


def test_the_end_of_the_program_stops_what_moves(plug_in: Callable) -> None:
    virtual, devices = VirtualController(), Devices()
    device = devices.connect(plug_in(virtual))
    device.push([design()])
    device.move_by(by_steps(LONG_MOVE))
    devices.close()
    assert state_of(virtual._machine._motors[0]) is not AxisState.MOVING
    assert virtual._machine._motors[0].position < LONG_MOVE
    assert devices.views() == []
    assert device.view.state is DeviceState.LOST
