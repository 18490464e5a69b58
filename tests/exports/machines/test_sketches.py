"""Sketches with other people's libraries: they compile, say what was designed, and move nothing unasked."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from exports.machines.sketches import HERE_TOO, LIBRARIES, ON_AVR, compile_strictly, run_on_bench, written
from exports.test_files import NASTY
from stepramp.ramp.profile import profile_of

PLAIN = {"move__steps": 200, "ramp__base_speed_steps_per_s": 100}
FIGURES: dict[str, list[list[str]]] = {
    "accelstepper": [["speed", "1000"], ["acceleration", "5000"]],
    # 100² / (2 · 5000) = 1 step.
    "fastaccelstepper": [["speed", "1000000"], ["acceleration", "5000"], ["jump", "1"]],
    "teensystep": [["speed", "1000"], ["acceleration", "5000"], ["pull-in", "100"]],
}
GAUGE = {"rows": [[4, 9000], [20, 2500], [60, 1200], [90, 640]], "interval_unit": "us"}


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("compiler", [HERE_TOO, ON_AVR], ids=["g++", "avr-g++"])
@pytest.mark.parametrize("name", ["Lead-screw stage", NASTY])
def test_a_sketch_compiles_without_a_warning(tmp_path: Path, library: str, compiler: list[str], name: str) -> None:
    compile_strictly(compiler, written(tmp_path, design(name=name), library))


@pytest.mark.parametrize("library", FIGURES)
def test_nothing_moves_until_the_button_is_pressed(tmp_path: Path, library: str) -> None:
    told = run_on_bench(written(tmp_path, design(**PLAIN), library), library)
    assert sorted(words for words in told if words[1] != "pin") == sorted(FIGURES[library])


@pytest.mark.parametrize("library", FIGURES)
@pytest.mark.parametrize("steps", [200, -200])
def test_it_moves_there_and_back(tmp_path: Path, library: str, steps: int) -> None:
    sketch = written(tmp_path, design(**{**PLAIN, "move__steps": steps}), library)
    moves = [words for words in run_on_bench(sketch, library, 1000) if words[1] in ("move", "stop")]
    assert [int(words[2]) for words in moves] == [steps, -steps]
    # The button has been down for 20 ms; 200 steps of 10 ms here; a rest of half a second.
    assert int(moves[0][0]) == pytest.approx(1_020_000, abs=1000)
    assert int(moves[1][0]) == pytest.approx(1_020_000 + 2_000_000 + 500_000, abs=2000)


@pytest.mark.parametrize("library", FIGURES)
def test_a_press_on_the_way_ends_it(tmp_path: Path, library: str) -> None:
    told = run_on_bench(written(tmp_path, design(**PLAIN), library), library, 1000, 2000)
    assert [words[1] for words in told if words[1] in ("move", "stop")] == ["move", "stop"]


@pytest.mark.parametrize("library", FIGURES)
def test_a_press_in_the_rest_keeps_it_there(tmp_path: Path, library: str) -> None:
    told = run_on_bench(written(tmp_path, design(**PLAIN), library), library, 1000, 3100)
    assert [words[1] for words in told if words[1] in ("move", "stop")] == ["move"]


def test_a_board_that_is_too_slow_moves_nothing(tmp_path: Path) -> None:
    # The bench's FastAccelStepper refuses what an Uno's does.
    asked = design(ramp__slew_speed_steps_per_s=50_001, ramp__acceleration_steps_per_s2=1e6)
    told = run_on_bench(written(tmp_path, asked, "fastaccelstepper"), "fastaccelstepper", 1000)
    assert ["0", "pin", "13", "1"] in told
    assert not [words for words in told if words[1] == "move"]


TICKS = {"rows": [[30, 5000], [300, 2000]], "interval_unit": "ticks"}


@pytest.mark.parametrize(
    ("steps", "table"),
    # 178 = 2 · 90 - 2 is the longest even one that doesn't get to the last row.
    [(1, GAUGE), (3, GAUGE), (177, GAUGE), (179, GAUGE), (180, GAUGE), (333, GAUGE), (599, TICKS), (600, TICKS)],
    ids=str,
)
def test_a_gauge_plays_the_planned_ramp(tmp_path: Path, steps: int, table: Any) -> None:
    # At 1 MHz a tick is a µs.
    asked = design(timer__frequency_hz=1_000_000, method__name="table", table=table, move__steps=steps)
    sketch = written(tmp_path, asked, "switecx25")
    assert "plays the table as planned" in sketch.read_text()
    told = [words for words in run_on_bench(sketch, "switecx25", 1000, tick_us=1) if words[1] != "pin"]
    assert told[0][1] == "zero"
    instants = [int(words[0]) for words in told if words[1] in ("step", "rest")]
    there, back = np.diff(instants[: steps + 1]), np.diff(instants[steps + 1 :])
    planned = profile_of(asked).intervals_ticks.tolist()
    assert there.tolist() == back.tolist() == planned
    positions = [int(words[2]) for words in told if words[1] == "step"]
    assert positions == [*range(1, steps + 1), *reversed(range(steps))]


@pytest.mark.parametrize("steps", [2, 150, 178])
def test_a_gauge_that_goes_a_step_too_far_is_told(tmp_path: Path, steps: int) -> None:
    asked = design(timer__frequency_hz=1_000_000, method__name="table", table=GAUGE, move__steps=steps)
    sketch = written(tmp_path, asked, "switecx25")
    told = [words for words in run_on_bench(sketch, "switecx25", 1000, tick_us=1) if words[1] in ("step", "rest")]
    at_rest = next(number for number, words in enumerate(told) if words[1] == "rest")
    assert [int(words[2]) for words in told[:at_rest]] == [*range(1, steps + 2), steps]
    text = sketch.read_text()
    assert f"{steps} steps goes one step too far and comes back" in text
    assert "as planned" not in text


def test_a_gauge_is_stopped_by_its_table(tmp_path: Path) -> None:
    asked = design(timer__frequency_hz=1_000_000, method__name="table", table=GAUGE, move__steps=900)
    told = run_on_bench(written(tmp_path, asked, "switecx25"), "switecx25", 1000, 1300, tick_us=1)
    steps = [int(words[2]) for words in told if words[1] == "step"]
    assert 0 < steps[-1] < 900
    assert all(after - before == 1 for before, after in itertools.pairwise(steps))
    assert [words[1] for words in told][-1] == "rest"
