"""A busy line on the simulated chip, with motors at their limits: stops right behind other requests, and floods.

Each conversation is made by its seed alone, and plays the same way to the cycle.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from firmware.checker import axis_of
from firmware.flight.answers import STOP_MS
from firmware.flight.exchange import IN_TRANSMITTER_CYCLES, message_of
from firmware.flight.pins import LAST_STEP_AFTER_HALT_MS
from firmware.protocol import (
    DATA,
    HALT,
    LINE,
    MOVE_BY,
    OK,
    READ,
    REPORT,
    RUN,
    STATUS,
    STOP,
    TRACE,
    Ramp,
    Settings,
    Status,
    for_axes,
)
from firmware.rig import RampDesign, image
from firmware.talk import CYCLES_PER_MS, SESSION, Talk
from firmware.test_simulator_axes import SPEEDS, STEPS
from simulator.avr import Conversation, Frame, TimedFrame, build_firmware, build_harness, converse, missing_tools
from tools import require

WITH_INPUTS = "INPUTS=yes"
"""The build that looks at inputs all the time, in place of ramps by formula."""
OTHER_SESSION = 7
LONGEST_BLOB = 128
STOPS = 40
MOST_EMPTY_FRAMES = 12
FASTEST_ALONE = 150_000
SEGMENTS = 30
FLOODS = 12
CHECKSUM = [5, 6]
"""Where a stop's frame has it. Damage there stays: bytes lost between two frames could undo what is wrong before it."""


@pytest.fixture(scope="module", autouse=True)
def tools() -> None:
    require(*missing_tools())
    build_harness()


@dataclass
class Busy(Talk):
    """What is said in a conversation that its seed makes."""

    random: random.Random = field(default_factory=random.Random)

    def end(self, axes: int) -> None:
        """Ask each axis how it is; see starved()."""
        for axis in range(axes):
            self.ask(STATUS, bytes([axis]), wait_ms=20)

    def play(self, folder: Path, *, with_inputs: bool = False) -> Conversation:
        build = [WITH_INPUTS] if with_inputs else []
        return converse(build_firmware(*build), folder, self.asked)


def answers(conversation: Conversation) -> list[tuple[Frame, bytes]]:
    """Return the frames that the controller sent, and their messages, without those that were cut short."""
    said = ((frame, message_of(frame)) for frame in conversation.frames if not frame.is_sent)
    return [(frame, message) for frame, message in said if message]


def starved(conversation: Conversation) -> int:
    """How often a queue ran dry, as the last status says."""
    _, last = answers(conversation)[-1]
    assert last[0] == STATUS | 0x80
    return Status.unpack(last[5:]).starved


def damaged(frame: bytes, at: int, bit: int) -> bytes:
    """Return a stop's frame with a wrong bit in its session, tag or checksum; no byte becomes 0, which ends a frame."""
    byte = frame[at] ^ bit or frame[at] ^ 8
    return frame[:at] + bytes([byte]) + frame[at + 1 :]


# ---- stops right behind other requests


def request_before(talk: Busy, axes: int, slew: int) -> bytes:
    everywhere = range(axes)
    steps = talk.random.choice([1, 50, 5000])
    return talk.random.choice(
        [
            lambda: talk.frame(STATUS, b"\0"),
            lambda: talk.frame(MOVE_BY, for_axes(dict.fromkeys(everywhere, steps))),
            lambda: talk.frame(RUN, for_axes(dict.fromkeys(everywhere, slew + 5))),
            lambda: talk.frame(LINE, bytes([(1 << axes) - 1, 0]) + struct.pack("<i", 3000) * axes),
            lambda: talk.frame(REPORT, b"\x32"),
        ]
    )()


def stops(talk: Busy, plan: RampDesign, axes: int) -> Iterator[tuple[int, bytes]]:
    """Ask for stops and halts, each right behind another request, most of them while the motors run; give the number of
    each blob and the header of the stop in it."""
    talk.ask(REPORT, b"\x32")
    talk.ask(TRACE, struct.pack("<BH", 0, 1))
    for _ in range(STOPS):
        runs = talk.random.random() < 0.75
        if runs:
            talk.ask(RUN, for_axes(dict.fromkeys(range(axes), plan.slew)), wait_ms=3)
        kind = talk.random.choice([STOP, HALT])
        session = talk.random.choice([SESSION, SESSION, OTHER_SESSION])
        before = request_before(talk, axes, plan.slew) + bytes(talk.random.randint(0, MOST_EMPTY_FRAMES))
        blob = before + talk.frame(kind, session=session)
        wait = (70 if runs else 10) + talk.random.random()
        talk.asked.append(TimedFrame(blob, wait_cycles=int(wait * CYCLES_PER_MS)))
        yield len(talk.asked) - 1, struct.pack("<BHB", kind, session, talk.tag)
        talk.ask(HALT, wait_ms=45)


@pytest.mark.parametrize(
    ("axes", "speed", "seed"), [(4, 30_000, 1), (4, 30_000, 2), (4, 30_000, 3), (1, FASTEST_ALONE, 1)]
)
def test_a_stop_right_behind_another_request_is_as_quick(
    tmp_path: Path, record_property: Callable[..., None], axes: int, speed: int, seed: int
) -> None:
    plan, talk = RampDesign(speed, 20 * speed, 20 * speed), Busy(random=random.Random(seed))
    talk.begin(image([plan] * axes))
    asked = list(stops(talk, plan, axes))
    talk.end(axes)
    judge_stops(talk.play(tmp_path), asked, axes, record_property)


def judge_stops(
    played: Conversation,
    asked: list[tuple[int, bytes]],
    axes: int,
    record_property: Callable[..., None],
) -> None:
    """Each was obeyed, in time, and no motor waited."""
    sent = [frame for frame in played.frames if frame.is_sent]
    replies = {message[:4]: (frame, message) for frame, message in answers(played)}
    steps = [axis_of(played.edges, axis).steps for axis in range(axes)]
    slowest = latest = 0.0
    for number, header in asked:
        arrived = sent[number].end
        reply, message = replies[bytes([header[0] | 0x80]) + header[1:]]
        assert message[4] == OK
        gone = reply.end + IN_TRANSMITTER_CYCLES
        slowest = max(slowest, (gone - arrived) / CYCLES_PER_MS)
        if header[0] == HALT:
            after = [one for axis in steps for one in axis[(axis > arrived) & (axis < gone + 10 * CYCLES_PER_MS)]]
            latest = max(latest, *((one - arrived) / CYCLES_PER_MS for one in after), 0.0)
    record_property("slowest_stop_ms", float(slowest))
    record_property("last_step_after_halt_ms", float(latest))
    assert len(asked) == STOPS
    assert slowest <= STOP_MS
    assert latest <= LAST_STEP_AFTER_HALT_MS
    assert starved(played) == 0


# ---- stops on a line at its highest speed


def just_keeping_pace(axes: int, slew: int, segments: int = SEGMENTS) -> Ramp:
    """A ramp whose segments are as short as docs/serial_protocol.md allows, from a third of the slew speed on."""
    intervals = [round(slew * 3 ** float(1 - place)) for place in np.linspace(0, 1, segments)]
    lengths = [axes * max(5_600, 11_200 * slew // interval) for interval in intervals]
    up = [(interval, 1 + length // interval, 0) for interval, length in zip(intervals, lengths, strict=True)]
    return Ramp(up, slew, up)


@pytest.mark.parametrize(
    ("axes", "slew", "both_edges", "with_inputs"),
    [
        (1, 106, 0, False),
        (2, 133, 0b1111, False),
        (3, 160, 0, False),
        (4, 181, 0, False),
        (4, 181, 0b1111, False),
        (2, 136, 0b1111, True),
        (4, 184, 0, True),
    ],
)
def test_a_stop_of_a_line_at_its_highest_speed_is_quick(
    tmp_path: Path, record_property: Callable[..., None], axes: int, slew: int, both_edges: int, *, with_inputs: bool
) -> None:
    """In the midst of all that keeps the processor busy, also behind the longest request that a client can send, and
    where a piece of the line ends."""
    talk = Busy(random=random.Random(axes + both_edges))
    talk.begin(just_keeping_pace(axes, slew).image(axes, fast=True), Settings(both_edges=both_edges))
    talk.ask(REPORT, b"\x32")
    talk.ask(TRACE, struct.pack("<BH", 0, 1))
    asked = []
    for _ in range(STOPS):
        steps = [40_000, *(talk.random.choice([40_000, 39_999, 30_000, 1_000]) for _ in range(axes - 1))]
        talk.ask(LINE, bytes([(1 << axes) - 1, 0]) + struct.pack(f"<{axes}i", *steps), wait_ms=20)
        before = talk.random.choice(
            [
                b"",
                talk.frame(STATUS, b"\0"),
                talk.frame(DATA, bytes(2) + b"\x09" * 48),
                talk.frame(READ, b"\1\0\0\x30"),
                talk.frame(MOVE_BY, b"\x0f" + bytes(16)),
            ]
        )
        kind = talk.random.choice([HALT, HALT, STOP])
        blob, wait_ms = before + talk.frame(kind), 30 + 180 * talk.random.random()
        talk.asked.append(TimedFrame(blob, wait_cycles=int(wait_ms * CYCLES_PER_MS)))
        asked.append((len(talk.asked) - 1, struct.pack("<BHB", kind, SESSION, talk.tag)))
        talk.ask(HALT, wait_ms=60)
    talk.end(axes)
    judge_stops(talk.play(tmp_path, with_inputs=with_inputs), asked, axes, record_property)


# ---- stops where a long ramp would have to be searched


@pytest.mark.parametrize(("axes", "slew"), [(1, 106), (4, 533)])
def test_a_stop_is_quick_wherever_on_a_long_ramp(
    tmp_path: Path, record_property: Callable[..., None], axes: int, slew: int
) -> None:
    """The ramp down from there is known by then, however busy the line was."""
    talk, ramp = Busy(random=random.Random(axes)), just_keeping_pace(axes, slew, 2 * SEGMENTS)
    lasting_ms = sum(interval * count for interval, count, _ in ramp.up) / CYCLES_PER_MS
    talk.begin(ramp.image(axes, fast=True))
    talk.ask(REPORT, b"\x32")
    talk.ask(TRACE, struct.pack("<BH", 0, 1))
    asked = []
    for number in range(STOPS):
        talk.ask(RUN, for_axes(dict.fromkeys(range(axes), slew)))
        wait_ms = 10 + number * (lasting_ms + 20) / STOPS
        talk.asked.append(TimedFrame(talk.frame(STOP), wait_cycles=int(wait_ms * CYCLES_PER_MS)))
        asked.append((len(talk.asked) - 1, struct.pack("<BHB", STOP, SESSION, talk.tag)))
        talk.ask(HALT, wait_ms=60)
    talk.end(axes)
    judge_stops(talk.play(tmp_path), asked, axes, record_property)


@pytest.mark.parametrize("second", [STOP, HALT])
def test_a_halt_is_obeyed_right_before_another_stop(tmp_path: Path, second: int) -> None:
    """Also behind a request, and when the second one names but one axis."""
    axes, plan, talk = 4, RampDesign(30_000, 600_000, 600_000), Busy(random=random.Random(second))
    talk.begin(image([plan] * axes))
    blobs = []
    for _ in range(20):
        talk.ask(RUN, for_axes(dict.fromkeys(range(axes), plan.slew)), wait_ms=3)
        before = talk.random.choice([b"", talk.frame(STATUS, b"\0"), talk.frame(MOVE_BY, b"\1" + bytes(4))])
        wait_ms = 60 + 20 * talk.random.random()
        blob = before + talk.frame(HALT) + talk.frame(second, b"\1")
        talk.asked.append(TimedFrame(blob, wait_cycles=int(wait_ms * CYCLES_PER_MS)))
        blobs.append(len(talk.asked) - 1)
        talk.ask(HALT, wait_ms=60)
    played = talk.play(tmp_path)
    sent = [frame for frame in played.frames if frame.is_sent]
    for axis in range(1, axes):
        steps = axis_of(played.edges, axis).steps
        for number in blobs:
            arrived, next_halt = sent[number].end, sent[number + 1].end
            after = steps[(steps > arrived + 10 * CYCLES_PER_MS) & (steps < next_halt)]
            assert after.size == 0


# ---- a line that does not fall silent


@pytest.mark.parametrize("count", SPEEDS)
@pytest.mark.parametrize(
    ("seed", "with_inputs"), [*((seed, False) for seed in range(FLOODS)), *((seed, True) for seed in range(3))]
)
def test_motors_never_wait_for_a_flood(tmp_path: Path, count: int, seed: int, *, with_inputs: bool) -> None:
    """It begins at any time of a move, and has pauses too short to catch up in."""
    talk = Busy(random=random.Random(seed))
    plan = RampDesign(SPEEDS[count], 30 * SPEEDS[count], 40 * SPEEDS[count])
    talk.begin(image([plan] * count))
    talk.ask(MOVE_BY, for_axes(dict(enumerate(STEPS[:count]))), wait_ms=talk.random.random() * 40)
    for _ in range(18):
        blob = b""
        for _ in range(talk.random.choice([14, 14, 14, 4, 8])):
            frame = talk.frame(STATUS, bytes([talk.random.randrange(4)]))
            blob += frame if len(blob) + len(frame) <= LONGEST_BLOB else b""
        pause_ms = talk.random.choice([0, 0, 0, talk.random.random(), 3 * talk.random.random()])
        talk.asked.append(TimedFrame(blob, wait_cycles=int(pause_ms * CYCLES_PER_MS)))
    talk.ask(STATUS, b"\0", wait_ms=300)
    talk.end(count)
    played = talk.play(tmp_path, with_inputs=with_inputs)
    assert starved(played) == 0
    assert [axis_of(played.edges, axis).steps.size for axis in range(count)] == [abs(steps) for steps in STEPS[:count]]


@pytest.mark.parametrize(
    ("seed", "damaged_stops", "with_inputs"),
    [
        *((seed, 0.0, False) for seed in (9, 35, 59)),
        *((seed, 0.5, False) for seed in (1, 9, 11)),
        (9, 0.0, True),
        (9, 0.5, True),
    ],
)
def test_a_line_of_four_never_waits_for_a_flood(
    tmp_path: Path, seed: int, damaged_stops: float, *, with_inputs: bool
) -> None:
    """At its highest speed, where nearly all of the processor is taken, and a status asks how far each axis goes; nor
    when so many of the frames are stops that a disturbed line has damaged, to each of which a request gives way."""
    talk = Busy(random=random.Random(seed))
    steps = (70_000, -23_456, 69_999, -69_998)
    talk.begin(image([RampDesign(86_956 if with_inputs else 88_395, 4_500_000, 4_500_000)] * 4))
    talk.ask(LINE, bytes([0b1111, 0]) + struct.pack("<4i", *steps), wait_ms=talk.random.random() * 40)
    longest_pause_ms = talk.random.choice([0, 0, 1, 3])
    for _ in range(110):
        blob = b""
        for _ in range(talk.random.choice([14, 14, 14, 4, 8])):
            frame = talk.frame(STATUS, bytes([talk.random.randrange(4)]))
            if damaged_stops and talk.random.random() < damaged_stops:
                stop = talk.frame(talk.random.choice([STOP, HALT]))
                frame = damaged(stop, talk.random.choice(CHECKSUM), talk.random.choice([1, 2, 4]))
            blob += frame if len(blob) + len(frame) <= LONGEST_BLOB else b""
        pause_ms = talk.random.choice([0, 0, 0, talk.random.random(), longest_pause_ms * talk.random.random()])
        talk.asked.append(TimedFrame(blob, wait_cycles=int(pause_ms * CYCLES_PER_MS)))
    talk.ask(STATUS, b"\0", wait_ms=300)
    talk.end(4)
    played = talk.play(tmp_path, with_inputs=with_inputs)
    assert starved(played) == 0
    assert [axis_of(played.edges, axis).travel for axis in range(4)] == list(steps)


# ---- stops that a disturbed line has damaged


@pytest.mark.parametrize(("seed", "with_inputs"), [(0, False), (1, False), (2, False), (0, True), (1, True)])
def test_motors_never_wait_for_what_only_looks_like_a_stop(tmp_path: Path, seed: int, *, with_inputs: bool) -> None:
    """Right behind a move that has all four motors turn back: an axis with little time left queues its steps first."""
    plan, talk = RampDesign(30_000, 600_000, 600_000), Busy(random=random.Random(seed))
    axes = range(4)
    talk.begin(image([plan] * 4))
    talk.ask(REPORT, b"\x32")
    talk.ask(TRACE, struct.pack("<BH", 0, 1))
    for _ in range(STOPS):
        talk.ask(RUN, for_axes(dict.fromkeys(axes, plan.slew)), wait_ms=3)
        move = talk.frame(MOVE_BY, for_axes(dict.fromkeys(axes, 500)))
        stop = talk.frame(talk.random.choice([STOP, HALT]))
        blob = move + damaged(stop, talk.random.choice([3, 4, 5, 6]), talk.random.choice([1, 2, 4]))
        talk.asked.append(TimedFrame(blob, wait_cycles=int((60 + talk.random.random()) * CYCLES_PER_MS)))
        talk.ask(STATUS, b"\0", wait_ms=20)
        talk.ask(HALT, wait_ms=40)
    talk.end(4)
    assert starved(talk.play(tmp_path, with_inputs=with_inputs)) == 0
