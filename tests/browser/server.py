"""The real server in a process of its own, and a real browser."""

import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Self

ROOT = Path(__file__).parents[2]
CHROMIUM = Path("/usr/bin/chromium")
CHROMIUM_ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
START_WITHIN_S = 120


class Server:
    """`stepramp` on a free port; it can be ended and started again at the same address."""

    def __init__(self, *options: str, lines: int = 0) -> None:
        """options: of the command line, besides the port. lines: so many of what it prints as it begins are kept."""
        self._options = options
        self._lines = lines
        self.said: list[str] = []
        """The first lines that it has printed."""
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port: int = probe.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}/"
        self._process: subprocess.Popen[str] | None = None

    def start(self) -> None:
        """Start the server and wait until it answers."""
        command = [sys.executable, "-m", "stepramp", "--port", str(self.port), "--no-browser", *self._options]
        out = subprocess.PIPE if self._lines else subprocess.DEVNULL
        self._process = subprocess.Popen(command, cwd=ROOT, stdout=out, text=True)
        if self._process.stdout is not None:
            self.said = [self._process.stdout.readline() for _ in range(self._lines)]
        deadline = time.monotonic() + START_WITHIN_S
        while not self._answers():
            if self._process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"the server on port {self.port} did not start")
            time.sleep(0.1)

    def stop(self) -> None:
        """End the server as a person would, and wait until it is gone."""
        if self._process is None:
            return
        self._process.terminate()
        self._process.wait(timeout=60)
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._process = None

    @property
    def pid(self) -> int:
        """The number of its process, while it runs."""
        assert self._process is not None
        return self._process.pid

    @contextmanager
    def hung(self) -> Iterator[None]:
        """Let the server do nothing at all for a while, which ends no connection."""
        assert self._process is not None
        self._process.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self._process.send_signal(signal.SIGCONT)

    def _answers(self) -> bool:
        try:
            with urllib.request.urlopen(f"{self.url}api/v1/health", timeout=1):
                return True
        except (urllib.error.URLError, OSError):
            return False

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
