import errno
import fcntl
import os
import re
import resource
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import serial

from stepramp.errors import DeviceLost, Rejected
from stepramp.link.serial_port import SerialPort
from waiting import PATIENCE_S


def received(port: SerialPort, count: int) -> bytes:
    data = b""
    while len(data) < count and (more := port.read(5.0)):
        data += more
    return data


def read_for_ever(port: SerialPort) -> None:
    while True:
        port.read(1.0)


def write_for_ever(port: SerialPort) -> None:
    while True:
        port.write(bytes(1000))


def waits_of(call: Callable[[], object]) -> int:
    """Return how often this thread gave up the processor in a call by itself, as whoever waits does."""
    before = resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw
    call()
    return resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw - before


def test_bytes_go_both_ways(cable: Any) -> None:
    port = SerialPort(cable.port)
    port.write(b"\x00out\xff")
    assert os.read(cable.far_end, 100) == b"\x00out\xff"
    os.write(cable.far_end, b"\x11in\x13\x03")
    assert received(port, 5) == b"\x11in\x13\x03"
    port.close()


def test_reading_ends_when_the_time_is_up(cable: Any) -> None:
    port = SerialPort(cable.port)
    began = time.monotonic()
    assert port.read(0.1) == b""
    assert time.monotonic() - began >= 0.1
    port.close()


def test_reading_returns_as_soon_as_something_comes(cable: Any) -> None:
    port = SerialPort(cable.port)
    sender = threading.Timer(0.05, os.write, (cable.far_end, b"x"))
    sender.start()
    began = time.monotonic()
    assert port.read(2 * PATIENCE_S) == b"x"
    assert time.monotonic() - began < PATIENCE_S
    sender.join()
    port.close()


def test_what_has_come_in_is_there_without_waiting(cable: Any) -> None:
    port = SerialPort(cable.port)
    assert min(waits_of(port.pending) for _ in range(10)) == 0
    assert port.pending() == b""
    os.write(cable.far_end, b"\x00\x01")
    data = b""
    while len(data) < 2:
        data += port.pending()
    assert data == b"\x00\x01"
    port.close()


@pytest.mark.parametrize(
    "use",
    [lambda port: port.read(1.0), lambda port: port.pending(), lambda port: port.write(b"x")],
    ids=["read", "pending", "write"],
)
def test_an_unplugged_port_is_a_lost_device(cable: Any, use: Callable[[SerialPort], object]) -> None:
    port = SerialPort(cable.port)
    cable.unplug()
    with pytest.raises(DeviceLost) as lost:
        use(port)
    # What the system and pyserial call it stands in the log.
    assert str(lost.value) == f"Port {cable.port} is gone: was it unplugged?"
    port.close()
    port.close()


def test_unplugging_while_a_read_waits(cable: Any) -> None:
    port = SerialPort(cable.port)
    unplug = threading.Timer(0.1, cable.unplug)
    unplug.start()
    with pytest.raises(DeviceLost):
        port.read(30.0)
    unplug.join()
    port.close()


def test_a_port_is_held_alone_and_can_be_opened_again(cable: Any) -> None:
    port = SerialPort(cable.port)
    with pytest.raises(DeviceLost, match=f"Port {cable.port} is in use by another program: end that first."):
        SerialPort(cable.port)
    port.close()
    SerialPort(cable.port).close()


def test_a_port_that_takes_nothing_is_lost_and_what_waits_goes_no_further(cable: Any) -> None:
    """Closing would wait for it, and a motion among it would set out later."""
    sent = []
    port = SerialPort(cable.port, lambda: sent.append(1000))
    with pytest.raises(DeviceLost, match="takes nothing more: what is there doesn't read"):
        write_for_ever(port)
    port.close()
    again = SerialPort(cable.port)
    os.set_blocking(cable.far_end, False)
    # That is what the far end's own line has taken already.
    assert len(os.read(cable.far_end, 4096)) < 4096 < sum(sent)
    with pytest.raises(BlockingIOError):
        os.read(cable.far_end, 4096)
    again.close()


def test_no_such_port_and_no_port_at_all(tmp_path: Path) -> None:
    for name in ("ttyNONE", "x" * 5000, "x/y"):
        with pytest.raises(DeviceLost, match="There is no port"):
            SerialPort(str(tmp_path / name))
    (tmp_path / "file").write_text("not a terminal")
    with pytest.raises(DeviceLost, match="file is no serial port"):
        SerialPort(str(tmp_path / "file"))
    with pytest.raises(Rejected, match="allowed: the name of a serial port"):
        SerialPort(str(tmp_path))


def test_a_port_that_another_program_holds_in_its_own_way(cable: Any) -> None:
    other = os.open(cable.port, os.O_RDWR | os.O_NOCTTY)
    fcntl.flock(other, fcntl.LOCK_EX)
    with pytest.raises(DeviceLost, match="is in use by another program"):
        SerialPort(cable.port)
    os.close(other)
    SerialPort(cable.port).close()


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (serial.SerialException(errno.EBUSY, "could not open port"), "in use by another program"),
        (serial.SerialException(errno.EAGAIN, "Could not exclusively lock port"), "in use by another program"),
        (serial.SerialException("could not open port 'COM3': PermissionError(13, 'Access is denied.', None, 5)"),
         "in use by another program"),
        (serial.SerialException("could not open port 'COM9': FileNotFoundError(2, '', None, 2)"), "There is no port"),
        (serial.SerialException(errno.EACCES, "could not open port"), "usermod -aG dialout"),
        (PermissionError(errno.EPERM, "Operation not permitted"), "usermod -aG dialout"),
        (serial.SerialException(errno.ENODEV, "could not open port"), "There is no port"),
        (serial.SerialException("could not open port"), "can't be opened: could not open port."),
    ],
)  # fmt: skip
def test_why_a_port_cant_be_opened(cable: Any, monkeypatch: pytest.MonkeyPatch, error: Exception, words: str) -> None:
    # Who may do everything, as in CI, is refused nothing: the system's errors are made here.
    def refuse(_: object) -> None:
        raise error

    monkeypatch.setattr(serial.Serial, "open", refuse)
    with pytest.raises(DeviceLost, match=re.escape(words)):
        SerialPort(cable.port)


@pytest.mark.parametrize(
    "port",
    ["spy:///dev/ttyS0?file=x", "hwgrep://.*", "loop://", "http://example.org", "", " ", "a\0b", "COM1\n", "\ud800",
     "socket://", "socket://bad", "socket://h:99999", "socket://h:0", "socket://h:-1", "socket://h:x", "socket://:80",
     "socket://h:\u0663", "socket://[::1", "socket://u:p@h:80", "socket://h:80/x", "socket://h:80?x", "socket://h:80#x",
     "socket://h:80\0", "socket://" + "a" * 70 + ":80", "socket://a..b:80", "rfc2217://h", "rfc2217://h:80?x=1",
     "SOCKET://h:80", "socket:/h:80://"],
)  # fmt: skip
def test_other_addresses_are_refused(port: str) -> None:
    with pytest.raises(Rejected) as caught:
        SerialPort(port)
    assert caught.value.rejections[0].field == "port"
