"""The real ser2net, with a serial port behind it that may be reached over the network of this machine."""

from __future__ import annotations

import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Self

from tools import require

PATIENCE_S = 10.0


class Ser2net:
    """Runs while the context lasts; it can be killed and begun again.

    scheme: how its port is reached. address: where.
    """

    def __init__(self, scheme: str, port: str, baud_rate: int, folder: Path) -> None:
        require(*([] if shutil.which("ser2net") else ["ser2net"]))
        with socket.create_server(("127.0.0.1", 0)) as free:
            number = free.getsockname()[1]
        self.host = f"127.0.0.1:{number}"
        self.address = f"{scheme}://{self.host}"
        self._settings = folder / "ser2net.yaml"
        accepts = "telnet(rfc2217),tcp" if scheme == "rfc2217" else "tcp"
        self._settings.write_text(
            f"connection: &port\n  accepter: {accepts},127.0.0.1,{number}\n"
            f"  connector: serialdev(nouucplock=true),{port},{baud_rate}n81,local\n"
        )
        self._process: subprocess.Popen[bytes] | None = None

    def begin(self) -> None:
        """Start it, and wait until it listens."""
        command = ["ser2net", "-n", "-c", str(self._settings), "-P", str(self._settings.with_suffix(".pid"))]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        host, _, number = self.host.partition(":")
        listening = f"{int.from_bytes(socket.inet_aton(host)[::-1]):08X}:{int(number):04X} 00000000:0000 0A"
        deadline_s = time.monotonic() + PATIENCE_S
        # Without a connection: it would have the serial port opened.
        while listening not in Path("/proc/net/tcp").read_text():
            assert self._process.poll() is None, "ser2net has ended"
            assert time.monotonic() < deadline_s
            time.sleep(0.02)

    def kill(self) -> None:
        """End it with all its connections."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def freeze(self) -> None:
        """Let nothing go through it, as when the network hangs: its connections stay."""
        assert self._process is not None
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        """Go on."""
        assert self._process is not None
        self._process.send_signal(signal.SIGCONT)

    def __enter__(self) -> Self:
        self.begin()
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()
