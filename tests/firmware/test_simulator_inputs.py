"""Inputs on the simulated chip: how soon an emergency stop is obeyed at all limits, and to which step axes are homed.

The firmware is the build with inputs. Each conversation plays the same way to the cycle.
"""

import random
import struct
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from firmware.checker import CYCLES_PER_S
from firmware.flight.exchange import Exchange, exchanges
from firmware.protocol import (
    ACKNOWLEDGE,
    AT_LIMIT,
    BEGIN,
    BY_EMERGENCY_STOP,
    DATA,
    EMERGENCY_STOP,
    END,
    HELLO,
    HOME,
    LINE,
    LOW_LIMIT,
    MOVE_BY,
    OK,
    REPORT,
    RUN,
    SET_POSITION,
    STATUS,
    STOPPED,
    TRACE,
    TRY,
    WRITE_LIMITS,
    WRITE_SETTINGS,
    InputSettings,
    InputsStatus,
    Ramp,
    Settings,
    Status,
    crc16,
    encode_frame,
    for_axes,
    image_parts,
    values_of,
)
from firmware.rig import RampDesign, image
from simulator.avr import Conversation, TimedFrame, build_firmware, build_harness, converse, missing_tools
from tools import require

SESSION = 0x5354
CYCLES_PER_MS, CYCLES_PER_US = CYCLES_PER_S // 1000, CYCLES_PER_S // 1_000_000
MOST_US = 100
"""From the edge of the emergency stop to the last step."""
STOP_PIN, LOW_PIN = 14, 9
STOP_INPUT, LOW_INPUT = 0, 6
ROLES = {STOP_INPUT: EMERGENCY_STOP}
PRESSES = 24
FIRST_MS, EVERY_MS, JITTER_MS = 700.0, 90.0, 7.0
OUTPUT_STATUS_BYTES = 26
LEAST_STACK_BYTES = 48
GAUGE = Ramp([(8000, 6, 0), (5000, 20, 0)], 3200, [(8000, 6, 0), (5000, 20, 0)])


@pytest.fixture(scope="module", autouse=True)
def tools() -> None:
    require(*missing_tools())
    build_harness()


@dataclass
class Talk:
    """What is said to a controller."""

    asked: list[TimedFrame] = field(default_factory=list)
    tag: int = 0

    def ask(self, kind: int, body: bytes = b"", *, wait_ms: float = 0.0, quiet_ms: float = 0.0) -> None:
        self.tag = (self.tag + 1) & 0xFF
        frame = encode_frame(struct.pack("<BHB", kind, SESSION, self.tag) + body)
        wait, quiet = int(wait_ms * CYCLES_PER_MS), int(quiet_ms * CYCLES_PER_MS)
        self.asked.append(TimedFrame(frame, wait_cycles=wait, quiet_cycles=quiet))

    def begin(self, ramps: bytes, inputs: InputSettings, outputs: Settings | None = None) -> None:
        self.ask(HELLO, b"\3")
        self.ask(WRITE_SETTINGS, (outputs or Settings()).packed() + inputs.packed())
        self.ask(BEGIN, struct.pack("<HH", len(ramps), crc16(ramps)))
        for part in image_parts(ramps):
            self.ask(DATA, part)
        self.ask(END)
        self.ask(TRY)


@dataclass(frozen=True)
class Work:
    """Motors at the limits of what they may do at the same time."""

    ramps: bytes
    kind: int
    body: bytes
    axes: int
    settings: Settings = field(default_factory=Settings)
    is_gauge: bool = False


def runs(count: int, speed: int, settings: Settings | None = None) -> Work:
    plan = RampDesign(speed, 40 * speed, 40 * speed)
    body = for_axes(dict.fromkeys(range(count), plan.slew))
    return Work(image([plan] * count), RUN, body, count, settings or Settings())


def line(count: int, speed: int) -> Work:
    plan = RampDesign(speed, 40 * speed, 40 * speed)
    steps = values_of({axis: 900_000 - 70_001 * axis for axis in range(count)})
    return Work(image([plan] * count), LINE, bytes([(1 << count) - 1, 0]) + steps, count)


def gauges() -> Work:
    return Work(GAUGE.image(3), RUN, for_axes(dict.fromkeys(range(3), 3200)), 3, Settings(outputs=1), is_gauge=True)


WORK = {
    "one axis": runs(1, 150_000),
    "two axes": runs(2, 65_000),
    "four axes": runs(4, 30_000),
    "a line of two": line(2, 117_000),
    "a line of four": line(4, 86_000),
    "pulses of 8 us": runs(4, 10_000, Settings(pulse_width_us=8)),
    "pulses of 12 us": runs(4, 7500, Settings(pulse_width_us=12)),
    "pulses of 100 us": runs(4, 1150, Settings(pulse_width_us=100)),
    "each edge a step": runs(4, 30_000, replace(Settings(), both_edges=15)),
    "gauges": gauges(),
}


def rises(conversation: Conversation, work: Work) -> npt.NDArray[np.int64]:
    """Return when steps are made [cycles]: rising edges, or all where each of them is a step, and of coils all."""
    edges = conversation.edges
    pins = list(range(2, 14)) if work.is_gauge else [2, 3, 4, 12]
    chosen = np.isin(edges["pin"], pins)
    if not (work.is_gauge or work.settings.both_edges):
        chosen &= edges["value"] == 1
    return edges["cycle"][chosen]


def acknowledgements(conversation: Conversation) -> list[Exchange]:
    return [each for each in exchanges(conversation.frames) if each.kind == ACKNOWLEDGE]


@pytest.mark.parametrize("name", WORK)
@pytest.mark.parametrize("looks", [4, 10])
def test_an_emergency_stop_halts_all_within_100_us(
    tmp_path: Path, record_property: Callable[..., None], name: str, looks: int
) -> None:
    """At speed, at two dozen moments, with reports: no step comes later, nor any before it was acknowledged."""
    work, chance = WORK[name], random.Random(f"{name} {looks}")
    talk = Talk()
    talk.begin(work.ramps, InputSettings(looks=looks, roles=ROLES), work.settings)
    talk.ask(REPORT, bytes([50]))
    presses = []
    for number in range(PRESSES):
        begin = FIRST_MS + EVERY_MS * number + chance.random() * JITTER_MS
        presses.append((STOP_PIN, begin, begin + chance.choice([0.06, 0.5, 3.0]) + 0.004 * looks))
        talk.ask(work.kind, work.body)
        talk.ask(work.kind, work.body, wait_ms=25, quiet_ms=20)
        talk.ask(ACKNOWLEDGE)
    talk.ask(STATUS, b"\0")
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, presses)
    steps, said = rises(played, work), acknowledgements(played)
    assert [each.status for each in said] == [OK] * PRESSES
    refused = [each for each in exchanges(played.frames) if each.kind == work.kind and each.status != OK]
    assert [each.status for each in refused] == [STOPPED] * PRESSES
    late_us = []
    for (_, begin_ms, _), acknowledged in zip(presses, said, strict=True):
        pressed = begin_ms * CYCLES_PER_MS
        before = steps[(steps > pressed - 10 * CYCLES_PER_MS) & (steps <= pressed)]
        assert before.size > 0, "nothing moved"
        after = steps[(steps > pressed) & (steps < acknowledged.came)]
        late_us.append(float(after.max() - pressed) / CYCLES_PER_US if after.size else 0.0)
    record_property("latest_us", max(late_us))
    assert max(late_us) <= MOST_US
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES
    (last,) = [each for each in exchanges(played.frames) if each.kind == STATUS]
    status, inputs = (
        Status.unpack(last.reply[:OUTPUT_STATUS_BYTES]),
        InputsStatus.unpack(last.reply[OUTPUT_STATUS_BYTES:]),
    )
    assert (status.state, inputs.stopped_by) == (0, 0)


def test_positions_are_those_of_the_pins_after_emergency_stops(tmp_path: Path) -> None:
    work, chance = WORK["four axes"], random.Random(7)
    talk = Talk()
    talk.begin(work.ramps, InputSettings(roles=ROLES))
    presses = []
    for number in range(PRESSES):
        begin = FIRST_MS + EVERY_MS * number + chance.random() * JITTER_MS
        presses.append((STOP_PIN, begin, begin + 1))
        talk.ask(RUN, work.body)
        talk.ask(STATUS, bytes([number % 4]), wait_ms=25, quiet_ms=6)
        talk.ask(ACKNOWLEDGE)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, presses)
    told = [each for each in exchanges(played.frames) if each.kind == STATUS]
    for number, each in enumerate(told):
        edges = played.edges
        pin = (2, 3, 4, 12)[number % 4]
        made = np.sum((edges["pin"] == pin) & (edges["value"] == 1) & (edges["cycle"] < each.came))
        status = Status.unpack(each.reply[:OUTPUT_STATUS_BYTES])
        assert status.position == made
        assert InputsStatus.unpack(each.reply[OUTPUT_STATUS_BYTES:]).stopped_by == BY_EMERGENCY_STOP


@pytest.mark.parametrize("slow_steps_per_s", [100, 500])
def test_homing_comes_to_the_same_step_each_time(tmp_path: Path, slow_steps_per_s: int) -> None:
    plan = RampDesign(8000, 40_000, 40_000)
    talk = Talk()
    talk.begin(image([plan]), InputSettings(roles={LOW_INPUT: LOW_LIMIT}))
    talk.ask(REPORT, bytes([50]))
    homings = 6
    body = struct.pack("<BIH", 1, CYCLES_PER_S // slow_steps_per_s, 30) + values_of({0: -8 * plan.slew})
    for number in range(homings):
        talk.ask(MOVE_BY, for_axes({0: 700 + 111 * number}))
        talk.ask(HOME, body, wait_ms=400)
        for _ in range(24):
            talk.ask(STATUS, b"\0", wait_ms=150)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, switches=["9:0<-250"])
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES
    edges = played.edges
    ends = [each for each in exchanges(played.frames) if each.kind == STATUS][23::24]
    homes = [each for each in exchanges(played.frames) if each.kind == HOME]
    assert [each.status for each in homes] == [OK] * homings
    places = []
    for each in ends:
        inputs = InputsStatus.unpack(each.reply[OUTPUT_STATUS_BYTES:])
        assert (inputs.homing, inputs.known & 1) == (0, 1)
        until = edges[edges["cycle"] < each.came]
        places.append(position(until) - Status.unpack(each.reply[:OUTPUT_STATUS_BYTES]).position)
    # The switch is inactive at -249.
    assert len(places) == homings
    assert set(places) <= {-249, -248}
    assert max(places) - min(places) <= 1


def test_four_axes_are_homed_at_once(tmp_path: Path) -> None:
    """With wide pulses, reports and a trace: what takes most of the stack."""
    limits = {1: LOW_LIMIT + 3, LOW_INPUT: LOW_LIMIT, LOW_INPUT + 1: LOW_LIMIT + 1, LOW_INPUT + 2: LOW_LIMIT + 2}
    switches = ["9:0<-250", "10:1<-300", "11:2<-10", "15:3<-777"]
    plan, axes = RampDesign(2000, 20_000, 20_000), dict.fromkeys(range(4), 0)
    talk = Talk()
    talk.begin(image([plan] * 4), InputSettings(roles=limits), Settings(pulse_width_us=40))
    talk.ask(REPORT, bytes([50]))
    talk.ask(TRACE, b"\0\1\0")
    intervals = values_of({axis: -(plan.slew + 1000 * axis) for axis in axes})
    talk.ask(HOME, struct.pack("<BIH", 15, CYCLES_PER_S // 400, 30) + intervals, wait_ms=400)
    for _ in range(24):
        talk.ask(STATUS, b"\0", wait_ms=150)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, switches=switches)
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES
    last = [each for each in exchanges(played.frames) if each.kind == STATUS][-1]
    inputs = InputsStatus.unpack(last.reply[OUTPUT_STATUS_BYTES:])
    assert (inputs.homing, inputs.known) == (0, 15)


def position(edges: npt.NDArray[np.void]) -> int:
    """Return where axis 0 is by its pins."""
    at, is_forward = 0, False
    for edge in edges[np.isin(edges["pin"], [2, 5])]:
        if edge["pin"] == 5:
            is_forward = bool(edge["value"])
        elif edge["value"]:
            at += 1 if is_forward else -1
    return at


def test_runs_of_all_axes_end_at_their_soft_limits(tmp_path: Path) -> None:
    """Four at the limits of what may move at the same time."""
    work, talk = runs(4, 30_000), Talk()
    talk.begin(work.ramps, InputSettings(roles=ROLES))
    highest = [20_000, 20_001, 17_345, 15_000]
    for axis, most in enumerate(highest):
        talk.ask(WRITE_LIMITS, struct.pack("<Bii", axis, -5, most))
    talk.ask(SET_POSITION, for_axes(dict.fromkeys(range(4), 0)))
    talk.ask(REPORT, bytes([50]))
    talk.ask(RUN, work.body)
    for axis in (0, 0, 0, 0, 1, 2, 3):
        talk.ask(STATUS, bytes([axis]), wait_ms=250)
    talk.ask(RUN, work.body)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked)
    told = exchanges(played.frames)
    ends = [Status.unpack(each.reply[:OUTPUT_STATUS_BYTES]) for each in told if each.kind == STATUS][3:]
    assert [end.position for end in ends] == highest
    assert [end.starved for end in ends] == [0] * 4
    edges = played.edges
    made = [np.sum((edges["pin"] == pin) & (edges["value"] == 1)) for pin in (2, 3, 4, 12)]
    assert made == highest
    assert [each.status for each in told if each.kind == RUN] == [OK, AT_LIMIT]
