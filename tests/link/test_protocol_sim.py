import pytest

from stepramp.errors import DeviceLost
from stepramp.link import protocol_sim
from stepramp.link.serial_port import SerialPort


class Echo:
    """Answers what it gets, and goes when it gets `bye`."""

    def __init__(self) -> None:
        self.resets = 0

    def opened(self) -> None:
        self.resets += 1

    def exchange(self, sent: bytes) -> bytes:
        if sent == b"bye":
            raise OSError("unplugged")
        return sent


def test_a_virtual_device_answers_and_is_reset_by_opening() -> None:
    echo = Echo()
    protocol_sim.register("sim://echo", echo)
    assert protocol_sim.registered("sim://echo")
    for resets in (1, 2):
        port = SerialPort("sim://echo")
        assert echo.resets == resets
        port.write(b"hello")
        assert port.read(1.0) == b"hello"
        assert port.read(0.0) == b""
        port.close()


def test_a_virtual_port_is_as_exclusive_as_a_real_one() -> None:
    protocol_sim.register("sim://alone", Echo())
    port = SerialPort("sim://alone")
    with pytest.raises(DeviceLost, match="in use"):
        SerialPort("sim://alone")
    port.close()
    SerialPort("sim://alone").close()


def test_a_virtual_device_can_go() -> None:
    protocol_sim.register("sim://going", Echo())
    port = SerialPort("sim://going")
    with pytest.raises(DeviceLost, match="unplugged"):
        port.write(b"bye")
    port.close()


def test_nothing_registered_there() -> None:
    assert not protocol_sim.registered("sim://nobody")
    with pytest.raises(DeviceLost, match="no virtual device"):
        SerialPort("sim://nobody")
