"""What is sent for each thing that is asked, byte for byte, with the answers of Marlin's documentation: none is left.

https://marlinfw.org/meta/gcode: G000-G001, G090, G091, M110, M114, M115, M201, M203, M204, M400, M410, M500-M503.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import reduce
from operator import xor

import pytest

from designs import design
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.errors import Refused
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

RESTS = "X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0\nok\n"
ENDSTOPS = "Reporting endstop status\nx_min: open\ny_min: open\nz_min: TRIGGERED\nok\n"
MARLIN = (
    "FIRMWARE_NAME:Marlin 2.0.9.3 (Jan  9 2022 14:20:55) SOURCE_CODE_URL:github.com/MarlinFirmware/Marlin "
    "PROTOCOL_VERSION:1.0 MACHINE_TYPE:3D Printer EXTRUDER_COUNT:1 UUID:cede2a2f-41a2-4748-9b12-c55c62f367ff\n"
    "Cap:SERIAL_XON_XOFF:0\nCap:EEPROM:1\nCap:EMERGENCY_PARSER:1\nok\n"
)
LISTING = (
    "echo:  G21    ; Units in mm (mm)\n\necho:Filament settings: Disabled\necho:  M200 D1.75\necho:Steps per unit:\n"
    "echo: M92 X80.00 Y80.00 Z400.00 E93.00\necho:Maximum feedrates (units/s):\n"
    "echo:  M203 X500.00 Y500.00 Z5.00 E25.00\necho:Maximum Acceleration (units/s2):\n"
    "echo:  M201 X500.00 Y500.00 Z100.00 E5000.00\n"
    "echo:Acceleration (units/s2): P<print_accel> R<retract_accel> T<travel_accel>\n"
    "echo:  M204 P500.00 R500.00 T1000.00\necho:Advanced: B<min_segment_time_us> S<min_feedrate> "
    "T<min_travel_feedrate> J<junc_dev>\necho:  M205 B20000.00 S0.00 T0.00 J0.01\nok\n"
)
SCALES = "echo:  M92 X80.00 Y80.00 Z400.00 E93.00\nok\n"
CONNECTING = [
    ("\nM115\n", "start\necho:Marlin 2.0.9.3\n" + MARLIN),
    ("M110 N0", None),
    ("M114", RESTS),
    ("M503", LISTING),
    ("M503", LISTING),
    ("M114", RESTS),
]


class Script:
    """A device that expects lines in an order, numbered, and answers each with what is set against it."""

    def __init__(self, *pairs: tuple) -> None:
        self.pairs, self._number = list(pairs), 0

    def opened(self) -> None:
        pass

    def exchange(self, sent: bytes) -> bytes:
        if not sent:
            return b""
        *number, expected, said = self.pairs.pop(0)
        self._number = number[0] if number else self._number
        if not expected.startswith("\n"):
            expected = f"N{self._number} {expected}"
            expected += f"*{reduce(xor, expected.encode())}\n"
            self._number += 1
        assert sent == expected.encode()
        return (said or "").encode()


Connect = Callable[..., MarlinController]


@pytest.fixture
def connect(plug_in: Callable[[VirtualDevice], str]) -> Iterator[Connect]:
    scripts: list[Script] = []

    def connected(*pairs: tuple) -> MarlinController:
        scripts.append(Script(*CONNECTING, *pairs))
        controller = MarlinController(SerialPort(plug_in(scripts[-1])))
        controller.connect()
        return controller

    yield connected
    assert [script.pairs for script in scripts] == [[]]


def test_connecting(connect: Connect) -> None:
    controller = connect()
    assert (controller.firmware_version, controller.most_axes) == ("2.0.9.3", 4)


def test_the_status(connect: Connect) -> None:
    axes = connect(("M114", "X:5.53 Y:0.56 Z:7.00 E:93.00 Count X:442 Y:45 Z:2800\nok P15 B3\n")).status().axes
    # 93 mm of the extruder at 93 steps/mm.
    assert [axis.position_steps for axis in axes] == [442, 45, 2800, 8649]


GOING = [
    ("M114", RESTS), ("M400", "ok\n"), ("M92", SCALES), ("G91", "ok\n"), ("G1 X10.00000 F60000", "ok\n"),
    ("G90", "ok\n"), ("M119", ENDSTOPS),
]  # fmt: skip


def test_a_move_and_a_stop(connect: Connect) -> None:
    controller = connect(
        *GOING,
        ("M114 R", "X:2.00 Y:0.00 Z:0.00 E:0.00 Count X:160 Y:0 Z:0\nok\n"),
        ("\nM410\n", ""),
        ("M114", "ok\nX:2.50 Y:0.00 Z:0.00 E:0.00 Count X:200 Y:0 Z:0\nok\n"),
        ("M400", "ok\n"),
        *[("M114", "X:2.50 Y:0.00 Z:0.00 E:0.00 Count X:200 Y:0 Z:0\nok\n")] * 3,
    )
    controller.move_to([AxisCommand(0, 800, "to_steps")])
    assert controller.status().axes[0].position_steps == 160
    controller.stop()
    assert controller.status().axes[0].position_steps == 200


def test_a_line_that_arrives_damaged(connect: Connect) -> None:
    """It is told again, with the same number, after the end of whatever has arrived of it."""
    controller = connect(
        *GOING[:3],
        ("G91", "Error:checksum mismatch, Last Line: 7\nResend: 8\nok\n"),
        ("\nN8 G91*25\n", "ok\n"),
        (9, *GOING[4]),
        *GOING[5:],
    )
    controller.move_to([AxisCommand(0, 800, "to_steps")])


RESTING = [("M114", RESTS), ("M400", "ok\n")]


def test_a_push(connect: Connect) -> None:
    kept = LISTING.replace("M203 X500.00", "M203 X12.50").replace("M201 X500.00", "M201 X62.00")
    controller = connect(
        *RESTING, ("M503", LISTING), ("M201 X62", "ok\n"), ("M203 X12.5", "ok\n"), ("M119", ENDSTOPS),
        ("M503", kept), ("M503", kept),
        ("M500", "echo:Settings Stored (622 bytes; crc 31234)\nok\n"), ("M119", ENDSTOPS),
        ("M501", "echo:V83 stored settings retrieved (622 bytes; crc 31234)\nok\n"), ("M119", ENDSTOPS), ("M503", kept),
    )  # fmt: skip
    report = controller.prepare_push([design()], 0)()
    assert (report.verified, report.kept) == (True, True)


def test_a_setting_that_is_not_known(connect: Connect) -> None:
    controller = connect(
        *RESTING,
        ("M503", LISTING),
        ("M201 X62", 'echo:Unknown command: "M201 X62"\nok\n'),
        ("M503", LISTING),
    )
    with pytest.raises(Refused, match="refuses 'M201 X62': it knows no such command"):
        controller.prepare_push([design()], 0)()


def test_a_backup(connect: Connect) -> None:
    controller = connect(*RESTING, *[("M115", MARLIN), ("M503", LISTING)] * 2)
    text = controller.backup().splitlines()
    assert text[0] == "; M115"
    assert "echo: M92 X80.00 Y80.00 Z400.00 E93.00" in text
