"""Steps that come late, on the simulated chip: what blocks its interrupts is late.c, linked with the firmware."""

import struct
from pathlib import Path

import numpy as np
import pytest

from firmware.flight.exchange import exchanges
from firmware.protocol import (
    ACKNOWLEDGE,
    BY_LATENESS,
    FAST_HZ,
    LINE,
    MOVE_BY,
    OK,
    RUN,
    SET_POSITION,
    SLOW_HZ,
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
SHORT_PIN, LONG_PIN, MIDDLE_PIN = 9, 10, 11
STEP_PINS = (2, 3, 4, 12)
PRESSED_MS, EVERY_MS = 700, 16
"""When interrupts are blocked, and from one time to the next."""
ALIKE = 0.02
CLOSEST_US = 4
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


def going(axes: int, speed: int, kind: int, hz: int = FAST_HZ) -> Talk:
    """Have so many axes move, fast, for longer than it takes to make them late."""
    talk = Talk()
    talk.begin(image([RampDesign(speed, 8 * speed, 8 * speed, hz)] * axes), None, InputSettings())
    talk.ask(SET_POSITION, for_axes(dict.fromkeys(range(axes), 0)))
    steps = dict.fromkeys(range(axes), speed)
    if kind == LINE:
        talk.ask(LINE, bytes([(1 << axes) - 1, 0]) + values_of(steps))
    else:
        talk.ask(MOVE_BY, for_axes(steps))
    return talk


@pytest.mark.parametrize(
    ("axes", "speed", "kind", "hz", "pin"),
    [
        (1, 100_000, MOVE_BY, FAST_HZ, SHORT_PIN),
        (4, 20_000, MOVE_BY, FAST_HZ, SHORT_PIN),
        (4, 60_000, LINE, FAST_HZ, SHORT_PIN),
        (1, 20_000, MOVE_BY, SLOW_HZ, MIDDLE_PIN),
    ],
)
def test_what_is_late_is_not_made_up_for(tmp_path: Path, axes: int, speed: int, kind: int, hz: int, pin: int) -> None:
    """Interrupts are blocked, once, for 0.25 ms, or 0.5 on the slow clock: the motors stand still for so long, and go
    on as they were."""
    talk = going(axes, speed, kind, hz)
    for axis in range(axes):
        talk.ask(STATUS, bytes([axis]), wait_ms=1300 if axis == 0 else 0)
    played = play(tmp_path, talk, pin, 1)
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


@pytest.mark.parametrize(("speed", "hz", "pin"), [(800, FAST_HZ, MIDDLE_PIN), (20_000, SLOW_HZ, SHORT_PIN)])
def test_what_is_less_late_is_made_up_for(tmp_path: Path, speed: int, hz: int, pin: int) -> None:
    """Interrupts are blocked, once, for less than an axis' interval, which nobody sees, or less than 384 us on the slow
    clock: soon its steps are again where they would have been."""
    talk = going(1, speed, MOVE_BY, hz)
    talk.ask(STATUS, b"\0", wait_ms=1300)
    played = play(tmp_path, talk, pin, 1)
    steps, usual = steps_of(played, 0), 16_000_000 / speed
    intervals = np.diff(steps)
    begin = np.searchsorted(steps, PRESSED_MS * 1000 * CYCLES_PER_US) - 1
    [late] = np.flatnonzero(intervals[begin : begin + 60] > usual + 50 * CYCLES_PER_US) + begin
    assert abs(steps[late + 10] - steps[late] - 10 * usual) < 5 * CYCLES_PER_US
    assert CLOSEST_US * CYCLES_PER_US <= intervals.min() == intervals[late + 1 : late + 10].min()
    [told] = [each for each in exchanges(played.frames) if each.kind == STATUS]
    assert Status.unpack(told.reply[:OUTPUT_STATUS_BYTES]).position == speed
    inputs = InputsStatus.unpack(told.reply[OUTPUT_STATUS_BYTES:])
    assert (inputs.stopped_by, inputs.known) == (0, 1)


def test_two_late_axes_of_one_channel_are_each_on_their_own(tmp_path: Path) -> None:
    """A slow one's next step may be half of the timer's round ahead: the quick one's, past by then, is no later one."""
    slow, quick, talk = RampDesign(540, 4000, 4000), RampDesign(8000, 64_000, 64_000), Talk()
    talk.begin(image([slow, slow, quick]), None, InputSettings())
    talk.ask(SET_POSITION, for_axes({0: 0, 2: 0}))
    talk.ask(MOVE_BY, for_axes({0: 540, 2: 8000}))
    talk.ask(STATUS, b"\2", wait_ms=1500)
    played = play(tmp_path, talk, MIDDLE_PIN, 1)
    for axis, speed in ((0, 540), (2, 8000)):
        usual, intervals = 16_000_000 / speed, np.diff(steps_of(played, axis))
        at_speed = intervals[len(intervals) // 10 : len(intervals) * 9 // 10]
        assert 380 * CYCLES_PER_US < at_speed.max() - usual < 520 * CYCLES_PER_US + usual
        assert at_speed.min() > 0.9 * usual
    [told] = [each for each in exchanges(played.frames) if each.kind == STATUS]
    assert Status.unpack(told.reply[:OUTPUT_STATUS_BYTES]).position == 8000
    inputs = InputsStatus.unpack(told.reply[OUTPUT_STATUS_BYTES:])
    assert (inputs.stopped_by, inputs.known) == (0, 0b101)


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
