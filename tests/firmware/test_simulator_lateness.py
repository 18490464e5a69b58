"""Steps that come late, on the simulated chip: what blocks its interrupts is late.c, linked with the firmware."""

import struct
from pathlib import Path

import numpy as np
import pytest

from firmware.flight.exchange import exchanges
from firmware.protocol import (
    ACKNOWLEDGE,
    BY_LATENESS,
    LINE,
    MOVE_BY,
    OK,
    RUN,
    SET_POSITION,
    STATUS,
    STOPPED,
    InputSettings,
    InputsStatus,
    Settings,
    Status,
    for_axes,
    values_of,
)
from firmware.rig import RampDesign, image
from firmware.talk import CYCLES_PER_US, Talk
from firmware.test_simulator_inputs import OUTPUT_STATUS_BYTES
from simulator.avr import build_firmware, build_harness, converse, missing_tools
from tools import require

LATE = Path(__file__).with_name("late.c")
SHORT_PIN, LONG_PIN = 9, 10
STEP_PINS = (2, 3, 4, 12)
PRESSED_MS, EVERY_MS = 700, 16
"""When interrupts are blocked, and from one time to the next."""
ALIKE = 0.02
CLOSEST_US = 4.5
"""Of two steps of an axis, whatever comes in between."""


@pytest.fixture(scope="module", autouse=True)
def tools() -> None:
    require(*missing_tools())
    build_harness()


def play(tmp_path: Path, talk: Talk, pin: int, times: int):
    firmware = build_firmware("INPUTS=yes", f"BESIDE={LATE} -Wl,--wrap=board_milliseconds")
    presses = [(pin, begin, begin + EVERY_MS / 2) for begin in PRESSED_MS + EVERY_MS * np.arange(times)]
    return converse(firmware, tmp_path, talk.asked, presses)


def steps_of(played, axis: int):
    edges = played.edges
    return edges["cycle"][(edges["pin"] == STEP_PINS[axis]) & (edges["value"] == 1)].astype(np.int64)


def going(axes: int, speed: int, kind: int, settings: Settings | None = None) -> Talk:
    """Have so many axes move, fast, for longer than it takes to make them late."""
    talk = Talk()
    talk.begin(image([RampDesign(speed, 8 * speed, 8 * speed)] * axes), settings, InputSettings())
    talk.ask(SET_POSITION, for_axes(dict.fromkeys(range(axes), 0)))
    steps = dict.fromkeys(range(axes), speed)
    if kind == LINE:
        talk.ask(LINE, bytes([(1 << axes) - 1, 0]) + values_of(steps))
    else:
        talk.ask(MOVE_BY, for_axes(steps))
    return talk


@pytest.mark.parametrize(("axes", "speed", "kind"), [(1, 100_000, MOVE_BY), (4, 20_000, MOVE_BY), (4, 60_000, LINE)])
def test_what_is_late_is_not_made_up_for(tmp_path: Path, axes: int, speed: int, kind: int) -> None:
    """Interrupts are blocked for 0.25 ms, once: the motors stand still for so long, and go on as they were."""
    talk = going(axes, speed, kind)
    for axis in range(axes):
        talk.ask(STATUS, bytes([axis]), wait_ms=1300 if axis == 0 else 0)
    played = play(tmp_path, talk, SHORT_PIN, 1)
    told = [each for each in exchanges(played.frames) if each.kind == STATUS]
    for axis in range(axes):
        intervals = np.diff(steps_of(played, axis))
        usual = intervals[len(intervals) // 2]
        late = np.flatnonzero(intervals > 240 * CYCLES_PER_US)
        late = late[(late > len(intervals) // 10) & (late < len(intervals) * 9 // 10)]
        assert len(late) == 1
        behind = intervals[late[0] + 1 : late[0] + 40]
        assert behind.min() > usual * 0.6 - 30 * CYCLES_PER_US * (axes > 1)
        assert intervals.min() >= CLOSEST_US * CYCLES_PER_US
        assert abs(np.median(behind) / usual - 1) < ALIKE
        status = Status.unpack(told[axis].reply[:OUTPUT_STATUS_BYTES])
        assert (status.position, status.starved) == (speed, 0)
    inputs = InputsStatus.unpack(told[-1].reply[OUTPUT_STATUS_BYTES:])
    assert (inputs.stopped_by, inputs.known) == (0, (1 << axes) - 1)


@pytest.mark.parametrize(("axes", "speed", "kind"), [(1, 100_000, MOVE_BY), (4, 20_000, MOVE_BY), (4, 60_000, LINE)])
@pytest.mark.parametrize(("pin", "times"), [(LONG_PIN, 1), (SHORT_PIN, 6)])
def test_what_is_too_late_halts_all(tmp_path: Path, axes: int, speed: int, kind: int, pin: int, times: int) -> None:
    talk = going(axes, speed, kind)
    talk.ask(STATUS, b"\0", wait_ms=700)
    talk.ask(MOVE_BY, for_axes({0: 10}))
    talk.ask(ACKNOWLEDGE)
    talk.ask(STATUS, b"\0")
    talk.ask(MOVE_BY, for_axes({0: 10}))
    talk.ask(STATUS, b"\0", wait_ms=300)
    played = play(tmp_path, talk, pin, times)
    first, acknowledged, last = (each for each in exchanges(played.frames) if each.kind == STATUS)
    inputs = InputsStatus.unpack(first.reply[OUTPUT_STATUS_BYTES:])
    assert (inputs.stopped_by, inputs.known) == (BY_LATENESS, 0)
    assert InputsStatus.unpack(acknowledged.reply[OUTPUT_STATUS_BYTES:]).stopped_by == 0
    asked = [each.status for each in exchanges(played.frames) if each.kind in (MOVE_BY, ACKNOWLEDGE)]
    assert asked[-3:] == [STOPPED, OK, OK]
    before = Status.unpack(first.reply[:OUTPUT_STATUS_BYTES])
    assert 0 < before.position < speed
    assert Status.unpack(last.reply[:OUTPUT_STATUS_BYTES]).position == before.position + 10
    assert len(steps_of(played, 0)) == before.position + 10
    for axis in range(axes):
        assert np.diff(steps_of(played, axis)).min() >= CLOSEST_US * CYCLES_PER_US


def test_at_its_limits_it_is_never_late(tmp_path: Path) -> None:
    """Four axes, the widest pulses that they can have: what other axes' pulses take is made up for."""
    plan, talk = RampDesign(3000, 60_000, 60_000), Talk()
    talk.begin(image([plan] * 4), Settings(pulse_width_us=36), InputSettings())
    talk.ask(RUN, for_axes(dict.fromkeys(range(4), plan.slew)))
    for _ in range(6):
        talk.ask(STATUS, b"\0", wait_ms=150)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked)
    told = [each for each in exchanges(played.frames) if each.kind == STATUS]
    assert [InputsStatus.unpack(each.reply[OUTPUT_STATUS_BYTES:]).stopped_by for each in told] == [0] * 6
    assert [struct.unpack("<B", each.reply[1:2]) for each in told] == [(1,)] * 6
