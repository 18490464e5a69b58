"""The end of the server: whatever ends it and whatever is unfinished, motors are stopped first."""

from __future__ import annotations

import signal
import socket
import sys
from collections.abc import Iterator

import pytest

from controllers.usb_board import UsbBoard
from designs import document
from server_process import ServerProcess
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, RunRequest, StopRequest
from stepramp.controllers.stepramp.messages.status import AxisState
from stepramp.controllers.virtual.motor_state import state_of
from waiting import until

LONG_MOVE = 1_000_000

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals and pseudo-terminals of Unix")


def half_a_post(server: ServerProcess) -> socket.socket:
    """Send half a request, and keep its connection open."""
    connection = socket.create_connection((server.address.hostname, server.address.port))
    connection.sendall(
        b"POST /api/v1/devices/1/move HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Type: application/json\r\n"
        b"Content-Length: 100\r\n\r\n{" % server.address.port
    )
    return connection


@pytest.fixture
def server() -> Iterator[ServerProcess]:
    with ServerProcess(8900) as server:
        yield server


@pytest.fixture
def board(server: ServerProcess) -> Iterator[UsbBoard]:
    """Return a board whose motor moves, and goes on without a host."""
    with UsbBoard() as board:
        device = server.ask("POST", "devices", {"port": board.port})["id"]
        server.ask("POST", f"devices/{device}/push", {"design": document()})
        server.ask("POST", f"devices/{device}/move", {"by_steps": LONG_MOVE})
        assert MoveByRequest.KIND in board.requests
        yield board


@pytest.mark.parametrize(
    "ending", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT], ids=lambda each: each.name
)
def test_a_signal_stops_the_motor_first_whatever_is_unfinished(
    server: ServerProcess, board: UsbBoard, ending: signal.Signals
) -> None:
    with half_a_post(server):
        server.process.send_signal(ending)
        until(lambda: StopRequest.KIND in board.requests)
        errors = server.ended()
    assert (server.process.returncode, "Traceback" in errors) == (0, False), errors
    assert state_of(board.controller._machine._motors[0]) is not AxisState.MOVING
    assert board.requests.count(MoveByRequest.KIND) == 1


def test_a_second_signal_stops_too_before_it_leaves(server: ServerProcess, board: UsbBoard) -> None:
    board.mute()
    with half_a_post(server):
        server.process.send_signal(signal.SIGINT)
        until(lambda: board.unheard.count(StopRequest.KIND) >= 1)
        board.speak()
        server.process.send_signal(signal.SIGINT)
        errors = server.ended()
    assert (server.process.returncode, "Traceback" in errors) == (0, False), errors
    assert StopRequest.KIND in board.requests


def test_a_server_that_is_killed_leaves_no_run(server: ServerProcess, board: UsbBoard) -> None:
    """What the server can't do any more the controller does: nobody asks it for anything for a second."""
    server.ask("POST", "devices/1/run", {"speed_steps_per_s": 100, "for_s": 3600})
    assert RunRequest.KIND in board.requests
    server.process.kill()
    until(lambda: state_of(board.controller._machine._motors[0]) is not AxisState.MOVING)
