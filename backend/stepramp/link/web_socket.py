"""A WebSocket to another machine: whole messages over a connection whose every wait has an end.

What the bytes mean is the library's, `websockets` without its own input and output; its clients that have some wait in
threads of their own, where no stop could come in between.
"""

import logging
import socket
from collections import deque
from collections.abc import Iterable, Mapping
from time import monotonic

from websockets.client import ClientProtocol
from websockets.exceptions import InvalidStatus, WebSocketException
from websockets.frames import Frame, Opcode
from websockets.protocol import State
from websockets.uri import parse_uri

from stepramp.errors import DeviceLost, Refused
from stepramp.link.remote_line import MOST_AT_A_TIME, drop

LARGEST = 8 * 1024 * 1024
"""What is longer is no message of a controller's [bytes]."""
FAREWELL_S = 0.3
UNAUTHORIZED = (401, 403)
_SILENT = logging.Logger("WebSocket", logging.CRITICAL)
"""The library would tell all headers, and a key is one."""


class WantsKey(Refused):
    """What listens there lets nobody in without a key, or not with this one."""


class WebSocket:
    """An open WebSocket. Not for two threads at once. Its methods raise OSError once it has ended."""

    def __init__(
        self, connection: socket.socket, url: str, headers: Mapping[str, str], deadline_s: float, write_s: float
    ) -> None:
        """Shake hands over a connection, and own it from then on.

        headers: besides the usual ones. deadline_s: until when [s]. write_s: how long a write may take [s].
        Raises DeviceLost when nothing is said to that in time, Refused when it is no WebSocket that is there.
        """
        self._socket, self._write_s, self._host = connection, write_s, url
        self._protocol = ClientProtocol(parse_uri(url), max_size=LARGEST, logger=_SILENT)
        self._messages: deque[bytes] = deque()
        self._begun = bytearray()
        self._has_ended = False
        try:
            self._shake_hands(headers, deadline_s)
        except BaseException:
            drop(connection)
            raise

    def send(self, message: bytes) -> None:
        """Send a text message; TimeoutError when it isn't taken in time."""
        if self._protocol.state is not State.OPEN:
            raise ConnectionResetError("the WebSocket has ended")
        self._protocol.send_text(message)
        self._flush()

    def receive(self, timeout_s: float) -> bytes:
        """Return a message, at once if there is one, or b"" when none came whole in time [s]."""
        deadline_s = monotonic() + timeout_s
        while not self._messages:
            left_s = deadline_s - monotonic()
            self._take(max(0.0, left_s))
            if left_s <= 0:
                break
        return self._messages.popleft() if self._messages else b""

    def close(self) -> None:
        """End it: what hasn't got there by then never does."""
        if self._protocol.state is State.OPEN:
            try:
                self._protocol.send_close()
                self._flush()
                self._socket.settimeout(FAREWELL_S)
                self._socket.recv(MOST_AT_A_TIME)
            except (OSError, WebSocketException):
                pass
        drop(self._socket)

    def _shake_hands(self, headers: Mapping[str, str], deadline_s: float) -> None:
        request = self._protocol.connect()
        for name, value in headers.items():
            request.headers[name] = value
        self._protocol.send_request(request)
        has_heard = False
        try:
            self._flush()
            while self._protocol.state is State.CONNECTING and self._protocol.handshake_exc is None:
                if (left_s := deadline_s - monotonic()) <= 0:
                    break
                has_heard = self._take(left_s) or has_heard
        except OSError as error:
            if self._protocol.handshake_exc is None:
                raise DeviceLost(f"What listens at {self._host} ends the connection at once.") from error
        failure = self._protocol.handshake_exc
        if failure is not None and not has_heard:
            raise DeviceLost(f"What listens at {self._host} ends the connection at once.") from failure
        if isinstance(failure, InvalidStatus) and failure.response.status_code in UNAUTHORIZED:
            raise WantsKey(f"What listens at {self._host} lets nobody in without its key.")
        if failure is not None or (has_heard and self._protocol.state is not State.OPEN):
            raise Refused(f"Something talks at {self._host}, but it is no WebSocket.") from failure
        if self._protocol.state is not State.OPEN:
            raise DeviceLost(f"Nothing answers at {self._host}.")

    def _take(self, wait_s: float) -> bool:
        """Take what comes in within a time [s], and return whether something did."""
        if self._has_ended:
            raise ConnectionResetError("the other side has ended the WebSocket")
        self._socket.settimeout(wait_s)
        try:
            data = self._socket.recv(MOST_AT_A_TIME)
        except (BlockingIOError, TimeoutError):
            return False
        if data:
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        self._understand(self._protocol.events_received())
        self._flush()
        # What came before its end is still to be heard.
        self._has_ended = not data or self._protocol.state in (State.CLOSING, State.CLOSED)
        return bool(data)

    def _understand(self, events: Iterable[object]) -> None:
        for event in events:
            if not isinstance(event, Frame) or event.opcode not in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
                continue
            self._begun += event.data
            if event.fin:
                self._messages.append(bytes(self._begun))
                self._begun = bytearray()

    def _flush(self) -> None:
        self._socket.settimeout(self._write_s)
        for data in self._protocol.data_to_send():
            if data:
                self._socket.sendall(data)
