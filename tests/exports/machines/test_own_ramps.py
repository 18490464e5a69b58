"""What libraries really play of a design, beside second computations: a C program, and a simulation of two timers."""

from __future__ import annotations

import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.controllers.own_ramp import Beside
from stepramp.exports.machines import accel_stepper_ramp, teensy_step_ramp
from stepramp.exports.machines.machines import MACHINES
from stepramp.exports.machines.teensy_step import TeensyFigures
from tools import require

SOURCE = Path(__file__).with_name("recurrence.c")
STRICT = ["-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion"]


@pytest.fixture(scope="module")
def recurrence(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*([] if shutil.which("gcc") else ["gcc"]))
    program = tmp_path_factory.mktemp("recurrence") / "recurrence"
    subprocess.run(["gcc", *STRICT, "-o", program, SOURCE, "-lm"], check=True)
    return program


def of_c(program: Path, steps: int, speed: float, rate: float) -> list[int]:
    run = subprocess.run([program, str(steps), repr(speed), repr(rate)], check=True, capture_output=True, text=True)
    return [int(each) for each in run.stdout.split()]


@pytest.mark.parametrize(
    ("steps", "speed", "rate"),
    [
        (2000, 1000.0, 5000.0),
        (2001, 1000.0, 5000.0),
        (7, 4000.0, 300.0),
        (3, 50.0, 20_000.0),
        (2, 1000.0, 1000.0),
        (1500, 3999.0, 12_345.0),
        (400, 10.0, 1.0),
        (20_000, 4000.0, 777.0),
    ],
)
def test_accelstepper_s_recurrence_is_that_of_a_c_program(
    recurrence: Path, steps: int, speed: float, rate: float
) -> None:
    """To the µs, in float."""
    waits = accel_stepper_ramp.intervals_us(steps, np.float32(speed), np.float32(rate))
    assert waits[:-1].tolist() == of_c(recurrence, steps, speed, rate)


def test_a_single_step_is_made_at_once() -> None:
    [wait] = accel_stepper_ramp.intervals_us(1, np.float32(1000), np.float32(5000))
    assert wait == math.floor(0.676 * math.sqrt(2 / 5000) * 1e6)


@given(st.integers(2, 3000), st.floats(20, 4000, width=32), st.floats(1, 1e5, width=32))
def test_accelstepper_begins_after_its_first_wait(steps: int, speed: float, rate: float) -> None:
    """c1 = c0 · (1 - 2/5), unless that is faster than its highest speed, or it slows down at once."""
    first, *_ = accel_stepper_ramp.intervals_us(steps, np.float32(speed), np.float32(rate))
    assert first == pytest.approx(max(0.6 * 0.676 * math.sqrt(2 / rate) * 1e6, 1e6 / speed), rel=1e-5, abs=1)


def timers(steps: int, speed: int, pull_in: int, rate: int) -> list[float]:
    """Return the waits of a step timer whose rate another one sets every 5 ms, from a list of what happens when."""
    up = (speed**2 - pull_in**2) // (2 * rate)
    made, waits = 0, []
    now_s, step_at_s, look_at_s, present = 0.0, 0.0, 0.005, pull_in
    while made < steps:
        now_s = min(step_at_s, look_at_s)
        if now_s == look_at_s:
            look_at_s += 0.005
            if made < min(up, steps // 2):
                present = int(math.sqrt(pull_in**2 + 2 * rate * made))
            elif up < steps // 2 and made < 2 * (steps // 2) - up:
                present = speed
            else:
                present = int(math.sqrt(pull_in**2 + 2 * rate * (steps - made - 1)))
            continue
        made += 1
        waits.append(1 / present)
        step_at_s = now_s + waits[-1]
    return waits


@pytest.mark.parametrize(
    ("steps", "speed", "pull_in", "rate"),
    [
        (2000, 1000, 50, 5000),
        (301, 5000, 200, 20_000),
        (300, 5000, 1, 20_000),
        (9000, 30_000, 500, 123_456),
        (2, 9, 9, 1),
    ],
)
def test_teensystep_changes_its_speed_every_5_ms(steps: int, speed: int, pull_in: int, rate: int) -> None:
    waits = teensy_step_ramp.intervals_s(steps, TeensyFigures(speed, pull_in, rate))
    assert waits[:-1] == pytest.approx(timers(steps, speed, pull_in, rate)[:-1], rel=1e-12)


@pytest.mark.parametrize(
    "machine", ["accelstepper", "teensystep", "tic", "tic_settings", "grbl", "fluidnc", "marlin", "klipper"]
)
@pytest.mark.parametrize("steps", [1, 2, -700, 3001])
def test_each_is_held_against_the_design(machine: str, steps: int) -> None:
    play = MACHINES[machine].play_own
    assert play is not None
    beside = Beside.of(design(move__steps=steps), play)
    assert beside.own.intervals_s.shape == beside.relative_error.shape == (abs(steps),)
    assert np.all(beside.own.intervals_s > 0)
    assert beside.own.losses


def test_what_isnt_followed_says_why() -> None:
    for machine in MACHINES.values():
        assert (machine.play_own is None) == machine.unplayed.endswith(".")
