"""What is sent for each thing that is asked, word for word, with answers as Moonraker's documentation has them.

https://moonraker.readthedocs.io/en/latest/external_api: server, printer, printer_objects. Nothing is left over.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from controllers.klipper.bench import by
from designs import design
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.controllers.klipper.seen import OBJECTS
from stepramp.errors import Refused
from stepramp.link.moonraker_port import Reply

SERVER_INFO = {
    "klippy_connected": True,
    "klippy_state": "ready",
    "components": ["database", "file_manager", "klippy_apis", "machine", "data_store"],
    "failed_components": [],
    "registered_directories": ["config", "gcodes", "config_examples", "docs"],
    "warnings": ["Invalid config option 'api_key_path' detected in section [authorization]."],
    "websocket_count": 2,
    "moonraker_version": "v0.7.1-105-ge4f103c",
    "api_version": [1, 4, 0],
    "api_version_string": "1.4.0",
}
PRINTER_INFO = {
    "state": "ready",
    "state_message": "Printer is ready",
    "hostname": "pi-debugger",
    "klipper_path": "/home/pi/klipper",
    "process_id": 275124,
    "log_file": "/home/pi/printer_data/logs/klippy.log",
    "config_file": "/home/pi/printer_data/config/printer.cfg",
    "software_version": "v0.12.0-85-gd785b396",
    "cpu_info": "4 core ?",
}
ROOTS = [
    {"name": "config", "path": "/home/pi/printer_data/config", "permissions": "rw"},
    {"name": "logs", "path": "/home/pi/printer_data/logs", "permissions": "r"},
]
CONFIG = {
    "mcu": {"serial": "/dev/serial/by-id/usb"},
    "exclude_object": {},
    "printer": {
        "kinematics": "cartesian",
        "max_velocity": "300",
        "max_accel": "1500",
        "max_z_velocity": "15",
        "max_z_accel": "200",
    },
    "stepper_x": {"microsteps": "16", "rotation_distance": "32", "position_min": "0", "position_max": "250"},
    "stepper_y": {"microsteps": "16", "rotation_distance": "32", "position_min": "-4", "position_max": "210"},
    "stepper_z": {"microsteps": "16", "rotation_distance": "8", "position_min": "-2", "position_max": "220"},
}


def status(x: float = 0.0, velocity: float = 300, accel: float = 1500, **of_toolhead: Any) -> dict[str, Any]:
    toolhead = {
        "homed_axes": "xyz",
        "axis_minimum": [0, -4, -2, 0],
        "axis_maximum": [250, 210, 220, 0],
        "position": [x, 0, 0, 0],
        "max_velocity": velocity,
        "max_accel": accel,
        "minimum_cruise_ratio": 0.5,
        "square_corner_velocity": 5,
    }
    return {
        "eventtime": 578243.57824499,
        "status": {
            "webhooks": {"state": "ready", "state_message": "Printer is ready"},
            "toolhead": toolhead | of_toolhead,
            "motion_report": {"live_position": [x, 0, 0, 0], "live_velocity": 0},
            "print_stats": {"state": "standby"},
            "idle_timeout": {"state": "Ready"},
            "virtual_sdcard": {"is_active": False},
            "stepper_enable": {"steppers": {"stepper_x": True}},
            "configfile": {"save_config_pending": False},
        },
    }


LOOK = ("printer.objects.query", {"objects": OBJECTS})
CONNECTING: list[tuple[str, dict[str, Any] | None, Any]] = [
    ("server.info", None, SERVER_INFO),
    ("printer.info", None, PRINTER_INFO),
    ("server.files.roots", None, ROOTS),
    (
        "printer.objects.query",
        {"objects": {"configfile": ["config"]}},
        {"eventtime": 1.0, "status": {"configfile": {"config": CONFIG}}},
    ),
    ("printer.objects.subscribe", {"objects": OBJECTS}, status()),
]


class Script:
    """A port at which requests are expected in an order; each is answered with what is set against it."""

    name = "moonraker://printer:7125"

    def __init__(self, *pairs: tuple[str, dict[str, Any] | None, Any]) -> None:
        self.pairs = list(pairs)
        self._said: list[bytes] = []
        self._last = 0

    def write(self, data: bytes) -> None:
        method, params, result = self.pairs.pop(0)
        self._last += 1
        expected = {"jsonrpc": "2.0", "method": method, "id": self._last} | (
            {} if params is None else {"params": params}
        )
        assert json.loads(data) == expected
        answer = result if isinstance(result, dict) and "error" in result else {"result": result}
        self._said.append(json.dumps({"jsonrpc": "2.0", "id": self._last} | answer).encode())

    def read(self, _: float) -> bytes:
        return self._said.pop(0) if self._said else b""

    def pending(self) -> bytes:
        return self.read(0.0)

    def close(self) -> None:
        pass

    def request(self, *_: object) -> Reply:
        raise AssertionError


def script(text: str, result: Any = "ok") -> tuple[str, dict[str, Any], Any]:
    return "printer.gcode.script", {"script": text}, result


def connected(*pairs: tuple[str, dict[str, Any] | None, Any]) -> tuple[KlipperController, Script]:
    port = Script(*CONNECTING, *pairs)
    controller = KlipperController(port, lambda _: None)
    controller.connect()
    return controller, port


def test_connecting() -> None:
    controller, port = connected((*LOOK, status(12.5)))
    found = controller.status()
    assert [axis.steps_per_mm for axis in found.axes] == [100, 100, 400]
    assert found.axes[0].position_steps == 1250
    assert port.pairs == []


def test_trying_a_design() -> None:
    # 1000 steps/s and 5000 steps/s² at 100 steps/mm.
    controller, port = connected(
        (*LOOK, status()),
        script("SET_VELOCITY_LIMIT ACCEL=50"),
        script("SET_VELOCITY_LIMIT VELOCITY=10"),
        (*LOOK, status(velocity=10.0, accel=50.0)),
    )
    assert controller.prepare_push([design()], 0, "try")().verified
    assert port.pairs == []


def test_a_move_and_the_emergency_stop() -> None:
    told = "SAVE_GCODE_STATE NAME=stepramp\nM220 S100\nG91\nG1 X-12.500000000 F18000.000000000\n"
    controller, port = connected(
        (*LOOK, status(50.0)),
        script(f"{told}RESTORE_GCODE_STATE NAME=stepramp"),
        (*LOOK, status(50.0, position=[37.5, 0, 0, 0])),
        ("printer.emergency_stop", None, "ok"),
        (*LOOK, {"status": {"webhooks": {"state": "shutdown", "state_message": "Shutdown due to webhooks request"}}}),
    )
    controller.move_by([by(-1250)])
    controller.halt()
    assert port.pairs == []


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            {"code": 400, "message": "Must home axis first: 0.000 0.000 0.000 [0.000]"},
            "says: Must home axis first: 0.000",
        ),
        ({"code": 503, "message": "Klippy Host not connected"}, "says: Klippy Host not connected."),
    ],
)
def test_a_move_that_is_refused(error: dict[str, Any], words: str) -> None:
    told = "SAVE_GCODE_STATE NAME=stepramp\nM220 S100\nG91\nG1 X1.000000000 F18000.000000000\n"
    put_back = "RESTORE_GCODE_STATE NAME=stepramp"
    controller, port = connected(
        (*LOOK, status()), script(f"{told}{put_back}", {"error": error}), script(put_back, {"error": error})
    )
    with pytest.raises(Refused, match=words):
        controller.move_by([by(100)])
    assert port.pairs == []
