from collections.abc import Sequence
from pathlib import Path

import pytest
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from stepramp.link.ports import Port, find_again, known_port, list_serial_ports, location_of, port_name
from stepramp.link.remote_ports import RemotePorts


def found(
    device: str, description: str = "n/a", usb: tuple[int, int] | None = None, serial_number: str | None = None
) -> ListPortInfo:
    info = ListPortInfo(device, skip_link_detection=True)
    info.serial_number = serial_number
    info.description = description
    info.vid, info.pid = usb or (None, None)
    return info


@pytest.fixture(autouse=True)
def _attached(monkeypatch: pytest.MonkeyPatch) -> None:
    ports = [
        found("/dev/ttyUSB0", "USB Serial", (0x1A86, 0x7523)),
        found("/dev/ttyACM0", "ttyACM0", (0x2341, 0x0043)),
        found("/dev/ttyS0"),
        found("/dev/ttyUSB1", "Some board", (0x1234, 0x5678)),
        found("/dev/ttyUSB2", "n/a", (0x1234, 0x5678)),
        found("/dev/ttyUSB3", "Modem"),
    ]
    monkeypatch.setattr(list_ports, "comports", lambda: ports)


def test_ports_have_names_that_people_know_and_the_virtual_one_is_last() -> None:
    assert list_serial_ports() == [
        Port("/dev/ttyACM0", "Arduino Uno on ttyACM0"),
        Port("/dev/ttyUSB0", "CH340 adapter on ttyUSB0"),
        Port("/dev/ttyUSB1", "Some board on ttyUSB1"),
        Port("/dev/ttyUSB2", "ttyUSB2"),
        Port("/dev/ttyUSB3", "Modem on ttyUSB3"),
        Port("sim://", "Virtual (nothing attached)", virtual=True),
    ]


def test_half_a_surrogate_pair_in_what_a_board_says_of_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(list_ports, "comports", lambda: [found("COM3", "Board \ud800", (0x1234, 0x5678))])
    assert list_serial_ports()[0].name == "Board \\ud800 on COM3"


@pytest.mark.parametrize(
    ("port", "name"),
    [
        ("/dev/ttyACM0", "Arduino Uno on ttyACM0"),
        ("/dev/gone", "gone"),
        ("sim://", "Virtual controller"),
        ("socket://10.0.0.1:3000", "socket://10.0.0.1:3000"),
    ],
)
def test_the_name_of_a_port(port: str, name: str) -> None:
    assert port_name(port) == name


UNO = (0x2341, 0x0043)


def test_a_board_is_known_again_by_its_serial_number_wherever_it_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    attached = [found("/dev/ttyACM0", usb=UNO, serial_number="A1"), found("/dev/ttyACM1", usb=UNO, serial_number="B2")]
    monkeypatch.setattr(list_ports, "comports", lambda: attached)
    lost = known_port("/dev/ttyACM1")
    attached[:] = [found("/dev/ttyACM0", usb=UNO, serial_number="A1")]
    assert find_again(lost) is None
    attached.append(found("/dev/ttyACM2", usb=UNO, serial_number="B2"))
    assert find_again(lost) == "/dev/ttyACM2"


@pytest.mark.parametrize(("kind", "serial_number"), [(UNO, "A1"), ((0x10C4, 0xEA60), "0001")])
def test_a_serial_number_that_two_have_tells_neither(
    monkeypatch: pytest.MonkeyPatch, kind: tuple[int, int], serial_number: str
) -> None:
    """Cheap boards have the same one, and adapters with a CP210x that which its maker delivers."""
    attached = [found(f"/dev/ttyUSB{number}", usb=kind, serial_number=serial_number) for number in range(2)]
    monkeypatch.setattr(list_ports, "comports", lambda: attached)
    one, other = (known_port(f"/dev/ttyUSB{number}") for number in range(2))
    assert (one.identity, other.identity) == ("/dev/ttyUSB0", "/dev/ttyUSB1")
    gone = attached.pop(0)
    assert find_again(one) is None
    # By itself it has the number, and is found again all the same.
    assert find_again(other) == "/dev/ttyUSB1"
    alone = known_port("/dev/ttyUSB1")
    assert alone.is_board_of(other)
    assert other.is_board_of(alone)
    assert not alone.is_board_of(one)
    attached.append(gone)
    assert find_again(alone) == "/dev/ttyUSB1"
    attached.pop()
    if serial_number == "0001":
        assert known_port("/dev/ttyUSB1").identity == "/dev/ttyUSB1"


def test_a_board_without_a_serial_number_is_known_by_its_port_and_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    attached = [found("/dev/ttyUSB0", usb=(0x1A86, 0x7523))]
    monkeypatch.setattr(list_ports, "comports", lambda: attached)
    lost = known_port("/dev/ttyUSB0")
    assert find_again(lost) == "/dev/ttyUSB0"
    attached[:] = [found("/dev/ttyUSB0", usb=UNO), found("/dev/ttyUSB1", usb=(0x1A86, 0x7523))]
    assert find_again(lost) is None


@pytest.mark.parametrize(
    ("before", "now", "is_other"),
    [
        ((*UNO, "A1"), (*UNO, "B2"), True),
        ((*UNO, None), (0x1A86, 0x7523, None), True),
        ((*UNO, "A1"), (*UNO, "A1"), False),
        ((*UNO, None), (*UNO, None), False),
        # Another one with the same number is plugged in as well, or isn't any more; or nothing is known.
        ((*UNO, "A1"), (*UNO, None), False),
        ((*UNO, None), (*UNO, "A1"), False),
        ((*UNO, "A1"), None, False),
    ],
)
def test_another_board_is_told_by_its_kind_and_serial_number(
    before: tuple[int, int, str | None], now: tuple[int, int, str | None] | None, is_other: bool
) -> None:
    assert Port("p", "p", usb=now).is_other_than(Port("p", "p", usb=before)) == is_other


def test_a_link_to_a_port_is_known_as_what_is_plugged_in_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is owed to a board, or known of it, holds by whichever of its names it is connected."""
    port, link = tmp_path / "ttyACM0", tmp_path / "by-id"
    port.touch()
    link.symlink_to(port)
    attached = [found(str(port), usb=UNO, serial_number="A1")]
    monkeypatch.setattr(list_ports, "comports", lambda: attached)
    known = known_port(str(link))
    assert (known.port, known.identity) == (str(link), known_port(str(port)).identity)
    attached[:] = [found(str(port), usb=(0x1A86, 0x7523))]
    without_serial = known_port(str(link))
    assert find_again(without_serial) == str(link)
    attached[:] = []
    assert find_again(without_serial) is None


def test_what_else_can_come_back(tmp_path: Path) -> None:
    path = tmp_path / "pty"
    assert find_again(known_port(str(path))) is None
    path.touch()
    assert find_again(known_port(str(path))) == str(path)
    assert find_again(known_port("socket://127.0.0.1:3000")) == "socket://127.0.0.1:3000"
    assert find_again(known_port("sim://nobody-there")) is None


def test_all_names_of_a_port_have_one_place(tmp_path: Path) -> None:
    port, link = tmp_path / "ttyACM0", tmp_path / "by-id"
    port.touch()
    link.symlink_to(port)
    assert {location_of(str(name)) for name in (port, link, tmp_path / ".." / tmp_path.name / "by-id")} == {str(port)}
    for no_file in ("sim://a/../b", "socket://bad/../x", "\0"):
        assert location_of(no_file) == no_file


@pytest.mark.parametrize(
    ("names", "location"),
    [
        (("COM3", "com3", "\\\\.\\COM3"), "COM3"),
        (("/dev/cu.usbmodem1", "/dev/tty.usbmodem1"), "/dev/cu.usbmodem1"),
        (("/dev/ttyACM0",), "/dev/ttyACM0"),
    ],
)
def test_what_windows_and_macos_call_a_port_is_one_place(names: Sequence[str], location: str) -> None:
    assert {location_of(name) for name in names} == {location}


def test_all_addresses_of_a_host_and_number_are_one_place() -> None:
    alike = ("socket://[::1]:2217", "rfc2217://[::1]:2217", "rfc2217://[0:0:0:0:0:0:0:1]:02217")
    assert {location_of(each) for each in alike} == {"[::1]:2217"}
    assert {known_port(each).identity for each in alike} == {"[::1]:2217"}
    assert location_of("rfc2217://Printer.local:2217") == "printer.local:2217"


def test_ports_of_other_machines_are_listed_each_way_before_the_virtual_one() -> None:
    listed = list_serial_ports(RemotePorts.named(["printer.local:2217"]))
    assert [each.port for each in listed[-4:]] == [
        "rfc2217://printer.local:2217",
        "socket://printer.local:2217",
        "moonraker://printer.local:2217",
        "sim://",
    ]
    assert listed[-4].name == "printer.local:2217 on the network, RFC 2217"
    assert listed[-3].name == "printer.local:2217 on the network, bytes only"
    assert listed[-2].name == "printer.local:2217 on the network, Klipper's Moonraker"
