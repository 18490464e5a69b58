"""Telnet and RFC 2217, against pyserial's own server side, and however the bytes are cut."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from serial.rfc2217 import PortManager

from stepramp.link.telnet import Telnet


class FarPort:
    """A serial port as pyserial's server sets one; what the server says is kept until it is asked for."""

    def __init__(self) -> None:
        self.baudrate, self.bytesize, self.parity, self.stopbits = 9600, 7, "E", 2
        self.xonxoff = self.rtscts = True
        self.dtr = self.rts = False
        self.cts = self.dsr = self.ri = self.cd = False
        self.purged = 0
        self.said = b""
        self.server = PortManager(self, self)

    def write(self, data: bytes) -> None:
        self.said += data

    def reset_input_buffer(self) -> None:
        self.purged += 1

    def reset_output_buffer(self) -> None:
        self.purged += 1

    def hear(self, data: bytes) -> bytes:
        """Return what of it is for the device."""
        return b"".join(self.server.filter(data))

    def says(self) -> bytes:
        said, self.said = self.said, b""
        return said


def agreed(telnet: Telnet, far: FarPort, piece: int = 1000) -> bytes:
    """Let both talk until neither says anything; return what got through to the device."""
    through, said = far.hear(telnet.opening()), far.says()
    while said:
        for at in range(0, len(said), piece):
            carried, answer = telnet.feed(said[at : at + piece])
            assert carried == b""
            through += far.hear(answer)
        said = far.says()
    return through


@pytest.mark.parametrize("piece", [1, 2, 3, 1000])
def test_the_far_port_is_set_as_one_here_would_be(piece: int) -> None:
    telnet, far = Telnet(115_200), FarPort()
    assert not telnet.is_ready
    assert agreed(telnet, far, piece) == b""
    assert telnet.is_ready
    assert telnet.trouble is None
    assert (far.baudrate, far.bytesize, far.parity, far.stopbits) == (115_200, 8, "N", 1)
    assert (far.xonxoff, far.rtscts, far.dtr, far.rts, far.purged) == (False, False, True, True, 2)


@given(data=st.binary(max_size=300), baud_rate=st.sampled_from([9_600, 115_200, 0xFF00FF]))
def test_every_byte_gets_there_and_back(data: bytes, baud_rate: int) -> None:
    telnet, far = Telnet(baud_rate), FarPort()
    agreed(telnet, far)
    assert far.baudrate == baud_rate
    assert far.hear(telnet.escaped(data)) == data
    assert telnet.feed(b"".join(far.server.escape(data))) == (data, b"")


COMMANDS = [b"\xff", b"\xff\xff", b"\xff\xfa\x2c", b"\xff\xf0", b"\xff\xfd\x2c", b"\xff\xfb\x01"]
telnet_bytes = st.lists(st.one_of(st.binary(max_size=4), st.sampled_from(COMMANDS))).map(b"".join)


@given(data=telnet_bytes, cuts=st.lists(st.integers(0, 400)), long=st.integers(0, 600))
def test_however_it_is_cut_it_is_the_same(data: bytes, cuts: list[int], long: int) -> None:
    data += b"\xff\xfa" + b"x" * long + b"\xff\xf0end"
    whole, pieces = Telnet(9_600), Telnet(9_600)
    carried, answer = whole.feed(data)
    ends = sorted({min(each, len(data)) for each in cuts} | {0, len(data)})
    fed = [pieces.feed(data[begin:end]) for begin, end in pairwise(ends)]
    assert b"".join(each for each, _ in fed) == carried
    assert b"".join(each for _, each in fed) == answer


@pytest.mark.parametrize(
    ("said", "trouble"),
    [
        (b"\xff\xfe\x2c", "refuses to carry RFC 2217"),
        (b"\xff\xfe\x00", "refuses to carry all bytes as they are"),
        (b"\xff\xfc\x00", "refuses to carry all bytes as they are"),
        (b"\xff\xfa\x2c\x65\x00\x00\x25\x80\xff\xf0", "sets its port to 9,600 baud, not to 115,200"),
        (b"\xff\xfa\x2c\x66\x07\xff\xf0", "doesn't set its port to 8 data bits, no parity and 1 stop bit"),
    ],
)
def test_what_a_server_cant_do_is_told(said: bytes, trouble: str) -> None:
    telnet = Telnet(115_200)
    telnet.feed(said)
    assert trouble in (telnet.trouble or "")
    assert not telnet.is_ready


def test_an_offer_is_answered_once_however_often_it_is_made() -> None:
    telnet = Telnet(9_600)
    assert telnet.feed(b"\xff\xfb\x01" * 1000) == (b"", b"\xff\xfe\x01")
    assert telnet.feed(b"\xff\xfd\x18" * 1000) == (b"", b"\xff\xfc\x18")


def test_what_is_said_without_an_end_is_not_kept() -> None:
    telnet = Telnet(9_600)
    for _ in range(1000):
        telnet.feed(b"\xff\xfa" + b"x" * 1000)
    assert len(telnet._rest) < 300
