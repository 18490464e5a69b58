"""Motions of devices in real time."""

from __future__ import annotations

import time

import numpy as np
import pytest

from controllers.usb_board import UsbBoard
from designs import design
from devices.motion import LONG_MOVE, PATIENCE_S, by_steps, wait_for
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.report import ReportRequest
from stepramp.controllers.stepramp.messages.status import StatusRequest
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused
from stepramp.ramp.move import play
from stepramp.ramp.plan import ramp_of


def test_push_move_stop(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    report = device.push([design()])
    assert report.verified
    assert device.view.pushed == report
    assert device.view.state is DeviceState.READY
    assert device.view.ramp is not None
    assert device.view.ramp.sequence == report.sequence == 1
    device.move_by(by_steps(LONG_MOVE))
    assert (device.view.state, device.view.target_steps) == (DeviceState.MOVING, LONG_MOVE)
    for refused in (lambda: device.push([design()]), lambda: devices.disconnect("1"), device.keep):
        with pytest.raises(Refused, match="The motor moves"):
            refused()
    device.stop().result(PATIENCE_S)
    assert device.view.state is DeviceState.STOPPING
    wait_for(device, DeviceState.READY)
    assert 0 < device.view.position_steps == device.view.target_steps < LONG_MOVE
    device.move_to(by_steps(0))
    wait_for(device, DeviceState.READY)
    assert device.view.position_steps == 0
    devices.disconnect("1")
    assert devices.views() == []


def test_four_axes(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    assert [axis.axis for axis in device.view.axes] == [0]
    device.push([design(), design(ramp__slew_speed_steps_per_s=500), design(), design()])
    device.move_by(by_steps(300, -200, 0, 50))
    assert [axis.state for axis in device.view.axes] == [DeviceState.MOVING] * 2 + [
        DeviceState.READY,
        DeviceState.MOVING,
    ]
    assert [axis.target_steps for axis in device.view.axes] == [300, -200, 0, 50]
    assert (device.view.state, device.view.target_steps) == (DeviceState.MOVING, 300)
    device.move_to([AxisCommand(1, 60, "axes.0.to_steps")])
    wait_for(device, DeviceState.READY)
    assert [axis.position_steps for axis in device.view.axes] == [300, 60, 0, 50]
    device.stop([0]).result(PATIENCE_S)
    device.run([AxisCommand(2, 400.0, "axes.0.speed_steps_per_s")], Lease({2: 400.0}, 60))
    device.halt([2]).result(PATIENCE_S)
    device.line([*by_steps(-30, 20), AxisCommand(3, 5, "axes.2.by_steps")])
    wait_for(device, DeviceState.READY)
    assert [device.view.axes[axis].position_steps for axis in (0, 1, 3)] == [270, 80, 55]
    device.set_position(by_steps(-7))
    assert device.view.position_steps == -7
    device.zero([0], 10)
    wait_for(device, DeviceState.READY)
    assert device.view.axes[0].position_steps == 0


def test_a_device_is_listened_to_while_it_moves(devices: Devices) -> None:
    with UsbBoard() as board:
        device = devices.connect(board.port)
        device.push([design()])
        device.move_by(by_steps(LONG_MOVE))
        positions = {device.view.position_steps}
        before = board.requests.count(StatusRequest.KIND)
        deadline = time.monotonic() + PATIENCE_S
        while len(positions) < 12 and time.monotonic() < deadline:
            positions.add(device.view.position_steps)
            time.sleep(0.002)
        assert len(positions) == 12
        # It tells by itself, far more often than it is asked.
        assert board.requests.count(StatusRequest.KIND) - before <= len(positions) / 2
        device.halt().result(PATIENCE_S)
        devices.disconnect("1")
    assert board.requests[-1] == ReportRequest.KIND


def test_a_trace(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design(), design()])
    with pytest.raises(Refused, match="No move has been traced"):
        device.trace()
    assert device.trace_moves(1, 0).every_steps == 1
    device.move_by(by_steps(50, -120))
    wait_for(device, DeviceState.READY)
    trace = device.trace()
    assert (trace.axis, trace.complete, trace.step.tolist()) == (1, True, list(range(1, 121)))
    assert np.abs(trace.deviation_us).max() == 0
    intervals = play(ramp_of(design()), 120)
    assert trace.planned_ticks.tolist() == [0, *np.cumsum(intervals)[:-1].tolist()]


def test_a_move_without_a_ramp_is_refused(devices: Devices, port: str) -> None:
    with pytest.raises(Refused, match="no ramp"):
        devices.connect(port).move_by(by_steps(1))
