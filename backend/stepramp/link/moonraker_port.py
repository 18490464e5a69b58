"""Moonraker, the server that speaks for Klipper: messages over its WebSocket, and its files over HTTP.

Both go to where the host's name led first. Neither is encrypted: that is for a tunnel to do. Its key is sent as a
header and told nowhere.
"""

import logging
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from http.client import HTTPException, HTTPResponse
from io import BytesIO
from socket import socket
from time import monotonic
from typing import cast

from stepramp.errors import DeviceLost, Refused
from stepramp.link.remote_line import MOST_AT_A_TIME, OPEN_S, connected, drop, keep_alive
from stepramp.link.remote_ports import KEYS_VARIABLE, RemotePorts, Scheme
from stepramp.link.web_socket import LARGEST, WantsKey, WebSocket

_logger = logging.getLogger(__name__)

SCHEME: Scheme = "moonraker"
WRITE_S = 1.0
SLICE_S = 0.05
"""So long a more urgent call waits while a file is on its way at most [s]."""
FILE_S = 10.0
"""So long a file may take [s]."""
NO_REMOTE_PORTS = RemotePorts()


@dataclass(frozen=True)
class Reply:
    """What is answered to a request over HTTP."""

    status: int
    body: bytes


class MoonrakerPort:
    """An open Moonraker; a Connection whose every write and read is a whole message. Not for two threads at once."""

    def __init__(
        self,
        port: str,
        before_write: Callable[[], None] = lambda: None,
        remote_ports: RemotePorts = NO_REMOTE_PORTS,
    ) -> None:
        """Connect to an address such as moonraker://printer:7125.

        before_write: called at the last instant before bytes go out; what it raises keeps them from going.
        remote_ports: which may be opened. Raises Rejected for any other, DeviceLost when nobody answers within OPEN_S,
        Refused when what is there lets nobody in, or is no such server.
        """
        self.name = port
        self._before_write = before_write
        self._remote = remote_ports.allowed(port, (SCHEME,))
        self._places = remote_ports.places(self._remote.host, OPEN_S)
        key = remote_ports.key_of(self._remote.host)
        self._headers = {} if key is None else {"X-Api-Key": key}
        deadline_s = monotonic() + OPEN_S
        try:
            connection = connected(self._remote, self._places, deadline_s)
        except ConnectionResetError as error:
            raise DeviceLost(f"{self._remote.host} ends the connection at once.") from error
        keep_alive(connection)
        try:
            self._socket = WebSocket(
                connection, f"ws://{self._remote.host}/websocket", self._headers, deadline_s, WRITE_S
            )
        except WantsKey as error:
            raise Refused(
                f"The Moonraker at {port} lets nobody in without its API key: start StepRamp with the variable "
                f"{KEYS_VARIABLE} set to {self._remote.host}=key."
            ) from error
        except Refused as error:
            raise Refused(f"Something talks at {port}, but it is no Moonraker.") from error
        except DeviceLost as error:
            raise DeviceLost(f"Nothing answers at {port} as Moonraker does: does it run there?") from error

    def write(self, data: bytes) -> None:
        """Send a message; DeviceLost when the connection is gone or takes no more for a second."""
        self._before_write()
        self._log("sent", data)
        try:
            self._socket.send(data)
        except OSError as error:
            raise self._gone() from error

    def read(self, timeout_s: float) -> bytes:
        """Return a message, at once if there is one, or b"" when none came in time [s].

        Raises DeviceLost when the connection is gone.
        """
        try:
            message = self._socket.receive(timeout_s)
        except OSError as error:
            raise self._gone() from error
        self._log("received", message)
        return message

    def pending(self) -> bytes:
        """Return a message that has come in by now, or b""; DeviceLost when the connection is gone."""
        return self.read(0.0)

    def close(self) -> None:
        """Close the connection; never raises, since it may be gone already."""
        self._socket.close()

    def request(
        self,
        method: str,
        path: str,
        give_way: Callable[[float], None],
        body: bytes = b"",
        content_type: str = "application/json",
        time_s: float = FILE_S,
    ) -> Reply:
        """Make a request over HTTP, over a connection of its own, and return what is answered.

        give_way: called again and again meanwhile. time_s: how long it may take [s]. Raises DeviceLost when it takes
        longer, or what is answered is no HTTP.
        """
        self._before_write()
        head = [f"{method} {path} HTTP/1.1", f"Host: {self._remote.host}", "Connection: close"]
        head += [f"{name}: {value}" for name, value in self._headers.items()]
        head += [f"Content-Type: {content_type}", f"Content-Length: {len(body)}"] if body else []
        _logger.debug("%s %s %s, %d bytes", self.name, method, path, len(body))
        try:
            said = self._asked("\r\n".join([*head, "", ""]).encode("ascii") + body, give_way, time_s)
        except TimeoutError as error:
            raise DeviceLost(f"The Moonraker at {self.name} doesn't {'take' if body else 'give'} its files.") from error
        except OSError as error:
            raise self._gone() from error
        try:
            response = HTTPResponse(cast(socket, _Heard(said)), method=method)
            response.begin()
            return Reply(response.status, response.read())
        except (HTTPException, ValueError) as error:
            raise DeviceLost(f"What is answered at {self.name} over HTTP makes no sense.") from error

    def _asked(self, sent: bytes, give_way: Callable[[float], None], time_s: float) -> bytes:
        """Send bytes over a connection of their own, and return all that is said until it is ended.

        Raises TimeoutError when that takes longer [s].
        """
        deadline_s, give_way_s = monotonic() + time_s, monotonic() + SLICE_S
        connection = connected(self._remote, self._places, monotonic() + min(OPEN_S, time_s))
        left, said = memoryview(sent), bytearray()
        try:
            connection.settimeout(SLICE_S)
            while monotonic() < deadline_s and len(said) < LARGEST:
                with suppress(TimeoutError):
                    if left:
                        left = left[connection.send(left) :]
                    elif data := connection.recv(MOST_AT_A_TIME):
                        said += data
                    else:
                        return bytes(said)
                # Also while something comes in all the time.
                if monotonic() >= give_way_s:
                    give_way(0.0)
                    give_way_s = monotonic() + SLICE_S
        finally:
            drop(connection)
        raise TimeoutError

    def _log(self, direction: str, message: bytes) -> None:
        if message and _logger.isEnabledFor(logging.DEBUG):
            _logger.debug("%s %s %s", self.name, direction, message.decode("utf-8", "backslashreplace"))

    def _gone(self) -> DeviceLost:
        return DeviceLost(f"The Moonraker at {self.name} is gone: the connection has ended, or takes nothing more.")


class _Heard:
    """Bytes that the library takes for a socket, since all of them have come in."""

    def __init__(self, said: bytes) -> None:
        self._said = said

    def makefile(self, _mode: str) -> BytesIO:
        return BytesIO(self._said)
