"""Ports of other machines that misbehave: each ends in a message of its own, in time, and can be opened again."""

from __future__ import annotations

import queue
import socket
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext

import pytest
from serial.rfc2217 import PortManager

from link.far_host import (
    FarHost,
    Serve,
    closes,
    host_that_never_answers,
    resets,
    says,
    says_nothing,
    says_that_it_is_taken,
)
from link.test_telnet import FarPort
from stepramp.errors import DeviceLost
from stepramp.link.remote_ports import RemotePorts
from stepramp.link.serial_port import SerialPort
from waiting import PATIENCE_S

PROMISED_S = 5.0
"""After so long it is told that nothing is to be had of a port, by decision."""
AT_ONCE = "ends the connection at once: is the serial port there, and in use by nobody else"
NOT_RFC2217 = "doesn't speak RFC 2217. If it is a serial port all the same, it is reached as socket://"


def fails(port: str, host: str) -> str:
    began_s = time.monotonic()
    with pytest.raises(DeviceLost) as caught:
        SerialPort(port, remote_ports=RemotePorts.named([host]))
    assert time.monotonic() - began_s < PATIENCE_S
    return str(caught.value)


def test_why_a_port_of_another_machine_cant_be_opened_is_told() -> None:
    odd: list[tuple[str, Serve, str]] = [
        ("rfc2217", says_nothing, NOT_RFC2217),
        ("rfc2217", says(b"ok\r\n", 1.0), NOT_RFC2217),
        ("rfc2217", says(b"nonsense" * 1000, 0.008), NOT_RFC2217),
        ("rfc2217", says(b"\xff\xfb\x01\xff\xfd\x18\xff\xfa", 0.01), NOT_RFC2217),
        ("rfc2217", says(b"\xff\xfe\x2c", 0.01), "refuses to carry RFC 2217"),
    ]
    for serve in (closes, resets, says_that_it_is_taken):
        odd += [("rfc2217", serve, AT_ONCE), ("socket", serve, AT_ONCE)]

    def tried(scheme: str, serve: Serve, words: str) -> None:
        with FarHost(serve) as host:
            for _ in range(2):
                message = fails(f"{scheme}://{host.name}", host.name)
                assert host.name in message
                assert words in message

    with ThreadPoolExecutor(len(odd)) as pool:
        for each in [pool.submit(tried, *case) for case in odd]:
            each.result()


def test_a_host_that_never_answers_or_does_not_listen_is_told() -> None:
    with host_that_never_answers() as host:
        assert f"{host} can't be reached: is it on" in fails(f"socket://{host}", host)
    assert f"Nothing listens at {host}" in fails(f"rfc2217://{host}", host)


def read_for_ever(port: SerialPort) -> None:
    while True:
        port.read(1.0)


class Ser2net:
    """Serves one connection after the other by RFC 2217, and gives back what it is sent."""

    def __init__(self) -> None:
        self.ports: queue.Queue[FarPort] = queue.Queue()

    def __call__(self, connection: socket.socket, _: threading.Event) -> None:
        port = FarPort()
        self.ports.put(port)
        connection.sendall(port.says())
        while data := connection.recv(4096):
            through = port.hear(data)
            connection.sendall(port.says() + b"".join(PortManager.escape(port.server, through)))


def test_all_bytes_go_both_ways_by_rfc_2217() -> None:
    served = Ser2net()
    with FarHost(served) as host:
        for _ in range(2):
            port = host.open("rfc2217")
            assert served.ports.get(timeout=PATIENCE_S).baudrate == 115_200
            sent = bytes(range(256)) * 20
            port.write(sent)
            heard = b""
            while len(heard) < len(sent) and (more := port.read(PATIENCE_S)):
                heard += more
            assert heard == sent
            assert port.read(0.0) == port.pending() == b""
            port.close()


def test_what_is_said_last_gets_there() -> None:
    heard: queue.Queue[bytes] = queue.Queue()

    def listens(connection: socket.socket, _: threading.Event) -> None:
        data = b""
        while more := connection.recv(100):
            data += more
        heard.put(data)

    with FarHost(listens) as host:
        port = host.open("socket")
        port.write(b"farewell")
        port.close()
        port.close()
        assert heard.get(timeout=PATIENCE_S) == b"farewell"


def test_what_has_not_got_there_when_it_is_closed_never_does() -> None:
    """A motion that waits on the way must not set out when the network is back."""
    read_on = threading.Event()
    heard: queue.Queue[int] = queue.Queue()
    sent = 0

    def reads_late(connection: socket.socket, _: threading.Event) -> None:
        read_on.wait()
        count = 0
        try:
            while more := connection.recv(65_536):
                count += len(more)
        except ConnectionResetError:
            heard.put(count)

    def write_for_ever() -> None:
        nonlocal sent
        while True:
            port.write(bytes(1000))
            sent += 1000

    with FarHost(reads_late) as host:
        port = host.open("socket")
        with pytest.raises(DeviceLost, match="takes nothing more: what is there doesn't read"):
            write_for_ever()
        port.close()
        read_on.set()
        assert heard.get(timeout=PATIENCE_S) < sent


@pytest.mark.parametrize("ends", [closes, resets])
def test_a_connection_that_ends_is_a_lost_device(ends: Serve) -> None:
    begun = threading.Event()

    def ends_later(connection: socket.socket, ended: threading.Event) -> None:
        begun.wait()
        connection.sendall(b"said before")
        ends(connection, ended)

    with FarHost(ends_later) as host:
        port = host.open("socket")
        begun.set()
        with pytest.raises(DeviceLost, match=f"Port socket://{host.name} is gone: the connection has ended"):
            read_for_ever(port)
        with pytest.raises(DeviceLost):
            port.pending()
        port.close()


def test_a_host_that_is_gone_without_a_word_is_asked_whether_it_is_there() -> None:
    with FarHost(says_nothing) as host:
        port = host.open("socket")
        line = port._serial._socket
        assert line.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        for option in ("TCP_KEEPIDLE", "TCP_KEEPINTVL", "TCP_KEEPCNT"):
            if hasattr(socket, option):
                assert line.getsockopt(socket.IPPROTO_TCP, getattr(socket, option)) <= PROMISED_S
        port.close()


def test_a_port_is_opened_that_another_connection_still_has_for_a_moment() -> None:
    connections = iter([closes, closes, says_nothing])

    def serve(connection: socket.socket, ended: threading.Event) -> None:
        next(connections)(connection, ended)

    with FarHost(serve) as host:
        host.open("socket").close()


def test_what_a_port_says_at_once_is_heard() -> None:
    with FarHost(says(b"hello", 0.001)) as host, nullcontext(host.open("socket")) as port:
        assert port.read(PATIENCE_S).startswith(b"hello")
        port.close()
