"""The tests of a real controller work: run here with the simulated one, and skipped without any."""

import os
import subprocess
import sys
from pathlib import Path

from simulator.avr import SimulatedController, build_firmware, missing_tools
from tools import require

MODULE = Path(__file__).with_name("test_real_controller.py")


def run(*options: str, **environment: str) -> str:
    """Run the module by itself; return the summary's last line."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(MODULE), *options]
    outer = {"CI", "PYTEST_ADDOPTS"}
    settings = {name: value for name, value in os.environ.items() if name not in outer} | environment
    result = subprocess.run(command, capture_output=True, text=True, check=False, env=settings, cwd=MODULE.parents[2])
    return result.stdout.rstrip().splitlines()[-1]


def test_with_a_simulated_controller(tmp_path: Path) -> None:
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path, boot_ms=300, real_time=False) as simulated:
        assert run("--device-port", simulated.port, "--allow-moves").startswith("5 passed")
    assert simulated.statistics["edges"] > 800


def test_motors_move_only_when_they_may(tmp_path: Path) -> None:
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path, real_time=False) as simulated:
        assert run("--device-port", simulated.port).startswith("2 passed, 3 skipped")
    edges = simulated.edges()
    assert not (edges["pin"] == 2).any()


def test_without_a_controller() -> None:
    assert run().startswith("5 skipped")
    assert run("--device-port", "/dev/null", CI="true").startswith("5 skipped")
