"""One serial port: opened for us alone, read and written with timeouts.

Unplugging raises OSError, SerialException or termios.error, depending on the call; here, and only here, they become
DeviceLost.
"""

import contextlib
import os
import sys
from collections.abc import Iterator
from time import monotonic

import serial

from stepramp.errors import DeviceLost, Rejected, Rejection

if sys.platform == "win32":
    _PORT_ERRORS: tuple[type[Exception], ...] = (OSError,)
else:
    import fcntl
    import termios

    _PORT_ERRORS = (OSError, termios.error)

BAUD_RATE = 115_200
WRITE_TIMEOUT_S = 1.0
_READ_SLICE_S = 0.02
"""pyserial's own timeout: changing it costs two system calls, so it stays, and longer waits are made of slices."""

ADDRESSES = ("sim://", "socket://", "rfc2217://")
"""The only addresses let through: pyserial also knows some that write files (spy://) or search (hwgrep://)."""

if "stepramp.link" not in serial.protocol_handler_packages:
    serial.protocol_handler_packages.append("stepramp.link")


class SerialPort:
    """An open port. Not for two threads at once."""

    def __init__(self, port: str) -> None:
        """Open a device such as /dev/ttyACM0, or an address of ADDRESSES.

        Raises Rejected for another address, DeviceLost when the port can't be opened.
        """
        if "://" in port and not port.startswith(ADDRESSES):
            raise Rejected([Rejection("port", port, f"the name of a serial port, or {', '.join(ADDRESSES)}…")])
        self.name = port
        self._is_tty = "://" not in port
        with self._loss_told("can't be opened"):
            self._serial = serial.serial_for_url(port, do_not_open=True, timeout=_READ_SLICE_S)
            self._serial.baudrate = BAUD_RATE
            if self._is_tty:
                self._serial.exclusive = True
                self._serial.write_timeout = WRITE_TIMEOUT_S
            self._serial.open()
            self._hold_alone(True)

    def write(self, data: bytes) -> None:
        """Send bytes; DeviceLost when the port is gone or takes no more for a second."""
        with self._loss_told("is gone"):
            self._serial.write(data)

    def read(self, timeout_s: float) -> bytes:
        """Return what has come in, at once if there is something, or b"" when nothing came in time [s].

        Raises DeviceLost when the port is gone.
        """
        deadline = monotonic() + timeout_s
        with self._loss_told("is gone"):
            while True:
                data: bytes = self._serial.read(max(1, self._serial.in_waiting))
                if data or monotonic() >= deadline:
                    return data

    def pending(self) -> bytes:
        """Return what has come in by now, without waiting; DeviceLost when the port is gone."""
        with self._loss_told("is gone"):
            waiting = self._serial.in_waiting
            data: bytes = self._serial.read(waiting) if waiting else b""
            return data

    def close(self) -> None:
        """Close the port; never raises, since it may be gone already."""
        with contextlib.suppress(DeviceLost), self._loss_told("is gone"):
            self._hold_alone(False)
        with contextlib.suppress(DeviceLost), self._loss_told("is gone"):
            self._serial.close()

    def _hold_alone(self, alone: bool) -> None:
        """Keep programs out that don't heed pyserial's flock; undone before closing, else it may outlast us."""
        if self._is_tty and sys.platform != "win32":
            fcntl.ioctl(self._serial.fileno(), termios.TIOCEXCL if alone else termios.TIOCNXCL)

    @contextlib.contextmanager
    def _loss_told(self, what: str) -> Iterator[None]:
        try:
            yield
        except (*_PORT_ERRORS, serial.SerialException) as error:
            raise DeviceLost(f"Port {self.name} {what}: {_reason(error)}.") from error


def _reason(error: Exception) -> str:
    """Return the system's words for an error that has a number: pyserial and termios wrap them in their own."""
    number = error.args[0] if error.args else None
    return os.strerror(number) if isinstance(number, int) else str(error).rstrip(".")
