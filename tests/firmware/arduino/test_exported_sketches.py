"""Exported sketches, built for an Uno without a warning and played in the simulator: when their pins change."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from firmware.arduino.board import UNO, Sketch, build_sketch
from firmware.arduino.pins import Edges, Move, edges_until, moves_of, times_us
from firmware.arduino.test_builds import STACK_BYTES
from firmware.arduino.test_examples import check_move
from simulator.avr import CLOCK_HZ, SimulatedController
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export
from stepramp.ramp.profile import profile_of

pytestmark = pytest.mark.usefixtures("arduino_tools")

STEP, LIBRARY_STEP, DIRECTION, ENABLE, START = 9, 2, 5, 8, 16
PRESS_MS = (START, 150, 250)
REST_US = 450_000
PULSE_US, DIRECTION_SETUP_US = 3, 30
TABLE = {"rows": [[4, 9000], [20, 2500], [60, 1200], [90, 640]], "interval_unit": "us"}


def built(folder: Path, asked: Design, kind: str = "arduino", bound: int = 0) -> Sketch:
    made = export(asked, kind, Options(segment_bound_ticks=bound))
    (folder / made.file_name).write_bytes(made.content)
    return build_sketch(folder / made.file_name, with_library=kind == "arduino_library")


def played(
    folder: Path, sketch: Sketch, is_enough: Callable[[Edges], bool], press_ms: tuple[int, int, int] = PRESS_MS
) -> Edges:
    return edges_until(SimulatedController(sketch.elf, folder, real_time=False, press=press_ms), is_enough)


def there_and_back(edges: Edges, pin: int) -> list[Move]:
    at_first = np.array([(0, DIRECTION, 0)], edges.dtype)  # A pin that stays low has no edge.
    return moves_of(np.concatenate((at_first, edges)), pin, DIRECTION, REST_US)


@pytest.mark.parametrize(
    "changes",
    [
        {"ramp__deceleration_steps_per_s2": 3000},
        {"method": {"name": "newton", "arithmetic": "fixed"}, "move__steps": 151},
        {"method": {"name": "first_order", "arithmetic": "float32", "rounding": "floor"}, "move__steps": -400},
        {"method": {"name": "table"}, "table": TABLE, "move__steps": 333},
        {"ramp__slew_speed_steps_per_s": 20_000, "ramp__acceleration_steps_per_s2": 400_000, "move__steps": 3000},
        {"timer__frequency_hz": 16_000_000, "timer__counter_bits": 32, "ramp__slew_speed_steps_per_s": 19_999,
         "ramp__acceleration_steps_per_s2": 500_000, "move__steps": -1500},
        {"timer__frequency_hz": 250_000, "ramp__base_speed_steps_per_s": 2, "move__steps": 60,
         "ramp__acceleration_steps_per_s2": 40},
        {"move__steps": 1},
    ],
    ids=["long", "newton", "formula", "table", "fast", "fast clock", "waits longer than the counter", "one step"],
)  # fmt: skip
def test_each_pulse_comes_in_the_planned_tick(tmp_path: Path, changes: dict[str, Any]) -> None:
    asked = design(**changes)
    planned, steps = profile_of(asked).intervals_ticks, abs(asked.move.steps)
    sketch = built(tmp_path, asked)
    assert sketch.warnings == ""
    edges = played(tmp_path, sketch, lambda edges: int((edges["pin"] == STEP).sum()) >= 4 * steps)
    there, back = there_and_back(edges, STEP)
    cycles_a_tick = CLOCK_HZ // int(asked.timer.frequency_hz)
    for move in (there, back):
        assert np.rint(move.intervals_us * 16).astype(int).tolist() == (planned[:-1] * cycles_a_tick).tolist()
    assert (there.backward, back.backward) == (asked.move.steps < 0, asked.move.steps > 0)
    # The last interval is part of the move; the rest comes after it.
    assert back.times_us[0] - there.times_us[-1] >= planned[-1] * cycles_a_tick / 16 + 500_000
    rises, falls = times_us(edges, STEP, 1), times_us(edges, STEP, 0)
    assert (falls - rises).min() >= PULSE_US
    turns = times_us(edges, DIRECTION, int(asked.move.steps < 0))
    assert back.times_us[0] - turns[-1] >= DIRECTION_SETUP_US
    [enabled] = times_us(edges, ENABLE, 0)
    assert 150_000 < enabled < rises[0] - 1000


@pytest.mark.parametrize("kind", ["arduino", "arduino_library"])
def test_a_button_that_is_held_from_the_beginning_starts_nothing(tmp_path: Path, kind: str) -> None:
    """As a wire to ground is; and its release doesn't either."""
    sketch = built(tmp_path, design(), kind, bound=10)
    simulated = SimulatedController(sketch.elf, tmp_path, real_time=False, press=(START, 0, 600))
    edges_until(simulated, lambda edges: bool(((edges["pin"] == START) & (edges["cycle"] > CLOCK_HZ // 2)).any()))
    edges = simulated.edges()
    assert simulated.statistics["cycles"] > 0.6 * CLOCK_HZ
    assert not (edges["pin"] == (STEP if kind == "arduino" else LIBRARY_STEP)).any()
    assert not ((edges["pin"] == ENABLE) & (edges["value"] == 0)).any(), "the driver stays off"


def test_the_library_plays_it_as_it_plays_its_examples(tmp_path: Path) -> None:
    asked = design(move__steps=-500)
    sketch = built(tmp_path, asked, "arduino_library")
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= UNO.flash_bytes
    assert sketch.ram_bytes <= UNO.ram_bytes - STACK_BYTES
    edges = played(tmp_path, sketch, lambda edges: int((edges["pin"] == LIBRARY_STEP).sum()) >= 2000)
    there, back = there_and_back(edges, LIBRARY_STEP)
    assert (there.backward, back.backward) == (True, False)
    for move in (there, back):
        check_move(move, profile_of(asked).intervals_ticks.tolist())


@pytest.mark.parametrize("speed", [2600, 96_000])
def test_above_what_polling_can_do_a_timer_makes_the_steps(tmp_path: Path, speed: int) -> None:
    """No step is more than 10 µs late, and the sketch says what it takes."""
    ramp = {"ramp__slew_speed_steps_per_s": speed, "ramp__acceleration_steps_per_s2": 8 * speed}
    asked = design(**ramp, timer__frequency_hz=16_000_000, timer__counter_bits=32, move__steps=-speed // 2)
    sketch = built(tmp_path, asked, "arduino_library", bound=6)
    assert sketch.warnings == ""
    assert sketch.flash_bytes <= UNO.flash_bytes
    text = (tmp_path / "test_library.ino").read_text()
    assert "#include <StepRampTimer1.h>" in text
    assert "analogWrite() on an Uno's pins 9 and 10" in text
    steps = abs(asked.move.steps)
    edges = played(tmp_path, sketch, lambda edges: int((edges["pin"] == LIBRARY_STEP).sum()) >= 4 * steps)
    there, back = there_and_back(edges, LIBRARY_STEP)
    assert (there.backward, back.backward) == (True, False)
    planned_us = np.cumsum(profile_of(asked).intervals_ticks[:-1]) / 16
    for move in (there, back):
        late = move.times_us[1:] - move.times_us[0] - planned_us
        # Each interval may be 6 ticks off by what was asked for, which adds up.
        assert np.abs(np.diff(late)).max() <= 20
        assert move.times_us.size == steps


def test_what_polling_can_do_leaves_the_timers_alone(tmp_path: Path) -> None:
    built(tmp_path, design(ramp__slew_speed_steps_per_s=2400), "arduino_library", bound=10)
    assert "Timer1" not in (tmp_path / "test_library.ino").read_text()


def test_the_longest_interval_is_played(tmp_path: Path) -> None:
    """2^28 - 1 ticks of 16 MHz, 16.8 s."""
    slowest = {"ramp__base_speed_steps_per_s": 0.0597, "ramp__slew_speed_steps_per_s": 0.0597}
    clock = {"timer__frequency_hz": 16_000_000, "timer__counter_bits": 32}
    asked = design(**slowest, **clock, move__steps=2)
    planned = profile_of(asked).intervals_ticks
    assert 2**28 - planned[0] < 2**20
    edges = played(tmp_path, built(tmp_path, asked), lambda edges: int((edges["pin"] == STEP).sum()) >= 4)
    cycles = edges["cycle"][(edges["pin"] == STEP) & (edges["value"] == 1)]
    assert cycles[1] - cycles[0] == planned[0]


def test_the_longest_ramp_fits_and_is_played(tmp_path: Path) -> None:
    ramp = {"ramp__slew_speed_steps_per_s": 19_000, "ramp__acceleration_steps_per_s2": 16_000}
    asked = design(**ramp, timer__frequency_hz=16_000_000, timer__counter_bits=32, move__steps=-24_000)
    sketch = built(tmp_path, asked)
    rows = re.findall(r"^ +\{\d+, [1-9]\d*, -?\d+\},$", (tmp_path / "test.ino").read_text(), re.MULTILINE)
    assert 3400 < len(rows) <= 3500
    assert sketch.flash_bytes <= UNO.flash_bytes
    edges = played(tmp_path, sketch, lambda edges: int((edges["pin"] == STEP).sum()) >= 48_000)
    cycles = edges["cycle"][(edges["pin"] == STEP) & (edges["value"] == 1)][:24_000]
    assert np.diff(cycles).tolist() == profile_of(asked).intervals_ticks[:-1].tolist()


TOO_LONG = {"timer__frequency_hz": 16_000_000, "ramp__slew_speed_steps_per_s": 9000,
            "ramp__acceleration_steps_per_s2": 500}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "changes", "message"),
    [
        ("arduino", {"timer__frequency_hz": 1_000_000}, "frequency_hz is .*; allowed: 16,000,000 or 2,000,000 or"),
        ("arduino_library", {"timer__frequency_hz": 1_000_000}, "frequency_hz is .*; allowed: 2,000,000 or 16"),
        ("arduino", {"ramp__slew_speed_steps_per_s": 20_500, "ramp__acceleration_steps_per_s2": 1e6},
         r"slew_speed_steps_per_s is 20500.0; allowed: at most 20,000 steps/s"),
        ("arduino_library", {"timer__frequency_hz": 16_000_000, "ramp__slew_speed_steps_per_s": 101_000,
         "ramp__acceleration_steps_per_s2": 1e8},
         r"slew_speed_steps_per_s is 101000.0; allowed: at most 100,000 steps/s"),
        ("arduino", {"method": {"name": "table"}, "table": {"rows": [[4, 900], [9, 49]], "interval_unit": "us"}},
         r"table\.rows\.1\.1 is 49; allowed: at least 50 µs"),
        ("arduino", {"method": {"name": "table"}, "table": {"rows": [[4, 90], [9, 799]], "interval_unit": "ticks"}},
         r"table\.rows\.0\.1 is 90; allowed: at least 100 ticks"),
        ("arduino", {"method": {"name": "table"}, "table": {"rows": [[4, 2**28], [9, 49]], "interval_unit": "ticks"}},
         r"table\.rows\.1\.1 is 49"),
        ("arduino", {"method": {"name": "table"}, "table": {"rows": [[4, 2**28], [9, 490]], "interval_unit": "ticks"}},
         r"table\.rows\.0\.1 is 268435456; allowed: at most 268,435,455 ticks"),
        ("arduino", {"ramp__base_speed_steps_per_s": 0.007, "ramp__slew_speed_steps_per_s": 0.007},
         r"slew_speed_steps_per_s is 0.007; allowed: at least 0.00745059 steps/s"),
        ("arduino", {"timer__frequency_hz": 16_000_000, "ramp__acceleration_steps_per_s2": 0.001,
         "ramp__slew_speed_steps_per_s": 0.08}, r"acceleration_steps_per_s2 is 0.001; allowed: faster"),
        ("arduino", TOO_LONG, r"segment_bound_ticks is 0; allowed: more, .* at most 3,500 segments instead of"),
        ("arduino_library", {"ramp__acceleration_steps_per_s2": 500, "ramp__slew_speed_steps_per_s": 2000},
         r"segment_bound_ticks is 0; allowed: more"),
    ],
)  # fmt: skip
def test_what_no_uno_can_play_is_refused(kind: str, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(Rejected, match=message):
        export(design(**changes), kind, Options())


def test_a_segment_that_is_too_short_is_not_blamed_on_a_speed_that_is_allowed() -> None:
    changes = {
        "timer__frequency_hz": 2_000_000,
        "ramp__slew_speed_steps_per_s": 20_000,
        "ramp__acceleration_steps_per_s2": 1e6,
    }
    export(design(**changes), "arduino", Options())
    # 100 ticks less a deviation of two.
    with pytest.raises(Rejected, match=r"is 20000.0; allowed: at most 19,600 steps/s.*this ramp's shortest is 49 µs"):
        export(design(**changes), "arduino", Options(segment_bound_ticks=2))


def test_no_name_of_a_design_breaks_a_sketch(tmp_path: Path) -> None:
    for kind in ("arduino", "arduino_library"):
        assert built(tmp_path, design(name="a */ #error\n$title ??/ \\"), kind, bound=20).warnings == ""
