"""A connection to a serial port of another machine, with those methods that pyserial's ports have.

pyserial's own take up to half a minute to find out that nobody is there, and hand bytes over that were written before a
network failed as soon as it is back.
"""

import contextlib
import socket
import struct
import sys
from time import monotonic, sleep

import serial

from stepramp.errors import DeviceLost
from stepramp.link.remote_ports import Place, RemotePort, RemotePorts
from stepramp.link.telnet import Telnet

OPEN_S = 2.5
"""So long it may take until bytes can be sent [s]."""
LET_GO_WITHIN_S = 1.0
"""So long another machine may take to let go of a port after a connection that has just ended [s]."""
AGAIN_S = 0.1
SETTLED_S = 0.05
"""A connection that isn't welcome has mostly ended by then [s]."""
FAREWELL_S = 0.3
"""So long what was sent last may take to get there as the line is closed [s]."""
MOST_AT_A_TIME = 65_536
ALIVE_S = 2
"""So often the other machine is asked whether it is there still, while nothing else is said to it [s]."""
_KEEPING_ALIVE = {
    name: value
    for option, value in (
        ("TCP_KEEPIDLE", ALIVE_S),
        ("TCP_KEEPALIVE", ALIVE_S),
        ("TCP_KEEPINTVL", 1),
        ("TCP_KEEPCNT", 3),
        ("TCP_USER_TIMEOUT", 5_000),
    )
    if (name := getattr(socket, option, None)) is not None
}
"""As far as the system has them: one that is gone without a word is noticed within 5 s."""


_AT_ONCE = struct.pack("hh" if sys.platform == "win32" else "ii", 1, 0)
"""SO_LINGER's value that has a connection end without sending what waits."""


class RemoteLine:
    """An open connection. Its methods raise OSError once it has ended."""

    def __init__(self, port: RemotePort, allowed: RemotePorts, baud_rate: int, read_s: float, write_s: float) -> None:
        """Connect, and have the serial port there set as its scheme allows.

        read_s: how long a read waits [s]. write_s: how long a write may take [s]. Raises DeviceLost, each reason in its
        own words, after OPEN_S at most.
        """
        began_s = monotonic()
        self._port = port
        self._read_s, self._write_s = read_s, write_s
        places = allowed.places(port.host, OPEN_S)
        while True:
            self._received = bytearray()
            self._telnet = Telnet(baud_rate) if port.scheme == "rfc2217" else None
            try:
                self._socket = connected(port, places, began_s + OPEN_S)
                self._set_up(began_s + OPEN_S)
            except OSError as error:
                if monotonic() > began_s + LET_GO_WITHIN_S:
                    raise DeviceLost(
                        f"{port.host} ends the connection at once: is the serial port there, and in use by nobody else?"
                    ) from error
                sleep(AGAIN_S)
            else:
                return

    @property
    def in_waiting(self) -> int:
        """Number of bytes that can be read at once."""
        if not self._received:
            self._receive(0.0)
        return len(self._received)

    def read(self, size: int) -> bytes:
        """Return up to so many bytes, as soon as there are any, or none when the time to wait is over."""
        if not self._received:
            self._receive(self._read_s)
        data = bytes(self._received[:size])
        del self._received[:size]
        return data

    def write(self, data: bytes) -> None:
        """Send bytes; SerialTimeoutException when they aren't taken in time."""
        self._send(data if self._telnet is None else self._telnet.escaped(data))

    def close(self) -> None:
        """End the connection: what hasn't got to the other machine by then never does."""
        deadline_s = monotonic() + FAREWELL_S
        with contextlib.suppress(OSError):
            # The other side ends it, too, once it has all that was sent.
            self._socket.shutdown(socket.SHUT_WR)
            while (left_s := deadline_s - monotonic()) > 0:
                self._socket.settimeout(left_s)
                if not self._socket.recv(MOST_AT_A_TIME):
                    self._socket.close()
                    return
        self._abort()

    def _abort(self) -> None:
        """Drop the connection with what is still on its way: a motion must not set out when the network is back."""
        drop(self._socket)

    def _set_up(self, deadline_s: float) -> None:
        """Agree upon what the scheme needs; on a failure the connection is dropped."""
        try:
            self._agree(deadline_s)
        except BaseException:
            self._abort()
            raise

    def _agree(self, deadline_s: float) -> None:
        keep_alive(self._socket)
        if self._telnet is None:
            # One that is in use there is told so, and ended.
            until_s = monotonic() + SETTLED_S
            while (left_s := until_s - monotonic()) > 0:
                self._receive(left_s)
            return
        self._send(self._telnet.opening())
        while not self._telnet.is_ready:
            if self._telnet.trouble is not None:
                raise DeviceLost(f"What listens at {self._port.host} {self._telnet.trouble}.")
            if (left_s := deadline_s - monotonic()) <= 0:
                raise DeviceLost(
                    f"What listens at {self._port.host} doesn't speak RFC 2217. If it is a serial port all the same, "
                    f"it is reached as socket://{self._port.host}."
                )
            # Whatever it says: nothing of that was said by the device since its port was set.
            self._received.clear()
            self._receive(left_s)

    def _receive(self, wait_s: float) -> None:
        """Take what comes in within a time [s]; nothing may come."""
        self._socket.settimeout(wait_s)
        try:
            data = self._socket.recv(MOST_AT_A_TIME)
        except (BlockingIOError, TimeoutError):
            return
        if not data:
            raise ConnectionResetError("the other side has ended the connection")
        if self._telnet is not None:
            data, answer = self._telnet.feed(data)
            if answer:
                self._send(answer)
        self._received += data

    def _send(self, data: bytes) -> None:
        self._socket.settimeout(self._write_s)
        try:
            self._socket.sendall(data)
        except TimeoutError as error:
            raise serial.SerialTimeoutException("what is there doesn't read") from error


def keep_alive(connection: socket.socket) -> None:
    """Have what is sent set out at once, and the other machine asked whether it is there still."""
    with contextlib.suppress(OSError):
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, value in _KEEPING_ALIVE.items():
            connection.setsockopt(socket.IPPROTO_TCP, option, value)


def drop(connection: socket.socket) -> None:
    """End a connection with what is still on its way."""
    with contextlib.suppress(OSError):
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
    connection.close()


def connected(port: RemotePort, places: list[Place], deadline_s: float) -> socket.socket:
    """Return a connection to the first of a host's places that takes one; DeviceLost when none does in time.

    Raises ConnectionResetError when one ends it at once.
    """
    failure: OSError | None = None
    for family, address in places:
        connection = socket.socket(family, socket.SOCK_STREAM)
        try:
            connection.settimeout(max(0.001, deadline_s - monotonic()))
            connection.connect(address)
        except OSError as error:
            connection.close()
            if isinstance(error, ConnectionResetError):
                raise
            failure = error
        else:
            return connection
    if isinstance(failure, ConnectionRefusedError):
        program = "Moonraker" if port.scheme == "moonraker" else "ser2net"
        raise DeviceLost(f"Nothing listens at {port.host}: does {program} run there, at this number?") from failure
    raise DeviceLost(f"{port.host} can't be reached: is it on, and on this network?") from failure
