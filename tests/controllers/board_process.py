"""A board on a cable in a process of its own: whatever keeps a test's interpreter busy, it answers in time.

Within the test's process the thread of a pseudo-terminal waits for the interpreter's lock, which another thread keeps
also while a machine that has much to do lets that thread rest: for longer than a controller is waited for.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from controllers.usb_board import Cable

TESTS = Path(__file__).parents[1]
ENDS_WITHIN_S = 30


class BoardProcess:
    """A port whose name stays while a board comes and goes, until it is ended: see Cable."""

    def __init__(self, port: Path) -> None:
        self.port = port
        path = os.pathsep.join([str(TESTS), str(TESTS.parent / "backend")])
        self._process = subprocess.Popen(
            [sys.executable, "-m", "controllers.board_process", str(port)],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def plug_in(self) -> None:
        """Plug the board in, which resets it."""
        self._tell("plug_in")

    def unplug(self) -> None:
        self._tell("unplug")

    def unplug_at(self, kind: int, after: int = 1) -> None:
        """Have the cable come out when so many requests of a kind have arrived."""
        self._tell(f"unplug_at {kind} {after}")

    def end(self) -> None:
        """Unplug the board for good."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait(ENDS_WITHIN_S)
        self._process.stdout.close()

    def _tell(self, words: str) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(words, file=self._process.stdin, flush=True)
        assert self._process.stdout.readline() == f"{words}\n"


def serve(port: Path) -> None:
    """Do what is said, line by line, and say it again once it is done."""
    cable = Cable(port)
    for line in sys.stdin:
        match line.split():
            case ["plug_in"]:
                cable.plug_in()
            case ["unplug"]:
                cable.unplug()
            case ["unplug_at", kind, after]:
                assert cable.board is not None
                cable.board.unplug_at(int(kind), int(after))
        print(line, end="", flush=True)
    cable.unplug()


if __name__ == "__main__":
    serve(Path(sys.argv[1]))
