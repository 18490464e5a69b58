"""Commands where no server runs: the same, within this program."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from command_line.conftest import Ask, begun
from controllers.board_process import BoardProcess
from designs import design, document
from stepramp.ramp.profile import profile_of

pytestmark = [
    pytest.mark.usefixtures("alone", "folder"),
    pytest.mark.skipif(sys.platform == "win32", reason="signals and pseudo-terminals of Unix"),
]


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the port of a board, which keeps what it is given."""
    board = BoardProcess(tmp_path_factory.mktemp("board") / "board")
    board.plug_in()
    yield str(board.port)
    board.end()


def test_numbers_are_those_of_one_s_own_process(ask: Ask) -> None:
    told = ask("profile design.json --format json")
    assert (told.code, told.err) == (0, "")
    assert json.loads(told.out)["intervals_ticks"] == profile_of(design()).intervals_ticks.tolist()
    picture = ask("map motor.json --cells 8")
    assert (picture.code, len(picture.out.splitlines())) == (0, 10)


def test_a_board_is_pushed_to_moved_and_stopped(ask: Ask, port: str) -> None:
    told = ask(f"push design.json --port {port} --yes")
    assert (told.code, "read back as sent, stored" in told.err) == (0, True), told.err
    moved = ask(f"move --port {port} --by 100 --trace - ")
    assert (moved.code, len(moved.out.splitlines())) == (0, 101), moved.err
    stopped = ask(f"stop --port {port}")
    assert (stopped.code, stopped.out.startswith(f"Stopped: {port}, axis 0 at ")) == (0, True), stopped.err


def test_a_port_that_another_program_has_says_so_and_ctrl_c_stops_what_moves(ask: Ask, port: str) -> None:
    assert ask(f"push design.json --port {port} --yes").code == 0
    with begun(f"run --port {port} --speed 500 --for 60", stderr=subprocess.PIPE) as process:
        assert process.stderr is not None
        assert "runs at 500 steps/s for 60 s" in process.stderr.readline()
        busy = ask(f"status --port {port}")
        assert (busy.code, busy.err) == (3, f"stepramp: Port {port} is in use by another program: end that first.\n")
        process.send_signal(signal.SIGINT)
        assert re.search(rf"stopp(ed|ing): {re.escape(port)}, axis 0 at ", process.stderr.read())
    assert process.returncode == 130


def test_what_needs_a_server_or_a_device_says_so(ask: Ask, port: str) -> None:
    no_device = ask("status")
    assert no_device.code == 3
    assert "No device is connected. Name what it is plugged in at: --port" in no_device.err
    refused = ask(f"move --by 10 --no-wait --port {port}")
    assert (refused.code, "--no-wait is true; allowed: nothing without" in refused.err) == (2, True), refused.err
    assert ask("status --port /dev/none").code == 3
    # What can't be used is told before a port is opened.
    for wrong in ("push absent.json --yes", "push design.json", "move", "run --speed 9 --for 0", "restore"):
        assert ask(f"{wrong} --port /dev/none").code == 2, wrong
    assert "Nothing listens at 127.0.0.1:1" in ask("status --port socket://127.0.0.1:1").err


def test_the_library_is_the_same_without_a_server(ask: Ask) -> None:
    Path("stage.json").write_text(json.dumps(document(name="Stage")))
    assert ask("designs save stage.json").code == 0
    assert "Stage" in ask("designs list").out
