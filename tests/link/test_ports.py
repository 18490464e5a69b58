import pytest
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from stepramp.link.ports import Port, list_serial_ports, port_name


def found(device: str, description: str = "n/a", usb: tuple[int, int] | None = None) -> ListPortInfo:
    info = ListPortInfo(device, skip_link_detection=True)
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
        Port("sim://", "Virtual controller (nothing attached)", virtual=True),
    ]


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
