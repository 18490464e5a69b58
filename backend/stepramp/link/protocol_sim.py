"""pyserial's handler for `sim://name`: a serial port whose other end is an object of this process.

pyserial finds this module by its name, once the package is among `serial.protocol_handler_packages`. What the bytes
mean is the virtual device's affair: it is registered from outside.
"""

import errno
import time
from typing import TYPE_CHECKING, Protocol

import serial

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

VIRTUAL_PORT = "sim://"
LISTEN_S = 0.002
"""How often an empty port listens to its device."""


class VirtualDevice(Protocol):
    """The other end of a virtual port."""

    def opened(self) -> None:
        """Notice that the port was opened, which resets many boards."""

    def exchange(self, sent: bytes) -> bytes:
        """Take the bytes sent, if any, and return what comes back; OSError when the device has gone.

        It is also called without any, to hear what the device says unasked.
        """


_devices: dict[str, VirtualDevice] = {}
_open_ports: set[str] = set()


def register(port: str, device: VirtualDevice) -> None:
    """Let a device answer at a port such as `sim://`; the one that was there before is replaced."""
    _devices[port] = device


def registered(port: str) -> bool:
    """Tell whether a virtual device answers at this port."""
    return port in _devices


def device_at(port: str) -> VirtualDevice | None:
    """Return the virtual device that answers at this port; None for none."""
    return _devices.get(port)


class Serial(serial.SerialBase):
    """A port to a virtual device, as exclusive as a real one. Replies have no travel time."""

    def open(self) -> None:
        """Open the port; SerialException when nothing is registered there, or it is open already."""
        name = str(self.port)
        if name not in _devices:
            raise serial.SerialException(f"no virtual device is there, but at {', '.join(sorted(_devices))}")
        if name in _open_ports:
            raise serial.SerialException(errno.EBUSY, f"{name} is in use")
        _open_ports.add(name)
        self._received = bytearray()
        self.is_open = True
        _devices[name].opened()

    def close(self) -> None:
        """Close the port; a second time is harmless."""
        if self.is_open:
            _open_ports.discard(str(self.port))
            self.is_open = False

    @property
    def in_waiting(self) -> int:
        """Number of bytes that can be read at once."""
        self._listen()
        return len(self._received)

    def read(self, size: int = 1, /) -> bytes:
        """Return up to `size` bytes, as soon as there are any, or none when the timeout is over."""
        deadline = time.monotonic() + (self.timeout or 0)
        while not self._received and (left_s := deadline - time.monotonic()) > 0:
            time.sleep(min(LISTEN_S, left_s))
            self._listen()
        data = bytes(self._received[:size])
        del self._received[:size]
        return data

    def write(self, data: "ReadableBuffer", /) -> int:
        """Hand the bytes to the device and keep what it answers."""
        sent = bytes(data)
        self._received += _devices[str(self.port)].exchange(sent)
        return len(sent)

    def _listen(self) -> None:
        self._received += _devices[str(self.port)].exchange(b"")

    def _reconfigure_port(self) -> None:
        """Nothing to configure: called by pyserial when a setting changes."""
