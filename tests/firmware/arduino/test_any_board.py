"""The library where the board is no AVR: on this machine, under the sanitizers, with pins that are noted."""

import shutil
import subprocess
from pathlib import Path

import pytest

from firmware.arduino.board import LIBRARY, sources_of
from firmware.protocol import Ramp
from tools import require

HERE = Path(__file__).parent / "any_board"
SOURCES = LIBRARY / "src"
SLOW = Ramp([(10_000, 6, -1000), (4500, 50, -50)], 2000, [(10_000, 6, -1000), (4500, 40, -60)])
FAST = Ramp([(80_000, 6, -8000), (36_000, 50, -400)], 16_000, [(80_000, 6, -8000), (36_000, 40, -480)])
"""The same in ticks of the fast clock."""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Everything compiled in C++11, the oldest that such boards have, and without a warning."""
    require(*(tool for tool in ("gcc", "g++") if shutil.which(tool) is None))
    folder = tmp_path_factory.mktemp("any_board")
    flags = ["-DARDUINO=10819", "-g", "-O1", "-Wall", "-Wextra", "-Werror", f"-I{HERE}", f"-I{SOURCES}"]
    sanitizers = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    objects = []
    for source in [*sources_of(LIBRARY), *sorted(HERE.glob("*.cpp"))]:
        compiler = ["gcc", "-std=gnu11"] if source.suffix == ".c" else ["g++", "-std=c++11"]
        objects.append(str(folder / f"{len(objects)}.o"))
        command = [*compiler, *flags, *sanitizers, "-c", str(source), "-o", objects[-1]]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr
    wrapped = "-Wl,--wrap=arduino_has_timer"
    subprocess.run(["g++", *sanitizers, wrapped, "-o", str(folder / "scenarios"), *objects], check=True)
    return folder / "scenarios"


SCENARIOS = [
    "refuse",
    "move",
    "run",
    "set",
    "delay_loop",
    "gauge",
    "axes",
    "refused_begin",
    "begin_in_flight",
    "begin_together",
    "enable_and_missing_pins",
    "axis_in_flight",
    "another_begins",
    "slow_ramps",
    "too_many_axes",
    "shared_pins",
    "shared_inputs",
    "shared_stop",
    "for_75_minutes",
    "emergency_stop",
    "home",
    "two_homes",
    "short_stop",
    "bad_inputs",
    "soft_limits",
    "early_poll",
    "early_poll_without_inputs",
    "beside_a_line",
    "home_without_hold",
    "home_beside_another",
    "soft_limits_the_wrong_way_round",
    "a_line_that_is_not_begun",
    "known_positions",
    "known_positions_of_long_intervals",
    "clock_of_the_good",
]


def check(program: Path, scenario: str, image: bytes) -> None:
    result = subprocess.run([program, scenario, image.hex()], capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout + result.stderr) == (0, "")


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_does_what_its_header_says(program: Path, scenario: str) -> None:
    check(program, scenario, SLOW.image(2))


@pytest.mark.parametrize("scenario", ["move", "delay_loop"])
def test_ramps_of_the_fast_clock_are_played_as_well(program: Path, scenario: str) -> None:
    check(program, scenario, FAST.image(2, fast=True))
