from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from controllers.conformance.answers import LONG_MOVE, TOLERANCE_US
from designs import document
from simulator.avr import SimulatedController, build_firmware, missing_tools
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.design import Design
from stepramp.errors import Refused, Rejected
from stepramp.link.serial_port import SerialPort
from stepramp.ramp.move import play
from stepramp.ramp.plan import ramp_of
from tools import require


def controller_at(port: str) -> tuple[StepRampController, SerialPort]:
    serial_port = SerialPort(port)
    controller = StepRampController(serial_port)
    controller.connect()
    return controller, serial_port


def test_the_client_pushes_and_moves(port: str) -> None:
    controller, serial_port = controller_at(port)
    designs = [Design.checked(document(ramp__deceleration_steps_per_s2=2500)), Design.checked(document())]
    report = controller.prepare_push(designs)()
    assert report.verified
    assert report.largest_deviation_us <= 0.5
    controller.move_by([AxisCommand(0, LONG_MOVE, "by_steps"), AxisCommand(1, -50, "by_steps")])
    with pytest.raises(Refused, match="moves"):
        controller.prepare_push(designs)()
    controller.halt()
    with pytest.raises(Rejected):
        controller.move_by([AxisCommand(0, 2**31 - 1, "by_steps")])
    serial_port.close()


def test_the_client_traces_a_move_against_its_plan(port: str) -> None:
    controller, serial_port = controller_at(port)
    design = Design.checked(document())
    controller.prepare_push([design])()
    every = controller.trace_moves(0, 0).every_steps
    controller.move_by([AxisCommand(0, 300, "by_steps")])
    deadline = time.monotonic() + 10
    while (work_out := controller.trace) is None or not (trace := work_out()).complete:
        assert time.monotonic() < deadline
        controller.listen()
        time.sleep(0.02)
    instants = np.concatenate(([0], np.cumsum(play(ramp_of(design), 300))))[:-1]
    assert trace.step.tolist() == list(range(1, 301, every))
    assert np.array_equal(trace.planned_ticks, instants[trace.step - 1])
    assert np.abs(trace.deviation_us).max() <= TOLERANCE_US
    serial_port.close()


@pytest.mark.parametrize("method", ["first_order", "compromise", "newton"])
def test_a_ramp_by_formula_moves_to_its_targets(port: str, method: str) -> None:
    controller, serial_port = controller_at(port)
    design = Design.checked(document(method__name=method, method__arithmetic="fixed"))
    report = controller.prepare_push([design])()
    assert (report.verified, report.segments, report.largest_deviation_us) == (True, 0, 0)
    for target in (1, 2, 30, -77, 200, 400, 0):
        controller.move_to([AxisCommand(0, target, "to_steps")])
        deadline = time.monotonic() + 10
        while (status := controller.status().axes[0]).activity != "ready":
            assert time.monotonic() < deadline
        assert status.position_steps == target
    serial_port.close()


def test_a_board_that_resets_when_its_port_is_opened(tmp_path: Path) -> None:
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path, boot_ms=1000) as simulated:
        controller, serial_port = controller_at(simulated.port)
        assert controller.status().axes[0].position_steps == 0
        serial_port.close()
