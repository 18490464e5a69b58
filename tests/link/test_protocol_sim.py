import time

import pytest

from stepramp.errors import DeviceLost
from stepramp.link import protocol_sim
from stepramp.link.serial_port import SerialPort
from waiting import PATIENCE_S


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


class Talkative:
    """Says something unasked, after a while."""

    def __init__(self) -> None:
        self.silent_until = float("inf")

    def opened(self) -> None:
        self.silent_until = time.monotonic() + 0.05

    def exchange(self, sent: bytes) -> bytes:
        if sent or time.monotonic() < self.silent_until:
            return sent
        self.silent_until = float("inf")
        return b"unasked"


def test_a_virtual_device_is_heard_unasked() -> None:
    protocol_sim.register("sim://talkative", Talkative())
    port = SerialPort("sim://talkative")
    assert port.pending() == b""
    began = time.monotonic()
    assert port.read(2 * PATIENCE_S) + port.pending() == b"unasked"
    assert time.monotonic() - began < PATIENCE_S
    port.write(b"hello")
    assert port.pending() == b"hello"
    assert port.pending() == b""
    port.close()


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
