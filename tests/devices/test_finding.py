"""Which family a controller is of, by what it says as it starts: it is listened to, and told nothing."""

from __future__ import annotations

import termios
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from devices.odd_device import OddDevice
from devices.test_odd_devices import ODD
from stepramp.devices.registry import Devices
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.serial_port import SerialPort
from waiting import PATIENCE_S

# As their makers print them: grbl's and grblHAL's wikis, FluidNC's wiki, Marlin's source of what it says at its start.
BANNERS = {
    "grbl": b"\r\nGrbl 1.1h ['$' for help]\r\n",
    "grblHAL": b"\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n",
    "FluidNC": b"ets Jul 29 2019\r\n[MSG:INFO: FluidNC v3.7.8]\r\nGrbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]\r\n",
    "Marlin": b"start\r\nMarlin 2.1.2.1\r\n\r\necho: Last Updated: 2022-12-31\r\n",
    "an older Marlin": b"start\r\necho: Marlin 1.1.9\r\n",
}


class Listener(OddDevice):
    """Says something over and over, and notes what it is told."""

    def __init__(self, says: bytes) -> None:
        self.told = b""
        super().__init__(self._note, says, 0.2)

    def _note(self, heard: bytes) -> bytes:
        self.told += heard
        return b""


class AtQuarterMegabaud(Listener):
    """What is heard of it at another rate is noise."""

    def _say(self, data: bytes) -> None:
        rate = termios.tcgetattr(self._near_end)[5]
        # Python has no name for a rate of 250,000: it is one of those that stand elsewhere.
        super()._say(bytes(255 - each for each in data) if rate == termios.B115200 else data)


@pytest.mark.parametrize(
    ("says", "family", "line"),
    [
        (BANNERS["grbl"], "grbl", "Grbl 1.1h ['$' for help]"),
        (BANNERS["grblHAL"], "grbl", "GrblHAL 1.1f ['$' or '$HELP' for help]"),
        (BANNERS["FluidNC"], "fluidnc", "Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]"),
        (BANNERS["Marlin"], "marlin", "Marlin 2.1.2.1"),
        (BANNERS["an older Marlin"], "marlin", "echo: Marlin 1.1.9"),
    ],
    ids=BANNERS,
)
def test_a_controller_that_names_itself_is_found_and_told_nothing(says: bytes, family: str, line: str) -> None:
    devices = Devices()
    with Listener(says) as board:
        found = devices.find_family(board.port)
        assert (found.family, found.heard) == (family, [line])
        assert board.told == b""
        SerialPort(board.port).close()
    assert devices.views() == []
    devices.close()


def test_one_that_talks_at_another_rate_is_found_there() -> None:
    devices = Devices()
    with AtQuarterMegabaud(BANNERS["Marlin"]) as board:
        assert devices.find_family(board.port).family == "marlin_250000"
        assert board.told == b""
    devices.close()


def test_what_names_no_family_is_told_and_leaves_its_port_usable() -> None:
    devices = Devices()

    def tried(name: str) -> None:
        with ODD[name]() as odd:
            began_s = time.monotonic()
            found = devices.find_family(odd.port)
            assert time.monotonic() - began_s < PATIENCE_S, name
            # What it only says to what it is told isn't heard: it is told nothing.
            assert (found.family, found.heard) == (None, []), name
            SerialPort(odd.port).close()

    with ThreadPoolExecutor(4) as pool:
        for each in [pool.submit(tried, name) for name in ODD]:
            each.result()
    devices.close()


def test_what_another_firmware_says_is_told() -> None:
    devices = Devices()
    with Listener(b"\x80\x81\r\nRepRapFirmware 3.4.5\r\n") as board:
        found = devices.find_family(board.port)
        assert (found.family, set(found.heard)) == (None, {"RepRapFirmware 3.4.5"})
    devices.close()


def test_where_none_can_be_found_the_reason_is_told() -> None:
    devices = Devices()
    with pytest.raises(Refused, match="No family that can be at sim:// says what it is before it is asked"):
        devices.find_family("sim://")
    with pytest.raises(DeviceLost, match="There is no port /dev/none: is it plugged in"):
        devices.find_family("/dev/none")
    with pytest.raises(Rejected):
        devices.find_family("rfc2217://nowhere:1")
    devices.connect("sim://")
    with pytest.raises(Refused, match="connected as one of the family StepRamp: disconnect it first"):
        devices.find_family("sim://")
    devices.close()
