"""`stepramp stop --port`: whoever names a port wants what is there to be stopped, whatever the servers have."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from client.test_urgent import HalfDeaf
from command_line.conftest import Ask, begun
from controllers.board_process import BoardProcess
from stepramp.client.servers import Server, noted
from stepramp.command_line import stop
from waiting import until

pytestmark = [
    pytest.mark.usefixtures("alone", "folder"),
    pytest.mark.skipif(sys.platform == "win32", reason="signals and pseudo-terminals of Unix"),
]
Serve = Callable[..., HalfDeaf]


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BoardProcess]:
    """Return a board, which keeps what it is given."""
    board = BoardProcess(tmp_path_factory.mktemp("board") / "board")
    board.plug_in()
    yield board
    board.end()


@pytest.fixture
def port(board: BoardProcess) -> str:
    """Return the port of the board."""
    return str(board.port)


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Return what begins a server that has devices, as state and port of each, and leaves a note."""
    with ExitStack() as running:

        def served(*devices: tuple[str, str], unanswered: int = 0) -> HalfDeaf:
            server = running.enter_context(HalfDeaf(unanswered))
            axes = [{"axis": 0, "position_steps": 40}]
            for state, at in devices:
                server.devices.append({"id": "7", "port": at, "state": state, "axes": axes})
            thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
            thread.start()
            running.callback(thread.join)
            running.callback(server.shutdown)
            running.enter_context(noted(Server(server.url)))
            return server

        yield served


def _moving(ask: Ask, port: str) -> subprocess.Popen[str]:
    """Begin a move that takes hours."""
    assert ask(f"push slow.json --port {port} --yes").code == 0
    process = begun(f"move --port {port} --by 4000000 --alone", stderr=subprocess.PIPE)
    assert process.stderr is not None
    assert "Ctrl+C stops it" in process.stderr.readline()
    return process


def _state(ask: Ask, port: str) -> Any:
    return json.loads(ask(f"status --alone --port {port} --format json").out)["state"]


def test_what_moves_by_itself_is_stopped_though_another_server_runs(ask: Ask, port: str, serve: Serve) -> None:
    """The program that has set it in motion was killed."""
    with _moving(ask, port) as process:
        process.kill()
    assert _state(ask, port) == "moving"
    servers = serve(("ready", "sim://")), serve()
    told = ask(f"stop --port {port}")
    assert (told.code, told.err) == (0, "")
    first, second, last = told.out.splitlines()
    assert {first, second} == {
        "Stopped: device 7 at sim://, ready, axis 0 at 40 steps.",
        f"Stopped: the server at {servers[1].url}, which has no device.",
    }
    assert last.startswith(f"Stopped: {port}, axis 0 at ")
    until(lambda: _state(ask, port) == "ready")


def test_what_a_server_has_is_stopped_by_it_whatever_its_port_is_called(
    ask: Ask, port: str, serve: Serve, tmp_path: Path
) -> None:
    serve(("ready", "sim://"))
    serve(("ready", port))
    link = tmp_path / "by-id"
    link.symlink_to(port)
    told = ask(f"stop --port {link}")
    assert (told.code, told.err) == (0, "")
    assert sorted(told.out.splitlines()) == [
        f"Stopped: device 7 at {port}, ready, axis 0 at 40 steps.",
        "Stopped: device 7 at sim://, ready, axis 0 at 40 steps.",
    ]


def test_a_port_that_another_program_has_is_told_as_not_stopped(ask: Ask, port: str, serve: Serve) -> None:
    with _moving(ask, port) as process:
        without_a_server = ask(f"stop --port {port}")
        serve(("ready", "sim://"))
        told = ask(f"stop --port {port}")
        process.terminate()
    assert told.out == "Stopped: device 7 at sim://, ready, axis 0 at 40 steps.\n"
    assert (
        (told.code, told.err)
        == (without_a_server.code, without_a_server.err)
        == (
            3,
            f"stepramp: Port {port} was NOT stopped: Port {port} is in use by another program: end that first. If it "
            "moves, cut the motor's power.\n",
        )
    )


@pytest.mark.parametrize("has_server", [False, True])
def test_a_port_that_is_not_there_is_told_as_not_stopped(ask: Ask, serve: Serve, has_server: bool) -> None:
    if has_server:
        serve(("ready", "sim://"))
    told = ask("stop --port /dev/ttyNone")
    assert (told.code, told.err) == (
        3,
        "stepramp: Port /dev/ttyNone was NOT stopped: There is no port /dev/ttyNone: is it plugged in? If it moves, "
        "cut the motor's power.\n",
    )


def test_a_family_that_there_is_not_is_told_as_not_stopped(ask: Ask, port: str) -> None:
    told = ask(f"stop --port {port} --family nosuch")
    assert (told.code, "was NOT stopped: " in told.err, "nosuch" in told.err) == (2, True, True)


def test_what_its_server_has_lost_is_stopped_without_it(ask: Ask, port: str, serve: Serve) -> None:
    """It is told to the server that lost it, too, which owes it the stop: so it isn't all done."""
    serve(("lost", port))
    told = ask(f"stop --port {port}")
    assert (told.code, told.out.startswith(f"Stopped: {port}, axis 0 at ")) == (3, True)
    assert told.err == f"stepramp: Device 7 at {port} is lost: it is stopped as soon as it answers.\n"


def test_what_its_server_is_connecting_is_left_to_it(ask: Ask, port: str, serve: Serve) -> None:
    serve(("connecting", port))
    told = ask(f"stop --port {port}")
    assert (told.code, told.out) == (3, "")
    assert told.err == f"stepramp: Device 7 at {port} is connecting: it is stopped as soon as it answers.\n"


def test_a_server_that_is_silent_keeps_the_port_from_nothing(
    ask: Ask, port: str, serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stop, "SILENT_S", 0.1)
    asked = serve(unanswered=8)
    told = ask(f"stop --port {port}")
    assert (told.code, len(asked.asked)) == (0, 9)
    assert told.out.startswith(f"Stopped: {port}, axis 0 at ")
    assert told.out.splitlines()[1:] == [f"Stopped: the server at {asked.url}, which has no device."]


def test_a_device_beside_a_port_stops_all(ask: Ask, port: str, serve: Serve) -> None:
    server = serve(("ready", "sim://"))
    told = ask(f"stop --port {port} --device 9")
    assert (told.code, server.asked) == (2, ["/api/v1/devices/stop"])
    assert "--port with --device was not understood" in told.err
    assert f"Stopped: {port}, " in told.out
