"""Another machine on the network, within this one: what it does to who connects is for the test to say."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from stepramp.link.remote_ports import RemotePorts
from stepramp.link.serial_port import SerialPort

Serve = Callable[[socket.socket, threading.Event], None]
"""Has a connection; the event is set once the host is to end."""


class FarHost:
    """A host that serves each connection in a thread of its own, as long as the context lasts."""

    def __init__(self, serve: Serve) -> None:
        self._serve = serve
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.name = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._ended = threading.Event()
        self._threads = [threading.Thread(target=self._accept)]

    def open(self, scheme: str) -> SerialPort:
        """Open its port, as the only one that is allowed."""
        return SerialPort(f"{scheme}://{self.name}", remote_ports=RemotePorts.named([self.name]))

    def __enter__(self) -> FarHost:
        self._threads[0].start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        for thread in self._threads:
            thread.join()

    def _accept(self) -> None:
        while not self._ended.is_set():
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            self._threads.append(threading.Thread(target=self._serve_one, args=(connection,)))
            self._threads[-1].start()

    def _serve_one(self, connection: socket.socket) -> None:
        with connection, suppress(OSError):
            self._serve(connection, self._ended)


def says_nothing(_: socket.socket, ended: threading.Event) -> None:
    ended.wait()


def closes(connection: socket.socket, _: threading.Event) -> None:
    connection.close()


def says_that_it_is_taken(connection: socket.socket, _: threading.Event) -> None:
    connection.sendall(b"Port already in use\r\n")


def resets(connection: socket.socket, _: threading.Event) -> None:
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def says(data: bytes, every_s: float) -> Serve:
    """Return what says the same time and again, and reads nothing."""

    def serve(connection: socket.socket, ended: threading.Event) -> None:
        while not ended.wait(every_s):
            connection.sendall(data)

    return serve


@contextmanager
def host_that_never_answers() -> Iterator[str]:
    """Yield the name of a host whose connections are never answered: as many wait to be accepted as may wait."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen(0)
        waiting = []
        with suppress(TimeoutError):
            for _ in range(10):
                waiting.append(socket.socket())
                waiting[-1].settimeout(0.2)
                waiting[-1].connect(listener.getsockname())
        try:
            yield f"127.0.0.1:{listener.getsockname()[1]}"
        finally:
            for each in waiting:
                each.close()
