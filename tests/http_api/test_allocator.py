"""What long moves have taken of memory is given back: a server of long sessions stays as it was."""

import ctypes
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from designs import document
from server_process import ServerProcess

if sys.platform != "linux" or not hasattr(ctypes.CDLL(None), "mallopt"):
    pytest.skip("only glibc is told to", allow_module_level=True)

WORKING_MB = 200
"""What is loaded while the first requests come, and what is under way: 36 to 103 MB more than after the first plan were
measured, and no more after four such rounds. Without what glibc is told it is 416 MB after the first of them."""


def resident_mb(server: ServerProcess) -> int:
    lines = Path(f"/proc/{server.process.pid}/status").read_text("ascii").splitlines()
    [told] = [line for line in lines if line.startswith("VmRSS:")]
    return int(told.split()[1]) // 1024


def test_what_long_moves_took_is_given_back() -> None:
    """Arrays of 4 to 24 MB from several threads; what stays of them is none of it."""

    def plan(number: int) -> None:
        ramp_steps = 500_000 + 125_000 * (number * 7 % 20)
        long = document(
            timer__frequency_hz=64e6, ramp__slew_speed_steps_per_s=2e5, move__steps=2 * ramp_steps + 1000,
            ramp__acceleration_steps_per_s2=2e10 / ramp_steps,
        )  # fmt: skip
        server.ask("POST", "profile", {"design": long, "max_points": 1000})

    with ServerProcess(8960) as server:
        plan(0)
        before = resident_mb(server)
        with ThreadPoolExecutor(3) as clients:
            list(clients.map(plan, range(24)))
        assert resident_mb(server) < before + WORKING_MB
