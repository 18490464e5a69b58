"""A real Dask cluster on loopback: a scheduler and workers, each in a process of its own."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from distributed import Client

PATIENCE_S = 60.0
# Each has a thread, as a core; their own warnings are no affair of ours.
ONE = {"OMP_NUM_THREADS": "1", "PYTHONWARNINGS": "ignore"}


class DaskCluster:
    """A scheduler, and the workers that are started there."""

    def __init__(self, folder: Path, **environment: str) -> None:
        """Start the scheduler. environment: what is set for it besides."""
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        self.address, self._folder = f"tcp://127.0.0.1:{port}", folder
        self.processes = [self._started("scheduler", "--host", "127.0.0.1", "--port", str(port), **environment)]

    def start_worker(self, name: str, **environment: str) -> subprocess.Popen[bytes]:
        """Start a worker of one thread."""
        local = ("--host", "127.0.0.1", "--local-directory", str(self._folder), "--no-nanny", "--nthreads", "1")
        self.processes.append(self._started("worker", self.address, *local, "--name", name, **environment))
        return self.processes[-1]

    @contextmanager
    def client(self, workers: int) -> Iterator[Client]:
        """Yield a client of the test's own, once so many workers are there."""
        client = Client(self.address, timeout=PATIENCE_S, set_as_default=False)
        try:
            if workers:
                client.wait_for_workers(workers, timeout=PATIENCE_S)
            yield client
        finally:
            client.close(timeout=1)

    def end(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()

    def _started(self, *command: str, **environment: str) -> subprocess.Popen[bytes]:
        with (self._folder / "log").open("ab") as log:
            program = [sys.executable, "-m", "dask", *command, "--no-dashboard"]
            return subprocess.Popen(program, stderr=log, stdout=log, env=os.environ | ONE | environment)
