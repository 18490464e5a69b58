"""One serial port: opened for us alone, read and written with timeouts.

Unplugging raises OSError, SerialException or termios.error, depending on the call; here, and only here, they become
DeviceLost.
"""

import contextlib
import errno
import logging
import os
import sys
from collections.abc import Callable, Iterator
from time import monotonic

import serial

from stepramp.errors import DeviceLost, Rejected, Rejection
from stepramp.link.protocol_sim import VIRTUAL_PORT
from stepramp.link.remote_line import RemoteLine
from stepramp.link.remote_ports import RemotePorts

_logger = logging.getLogger(__name__)

if sys.platform == "win32":
    _PORT_ERRORS: tuple[type[Exception], ...] = (OSError,)
else:
    import fcntl
    import termios

    _PORT_ERRORS = (OSError, termios.error)

USUAL_BAUD_RATE = 115_200
WRITE_TIMEOUT_S = 1.0
NO_REMOTE_PORTS = RemotePorts()
_READ_SLICE_S = 0.02
"""pyserial's own timeout: changing it costs two system calls, so it stays, and longer waits are made of slices."""

_IN_USE = "Port {name} is in use by another program: end that first."
_NONE = "There is no port {name}: is it plugged in?"
_NOT_PERMITTED = (
    "Port {name} may not be opened by this user. On Linux, join the group of serial ports with "
    "'sudo usermod -aG dialout $USER', and log in again."
)
_WORDS = {
    **dict.fromkeys((errno.EBUSY, errno.EAGAIN), _IN_USE),
    **dict.fromkeys((errno.EACCES, errno.EPERM), _NOT_PERMITTED),
    **dict.fromkeys((errno.ENOENT, errno.ENODEV, errno.ENXIO, errno.ENOTDIR, errno.ENAMETOOLONG), _NONE),
    errno.ENOTTY: "{name} is no serial port.",
}
"""What an error means when a port is being opened."""
_WORDS_ON_WINDOWS = {"PermissionError(": _IN_USE, "FileNotFoundError(": _NONE}
"""There pyserial names the error only in its text, and a port that somebody else has open is not permitted."""

if "stepramp.link" not in serial.protocol_handler_packages:
    serial.protocol_handler_packages.append("stepramp.link")


class SerialPort:
    """An open port. Not for two threads at once."""

    def __init__(
        self,
        port: str,
        before_write: Callable[[], None] = lambda: None,
        remote_ports: RemotePorts = NO_REMOTE_PORTS,
        baud_rate: int = USUAL_BAUD_RATE,
    ) -> None:
        """Open a device such as /dev/ttyACM0, the virtual one at sim://, or a port of another machine.

        before_write: called at the last instant before bytes go out; what it raises keeps them from going.
        remote_ports: which ports of other machines may be opened.
        Raises Rejected for what can't be a port, DeviceLost when it can't be opened, each reason in its own words.
        """
        self.name = port
        self._before_write = before_write
        self._is_tty = "://" not in port
        self._is_far_away = not self._is_tty and not port.startswith(VIRTUAL_PORT)
        _check_name(port)
        self._serial: serial.Serial | RemoteLine
        if self._is_far_away:
            remote = remote_ports.allowed(port, besides="the name of a serial port, sim://, ")
            self._serial = RemoteLine(remote, remote_ports, baud_rate, _READ_SLICE_S, WRITE_TIMEOUT_S)
            return
        with self._failure_told():
            self._serial = opened = serial.serial_for_url(port, do_not_open=True, timeout=_READ_SLICE_S)
            opened.baudrate = baud_rate
            if self._is_tty:
                opened.exclusive = True
                opened.write_timeout = WRITE_TIMEOUT_S
            opened.open()
            self._hold_alone(True)

    def write(self, data: bytes) -> None:
        """Send bytes; DeviceLost when the port is gone or takes no more for a second."""
        self._before_write()
        _log_bytes(self.name, "sent", data)
        with self._loss_told():
            try:
                self._serial.write(data)
            except serial.SerialTimeoutException:
                self._drop_unsent()
                raise

    def read(self, timeout_s: float) -> bytes:
        """Return what has come in, at once if there is something, or b"" when nothing came in time [s].

        Raises DeviceLost when the port is gone.
        """
        deadline = monotonic() + timeout_s
        with self._loss_told():
            while True:
                data: bytes = self._serial.read(max(1, self._serial.in_waiting))
                if data or monotonic() >= deadline:
                    _log_bytes(self.name, "received", data)
                    return data

    def pending(self) -> bytes:
        """Return what has come in by now, without waiting; DeviceLost when the port is gone."""
        with self._loss_told():
            waiting = self._serial.in_waiting
            data: bytes = self._serial.read(waiting) if waiting else b""
            _log_bytes(self.name, "received", data)
            return data

    def close(self) -> None:
        """Close the port; never raises, since it may be gone already."""
        with contextlib.suppress(DeviceLost), self._loss_told():
            self._hold_alone(False)
        with contextlib.suppress(DeviceLost), self._loss_told():
            self._serial.close()

    def _drop_unsent(self) -> None:
        """Drop what waits to be sent: closing would wait for that, and a motion among it must not set out later."""
        if isinstance(self._serial, serial.Serial):
            self._serial.reset_output_buffer()

    def _hold_alone(self, alone: bool) -> None:
        """Keep programs out that don't heed pyserial's flock; undone before closing, else it may outlast us."""
        if self._is_tty and isinstance(self._serial, serial.Serial) and sys.platform != "win32":
            fcntl.ioctl(self._serial.fileno(), termios.TIOCEXCL if alone else termios.TIOCNXCL)

    @contextlib.contextmanager
    def _failure_told(self) -> Iterator[None]:
        try:
            yield
        except (*_PORT_ERRORS, serial.SerialException) as error:
            on_windows = (words for name, words in _WORDS_ON_WINDOWS.items() if name in str(error))
            words = _WORDS.get(_number(error)) or next(on_windows, None)
            told = words.format(name=self.name) if words else f"Port {self.name} can't be opened: {_reason(error)}."
            raise DeviceLost(told) from error
        except ValueError as error:
            raise Rejected([Rejection("port", self.name, f"a port that can be opened ({error})")]) from error

    @contextlib.contextmanager
    def _loss_told(self) -> Iterator[None]:
        try:
            yield
        except serial.SerialTimeoutException as error:
            raise DeviceLost(f"Port {self.name} takes nothing more: what is there doesn't read.") from error
        except (*_PORT_ERRORS, serial.SerialException) as error:
            _logger.info("%s: %s", self.name, error)
            why = "the connection has ended." if self._is_far_away else "was it unplugged?"
            raise DeviceLost(f"Port {self.name} is gone: {why}") from error


def _log_bytes(port: str, direction: str, data: bytes) -> None:
    if data and _logger.isEnabledFor(logging.DEBUG):
        _logger.debug("%s %s %s", port, direction, data.hex(" "))


def _reason(error: Exception) -> str:
    """Return the system's words for an error that has a number: pyserial and termios wrap them in their own."""
    number = error.args[0] if error.args else None
    return os.strerror(number) if isinstance(number, int) else str(error).rstrip(".")


def _number(error: Exception) -> int:
    """Return the system's number of an error, or of the one that pyserial put into words; 0 without any."""
    causes = [error, error.__context__]
    numbers = (each.args[0] for each in causes if each is not None and each.args and isinstance(each.args[0], int))
    return next(numbers, 0)


def _check_name(port: str) -> None:
    """Reject what is no name that a port could have.

    pyserial also knows addresses that write files (spy://) or search (hwgrep://): they never get there.
    """
    if not port.strip() or not port.isprintable() or ("://" not in port and os.path.isdir(port)):
        allowed = "the name of a serial port, sim://, or the address of one on the network, as rfc2217://host:port"
        raise Rejected([Rejection("port", port, allowed)])
