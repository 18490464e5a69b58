"""What is sent for each thing that is asked, byte for byte, with the answers of grbl's documentation: nothing is left.

https://github.com/gnea/grbl/wiki: Interface, Commands, Configuration, Jogging.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from designs import design
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.grbl import conversation
from stepramp.controllers.grbl.controller import GrblController
from stepramp.errors import Refused
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

IDLE = "<Idle|MPos:5.529,0.560,7.000|FS:0,0|WCO:0.000,1.551,5.664>\r\n"
JOGS = "<Jog|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n"
RESTS = "<Idle|MPos:0.000,0.000,0.000|FS:0,0|Ov:100,100,100>\r\n"
LISTING = (
    "$0=10\r\n$1=25\r\n$10=1\r\n$11=0.010\r\n$13=0\r\n$20=0\r\n$22=0\r\n$100=250.000\r\n$101=250.000\r\n$102=250.000\r\n"
    "$110=500.000\r\n$111=500.000\r\n$112=500.000\r\n$120=10.000\r\n$121=10.000\r\n$122=10.000\r\n$130=200.000\r\n"
    "$131=200.000\r\n$132=200.000\r\nok\r\n"
)
STARTUP = "$N0=\r\n$N1=\r\nok\r\n"
BANNER = "\r\nGrbl 1.1h ['$' for help]\r\n"
CONNECTING = [
    ("?", BANNER),
    ("?", RESTS),
    ("$I\n", "[VER:1.1h.20190830:Some string]\r\n[OPT:V,15,128]\r\nok\r\n"),
    ("$$\n", LISTING),
    ("$N\n", STARTUP),
    ("?", RESTS),
]


class Script:
    """A device that expects what is sent in an order, and answers each with what is set against it."""

    def __init__(self, *pairs: tuple[str, str]) -> None:
        self.pairs = [(sent.encode("latin-1"), said.encode()) for sent, said in pairs]

    def opened(self) -> None:
        pass

    def exchange(self, sent: bytes) -> bytes:
        if not sent:
            return b""
        expected, said = self.pairs.pop(0)
        assert sent == expected
        return said


Connect = Callable[..., GrblController]


@pytest.fixture
def connect(plug_in: Callable[[VirtualDevice], str], monkeypatch: pytest.MonkeyPatch) -> Iterator[Connect]:
    monkeypatch.setattr(conversation, "KNOCK_S", 0.02)
    scripts: list[Script] = []

    def connected(*pairs: tuple[str, str]) -> GrblController:
        scripts.append(Script(*CONNECTING, *pairs))
        controller = GrblController(SerialPort(plug_in(scripts[-1])))
        controller.connect()
        return controller

    yield connected
    assert [script.pairs for script in scripts] == [[]]


def test_connecting(connect: Connect) -> None:
    assert connect().firmware_version == "1.1h"


def test_the_status(connect: Connect) -> None:
    axes = connect(("?", IDLE)).status().axes
    # 5.529 mm, 0.56 mm and 7 mm at 250 steps/mm.
    assert [axis.position_steps for axis in axes] == [1382, 140, 1750]


def test_a_jog_and_its_end(connect: Connect) -> None:
    controller = connect(
        ("?", RESTS), ("?", RESTS), ("$$\n", LISTING), ("$J=G53G21G90X10.000000F500\n", "ok\r\n"),
        ("\x85", ""), ("\x85", ""), ("?", JOGS), ("\x85", ""), ("?", RESTS), ("?", RESTS),
    )  # fmt: skip
    controller.move_to([AxisCommand(0, 2500, "to_steps")])
    controller.stop()
    assert controller.status().axes[0].target_steps == 0


def test_a_halt(connect: Connect) -> None:
    controller = connect(
        ("?", JOGS),
        ("\x18", "ALARM:3\r\n" + BANNER + "[MSG:'$H'|'$X' to unlock]\r\n"),
        ("?", "<Alarm|MPos:1.000,0.000,0.000|FS:0,0>\r\n"),
    )
    controller.halt()


def test_a_push(connect: Connect) -> None:
    kept = LISTING.replace("$120=10.000", "$120=20.000").replace("$110=500.000", "$110=240.000")
    controller = connect(
        ("?", RESTS), ("$$\n", LISTING), ("$N\n", STARTUP), ("?", RESTS),
        ("$110=240.000\n", "ok\r\n"), ("$120=20.000\n", "ok\r\n"), ("$$\n", kept), ("$N\n", STARTUP),
        ("?", RESTS),
    )  # fmt: skip
    assert controller.prepare_push([design()], 0)().verified


def test_a_setting_that_is_refused(connect: Connect) -> None:
    controller = connect(
        ("?", RESTS), ("$$\n", LISTING), ("$N\n", STARTUP), ("?", RESTS),
        ("$110=240.000\n", "error:8\r\n"), ("$$\n", LISTING), ("$N\n", STARTUP), ("?", RESTS)
    )  # fmt: skip
    with pytest.raises(Refused, match=r"refuses '\$110=240.000': it takes that only at rest \(error:8\)"):
        controller.prepare_push([design()], 0)()


def test_a_backup(connect: Connect) -> None:
    places = "[G54:4.000,0.000,0.000]\r\n[G28:1.000,2.000,0.000]\r\n[TLO:0.000]\r\n[PRB:0.000,0.000,0.000:0]\r\nok\r\n"
    controller = connect(
        ("?", RESTS), ("$I\n", "[VER:1.1h.20190830:]\r\nok\r\n"), ("$$\n", LISTING), ("$#\n", places),
        ("$#\n", places), ("$N\n", STARTUP),
    )  # fmt: skip
    text = controller.backup()
    assert text.splitlines()[:3] == ["; $I", "[VER:1.1h.20190830:]", "; $$"]
    assert "[G54:4.000,0.000,0.000]" in text


def test_locked_and_unlocked_by_saying_where_it_is(connect: Connect) -> None:
    controller = connect(
        ("?", "<Alarm|MPos:0.000,0.000,0.000|FS:0,0>\r\n"),
        ("$X\n", "[MSG:Caution: Unlocked]\r\nok\r\n"),
        ("?", RESTS),
    )
    controller.set_position([AxisCommand(0, 40, "position_steps")])
