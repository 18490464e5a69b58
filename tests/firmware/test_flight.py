"""The judge of motors in flight sees each kind of fault, and none where there is none."""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
import pytest

from firmware.checker import CYCLES_PER_S, DIRECTION_PINS, STEP_PINS
from firmware.flight.judge import judge
from firmware.flight.judgement import Judgement
from firmware.flight.setting import LATE_US, Setting, Slopes
from firmware.protocol import (
    HALT,
    LINE,
    MOVE_BY,
    MOVE_TO,
    RUN,
    STATUS,
    STOP,
    Ramp,
    Settings,
    encode_frame,
    for_axes,
    values_of,
)
from simulator.avr import EDGE, Conversation, Frame

MS = CYCLES_PER_S // 1000
US = CYCLES_PER_S // 1_000_000
SLEW = 1600
WAY = np.round(CYCLES_PER_S / np.sqrt(2 * 200_000 * (np.arange(250) + 0.5)))
"""Intervals of an even acceleration to slew speed, 10,000 steps/s."""
SLOPES = Slopes(WAY, WAY, SLEW)
SETTING = Setting([SLOPES], 1, Settings())
BEGIN = 10 * MS
STEPS = 3000
Times = npt.NDArray[np.int64]


def move(steps: int = STEPS) -> Times:
    """Return when the steps of a move come that begins at BEGIN."""
    way = [(int(interval), 1, 0) for interval in WAY]
    return after(Ramp(way, SLEW, way).intervals(steps))


def after(intervals: npt.ArrayLike) -> Times:
    """Return when steps with these intervals come; the last one isn't followed by a step."""
    return BEGIN + np.concatenate(([0], np.cumsum(np.asarray(intervals)[:-1]))).astype(np.int64)


@dataclass
class Told:
    """Requests with their answers; status is asked for at the end."""

    frames: list[Frame] = field(default_factory=list)

    def tell(self, at: int, kind: int, body: bytes = b"", reply: bytes = b"\0", answer_ms: float = 1) -> "Told":
        header = struct.pack("<HB", 1, len(self.frames) & 0xFF)
        self.frames.append(Frame(True, at - MS, at, encode_frame(bytes([kind]) + header + body)))
        answered = at + int(answer_ms * MS)
        self.frames.append(Frame(False, answered, answered, encode_frame(bytes([kind | 0x80]) + header + reply)))
        return self

    def move(self, target: int = STEPS, at: int = BEGIN - 3 * MS) -> "Told":
        return self.tell(at, MOVE_TO, for_axes({0: target}), b"\0" + struct.pack("<i", target))

    def status(self, at: int, position: int, target: int, *, state: int = 0, starved: int = 0) -> "Told":
        numbers = struct.pack("<BBBiiIIIHBB", 0, state, state, position, target, 0, 0, 0, 0, 0, starved)
        return self.tell(at, STATUS, b"\0", numbers)


def flown(
    times: Times,
    told: Told,
    *,
    setting: Setting = SETTING,
    turns: Sequence[int] = (),
    width: int = 40,
    others: Sequence[Times] = (),
) -> Judgement:
    """Return the judgement of steps at these times; the direction turns at others, and is forward at first."""
    rows = [(0, pin, 1) for pin in DIRECTION_PINS]
    rows += [(turn, DIRECTION_PINS[0], number % 2) for number, turn in enumerate(turns)]
    for axis, its in enumerate([times, *others]):
        rows += [(int(t) + after, STEP_PINS[axis], value) for t in its for after, value in ((0, 1), (width, 0))]
    statistics = {"lost_bytes": 0, "resets": 1}
    return judge(Conversation(told.frames, np.array(sorted(rows), EDGE), statistics), setting)


def ended(told: Told, position: int = STEPS) -> Told:
    return told.status(1000 * MS, position, position)


def seen(*args: object, **how: object) -> str:
    return "; ".join(flown(*args, **how).faults)  # type: ignore[arg-type]  # of flown


@pytest.mark.parametrize("steps", [1, 2, 3, 100, 499, 501, STEPS])
def test_an_even_move_is_good(steps: int) -> None:
    judgement = flown(move(steps), ended(Told().move(steps), steps))
    assert judgement.faults == []
    assert judgement.latest_us == 0


def test_lateness_is_forgiven_as_far_as_it_is_stated() -> None:
    late = np.random.default_rng(1).integers(0, int(LATE_US[0] * US), STEPS)
    judgement = flown(move() + late, ended(Told().move()))
    assert judgement.faults == []
    assert 2 < judgement.latest_us <= LATE_US[0]


@pytest.mark.parametrize("at", [20, 100, 249, 300, 1500, 2760, 2900, 2990])
def test_a_pause_at_speed(at: int) -> None:
    """A queue ran dry: all that follows comes later. Where it is slower, it takes a longer pause to tell."""
    times = move()
    times[at:] += max(2 * int(times[at] - times[at - 1]), 100 * US)
    assert "a pause at speed" in seen(times, ended(Told().move()))


@pytest.mark.parametrize("us", [8, -8])
@pytest.mark.parametrize("at", [249, 1500, 2760])
def test_a_single_step_late_or_early(at: int, us: int) -> None:
    times = move()
    times[at] += us * US
    assert seen(times, ended(Told().move()))


@pytest.mark.parametrize("at", [1, 5, 50, 248, 1500, 2800, 2990])
def test_a_short_interval(at: int) -> None:
    """One that has been played as half of it."""
    times = move()
    times[at:] -= (times[at] - times[at - 1]) // 2
    assert "too fast" in seen(times, ended(Told().move())) or "slew interval" in seen(times, ended(Told().move()))


@pytest.mark.parametrize("at", [0, 3, 30, 200])
def test_a_ramp_up_with_intervals_left_out(at: int) -> None:
    left_out = np.concatenate((WAY[:at], WAY[at + 30 :], np.full(500, SLEW), WAY[::-1]))
    times = after(left_out)
    assert "the speed rises too fast" in seen(times, ended(Told().move(times.size), times.size))


@pytest.mark.parametrize("at", [5, 30, 200])
def test_a_ramp_down_with_intervals_left_out(at: int) -> None:
    left_out = np.concatenate((WAY, np.full(500, SLEW), WAY[::-1][: -at - 30], WAY[::-1][-at:]))
    times = after(left_out)
    assert "a pause at speed" in seen(times, ended(Told().move(times.size), times.size))


@pytest.mark.parametrize("made", [100, 1000, 2900])
def test_an_end_at_speed(made: int) -> None:
    assert "a pause at speed" in seen(move()[:made], ended(Told().move(made), made))


def test_a_halt_may_end_it_at_speed_but_at_once() -> None:
    times = move()
    halted = int(times[1000]) + 100

    def told() -> Told:
        return Told().move().tell(halted, HALT)

    assert seen(times[:1002], ended(told(), 1002)) == ""
    assert "after a halt" in seen(times[:1040], ended(told(), 1040))


def turned(at: int, pause: int) -> tuple[Times, dict[str, object], int]:
    """Return a move that goes back after so many of its steps, the direction set in the middle of a pause."""
    times = move()
    turn = int(times[at - 1]) + pause // 2
    times = np.concatenate((times[:at], times[at - 1] + pause + move(500) - BEGIN))
    forward = np.arange(times.size) < at
    return times, {"turns": [turn]}, int(2 * forward.sum() - times.size)


@pytest.mark.parametrize(("at", "good"), [(1000, False), (2900, False), (3000, True)])
def test_a_reversal_at_speed(at: int, good: bool) -> None:
    times, how, end = turned(at, 10 * MS)
    found = seen(times, ended(Told().move(), end).move(end, at=BEGIN), **how)
    assert ("the direction changes at speed" in found) != good


def test_the_direction_set_too_late() -> None:
    times, _, end = turned(3000, 10 * MS)
    told = Told().move().move(end, at=BEGIN + MS)
    assert seen(times, ended(told, end), turns=[int(times[3000]) - 30 * US]) == ""
    assert "29.00 us after the direction" in seen(times, ended(told, end), turns=[int(times[3000]) - 29 * US])


def test_a_turn_too_soon_after_the_last_step() -> None:
    times, how, end = turned(3000, int(WAY[0]) // 2)
    assert "from a step to one back" in seen(times, ended(Told().move(), end), **how)


def dipped(depth: int) -> Times:
    """Return a move that slows down along its ramp in the middle, and rises again."""
    down = WAY[::-1][:depth]
    intervals = np.concatenate((WAY, np.full(700, SLEW), down, down[::-1], np.full(700, SLEW), WAY[::-1]))
    return after(intervals)


def test_a_dip_has_an_order() -> None:
    times = dipped(200)
    ordered = Told().move().move(times.size, at=int(times[1150]))
    assert seen(times, ended(ordered, times.size)) == ""
    assert "dips to" in seen(times, ended(Told().move(times.size), times.size))


def test_a_rise_after_a_stop() -> None:
    times = dipped(200)
    told = Told().move().tell(int(times[970]), STOP)
    assert "off after a stop" in seen(times, ended(told, times.size))


@pytest.mark.parametrize(("ahead_us", "good"), [(2, True), (-2, False)])
def test_a_first_step_while_a_stop_is_obeyed(ahead_us: int, good: bool) -> None:
    """The motor is halted after it, so that the next motion may set out sooner than a second step would come."""
    times = BEGIN + np.array([0, 3, 13]) * MS
    told = Told().tell(BEGIN - 6 * MS, HALT).move(1).tell(BEGIN - ahead_us * US, STOP).move(3, at=BEGIN + MS)
    slow = replace(SETTING, slopes=[Slopes(np.array([]), np.array([]), 10 * MS)])
    assert ("the slew interval is" not in seen(times, ended(told, 3), setting=slow)) == good


def test_a_run_that_leaves_its_speed() -> None:
    intervals = np.concatenate((WAY[:100], np.full(1000, 2600), WAY[100:], np.full(200, SLEW), WAY[::-1]))
    times = after(intervals)

    def told(until: int) -> Told:
        body = for_axes({0: 2600})
        faster = Told().tell(BEGIN - 3 * MS, RUN, body).tell(int(times[until]), RUN, for_axes({0: SLEW}))
        return faster.tell(int(times[1440]), STOP)

    assert seen(times, ended(told(1098), times.size)) == ""
    assert "off after a run" in seen(times, ended(told(1240), times.size))


def test_pulses() -> None:
    wide = replace(SETTING, settings=Settings(pulse_width_us=3))
    assert "a pulse of 2.50 us" in seen(move(), ended(Told().move()), setting=wide)
    assert "a pause of 0.62 us" in seen(move(), ended(Told().move()), width=SLEW - 10)


LINE_OF_TWO = bytes([3, 0]) + values_of({0: STEPS, 1: 1000})


@pytest.mark.parametrize("late_us", [0, 5])
@pytest.mark.parametrize("steps", [1000, 999])
def test_a_line(late_us: int, steps: int) -> None:
    """Three steps of the leader are one of the other's: at the second of them."""
    both = replace(SETTING, slopes=[SLOPES] * 2)
    follower = move()[1::3][:steps].copy()
    follower[500] += late_us * US
    told = (
        Told()
        .tell(BEGIN - 3 * MS, LINE, LINE_OF_TWO, b"\0" + struct.pack("<ii", STEPS, 1000))
        .status(999 * MS, STEPS, STEPS)
    )
    found = seen(move(), ended(told), setting=both, others=[follower])
    assert ("the leader's" in found) == (late_us > 0 and steps == 1000)
    assert ("999 steps of a line" in found) == (steps == 999)


LATER = 900 * MS


@pytest.mark.parametrize(
    ("told", "fault"),
    [
        (lambda: ended(Told().move(), STEPS - 1), "the edges say"),
        (lambda: ended(Told().move(STEPS + 2)), "the target is 3000, it was 3002"),
        (lambda: Told().move().status(LATER, STEPS, STEPS, starved=2), "starved 2 times"),
        (lambda: Told().move().status(LATER, STEPS, STEPS, state=1), "not at rest"),
        (lambda: ended(Told().move().tell(LATER, STOP, answer_ms=9.5)), "an answer to 0x30 after"),
        (lambda: ended(Told().move().tell(LATER, MOVE_BY, b"\1\2\0\0\0", b"\0\xbd\x0b\0\0")), "is told as the target"),
        (lambda: ended(Told().move().tell(LATER, MOVE_BY, b"\1\2\0\0\0", b"\6\0\0")), "refused with status 6"),
        (lambda: Told(ended(Told().move().move()).frames[:2] + ended(Told().move().move()).frames[2:3]), "no answer"),
    ],
)  # fmt: skip
def test_what_is_said(told: Callable[[], Told], fault: str) -> None:
    conversation = told()
    if fault == "no answer":
        conversation = ended(conversation)
    assert fault in seen(move(), conversation)
